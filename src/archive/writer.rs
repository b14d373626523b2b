//! MCAP writer of a run, for any `io::Write`.
//!
//! [`crate::archive::format`] lists the records of such a file in their order. [`McapWriter`] is single-threaded;
//! [`crate::archive::pipeline`] writes the same bytes with two threads.

pub use crate::archive::format::Form;

use crate::archive::format::{
    CONTENT_DIGEST, END_RECORD, Entries, LIBRARY, RUN_RECORD, form_entries, run_entries,
    scenario_attachment,
};
use crate::run::scenario::Scenario;
use crate::telemetry::digest::{ContentDigest, append_content};
use crate::telemetry::encoding::{Encoder, Encoding};
use crate::telemetry::supplement::{Supplement, SupplementaryAttachment};
use crate::telemetry::views::{VIEW_CHANNELS, Views};
use crate::telemetry::{Message, Telemetry, Topic};
use ::mcap::records::{MessageHeader, Metadata};
use ::mcap::write::NoSeek;
use ::mcap::{Attachment, Compression, McapError, McapResult, WriteOptions, Writer};
use std::fmt;
use std::io::{Seek, Write};

/// Uncompressed chunk size, bytes.
const CHUNK_SIZE: u64 = 256 * 1024;

/// Everything in the recording of a run before its messages.
#[derive(Debug)]
pub struct Header {
    /// The entries of [`RUN_RECORD`].
    pub(crate) run: Entries,
    /// The scenario.
    pub(crate) scenario: Attachment<'static>,
    /// The channels, in the order of their ids.
    pub(crate) channels: Vec<RegisteredChannel>,
    encoding: Encoding,
    views: Option<Views>,
}

/// A channel as a recording declares it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct RegisteredChannel {
    pub(crate) topic: &'static str,
    pub(crate) encoding: &'static str,
    pub(crate) schema_name: &'static str,
    pub(crate) schema_encoding: &'static str,
    pub(crate) schema: Vec<u8>,
}

impl Header {
    /// For the run of `scenario` with the topics enabled in `telemetry`.
    pub fn new(scenario: &Scenario, telemetry: &Telemetry, form: Form) -> Self {
        let support = scenario.model.support;
        let topics = Topic::all_with(support).filter(|topic| telemetry.is_enabled(*topic));
        let views = form
            .views
            .then(|| Views::new(scenario, |topic| telemetry.is_enabled(topic)));
        let mut channels: Vec<_> = topics
            .map(|t| RegisteredChannel::table(t, form.encoding))
            .collect();
        channels.extend(views.iter().flat_map(RegisteredChannel::views));
        let mut run = run_entries(scenario);
        run.extend(form_entries(form, &telemetry.topics(support)));
        Self {
            run,
            scenario: scenario_attachment(scenario.to_toml()),
            channels,
            encoding: form.encoding,
            views,
        }
    }

    /// The id of a topic's channel, given those of all channels; 0 if it is not recorded.
    fn id_of(&self, topic: &str, ids: &[u16]) -> u16 {
        self.channels
            .iter()
            .zip(ids)
            .find(|(channel, _)| channel.topic == topic)
            .map_or(0, |(_, id)| *id)
    }

    /// Writes the header and returns the ids of the channels.
    fn write<W: Write + Seek>(&self, writer: &mut Writer<W>) -> McapResult<Vec<u16>> {
        writer.write_metadata(&metadata(RUN_RECORD, self.run.clone()))?;
        writer.attach(&self.scenario)?;
        // A killed run can be repeated from here on. No chunk has begun, so this doesn't change the bytes.
        writer.flush()?;
        let mut ids = Vec::with_capacity(self.channels.len());
        for channel in &self.channels {
            ids.push(channel.register(writer)?);
        }
        Ok(ids)
    }
}

impl RegisteredChannel {
    fn table(topic: Topic, encoding: Encoding) -> Self {
        let info = topic.info();
        Self {
            topic: info.topic,
            encoding: encoding.name(),
            schema_name: info.schema,
            schema_encoding: encoding.schema_encoding(),
            schema: encoding.schema(info),
        }
    }

    pub(crate) fn supplement(supplement: &Supplement) -> Self {
        let encoding = Encoding::Json;
        Self {
            topic: supplement.info.topic,
            encoding: encoding.name(),
            schema_name: supplement.info.schema,
            schema_encoding: encoding.schema_encoding(),
            schema: encoding.schema(&supplement.info),
        }
    }

    /// Declares the channel in a file and returns its id.
    fn register<W: Write + Seek>(&self, writer: &mut Writer<W>) -> McapResult<u16> {
        let schema = writer.add_schema(self.schema_name, self.schema_encoding, &self.schema)?;
        writer.add_channel(schema, self.topic, self.encoding, &Entries::new())
    }

