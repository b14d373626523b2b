//! The archive: a run as an MCAP file.
//!
//! Order in the file: the metadata record `toprise.run` and the scenario as an attachment; the schemas
//! and channels; the messages; the metadata record `toprise.end`. A file without the last was
//! interrupted. Nothing in it depends on when or where it was made.
//!
//! Messages are encoded on the caller's thread; another takes their digest, compresses and writes them, one
//! after the other: the bytes are those of a single thread.

use super::publish::{Existing, Place};
use super::{Sink, SinkError};
use crate::scenario::Scenario;
use crate::simulation::Outcome;
use crate::telemetry::digest::{ContentDigest, append_content};
use crate::telemetry::json::JsonEncoder;
use crate::telemetry::schema::json_schema;
use crate::telemetry::{Message, Telemetry, channels};
use ::mcap::records::{MessageHeader, Metadata};
use ::mcap::write::NoSeek;
use ::mcap::{Attachment, Compression, McapError, WriteOptions, Writer};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::thread::{self, JoinHandle};

/// Name of the metadata record at the start.
pub const RUN_RECORD: &str = "toprise.run";
/// Name of the metadata record at the end.
pub const END_RECORD: &str = "toprise.end";
/// Name of the attachment that holds the scenario.
pub const SCENARIO_ATTACHMENT: &str = "scenario.toml";

/// What is lost at most when the process is killed, uncompressed.
const CHUNK_SIZE: u64 = 256 * 1024;
/// Encoded messages travel to the writing thread in batches of about this size.
const BATCH_BYTES: usize = 128 * 1024;
/// So many batches may wait for the writing thread: it bounds the memory.
const BATCHES: usize = 8;

type FileWriter = Writer<NoSeek<BufWriter<File>>>;

/// Writes an MCAP file.
#[derive(Debug)]
pub struct McapSink {
    encoder: JsonEncoder,
    /// MCAP channel ids; 0 for channels that are not logged.
    channel_ids: Vec<u16>,
    batch: Batch,
    worker: Worker,
    place: Place,
}

/// A finished file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Archived {
    /// Where it is.
    pub path: PathBuf,
    /// Its size.
    pub bytes: u64,
    /// Digest of its content.
    pub digest: String,
}

/// Encoded messages on their way to the writing thread.
#[derive(Debug, Default)]
struct Batch {
    /// Their JSON, one after the other.
    data: Vec<u8>,
    /// What the digest takes in of them, likewise.
    content: Vec<u8>,
    messages: Vec<Entry>,
}

/// A message in a batch.
#[derive(Debug)]
struct Entry {
    header: MessageHeader,
    /// Its channel in the table.
    channel: usize,
    /// Where its JSON ends.
    data_end: usize,
    /// Where its content ends.
    content_end: usize,
}

enum Job {
    Write(Batch),
    Flush,
    Finish(Box<Outcome>),
}

/// The writing thread, and the way to it.
#[derive(Debug)]
struct Worker {
    jobs: Option<SyncSender<Job>>,
    /// Batches come back empty, to be filled again.
    empty: Receiver<Batch>,
    thread: Option<JoinHandle<Result<Option<Archived>, SinkError>>>,
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
    ) -> Result<Self, SinkError> {
        let (place, file) = Place::reserve(path, existing)?;
        let (writer, channel_ids) = start(file, scenario, telemetry).map_err(|reason| {
            place.withdraw();
            SinkError::Mcap {
                path: place.partial(),
                reason,
            }
        })?;
        Ok(Self {
            encoder: JsonEncoder::default(),
            channel_ids,
            batch: Batch::default(),
            worker: Worker::start(writer, place.clone()),
            place,
        })
    }

    /// Ends the recording with its end record and gives the file its name.
    ///
    /// # Errors
    /// [`SinkError`] if anything could not be written; the partial file is kept.
    pub fn finish(mut self, outcome: &Outcome) -> Result<Archived, SinkError> {
        self.send_batch()?;
        let path = self.place.path();
        self.worker.send(Job::Finish(Box::new(*outcome)), path)?;
        self.worker.join(path)?.ok_or_else(|| died(path))
    }

    /// Gives up a recording that has not begun, and removes its file.
    pub fn discard(self) {
        let place = self.place.clone();
        drop(self);
        place.withdraw();
    }

    fn send_batch(&mut self) -> Result<(), SinkError> {
        if self.batch.messages.is_empty() {
            return Ok(());
        }
        let empty = self.worker.empty.try_recv().unwrap_or_default();
        let batch = std::mem::replace(&mut self.batch, empty);
        self.worker.send(Job::Write(batch), self.place.path())
    }
}

