//! Reads a recording as everything does that reports on its run: in order of time, with all that is wrong with it.

use crate::archive::format::Entries;
use crate::archive::recording::{Condition, ContentCheck, Missing, Reader, Recording, Selection};
use crate::telemetry::{Message, Topic, Topics};

/// The end of a run that has been read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadEnd {
    /// The entries of its end record.
    pub end: Option<Entries>,
    /// Parts that could not be read, in sentences.
    pub losses: Vec<String>,
    /// Number of messages that could not be decoded.
    pub undecodable: u64,
    /// Messages that the run has according to its end record, but the recording lacks.
    pub missing: Vec<Missing>,
    /// State of the file, with all that reading it has shown; absent for a simulation.
    pub state: Option<Condition>,
}

/// Calls `take` with the selected messages in order of time, and the number of bytes read since the last call, as long
/// as `take` returns true. One message that can't be decoded doesn't hide the others.
pub fn replay(
    recording: &Recording,
    selection: Selection,
    take: &mut dyn FnMut(&Message<'_>, u64) -> bool,
) -> ReadEnd {
    // The rest of a recording that is read in part isn't missing.
    let mut is_part = selection.from_ns.is_some() || selection.to_ns.is_some();
    let mut check = ContentCheck::new(recording, &selected_topics(&selection));
    let mut reader = recording.reader(selection).in_order_of_time();
    loop {
        let bytes = reader.progress();
        let Some(message) = reader.next() else {
            break;
        };
        check.take(&message);
        if let Ok(message) = message
            && !take(&message, bytes)
        {
            is_part = true;
            break;
        }
    }
    let mut sentences = losses(recording, &reader);
    let faults = check.finish(recording.end().filter(|_| !is_part));
    let found = faults.sentences(!reader.all_losses().is_empty());
    let state = reader.condition(!found.is_empty());
    sentences.extend(found);
    ReadEnd {
        end: recording.end().cloned(),
        losses: sentences,
        undecodable: faults
            .undecodable
            .map_or(0, |undecodable| undecodable.count),
        missing: faults.missing,
        state: Some(state),
    }
}

/// The topics of the table in a selection.
fn selected_topics(selection: &Selection) -> Topics {
    match &selection.topics {
        Topics::All => Topics::All,
        Topics::Only(names) => {
            Topics::Only(names.iter().filter_map(|name| Topic::find(name)).collect())
        }
    }
}

/// Parts that a recording lacks and a reader could not read, in sentences.
pub(crate) fn losses(recording: &Recording, reader: &Reader<'_>) -> Vec<String> {
    let mut sentences = reader.all_losses().sentences();
    sentences.extend(reader.left_out().map(ToString::to_string));
    if recording.lacks_end() {
        let what = if recording.is_ours() { "run" } else { "file" };
        sentences.push(format!("missing end of the {what} (interrupted)"));
    }
    sentences.extend(reader.statistics_fault().map(|fault| fault.to_string()));
    sentences
}