    fn views(views: &Views) -> impl Iterator<Item = Self> {
        VIEW_CHANNELS
            .iter()
            .enumerate()
            .filter(|(index, _)| views.is_enabled(*index))
            .map(|(_, view)| Self {
                topic: view.topic,
                encoding: "cdr",
                schema_name: view.schema,
                schema_encoding: "ros2msg",
                schema: view.definition.as_bytes().to_vec(),
            })
    }
}

/// Encodes the messages of a run, each followed by its views.
#[derive(Debug)]
pub(crate) struct RunEncoder {
    encoder: Encoder,
    views: Option<Views>,
    /// The id of each channel of the table; 0 for those that are not recorded.
    table_ids: Vec<u16>,
    /// The id of each view, likewise.
    view_ids: Vec<u16>,
    /// The messages that have been encoded.
    pub(crate) batch: Batch,
}

impl RunEncoder {
    /// `ids` are those of the header's channels.
    pub(crate) fn new(header: &Header, ids: &[u16]) -> Self {
        Self {
            encoder: Encoder::new(header.encoding),
            table_ids: Topic::all()
                .map(|topic| header.id_of(topic.name(), ids))
                .collect(),
            view_ids: VIEW_CHANNELS
                .iter()
                .map(|view| header.id_of(view.topic, ids))
                .collect(),
            views: header.views.clone(),
            batch: Batch::default(),
        }
    }

    /// Appends a message and its views to the batch.
    pub(crate) fn encode(&mut self, message: &Message<'_>) {
        let batch = &mut self.batch;
        self.encoder.encode(message, &mut batch.data);
        append_content(message, &mut batch.content);
        let channel = Some(message.channel);
        batch.end_message(self.table_ids[message.channel], channel, message);
        if let Some(views) = &mut self.views {
            views.process(message, |view, sequence, data| {
                batch.data.extend_from_slice(data);
                let head = Message {
                    sequence,
                    ..*message
                };
                batch.end_message(self.view_ids[view], None, &head);
            });
        }
    }
}

/// Encoded messages to be written to a file.
#[derive(Debug, Default)]
pub(crate) struct Batch {
    /// Their concatenated encoded bytes.
    data: Vec<u8>,
    /// Their concatenated digest input.
    content: Vec<u8>,
    messages: Vec<EncodedMessage>,
}

/// A message in a batch.
#[derive(Debug)]
struct EncodedMessage {
    header: MessageHeader,
    /// Index of the channel in the table; `None` for views.
    channel: Option<usize>,
    /// End of the encoded bytes in the batch.
    data_end: usize,
    /// End of the content in the batch.
    content_end: usize,
}

impl Batch {
    fn end_message(&mut self, channel_id: u16, channel: Option<usize>, message: &Message<'_>) {
        self.messages.push(EncodedMessage {
            header: MessageHeader {
                channel_id,
                sequence: message.sequence,
                log_time: message.time_ns,
                publish_time: message.time_ns,
            },
            channel,
            data_end: self.data.len(),
            content_end: self.content.len(),
        });
    }

    /// Size of the encoded messages, bytes.
    pub(crate) fn len(&self) -> usize {
        self.data.len()
    }

    pub(crate) fn clear(&mut self) {
        self.data.clear();
        self.content.clear();
        self.messages.clear();
    }

    /// The messages: header and encoded bytes.
    pub(crate) fn messages(&self) -> impl Iterator<Item = (&MessageHeader, &[u8])> {
        self.entries().map(|(entry, data, _)| (&entry.header, data))
    }

    /// The messages with their encoded bytes and their content.
    fn entries(&self) -> impl Iterator<Item = (&EncodedMessage, &[u8], &[u8])> {
        let (mut data_start, mut content_start) = (0, 0);
        self.messages.iter().map(move |entry| {
            let data = &self.data[data_start..entry.data_end];
            let content = &self.content[content_start..entry.content_end];
            (data_start, content_start) = (entry.data_end, entry.content_end);
            (entry, data, content)
        })
    }
}

/// Writes batches to a file in chunks. If dropped unfinished, the file stays without an end record.
pub(crate) struct ChunkWriter<W: Write> {
    /// Taken when the file is finished or abandoned: the `mcap` crate's writer completes its file on drop.
    writer: Option<Writer<NoSeek<W>>>,
    digest: ContentDigest,
}

impl<W: Write> ChunkWriter<W> {
    /// Writes the header into `target`; also returns the channel ids.
    pub(crate) fn open(target: W, header: &Header) -> McapResult<(Self, Vec<u16>)> {
        let mut chunks = Self {
            writer: Some(options().create(NoSeek::new(target))?),
            digest: ContentDigest::default(),
        };
        let ids = header.write(chunks.writer()?)?;
        Ok((chunks, ids))
    }

    /// The writer of records that are not of the run.
    pub(super) fn writer(&mut self) -> McapResult<&mut Writer<NoSeek<W>>> {
        self.writer
            .as_mut()
            .ok_or(McapError::AttemptedWriteAfterFailure)
    }

