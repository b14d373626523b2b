//! Channels of a file, matched with the table.

use crate::telemetry::encoding::{DecodeError, Decoder};
use crate::telemetry::views::VIEW_CHANNELS;
use crate::telemetry::{ChannelInfo, Topic};
use mcap::records::Record;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::sync::Arc;

/// A channel of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileChannel {
    /// MCAP channel id.
    pub id: u16,
    /// Topic.
    pub topic: String,
    /// Encoding of its messages.
    pub encoding: String,
    /// Its message type; `None` for self-describing messages.
    pub schema: Option<Arc<FileSchema>>,
    /// Its further metadata in the file.
    pub metadata: BTreeMap<String, String>,
    /// Its topic in the table of channels, if it is one of them.
    pub table: Option<Topic>,
}

/// A message type of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileSchema {
    /// Its name.
    pub name: String,
    /// Its schema encoding.
    pub encoding: String,
    /// Its schema data.
    pub data: Vec<u8>,
}

impl FileChannel {
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

/// All channels of a file, in the order of their first definitions.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Channels {
    schemas: BTreeMap<u16, Arc<FileSchema>>,
    list: Vec<FileChannel>,
    positions: BTreeMap<u16, usize>,
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
        let schemas = self.schemas.values();
        let is_used = |schema: &Arc<FileSchema>| {
            let mut used = self
                .list
                .iter()
                .filter_map(|channel| channel.schema.as_ref());
            used.any(|used| Arc::ptr_eq(used, schema))
        };
        schemas
            .filter(move |schema| !is_used(schema))
            .map(Arc::as_ref)
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// The place of the channel with an id in the list.
    pub(crate) fn position(&self, id: u16) -> Option<usize> {
        self.positions.get(&id).copied()
    }

    /// Adds a schema or channel record; other records are ignored.
    pub(crate) fn define(&mut self, record: Record<'_>) {
        match record {
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
                let schema = self.schemas.get(&record.schema_id).cloned();
                let table = Topic::find(&record.topic);
                let channel = FileChannel {
                    id: record.id,
                    topic: record.topic,
                    encoding: record.message_encoding,
                    schema,
                    metadata: record.metadata,
                    table,
                };
                if let Entry::Vacant(free) = self.positions.entry(record.id) {
                    free.insert(self.list.len());
                    self.list.push(channel);
                }
            }
            _ => {}
        }
    }
}
