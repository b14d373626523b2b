//! Forgeries with recomputed checksums, indexes and digests: `verify` detects any change in what people or viewers
//! read, except the name and description of the scenario. Repacking the same content is not a forgery.

use crate::support::{archive, scenario, verified};
use mcap::records::{Record as Parsed, op};
use std::collections::BTreeMap;
use std::fs;
use std::io::Write as _;
use std::path::Path;
use toprise::analysis::verify::{Verdict, verify};
use toprise::archive::recording::{Recording, Selection};
use toprise::archive::writer::Form;
use toprise::run::scenario::Scenario;
use toprise::telemetry::digest::ContentDigest;
use toprise::telemetry::encoding::Encoding;
use toprise::telemetry::views::{ViewChannel, view_channels};

type Texts = Vec<(String, String)>;

/// A record of an MCAP file, with all fields that a forgery can change.
#[derive(Clone, Debug)]
enum Record {
    Metadata(String, Texts),
    Attachment(Attachment),
    /// Id, name, encoding, data.
    Schema(u16, String, String, Vec<u8>),
    Channel(Channel),
    Message(Message),
    Chunk(Vec<Record>),
    Other(u8, Vec<u8>),
}

#[derive(Clone, Debug)]
struct Attachment {
    log_time: u64,
    create_time: u64,
    name: String,
    media_type: String,
    data: Vec<u8>,
}

#[derive(Clone, Debug)]
struct Channel {
    id: u16,
    schema: u16,
    topic: String,
    encoding: String,
    metadata: Texts,
}

#[derive(Clone, Debug)]
struct Message {
    channel: u16,
    sequence: u32,
    log_time: u64,
    publish_time: u64,
    data: Vec<u8>,
}

/// A record as it is written: opcode and body.
type Raw = (u8, Vec<u8>);

/// A recording taken apart.
#[derive(Clone)]
pub struct Forgery {
    profile: String,
    library: String,
    /// What stands before the end of the data.
    records: Vec<Record>,
    /// Changes what the summary repeats and indexes, before its offsets are computed.
    summary: fn(&mut Vec<Raw>),
    /// Changes the order of the summary's records, which stand in groups.
    order: fn(&mut Vec<Raw>),
    /// Changes the offsets of the summary.
    offsets: fn(&mut Vec<Raw>),
    /// Where the footer says that the offsets are.
    offsets_start: fn(u64) -> u64,
    /// Changes the records behind a chunk, which index it.
    indexes: fn(&mut Vec<Raw>),
    /// Changes a record of the data before it is written.
    written: fn(&mut Raw),
    before_magic: Vec<u8>,
    before_last_magic: Vec<u8>,
    is_digest_right: bool,
}

fn text(text: &str) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes()[..], text.as_bytes()].concat()
}

fn texts(pairs: &Texts) -> Vec<u8> {
    let pairs: Vec<u8> = pairs
        .iter()
        .flat_map(|(key, value)| [text(key), text(value)].concat())
        .collect();
    [&(pairs.len() as u32).to_le_bytes()[..], &pairs].concat()
}

fn framed((opcode, body): &Raw) -> Vec<u8> {
    [&[*opcode], &(body.len() as u64).to_le_bytes()[..], body].concat()
}

impl Record {
    fn raw(&self) -> Raw {
        match self {
            Self::Metadata(name, entries) => (op::METADATA, [text(name), texts(entries)].concat()),
            Self::Attachment(attachment) => {
                let mut body = attachment.log_time.to_le_bytes().to_vec();
                body.extend(attachment.create_time.to_le_bytes());
                body.extend(text(&attachment.name));
                body.extend(text(&attachment.media_type));
                body.extend((attachment.data.len() as u64).to_le_bytes());
                body.extend(&attachment.data);
                body.extend(crc32fast::hash(&body).to_le_bytes());
                (op::ATTACHMENT, body)
            }
            Self::Schema(id, name, encoding, data) => {
                let mut body = id.to_le_bytes().to_vec();
                body.extend([text(name), text(encoding)].concat());
                body.extend((data.len() as u32).to_le_bytes());
                body.extend(data);
                (op::SCHEMA, body)
            }
            Self::Channel(channel) => {
                let mut body = channel.id.to_le_bytes().to_vec();
                body.extend(channel.schema.to_le_bytes());
                body.extend([text(&channel.topic), text(&channel.encoding)].concat());
                body.extend(texts(&channel.metadata));
                (op::CHANNEL, body)
            }
            Self::Message(message) => {
                let mut body = message.channel.to_le_bytes().to_vec();
                body.extend(message.sequence.to_le_bytes());
                body.extend(message.log_time.to_le_bytes());
                body.extend(message.publish_time.to_le_bytes());
                body.extend(&message.data);
                (op::MESSAGE, body)
            }
            Self::Chunk(records) => {
                let content: Vec<u8> = records.iter().flat_map(|r| framed(&r.raw())).collect();
                let times = |record: &Record| match record {
                    Self::Message(message) => Some(message.log_time),
                    _ => None,
                };
                let first = records.iter().filter_map(times).min().unwrap_or(0);
                let last = records.iter().filter_map(times).max().unwrap_or(0);
                let mut body = [first.to_le_bytes(), last.to_le_bytes()].concat();
                body.extend((content.len() as u64).to_le_bytes());
                body.extend(crc32fast::hash(&content).to_le_bytes());
                body.extend(text(""));
                body.extend((content.len() as u64).to_le_bytes());
                body.extend(content);
                (op::CHUNK, body)
            }
            Self::Other(opcode, body) => (*opcode, body.clone()),
        }
    }
}

/// The file while it is written.
#[derive(Default)]
struct Writing {
    bytes: Vec<u8>,
    schemas: BTreeMap<u16, Raw>,
    channels: BTreeMap<u16, Raw>,
    indexes: Vec<Raw>,
    counts: BTreeMap<u16, u64>,
    span: Option<(u64, u64)>,
    attachments: u32,
    metadata: u32,
    chunks: u32,
}

impl Writing {
    fn add(&mut self, raw: &Raw) -> (u64, u64) {
        let offset = self.bytes.len() as u64;
        self.bytes.extend(framed(raw));
        (offset, self.bytes.len() as u64 - offset)
    }

    fn data(&mut self, record: &Record, forgery: &Forgery) {
        let mut raw = record.raw();
        (forgery.written)(&mut raw);
        let (offset, length) = self.add(&raw);
        let place = [offset.to_le_bytes(), length.to_le_bytes()].concat();
        match record {
            Record::Schema(..) | Record::Channel(_) | Record::Message(_) => self.define(record),
            Record::Metadata(name, _) => {
                self.metadata += 1;
                let index = [place, text(name)].concat();
                self.indexes.push((op::METADATA_INDEX, index));
            }
            Record::Attachment(attachment) => {
                self.attachments += 1;
                let mut index = place;
                index.extend(attachment.log_time.to_le_bytes());
                index.extend(attachment.create_time.to_le_bytes());
                index.extend((attachment.data.len() as u64).to_le_bytes());
                index.extend([text(&attachment.name), text(&attachment.media_type)].concat());
                self.indexes.push((op::ATTACHMENT_INDEX, index));
            }
            Record::Chunk(records) => {
                self.chunks += 1;
                self.index_chunk(records, &raw, (offset, length), forgery.indexes);
            }
            Record::Other(..) => {}
        }
    }

    fn define(&mut self, record: &Record) {
        match record {
            Record::Schema(id, ..) => {
                self.schemas.entry(*id).or_insert_with(|| record.raw());
            }
            Record::Channel(channel) => {
                let raw = record.raw();
                self.channels.entry(channel.id).or_insert(raw);
            }
            Record::Message(message) => {
                *self.counts.entry(message.channel).or_default() += 1;
                let time = message.log_time;
                let (first, last) = self.span.unwrap_or((time, time));
                self.span = Some((first.min(time), last.max(time)));
            }
            _ => {}
        }
    }

