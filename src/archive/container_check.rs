//! The file as an MCAP file: structure, checksums, indexes.

use crate::archive::check::{Check, Group, Problems, Verdict};
use crate::archive::container::channels::Channels;
use crate::archive::container::layout::{read_footer, summary_checksum};
use crate::archive::container::record::{HEAD, RecordSpan, content_length, head, is_known, parse};
use crate::archive::container::scan::{Found, Scanner};
use crate::archive::container::section::{
    Buffers, InnerRecord, MessageRecord, Packing, Section, record_at,
};
use crate::archive::container::source::Source;
use crate::archive::format::{END_RECORD, LOST, RUN_RECORD, SCENARIO_ATTACHMENT, STOP_REASON};
use crate::archive::recording::{Condition, Recording};
use mcap::records::{AttachmentIndex, MessageIndexEntry, MetadataIndex, Record, Statistics, op};
use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::ops::Range;

/// The length of the record that ends the data.
const DATA_END: u64 = HEAD + 4;

/// Whether nothing is wrong with a recording as an MCAP file.
pub(crate) fn is_sound_container(recording: &Recording) -> bool {
    let checks = check(recording, &|_| {});
    checks.iter().all(|check| check.verdict != Verdict::Failed)
}

/// Checks the container.
pub(crate) fn check(recording: &Recording, progress: &dyn Fn(u64)) -> Vec<Check> {
    let mut survey = Survey::new(recording);
    if let Err(error) = survey.take_all(progress) {
        survey
            .structure
            .add(|| format!("it can't be read: {error}"));
    }
    survey.checks()
}

/// The kinds of records that a summary groups.
const GROUPED: [u8; 6] = [
    op::SCHEMA,
    op::CHANNEL,
    op::STATISTICS,
    op::CHUNK_INDEX,
    op::ATTACHMENT_INDEX,
    op::METADATA_INDEX,
];

/// What is seen in going through the file.
struct Survey<'a> {
    recording: &'a Recording,
    source: &'a Source,
    buffers: Buffers,
    structure: Problems,
    checksums: Problems,
    index: Problems,
    records: u64,
    /// The opcode of the record before.
    previous: Option<u8>,
    is_ended: bool,
    data_end: Option<u64>,
    footer: Option<RecordSpan>,
    /// Where each chunk stands, with its length.
    chunks: BTreeMap<u64, ChunkSeen>,
    /// The chunk that was read last.
    last_chunk: Option<u64>,
    /// Records that an index may point to: opcode and length by offset.
    places: BTreeMap<u64, (u8, u64)>,
    indexed: BTreeSet<u64>,
    /// What the indexes of attachments and metadata have to say, by offset.
    attachments: BTreeMap<u64, AttachmentIndex>,
    metadata: BTreeMap<u64, MetadataIndex>,
    /// Schemas and channels, wherever they are defined: everywhere alike.
    channels: Channels,
    /// Opcodes and ids of those that are defined before the end of the data, and behind it.
    defined: [BTreeSet<(u8, u16)>; 2],
    /// The groups that the summary says to have: opcode, start and length.
    groups: Vec<(u8, u64, u64)>,
    /// Where the record `toprise.end` stands.
    end_record: Option<u64>,
    counts: Counts,
    statistics: Option<Statistics>,
}

/// A chunk's messages, until its indexes have been compared with them.
struct ChunkSeen {
    length: u64,
    span: (u64, u64),
    packing: Packing,
    messages: BTreeMap<u16, Vec<MessageIndexEntry>>,
    indexes: BTreeMap<u16, u64>,
    indexes_length: u64,
    /// Whether some of its messages stand in no index.
    is_unindexed: bool,
}

/// What the statistics record counts.
#[derive(Default)]
struct Counts {
    schemas: BTreeSet<u16>,
    channels: BTreeSet<u16>,
    attachments: u32,
    metadata: u32,
    chunks: u32,
    messages: BTreeMap<u16, u64>,
    span: Option<(u64, u64)>,
}

