//! Takes a recording apart, and writes it again with checksums, indexes and a digest that fit its content.

use binrw::{BinRead as _, BinWrite};
use mcap::records::{
    AttachmentHeader, AttachmentIndex, Channel, ChunkHeader, ChunkIndex, DataEnd, Footer, Header,
    MessageHeader, MessageIndex, MessageIndexEntry, Metadata, MetadataIndex, Record as Parsed,
    SchemaHeader, Statistics, SummaryOffset, op,
};
use std::collections::BTreeMap;
use std::fs;
use std::io::Cursor;
use std::path::Path;
use std::rc::Rc;
use toprise::archive::recording::{Recording, Selection};
use toprise::telemetry::digest::ContentDigest;

/// The metadata at the start of a recording.
pub const RUN: &str = "toprise.run";
/// The metadata at the end of a recording.
pub const END: &str = "toprise.end";

/// A record as it is written: opcode and body.
pub type Raw = (u8, Vec<u8>);

/// A change to a value that is about to be written.
pub type Change<T> = Rc<dyn Fn(&mut T)>;

/// A record of an MCAP file, with all fields that a forgery can change.
#[derive(Clone)]
pub enum Record {
    Metadata(Metadata),
    Attachment(AttachmentHeader, Vec<u8>),
    Schema(SchemaHeader, Vec<u8>),
    Channel(Channel),
    Message(MessageHeader, Vec<u8>),
    Chunk(Vec<Record>),
    Other(Raw),
}

/// The bytes of a record's fields.
pub fn body(fields: &impl for<'a> BinWrite<Args<'a> = ()>) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    fields.write_le(&mut bytes).unwrap();
    bytes.into_inner()
}

/// A record with its opcode and length in front.
pub fn framed((opcode, body): &Raw) -> Vec<u8> {
    [&[*opcode], &(body.len() as u64).to_le_bytes()[..], body].concat()
}

/// A metadata record.
pub fn metadata(name: &str, entries: &[(&str, &str)]) -> Record {
    let entries = entries.iter();
    Record::Metadata(Metadata {
        name: name.to_owned(),
        metadata: entries.map(|(k, v)| ((*k).into(), (*v).into())).collect(),
    })
}

/// Selects metadata by its name.
pub fn named(name: &str) -> impl Fn(&Record) -> bool {
    move |record| matches!(record, Record::Metadata(metadata) if metadata.name == name)
}

impl Record {
    pub fn raw(&self) -> Raw {
        match self {
            Self::Metadata(metadata) => (op::METADATA, body(metadata)),
            Self::Attachment(header, data) => {
                let length = (data.len() as u64).to_le_bytes();
                let mut bytes = [&body(header)[..], &length, data].concat();
                bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
                (op::ATTACHMENT, bytes)
            }
            Self::Schema(header, data) => {
                let length = (data.len() as u32).to_le_bytes();
                (op::SCHEMA, [&body(header)[..], &length, data].concat())
            }
            Self::Channel(channel) => (op::CHANNEL, body(channel)),
            Self::Message(header, data) => (op::MESSAGE, [&body(header)[..], data].concat()),
            Self::Chunk(records) => {
                let content: Vec<u8> = records.iter().flat_map(|r| framed(&r.raw())).collect();
                let times = || records.iter().filter_map(Self::time);
                let header = ChunkHeader {
                    message_start_time: times().min().unwrap_or(0),
                    message_end_time: times().max().unwrap_or(0),
                    uncompressed_size: content.len() as u64,
                    uncompressed_crc: crc32fast::hash(&content),
                    compression: String::new(),
                    compressed_size: content.len() as u64,
                };
                (op::CHUNK, [body(&header), content].concat())
            }
            Self::Other(raw) => raw.clone(),
        }
    }

    fn time(&self) -> Option<u64> {
        match self {
            Self::Message(message, _) => Some(message.log_time),
            _ => None,
        }
    }
}