    fn index_chunk(
        &mut self,
        records: &[Record],
        chunk: &Raw,
        (offset, length): (u64, u64),
        change: fn(&mut Vec<Raw>),
    ) {
        let mut entries: BTreeMap<u16, Vec<u8>> = BTreeMap::new();
        let mut at = 0_u64;
        for record in records {
            self.define(record);
            if let Record::Message(message) = record {
                let entry = entries.entry(message.channel).or_default();
                entry.extend(message.log_time.to_le_bytes());
                entry.extend(at.to_le_bytes());
            }
            at += framed(&record.raw()).len() as u64;
        }
        let mut indexes: Vec<Raw> = entries
            .iter()
            .map(|(channel, entries)| {
                let mut body = channel.to_le_bytes().to_vec();
                body.extend((entries.len() as u32).to_le_bytes());
                body.extend(entries);
                (op::MESSAGE_INDEX, body)
            })
            .collect();
        change(&mut indexes);
        let mut places = BTreeMap::new();
        let start = self.bytes.len();
        for index in &indexes {
            let (at, _) = self.add(index);
            if index.0 == op::MESSAGE_INDEX {
                places.insert([index.1[0], index.1[1]], at.to_le_bytes());
            }
        }
        let places = places.iter();
        let offsets: Vec<u8> = places.flat_map(|(c, at)| [&c[..], at].concat()).collect();
        let mut body = chunk.1[..16].to_vec();
        body.extend(offset.to_le_bytes());
        body.extend(length.to_le_bytes());
        body.extend((offsets.len() as u32).to_le_bytes());
        body.extend(offsets);
        body.extend(((self.bytes.len() - start) as u64).to_le_bytes());
        // The name of its compression, its compressed size and its size.
        let name = 4 + chunk.1[28] as usize;
        body.extend(&chunk.1[28..28 + name + 8]);
        body.extend(at.to_le_bytes());
        self.indexes.push((op::CHUNK_INDEX, body));
    }

    fn statistics(&self) -> Raw {
        let mut body = self.counts.values().sum::<u64>().to_le_bytes().to_vec();
        body.extend((self.schemas.len() as u16).to_le_bytes());
        body.extend((self.channels.len() as u32).to_le_bytes());
        for count in [self.attachments, self.metadata, self.chunks] {
            body.extend(count.to_le_bytes());
        }
        let (first, last) = self.span.unwrap_or((0, 0));
        body.extend([first.to_le_bytes(), last.to_le_bytes()].concat());
        body.extend((10 * self.counts.len() as u32).to_le_bytes());
        for (channel, count) in &self.counts {
            body.extend(channel.to_le_bytes());
            body.extend(count.to_le_bytes());
        }
        (op::STATISTICS, body)
    }

    fn end(&mut self, forgery: &Forgery) {
        let sum = crc32fast::hash(&self.bytes);
        self.add(&(op::DATA_END, sum.to_le_bytes().to_vec()));
        let mut summary: Vec<Raw> = self.schemas.values().cloned().collect();
        summary.extend(self.channels.values().cloned());
        summary.push(self.statistics());
        summary.append(&mut self.indexes);
        (forgery.summary)(&mut summary);
        summary.sort_by_key(|(opcode, _)| *opcode);
        (forgery.order)(&mut summary);
        let start = self.bytes.len();
        let mut offsets: Vec<Raw> = Vec::new();
        for group in summary.chunk_by(|one, next| one.0 == next.0) {
            let from = self.bytes.len() as u64;
            for raw in group {
                self.add(raw);
            }
            let length = self.bytes.len() as u64 - from;
            let mut body = vec![group[0].0];
            body.extend([from.to_le_bytes(), length.to_le_bytes()].concat());
            offsets.push((op::SUMMARY_OFFSET, body));
        }
        (forgery.offsets)(&mut offsets);
        let offsets_start = self.bytes.len() as u64;
        for offset in &offsets {
            self.add(offset);
        }
        let mut footer = (start as u64).to_le_bytes().to_vec();
        footer.extend((forgery.offsets_start)(offsets_start).to_le_bytes());
        let head = framed(&(op::FOOTER, [&footer[..], &[0; 4]].concat()));
        let summed = [&self.bytes[start..], &head[..head.len() - 4]].concat();
        footer.extend(crc32fast::hash(&summed).to_le_bytes());
        self.add(&(op::FOOTER, footer));
    }
}

fn views_of_fixed_peg() -> impl Iterator<Item = &'static ViewChannel> {
    view_channels().iter().filter(|view| !view.is_free_peg_only)
}

impl Forgery {
    /// Takes a recording apart.
    pub fn of(bytes: &[u8]) -> Self {
        let (mut profile, mut library) = (String::new(), String::new());
        let mut records = Vec::new();
        let mut chunk = Vec::new();
        for record in mcap::read::ChunkFlattener::new(bytes).unwrap() {
            match record.unwrap() {
                Parsed::Header(header) => (profile, library) = (header.profile, header.library),
                Parsed::Metadata(found) => {
                    // Several chunks, so that there is something to mix up.
                    let mut whole = std::mem::take(&mut chunk);
                    while !whole.is_empty() {
                        let rest = whole.split_off(whole.len().min(150));
                        records.push(Record::Chunk(std::mem::replace(&mut whole, rest)));
                    }
                    let entries = found.metadata.into_iter().collect();
                    records.push(Record::Metadata(found.name, entries));
                }
                Parsed::Attachment { header, data, .. } => {
                    records.push(Record::Attachment(Attachment {
                        log_time: header.log_time,
                        create_time: header.create_time,
                        name: header.name,
                        media_type: header.media_type,
                        data: data.into_owned(),
                    }));
                }
                Parsed::Schema { header, data } => {
                    let (name, encoding) = (header.name, header.encoding);
                    let schema = Record::Schema(header.id, name, encoding, data.into_owned());
                    chunk.push(schema);
                }
                Parsed::Channel(found) => chunk.push(Record::Channel(Channel {
                    id: found.id,
                    schema: found.schema_id,
                    topic: found.topic,
                    encoding: found.message_encoding,
                    metadata: found.metadata.into_iter().collect(),
                })),
                Parsed::Message { header, data } => chunk.push(Record::Message(Message {
                    channel: header.channel_id,
                    sequence: header.sequence,
                    log_time: header.log_time,
                    publish_time: header.publish_time,
                    data: data.into_owned(),
                })),
                Parsed::DataEnd(_) => break,
                _ => {}
            }
        }
        Self {
            profile,
            library,
            records,
            summary: |_| {},
            order: |_| {},
            offsets: |_| {},
            offsets_start: |start| start,
            written: |_| {},
            indexes: |_| {},
            before_magic: Vec::new(),
            before_last_magic: Vec::new(),
            is_digest_right: true,
        }
    }

    fn bytes(&self) -> Vec<u8> {
        let mut writing = Writing::default();
        writing.bytes.extend(&self.before_magic);
        writing.bytes.extend(mcap::MAGIC);
        let header = [text(&self.profile), text(&self.library)].concat();
        writing.add(&(op::HEADER, header));
        for record in &self.records {
            writing.data(record, self);
        }
        writing.end(self);
        writing.bytes.extend(&self.before_last_magic);
        writing.bytes.extend(mcap::MAGIC);
        writing.bytes
    }

