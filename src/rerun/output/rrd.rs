//! `.rrd` files, each written by a thread that encodes and compresses.

use std::fs::File;
use std::io::BufWriter;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{self, JoinHandle};

use rerun::external::re_log_encoding::Encoder;
use rerun::external::re_log_encoding::rrd::EncodingOptions;
use rerun::external::re_log_types::LogMsg;

use super::message::QUEUE;
use crate::rerun::error::RerunError;

/// An `.rrd` file that is being written.
pub(super) struct RrdFile {
    queue: SyncSender<LogMsg>,
    worker: JoinHandle<Result<(), RerunError>>,
}

impl RrdFile {
    /// Starts the thread that writes into `file`.
    pub(super) fn open(file: File) -> Result<Self, RerunError> {
        // Bounded, so that a slow disk slows the run down instead of filling the memory.
        let (queue, messages) = sync_channel(QUEUE);
        let worker = thread::Builder::new()
            .name("rrd encoder".to_owned())
            .spawn(move || encode(file, &messages))?;
        Ok(Self { queue, worker })
    }

    /// Passes a message on, unless writing has failed; [`Self::finish`] returns the reason.
    pub(super) fn send(&self, message: LogMsg) -> bool {
        self.queue.send(message).is_ok()
    }

    /// Waits until all messages and the footer are in the file.
    pub(super) fn finish(self) -> Result<(), RerunError> {
        drop(self.queue);
        self.worker.join().map_err(|_| RerunError::Worker)?
    }
}

/// Encodes messages until there are no more, then adds the footer.
fn encode(file: File, messages: &Receiver<LogMsg>) -> Result<(), RerunError> {
    let version = rerun::build_info().version;
    let options = EncodingOptions::PROTOBUF_COMPRESSED;
    let mut encoder = Encoder::new_eager(version, options, BufWriter::new(file))?;
    for message in messages {
        encoder.append(&message)?;
    }
    encoder.finish()?;
    Ok(encoder.flush_blocking()?)
}