impl Counts {
    fn message(&mut self, message: &MessageRecord<'_>) {
        *self.messages.entry(message.channel_id).or_insert(0) += 1;
        self.span = Some(widened(self.span, message.log_time));
    }
}

fn widened(span: Option<(u64, u64)>, time: u64) -> (u64, u64) {
    span.map_or((time, time), |(first, last)| {
        (first.min(time), last.max(time))
    })
}

impl<'a> Survey<'a> {
    fn new(recording: &'a Recording) -> Self {
        Self {
            recording,
            source: &recording.source,
            buffers: Buffers::default(),
            structure: Problems::default(),
            checksums: Problems::default(),
            index: Problems::default(),
            records: 0,
            previous: None,
            is_ended: false,
            data_end: None,
            footer: None,
            chunks: BTreeMap::new(),
            last_chunk: None,
            places: BTreeMap::new(),
            indexed: BTreeSet::new(),
            attachments: BTreeMap::new(),
            metadata: BTreeMap::new(),
            channels: Channels::default(),
            defined: Default::default(),
            groups: Vec::new(),
            end_record: None,
            counts: Counts::default(),
            statistics: None,
        }
    }

    fn take_all(&mut self, progress: &dyn Fn(u64)) -> io::Result<()> {
        let source = self.source;
        let mut scanner = Scanner::new(source);
        let mut told = 0;
        while let Some(found) = scanner.next()? {
            match found {
                Found::Record(place) => {
                    self.records += 1;
                    self.take(&place)?;
                    progress(place.end() - told);
                    told = place.end();
                }
                Found::Damage(bytes) => self.structure.add(|| {
                    let count = bytes.end - bytes.start;
                    format!("{count} bytes at {} are no record", bytes.start)
                }),
                Found::Cut(bytes) => {
                    let is_cut = self.recording.end().is_none() || self.is_cut_off(&bytes)?;
                    self.structure.unless(is_cut, || {
                        format!(
                            "the {} bytes at {} are no record",
                            bytes.end - bytes.start,
                            bytes.start
                        )
                    });
                }
                Found::End => self.is_ended = true,
            }
        }
        progress(source.length() - told);
        if self.is_ended {
            self.check_ends()?;
        }
        Ok(())
    }

    /// Whether the last bytes of a file are the beginning of a record or of the magic bytes.
    fn is_cut_off(&self, bytes: &Range<u64>) -> io::Result<bool> {
        let mut start = Vec::new();
        self.source.read(bytes.start, HEAD, &mut start)?;
        let room = bytes.end - bytes.start;
        Ok(match head(&start) {
            Some((opcode, length)) => is_known(opcode) && HEAD + length > room,
            None => mcap::MAGIC.starts_with(&start) || is_known(start[0]),
        })
    }

    fn take(&mut self, place: &RecordSpan) -> io::Result<()> {
        let is_in_place = (place.opcode == op::HEADER) == (self.records == 1)
            && (!self.is_ours() || self.is_in_place(place.opcode));
        self.structure.unless(is_in_place, || {
            format!("the record at {} is out of place", place.offset)
        });
        self.previous = Some(place.opcode);
        match place.opcode {
            op::CHUNK => return self.take_chunk(place),
            // No index points to them by their places, and there may be many.
            op::MESSAGE | op::MESSAGE_INDEX => {}
            opcode => {
                let found = (opcode, place.length);
                self.places.insert(place.offset, found);
            }
        }
        if place.opcode == op::DATA_END {
            self.structure.unless(self.data_end.is_none(), || {
                format!("the data end a second time at {}", place.offset)
            });
            self.data_end = Some(place.offset);
        }
        if place.opcode == op::FOOTER {
            self.footer = Some(place.clone());
        }
        let mut bytes = Vec::new();
        self.source.read(place.offset, place.length, &mut bytes)?;
        let body = bytes.get(HEAD as usize..).unwrap_or_default();
        match parse(place.opcode, body) {
            Ok(record) => {
                let is_read = content_length(&record).is_none_or(|length| length == body.len());
                self.structure.unless(is_read || !self.is_ours(), || {
                    format!(
                        "the record at {} holds more than is read of it",
                        place.offset
                    )
                });
                self.take_record(place, record, body);
            }
            Err(error) => self
                .structure
                .add(|| format!("the record at {} can't be read: {error}", place.offset)),
        }
        Ok(())
    }

