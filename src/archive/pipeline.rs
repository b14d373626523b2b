//! Two-threaded MCAP writing: the caller encodes messages; a worker thread hashes, compresses and writes them in order.
//! WebAssembly has no threads: there the caller writes, too.
//! The bytes equal those of [`crate::archive::writer::McapWriter`].

use crate::archive::format::end_entries;
use crate::archive::publish::{Draft, Existing};
use crate::archive::sink::{Sink, SinkError};
use crate::archive::supplements::Supplements;
use crate::archive::writer::{Batch, ChunkWriter, Form, Header, RunEncoder};
use crate::run::scenario::Scenario;
use crate::run::simulation::RunEnd;
use crate::telemetry::{Message, Telemetry};
use ::mcap::{McapError, McapResult};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{self, JoinHandle};

/// Approximate size of a batch of encoded messages.
const BATCH_BYTES: usize = 128 * 1024;
/// Maximum number of queued batches; bounds memory use.
const BATCHES: usize = 8;

/// A recording that is written, in a target.
#[derive(Debug)]
pub struct Ended<T> {
    /// What it was written to.
    pub target: T,
    /// The digest of its content.
    pub content_digest: String,
    /// Whether it has all supplements that it was to have; some of a damaged recording may be lost.
    pub has_all_supplements: bool,
}

impl<T> Ended<T> {
    /// The same recording in what `map` makes of its target.
    pub(crate) fn try_map<U, E>(self, map: impl FnOnce(T) -> Result<U, E>) -> Result<Ended<U>, E> {
        Ok(Ended {
            target: map(self.target)?,
            content_digest: self.content_digest,
            has_all_supplements: self.has_all_supplements,
        })
    }
}

/// Writes a run as MCAP with two threads.
#[derive(Debug)]
pub struct Pipeline<W: Write> {
    /// Name of the file in error messages.
    name: PathBuf,
    encoder: RunEncoder,
    /// Taken when the thread is joined.
    target: Option<Target<W>>,
}

/// Where batches are written.
#[derive(Debug)]
enum Target<W: Write> {
    /// By a thread, over a channel.
    Thread(SyncSender<Batch>, JoinHandle<McapResult<ChunkWriter<W>>>),
    /// By the caller.
    Here(Box<ChunkWriter<W>>),
}

impl<W: Write + Send + 'static> Pipeline<W> {
    /// Starts a recording in `target`; `name` is used in errors.
    pub(crate) fn start(target: W, name: PathBuf, header: &Header) -> Result<Self, SinkError> {
        let (chunks, ids) =
            ChunkWriter::open(target, header).map_err(|reason| mcap_error(&name, reason))?;
        let target = if cfg!(target_family = "wasm") {
            Target::Here(Box::new(chunks))
        } else {
            let (batches, received) = sync_channel(BATCHES);
            Target::Thread(batches, thread::spawn(move || work(chunks, &received)))
        };
        Ok(Self {
            name,
            encoder: RunEncoder::new(header, &ids),
            target: Some(target),
        })
    }

    /// Ends the recording.
    pub(crate) fn end(
        mut self,
        end: &RunEnd,
        supplements: &Supplements<'_>,
    ) -> Result<Ended<W>, SinkError> {
        self.send_batch()?;
        let ended = finish(self.join()?, end, supplements);
        ended.map_err(|reason| mcap_error(&self.name, reason))
    }

    fn send_batch(&mut self) -> Result<(), SinkError> {
        // The thread keeps the buffers: a new batch is cheaper than a channel that returns them.
        let batch = std::mem::take(&mut self.encoder.batch);
        match &mut self.target {
            Some(Target::Here(chunks)) => {
                let written = chunks.write(&batch);
                written.map_err(|reason| mcap_error(&self.name, reason))
            }
            Some(Target::Thread(batches, _)) if batches.send(batch).is_ok() => Ok(()),
            // The channel is closed early only if the thread has failed.
            Some(Target::Thread(..)) | None => {
                self.join()?;
                Err(self.died())
            }
        }
    }
}

impl<W: Write> Pipeline<W> {
    /// Waits until the thread has written everything.
    fn join(&mut self) -> Result<ChunkWriter<W>, SinkError> {
        let (batches, thread) = match self.target.take().ok_or_else(|| self.died())? {
            Target::Here(chunks) => return Ok(*chunks),
            Target::Thread(batches, thread) => (batches, thread),
        };
        // Ends the thread.
        drop(batches);
        let chunks = thread.join().map_err(|_| self.died())?;
        chunks.map_err(|reason| mcap_error(&self.name, reason))
    }

    fn died(&self) -> SinkError {
        SinkError::WriterDied {
            path: self.name.clone(),
        }
    }
}

