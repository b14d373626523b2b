//! Channels of a file, matched with the table.

use crate::archive::format::is_reserved;
use crate::telemetry::encoding::{DecodeError, Decoder};
use crate::telemetry::supplement::Supplement;
use crate::telemetry::views::VIEW_CHANNELS;
use crate::telemetry::{ChannelInfo, Topic};
use mcap::records::Record;
use mcap::{McapResult, Writer};
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::io::{Seek, Write};
use std::sync::Arc;
use thiserror::Error;

/// A channel of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileChannel {
    /// MCAP channel id.
    pub id: u16,
    /// Topic.
    pub topic: String,
    /// Encoding of the messages.
    pub encoding: String,
    /// Message type; `None` for self-describing messages, or if the file doesn't define it.
    pub schema: Option<Arc<FileSchema>>,
    /// Id of its message type in the file; 0 for self-describing messages.
    pub schema_id: u16,
    /// Further metadata in the file.
    pub metadata: BTreeMap<String, String>,
    /// Topic of the table, if it is one of them.
    pub table: Option<Topic>,
    /// Whether the data define its topic otherwise, and only the summary has this definition, without messages. It says
    /// nothing about the topic then.
    pub is_superseded: bool,
}

/// A message type of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileSchema {
    /// Name of the type.
    pub name: String,
    /// Language of the definition, e.g. `jsonschema`.
    pub encoding: String,
    /// The definition.
    pub data: Vec<u8>,
}

impl FileChannel {
    /// Id of its message type, if the file doesn't define it.
    pub fn undefined_schema(&self) -> Option<u16> {
        let is_undefined = self.schema.is_none() && self.schema_id != NO_SCHEMA;
        is_undefined.then_some(self.schema_id)
    }

    /// The name of its message type, empty if it has none.
    pub fn schema_name(&self) -> &str {
        self.schema.as_ref().map_or("", |schema| &schema.name)
    }

    /// The row of the table, if it is a channel of the table.
    pub fn info(&self) -> Option<&'static ChannelInfo> {
        self.table.map(Topic::info)
    }

    /// Whether it is a view channel.
    pub fn is_view(&self) -> bool {
        VIEW_CHANNELS.iter().any(|view| view.topic == self.topic)
    }

    /// Whether it is a channel in addition to those of a run. One whose schema the file doesn't define may be of the run,
    /// and those of a later version have schemas of toprise.
    pub fn is_supplement(&self) -> bool {
        let is_of_run = self.table.is_some()
            || self.is_view()
            || self.undefined_schema().is_some()
            || is_reserved(self.schema_name());
        self.is_declared_supplement() || !is_of_run
    }

    /// Whether it has a topic of toprise in addition to those of a run, so that toprise knows how it must be declared.
    pub(crate) fn is_declared_supplement(&self) -> bool {
        Supplement::find(&self.topic).is_some()
    }

    /// Declares the channel in another file and returns its id there.
    pub(crate) fn register<W: Write + Seek>(&self, writer: &mut Writer<W>) -> McapResult<u16> {
        let schema = match &self.schema {
            Some(schema) => writer.add_schema(&schema.name, &schema.encoding, &schema.data)?,
            None => NO_SCHEMA,
        };
        writer.add_channel(schema, &self.topic, &self.encoding, &self.metadata)
    }

    /// Decoder of its messages, if it is a channel of the table.
    ///
    /// # Errors
    /// [`DecodeError`] if its encoding or schema can't be read.
    pub fn decoder(&self) -> Option<Result<Decoder, DecodeError>> {
        let data = self.schema.as_ref().map_or(&[][..], |schema| &schema.data);
        let info = self.info()?;
        Some(Decoder::new(info, &self.encoding, self.schema_name(), data))
    }
}

/// The schema id of channels without a schema.
const NO_SCHEMA: u16 = 0;

/// Maximum size of all definitions, bytes. Further ones are ignored, because they stay in memory.
const MAX_SIZE: usize = 64 << 20;

/// The reason why a definition of a channel or schema can't be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub(crate) enum Conflict {
    /// A channel has another definition before it.
    #[error("a second definition of channel {0} that differs from the first")]
    Channel(u16),
    /// A schema has another definition before it.
    #[error("a second definition of schema {0} that differs from the first")]
    Schema(u16),
    /// A definition that was not found when the file was opened: toprise defines all channels in its first chunk and in
    /// the summary.
    #[error("a further definition after those of the first chunk")]
    Further,
    /// All definitions together are too large.
    #[error("the definitions of channels and schemas exceed {} MiB", MAX_SIZE >> 20)]
    TooLarge,
}

