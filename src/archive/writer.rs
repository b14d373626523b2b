//! The archive: a run as an MCAP file.
//!
//! [`crate::archive::format`] says what stands in the file, and in which order.
//!
//! Messages are encoded on the caller's thread; another takes their digest, compresses and writes them, one
//! after the other: the bytes are those of a single thread.

use crate::archive::format::{
    CONTENT_DIGEST, END_RECORD, Entries, LIBRARY, RUN_RECORD, end_entries, form_entries,
    run_entries, scenario_attachment,
};
use crate::archive::publish::{Draft, Existing};
use crate::archive::sink::{Sink, SinkError};
use crate::run::scenario::Scenario;
use crate::run::simulation::RunEnd;
use crate::telemetry::digest::{ContentDigest, append_content};
use crate::telemetry::encoding::{Encoder, Encoding};
use crate::telemetry::views::{Views, view_channels};
use crate::telemetry::{Message, Telemetry, Topic, Version};
use ::mcap::records::{MessageHeader, Metadata};
use ::mcap::write::NoSeek;
use ::mcap::{Attachment, Compression, McapError, WriteOptions, Writer};
use std::io::{BufWriter, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::thread::{self, JoinHandle};

/// What is lost at most when the process is killed, uncompressed.
const CHUNK_SIZE: u64 = 256 * 1024;
/// Encoded messages travel to the writing thread in batches of about this size.
const BATCH_BYTES: usize = 128 * 1024;
/// Number of batches that may wait for the writing thread, which bounds the memory.
const BATCHES: usize = 8;

type FileWriter = Writer<NoSeek<BufWriter<Draft>>>;

/// How a run is recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Form {
    /// The encoding of the table's channels.
    pub encoding: Encoding,
    /// Whether the channels for viewers are written too.
    pub views: bool,
}

impl Default for Form {
    /// JSON, with views.
    fn default() -> Self {
        Self {
            encoding: Encoding::Json,
            views: true,
        }
    }
}

/// What a recording begins with.
#[derive(Debug)]
pub struct Opening {
    /// The name and version of the program that writes the file: [`LIBRARY`] for a recording of toprise.
    pub library: &'static str,
    /// Metadata records: names and entries.
    pub metadata: Vec<(String, Entries)>,
    /// Attachments.
    pub attachments: Vec<Attachment<'static>>,
    /// The version of the telemetry of the table's channels.
    pub version: Version,
    /// The encoding of the table's channels.
    pub encoding: Encoding,
    /// Which of the table's channels there will be.
    pub wanted: Vec<bool>,
    /// Channels whose messages come ready encoded, and are not part of the content.
    pub raw: Vec<RawChannel>,
}

/// A channel whose messages come ready encoded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RawChannel {
    /// Topic.
    pub topic: String,
    /// Encoding of the messages.
    pub encoding: String,
    /// Name, encoding and data of the schema, if there is one.
    pub schema: Option<(String, String, Vec<u8>)>,
    /// What there is to say beside that.
    pub metadata: Entries,
}

/// A message of a raw channel.
#[derive(Clone, Copy, Debug)]
pub struct RawMessage<'a> {
    /// Index in [`Opening::raw`].
    pub channel: usize,
    /// Sequence number.
    pub sequence: u32,
    /// Time of logging, ns.
    pub log_time: u64,
    /// Time of publishing, ns.
    pub publish_time: u64,
    /// The message.
    pub data: &'a [u8],
}

/// What a recording ends with.
#[derive(Clone, Debug, Default)]
pub struct Ending {
    /// Metadata records before the last: names and entries.
    pub metadata: Vec<(String, Entries)>,
    /// The entries of `toprise.end`, the last; the content digest is added.
    pub end: Option<Entries>,
    /// The content digest that must come out, if that is known.
    pub digest: Option<String>,
}

/// Writes an MCAP file.
#[derive(Debug)]
pub struct McapSink {
    version: Version,
    encoder: Encoder,
    /// MCAP ids of the table's channels; 0 for those that are not logged.
    channel_ids: Vec<u16>,
    /// MCAP ids of the raw channels.
    raw_ids: Vec<u16>,
    /// The views, and where each of them stands among the raw channels.
    views: Option<(Views, Vec<usize>)>,
    batch: Batch,
    worker: Worker,
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
    /// Their encoded bytes, one after the other.
    data: Vec<u8>,
    /// What the digest takes in of them, likewise.
    content: Vec<u8>,
    messages: Vec<Entry>,
}

