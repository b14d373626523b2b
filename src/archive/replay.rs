//! Replays a recording into a sink.

use crate::archive::recording::{Losses, MessageError, Misplaced, Recording, Selection};
use crate::archive::sink::{Sink, SinkError};
use std::ops::ControlFlow;

/// Result of a replay.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Replayed {
    /// Messages passed on.
    pub messages: u64,
    /// Messages that could not be decoded: the first, and how many.
    pub undecodable: Option<(MessageError, u64)>,
    /// Parts of the file that could not be read.
    pub losses: Losses,
    /// Messages that repeat others or go back in time.
    pub left_out: Option<Misplaced>,
}

/// Writes the selected messages of a recording to `sink`, in order of time.
///
/// `between` is called after each message with the number of bytes of the file that have been read since the
/// last one; it can cancel the replay.
///
/// # Errors
/// The first error of the sink.
pub fn replay(
    recording: &Recording,
    selection: Selection,
    sink: &mut dyn Sink,
    mut between: impl FnMut(u64) -> ControlFlow<()>,
) -> Result<Replayed, SinkError> {
    let mut replayed = Replayed::default();
    let mut reader = recording.reader(selection).in_order_of_time();
    while let Some(message) = reader.next() {
        match message {
            Ok(message) => {
                sink.write(&message)?;
                replayed.messages += 1;
            }
            // One bad message must not hide the others.
            Err(error) => match &mut replayed.undecodable {
                Some((_, count)) => *count += 1,
                none => *none = Some((error, 1)),
            },
        }
        if between(reader.progress()).is_break() {
            break;
        }
    }
    replayed.losses = reader.all_losses();
    replayed.left_out = reader.left_out().cloned();
    Ok(replayed)
}