    /// Whether toprise wrote the file, by its own words.
    fn is_ours(&self) -> bool {
        self.recording.condition() != Condition::Foreign
    }

    /// Whether recordings of toprise have such a record here: all messages are in chunks, indexed right behind
    /// them, and what only says where things are stands behind the end of the data.
    fn is_in_place(&self, opcode: u8) -> bool {
        let in_data = self.data_end.is_none_or(|_| opcode == op::DATA_END);
        self.footer.is_none()
            && match opcode {
                // Only a run that was cut off before its first chunk has them outside of chunks.
                op::SCHEMA | op::CHANNEL if in_data => {
                    self.counts.chunks == 0 && self.recording.condition() == Condition::Interrupted
                }
                op::SCHEMA | op::CHANNEL => true,
                op::MESSAGE_INDEX => {
                    let previous = self.previous;
                    in_data && matches!(previous, Some(op::CHUNK | op::MESSAGE_INDEX))
                }
                op::HEADER | op::CHUNK | op::ATTACHMENT | op::METADATA | op::DATA_END => in_data,
                op::STATISTICS
                | op::CHUNK_INDEX
                | op::ATTACHMENT_INDEX
                | op::METADATA_INDEX
                | op::SUMMARY_OFFSET
                | op::FOOTER => !in_data,
                _ => false,
            }
    }

    /// Takes in a schema or a channel, wherever it is defined.
    fn define(&mut self, record: Record<'_>) {
        let (opcode, id) = match &record {
            Record::Schema { header, .. } => (op::SCHEMA, header.id),
            Record::Channel(channel) => (op::CHANNEL, channel.id),
            _ => return,
        };
        match opcode {
            op::SCHEMA => self.counts.schemas.insert(id),
            _ => self.counts.channels.insert(id),
        };
        let defined = &mut self.defined[usize::from(self.data_end.is_some())];
        let is_first = defined.insert((opcode, id));
        let what = match opcode {
            op::SCHEMA => "schema",
            _ => "channel",
        };
        self.structure.unless(is_first || !self.is_ours(), || {
            format!("{what} {id} is defined a second time")
        });
        self.structure.unless(opcode != op::SCHEMA || id != 0, || {
            "a schema has the number 0, which stands for none".to_owned()
        });
        self.channels.define(record);
    }