    /// Writes the file, with a content digest and counts that fit what is in it.
    pub fn write(mut self, path: &Path) {
        fs::write(path, self.bytes()).unwrap();
        let Ok(recording) = Recording::open(path) else {
            return;
        };
        let mut digest = ContentDigest::default();
        let topics = recording.topics().into_iter();
        let mut counts: BTreeMap<String, u64> = topics.map(|t| (t.to_string(), 0)).collect();
        let mut reader = recording.reader(Selection::default());
        while let Some(message) = reader.next() {
            let Ok(message) = message else { continue };
            digest.update(&message);
            *counts.entry(message.topic().to_string()).or_default() += 1;
        }
        if !self.is_digest_right {
            return;
        }
        for record in &mut self.records {
            let Record::Metadata(name, entries) = record else {
                continue;
            };
            for (key, value) in entries.iter_mut().filter(|_| name == "toprise.end") {
                let topic = match key.as_str() {
                    "content_digest" => {
                        *value = digest.finish();
                        continue;
                    }
                    "samples" => "/top/state",
                    "events" => "/events",
                    "nutations" => "/top/nutation",
                    _ => continue,
                };
                if let Some(count) = counts.get(topic) {
                    *value = count.to_string();
                }
            }
        }
        fs::write(path, self.bytes()).unwrap();
    }

    /// All records, also those in chunks.
    fn each(&mut self, mut change: impl FnMut(&mut Record)) {
        for record in &mut self.records {
            match record {
                Record::Chunk(inner) => inner.iter_mut().for_each(&mut change),
                other => change(other),
            }
        }
    }

    /// Leaves out records, also in chunks.
    fn drop(&mut self, is_it: impl Fn(&Record) -> bool) {
        for record in &mut self.records {
            if let Record::Chunk(inner) = record {
                inner.retain(|record| !is_it(record));
            }
        }
        let is_empty = |record: &Record| matches!(record, Record::Chunk(inner) if inner.is_empty());
        self.records
            .retain(|record| !is_it(record) && !is_empty(record));
    }

    /// Leaves out a channel, its schema and its messages.
    fn leave_out(&mut self, topic: &str) {
        let (id, schema) = self.id(topic);
        self.drop(|record| match record {
            Record::Channel(channel) => channel.id == id,
            Record::Message(message) => message.channel == id,
            _ => false,
        });
        let mut is_used = false;
        self.each(|r| is_used |= matches!(r, Record::Channel(c) if c.schema == schema));
        self.drop(|r| !is_used && matches!(r, Record::Schema(id, ..) if *id == schema));
    }

    fn leave_out_views(&mut self) {
        for view in views_of_fixed_peg() {
            self.leave_out(view.topic);
        }
    }

    fn entries(&mut self, record: &str) -> &mut Texts {
        let found = self.records.iter_mut().find_map(|found| match found {
            Record::Metadata(name, entries) if name == record => Some(entries),
            _ => None,
        });
        found.unwrap()
    }

    /// Sets an entry of a metadata record.
    pub fn set(&mut self, record: &str, key: &str, value: &str) {
        let entries = self.entries(record);
        entries.retain(|(found, _)| found != key);
        entries.push((key.to_owned(), value.to_owned()));
    }

    /// The attachment with the scenario.
    fn scenario(&mut self) -> &mut Attachment {
        let found = self.records.iter_mut().find_map(|found| match found {
            Record::Attachment(attachment) => Some(attachment),
            _ => None,
        });
        found.unwrap()
    }

    fn edit_scenario(&mut self, from: &str, to: &str) {
        let attachment = self.scenario();
        let toml = String::from_utf8(std::mem::take(&mut attachment.data)).unwrap();
        assert!(toml.contains(from), "{toml}");
        attachment.data = toml.replacen(from, to, 1).into_bytes();
    }

    fn channel(&mut self, topic: &str, mut change: impl FnMut(&mut Channel)) {
        let mut is_found = false;
        self.each(|record| match record {
            Record::Channel(channel) if channel.topic == topic => {
                is_found = true;
                change(channel);
            }
            _ => {}
        });
        assert!(is_found, "{topic}");
    }

    fn id(&mut self, topic: &str) -> (u16, u16) {
        let mut ids = (0, 0);
        self.channel(topic, |channel| ids = (channel.id, channel.schema));
        ids
    }

    fn schema(&mut self, topic: &str, change: impl Fn(&mut String, &mut String, &mut Vec<u8>)) {
        let (_, schema) = self.id(topic);
        self.each(|record| match record {
            Record::Schema(id, name, encoding, data) if *id == schema => {
                change(name, encoding, data);
            }
            _ => {}
        });
    }

    fn messages(&mut self, topic: &str, mut change: impl FnMut(&mut Message)) {
        let (id, _) = self.id(topic);
        self.each(|record| match record {
            Record::Message(message) if message.channel == id => change(message),
            _ => {}
        });
    }

    /// Changes the text of the JSON message with a number.
    fn edit(&mut self, topic: &str, number: u32, change: impl Fn(&str) -> String) {
        self.messages(topic, |message| {
            if message.sequence == number {
                let text = String::from_utf8(std::mem::take(&mut message.data)).unwrap();
                let changed = change(&text);
                assert_ne!(text, changed);
                message.data = changed.into_bytes();
            }
        });
    }

    /// The records of the first chunk, which begins with schemas and channels.
    fn first_chunk(&mut self) -> &mut Vec<Record> {
        let found = self.records.iter_mut().find_map(|found| match found {
            Record::Chunk(records) => Some(records),
            _ => None,
        });
        found.unwrap()
    }

    /// The records of the last chunk.
    fn last_chunk(&mut self) -> &mut Vec<Record> {
        let found = self.records.iter_mut().rev().find_map(|found| match found {
            Record::Chunk(records) => Some(records),
            _ => None,
        });
        found.unwrap()
    }

    /// Orders the messages of one time otherwise.
    fn reorder<K: Ord>(&mut self, key: impl Fn(&Message) -> K) {
        for record in &mut self.records {
            if let Record::Chunk(chunk) = record {
                chunk.sort_by_key(|record| match record {
                    Record::Message(message) => Some((message.log_time, key(message))),
                    _ => None,
                });
            }
        }
    }

    /// Moves a record of the data to another place.
    fn shift(&mut self, to: usize, is_it: impl Fn(&Record) -> bool) {
        let at = self.records.iter().position(is_it).unwrap();
        let record = self.records.remove(at);
        self.records.insert(to.min(self.records.len()), record);
    }

    /// The record that defines a channel.
    fn definition(&mut self, topic: &str) -> Record {
        let mut found = None;
        self.channel(topic, |channel| {
            found = Some(Record::Channel(channel.clone()));
        });
        found.unwrap()
    }

    fn metadata(&mut self, name: &str, entries: &[(&str, &str)]) {
        let entries = entries.iter();
        let entries = entries.map(|(key, value)| ((*key).to_owned(), (*value).to_owned()));
        let record = Record::Metadata(name.to_owned(), entries.collect());
        self.records.insert(1, record);
    }
}

/// The verdict on a forgery.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Expected {
    /// Neither verified nor packed otherwise.
    Caught,
    /// Packed otherwise: it holds what its scenario gives.
    Repacked,
    /// It can't be opened.
    Unreadable,
}
use Expected::{Caught, Repacked, Unreadable};