impl Sink for McapSink {
    fn write(&mut self, message: &Message<'_>) -> Result<(), SinkError> {
        let batch = &mut self.batch;
        self.encoder.encode(message, &mut batch.data);
        append_content(message, &mut batch.content);
        batch.messages.push(Entry {
            header: MessageHeader {
                channel_id: self.channel_ids[message.channel],
                sequence: message.sequence,
                log_time: message.time_ns,
                publish_time: message.time_ns,
            },
            channel: message.channel,
            data_end: batch.data.len(),
            content_end: batch.content.len(),
        });
        if self.batch.data.len() < BATCH_BYTES {
            return Ok(());
        }
        self.send_batch()
    }

    fn flush(&mut self) -> Result<(), SinkError> {
        self.send_batch()?;
        self.worker.send(Job::Flush, self.place.path())
    }
}

impl Worker {
    fn start(writer: FileWriter, place: Place) -> Self {
        let (jobs, received) = sync_channel(BATCHES);
        let (returned, empty) = channel();
        let thread = thread::spawn(move || work(writer, &place, &received, &returned));
        Self {
            jobs: Some(jobs),
            empty,
            thread: Some(thread),
        }
    }

    fn send(&mut self, job: Job, path: &Path) -> Result<(), SinkError> {
        let sent = self
            .jobs
            .as_ref()
            .is_some_and(|jobs| jobs.send(job).is_ok());
        if sent {
            return Ok(());
        }
        // The thread only goes away before the end when it has failed.
        self.join(path)?;
        Err(died(path))
    }

    /// Waits for the thread: what it has finished, or nothing if it was not asked to finish.
    fn join(&mut self, path: &Path) -> Result<Option<Archived>, SinkError> {
        self.jobs = None;
        let thread = self.thread.take().ok_or_else(|| died(path))?;
        thread.join().map_err(|_| died(path))?
    }
}

fn died(path: &Path) -> SinkError {
    SinkError::WriterDied {
        path: path.to_owned(),
    }
}

