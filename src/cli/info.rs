//! `toprise info`.

use super::done::Done;
use super::numbers::{bytes, count};
use super::page::{Page, Section};
use super::report::{self, LossReport};
use super::table::Table;
use crate::archive::recording::{ChannelOverview, Condition, Overview};
use crate::run::simulation::EventKind;
use anyhow::{Context as _, Error};
use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Kinds of events with more of them are counted, not listed.
const RARE: u64 = 20;

/// Arguments of `toprise info`.
#[derive(Args, Debug, Default, PartialEq)]
pub(super) struct InfoArguments {
    /// An MCAP file.
    file: PathBuf,
}

/// Content of a file.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct InfoReport {
    /// The file.
    file: String,
    /// Its size.
    bytes: u64,
    /// Kind of the file.
    state: Condition,
    /// Name of the library that wrote it.
    library: String,
    /// Parts that can't be read.
    losses: Vec<LossReport>,
    /// Metadata of toprise from the start of the run; absent in other files.
    run: Option<BTreeMap<String, String>>,
    /// Metadata of toprise from the end of the run; absent if it did not.
    end: Option<BTreeMap<String, String>>,
    /// The scenario, TOML.
    scenario: Option<String>,
    /// Number of messages in all channels.
    messages: u64,
    /// Time of the last message, ns.
    last_ns: u64,
    /// The channels, in the order of the file.
    channels: Vec<ChannelReport>,
    /// The event.
    events: Vec<EventReport>,
    /// The losses, human-readable.
    #[serde(skip)]
    told_losses: Vec<String>,
}

/// A channel of a file.
#[derive(Debug, Serialize, JsonSchema)]
struct ChannelReport {
    /// Its topic.
    topic: String,
    /// The name of its message type; empty if it has none.
    schema: String,
    /// The encoding of its messages.
    encoding: String,
    /// Number of messages.
    messages: u64,
    /// Mean rate of the messages, Hz; absent for fewer than two.
    rate_hz: Option<f64>,
    /// Bytes of all messages.
    bytes: u64,
    /// Time of the first message, ns.
    first_ns: u64,
    /// Time of the last message, ns.
    last_ns: u64,
}

/// An event of a run.
#[derive(Debug, Serialize, JsonSchema)]
struct EventReport {
    /// Its kind.
    name: String,
    /// When, s.
    time: f64,
    /// The event, in a sentence.
    description: String,
}

/// Says what is in a file.
pub(super) fn info(arguments: &InfoArguments) -> Result<Done, Error> {
    let path = &arguments.file;
    let context = || path.display().to_string();
    let overview = Overview::read(path).with_context(context)?;
    let size = fs::metadata(path).with_context(context)?.len();
    let is_whole = matches!(overview.condition, Condition::Whole | Condition::Foreign);
    let report = InfoReport::of(path, size, overview);
    report::print(&report, || report.page())?;
    Ok(if is_whole && report.losses.is_empty() {
        Done::Well
    } else {
        Done::WithLosses
    })
}

impl InfoReport {
    fn of(path: &Path, size: u64, overview: Overview) -> Self {
        let channel = |channel: &ChannelOverview| ChannelReport {
            topic: channel.topic.clone(),
            schema: channel.schema.clone(),
            encoding: channel.encoding.clone(),
            messages: channel.messages,
            rate_hz: channel.rate(),
            bytes: channel.bytes,
            first_ns: channel.first_ns,
            last_ns: channel.last_ns,
        };
        let events = overview.events.iter().map(|event| EventReport {
            name: event.name.clone(),
            time: event.time,
            description: event.description.clone(),
        });
        Self {
            file: path.display().to_string(),
            bytes: size,
            state: overview.condition,
            losses: overview.losses.iter().map(LossReport::from).collect(),
            told_losses: overview.losses.iter().map(ToString::to_string).collect(),
            messages: overview.messages(),
            last_ns: overview.last_ns(),
            channels: overview.channels.iter().map(channel).collect(),
            events: events.collect(),
            library: overview.library,
            run: overview.run,
            end: overview.end,
            scenario: overview.scenario,
        }
    }