type Attempt = (&'static str, Expected, fn(&mut Forgery));

/// The verdict on a file, and the difference that was found.
fn judge(path: &Path) -> (Expected, String) {
    let recording = match Recording::open(path) {
        Ok(recording) => recording,
        Err(error) => return (Unreadable, error.to_string()),
    };
    let report = verify(&recording, &|_| {});
    let found = match report.verdict {
        Verdict::Verified | Verdict::PackedOtherwise => Repacked,
        Verdict::OtherVersion | Verdict::Incomplete | Verdict::Different => Caught,
    };
    (found, format!("{report:?}"))
}

fn recorded(encoding: Encoding) -> Vec<u8> {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let form = Form {
        encoding,
        views: true,
    };
    archive(&path, &short(), &[], form).unwrap();
    fs::read(&path).unwrap()
}

fn short() -> Scenario {
    scenario("paper", &[("stop.duration", "0.05")])
}

/// Tries forgeries of a recording.
fn try_all(encoding: Encoding, attempts: &[Attempt]) {
    let original = Forgery::of(&recorded(encoding));
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("forged.mcap");
    let mut surprises = Vec::new();
    for (name, expected, change) in attempts {
        let mut forgery = original.clone();
        change(&mut forgery);
        forgery.write(&path);
        let (found, report) = judge(&path);
        if found != *expected {
            surprises.push(format!("{name}: {found:?}, {report}"));
        }
    }
    assert!(surprises.is_empty(), "{}", surprises.join("\n"));
}

/// A view as it would be of another top: the last byte of its last number is another one.
fn other_view(message: &mut Message) {
    if let Some(byte) = message.data.last_mut() {
        *byte ^= 1;
    }
}

/// Puts the index of the last chunk behind the other groups of the summary.
fn split_chunk_indexes(forgery: &mut Forgery) {
    forgery.order = |summary| {
        let last = summary
            .iter()
            .rposition(|(opcode, _)| *opcode == op::CHUNK_INDEX);
        let index = summary.remove(last.unwrap());
        summary.push(index);
    };
}

/// Compresses a chunk.
fn pack((opcode, body): &mut Raw, name: &str, compress: impl Fn(&[u8]) -> Vec<u8>) {
    if *opcode != op::CHUNK {
        return;
    }
    let packed = compress(&body[40..]);
    body.truncate(28);
    body.extend(text(name));
    body.extend((packed.len() as u64).to_le_bytes());
    body.extend(packed);
}

fn lz4(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = lz4_flex::frame::FrameEncoder::new(Vec::new());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn what_stands_beside_the_messages_follows_from_the_scenario() {
    try_all(
        Encoding::Json,
        &[
            ("written anew", Repacked, |_| {}),
            // The record toprise.run.
            ("another law", Caught, |f| {
                f.set("toprise.run", "friction_law", "viscous");
            }),
            ("another formulation", Caught, |f| {
                f.set("toprise.run", "formulation", "body");
            }),
            ("another name", Caught, |f| {
                f.set("toprise.run", "scenario", "best top ever");
            }),
            ("another epoch", Caught, |f| {
                f.set("toprise.run", "epoch", "1970-01-01");
            }),
            ("another period", Caught, |f| {
                f.set("toprise.run", "sample_period_ns", "2000000");
            }),
            ("another digest", Caught, |f| {
                f.set("toprise.run", "scenario_digest", "00");
            }),
            ("no version", Caught, |f| {
                f.set("toprise.run", "version", "by the author himself");
            }),
            ("another version", Caught, |f| {
                f.set("toprise.run", "version", "0.0.9");
            }),
            ("another key", Caught, |f| {
                f.set("toprise.run", "measured_at", "MIT");
            }),
            ("a key is missing", Caught, |f| {
                f.entries("toprise.run")
                    .retain(|(key, _)| key != "friction_law");
            }),
            ("a key twice", Caught, |f| {
                let entry = ("friction_law".to_owned(), "viscous".to_owned());
                f.entries("toprise.run").insert(0, entry);
            }),
            ("a second toprise.run", Caught, |f| {
                f.metadata("toprise.run", &[("friction_law", "viscous")]);
            }),
            ("no toprise.run", Caught, |f| {
                f.drop(|r| matches!(r, Record::Metadata(name, _) if name == "toprise.run"));
            }),
            // The record toprise.end.
            ("another end", Caught, |f| {
                f.set("toprise.end", "stop_reason", "risen");
            }),
            ("an end that failed", Caught, |f| {
                f.set("toprise.end", "stop_reason", "failed");
                f.set("toprise.end", "stop_time", "0.03");
                f.drop(|r| matches!(r, Record::Message(m) if m.log_time > 30_000_000));
            }),
            ("an end that was interrupted", Caught, |f| {
                f.set("toprise.end", "stop_reason", "interrupted");
                f.drop(|r| matches!(r, Record::Message(m) if m.log_time > 30_000_000));
            }),
            ("another key at an interrupted end", Caught, |f| {
                f.set("toprise.end", "stop_reason", "interrupted");
                f.set("toprise.end", "winner", "paper");
                f.drop(|r| matches!(r, Record::Message(m) if m.log_time > 30_000_000));
            }),
            ("another time of the end", Caught, |f| {
                f.set("toprise.end", "stop_time", "0.051");
            }),
            ("other steps", Caught, |f| {
                f.set("toprise.end", "steps_accepted", "7");
            }),
            ("other largest step", Caught, |f| {
                f.set("toprise.end", "largest_step", "1.0");
            }),
            ("another key at the end", Caught, |f| {
                f.set("toprise.end", "winner", "paper");
            }),
            ("another content digest", Caught, |f| {
                f.is_digest_right = false;
                f.set("toprise.end", "content_digest", "00");
            }),
            ("another count of samples", Caught, |f| {
                f.is_digest_right = false;
                f.set("toprise.end", "samples", "52");
            }),
            ("a second toprise.end", Caught, |f| {
                f.metadata("toprise.end", &[("stop_reason", "risen")]);
            }),
            ("a recovery", Caught, |f| {
                f.metadata("toprise.recovery", &[("lost", "a dog ate it")]);
            }),
            ("a second recovery", Caught, |f| {
                f.metadata("toprise.recovery", &[("lost", "a dog ate it")]);
                f.metadata("toprise.recovery", &[("lost", "nothing")]);
            }),
            ("a recovery with another end", Caught, |f| {
                f.metadata("toprise.recovery", &[("lost", "a dog ate it")]);
                f.set("toprise.end", "steps_accepted", "7");
            }),
            // The scenario.
            ("another scenario", Caught, |f| {
                f.edit_scenario("\nk = 0.03", "\nk = 0.029");
                let toml = String::from_utf8(f.scenario().data.clone()).unwrap();
                let scenario = Scenario::from_toml(&toml).unwrap();
                f.set("toprise.run", "scenario_digest", &scenario.digest());
            }),
            ("a second scenario", Caught, |f| {
                let mut second = f.scenario().clone();
                second.data = b"name = \"another\"".to_vec();
                f.records.insert(2, Record::Attachment(second));
            }),
            ("the scenario as another type", Caught, |f| {
                f.scenario().media_type = "text/html".to_owned();
            }),
            ("the scenario made today", Caught, |f| {
                f.scenario().create_time = 1_700_000_000_000_000_000;
            }),
            ("the scenario logged later", Caught, |f| {
                f.scenario().log_time = 7;
            }),
            ("another description", Repacked, |f| {
                f.edit_scenario(
                    "description = \"",
                    "description = \"Measured, not simulated. ",
                );
            }),
            ("another comment", Caught, |f| {
                f.edit_scenario("  # ", "  # as measured by the author, ");
            }),
            ("an attachment", Caught, |f| {
                let mut notes = f.scenario().clone();
                notes.name = "notes.txt".to_owned();
                f.records.insert(2, Record::Attachment(notes));
            }),
            ("metadata", Caught, |f| {
                f.metadata("laboratory", &[("place", "MIT")]);
            }),
            ("metadata that is called almost like ours", Caught, |f| {
                f.metadata("toprise.run ", &[("friction_law", "viscous")]);
            }),
            ("metadata without a name", Caught, |f| {
                f.metadata("", &[("place", "MIT")]);
            }),
            ("an attachment without a name", Caught, |f| {
                let mut notes = f.scenario().clone();
                notes.name = String::new();
                f.records.insert(2, Record::Attachment(notes));
            }),
            ("the end first", Repacked, |f| {
                f.shift(
                    0,
                    |r| matches!(r, Record::Metadata(name, _) if name == "toprise.end"),
                );
            }),
            ("the run last", Repacked, |f| {
                f.shift(
                    usize::MAX,
                    |r| matches!(r, Record::Metadata(name, _) if name == "toprise.run"),
                );
            }),
            ("the scenario last", Repacked, |f| {
                f.shift(usize::MAX, |r| matches!(r, Record::Attachment(_)));
            }),
            // The header.
            ("no library", Repacked, |f| {
                f.library = String::new();
            }),
            ("another version wrote and simulated it", Caught, |f| {
                f.library = "toprise/9.9.9".to_owned();
                f.set("toprise.run", "version", "9.9.9");
            }),
            ("a profile", Caught, |f| {
                f.profile = "ros2".to_owned();
            }),
            ("no version of toprise", Repacked, |f| {
                f.library = "toprise/best".to_owned();
            }),
            ("another library", Repacked, |f| {
                f.library = "somebody".to_owned();
            }),
            ("another version wrote it", Repacked, |f| {
                f.library = "toprise/9.9.9".to_owned();
            }),
        ],
    );
}

#[test]
fn channels_and_schemas_are_those_of_toprise() {
    try_all(
        Encoding::Json,
        &[
            ("metadata of a channel", Caught, |f| {
                f.channel("/top/state", |channel| {
                    channel
                        .metadata
                        .push(("unit".to_owned(), "degrees".to_owned()));
                });
            }),
            ("metadata of a view", Caught, |f| {
                f.channel("/tf", |channel| {
                    channel
                        .metadata
                        .push(("offered_qos_profiles".to_owned(), String::new()));
                });
            }),
            ("swapped schemas of views", Caught, |f| {
                let (tf, log) = (f.id("/tf").1, f.id("/log").1);
                f.channel("/tf", |channel| channel.schema = log);
                f.channel("/log", |channel| channel.schema = tf);
            }),
            ("swapped views", Caught, |f| {
                f.channel("/view/spin_rate", |channel| {
                    channel.topic = "swap".to_owned();
                });
                f.channel("/view/precession_rate", |channel| {
                    channel.topic = "/view/spin_rate".to_owned();
                });
                f.channel("swap", |channel| {
                    channel.topic = "/view/precession_rate".to_owned();
                });
            }),
            ("a view with another definition", Caught, |f| {
                f.schema("/view/inclination", |_, _, data| {
                    let text = String::from_utf8(std::mem::take(data)).unwrap();
                    let swapped = text.replace("position", "swap");
                    let swapped = swapped.replace("velocity", "position");
                    *data = swapped.replace("swap", "velocity").into_bytes();
                });
            }),
            ("a view with another encoding", Caught, |f| {
                f.channel("/tf", |channel| channel.encoding = "ros1".to_owned());
            }),
            ("a channel of others", Caught, |f| {
                let schema = f.id("/top/state").1;
                f.first_chunk().push(Record::Channel(Channel {
                    id: 99,
                    schema,
                    topic: "/speed".to_owned(),
                    encoding: "json".to_owned(),
                    metadata: Texts::new(),
                }));
            }),
            ("a view twice", Caught, |f| {
                let schema = f.id("/tf").1;
                f.first_chunk().push(Record::Channel(Channel {
                    id: 99,
                    schema,
                    topic: "/tf".to_owned(),
                    encoding: "cdr".to_owned(),
                    metadata: Texts::new(),
                }));
            }),
            ("a channel twice", Unreadable, |f| {
                let schema = f.id("/top/state").1;
                f.first_chunk().push(Record::Channel(Channel {
                    id: 99,
                    schema,
                    topic: "/top/state".to_owned(),
                    encoding: "json".to_owned(),
                    metadata: Texts::new(),
                }));
            }),
            ("another name of a schema", Caught, |f| {
                f.schema("/top/state", |name, _, _| {
                    *name = "toprise.Speed".to_owned();
                });
            }),
            ("another language of a schema", Caught, |f| {
                f.schema("/top/state", |_, encoding, _| *encoding = "json".to_owned());
            }),
            ("another unit in a schema", Caught, |f| {
                f.schema("/top/state", |_, _, data| {
                    let text = String::from_utf8(std::mem::take(data)).unwrap();
                    *data = text.replace("[rad]", "[degrees]").into_bytes();
                });
            }),
            ("a channel without schema", Caught, |f| {
                f.channel("/tf", |channel| channel.schema = 0);
            }),
            ("a schema with the number 0", Caught, |f| {
                let schema = f.id("/tf").1;
                f.each(|record| match record {
                    Record::Schema(id, ..) if *id == schema => *id = 0,
                    Record::Channel(channel) if channel.schema == schema => channel.schema = 0,
                    _ => {}
                });
            }),
            ("a channel again", Repacked, |f| {
                let channel = f.definition("/tf");
                f.last_chunk().insert(0, channel);
            }),
            ("a schema again", Repacked, |f| {
                let is_schema = |r: &&Record| matches!(r, Record::Schema(..));
                let schema = f.first_chunk().iter().find(is_schema).unwrap().clone();
                f.last_chunk().insert(0, schema);
            }),
            ("a channel outside of chunks", Caught, |f| {
                let channel = f.definition("/tf");
                f.records.insert(3, channel);
            }),
            ("a schema that nothing uses", Caught, |f| {
                let (name, language) = ("toprise.Heat".to_owned(), "jsonschema".to_owned());
                let schema = Record::Schema(99, name, language, b"{}".to_vec());
                f.first_chunk().insert(0, schema);
            }),
            (
                "a schema that nothing uses, like one that is used",
                Caught,
                |f| {
                    let is_schema = |r: &&Record| matches!(r, Record::Schema(..));
                    let schema = f.first_chunk().iter().find(is_schema).cloned();
                    let Some(Record::Schema(_, name, language, data)) = schema else {
                        panic!("the first chunk begins with schemas");
                    };
                    let again = Record::Schema(99, name, language, data);
                    f.first_chunk().insert(0, again);
                },
            ),
            ("another encoding", Caught, |f| {
                f.channel("/top/state", |channel| channel.encoding = "cbor".to_owned());
            }),
            ("several encodings", Caught, |f| {
                f.channel("/top/state", |channel| {
                    channel.encoding = "protobuf".to_owned();
                });
            }),
            ("other channels in the summary", Caught, |f| {
                f.summary = |summary| {
                    let is_channel = |raw: &&mut Raw| raw.0 == op::CHANNEL;
                    let (_, body) = summary.iter_mut().find(is_channel).unwrap();
                    let topic = body.len() - 4;
                    let entry = texts(&vec![("unit".to_owned(), "degrees".to_owned())]);
                    body.splice(topic.., entry);
                };
            }),
            ("other schemas in the summary", Caught, |f| {
                f.summary = |summary| {
                    let is_schema = |raw: &&mut Raw| raw.0 == op::SCHEMA;
                    let (_, body) = summary.iter_mut().find(is_schema).unwrap();
                    *body.last_mut().unwrap() = b' ';
                };
            }),
            ("a channel that the summary lacks", Caught, |f| {
                f.summary = |summary| {
                    let at = summary.iter().position(|raw| raw.0 == op::CHANNEL);
                    summary.remove(at.unwrap());
                };
            }),
            ("a channel in the summary alone", Caught, |f| {
                f.summary = |summary| {
                    let mut channel = summary
                        .iter()
                        .rfind(|raw| raw.0 == op::CHANNEL)
                        .unwrap()
                        .clone();
                    channel.1[0] = 99;
                    summary.push(channel);
                };
            }),
            ("a channel that was dropped", Caught, |f| {
                f.leave_out("/top/energy");
            }),
            ("a channel that was dropped, as told", Repacked, |f| {
                f.leave_out("/top/energy");
                let others = "/top/state,/top/pose,/top/torque,/top/acceleration,/top/contact,/top/momentum,\
                              /top/precession,/top/nutation,/events";
                f.set("toprise.run", "topics", others);
            }),
            ("a view that was dropped", Caught, |f| {
                f.leave_out("/tf");
            }),
            ("views that were dropped", Caught, Forgery::leave_out_views),
            ("no views, as told", Repacked, |f| {
                f.leave_out_views();
                f.set("toprise.run", "views", "no");
            }),
            ("views that are not told", Caught, |f| {
                f.set("toprise.run", "views", "no");
            }),
            ("topics that are not told", Caught, |f| {
                f.set("toprise.run", "topics", "/events");
            }),
            ("another encoding told", Caught, |f| {
                f.set("toprise.run", "encoding", "protobuf");
            }),
            ("an encoding that is none", Caught, |f| {
                f.set("toprise.run", "encoding", "by hand");
            }),
            ("a channel added to the last chunk", Caught, |f| {
                let mut added = f.definition("/top/energy");
                if let Record::Channel(channel) = &mut added {
                    (channel.id, channel.topic) = (99, "/more".to_owned());
                }
                f.last_chunk().push(added);
            }),
            ("an added channel that the summary lacks", Caught, |f| {
                let mut added = f.definition("/top/energy");
                if let Record::Channel(channel) = &mut added {
                    (channel.id, channel.topic) = (99, "/more".to_owned());
                }
                f.last_chunk().push(added);
                f.summary = |summary| {
                    summary.retain(|(opcode, body)| *opcode != op::CHANNEL || body[..2] != [99, 0]);
                };
            }),
            ("another definition in the last chunk", Caught, |f| {
                let mut other = f.definition("/top/energy");
                if let Record::Channel(channel) = &mut other {
                    "/more".clone_into(&mut channel.topic);
                }
                f.last_chunk().push(other);
            }),
            (
                "a definition just before its first message",
                Repacked,
                |f| {
                    let definition = f.definition("/top/nutation");
                    let (id, _) = f.id("/top/nutation");
                    f.drop(|r| matches!(r, Record::Channel(channel) if channel.id == id));
                    let is_of =
                        |r: &Record| matches!(r, Record::Message(message) if message.channel == id);
                    let found = f.records.iter_mut().find_map(|record| match record {
                        Record::Chunk(chunk) if chunk.iter().any(is_of) => Some(chunk),
                        _ => None,
                    });
                    found.unwrap().insert(0, definition);
                },
            ),
            ("a message at the last possible time", Caught, |f| {
                f.messages("/top/energy", |message| {
                    if message.sequence == 50 {
                        message.log_time = u64::MAX;
                    }
                });
            }),
            ("a channel whose messages were dropped", Caught, |f| {
                let (id, _) = f.id("/top/energy");
                f.drop(|r| matches!(r, Record::Message(message) if message.channel == id));
            }),
        ],
    );
}

#[test]
fn messages_are_those_of_the_simulation_byte_by_byte() {
    try_all(
        Encoding::Json,
        &[
            ("a publish time", Caught, |f| {
                f.messages("/top/state", |message| message.publish_time += 1);
            }),
            ("a publish time of a view", Caught, |f| {
                f.messages("/tf", |message| message.publish_time = 0);
            }),
            ("a time of a view", Caught, |f| {
                f.messages("/view/spin_rate", |message| {
                    message.log_time += 1;
                    message.publish_time += 1;
                });
            }),
            ("a number", Caught, |f| {
                f.edit("/top/state", 7, |text| {
                    text.replacen("\"theta\":0.", "\"theta\":0.1", 1)
                });
            }),
            ("a text", Caught, |f| {
                f.edit("/events", 0, |text| text.replace("start", "risen"));
            }),
            ("a number of a view", Caught, |f| {
                f.messages("/view/slip_speed", other_view);
            }),
            ("the words of a view", Caught, |f| {
                f.messages("/robot_description", |message| {
                    let at = message.data.windows(3).position(|bytes| bytes == b"top");
                    message.data[at.unwrap()] = b'h';
                });
            }),
            ("spaces", Caught, |f| {
                f.edit("/top/state", 7, |text| text.replacen(':', ": ", 1));
            }),
            ("more digits than count", Caught, |f| {
                f.edit("/top/energy", 7, |text| {
                    let at = text.find("\"potential\":").unwrap() + 12;
                    let end = at + text[at..].find([',', '}']).unwrap();
                    format!("{}0000000001{}", &text[..end], &text[end..])
                });
            }),
            ("a member twice", Caught, |f| {
                f.edit("/top/state", 7, |text| {
                    text.replacen("\"theta\":", "\"theta\":1.5,\"theta\":", 1)
                });
            }),
            ("another member", Caught, |f| {
                f.edit("/top/state", 7, |text| {
                    text.replacen("\"theta\":", "\"heat\":1.5,\"theta\":", 1)
                });
            }),
            ("members in another order", Caught, |f| {
                f.edit("/top/state", 7, |text| {
                    let (stamp, rest) = text[1..text.len() - 1].split_once("},").unwrap();
                    format!("{{{rest},{stamp}}}}}")
                });
            }),
            ("escaped letters", Caught, |f| {
                f.edit("/events", 0, |text| {
                    text.replacen("start", "\\u0073tart", 1)
                });
            }),
            ("a sequence number", Caught, |f| {
                let (id, _) = f.id("/events");
                f.each(|record| match record {
                    Record::Message(m) if m.channel == id && m.sequence > 0 => m.sequence += 1,
                    _ => {}
                });
            }),
            ("a sequence number of a view", Caught, |f| {
                f.messages("/tf", |message| message.sequence += 1);
            }),
            ("messages dropped at the end", Caught, |f| {
                f.drop(|r| matches!(r, Record::Message(m) if m.log_time > 40_000_000));
            }),
            ("messages dropped in between", Caught, |f| {
                f.drop(|r| matches!(r, Record::Message(m) if m.log_time == 40_000_000));
            }),
            ("a message of a view dropped", Caught, |f| {
                let (id, _) = f.id("/tf");
                f.drop(|r| matches!(r, Record::Message(m) if m.channel == id && m.log_time == 40_000_000));
            }),
            ("a message twice", Caught, |f| {
                let chunk = f.last_chunk();
                chunk.push(chunk.last().unwrap().clone());
            }),
            ("a message out of order", Caught, |f| {
                let chunk = f.last_chunk();
                let last = chunk.pop().unwrap();
                chunk.insert(0, last);
            }),
            ("another order at one time", Caught, |f| {
                f.reorder(|message| std::cmp::Reverse(message.channel));
            }),
            ("views behind the rest", Caught, |f| {
                let views: Vec<_> = views_of_fixed_peg().map(|v| f.id(v.topic).0).collect();
                f.reorder(|message| views.contains(&message.channel));
            }),
            ("a message of no channel", Caught, |f| {
                let chunk = f.last_chunk();
                let Some(Record::Message(mut last)) = chunk.last().cloned() else {
                    panic!("a chunk ends with a message");
                };
                last.channel = 99;
                chunk.push(Record::Message(last));
            }),
        ],
    );
    try_all(
        Encoding::Protobuf,
        &[
            ("written anew", Repacked, |_| {}),
            ("a field twice", Caught, |f| {
                f.messages("/top/energy", |message| {
                    let last = message.data[message.data.len() - 9..].to_vec();
                    message.data.extend(last);
                });
            }),
            ("an unknown field", Caught, |f| {
                // Field 99, a varint.
                f.messages("/top/energy", |message| {
                    message.data.extend([0x98, 0x06, 1]);
                });
            }),
            ("a number", Caught, |f| {
                f.messages("/top/energy", other_view);
            }),
            ("another unit in a schema", Caught, |f| {
                f.schema("/top/energy", |_, _, data| {
                    let at = data.windows(4).position(|bytes| bytes == b"kine");
                    data[at.unwrap()] = b'K';
                });
            }),
        ],
    );
}

#[test]
fn the_container_says_nothing_else_than_the_messages() {
    try_all(
        Encoding::Json,
        &[
            ("a message outside of chunks", Caught, |f| {
                let last = f.last_chunk().pop().unwrap();
                let at = f.records.len() - 1;
                f.records.insert(at, last);
            }),
            ("an unknown record", Caught, |f| {
                f.records.insert(1, Record::Other(0x80, b"by me".to_vec()));
            }),
            ("an unknown record in a chunk", Caught, |f| {
                f.last_chunk().push(Record::Other(0x80, b"by me".to_vec()));
            }),
            ("an unknown record in the summary", Caught, |f| {
                f.summary = |summary| summary.push((0x80, b"by me".to_vec()));
            }),
            ("an empty chunk", Caught, |f| {
                f.records.insert(2, Record::Chunk(Vec::new()));
            }),
            ("bytes behind metadata", Caught, |f| {
                let mut raw = f.records[0].raw();
                raw.1.extend(b"by me");
                f.records[0] = Record::Other(raw.0, raw.1);
            }),
            ("bytes behind a schema in a chunk", Caught, |f| {
                let first = &mut f.first_chunk()[0];
                let mut raw = first.raw();
                raw.1.extend(b"by me");
                *first = Record::Other(raw.0, raw.1);
            }),
            ("metadata in the summary", Caught, |f| {
                f.summary = |summary| {
                    let record = Record::Metadata("by me".to_owned(), Texts::new());
                    summary.push(record.raw());
                };
            }),
            ("a second header", Caught, |f| {
                let header = [text("ros2"), text("toprise/0.1.0")].concat();
                f.records.insert(1, Record::Other(op::HEADER, header));
            }),
            ("bytes before the magic", Unreadable, |f| {
                f.before_magic = b"by me".to_vec();
            }),
            ("a record behind the footer", Caught, |f| {
                f.before_last_magic = framed(&(0x80, b"by me".to_vec()));
            }),
            ("a second footer", Caught, |f| {
                f.before_last_magic = framed(&(op::FOOTER, vec![0; 20]));
            }),
            ("bytes behind the footer", Caught, |f| {
                f.before_last_magic = b"by me".to_vec();
            }),
            ("a chunk indexed twice", Caught, |f| {
                f.summary = |summary| {
                    let index = summary.iter().find(|raw| raw.0 == op::CHUNK_INDEX);
                    summary.push(index.unwrap().clone());
                };
            }),
            ("a chunk not indexed", Caught, |f| {
                f.summary = |summary| {
                    let at = summary.iter().position(|raw| raw.0 == op::CHUNK_INDEX);
                    summary.remove(at.unwrap());
                };
            }),
            ("another compression", Caught, |f| {
                f.summary = |summary| {
                    let index = summary.iter_mut().find(|raw| raw.0 == op::CHUNK_INDEX);
                    let (_, body) = index.unwrap();
                    let at = body.len() - 20;
                    body.splice(at..at + 4, text("zstd"));
                };
            }),
            ("another size of a chunk", Caught, |f| {
                f.summary = |summary| {
                    let index = summary.iter_mut().find(|raw| raw.0 == op::CHUNK_INDEX);
                    *index.unwrap().1.last_mut().unwrap() = 1;
                };
            }),
            ("other times of a chunk", Caught, |f| {
                f.summary = |summary| {
                    let index = summary.iter_mut().find(|raw| raw.0 == op::CHUNK_INDEX);
                    index.unwrap().1[8] ^= 1;
                };
            }),
            ("another media type in the index", Caught, |f| {
                f.summary = |summary| {
                    let index = summary.iter_mut().find(|raw| raw.0 == op::ATTACHMENT_INDEX);
                    *index.unwrap().1.last_mut().unwrap() = b'x';
                };
            }),
            ("another name in the index", Caught, |f| {
                f.summary = |summary| {
                    let index = summary.iter_mut().find(|raw| raw.0 == op::METADATA_INDEX);
                    *index.unwrap().1.last_mut().unwrap() = b'x';
                };
            }),
            ("an index twice", Caught, |f| {
                f.summary = |summary| {
                    let index = summary.iter().find(|raw| raw.0 == op::METADATA_INDEX);
                    summary.push(index.unwrap().clone());
                };
            }),
            ("an attachment not indexed", Caught, |f| {
                f.summary = |summary| summary.retain(|raw| raw.0 != op::ATTACHMENT_INDEX);
            }),
            ("other statistics", Caught, |f| {
                f.summary = |summary| {
                    let found = summary.iter_mut().find(|raw| raw.0 == op::STATISTICS);
                    found.unwrap().1[0] ^= 1;
                };
            }),
            ("other counts of channels", Caught, |f| {
                f.summary = |summary| {
                    let found = summary.iter_mut().find(|raw| raw.0 == op::STATISTICS);
                    *found.unwrap().1.last_mut().unwrap() = 1;
                };
            }),
            ("another end in the statistics", Caught, |f| {
                f.summary = |summary| {
                    let found = summary.iter_mut().find(|raw| raw.0 == op::STATISTICS);
                    found.unwrap().1[34] ^= 1;
                };
            }),
            ("statistics twice", Caught, |f| {
                f.summary = |summary| {
                    let found = summary.iter().find(|raw| raw.0 == op::STATISTICS);
                    summary.push(found.unwrap().clone());
                };
            }),
            ("no statistics", Caught, |f| {
                f.summary = |summary| summary.retain(|raw| raw.0 != op::STATISTICS);
            }),
            ("an offset that leads elsewhere", Caught, |f| {
                f.offsets = |offsets| offsets[0].1[1] ^= 1;
            }),
            ("an offset to a part of its group", Caught, |f| {
                f.offsets = |offsets| {
                    let length = u64::from_le_bytes(offsets[0].1[9..].try_into().unwrap());
                    offsets[0].1[9..].copy_from_slice(&(length / 2).to_le_bytes());
                };
            }),
            ("an index without some messages", Caught, |f| {
                f.indexes = |indexes| {
                    let (_, body) = &mut indexes[0];
                    let length = u32::from_le_bytes(body[2..6].try_into().unwrap()) - 16;
                    body[2..6].copy_from_slice(&length.to_le_bytes());
                    body.truncate(body.len() - 16);
                };
            }),
            ("a channel without index", Caught, |f| {
                f.indexes = |indexes| drop(indexes.remove(0));
            }),
            ("an empty index behind the right one", Caught, |f| {
                f.indexes = |indexes| {
                    let channel = indexes[0].1[..2].to_vec();
                    indexes.push((op::MESSAGE_INDEX, [channel, vec![0; 4]].concat()));
                };
            }),
            (
                "an index of a channel that has nothing there",
                Caught,
                |f| {
                    f.indexes = |indexes| {
                        indexes.push((op::MESSAGE_INDEX, vec![0x0f, 0x27, 0, 0, 0, 0]));
                    };
                },
            ),
            ("metadata between a chunk and its indexes", Caught, |f| {
                f.indexes = |indexes| {
                    let record = Record::Metadata("by me".to_owned(), Texts::new());
                    indexes.insert(0, record.raw());
                };
            }),
            ("two zstd frames", Caught, |f| {
                f.written = |raw| {
                    pack(raw, "zstd", |bytes| {
                        let (one, two) = bytes.split_at(bytes.len() / 2);
                        let pack = |bytes| zstd::bulk::compress(bytes, 1).unwrap();
                        [pack(one), pack(two)].concat()
                    });
                };
            }),
            ("a zstd frame that is skipped", Caught, |f| {
                f.written = |raw| {
                    pack(raw, "zstd", |bytes| {
                        let hidden = [0x50, 0x2a, 0x4d, 0x18, 2, 0, 0, 0, b'm', b'e'];
                        [zstd::bulk::compress(bytes, 1).unwrap(), hidden.to_vec()].concat()
                    });
                };
            }),
            ("two lz4 frames", Caught, |f| {
                f.written = |raw| {
                    pack(raw, "lz4", |bytes| {
                        let (one, two) = bytes.split_at(bytes.len() / 2);
                        [lz4(one), lz4(two)].concat()
                    });
                };
            }),
            ("one zstd frame", Repacked, |f| {
                f.written = |raw| {
                    pack(raw, "zstd", |bytes| zstd::bulk::compress(bytes, 1).unwrap());
                };
            }),
            ("one lz4 frame", Repacked, |f| {
                f.written = |raw| pack(raw, "lz4", lz4);
            }),
            ("no checksums of chunks", Caught, |f| {
                f.written = |(opcode, body)| {
                    if *opcode == op::CHUNK {
                        body[24..28].fill(0);
                    }
                };
            }),
            ("no checksum of an attachment", Caught, |f| {
                f.written = |(opcode, body)| {
                    if *opcode == op::ATTACHMENT {
                        let at = body.len() - 4;
                        body[at..].fill(0);
                    }
                };
            }),
            ("empty offsets", Caught, |f| {
                f.offsets = |offsets| {
                    for (_, body) in offsets {
                        body[9..].fill(0);
                    }
                };
            }),
            ("an offset of an unknown kind", Caught, |f| {
                f.offsets = |offsets| {
                    let mut more = offsets[0].clone();
                    more.1[0] = 200;
                    more.1[9..].fill(0);
                    offsets.push(more);
                };
            }),
            ("no offsets", Caught, |f| {
                f.offsets = Vec::clear;
            }),
            ("offsets that lack groups", Caught, |f| {
                f.offsets = |offsets| offsets.truncate(2);
            }),
            ("a group in two parts", Caught, split_chunk_indexes),
            (
                "a group in two parts, of which one has an offset",
                Caught,
                |f| {
                    split_chunk_indexes(f);
                    f.offsets = |offsets| {
                        offsets.pop();
                    };
                },
            ),
            ("offsets twice", Caught, |f| {
                f.offsets = |offsets| offsets.extend(offsets.clone());
            }),
            ("a footer that leads to the second offset", Caught, |f| {
                f.offsets_start = |start| start + 26;
            }),
            ("a footer without offsets", Caught, |f| {
                f.offsets_start = |_| 0;
            }),
            ("an index with other times", Caught, |f| {
                f.indexes = |indexes| indexes[0].1[6] ^= 1;
            }),
        ],
    );
}

#[test]
fn to_claim_to_be_old_or_new_is_no_way_out() {
    try_all(
        Encoding::Protobuf,
        &[
            ("an old version", Caught, |f| {
                let of_form = ["telemetry", "encoding", "views", "topics"];
                f.entries("toprise.run")
                    .retain(|(key, _)| !of_form.contains(&key.as_str()));
                f.set("toprise.run", "version", "0.1.0");
            }),
            ("an old telemetry", Caught, |f| {
                f.set("toprise.run", "telemetry", "1");
            }),
            ("no telemetry", Caught, |f| {
                f.set("toprise.run", "telemetry", "best");
            }),
            ("a newer telemetry", Caught, |f| {
                f.set("toprise.run", "telemetry", "1000");
            }),
            ("a newer telemetry with another number", Caught, |f| {
                f.set("toprise.run", "telemetry", "1000");
                f.messages("/top/energy", other_view);
            }),
        ],
    );
}

#[test]
fn another_telemetry_is_compared_by_the_names_of_its_fields() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("newer.mcap");
    let verdict = |change: fn(&mut Forgery)| {
        let mut forgery = Forgery::of(&recorded(Encoding::Json));
        forgery.set("toprise.run", "telemetry", "1000");
        // Another field in the place of one, and a topic less.
        let renamed = |data: &mut Vec<u8>| {
            let text = String::from_utf8(std::mem::take(data)).unwrap();
            *data = text.replace("\"potential\"", "\"novel\"").into_bytes();
        };
        forgery.schema("/top/energy", |_, _, data| renamed(data));
        forgery.messages("/top/energy", |message| renamed(&mut message.data));
        forgery.leave_out("/top/contact");
        change(&mut forgery);
        forgery.write(&path);
        verified(&path).verdict
    };
    assert_eq!(verdict(|_| {}), Verdict::OtherVersion);
    let other = verdict(|f| {
        f.edit("/top/energy", 7, |text| {
            text.replace("\"kinetic\":1.", "\"kinetic\":2.")
        });
    });
    assert_eq!(other, Verdict::Different);
}

#[test]
fn a_run_without_the_end_of_its_simulation_is_not_verified() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("cut.mcap");
    let mut forgery = Forgery::of(&recorded(Encoding::Json));
    forgery.drop(|r| matches!(r, Record::Metadata(name, _) if name == "toprise.end"));
    forgery.write(&path);
    let report = verified(&path);
    assert_eq!(report.verdict, Verdict::Incomplete, "{report:#?}");
}

