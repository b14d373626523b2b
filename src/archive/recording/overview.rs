//! Content of a file.

use super::condition::Condition;
use super::file::Recording;
use super::selection::Selection;
use super::statistics::StatisticsFault;
use crate::archive::container::channels::FileChannel;
use crate::archive::container::loss::Loss;
use crate::archive::error::RecordingError;
use crate::archive::format::Entries;
use crate::physics::top::Top;
use crate::telemetry::encoding::Row;
use crate::telemetry::fields::{EVENTS, events};
use crate::telemetry::{Message, event_sentence};
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
    /// Numbers of samples and events, in channels of the table that are in the file.
    #[serde(skip)]
    pub counts: Vec<MessageCount>,
    /// The channels, in the order of the file.
    pub channels: Vec<ChannelOverview>,
    /// The events.
    pub events: Vec<EventOverview>,
    /// A number in the file's statistics that contradicts its content; absent if there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub statistics_fault: Option<StatisticsFault>,
    /// Parts that can't be read, at most 1000.
    pub losses: Vec<Loss>,
    /// Number of further parts that can't be read; absent if all are listed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub more_losses: Option<u64>,
}

/// A channel of a file.
#[derive(Clone, Debug, PartialEq, Default, Serialize, JsonSchema)]
pub struct ChannelOverview {
    /// Topic.
    pub topic: String,
    /// The name of its message type; empty if it has none.
    pub schema: String,
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

/// Number of messages in a channel, compared with the end record.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MessageCount {
    /// `samples` or `events`.
    pub kind: &'static str,
    /// Number of messages in the channel.
    pub found: u64,
    /// Number in the end record.
    pub recorded: u64,
}

impl MessageCount {
    /// The counts of a recording's channels, without repetitions; none if it has no end record.
    fn list(recording: &Recording, counted: &[ChannelOverview]) -> Vec<Self> {
        let mut counts = Vec::new();
        for (channel, overview) in recording.channels().iter().zip(counted) {
            let kind = match (channel.info(), channel.table) {
                // Optional channels leave out some samples.
                (Some(info), _) if info.is_sampled && !info.is_optional => "samples",
                (_, Some(EVENTS)) => "events",
                _ => continue,
            };
            let recorded = recording.end().and_then(|end| end.get(kind)?.parse().ok());
            let Some(recorded) = recorded else { continue };
            let count = Self {
                kind,
                found: overview.messages,
                recorded,
            };
            if !counts.contains(&count) {
                counts.push(count);
            }
        }
        counts
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
        let channels = recording.channels();
        let mut counted: Vec<_> = channels.iter().map(ChannelOverview::new).collect();
        let decoder = channels
            .iter()
            .find(|channel| channel.table == Some(EVENTS))
            .and_then(|channel| channel.decoder()?.ok());
        let top = recording.scenario().ok().map(|scenario| scenario.model.top);
        let (mut events, mut row) = (Vec::new(), Row::default());
        let mut reader = recording.reader(Selection::default());
        while let Some(message) = reader.next_undecoded() {
            counted[message.position].add_message(message.log_time, message.data.len());
            if message.channel.table == Some(EVENTS)
                && let Some(decoder) = &decoder
                && decoder.decode(message.data, &mut row).is_ok()
            {
                events.push(event(&row, top.as_ref()));
            }
        }
        for channel in &mut counted {
            channel.rate_hz = channel.rate_hz();
        }
        let losses = reader.all_losses();
        let condition = recording.condition();
        // Damage that opening the file doesn't find.
        let is_damaged = !reader.losses().is_empty();
        let counts = MessageCount::list(recording, &counted);
        let statistics_fault = reader.statistics_fault();
        let is_altered =
            statistics_fault.is_some() || counts.iter().any(|count| count.found != count.recorded);
        Self {
            condition: if is_damaged {
                Condition::Damaged
            } else {
                match condition {
                    Condition::Whole | Condition::Foreign if is_altered => Condition::Altered,
                    condition => condition,
                }
            },
            library: recording.library().to_owned(),
            is_ours: recording.is_ours(),
            run: recording.run().cloned(),
            end: recording.end().cloned(),
            scenario: recording.scenario_text().ok(),
            counts,
            channels: counted,
            events,
            statistics_fault,
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

fn event(row: &Row, top: Option<&Top>) -> EventOverview {
    let message = Message {
        channel: EVENTS.index(),
        sequence: 0,
        time_ns: row.time_ns,
        numbers: &row.numbers,
        texts: &row.texts,
    };
    EventOverview {
        name: events::NAME.of(&message).to_owned(),
        time: events::TIME.of(&message),
        description: top.map(|top| event_sentence(&message, top)),
    }
}