/// The definition of a channel, to be compared with another of the same id.
#[derive(PartialEq)]
struct Definition<'a> {
    topic: &'a str,
    encoding: &'a str,
    metadata: &'a BTreeMap<String, String>,
    schema_id: u16,
}

/// All channels of a file, in the order of their first definitions.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Channels {
    schemas: BTreeMap<u16, Arc<FileSchema>>,
    list: Vec<FileChannel>,
    positions: BTreeMap<u16, usize>,
    /// Size of all definitions, bytes.
    size: usize,
}

impl Channels {
    pub(crate) fn list(&self) -> &[FileChannel] {
        &self.list
    }

    /// Number of schemas.
    pub(crate) fn schema_count(&self) -> usize {
        self.schemas.len()
    }

    /// Unused schemas, including duplicates of used ones.
    pub(crate) fn unused_schemas(&self) -> impl Iterator<Item = &FileSchema> {
        self.schemas
            .values()
            .filter(|schema| !self.is_used(schema))
            .map(Arc::as_ref)
    }

    fn is_used(&self, schema: &Arc<FileSchema>) -> bool {
        self.list
            .iter()
            .filter_map(|channel| channel.schema.as_ref())
            // Equal schemas with other ids are schemas of their own.
            .any(|used| Arc::ptr_eq(used, schema))
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// The place of the channel with an id in the list.
    pub(crate) fn position(&self, id: u16) -> Option<usize> {
        self.positions.get(&id).copied()
    }

    /// The schema with this id.
    pub(crate) fn schema(&self, id: u16) -> Option<&FileSchema> {
        self.schemas.get(&id).map(Arc::as_ref)
    }

    /// The channels whose messages have no certain meaning after a conflict.
    pub(crate) fn affected_by(&self, conflict: Conflict) -> Vec<usize> {
        match conflict {
            Conflict::Channel(id) => Vec::from_iter(self.position(id)),
            Conflict::Schema(id) => (0..self.list.len())
                .filter(|position| self.list[*position].schema_id == id)
                .collect(),
            Conflict::Further | Conflict::TooLarge => Vec::new(),
        }
    }

    /// Checks a schema or channel record against the definitions; other records are no conflict.
    pub(crate) fn conflict(&self, record: &Record<'_>) -> Option<Conflict> {
        match record {
            Record::Schema { header, .. } if header.id == NO_SCHEMA => None,
            Record::Schema { header, data } => match self.schemas.get(&header.id) {
                Some(schema) => {
                    let is_equal = schema.name == header.name
                        && schema.encoding == header.encoding
                        && schema.data == data.as_ref();
                    (!is_equal).then_some(Conflict::Schema(header.id))
                }
                None => Some(self.unknown()),
            },
            Record::Channel(record) => match self.position(record.id) {
                Some(position) => {
                    let other = Definition {
                        topic: &record.topic,
                        encoding: &record.message_encoding,
                        metadata: &record.metadata,
                        schema_id: record.schema_id,
                    };
                    (self.definition(position) != other).then_some(Conflict::Channel(record.id))
                }
                None => Some(self.unknown()),
            },
            _ => None,
        }
    }

    /// The reason why an id has no definition although its file has one.
    fn unknown(&self) -> Conflict {
        if self.is_full() {
            Conflict::TooLarge
        } else {
            Conflict::Further
        }
    }

    /// Whether definitions are ignored because they are too large.
    fn is_full(&self) -> bool {
        self.size > MAX_SIZE
    }

    /// Adds a schema or channel record, the first of its id; other records are ignored.
    pub(crate) fn define(&mut self, record: Record<'_>) {
        if !self.is_defined(&record) {
            self.size = self.size.saturating_add(size(&record));
        }
        if self.is_full() {
            return;
        }
        match record {
            // Invalid, and ignored by readers.
            Record::Schema { header, .. } if header.id == NO_SCHEMA => {}
            Record::Schema { header, data } => {
                let schema = Arc::new(FileSchema {
                    name: header.name,
                    encoding: header.encoding,
                    data: data.into_owned(),
                });
                // The summary repeats those of the data.
                self.schemas.entry(header.id).or_insert(schema);
            }
            Record::Channel(record) => {
                if self.position(record.id).is_some() {
                    return;
                }
                let channel = FileChannel {
                    id: record.id,
                    schema: self.schemas.get(&record.schema_id).cloned(),
                    schema_id: record.schema_id,
                    table: Topic::find(&record.topic),
                    topic: record.topic,
                    encoding: record.message_encoding,
                    metadata: record.metadata,
                    is_superseded: false,
                };
                self.push(channel);
            }
            _ => {}
        }
    }

    /// Adds the definitions of the summary to those of the data, which have the last word. Writers may define a channel in
    /// the data with its first message only, so the summary alone has those without messages. `used` are the ids of the
    /// channels with messages.
    ///
    /// Returns the first definition of the summary that contradicts the data.
    pub(crate) fn merge(&mut self, summary: &Self, used: &BTreeSet<u16>) -> Option<Conflict> {
        let mut conflict = None;
        for (id, schema) in &summary.schemas {
            match self.schemas.entry(*id) {
                Entry::Vacant(free) => {
                    free.insert(Arc::clone(schema));
                }
                Entry::Occupied(defined) if defined.get() == schema => {}
                Entry::Occupied(_) => conflict = conflict.or(Some(Conflict::Schema(*id))),
            }
        }
        self.find_late_schemas();
        let superseded = self.superseded(summary, used);
        for (at, channel) in summary.list.iter().enumerate() {
            match self.position(channel.id) {
                Some(position) if self.definition(position) == summary.definition(at) => {}
                Some(_) => conflict = conflict.or(Some(Conflict::Channel(channel.id))),
                None => self.push(FileChannel {
                    is_superseded: superseded.contains(&channel.id),
                    ..channel.clone()
                }),
            }
        }
        self.find_late_schemas();
        conflict
    }

    /// The ids of channels of a summary without messages whose topics have another encoding or schema here.
    fn superseded(&self, summary: &Self, used: &BTreeSet<u16>) -> BTreeSet<u16> {
        let mut known: BTreeMap<&str, &FileChannel> = BTreeMap::new();
        for channel in &self.list {
            known.entry(&channel.topic).or_insert(channel);
        }
        let unused = summary
            .list
            .iter()
            .filter(|channel| !used.contains(&channel.id));
        unused
            .filter(|channel| {
                known.get(channel.topic.as_str()).is_some_and(|known| {
                    (&known.encoding, &known.schema) != (&channel.encoding, &channel.schema)
                })
            })
            .map(|channel| channel.id)
            .collect()
    }

    /// Gives channels that were defined before their schemas those schemas.
    fn find_late_schemas(&mut self) {
        for channel in &mut self.list {
            if channel.schema.is_none() {
                channel.schema = self.schemas.get(&channel.schema_id).cloned();
            }
        }
    }

    /// The definition of the channel at a position.
    fn definition(&self, position: usize) -> Definition<'_> {
        let channel = &self.list[position];
        Definition {
            topic: &channel.topic,
            encoding: &channel.encoding,
            metadata: &channel.metadata,
            schema_id: channel.schema_id,
        }
    }