/// A recording taken apart.
#[derive(Clone)]
pub struct Forgery {
    pub header: Header,
    /// The records before the end of the data.
    pub records: Vec<Record>,
    /// Changes what the summary repeats and indexes, before its offsets are computed.
    pub summary: Change<Vec<Raw>>,
    /// Changes the order of the summary's records, which stand in groups.
    pub order: Change<Vec<Raw>>,
    /// Changes the offsets of the summary.
    pub offsets: Change<Vec<Raw>>,
    /// Changes where the footer says that the offsets are.
    pub offsets_start: Change<u64>,
    /// Changes the records after a chunk, which index it.
    pub indexes: Change<Vec<Raw>>,
    /// Changes a record of the data before it is written.
    pub written: Change<Raw>,
    pub before_magic: Vec<u8>,
    pub before_last_magic: Vec<u8>,
    pub is_digest_right: bool,
}

/// The file while it is written.
#[derive(Default)]
struct Writing {
    bytes: Vec<u8>,
    schemas: BTreeMap<u16, Raw>,
    channels: BTreeMap<u16, Raw>,
    indexes: Vec<Raw>,
    statistics: Statistics,
}

impl Writing {
    /// Writes a record; returns its offset and length.
    fn add(&mut self, raw: &Raw) -> (u64, u64) {
        let offset = self.bytes.len() as u64;
        self.bytes.extend(framed(raw));
        (offset, self.bytes.len() as u64 - offset)
    }

    fn data(&mut self, record: &Record, forgery: &Forgery) {
        let mut raw = record.raw();
        (forgery.written)(&mut raw);
        let (offset, length) = self.add(&raw);
        match record {
            Record::Metadata(metadata) => {
                self.statistics.metadata_count += 1;
                let index = MetadataIndex {
                    offset,
                    length,
                    name: metadata.name.clone(),
                };
                self.indexes.push((op::METADATA_INDEX, body(&index)));
            }
            Record::Attachment(header, data) => {
                self.statistics.attachment_count += 1;
                let index = AttachmentIndex {
                    offset,
                    length,
                    log_time: header.log_time,
                    create_time: header.create_time,
                    data_size: data.len() as u64,
                    name: header.name.clone(),
                    media_type: header.media_type.clone(),
                };
                self.indexes.push((op::ATTACHMENT_INDEX, body(&index)));
            }
            Record::Chunk(records) => {
                self.statistics.chunk_count += 1;
                let header = ChunkHeader::read_le(&mut Cursor::new(&raw.1)).unwrap();
                self.index_chunk(records, header, (offset, length), &forgery.indexes);
            }
            other => self.define(other),
        }
    }

    fn define(&mut self, record: &Record) {
        match record {
            Record::Schema(SchemaHeader { id, .. }, _) => {
                self.schemas.entry(*id).or_insert_with(|| record.raw());
            }
            Record::Channel(Channel { id, .. }) => {
                self.channels.entry(*id).or_insert_with(|| record.raw());
            }
            Record::Message(message, _) => {
                let (statistics, time) = (&mut self.statistics, message.log_time);
                if statistics.message_count == 0 {
                    statistics.message_start_time = time;
                }
                statistics.message_count += 1;
                statistics.message_start_time = time.min(statistics.message_start_time);
                statistics.message_end_time = time.max(statistics.message_end_time);
                let counts = &mut statistics.channel_message_counts;
                *counts.entry(message.channel_id).or_default() += 1;
            }
            _ => {}
        }
    }