    fn take_record(&mut self, place: &RecordSpan, record: Record<'_>, body: &[u8]) {
        let in_data = self.data_end.is_none();
        match record {
            Record::Schema { .. } | Record::Channel(_) => self.define(record),
            Record::Message { .. } => {
                let inner = InnerRecord {
                    opcode: op::MESSAGE,
                    body,
                };
                if let Some(message) = MessageRecord::parse(&inner) {
                    self.counts.message(&message);
                }
            }
            Record::MessageIndex(found) => {
                self.check_message_index(place, found.channel_id, &found.records);
            }
            Record::ChunkIndex(found) => self.check_chunk_index(&found),
            Record::Attachment { header, data, crc } => {
                self.counts.attachments += 1;
                let index = AttachmentIndex {
                    offset: place.offset,
                    length: place.length,
                    log_time: header.log_time,
                    create_time: header.create_time,
                    data_size: data.len() as u64,
                    name: header.name,
                    media_type: header.media_type,
                };
                let is_scenario = index.name == SCENARIO_ATTACHMENT;
                self.demand_before_chunks(is_scenario, SCENARIO_ATTACHMENT);
                self.attachments.insert(place.offset, index);
                self.demand_checksum(crc, "an attachment has");
                let sum = crc32fast::hash(&body[..body.len().saturating_sub(4)]);
                self.checksums.unless(crc == 0 || crc == sum, || {
                    format!(
                        "the checksum of the attachment at {} is wrong",
                        place.offset
                    )
                });
            }
            Record::AttachmentIndex(found) => {
                let is_right = self.attachments.get(&found.offset) == Some(&found);
                self.check_pointer(is_right, found.offset, "attachment");
            }
            Record::Metadata(found) => {
                self.counts.metadata += u32::from(in_data);
                self.demand_before_chunks(found.name == RUN_RECORD, RUN_RECORD);
                if found.name == END_RECORD {
                    self.end_record = Some(place.offset);
                }
                let index = MetadataIndex {
                    offset: place.offset,
                    length: place.length,
                    name: found.name,
                };
                self.metadata.insert(place.offset, index);
            }
            Record::MetadataIndex(found) => {
                let is_right = self.metadata.get(&found.offset) == Some(&found);
                self.check_pointer(is_right, found.offset, "metadata");
            }
            Record::Statistics(found) => {
                let is_first = self.statistics.replace(found).is_none();
                self.index
                    .unless(is_first, || "it has statistics twice".to_owned());
            }
            Record::DataEnd(found) => self.check_data(place, found.data_section_crc),
            Record::SummaryOffset(found) => {
                let group = (found.group_opcode, found.group_start, found.group_length);
                self.groups.push(group);
                // Others write the offsets of empty groups too, which start where the next one does.
                let right = found.group_length == 0
                    || self.is_group(found.group_opcode, found.group_start, found.group_length);
                self.index.unless(right, || {
                    format!("the summary offset at {} leads nowhere", place.offset)
                });
            }
            _ => {}
        }
    }

    fn take_chunk(&mut self, place: &RecordSpan) -> io::Result<()> {
        self.counts.chunks += 1;
        let is_before_end = self.end_record.is_none() || !self.recording.layout.is_ours();
        self.structure.unless(is_before_end, || {
            format!("a chunk stands behind {END_RECORD}, at {}", place.offset)
        });
        let section = Section::of_chunk(place, self.source)?;
        let mut seen = ChunkSeen {
            length: place.length,
            span: section.span.unwrap_or_default(),
            packing: Packing::default(),
            messages: BTreeMap::new(),
            indexes: BTreeMap::new(),
            indexes_length: 0,
            is_unindexed: false,
        };
        self.close_chunk();
        self.last_chunk = Some(place.offset);
        if let Err(error) = section.load(self.source, &mut self.buffers) {
            self.checksums
                .add(|| format!("the chunk at {}: {error}", place.offset));
            self.chunks.insert(place.offset, seen);
            return Ok(());
        }
        seen.packing = self.buffers.packing().unwrap_or_default();
        let is_one_frame = !self.is_ours() || self.buffers.is_one_frame();
        self.structure.unless(is_one_frame, || {
            format!("the chunk at {} is not one frame", place.offset)
        });
        let has_checksum = !self.is_ours() || self.buffers.has_checksum();
        self.checksums.unless(has_checksum, || {
            format!("the chunk at {} has no checksum", place.offset)
        });
        let records = std::mem::take(&mut self.buffers.records);
        self.structure
            .unless(!records.is_empty() || !self.is_ours(), || {
                format!("the chunk at {} is empty", place.offset)
            });
        let mut position = 0;
        let mut span = None;
        while let Some(next) = record_at(&records, position) {
            let (inner, end) = match next {
                Ok(found) => found,
                Err(reason) => {
                    self.structure
                        .add(|| format!("the chunk at {}: {reason}", place.offset));
                    break;
                }
            };
            if let Some(message) = MessageRecord::parse(&inner) {
                self.counts.message(&message);
                span = Some(widened(span, message.log_time));
                let entries = seen.messages.entry(message.channel_id).or_default();
                entries.push(MessageIndexEntry {
                    log_time: message.log_time,
                    offset: position as u64,
                });
                let known = self.counts.channels.contains(&message.channel_id);
                self.structure.unless(known, || {
                    let channel = message.channel_id;
                    format!(
                        "a message in the chunk at {} has channel {channel}, which is not defined",
                        place.offset
                    )
                });
            } else {
                let chunk = place.offset;
                match parse(inner.opcode, inner.body) {
                    Ok(record @ (Record::Schema { .. } | Record::Channel(_)))
                        if content_length(&record) == Some(inner.body.len()) || !self.is_ours() =>
                    {
                        self.define(record);
                    }
                    _ => self
                        .structure
                        .add(|| format!("the chunk at {chunk} holds a record that it can't")),
                }
            }
            position = end;
        }
        self.buffers.records = records;
        let span = span.unwrap_or((0, 0));
        self.index.unless(span == seen.span, || {
            format!(
                "the chunk at {} gives other times than its messages",
                place.offset
            )
        });
        self.chunks.insert(place.offset, seen);
        Ok(())
    }