impl<W: Write> Drop for Pipeline<W> {
    /// Keeps the partial file of an unfinished recording.
    fn drop(&mut self) {
        if let Ok(mut chunks) = self.join() {
            let _ = chunks.flush();
        }
    }
}

/// Writes what follows the last message.
fn finish<W: Write>(
    mut chunks: ChunkWriter<W>,
    end: &RunEnd,
    supplements: &Supplements<'_>,
) -> McapResult<Ended<W>> {
    let has_all_supplements = supplements.write(chunks.writer()?)?;
    let (target, content_digest) = chunks.finish(end_entries(end))?;
    Ok(Ended {
        target,
        content_digest,
        has_all_supplements,
    })
}

/// The writer thread.
fn work<W: Write>(
    mut chunks: ChunkWriter<W>,
    batches: &Receiver<Batch>,
) -> McapResult<ChunkWriter<W>> {
    for batch in batches {
        chunks.write(&batch)?;
    }
    Ok(chunks)
}

fn mcap_error(path: &Path, reason: McapError) -> SinkError {
    SinkError::Mcap {
        path: path.to_owned(),
        reason,
    }
}

impl<W: Write + Send + 'static> Sink for Pipeline<W> {
    fn write(&mut self, message: &Message<'_>) -> Result<(), SinkError> {
        self.encoder.encode(message);
        if self.encoder.batch.len() < BATCH_BYTES {
            return Ok(());
        }
        self.send_batch()
    }

    /// Sends the pending batch. Does not end a chunk, so that flushing doesn't change the bytes.
    fn flush(&mut self) -> Result<(), SinkError> {
        self.send_batch()
    }
}

/// A finished file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Archived {
    /// Path of the file.
    pub path: PathBuf,
    /// Size of the file, bytes.
    pub bytes: u64,
    /// Content digest, as in [`END_RECORD`](crate::archive::format::END_RECORD).
    pub digest: String,
}

/// Writes a recording to a draft file, which is renamed when complete.
#[derive(Debug)]
pub struct McapSink {
    pipeline: Pipeline<BufWriter<File>>,
    /// Dropped after the pipeline, which still writes what it has.
    draft: Draft,
}

impl McapSink {
    /// Starts the recording of `scenario` with the channels enabled in `telemetry`.
    ///
    /// # Errors
    /// [`SinkError`] if the file can't be created or written.
    pub fn create(
        path: &Path,
        existing: Existing,
        scenario: &Scenario,
        telemetry: &Telemetry,
        form: Form,
    ) -> Result<Self, SinkError> {
        let header = Header::new(scenario, telemetry, form);
        let mut sink = Self::open(Draft::new(path, existing)?, &header)?;
        sink.keep();
        Ok(sink)
    }

    /// Starts a recording in a draft. The file gets its partial name when the header is written, so whatever has that
    /// name can be repeated.
    ///
    /// # Errors
    /// [`SinkError`] if the file can't be written, or its name is taken.
    pub fn open(draft: Draft, header: &Header) -> Result<Self, SinkError> {
        // Compressed chunks are written in one piece; this collects the small records between them.
        let file = BufWriter::with_capacity(64 * 1024, draft.file()?);
        let mut pipeline = Pipeline::start(file, draft.path().to_owned(), header)?;
        let draft = draft.make_partial()?;
        draft.working_name().clone_into(&mut pipeline.name);
        Ok(Self { pipeline, draft })
    }

    /// The name that the file will have.
    pub fn path(&self) -> &Path {
        self.draft.path()
    }

    /// Keeps the partial file from now on, even if the recording is not finished.
    pub fn keep(&mut self) {
        self.draft.keep();
    }

    /// Finishes the recording without publishing it. Returns the draft and the content digest.
    ///
    /// # Errors
    /// [`SinkError`] if anything could not be written; the partial file is kept.
    pub fn complete(self, end: &RunEnd) -> Result<(Draft, String), SinkError> {
        let ended = self.complete_with(end, &Supplements::default())?;
        Ok((ended.target, ended.content_digest))
    }

    /// As [`Self::complete`], with supplements before the end record.
    ///
    /// # Errors
    /// As [`Self::complete`].
    pub fn complete_with(
        self,
        end: &RunEnd,
        supplements: &Supplements<'_>,
    ) -> Result<Ended<Draft>, SinkError> {
        let Self { pipeline, draft } = self;
        let ended = pipeline.end(end, supplements)?;
        ended.try_map(|file| match file.into_inner() {
            Ok(_) => Ok(draft),
            Err(error) => Err(SinkError::Io {
                action: "write",
                path: draft.working_name().to_owned(),
                reason: error.into_error(),
            }),
        })
    }

    /// Finishes and publishes the recording.
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
        self.pipeline.write(message)
    }

    fn flush(&mut self) -> Result<(), SinkError> {
        self.pipeline.flush()
    }
}