    fn index_chunk(
        &mut self,
        records: &[Record],
        header: ChunkHeader,
        (chunk_start_offset, chunk_length): (u64, u64),
        change: &Change<Vec<Raw>>,
    ) {
        let mut entries: BTreeMap<u16, Vec<MessageIndexEntry>> = BTreeMap::new();
        let mut offset = 0;
        for record in records {
            self.define(record);
            if let Record::Message(message, _) = record {
                let log_time = message.log_time;
                let entries = entries.entry(message.channel_id).or_default();
                entries.push(MessageIndexEntry { log_time, offset });
            }
            offset += framed(&record.raw()).len() as u64;
        }
        let index = |(channel_id, records)| MessageIndex {
            channel_id,
            records,
        };
        let indexes = entries.into_iter().map(index);
        let mut indexes = indexes.map(|i| (op::MESSAGE_INDEX, body(&i))).collect();
        change(&mut indexes);
        let start = self.bytes.len();
        let mut message_index_offsets = BTreeMap::new();
        for index in &indexes {
            let (offset, _) = self.add(index);
            if let (op::MESSAGE_INDEX, [low, high, ..]) = (index.0, &index.1[..]) {
                message_index_offsets.insert(u16::from_le_bytes([*low, *high]), offset);
            }
        }
        let index = ChunkIndex {
            message_start_time: header.message_start_time,
            message_end_time: header.message_end_time,
            chunk_start_offset,
            chunk_length,
            message_index_offsets,
            message_index_length: (self.bytes.len() - start) as u64,
            compression: header.compression,
            compressed_size: header.compressed_size,
            uncompressed_size: header.uncompressed_size,
        };
        self.indexes.push((op::CHUNK_INDEX, body(&index)));
    }

    fn end(&mut self, forgery: &Forgery) {
        let data_section_crc = crc32fast::hash(&self.bytes);
        self.add(&(op::DATA_END, body(&DataEnd { data_section_crc })));
        let (schemas, channels) = (self.schemas.values(), self.channels.values());
        let mut summary: Vec<Raw> = schemas.chain(channels).cloned().collect();
        self.statistics.schema_count = self.schemas.len() as u16;
        self.statistics.channel_count = self.channels.len() as u32;
        summary.push((op::STATISTICS, body(&self.statistics)));
        summary.append(&mut self.indexes);
        (forgery.summary)(&mut summary);
        summary.sort_by_key(|(opcode, _)| *opcode);
        (forgery.order)(&mut summary);
        let summary_start = self.bytes.len() as u64;
        let mut offsets: Vec<Raw> = Vec::new();
        for group in summary.chunk_by(|one, next| one.0 == next.0) {
            let group_start = self.bytes.len() as u64;
            for raw in group {
                self.add(raw);
            }
            let offset = SummaryOffset {
                group_opcode: group[0].0,
                group_start,
                group_length: self.bytes.len() as u64 - group_start,
            };
            offsets.push((op::SUMMARY_OFFSET, body(&offset)));
        }
        (forgery.offsets)(&mut offsets);
        let mut footer = Footer {
            summary_start,
            summary_offset_start: self.bytes.len() as u64,
            summary_crc: 0,
        };
        (forgery.offsets_start)(&mut footer.summary_offset_start);
        for offset in &offsets {
            self.add(offset);
        }
        let head = framed(&(op::FOOTER, body(&footer)));
        let summary = &self.bytes[summary_start as usize..];
        footer.summary_crc = crc32fast::hash(&[summary, &head[..head.len() - 4]].concat());
        self.add(&(op::FOOTER, body(&footer)));
    }
}

impl Forgery {
    /// Takes a recording apart.
    pub fn of(bytes: &[u8]) -> Self {
        let mut header = None;
        let (mut records, mut chunk) = (Vec::new(), Vec::new());
        for record in mcap::read::ChunkFlattener::new(bytes).unwrap() {
            match record.unwrap() {
                Parsed::Header(found) => header = Some(found),
                Parsed::Metadata(found) => {
                    // Several chunks, so that there is something to mix up.
                    records.extend(chunk.chunks(150).map(|part| Record::Chunk(part.to_vec())));
                    chunk.clear();
                    records.push(Record::Metadata(found));
                }
                Parsed::Attachment { header, data, .. } => {
                    records.push(Record::Attachment(header, data.into_owned()));
                }
                Parsed::Schema { header, data } => {
                    chunk.push(Record::Schema(header, data.into_owned()));
                }
                Parsed::Channel(found) => chunk.push(Record::Channel(found)),
                Parsed::Message { header, data } => {
                    chunk.push(Record::Message(header, data.into_owned()));
                }
                Parsed::DataEnd(_) => break,
                _ => {}
            }
        }
        Self {
            header: header.unwrap(),
            records,
            summary: Rc::new(|_| {}),
            order: Rc::new(|_| {}),
            offsets: Rc::new(|_| {}),
            offsets_start: Rc::new(|_| {}),
            written: Rc::new(|_| {}),
            indexes: Rc::new(|_| {}),
            before_magic: Vec::new(),
            before_last_magic: Vec::new(),
            is_digest_right: true,
        }
    }

