//! Reading recordings back.
//!
//! [`Overview`] reads a file once from start to end in bounded memory, as far as it is readable, and
//! tells what is in it. [`end_record`] reads only the end of a whole file.

use crate::scenario::Scenario;
use crate::sink::mcap::{END_RECORD, RUN_RECORD, SCENARIO_ATTACHMENT};
use mcap::McapError;
use mcap::records::{Metadata, Record};
use mcap::sans_io::{
    LinearReadEvent, LinearReader, LinearReaderOptions, SummaryReadEvent, SummaryReader,
};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::Path;
use thiserror::Error;

/// No record of a recording is longer than this; a longer one is damage.
const LONGEST_RECORD: usize = 1 << 30;

/// Why a file can't be read at all.
#[derive(Debug, Error)]
pub enum RecordingError {
    /// The file system refused.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// It is empty.
    #[error("the file is empty")]
    Empty,
    /// It is something else, or nothing of it is readable.
    #[error("not an MCAP file, or damaged at its very start: {0}")]
    NotMcap(McapError),
}

/// What is in an MCAP file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overview {
    /// The entries of the `toprise.run` record; `None` if the file is not a recording of toprise.
    pub run: Option<BTreeMap<String, String>>,
    /// The entries of the `toprise.end` record; `None` if the run did not reach its end.
    pub end: Option<BTreeMap<String, String>>,
    /// The scenario as TOML.
    pub scenario: Option<String>,
    /// The channels, in the order of the file.
    pub channels: Vec<ChannelOverview>,
    /// The messages on `/events`.
    pub events: Vec<EventOverview>,
    /// Why the file can't be read further, if it can't.
    pub damage: Option<String>,
}

/// A channel of a file.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct ChannelOverview {
    /// MCAP channel id.
    pub id: u16,
    /// Topic.
    pub topic: String,
    /// Encoding of its messages.
    pub encoding: String,
    /// Name of its message type, empty if it has none.
    pub schema: String,
    /// Number of messages.
    pub messages: u64,
    /// Bytes of all messages.
    pub bytes: u64,
    /// Time of the first message, ns.
    pub first_ns: u64,
    /// Time of the last message, ns.
    pub last_ns: u64,
}

impl ChannelOverview {
    /// Mean rate of the messages, Hz; `None` for fewer than two.
    #[must_use]
    pub fn rate(&self) -> Option<f64> {
        let span = self.last_ns.saturating_sub(self.first_ns);
        (self.messages > 1 && span > 0).then(|| (self.messages - 1) as f64 * 1e9 / span as f64)
    }
}

/// An event of a recording.
#[derive(Clone, Debug, PartialEq)]
pub struct EventOverview {
    /// Kind.
    pub name: String,
    /// When, s.
    pub time: f64,
    /// A sentence for people.
    pub description: String,
}

impl Overview {
    /// Reads a file as far as it can be read.
    ///
    /// # Errors
    /// [`RecordingError`] if it can't be opened or is not MCAP. Damage further on is no error: it is
    /// told in `damage`.
    pub fn read(path: &Path) -> Result<Self, RecordingError> {
        let file = File::open(path)?;
        if file.metadata()?.len() == 0 {
            return Err(RecordingError::Empty);
        }
        let mut overview = Self::default();
        let mut schemas = BTreeMap::new();
        let mut positions = BTreeMap::new();
        let result = each_record(BufReader::new(file), |record| match record {
            Record::Schema { header, .. } => {
                schemas.insert(header.id, header.name);
            }
            Record::Channel(channel) => {
                positions.entry(channel.id).or_insert_with(|| {
                    overview.channels.push(ChannelOverview {
                        id: channel.id,
                        topic: channel.topic,
                        encoding: channel.message_encoding,
                        schema: schemas.get(&channel.schema_id).cloned().unwrap_or_default(),
                        ..ChannelOverview::default()
                    });
                    overview.channels.len() - 1
                });
            }
            Record::Message { header, data } => {
                if let Some(&position) = positions.get(&header.channel_id) {
                    overview.count(position, header.log_time, &data);
                }
            }
            Record::Metadata(record) => overview.keep_metadata(record),
            Record::Attachment { header, data, .. } if header.name == SCENARIO_ATTACHMENT => {
                overview.scenario = String::from_utf8(data.into_owned()).ok();
            }
            _ => {}
        });
        match result {
            Ok(()) => {}
            Err(error) if overview == Self::default() => {
                return Err(RecordingError::NotMcap(error));
            }
            Err(error) => overview.damage = Some(error.to_string()),
        }
        Ok(overview)
    }

