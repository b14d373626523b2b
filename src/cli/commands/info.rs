//! `toprise info`.

use crate::archive::container::loss::loss_lines;
use crate::archive::format::{
    CONTENT_DIGEST, SCENARIO_DIGEST, STEPS, STOP_REASON, STOP_TIME, VERSION,
};
use crate::archive::recording::{
    AttachmentOverview, ChannelOverview, Condition, Overview, Recording,
};
use crate::archive::supplements::Supplementary;
use crate::cli::report;
use crate::cli::status::Status;
use crate::run::simulation::EventKind;
use crate::run::time::seconds_and_nanoseconds;
use crate::telemetry::Topic;
use crate::words::number::{bytes, fixed};
use crate::words::shortened_to;
use crate::words::{Column, Section, Table, grouped, plural};
use anyhow::{Context as _, Error};
use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Event kinds with more events than this are only counted.
const MAX_LISTED: u64 = 20;

/// Longest value of a metadata record that is shown whole, characters.
const MAX_VALUE: usize = 80;

/// Arguments of `toprise info`.
#[derive(Args, Debug, Default, PartialEq)]
pub(in crate::cli) struct InfoArguments {
    /// An MCAP file.
    file: PathBuf,
}

/// Content of a file.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct InfoReport {
    /// The file.
    file: String,
    /// Size of the file, bytes.
    bytes: u64,
    /// Number of messages in all channels.
    messages: u64,
    /// Earliest log time, ns; 0 without messages.
    first_ns: u64,
    /// Latest log time, ns; 0 without messages.
    last_ns: u64,
    #[serde(flatten)]
    overview: Overview,
}

/// Lists the content of a file.
pub(super) fn info(arguments: &InfoArguments) -> Result<Status, Error> {
    let path = &arguments.file;
    let file = path.display().to_string();
    let recording = Recording::open(path).with_context(|| file.clone())?;
    let report = InfoReport::new(file, &recording);
    // Files of other software have no end of a run that could be missing.
    let condition = report.overview.condition;
    let is_whole = matches!(condition, Condition::Whole | Condition::Foreign);
    report::print(&report, || report.page())?;
    Ok(Status::from_whole(
        is_whole && report.overview.losses.is_empty(),
    ))
}

impl InfoReport {
    /// The content of a recording; `file` is its name in the report.
    pub(super) fn new(file: String, recording: &Recording) -> Self {
        let overview = Overview::new(recording);
        Self {
            file,
            bytes: recording.size(),
            messages: overview.messages(),
            first_ns: overview.first_ns(),
            last_ns: overview.last_ns(),
            overview,
        }
    }

    pub(super) fn page(&self) -> Vec<Section> {
        let facts = Section::from(Table::from_facts(self.facts()));
        let head = facts.titled(&self.file, bytes(self.bytes));
        let mut rest = Section::from(self.channel_table());
        // A recording of toprise has its scenario, which the first lines name.
        if !self.overview.is_ours {
            rest.table(self.attachment_table());
        }
        rest.table(self.metadata_table());
        rest.table(self.event_table());
        vec![head, rest]
    }

    fn facts(&self) -> Vec<(&'static str, String)> {
        let overview = &self.overview;
        let mut facts = vec![("state", overview.condition.name().to_owned())];
        if !overview.is_ours {
            facts.push(("written by", overview.library.clone()));
        }
        facts.extend(loss_lines(&overview.losses, overview.more_losses));
        facts.extend(
            overview
                .faults
                .iter()
                .map(|fault| ("altered", fault.clone())),
        );
        if let Some(fault) = &overview.statistics_fault {
            facts.push(("altered", fault.to_string()));
        }
        if let Some(run) = &overview.run {
            facts.push(("scenario", run_line(run)));
        }
        if let Some(end) = &overview.end {
            facts.push(("end", end_line(end)));
            let digest = entry(end, CONTENT_DIGEST);
            facts.push(("content", format!("sha-256 {digest}")));
        }
        if let Some(relogged) = overview.relogged {
            facts.push(("log times", relogged.fact()));
        }
        let supplements = overview.supplements.iter().map(ToString::to_string);
        facts.extend(supplements.map(|supplement| ("in addition", supplement)));
        facts.push(("span", exact_seconds(self.last_ns - self.first_ns)));
        facts.push(("messages", self.message_line()));
        if !self.overview.events.is_empty() {
            let mut counts = Vec::new();
            for (name, number) in self.counts() {
                let kind = EventKind::find(name);
                let is_extreme = kind.is_some_and(EventKind::is_nutation_extreme);
                // There are more nutations than extremes of θ: where θ falls fast, they only slow it down and speed it up.
                let quantity = if is_extreme { " of θ" } else { "" };
                counts.push(format!(
                    "{} × {}{quantity}",
                    grouped(number),
                    event_words(name, number)
                ));
            }
            facts.push(("events", counts.join(", ")));
        }
        facts
    }

    /// Number of messages; also without those for viewers, which other commands don't count.
    fn message_line(&self) -> String {
        let all = grouped(self.messages);
        let channels = self.overview.channels.iter();
        let of_run: u64 = channels
            .filter(|channel| Topic::all().any(|topic| topic.name() == channel.topic))
            .map(|channel| channel.messages)
            .sum();
        if !self.overview.is_ours || of_run == self.messages {
            return all;
        }
        format!("{all} ({} of the run itself)", grouped(of_run))
    }

    /// Number of events of each kind.
    fn counts(&self) -> BTreeMap<&str, u64> {
        let mut counts = BTreeMap::new();
        for event in &self.overview.events {
            *counts.entry(event.name.as_str()).or_insert(0) += 1;
        }
        counts
    }