    pub fn bytes(&self) -> Vec<u8> {
        let mut writing = Writing::default();
        writing.bytes.extend(&self.before_magic);
        writing.bytes.extend(mcap::MAGIC);
        writing.add(&(op::HEADER, body(&self.header)));
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
        if !self.is_digest_right {
            return;
        }
        let mut digest = ContentDigest::default();
        let topics = recording.topics().into_iter();
        let mut counts: BTreeMap<String, u64> = topics.map(|t| (t.to_string(), 0)).collect();
        let mut reader = recording.reader(Selection::default());
        while let Some(message) = reader.next() {
            let Ok(message) = message else { continue };
            digest.update(&message);
            *counts.entry(message.topic().to_string()).or_default() += 1;
        }
        let count = |topic| counts.get(topic).map(u64::to_string);
        let fitting = [
            ("content_digest", Some(digest.finish())),
            ("samples", count("/top/state")),
            ("events", count("/events")),
            ("nutations", count("/top/nutation")),
        ];
        for record in self.records.iter_mut().filter(|record| named(END)(record)) {
            let Record::Metadata(Metadata { metadata, .. }) = record else {
                unreachable!("it has a name");
            };
            for (key, fitting) in &fitting {
                if let (Some(value), Some(fitting)) = (metadata.get_mut(*key), fitting) {
                    value.clone_from(fitting);
                }
            }
        }
        fs::write(path, self.bytes()).unwrap();
    }

    /// Changes all records, also those in chunks.
    pub fn each(&mut self, mut change: impl FnMut(&mut Record)) {
        for record in &mut self.records {
            match record {
                Record::Chunk(inner) => inner.iter_mut().for_each(&mut change),
                other => change(other),
            }
        }
    }

    /// Leaves out records, also in chunks.
    pub fn drop(&mut self, is_it: impl Fn(&Record) -> bool) {
        for record in &mut self.records {
            if let Record::Chunk(inner) = record {
                inner.retain(|record| !is_it(record));
            }
        }
        let is_empty = |record: &Record| matches!(record, Record::Chunk(inner) if inner.is_empty());
        self.records
            .retain(|record| !is_it(record) && !is_empty(record));
    }

    /// Leaves out messages.
    pub fn drop_messages(&mut self, is_it: impl Fn(&MessageHeader) -> bool) {
        self.drop(|record| matches!(record, Record::Message(message, _) if is_it(message)));
    }

    /// Leaves out a channel, its schema and its messages.
    pub fn leave_out(&mut self, topic: &str) {
        let (id, schema) = self.id(topic);
        self.drop_messages(|message| message.channel_id == id);
        self.drop(|record| matches!(record, Record::Channel(channel) if channel.id == id));
        let mut is_used = false;
        self.each(|r| is_used |= matches!(r, Record::Channel(c) if c.schema_id == schema));
        self.drop(|r| !is_used && matches!(r, Record::Schema(s, _) if s.id == schema));
    }