/// A message in a batch.
#[derive(Debug)]
struct Entry {
    header: MessageHeader,
    /// Its channel in the table, if it is one of them.
    channel: Option<usize>,
    /// Where its encoded bytes end.
    data_end: usize,
    /// Where its content ends.
    content_end: usize,
}

enum Job {
    Write(Batch),
    Flush,
    Finish(Box<Ending>),
}

/// The writing thread, and the way to it.
#[derive(Debug)]
struct Worker {
    /// What messages call the file.
    name: PathBuf,
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
        form: Form,
    ) -> Result<Self, SinkError> {
        let preface = Self::preface(scenario, telemetry, form)?;
        let draft = Draft::of_run(path, existing, &preface)?;
        Self::create_in(draft, scenario, telemetry, form)
    }

    /// What a draft of the run's recording holds before the first chunk is there: everything that comes before the
    /// messages, with the channels outside of chunks. So a run that is killed at once can be completed.
    ///
    /// # Errors
    /// [`SinkError`] if the channels are more than a file may have.
    pub fn preface(
        scenario: &Scenario,
        telemetry: &Telemetry,
        form: Form,
    ) -> Result<Vec<u8>, SinkError> {
        let (opening, _) = opening_of_run(scenario, telemetry, form);
        let written = options(&opening)
            .use_chunks(false)
            .create(NoSeek::new(Vec::new()))
            .and_then(|mut writer| {
                open_channels(&mut writer, &opening)?;
                Ok(writer.into_inner().into_inner())
            });
        written.map_err(|reason| SinkError::Mcap {
            path: PathBuf::new(),
            reason,
        })
    }

    /// Starts the recording of `scenario` in a draft, with the channels that `telemetry` wants.
    ///
    /// # Errors
    /// [`SinkError`] if the file can't be written.
    pub fn create_in(
        draft: Draft,
        scenario: &Scenario,
        telemetry: &Telemetry,
        form: Form,
    ) -> Result<Self, SinkError> {
        let (opening, views) = opening_of_run(scenario, telemetry, form);
        let mut sink = Self::open(draft, &opening)?;
        sink.views = views.map(|views| {
            let wanted = |view: &usize| views.wants(*view);
            let position = |view: usize| (0..view).filter(wanted).count();
            let positions = (0..view_channels().len()).map(position).collect();
            (views, positions)
        });
        Ok(sink)
    }

    /// Starts a recording that begins with `opening`, in a draft.
    ///
    /// # Errors
    /// [`SinkError`] if the file can't be written.
    pub fn open(draft: Draft, opening: &Opening) -> Result<Self, SinkError> {
        let name = draft.working_name().to_owned();
        let started = start(draft, opening).map_err(|reason| SinkError::Mcap {
            path: name.clone(),
            reason,
        })?;
        Ok(Self {
            encoder: Encoder::of(opening.encoding, opening.version.channels()),
            version: opening.version.clone(),
            channel_ids: started.channel_ids,
            raw_ids: started.raw_ids,
            views: None,
            batch: Batch::default(),
            worker: Worker::start(started.writer, name),
        })
    }

    /// Ends the recording of a run and gives the file its name.
    ///
    /// # Errors
    /// [`SinkError`] if anything could not be written; the partial file is kept.
    pub fn finish(self, end: &RunEnd) -> Result<Archived, SinkError> {
        self.finish_with(Ending {
            end: Some(end_entries(end)),
            ..Ending::default()
        })
    }

    /// Ends the recording with `ending` and gives the file its name.
    ///
    /// # Errors
    /// [`SinkError::Digest`] if the content is not what it must be, others if anything could not be
    /// written; the partial file is kept.
    pub fn finish_with(mut self, ending: Ending) -> Result<Archived, SinkError> {
        self.send_batch()?;
        self.worker.send(Job::Finish(Box::new(ending)))?;
        self.worker.join()?.ok_or_else(|| self.worker.died())
    }

    /// Writes a message of a raw channel as it is.
    ///
    /// # Errors
    /// [`SinkError`] if this message or an earlier one could not be written.
    pub fn write_raw(&mut self, message: &RawMessage<'_>) -> Result<(), SinkError> {
        push_raw(&mut self.batch, &self.raw_ids, message);
        self.send_full_batch()
    }

    fn send_full_batch(&mut self) -> Result<(), SinkError> {
        if self.batch.data.len() < BATCH_BYTES {
            return Ok(());
        }
        self.send_batch()
    }

    fn send_batch(&mut self) -> Result<(), SinkError> {
        if self.batch.messages.is_empty() {
            return Ok(());
        }
        let empty = self.worker.empty.try_recv().unwrap_or_default();
        let batch = std::mem::replace(&mut self.batch, empty);
        self.worker.send(Job::Write(batch))
    }
}

