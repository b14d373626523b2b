//! Reading recordings back.
//!
//! [`Recording::open`] finds out where everything is in a file, past whatever is damaged, and what
//! kind of file it is. [`Recording::reader`] gives its messages with the very bits that were written,
//! [`Recording::series`] single quantities, [`Overview`] says what is in it.
//!
//! ```no_run
//! use toprise::archive::recording::Recording;
//! use toprise::telemetry::fields::state;
//!
//! let recording = Recording::open("recordings/paper.mcap".as_ref())?;
//! let theta = recording.series(state::THETA)?;
//! println!("{} {} at {} ns", theta.values[0], theta.field.unit(), theta.times_ns[0]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod channels;
pub(crate) mod layout;
mod loss;
mod numbers;
mod overview;
mod reader;
pub(crate) mod scan;
pub(crate) mod section;
mod series;
pub(crate) mod source;

pub use self::channels::{FileChannel, FileSchema};
use self::layout::Layout;
pub use self::loss::{Loss, Span};
pub use self::numbers::{MAX_FIELDS, NumberDecoder, NumbersError};
pub use self::overview::{ChannelOverview, EventOverview, Overview};
pub use self::reader::{Any, Reader, Selection, Undecoded};
use self::scan::HEAD;
pub use self::series::{Columns, Series, SeriesError};
use self::source::Source;
pub use crate::archive::format::Entries;
use crate::archive::format::{END_RECORD, RECOVERY_RECORD, RUN_RECORD, SCENARIO_ATTACHMENT};
use crate::run::scenario::{Scenario, ScenarioError};
use crate::telemetry::Topic;
use crate::telemetry::encoding::{DecodeError, Encoding, FieldDifferences};
use mcap::records::Record;
use schemars::JsonSchema;
use serde::Serialize;
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why a file can't be read at all.
#[derive(Debug, Error)]
pub enum RecordingError {
    /// The file system refused.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// It is a directory.
    #[error("it is a directory; name an MCAP file")]
    Directory,
    /// It is a device, a pipe or the like.
    #[error("it is not a file")]
    NoFile,
    /// It is empty.
    #[error("the file is empty")]
    Empty,
    /// It is something else.
    #[error("not an MCAP file: it doesn't begin like one")]
    NotMcap,
    /// A topic of ours has two channels.
    #[error("it has two channels {0}: which one counts can't be known")]
    TwoChannels(String),
}

/// Why a message can't be decoded.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{topic} message {sequence} at {} s: {reason}", *time_ns as f64 / 1e9)]
pub struct MessageError {
    /// Its topic.
    pub topic: &'static str,
    /// Its sequence number.
    pub sequence: u32,
    /// Its time, ns.
    pub time_ns: u64,
    /// What is wrong.
    pub reason: DecodeError,
}

/// Why a recording gives no scenario.
#[derive(Debug, Error)]
pub enum NoScenario {
    /// It has none.
    #[error("no scenario is attached to it")]
    Missing,
    /// The attachment is damaged.
    #[error("its scenario is damaged: {0}")]
    Damaged(String),
    /// This version can't read it.
    #[error("its scenario can't be used: {0}")]
    Unusable(#[from] ScenarioError),
}

/// What kind of file it is, as far as opening it tells: damage inside of chunks is found in reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Condition {
    /// An MCAP file that toprise did not write.
    #[serde(rename = "not a toprise recording")]
    Foreign,
    /// A recording with its end record, readable throughout.
    #[serde(rename = "complete")]
    Whole,
    /// A recording without an end record: the run was cut off, but nothing else is wrong.
    Interrupted,
    /// A recording of which parts can't be read.
    Damaged,
    /// What was saved of an interrupted or damaged recording.
    Recovered,
}

impl Condition {
    /// In a word or two.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Foreign => "not a toprise recording",
            Self::Whole => "complete",
            Self::Interrupted => "interrupted",
            Self::Damaged => "damaged",
            Self::Recovered => "recovered",
        }
    }
}