    /// All indexes of the last chunk have been seen: what is left of its messages has none.
    fn close_chunk(&mut self) {
        let last = self.last_chunk.and_then(|at| self.chunks.get_mut(&at));
        if let Some(chunk) = last {
            chunk.is_unindexed = !chunk.messages.is_empty();
            chunk.messages.clear();
        }
    }

    fn check_message_index(
        &mut self,
        place: &RecordSpan,
        channel: u16,
        entries: &[MessageIndexEntry],
    ) {
        let is_ours = self.is_ours();
        let chunk = self.last_chunk.and_then(|at| self.chunks.get_mut(&at));
        let Some(chunk) = chunk else {
            self.index
                .add(|| format!("the message index at {} has no chunk", place.offset));
            return;
        };
        let is_first = chunk.indexes.insert(channel, place.offset).is_none();
        self.index
            .unless(!is_ours || (is_first && !entries.is_empty()), || {
                format!(
                    "the message index at {} is empty or comes twice",
                    place.offset
                )
            });
        chunk.indexes_length += place.length;
        let mut sorted = entries.to_vec();
        sorted.sort_by_key(|entry| entry.offset);
        // Compared and done with: memory doesn't grow with the file.
        let content = chunk.messages.remove(&channel).unwrap_or_default();
        self.index.unless(content == sorted, || {
            format!(
                "the message index at {} is not that of its chunk",
                place.offset
            )
        });
    }

    fn check_chunk_index(&mut self, found: &mcap::records::ChunkIndex) {
        let at = found.chunk_start_offset;
        let is_first = self.indexed.insert(at);
        let packing = Packing {
            compression: found.compression.clone(),
            compressed: found.compressed_size,
            uncompressed: found.uncompressed_size,
        };
        let right = self.chunks.get(&at).is_some_and(|chunk| {
            is_first
                && chunk.packing == packing
                && chunk.length == found.chunk_length
                && chunk.span == (found.message_start_time, found.message_end_time)
                && chunk.indexes == found.message_index_offsets
                && chunk.indexes_length == found.message_index_length
        });
        self.index
            .unless(right, || format!("the index of the chunk at {at} is wrong"));
    }

    /// Whether all records of a kind stand between two places of the summary, and nothing else.
    fn is_group(&self, opcode: u8, start: u64, length: u64) -> bool {
        let is_of_kind = |(_, (found, _)): (&u64, &(u8, u64))| *found == opcode;
        let end = start.saturating_add(length);
        let before = self.places.range(..start).next_back();
        self.places.contains_key(&start)
            && self.places.contains_key(&end)
            && self.places.range(start..end).all(is_of_kind)
            && !before.is_some_and(is_of_kind)
            && !self.places.get_key_value(&end).is_some_and(is_of_kind)
    }

