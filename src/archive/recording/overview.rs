//! Content of a file.

use super::clock::Relogged;
use super::condition::Condition;
use super::content::ContentCheck;
use super::file::Recording;
use super::reader::Reader;
use super::selection::Selection;
use super::statistics::StatisticsFault;
use crate::archive::container::attachment::Attachment;
use crate::archive::container::channels::FileChannel;
use crate::archive::container::loss::Loss;
use crate::archive::error::RecordingError;
use crate::archive::format::Entries;
use crate::archive::supplements::Supplementary;
use crate::physics::top::Top;
use crate::telemetry::fields::{EVENTS, events};
use crate::telemetry::{Message, Topics, event_sentence};
use schemars::JsonSchema;
use serde::Serialize;
use std::path::Path;

/// Content of an MCAP file, after reading all of it.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Overview {
    /// Kind of the file.
    #[serde(rename = "state")]
    pub condition: Condition,
    /// Name of the library that wrote it.
    pub library: String,
    /// Whether toprise recorded it.
    #[serde(skip)]
    pub is_ours: bool,
    /// Metadata of toprise from the start of the run; absent in other files.
    pub run: Option<Entries>,
    /// Metadata of toprise from the end of the run; absent if the run did not end.
    pub end: Option<Entries>,
    /// The scenario, TOML.
    pub scenario: Option<String>,
    /// The same as an object, if this version can read it.
    pub scenario_keys: Option<serde_json::Value>,
    /// The channels, in the order of the file.
    pub channels: Vec<ChannelOverview>,
    /// The events.
    pub events: Vec<EventOverview>,
    /// Faults of the messages of the run, in sentences: some are missing, repeated or can't be decoded; absent if
    /// nothing is.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub faults: Vec<String>,
    /// How the log times differ from the time stamps of the messages; absent if they are equal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub relogged: Option<Relogged>,
    /// A number in the file's statistics that contradicts its content; absent if there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub statistics_fault: Option<StatisticsFault>,
    /// What a recording of toprise holds in addition to its run; absent if nothing.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub supplements: Vec<Supplementary>,
    /// The attachments, in the order of the file.
    #[serde(skip)]
    pub attachments: Vec<AttachmentOverview>,
    /// Parts that can't be read, at most 1000.
    pub losses: Vec<Loss>,
    /// Number of further parts that can't be read; absent if all are listed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub more_losses: Option<u64>,
}

/// An attachment of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AttachmentOverview {
    /// Name.
    pub name: String,
    /// Media type.
    pub media_type: String,
    /// Size of the data, bytes.
    pub bytes: u64,
}

impl AttachmentOverview {
    fn new(attachment: &Attachment) -> Self {
        Self {
            name: attachment.header.name.clone(),
            media_type: attachment.header.media_type.clone(),
            bytes: attachment.data_length,
        }
    }
}

/// A channel of a file.
#[derive(Clone, Debug, PartialEq, Default, Serialize, JsonSchema)]
pub struct ChannelOverview {
    /// Topic.
    pub topic: String,
    /// The name of its message type; empty if it has none.
    pub schema: String,
    /// The id of its message type, if the file doesn't define it.
    #[serde(skip)]
    pub undefined_schema: Option<u16>,
    /// The encoding of its messages.
    pub encoding: String,
    /// Number of messages.
    pub messages: u64,
    /// Mean rate of the messages, Hz; absent for fewer than two.
    pub rate_hz: Option<f64>,
    /// Bytes of all messages.
    pub bytes: u64,
    /// Earliest log time, ns; 0 without messages.
    pub first_ns: u64,
    /// Latest log time, ns; 0 without messages.
    pub last_ns: u64,
}

impl ChannelOverview {
    /// A channel of which no message has been counted yet.
    fn new(channel: &FileChannel) -> Self {
        Self {
            topic: channel.topic.clone(),
            encoding: channel.encoding.clone(),
            schema: channel.schema_name().to_owned(),
            undefined_schema: channel.undefined_schema(),
            ..Self::default()
        }
    }

    fn rate_hz(&self) -> Option<f64> {
        let span = self.last_ns.saturating_sub(self.first_ns);
        (self.messages > 1 && span > 0).then(|| (self.messages - 1) as f64 * 1e9 / span as f64)
    }