    /// Finds something in the records outside of chunks.
    fn find<'a, T>(
        &'a mut self,
        what: impl FnMut(&'a mut Record) -> Option<&'a mut T>,
    ) -> &'a mut T {
        self.records.iter_mut().find_map(what).unwrap()
    }

    /// The entries of a metadata record.
    pub fn entries(&mut self, name: &str) -> &mut BTreeMap<String, String> {
        self.find(|record| match record {
            Record::Metadata(found) if found.name == name => Some(&mut found.metadata),
            _ => None,
        })
    }

    /// Sets an entry of a metadata record.
    pub fn set(&mut self, record: &str, key: &str, value: &str) {
        let entries = self.entries(record);
        entries.insert(key.to_owned(), value.to_owned());
    }

    /// Adds a metadata record.
    pub fn add(&mut self, name: &str, entries: &[(&str, &str)]) {
        self.records.insert(1, metadata(name, entries));
    }

    /// Adds a metadata record, an attachment and a channel of others with two messages.
    pub fn add_supplements(&mut self) {
        let text = |text: &str| text.to_owned();
        let attachment = AttachmentHeader {
            log_time: 5,
            create_time: 6,
            name: text("notes.txt"),
            media_type: text("text/plain"),
        };
        let schema = SchemaHeader {
            id: 900,
            name: text("lab.Note"),
            encoding: text("jsonschema"),
        };
        let channel = Channel {
            id: 901,
            schema_id: 900,
            topic: text("/lab/note"),
            message_encoding: text("json"),
            metadata: BTreeMap::new(),
        };
        let message = |log_time| {
            let header = MessageHeader {
                channel_id: 901,
                sequence: 3,
                log_time,
                publish_time: 8,
            };
            Record::Message(header, b"{}".to_vec())
        };
        let chunk = vec![
            Record::Schema(schema, b"{}".to_vec()),
            Record::Channel(channel),
            message(7),
            message(20_000_000),
        ];
        // Forgeries of the last chunk are of the run.
        let is_chunk = |record: &Record| matches!(record, Record::Chunk(_));
        let last = self.records.iter().rposition(is_chunk).unwrap();
        self.records.splice(
            last..last,
            [
                Record::Chunk(chunk),
                Record::Attachment(attachment, b"measured at night".to_vec()),
                metadata("lab", &[("place", "cellar")]),
            ],
        );
    }

    /// The header of the attachment with the scenario.
    pub fn scenario(&mut self) -> &mut AttachmentHeader {
        self.find(|record| match record {
            Record::Attachment(header, _) => Some(header),
            _ => None,
        })
    }

    /// The TOML of the attachment with the scenario.
    pub fn toml(&mut self) -> &mut Vec<u8> {
        self.find(|record| match record {
            Record::Attachment(_, data) => Some(data),
            _ => None,
        })
    }

    /// Replaces a text in the scenario; returns the new scenario.
    pub fn edit_scenario(&mut self, from: &str, to: &str) -> String {
        let toml = String::from_utf8(self.toml().clone()).unwrap();
        assert!(toml.contains(from), "{toml}");
        let edited = toml.replacen(from, to, 1);
        *self.toml() = edited.clone().into_bytes();
        edited
    }

    /// Adds a changed copy of the attachment with the scenario.
    pub fn attach(&mut self, change: impl FnOnce(&mut AttachmentHeader, &mut Vec<u8>)) {
        let (mut header, mut data) = (self.scenario().clone(), self.toml().clone());
        change(&mut header, &mut data);
        self.records.insert(2, Record::Attachment(header, data));
    }

    pub fn channel(&mut self, topic: &str, mut change: impl FnMut(&mut Channel)) {
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

    /// The record of a channel, with changes.
    pub fn like(&mut self, topic: &str, change: impl FnOnce(&mut Channel)) -> Record {
        let mut found = None;
        self.channel(topic, |channel| found = Some(channel.clone()));
        let mut channel = found.unwrap();
        change(&mut channel);
        Record::Channel(channel)
    }

    /// The record of a channel, as one of another number and topic.
    pub fn another(&mut self, like: &str, topic: &str) -> Record {
        self.like(like, |channel| {
            (channel.id, channel.topic) = (99, topic.to_owned());
        })
    }

    /// The numbers of a channel and of its schema.
    pub fn id(&mut self, topic: &str) -> (u16, u16) {
        let mut ids = (0, 0);
        self.channel(topic, |channel| ids = (channel.id, channel.schema_id));
        ids
    }

    pub fn schema(&mut self, topic: &str, change: impl Fn(&mut SchemaHeader, &mut Vec<u8>)) {
        let (_, schema) = self.id(topic);
        self.each(|record| match record {
            Record::Schema(header, data) if header.id == schema => change(header, data),
            _ => {}
        });
    }

    pub fn messages(
        &mut self,
        topic: &str,
        mut change: impl FnMut(&mut MessageHeader, &mut Vec<u8>),
    ) {
        let (id, _) = self.id(topic);
        self.each(|record| match record {
            Record::Message(header, data) if header.channel_id == id => change(header, data),
            _ => {}
        });
    }

    /// Changes the text of the JSON message with a number.
    pub fn edit(&mut self, topic: &str, number: u32, change: impl Fn(&str) -> String) {
        self.messages(topic, |header, data| {
            if header.sequence == number {
                let before = data.clone();
                edit(data, &change);
                assert_ne!(before, *data);
            }
        });
    }

    /// The records of the first chunk, which begins with schemas and channels.
    pub fn first_chunk(&mut self) -> &mut Vec<Record> {
        self.find(|record| match record {
            Record::Chunk(records) => Some(records),
            _ => None,
        })
    }

    /// The first record of a schema.
    pub fn first_schema(&mut self) -> Record {
        let is_schema = |record: &&Record| matches!(record, Record::Schema(..));
        self.first_chunk().iter().find(is_schema).unwrap().clone()
    }

    /// The records of the last chunk.
    pub fn last_chunk(&mut self) -> &mut Vec<Record> {
        let found = self.records.iter_mut().rev().find_map(|found| match found {
            Record::Chunk(records) => Some(records),
            _ => None,
        });
        found.unwrap()
    }

    /// Orders the messages of one time otherwise.
    pub fn reorder<K: Ord>(&mut self, key: impl Fn(&MessageHeader) -> K) {
        for record in &mut self.records {
            if let Record::Chunk(chunk) = record {
                chunk.sort_by_key(|record| match record {
                    Record::Message(message, _) => Some((message.log_time, key(message))),
                    _ => None,
                });
            }
        }
    }

    /// Moves a record of the data to another place.
    pub fn shift(&mut self, to: usize, is_it: impl Fn(&Record) -> bool) {
        let at = self.records.iter().position(is_it).unwrap();
        let record = self.records.remove(at);
        self.records.insert(to.min(self.records.len()), record);
    }

    /// Changes the first record of this opcode in the summary.
    pub fn in_summary(&mut self, opcode: u8, change: impl Fn(&mut Vec<u8>) + 'static) {
        self.summary = Rc::new(move |summary| {
            let found = summary.iter_mut().find(|raw| raw.0 == opcode);
            change(&mut found.unwrap().1);
        });
    }

    /// Repeats the first record of this opcode in the summary.
    pub fn twice_in_summary(&mut self, opcode: u8) {
        self.summary = Rc::new(move |summary| {
            let found = summary.iter().find(|raw| raw.0 == opcode);
            summary.push(found.unwrap().clone());
        });
    }

    /// Leaves out the first record of this opcode in the summary.
    pub fn not_in_summary(&mut self, opcode: u8) {
        self.summary = Rc::new(move |summary| {
            let at = summary.iter().position(|raw| raw.0 == opcode);
            summary.remove(at.unwrap());
        });
    }

    /// Compresses the chunks.
    pub fn pack(&mut self, name: &'static str, compress: impl Fn(&[u8]) -> Vec<u8> + 'static) {
        self.written = Rc::new(move |(opcode, bytes)| {
            if *opcode == op::CHUNK {
                let mut header = ChunkHeader::read_le(&mut Cursor::new(&bytes)).unwrap();
                let packed = compress(&bytes[40..]);
                name.clone_into(&mut header.compression);
                header.compressed_size = packed.len() as u64;
                *bytes = [body(&header), packed].concat();
            }
        });
    }
}

/// Changes a text.
pub fn edit(data: &mut Vec<u8>, change: impl Fn(&str) -> String) {
    *data = change(std::str::from_utf8(data).unwrap()).into_bytes();
}