impl Drop for Worker {
    /// A recording that was not finished keeps what it has: the thread writes out what it was given
    /// and leaves the partial file.
    fn drop(&mut self) {
        self.jobs = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// The writing thread: returns the finished file, or nothing if it was abandoned.
fn work(
    mut writer: FileWriter,
    place: &Place,
    jobs: &Receiver<Job>,
    returned: &Sender<Batch>,
) -> Result<Option<Archived>, SinkError> {
    let mut digest = ContentDigest::default();
    for job in jobs {
        let done = match job {
            Job::Write(mut batch) => {
                let written = write_batch(&mut writer, &mut digest, &batch);
                batch.data.clear();
                batch.content.clear();
                batch.messages.clear();
                // Nobody waits for it once the sink is gone.
                let _ = returned.send(batch);
                written
            }
            Job::Flush => writer.flush(),
            Job::Finish(outcome) => {
                let digest = digest.finish();
                match end(&mut writer, &outcome, &digest) {
                    Ok(()) => return publish(writer, place, digest).map(Some),
                    Err(error) => Err(error),
                }
            }
        };
        if let Err(reason) = done {
            abandon(writer);
            return Err(SinkError::Mcap {
                path: place.partial(),
                reason,
            });
        }
    }
    let _ = writer.flush();
    abandon(writer);
    Ok(None)
}

fn write_batch(
    writer: &mut FileWriter,
    digest: &mut ContentDigest,
    batch: &Batch,
) -> Result<(), McapError> {
    let (mut data_start, mut content_start) = (0, 0);
    for entry in &batch.messages {
        digest.absorb(
            entry.channel,
            &batch.content[content_start..entry.content_end],
        );
        writer.write_to_known_channel(&entry.header, &batch.data[data_start..entry.data_end])?;
        (data_start, content_start) = (entry.data_end, entry.content_end);
    }
    Ok(())
}

fn end(writer: &mut FileWriter, outcome: &Outcome, digest: &str) -> Result<(), McapError> {
    writer.write_metadata(&end_record(outcome, digest))?;
    writer.finish().map(|_| ())
}

/// Lets go of a writer without completing its file, which dropping it would do.
fn abandon(writer: FileWriter) {
    let _ = writer.into_inner().into_inner().into_inner();
}

fn publish(writer: FileWriter, place: &Place, digest: String) -> Result<Archived, SinkError> {
    let partial = |reason: io::Error| SinkError::Io {
        action: "write",
        path: place.partial(),
        reason,
    };
    let file = writer
        .into_inner()
        .into_inner()
        .into_inner()
        .map_err(|error| partial(error.into_error()))?;
    let bytes = file.metadata().map_err(partial)?.len();
    place.publish(&file)?;
    Ok(Archived {
        path: place.path().to_owned(),
        bytes,
        digest,
    })
}

/// Writes everything that comes before the messages.
fn start(
    file: File,
    scenario: &Scenario,
    telemetry: &Telemetry,
) -> Result<(FileWriter, Vec<u16>), McapError> {
    let file = NoSeek::new(BufWriter::with_capacity(64 * 1024, file));
    let mut writer = WriteOptions::new()
        .compression(Some(Compression::Zstd))
        .compression_level(1)
        .compression_threads(0)
        .chunk_size(Some(CHUNK_SIZE))
        .disable_seeking(true)
        .profile("")
        .library(concat!("toprise/", env!("CARGO_PKG_VERSION")))
        .create(file)?;
    writer.write_metadata(&run_record(scenario))?;
    writer.attach(&Attachment {
        log_time: 0,
        create_time: 0,
        name: SCENARIO_ATTACHMENT.to_owned(),
        media_type: "application/toml".to_owned(),
        data: scenario.to_toml().into_bytes().into(),
    })?;
    let mut channel_ids = Vec::with_capacity(channels().len());
    for (index, channel) in channels().iter().enumerate() {
        channel_ids.push(if telemetry.wants(index) {
            let schema = json_schema(channel);
            let schema = writer.add_schema(channel.schema, "jsonschema", schema.as_bytes())?;
            writer.add_channel(schema, channel.topic, "json", &BTreeMap::new())?
        } else {
            0
        });
    }
    Ok((writer, channel_ids))
}

fn run_record(scenario: &Scenario) -> Metadata {
    metadata(
        RUN_RECORD,
        [
            ("version", env!("CARGO_PKG_VERSION").to_owned()),
            ("scenario", scenario.name().to_owned()),
            ("scenario_digest", scenario.digest()),
            ("formulation", scenario.word("formulation").to_owned()),
            ("friction_law", scenario.word("friction.law").to_owned()),
            ("sample_period_ns", scenario.sample_period_ns.to_string()),
            ("epoch", "simulation start".to_owned()),
        ],
    )
}

fn end_record(outcome: &Outcome, digest: &str) -> Metadata {
    let statistics = &outcome.statistics;
    metadata(
        END_RECORD,
        [
            ("stop_reason", outcome.stop.name().to_owned()),
            ("stop_time", format!("{:?}", outcome.time)),
            ("samples", outcome.samples.to_string()),
            ("events", outcome.events.to_string()),
            ("nutations", outcome.nutations.to_string()),
            ("content_digest", digest.to_owned()),
            ("steps_accepted", statistics.accepted.to_string()),
            ("steps_rejected", statistics.rejected.to_string()),
            ("evaluations", statistics.evaluations.to_string()),
            ("smallest_step", format!("{:?}", statistics.smallest_step)),
            ("largest_step", format!("{:?}", statistics.largest_step)),
        ],
    )
}

fn metadata<const N: usize>(name: &str, entries: [(&str, String); N]) -> Metadata {
    Metadata {
        name: name.to_owned(),
        metadata: entries
            .into_iter()
            .map(|(key, value)| (key.to_owned(), value))
            .collect(),
    }
}