/// An MCAP file, opened for reading.
///
/// It keeps where things are, not what they are: memory doesn't grow with the messages.
#[derive(Debug)]
pub struct Recording {
    pub(crate) source: Source,
    pub(crate) layout: Layout,
    path: PathBuf,
}

impl Recording {
    /// Opens a file and finds out where everything is in it.
    ///
    /// # Errors
    /// [`RecordingError`] if it can't be opened or is no MCAP file. Damage is no error.
    pub fn open(path: &Path) -> Result<Self, RecordingError> {
        let source = Source::open(path)?;
        let layout = Layout::read(&source)?;
        let recording = Self {
            source,
            layout,
            path: path.to_owned(),
        };
        if recording.condition() != Condition::Foreign {
            let mut tables: Vec<_> = recording
                .channels()
                .iter()
                .filter_map(|c| c.table)
                .collect();
            tables.sort_unstable();
            if let Some(twice) = tables.windows(2).find(|pair| pair[0] == pair[1]) {
                return Err(RecordingError::TwoChannels(twice[0].to_string()));
            }
        }
        Ok(recording)
    }

    /// Where it is.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Its size, bytes.
    #[must_use]
    pub fn size(&self) -> u64 {
        self.source.length()
    }

    /// The program and version that wrote it, by its own words.
    #[must_use]
    pub fn library(&self) -> &str {
        &self.layout.library
    }

    /// What kind of file it is.
    #[must_use]
    pub fn condition(&self) -> Condition {
        if self.run().is_none() && !self.layout.is_ours() {
            return Condition::Foreign;
        }
        let cut_in_the_middle = self.end().is_some() && !self.layout.is_ended;
        if self.layout.losses.iter().any(|loss| !self.is_tail(loss)) || cut_in_the_middle {
            Condition::Damaged
        } else if self.recovery().is_some() {
            Condition::Recovered
        } else if self.end().is_none() {
            Condition::Interrupted
        } else {
            Condition::Whole
        }
    }

    /// Whether a loss is only the record that was being written when the run was cut off.
    fn is_tail(&self, loss: &Loss) -> bool {
        self.end().is_none() && loss.offset + loss.length == self.size()
    }

    /// The entries of the `toprise.run` record.
    #[must_use]
    pub fn run(&self) -> Option<&Entries> {
        self.metadata(RUN_RECORD)
    }

    /// The entries of the `toprise.end` record; none if the run did not reach its end.
    #[must_use]
    pub fn end(&self) -> Option<&Entries> {
        self.metadata(END_RECORD)
    }

    /// The entries of the `toprise.recovery` record, which says what was lost.
    #[must_use]
    pub fn recovery(&self) -> Option<&Entries> {
        self.metadata(RECOVERY_RECORD)
    }

    /// The entries of the first metadata record with a name.
    #[must_use]
    pub fn metadata(&self, name: &str) -> Option<&Entries> {
        let mut records = self.layout.metadata.iter();
        records.find(|r| r.name == name).map(|r| &r.metadata)
    }

    /// All metadata records: names and entries, in the order of the file.
    pub fn all_metadata(&self) -> impl Iterator<Item = (&str, &Entries)> {
        let records = self.layout.metadata.iter();
        records.map(|record| (record.name.as_str(), &record.metadata))
    }

    /// All channels, in the order of the file.
    #[must_use]
    pub fn channels(&self) -> &[FileChannel] {
        self.layout.channels.list()
    }

    /// The encoding of its channels of the table; none if it has none, or they differ.
    #[must_use]
    pub fn encoding(&self) -> Option<Encoding> {
        let mut ours = self.channels().iter().filter(|c| c.table.is_some());
        let first = ours.next()?;
        ours.all(|channel| channel.encoding == first.encoding)
            .then(|| Encoding::find(&first.encoding))?
    }