    fn add_message(&mut self, time_ns: u64, bytes: usize) {
        // Files of other software need not be in order of time.
        if self.messages == 0 || time_ns < self.first_ns {
            self.first_ns = time_ns;
        }
        self.last_ns = self.last_ns.max(time_ns);
        self.messages += 1;
        self.bytes += bytes as u64;
    }
}

/// An event of a recording.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct EventOverview {
    /// Kind of the event.
    pub name: String,
    /// Time, s.
    pub time: f64,
    /// A sentence about the event; absent if the scenario can't be read.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
}

impl Overview {
    /// Opens a file and reads it as far as it can be read.
    ///
    /// # Errors
    /// [`RecordingError`] if it can't be opened or is not MCAP. Damage is no error: it is listed in
    /// `losses`.
    pub fn read(path: &Path) -> Result<Self, RecordingError> {
        Ok(Self::new(&Recording::open(path)?))
    }

    /// Reads a recording as far as it can be read.
    pub fn new(recording: &Recording) -> Self {
        let mut channels: Vec<_> = recording
            .channels()
            .iter()
            .map(ChannelOverview::new)
            .collect();
        let top = recording.scenario().ok().map(|scenario| scenario.model.top);
        let (mut events, mut check) = (Vec::new(), ContentCheck::new(recording, &Topics::All));
        let is_ours = recording.is_ours();
        let mut reader = recording.reader(Selection::default());
        if is_ours {
            // As explain and diff read it: repeated messages don't belong to the run.
            reader = reader.in_order_of_time();
        }
        while let Some((message, decoded)) = reader.next_both() {
            channels[message.position].add_message(message.log_time, message.data.len());
            let Some(decoded) = decoded else { continue };
            check.take(&decoded);
            if let Ok(decoded) = decoded
                && decoded.topic() == EVENTS
            {
                events.push(event(&decoded, top.as_ref()));
            }
        }
        for channel in &mut channels {
            channel.rate_hz = channel.rate_hz();
        }
        let losses = reader.all_losses();
        let statistics_fault = reader.statistics_fault();
        let faults = if is_ours {
            content_faults(recording, &reader, check)
        } else {
            Vec::new()
        };
        Self {
            condition: reader.condition(!faults.is_empty()),
            library: recording.library().to_owned(),
            is_ours,
            run: recording.run().cloned(),
            end: recording.end().cloned(),
            scenario: recording.scenario_text().ok(),
            scenario_keys: recording.scenario().ok().map(|scenario| scenario.to_json()),
            channels,
            events,
            faults,
            relogged: recording.relogged(),
            statistics_fault,
            supplements: if is_ours {
                recording.supplements()
            } else {
                Vec::new()
            },
            attachments: recording
                .layout
                .attachments
                .iter()
                .map(AttachmentOverview::new)
                .collect(),
            more_losses: losses.unlisted(),
            losses: losses.list().to_vec(),
        }
    }

    /// Whether it is a recording of toprise that reached its end and is readable throughout.
    pub fn is_whole(&self) -> bool {
        self.condition == Condition::Whole
    }

    /// Number of messages in all channels.
    pub fn messages(&self) -> u64 {
        self.channels.iter().map(|channel| channel.messages).sum()
    }

    /// Earliest log time, ns; 0 without messages.
    pub fn first_ns(&self) -> u64 {
        let channels = self.channels.iter().filter(|c| c.messages > 0);
        channels.map(|c| c.first_ns).min().unwrap_or(0)
    }

    /// Latest log time, ns; 0 without messages.
    pub fn last_ns(&self) -> u64 {
        self.channels.iter().map(|c| c.last_ns).max().unwrap_or(0)
    }
}

/// Faults of the messages of a recording, in sentences.
fn content_faults(recording: &Recording, reader: &Reader<'_>, check: ContentCheck) -> Vec<String> {
    let mut sentences: Vec<String> = reader
        .left_out()
        .map(ToString::to_string)
        .into_iter()
        .collect();
    let faults = check.finish(recording.end());
    sentences.extend(faults.sentences(!reader.all_losses().is_empty()));
    sentences
}

fn event(message: &Message<'_>, top: Option<&Top>) -> EventOverview {
    EventOverview {
        name: events::NAME.of(message).to_owned(),
        time: events::TIME.of(message),
        description: top.map(|top| event_sentence(message, top)),
    }
}