    fn channel_table(&self) -> Table {
        let columns: [Column<&ChannelOverview>; 6] = [
            ("topic", |channel| channel.topic.clone()),
            ("type", |channel| match channel.undefined_schema {
                Some(id) => format!("schema {id}, which is not defined"),
                None => channel.schema.clone(),
            }),
            ("encoding", |channel| channel.encoding.clone()),
            ("messages", |channel| grouped(channel.messages)),
            ("rate", |channel| match channel.rate_hz {
                Some(rate) => format!("{rate:.1} Hz"),
                None => String::new(),
            }),
            ("uncompressed", |channel| bytes(channel.bytes)),
        ];
        Table::new(&self.overview.channels, 3, &columns)
    }

    fn attachment_table(&self) -> Table {
        let columns: [Column<&AttachmentOverview>; 3] = [
            ("attachment", |attachment| attachment.name.clone()),
            ("media type", |attachment| attachment.media_type.clone()),
            ("bytes", |attachment| bytes(attachment.bytes)),
        ];
        Table::new(&self.overview.attachments, 2, &columns)
    }

    /// The entries of the metadata records in addition to the run.
    fn metadata_table(&self) -> Table {
        let mut rows = Vec::new();
        for supplement in &self.overview.supplements {
            let Supplementary::Metadata { name, entries } = supplement else {
                continue;
            };
            for (key, value) in entries {
                let value = shortened_to(value, MAX_VALUE).into_owned();
                rows.push(vec![name.clone(), key.clone(), value]);
            }
        }
        Table::from_texts(rows)
    }

    fn event_table(&self) -> Table {
        let counts = self.counts();
        let mut rows = Vec::new();
        for event in &self.overview.events {
            let kind = EventKind::find(&event.name);
            // Each nutation has its extremes: they would hide everything else.
            let is_common = kind.is_some_and(EventKind::is_nutation_extreme);
            if counts[event.name.as_str()] <= MAX_LISTED && !is_common {
                rows.push(vec![
                    format!("{:.6} s", event.time),
                    event_words(&event.name, 1),
                    event.description.clone().unwrap_or_default(),
                ]);
            }
        }
        Table::from_texts(rows)
    }
}

/// An event in a few words; its name if this version doesn't know the kind.
fn event_words(name: &str, count: u64) -> String {
    EventKind::find(name).map_or_else(|| name.replace('_', " "), |kind| kind.words(count))
}

/// A time in seconds, exact to the nanosecond: Unix times have more digits than a float.
fn exact_seconds(time_ns: u64) -> String {
    let (seconds, nanoseconds) = seconds_and_nanoseconds(time_ns);
    let text = format!("{seconds}.{nanoseconds:09}");
    format!("{} s", text.trim_end_matches('0').trim_end_matches('.'))
}

fn entry<'a>(entries: &'a BTreeMap<String, String>, key: &str) -> &'a str {
    // Other versions may have other entries.
    entries.get(key).map_or("?", String::as_str)
}

/// A count of an end record with its noun.
fn entry_count(end: &BTreeMap<String, String>, key: &str, noun: &str) -> String {
    let number = entry(end, key);
    // A count that isn't a number is shown as it stands.
    format!("{number} {}", plural(number.parse().unwrap_or(0), noun))
}

fn run_line(run: &BTreeMap<String, String>) -> String {
    format!(
        "{} ({} formulation, friction law {}, toprise {}), digest {:.16}…",
        entry(run, "scenario"),
        entry(run, "formulation"),
        entry(run, "friction_law"),
        entry(run, VERSION),
        entry(run, SCENARIO_DIGEST)
    )
}

fn end_line(end: &BTreeMap<String, String>) -> String {
    let time = entry(end, STOP_TIME)
        .parse()
        .map_or("?".to_owned(), |time| fixed(time, 6));
    format!(
        "{} at {} s, {}, {} (from one maximum of θ̇ to the next), {}",
        entry(end, STOP_REASON),
        time,
        entry_count(end, "samples", "sample"),
        entry_count(end, "nutations", "nutation"),
        entry_count(end, STEPS, "step")
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::arguments::parse;

    #[test]
    fn rounds_the_end() {
        let end = |time: &str| BTreeMap::from([(STOP_TIME.to_owned(), time.to_owned())]);
        for (time, shown) in [
            ("1.2299986164036739e-5", "? at 0.000012 s"),
            ("24.730941", "? at 24.730941 s"),
            ("78.4096899", "? at 78.409690 s"),
        ] {
            let line = end_line(&end(time));
            assert!(line.starts_with(shown), "{line}");
        }
    }

    #[test]
    fn times_are_exact_to_the_nanosecond() {
        for (time_ns, expected) in [
            (0, "0 s"),
            (20_000_000, "0.02 s"),
            (1, "0.000000001 s"),
            (10_000_000_000, "10 s"),
            (1_659_409_674_222_474_801, "1659409674.222474801 s"),
            (u64::MAX, "18446744073.709551615 s"),
        ] {
            assert_eq!(exact_seconds(time_ns), expected);
        }
    }

    #[test]
    fn parses_one_file() {
        let expected = InfoArguments {
            file: "a.mcap".into(),
        };
        assert_eq!(parse::<InfoArguments>("a.mcap").unwrap(), expected);
        assert!(parse::<InfoArguments>("").is_err());
        assert!(parse::<InfoArguments>("a.mcap b.mcap").is_err());
    }
}