    /// Compares the groups of the summary with those that its offsets name: each once, and none is left out. Others
    /// write the offsets of empty groups too.
    fn check_groups(&mut self, summary: u64, offsets: u64) {
        let mut groups: Vec<(u8, u64, u64)> = Vec::new();
        let mut named = self.groups.clone();
        named.sort_unstable();
        let mut offsets_start = 0;
        for (&at, &(opcode, length)) in self.places.range(summary..) {
            match groups.last_mut() {
                _ if opcode == op::SUMMARY_OFFSET && offsets_start == 0 => offsets_start = at,
                _ if !GROUPED.contains(&opcode) => {}
                Some((last, _, all)) if *last == opcode => *all += length,
                _ => groups.push((opcode, at, length)),
            }
        }
        groups.sort_unstable();
        let is_repeated = |pair: &[(u8, u64, u64)]| pair[0].0 == pair[1].0;
        let is_once = !groups.windows(2).any(is_repeated) && !named.windows(2).any(is_repeated);
        named.retain(|(opcode, start, length)| {
            *length != 0 || !GROUPED.contains(opcode) || !self.places.contains_key(start)
        });
        self.index.unless(is_once && named == groups, || {
            "the summary offsets are not those of the summary's groups".to_owned()
        });
        self.index.unless(offsets_start == offsets, || {
            "the footer doesn't lead to the summary offsets".to_owned()
        });
    }

    /// `is_right` tells whether an index says what stands at the place that it leads to.
    fn check_pointer(&mut self, is_right: bool, offset: u64, what: &str) {
        let is_first = self.indexed.insert(offset);
        self.index.unless(is_right && is_first, || {
            format!("the {what} index for {offset} is wrong: something else stands there, or it comes twice")
        });
    }

    fn check_data(&mut self, place: &RecordSpan, crc: u32) {
        match self.source.checksum(0, place.offset) {
            Ok(found) => {
                self.checksums.unless(crc == 0 || crc == found, || {
                    format!("the checksum of the data is {found:08x}, not {crc:08x}")
                });
                self.demand_checksum(crc, "the data have");
            }
            Err(error) => self.checksums.add(|| error.to_string()),
        }
    }

    /// Recordings of toprise have a checksum where others may have none, which is a zero.
    fn demand_checksum(&mut self, crc: u32, what: &str) {
        self.checksums.unless(crc != 0 || !self.is_ours(), || {
            format!("{what} no checksum")
        });
    }

    /// What toprise writes before the messages stands there, unless another program has rewritten the file.
    fn demand_before_chunks(&mut self, is_such: bool, what: &str) {
        let is_right = !is_such || self.counts.chunks == 0 || !self.recording.layout.is_ours();
        self.structure
            .unless(is_right, || format!("{what} stands behind the first chunk"));
    }

    /// What a file with a footer must have.
    fn check_ends(&mut self) -> io::Result<()> {
        self.structure.unless(self.data_end.is_some(), || {
            "the data have no end".to_owned()
        });
        let Some(footer) = self.footer.clone() else {
            self.structure.add(|| "it has no footer".to_owned());
            return Ok(());
        };
        let Some(found) = read_footer(&footer, self.source)? else {
            return Ok(());
        };
        if found.summary_start == 0 {
            self.index.add(|| "it has no summary".to_owned());
            return Ok(());
        }
        let sum = summary_checksum(&footer, &found, self.source)?;
        let right = found.summary_crc == 0 || found.summary_crc == sum;
        self.checksums
            .unless(right, || "the checksum of the summary is wrong".to_owned());
        self.demand_checksum(found.summary_crc, "the summary has");
        let is_last = footer.end() + mcap::MAGIC.len() as u64 == self.source.length();
        self.structure
            .unless(is_last, || "something stands behind the footer".to_owned());
        let is_offset = |at| {
            self.places
                .get(&at)
                .is_some_and(|p| p.0 == op::SUMMARY_OFFSET)
        };
        let behind_data = self.data_end.map(|at| at + DATA_END);
        let points_well = behind_data.is_none_or(|at| at == found.summary_start)
            && (found.summary_offset_start == 0 || is_offset(found.summary_offset_start));
        self.index
            .unless(points_well, || "the footer leads nowhere".to_owned());
        if self.is_ours() {
            self.check_groups(found.summary_start, found.summary_offset_start);
        }
        self.check_completeness();
        Ok(())
    }