fn push_raw(batch: &mut Batch, ids: &[u16], message: &RawMessage<'_>) {
    batch.data.extend_from_slice(message.data);
    batch.messages.push(Entry {
        header: MessageHeader {
            channel_id: ids[message.channel],
            sequence: message.sequence,
            log_time: message.log_time,
            publish_time: message.publish_time,
        },
        channel: None,
        data_end: batch.data.len(),
        content_end: batch.content.len(),
    });
}

impl Sink for McapSink {
    fn write(&mut self, message: &Message<'_>) -> Result<(), SinkError> {
        let batch = &mut self.batch;
        let narrowed;
        let recorded = match self.version.is_current() {
            true => message,
            false => {
                narrowed = self.version.narrowed(message);
                &narrowed
            }
        };
        self.encoder.encode(recorded, &mut batch.data);
        append_content(recorded, &mut batch.content);
        batch.messages.push(Entry {
            header: MessageHeader {
                channel_id: self.channel_ids[message.channel],
                sequence: message.sequence,
                log_time: message.time_ns,
                publish_time: message.time_ns,
            },
            channel: Some(message.channel),
            data_end: batch.data.len(),
            content_end: batch.content.len(),
        });
        if let Some((views, positions)) = &mut self.views {
            views.take(message, |view, sequence, data| {
                let view = RawMessage {
                    channel: positions[view],
                    sequence,
                    log_time: message.time_ns,
                    publish_time: message.time_ns,
                    data,
                };
                push_raw(batch, &self.raw_ids, &view);
            });
        }
        self.send_full_batch()
    }

    fn flush(&mut self) -> Result<(), SinkError> {
        self.send_batch()?;
        self.worker.send(Job::Flush)
    }
}

impl Worker {
    fn start(writer: FileWriter, name: PathBuf) -> Self {
        let (jobs, received) = sync_channel(BATCHES);
        let (returned, empty) = channel();
        let of_thread = name.clone();
        let thread = thread::spawn(move || work(writer, of_thread, &received, &returned));
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

    /// Waits for the thread: what it has finished, or nothing if it was not asked to finish.
    fn join(&mut self) -> Result<Option<Archived>, SinkError> {
        self.jobs = None;
        let thread = self.thread.take().ok_or_else(|| self.died())?;
        thread.join().map_err(|_| self.died())?
    }

    fn died(&self) -> SinkError {
        SinkError::WriterDied {
            path: self.name.clone(),
        }
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
    name: PathBuf,
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
            Job::Finish(ending) => return finish(writer, name, *ending, digest).map(Some),
        };
        if let Err(reason) = done {
            abandon(writer);
            return Err(SinkError::Mcap { path: name, reason });
        }
    }
    let _ = writer.flush();
    abandon(writer);
    Ok(None)
}

/// Completes and publishes the file, unless it holds other content than it must.
fn finish(
    mut writer: FileWriter,
    name: PathBuf,
    ending: Ending,
    digest: ContentDigest,
) -> Result<Archived, SinkError> {
    let found = digest.finish();
    let expected = ending.digest.clone();
    if let Some(expected) = expected.filter(|expected| *expected != found) {
        abandon(writer);
        return Err(SinkError::Digest {
            path: name,
            expected,
            found,
        });
    }
    if let Err(reason) = end(&mut writer, ending, &found) {
        abandon(writer);
        return Err(SinkError::Mcap { path: name, reason });
    }
    publish(writer, name, found)
}

fn write_batch(
    writer: &mut FileWriter,
    digest: &mut ContentDigest,
    batch: &Batch,
) -> Result<(), McapError> {
    let (mut data_start, mut content_start) = (0, 0);
    for entry in &batch.messages {
        if let Some(channel) = entry.channel {
            let content = &batch.content[content_start..entry.content_end];
            digest.absorb(channel, content);
        }
        writer.write_to_known_channel(&entry.header, &batch.data[data_start..entry.data_end])?;
        (data_start, content_start) = (entry.data_end, entry.content_end);
    }
    Ok(())
}

fn end(writer: &mut FileWriter, ending: Ending, digest: &str) -> Result<(), McapError> {
    for (name, entries) in ending.metadata {
        writer.write_metadata(&metadata(&name, entries))?;
    }
    if let Some(mut end) = ending.end {
        end.insert(CONTENT_DIGEST.to_owned(), digest.to_owned());
        writer.write_metadata(&metadata(END_RECORD, end))?;
    }
    writer.finish().map(|_| ())
}