    /// The scenario, if it is there and this version can read it.
    #[must_use]
    pub fn parsed_scenario(&self) -> Option<Scenario> {
        Scenario::from_toml(self.scenario.as_deref()?).ok()
    }

    /// Whether it is a recording of toprise that reached its end and is readable throughout.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.run.is_some() && self.end.is_some() && self.damage.is_none()
    }

    /// Number of messages in all channels.
    #[must_use]
    pub fn messages(&self) -> u64 {
        self.channels.iter().map(|channel| channel.messages).sum()
    }

    /// Time of the last message, ns.
    #[must_use]
    pub fn last_ns(&self) -> u64 {
        self.channels.iter().map(|c| c.last_ns).max().unwrap_or(0)
    }

    fn count(&mut self, position: usize, time_ns: u64, data: &[u8]) {
        let channel = &mut self.channels[position];
        if channel.messages == 0 {
            channel.first_ns = time_ns;
        }
        channel.last_ns = time_ns;
        channel.messages += 1;
        channel.bytes += data.len() as u64;
        if channel.topic == "/events" && channel.encoding == "json" {
            self.events.extend(event(data));
        }
    }

    fn keep_metadata(&mut self, record: Metadata) {
        match record.name.as_str() {
            RUN_RECORD => self.run = Some(record.metadata),
            END_RECORD => self.end = Some(record.metadata),
            _ => {}
        }
    }
}

/// The entries of the `toprise.end` record of a whole file; `None` if it has none or can't be read.
#[must_use]
pub fn end_record(path: &Path) -> Option<BTreeMap<String, String>> {
    let mut file = File::open(path).ok()?;
    let mut reader = SummaryReader::new();
    while let Some(event) = reader.next_event() {
        match event.ok()? {
            SummaryReadEvent::ReadRequest(wanted) => {
                let read = file.read(reader.insert(wanted)).ok()?;
                reader.notify_read(read);
            }
            SummaryReadEvent::SeekRequest(to) => {
                reader.notify_seeked(file.seek(to).ok()?);
            }
        }
    }
    let summary = reader.finish()?;
    let index = summary
        .metadata_indexes
        .iter()
        .find(|index| index.name == END_RECORD)?;
    // Opcode and length come before the record's body.
    let mut body = vec![0; usize::try_from(index.length).ok()?.checked_sub(9)?];
    file.seek(SeekFrom::Start(index.offset + 9)).ok()?;
    file.read_exact(&mut body).ok()?;
    match mcap::parse_record(mcap::records::op::METADATA, &body).ok()? {
        Record::Metadata(record) => Some(record.metadata),
        _ => None,
    }
}

/// Gives each record of a file to `each`, those in chunks included, until the end or the first damage.
fn each_record(mut source: impl Read, mut each: impl FnMut(Record<'_>)) -> Result<(), McapError> {
    let mut reader = LinearReader::new_with_options(
        LinearReaderOptions::default()
            .with_prevalidate_chunk_crcs(true)
            .with_record_length_limit(LONGEST_RECORD),
    );
    while let Some(event) = reader.next_event() {
        match event? {
            LinearReadEvent::ReadRequest(wanted) => {
                let read = source.read(reader.insert(wanted))?;
                reader.notify_read(read);
            }
            LinearReadEvent::Record { data, opcode } => each(mcap::parse_record(opcode, data)?),
        }
    }
    Ok(())
}

fn event(data: &[u8]) -> Option<EventOverview> {
    let message: Value = serde_json::from_slice(data).ok()?;
    Some(EventOverview {
        name: message.get("name")?.as_str()?.to_owned(),
        time: message.get("time")?.as_f64()?,
        description: message.get("description")?.as_str()?.to_owned(),
    })
}