    fn push(&mut self, channel: FileChannel) {
        self.positions.insert(channel.id, self.list.len());
        self.list.push(channel);
    }

    /// Whether a record has an id that is already defined.
    fn is_defined(&self, record: &Record<'_>) -> bool {
        match record {
            // Ignored, so it takes no memory.
            Record::Schema { header, .. } if header.id == NO_SCHEMA => true,
            Record::Schema { header, .. } => self.schemas.contains_key(&header.id),
            Record::Channel(record) => self.positions.contains_key(&record.id),
            _ => true,
        }
    }
}

/// Size of the texts and data of a definition, bytes.
fn size(record: &Record<'_>) -> usize {
    match record {
        Record::Schema { header, data } => header.name.len() + header.encoding.len() + data.len(),
        Record::Channel(record) => {
            let metadata: usize = record
                .metadata
                .iter()
                .map(|(key, value)| key.len() + value.len())
                .sum();
            record.topic.len() + record.message_encoding.len() + metadata
        }
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mcap::records::SchemaHeader;

    fn schema(id: u16, data: &[u8]) -> Record<'_> {
        let header = SchemaHeader {
            id,
            name: String::new(),
            encoding: String::new(),
        };
        Record::Schema {
            header,
            data: data.into(),
        }
    }

    #[test]
    fn definitions_take_bounded_memory() {
        let mut channels = Channels::default();
        let data = vec![0; 1 << 20];
        for id in 1..=100 {
            // Repetitions take no memory.
            for _ in 0..2 {
                channels.define(schema(id, &data));
            }
        }
        assert_eq!(channels.schema_count(), 64);
        assert_eq!(channels.conflict(&schema(1, &data)), None);
        assert_eq!(
            channels.conflict(&schema(100, &data)),
            Some(Conflict::TooLarge)
        );
        assert_eq!(
            channels.conflict(&schema(1, &[])),
            Some(Conflict::Schema(1))
        );
    }
}
