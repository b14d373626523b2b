//! Writing a run with two threads: the caller's encodes messages, another takes their digest, compresses and writes
//! them, in order. The bytes are those of [`crate::archive::writer::McapWriter`].

use crate::archive::format::{Entries, end_entries};
use crate::archive::publish::{Draft, Existing};
use crate::archive::sink::{Sink, SinkError};
use crate::archive::writer::{Batch, Form, Opening, Packer, RunEncoder};
use crate::run::scenario::Scenario;
use crate::run::simulation::RunEnd;
use crate::telemetry::{Message, Telemetry};
use ::mcap::McapError;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::thread::{self, JoinHandle};

/// Encoded messages travel to the writing thread in batches of about this size.
const BATCH_BYTES: usize = 128 * 1024;
/// Number of batches that may wait for the writing thread, which bounds the memory.
const BATCHES: usize = 8;

/// Writes a run as MCAP with two threads.
#[derive(Debug)]
pub(crate) struct Pipeline<W> {
    encoder: RunEncoder,
    batch: Batch,
    worker: Worker<W>,
}

enum Job {
    Write(Batch),
    Finish(Entries),
}

/// The target and the content digest; none if the recording was not finished.
type Finished<W> = Option<(W, String)>;

/// The writing thread, and the way to it.
#[derive(Debug)]
struct Worker<W> {
    /// Name of the file in error messages.
    name: PathBuf,
    jobs: Option<SyncSender<Job>>,
    /// Batches come back empty, to be filled again.
    empty: Receiver<Batch>,
    thread: Option<JoinHandle<Result<Finished<W>, McapError>>>,
}

impl<W: Write + Send + 'static> Pipeline<W> {
    /// Starts a recording in `target`, which errors call `name`.
    pub(crate) fn start(target: W, name: PathBuf, opening: Opening) -> Result<Self, SinkError> {
        let (packer, ids) = Packer::open(target, &opening).map_err(|reason| SinkError::Mcap {
            path: name.clone(),
            reason,
        })?;
        Ok(Self {
            encoder: RunEncoder::new(opening, &ids),
            batch: Batch::default(),
            worker: Worker::start(packer, name),
        })
    }

    /// Ends the recording; returns the target and the content digest.
    pub(crate) fn finish(mut self, end: &RunEnd) -> Result<(W, String), SinkError> {
        self.send_batch()?;
        self.worker.send(Job::Finish(end_entries(end)))?;
        self.worker.join()?.ok_or_else(|| self.worker.died())
    }

    fn send_batch(&mut self) -> Result<(), SinkError> {
        let empty = self.worker.empty.try_recv().unwrap_or_default();
        let batch = std::mem::replace(&mut self.batch, empty);
        self.worker.send(Job::Write(batch))
    }
}

impl<W: Write + Send + 'static> Sink for Pipeline<W> {
    fn write(&mut self, message: &Message<'_>) -> Result<(), SinkError> {
        self.encoder.encode(message, &mut self.batch);
        if self.batch.len() < BATCH_BYTES {
            return Ok(());
        }
        self.send_batch()
    }

    /// Passes on what there is. Chunks end by their size alone, so that their bytes are the same whenever they are written.
    fn flush(&mut self) -> Result<(), SinkError> {
        self.send_batch()
    }
}

impl<W: Write + Send + 'static> Worker<W> {
    fn start(packer: Packer<W>, name: PathBuf) -> Self {
        let (jobs, received) = sync_channel(BATCHES);
        let (returned, empty) = channel();
        let thread = thread::spawn(move || work(packer, &received, &returned));
        Self {
            name,
            jobs: Some(jobs),
            empty,
            thread: Some(thread),
        }
    }

    fn send(&mut self, job: Job) -> Result<(), SinkError> {
        let sent = self
            .jobs
            .as_ref()
            .is_some_and(|jobs| jobs.send(job).is_ok());
        if sent {
            return Ok(());
        }
        // The thread only goes away before the end when it has failed.
        self.join()?;
        Err(self.died())
    }

    /// Waits for the thread.
    fn join(&mut self) -> Result<Finished<W>, SinkError> {
        self.jobs = None;
        let thread = self.thread.take().ok_or_else(|| self.died())?;
        let finished = thread.join().map_err(|_| self.died())?;
        finished.map_err(|reason| SinkError::Mcap {
            path: self.name.clone(),
            reason,
        })
    }
}