/// Lets go of a writer without completing its file, which dropping it would do.
fn abandon(writer: FileWriter) {
    let _ = writer.into_inner().into_inner().into_inner();
}

fn publish(writer: FileWriter, name: PathBuf, digest: String) -> Result<Archived, SinkError> {
    let file = writer.into_inner().into_inner().into_inner();
    let file = file.map_err(|error| SinkError::Io {
        action: "write",
        path: name,
        reason: error.into_error(),
    })?;
    let path = file.path().to_owned();
    let bytes = file.publish()?;
    Ok(Archived {
        path,
        bytes,
        digest,
    })
}

/// What the recording of a run begins with, and what makes its views.
fn opening_of_run(
    scenario: &Scenario,
    telemetry: &Telemetry,
    form: Form,
) -> (Opening, Option<Views>) {
    let support = scenario.model.support;
    let topics: Vec<_> = Topic::all_with(support)
        .filter(|topic| telemetry.wants(*topic))
        .collect();
    let wants = |topic| topics.contains(&topic);
    let views = form.views.then(|| Views::new(scenario, wants));
    let mut run = run_entries(scenario);
    run.extend(form_entries(
        form.encoding,
        form.views,
        &telemetry.topics(support),
    ));
    let opening = Opening {
        library: LIBRARY,
        metadata: vec![(RUN_RECORD.to_owned(), run)],
        attachments: vec![scenario_attachment(scenario.to_toml())],
        version: Version::default(),
        encoding: form.encoding,
        wanted: Topic::all().map(wants).collect(),
        raw: views.as_ref().map_or_else(Vec::new, raw_views),
    };
    (opening, views)
}

/// A file that has everything that comes before the messages.
struct Started {
    writer: FileWriter,
    channel_ids: Vec<u16>,
    raw_ids: Vec<u16>,
}

fn start(mut draft: Draft, opening: &Opening) -> Result<Started, McapError> {
    draft.keep();
    let file = NoSeek::new(BufWriter::with_capacity(64 * 1024, draft));
    let mut writer = options(opening).create(file)?;
    let (channel_ids, raw_ids) = open_channels(&mut writer, opening)?;
    Ok(Started {
        writer,
        channel_ids,
        raw_ids,
    })
}

fn options(opening: &Opening) -> WriteOptions {
    WriteOptions::new()
        .compression(Some(Compression::Zstd))
        .compression_level(1)
        .compression_threads(0)
        .chunk_size(Some(CHUNK_SIZE))
        .disable_seeking(true)
        .profile("")
        .library(opening.library)
}

/// Writes everything that comes before the messages; gives the ids of the table's channels and of the raw ones.
fn open_channels<W: Write + Seek>(
    writer: &mut Writer<W>,
    opening: &Opening,
) -> Result<(Vec<u16>, Vec<u16>), McapError> {
    for (name, entries) in &opening.metadata {
        writer.write_metadata(&metadata(name, entries.clone()))?;
    }
    for attachment in &opening.attachments {
        writer.attach(attachment)?;
    }
    let channels = opening.version.channels();
    let mut channel_ids = Vec::with_capacity(channels.len());
    let encoding = opening.encoding;
    for (channel, wanted) in channels.iter().zip(&opening.wanted) {
        channel_ids.push(if *wanted {
            let schema = encoding.schema(channel);
            let schema = writer.add_schema(channel.schema, encoding.schema_encoding(), &schema)?;
            writer.add_channel(schema, channel.topic, encoding.name(), &Entries::new())?
        } else {
            0
        });
    }
    let mut raw_ids = Vec::with_capacity(opening.raw.len());
    for raw in &opening.raw {
        let schema = match &raw.schema {
            Some((name, encoding, data)) => writer.add_schema(name, encoding, data)?,
            None => 0,
        };
        raw_ids.push(writer.add_channel(schema, &raw.topic, &raw.encoding, &raw.metadata)?);
    }
    Ok((channel_ids, raw_ids))
}

/// The channels for viewers, as raw channels.
fn raw_views(views: &Views) -> Vec<RawChannel> {
    let wanted = view_channels().iter().enumerate();
    let wanted = wanted.filter(|(index, _)| views.wants(*index));
    wanted
        .map(|(_, view)| RawChannel {
            topic: view.topic.to_owned(),
            encoding: "cdr".to_owned(),
            schema: Some((
                view.schema.to_owned(),
                "ros2msg".to_owned(),
                view.definition.as_bytes().to_vec(),
            )),
            metadata: Entries::new(),
        })
        .collect()
}

fn metadata(name: &str, entries: Entries) -> Metadata {
    Metadata {
        name: name.to_owned(),
        metadata: entries,
    }
}