/// Readers that follow the index would see other things than those that follow the data, however much of the run is there.
#[test]
fn an_index_that_contradicts_the_data_is_different_in_parts_of_runs_too() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.mcap");
    let parts: [fn(&mut Forgery); 3] = [
        |f| f.drop(|r| matches!(r, Record::Metadata(name, _) if name == "toprise.end")),
        |f| {
            f.is_digest_right = false;
            f.last_chunk().pop();
        },
        |f| f.set("toprise.run", "version", "0.1.9"),
    ];
    for part in parts {
        let mut forgery = Forgery::of(&recorded(Encoding::Json));
        part(&mut forgery);
        let sound = forgery.clone();
        sound.write(&path);
        let report = verified(&path);
        assert_ne!(report.verdict, Verdict::Different, "{report:#?}");
        forgery.summary = |summary| {
            let index = summary.iter_mut().find(|raw| raw.0 == op::CHUNK_INDEX);
            *index.unwrap().1.last_mut().unwrap() = 1;
        };
        forgery.write(&path);
        assert_eq!(verified(&path).verdict, Verdict::Different);
    }
}

/// Python's `mcap` writes no checksum of the data unless it is asked to.
#[test]
fn a_file_without_a_checksum_of_its_data_is_packed_otherwise() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.mcap");
    let mut bytes = recorded(Encoding::Json);
    // The footer's first number says where the summary begins: behind the checksum.
    let footer = bytes.len() - mcap::MAGIC.len() - 20;
    let summary = u64::from_le_bytes(bytes[footer..footer + 8].try_into().unwrap()) as usize;
    bytes[summary - 4..summary].fill(0);
    fs::write(&path, &bytes).unwrap();
    assert_eq!(verified(&path).verdict, Verdict::PackedOtherwise);
    bytes[summary - 4] = 1;
    fs::write(&path, &bytes).unwrap();
    assert_eq!(verified(&path).verdict, Verdict::Different);
}

/// A text of megabytes is no scenario, and is not given to a parser.
#[test]
fn a_scenario_of_megabytes_is_not_read() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.mcap");
    let mut forgery = Forgery::of(&recorded(Encoding::Json));
    forgery.scenario().data = vec![b' '; 2 << 20];
    fs::write(&path, forgery.bytes()).unwrap();
    let recording = Recording::open(&path).unwrap();
    let reason = recording.scenario_text().unwrap_err().to_string();
    assert!(reason.contains("it is longer than"), "{reason}");
}