impl<W> Worker<W> {
    fn died(&self) -> SinkError {
        SinkError::WriterDied {
            path: self.name.clone(),
        }
    }
}

impl<W> Drop for Worker<W> {
    /// A recording that was not finished keeps what it has: the thread writes out what it was given.
    fn drop(&mut self) {
        self.jobs = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// The writing thread.
fn work<W: Write>(
    mut packer: Packer<W>,
    jobs: &Receiver<Job>,
    returned: &Sender<Batch>,
) -> Result<Finished<W>, McapError> {
    for job in jobs {
        match job {
            Job::Write(mut batch) => {
                packer.write(&batch)?;
                batch.clear();
                // The receiver is gone if the sink is.
                let _ = returned.send(batch);
            }
            Job::Finish(end) => return packer.finish(end).map(Some),
        }
    }
    packer.flush().map(|()| None)
}

/// Writes the recording of a run into a file, which takes its name when it is complete.
#[derive(Debug)]
pub struct McapSink(Pipeline<BufWriter<Draft>>);

/// A finished file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Archived {
    /// Its place.
    pub path: PathBuf,
    /// Its size.
    pub bytes: u64,
    /// Digest of its content.
    pub digest: String,
}

impl McapSink {
    /// Starts the recording of `scenario` with the channels that `telemetry` wants.
    ///
    /// # Errors
    /// [`SinkError`] if the file can't be made or written.
    pub fn create(
        path: &Path,
        existing: Existing,
        scenario: &Scenario,
        telemetry: &Telemetry,
        form: Form,
    ) -> Result<Self, SinkError> {
        let preface = Self::preface(scenario, telemetry, form)?;
        let draft = Draft::of_run(path, existing, &preface)?;
        Self::create_in(draft, scenario, telemetry, form)
    }

    /// Content of a draft before its first chunk: everything that comes before the
    /// messages, with the channels outside of chunks. So a run that is killed at once can be run again.
    ///
    /// # Errors
    /// [`SinkError`] if the channels are more than a file may have.
    pub fn preface(
        scenario: &Scenario,
        telemetry: &Telemetry,
        form: Form,
    ) -> Result<Vec<u8>, SinkError> {
        let bytes = Opening::new(scenario, telemetry, form).bytes();
        bytes.map_err(|reason| SinkError::Mcap {
            path: PathBuf::new(),
            reason,
        })
    }

    /// Starts the recording of `scenario` in a draft, with the channels that `telemetry` wants.
    ///
    /// # Errors
    /// [`SinkError`] if the file can't be written.
    pub fn create_in(
        mut draft: Draft,
        scenario: &Scenario,
        telemetry: &Telemetry,
        form: Form,
    ) -> Result<Self, SinkError> {
        draft.keep();
        let name = draft.working_name().to_owned();
        let opening = Opening::new(scenario, telemetry, form);
        let file = BufWriter::with_capacity(64 * 1024, draft);
        Pipeline::start(file, name, opening).map(Self)
    }

    /// Ends the recording, which still has to be published; returns the content digest too.
    ///
    /// # Errors
    /// [`SinkError`] if anything could not be written; the partial file is kept.
    pub fn complete(self, end: &RunEnd) -> Result<(Draft, String), SinkError> {
        let name = self.0.worker.name.clone();
        let (file, digest) = self.0.finish(end)?;
        let draft = file.into_inner().map_err(|error| SinkError::Io {
            action: "write",
            path: name,
            reason: error.into_error(),
        })?;
        Ok((draft, digest))
    }

    /// Ends the recording and gives the file its name.
    ///
    /// # Errors
    /// As [`Self::complete`] and [`Draft::publish`].
    pub fn finish(self, end: &RunEnd) -> Result<Archived, SinkError> {
        let (draft, digest) = self.complete(end)?;
        let path = draft.path().to_owned();
        let bytes = draft.publish()?;
        Ok(Archived {
            path,
            bytes,
            digest,
        })
    }
}

impl Sink for McapSink {
    fn write(&mut self, message: &Message<'_>) -> Result<(), SinkError> {
        self.0.write(message)
    }

    fn flush(&mut self) -> Result<(), SinkError> {
        self.0.flush()
    }
}