    fn page(&self) -> Page {
        let mut head = Section::new(&self.file);
        head.note = bytes(self.bytes);
        head.table(Table::of_facts(self.facts()));
        let mut rest = Section::default();
        rest.table(self.channel_table());
        rest.table(self.event_table());
        Page {
            sections: vec![head, rest],
            ..Page::default()
        }
    }

    fn facts(&self) -> Vec<(&'static str, String)> {
        let mut facts = vec![("state", self.state.name().to_owned())];
        if self.state == Condition::Foreign {
            facts.push(("written by", self.library.clone()));
        }
        facts.extend(self.told_losses.iter().map(|loss| ("lost", loss.clone())));
        if let Some(run) = &self.run {
            facts.push(("scenario", run_line(run)));
        }
        if let Some(end) = &self.end {
            facts.push(("end", end_line(end)));
            facts.push((
                "content",
                format!("sha-256 {}", entry(end, "content_digest")),
            ));
        }
        facts.push(("span", format!("{} s", self.last_ns as f64 / 1e9)));
        facts.push(("messages", count(self.messages)));
        if !self.events.is_empty() {
            let counts = self.counts().into_iter();
            let counts: Vec<_> = counts
                .map(|(name, number)| format!("{} × {}", count(number), name.replace('_', " ")))
                .collect();
            facts.push(("events", counts.join(", ")));
        }
        facts
    }

    /// Number of events of each kind.
    fn counts(&self) -> BTreeMap<&str, u64> {
        let mut counts = BTreeMap::new();
        for event in &self.events {
            *counts.entry(event.name.as_str()).or_insert(0) += 1;
        }
        counts
    }

    fn channel_table(&self) -> Table {
        let header = ["topic", "type", "encoding", "messages", "rate", "bytes"];
        let row = |channel: &ChannelReport| {
            let rate = channel.rate_hz.map(|rate| format!("{rate:.1} Hz"));
            vec![
                channel.topic.clone(),
                channel.schema.clone(),
                channel.encoding.clone(),
                count(channel.messages),
                rate.unwrap_or_default(),
                bytes(channel.bytes),
            ]
        };
        Table {
            header: header.map(str::to_owned).to_vec(),
            rows: self.channels.iter().map(row).collect(),
            left: 3,
        }
    }

    fn event_table(&self) -> Table {
        let counts = self.counts();
        let is_rare = |event: &&EventReport| {
            let is_of_nutation =
                EventKind::find(&event.name).is_some_and(EventKind::is_of_nutation);
            counts[event.name.as_str()] <= RARE && !is_of_nutation
        };
        let rare = self.events.iter().filter(is_rare);
        let row = |event: &EventReport| {
            vec![
                format!("{:.6} s", event.time),
                event.name.replace('_', " "),
                event.description.clone(),
            ]
        };
        Table::of_texts(rare.map(row).collect())
    }
}

fn entry<'a>(entries: &'a BTreeMap<String, String>, key: &str) -> &'a str {
    entries.get(key).map_or("", String::as_str)
}

fn run_line(run: &BTreeMap<String, String>) -> String {
    format!(
        "{} ({} formulation, friction law {}, toprise {}), digest {:.16}…",
        entry(run, "scenario"),
        entry(run, "formulation"),
        entry(run, "friction_law"),
        entry(run, "version"),
        entry(run, "scenario_digest")
    )
}

fn end_line(end: &BTreeMap<String, String>) -> String {
    format!(
        "{} at {} s: {} samples, {} nutations, {} steps",
        entry(end, "stop_reason"),
        entry(end, "stop_time"),
        entry(end, "samples"),
        entry(end, "nutations"),
        entry(end, "steps_accepted")
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::arguments::parse;

    #[test]
    fn one_file_is_named() {
        let expected = InfoArguments {
            file: "a.mcap".into(),
        };
        assert_eq!(parse::<InfoArguments>("a.mcap").unwrap(), expected);
        assert!(parse::<InfoArguments>("").is_err());
        assert!(parse::<InfoArguments>("a.mcap b.mcap").is_err());
    }
}