    pub(crate) fn write(&mut self, batch: &Batch) -> McapResult<()> {
        for (entry, data, content) in batch.entries() {
            if let Some(channel) = entry.channel {
                self.digest.absorb(channel, content);
            }
            self.writer()?.write_to_known_channel(&entry.header, data)?;
        }
        Ok(())
    }

    /// Closes the chunk and flushes.
    pub(crate) fn flush(&mut self) -> McapResult<()> {
        self.writer()?.flush()
    }

    /// Completes the file with these entries of [`END_RECORD`]; returns the target and the content digest.
    pub(crate) fn finish(mut self, mut end: Entries) -> McapResult<(W, String)> {
        let digest = std::mem::take(&mut self.digest).finish();
        end.insert(CONTENT_DIGEST.to_owned(), digest.clone());
        let writer = self.writer()?;
        writer.write_metadata(&metadata(END_RECORD, end))?;
        writer.finish()?;
        let target = self
            .abandon()
            .ok_or(McapError::AttemptedWriteAfterFailure)?;
        Ok((target, digest))
    }

    /// Releases the target without finishing it.
    fn abandon(&mut self) -> Option<W> {
        let writer = self.writer.take()?;
        Some(writer.into_inner().into_inner())
    }
}

impl<W: Write> Drop for ChunkWriter<W> {
    fn drop(&mut self) {
        self.abandon();
    }
}

impl<W: Write> fmt::Debug for ChunkWriter<W> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ChunkWriter").finish_non_exhaustive()
    }
}

/// Writes a run to any `Write`, on the caller's thread.
#[derive(Debug)]
pub struct McapWriter<W: Write> {
    encoder: RunEncoder,
    chunks: ChunkWriter<W>,
}

impl<W: Write> McapWriter<W> {
    /// Starts the recording of `scenario` with the topics enabled in `telemetry`.
    ///
    /// # Errors
    /// [`McapError`] if `target` fails.
    pub fn new(
        target: W,
        scenario: &Scenario,
        telemetry: &Telemetry,
        form: Form,
    ) -> McapResult<Self> {
        let header = Header::new(scenario, telemetry, form);
        let (chunks, ids) = ChunkWriter::open(target, &header)?;
        Ok(Self {
            encoder: RunEncoder::new(&header, &ids),
            chunks,
        })
    }

    /// Writes a message, and the views that come with it.
    ///
    /// # Errors
    /// [`McapError`] if the target fails.
    pub fn write(&mut self, message: &Message<'_>) -> McapResult<()> {
        self.encoder.batch.clear();
        self.encoder.encode(message);
        self.chunks.write(&self.encoder.batch)
    }

    /// Writes a channel in addition to those of the run: its messages by time in ns, with their numbers and texts.
    ///
    /// # Errors
    /// [`McapError`] if the target fails.
    pub fn write_supplement<'a>(
        &mut self,
        supplement: &Supplement,
        messages: impl IntoIterator<Item = (u64, &'a [f64], &'a [String])>,
    ) -> McapResult<()> {
        let channel = RegisteredChannel::supplement(supplement);
        let writer = self.chunks.writer()?;
        let channel_id = channel.register(writer)?;
        let mut data = Vec::new();
        for (sequence, (time_ns, numbers, texts)) in (0..).zip(messages) {
            data.clear();
            supplement.encode(time_ns, numbers, texts, &mut data);
            let header = MessageHeader {
                channel_id,
                sequence,
                log_time: time_ns,
                publish_time: time_ns,
            };
            writer.write_to_known_channel(&header, &data)?;
        }
        Ok(())
    }

    /// Attaches a file in addition to the scenario.
    ///
    /// # Errors
    /// [`McapError`] if the target fails.
    pub fn attach(&mut self, kind: SupplementaryAttachment, data: &[u8]) -> McapResult<()> {
        self.chunks.writer()?.attach(&Attachment {
            log_time: 0,
            create_time: 0,
            name: kind.name.to_owned(),
            media_type: kind.media_type.to_owned(),
            data: data.into(),
        })
    }

    /// Ends the recording with `end`, see [`crate::archive::format::end_entries`]. Returns the target and the content
    /// digest.
    ///
    /// # Errors
    /// [`McapError`] if the target fails.
    pub fn finish(self, end: Entries) -> McapResult<(W, String)> {
        self.chunks.finish(end)
    }
}

/// The options with which recordings are written.
pub(super) fn options() -> WriteOptions {
    WriteOptions::new()
        .compression(Some(Compression::Zstd))
        .compression_level(1)
        // The bytes must not depend on the number of processors.
        .compression_threads(0)
        .chunk_size(Some(CHUNK_SIZE))
        // Chunks are written when they are complete, so that any `Write` will do and a killed run leaves whole chunks.
        .disable_seeking(true)
        .profile("")
        .library(LIBRARY)
}

/// A metadata record.
pub(super) fn metadata(name: &str, metadata: Entries) -> Metadata {
    Metadata {
        name: name.to_owned(),
        metadata,
    }
}