    /// Whether it has this channel of the table.
    #[must_use]
    pub fn has(&self, topic: Topic) -> bool {
        self.channels().iter().any(|c| c.table == Some(topic))
    }

    /// The topics of the table that it has, in the order of the file.
    #[must_use]
    pub fn topics(&self) -> Vec<Topic> {
        self.channels().iter().filter_map(|c| c.table).collect()
    }

    /// The damage that opening it met.
    #[must_use]
    pub fn losses(&self) -> &[Loss] {
        &self.layout.losses
    }

    /// In what its channels differ from this version's: topics with the fields that are missing or
    /// unknown, and topics of toprise that are not known at all.
    #[must_use]
    pub fn differences(&self) -> Vec<(String, FieldDifferences)> {
        let mut differences = Vec::new();
        for channel in self.channels() {
            let of_channel = match channel.decoder() {
                Some(Ok(decoder)) => decoder.differences().clone(),
                Some(Err(_)) => continue,
                None if channel.is_view() => continue,
                None => FieldDifferences {
                    missing: Vec::new(),
                    unknown: vec!["the whole channel".to_owned()],
                },
            };
            if !of_channel.is_empty() {
                differences.push((channel.topic.clone(), of_channel));
            }
        }
        differences
    }

    /// Its scenario as the text that was attached.
    ///
    /// # Errors
    /// [`NoScenario`] if it has none, or it is damaged.
    pub fn scenario_text(&self) -> Result<String, NoScenario> {
        let attached = self.layout.attachments.iter();
        let mut attached = attached.filter(|attachment| attachment.name == SCENARIO_ATTACHMENT);
        let place = &attached.next().ok_or(NoScenario::Missing)?.place;
        let damaged = |reason: String| NoScenario::Damaged(reason);
        let data = self.attachment(place).map_err(damaged)?;
        String::from_utf8(data.1).map_err(|error| damaged(error.to_string()))
    }

    /// Its scenario.
    ///
    /// # Errors
    /// [`NoScenario`] if it has none, or it can't be used.
    pub fn scenario(&self) -> Result<Scenario, NoScenario> {
        Ok(Scenario::from_toml(&self.scenario_text()?)?)
    }

    /// An attachment's head and data, if its checksum is right.
    pub(crate) fn attachment(
        &self,
        place: &scan::Place,
    ) -> Result<(mcap::records::AttachmentHeader, Vec<u8>), String> {
        let mut bytes = Vec::new();
        let read = self.source.read(place.offset, place.length, &mut bytes);
        read.map_err(|error| error.to_string())?;
        let body = bytes.get(HEAD as usize..).unwrap_or_default();
        match scan::parse(place.opcode, body) {
            Ok(Record::Attachment { header, data, crc }) => {
                let checked = body.len().saturating_sub(4);
                if crc != 0 && crc32fast::hash(&body[..checked]) != crc {
                    return Err("its checksum is wrong".to_owned());
                }
                Ok((header, data.into_owned()))
            }
            Ok(_) => Err("it is no attachment".to_owned()),
            Err(error) => Err(error.to_string()),
        }
    }

    /// Whether the data are what they were when they were written; a file without a checksum can't be told.
    pub(crate) fn data_checksum_is_right(&self) -> bool {
        let Some(end) = self.layout.data_end else {
            return true;
        };
        let mut bytes = Vec::new();
        let read = self.source.read(end + HEAD, 4, &mut bytes);
        let noted = bytes.as_slice().try_into().map_or(0, u32::from_le_bytes);
        let is_right = |found| found == noted;
        read.is_ok() && (noted == 0 || self.source.checksum(0, end).is_ok_and(is_right))
    }

    /// A reader for some of its messages.
    #[must_use]
    pub fn reader(&self, selection: Selection) -> Reader<'_> {
        Reader::new(self, selection)
    }
}