    /// Whether everything is indexed, and counted.
    fn check_completeness(&mut self) {
        self.close_chunk();
        let [in_data, in_summary] = &self.defined;
        self.index
            .unless(in_data == in_summary || !self.is_ours(), || {
                "its summary repeats other schemas and channels than its data have".to_owned()
            });
        for (at, chunk) in &self.chunks {
            let all = self.indexed.contains(at) && !chunk.is_unindexed;
            self.index
                .unless(all, || format!("the chunk at {at} is not wholly indexed"));
        }
        for (at, (opcode, _)) in &self.places {
            let must = matches!(*opcode, op::METADATA | op::ATTACHMENT);
            self.index.unless(!must || self.indexed.contains(at), || {
                format!("the record at {at} is not indexed")
            });
        }
        let Some(found) = &self.statistics else {
            self.index.add(|| "it has no statistics".to_owned());
            return;
        };
        let counts = &self.counts;
        let span = counts.span.unwrap_or((0, 0));
        let right = found.message_count == counts.messages.values().sum::<u64>()
            && usize::from(found.schema_count) == counts.schemas.len()
            && found.channel_count as usize == counts.channels.len()
            && found.attachment_count == counts.attachments
            && found.metadata_count == counts.metadata
            && found.chunk_count == counts.chunks
            && found.channel_message_counts == counts.messages
            && (found.message_start_time, found.message_end_time) == span;
        self.index.unless(right, || {
            "the statistics are not those of the file".to_owned()
        });
    }

    fn checks(mut self) -> Vec<Check> {
        let of_layout = &self.recording.layout.channels.contradictions;
        for contradiction in of_layout.union(&self.channels.contradictions) {
            self.structure.add(|| contradiction.clone());
        }
        let group = Group::Container;
        let ended = self.is_ended && self.footer.is_some();
        let found = format!("{} records, {} chunks", self.records, self.counts.chunks);
        let mut structure = Check::of(group, "structure", &self.structure, found);
        if !ended && structure.verdict == Verdict::Passed {
            structure.verdict = Verdict::Incomplete;
            structure.finding += ", but no footer: the file was not completed";
        }
        let checksums = "all are right".to_owned();
        let mut checks = vec![
            structure,
            Check::of(group, "checksums", &self.checksums, checksums),
        ];
        let messages: u64 = self.counts.messages.values().sum();
        checks.push(if ended || self.index.count > 0 {
            let found = format!("all {messages} messages are indexed where they stand");
            Check::of(group, "index", &self.index, found)
        } else {
            let found = "there is none at the end; those of the chunks are right".to_owned();
            Check::new(group, "index", Verdict::Incomplete, found)
        });
        if self.is_ours() {
            checks.push(self.end_record());
        }
        checks
    }

    fn end_record(&self) -> Check {
        let end = self.recording.end();
        let reason = end.and_then(|end| end.get(STOP_REASON));
        let recovery = self.recording.recovery();
        let lost = recovery.and_then(|r| r.get(LOST));
        let (verdict, finding) = match (reason, lost) {
            (_, Some(lost)) => (Verdict::Incomplete, format!("recovered; lost: {lost}")),
            (Some(reason), None) => (Verdict::Passed, format!("the run ended: {reason}")),
            (None, None) => {
                let finding = "there is none: the run was cut off".to_owned();
                (Verdict::Incomplete, finding)
            }
        };
        Check::new(Group::Container, "end record", verdict, finding)
    }
}
