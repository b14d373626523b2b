//! `toprise info`.

use super::{Done, Format, format, output};
use crate::recording::{ChannelOverview, Overview};
use anyhow::{Context as _, Error};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

/// Says what is in a recording.
pub(super) fn info(path: &Path, form: Format) -> Result<Done, Error> {
    let context = || path.display().to_string();
    let overview = Overview::read(path).with_context(context)?;
    let size = fs::metadata(path).with_context(context)?.len();
    match form {
        Format::Text => output::print(&text(path, size, &overview))?,
        Format::Json => output::print(&format!("{:#}", json(path, size, &overview)))?,
    }
    Ok(if overview.damage.is_some() {
        Done::WithLosses
    } else {
        Done::Well
    })
}

/// What kind of file it is.
fn state(overview: &Overview) -> &'static str {
    match (&overview.run, &overview.end, &overview.damage) {
        (None, ..) => "not a toprise recording",
        (Some(_), Some(_), None) => "complete",
        (Some(_), None, _) => "interrupted",
        (Some(_), Some(_), Some(_)) => "damaged",
    }
}

fn text(path: &Path, size: u64, overview: &Overview) -> String {
    let mut text = String::new();
    let mut line = |label: &str, value: String| {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "  {label:<10} {value}");
    };
    line("state", state(overview).to_owned());
    if let Some(damage) = &overview.damage {
        line("damage", format!("readable up to here: {damage}"));
    }
    if let Some(run) = &overview.run {
        line("scenario", run_line(run));
    }
    if let Some(end) = &overview.end {
        line("end", end_line(end));
        line("content", entry(end, "content_digest"));
    }
    line("span", format!("{} s", overview.last_ns() as f64 / 1e9));
    line("messages", format::count(overview.messages()));
    line("events", event_counts(overview));
    format!(
        "{}  {}\n{text}\n{}{}",
        path.display(),
        format::bytes(size),
        channel_table(&overview.channels),
        event_table(overview)
    )
}

fn entry(record: &BTreeMap<String, String>, key: &str) -> String {
    record.get(key).cloned().unwrap_or_default()
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

fn counts(overview: &Overview) -> BTreeMap<&str, u64> {
    let mut counts = BTreeMap::new();
    for event in &overview.events {
        *counts.entry(event.name.as_str()).or_insert(0) += 1;
    }
    counts
}

fn event_counts(overview: &Overview) -> String {
    let counts = counts(overview);
    let parts = counts.iter().map(|(name, count)| format!("{count} {name}"));
    parts.collect::<Vec<_>>().join(", ")
}

fn channel_table(channels: &[ChannelOverview]) -> String {
    let header = ["topic", "type", "encoding", "messages", "rate", "bytes"];
    let row = |channel: &ChannelOverview| {
        let rate = channel.rate().map(|rate| format!("{rate:.1} Hz"));
        vec![
            channel.topic.clone(),
            channel.schema.clone(),
            channel.encoding.clone(),
            format::count(channel.messages),
            rate.unwrap_or_default(),
            format::bytes(channel.bytes),
        ]
    };
    let mut rows = vec![header.map(str::to_owned).to_vec()];
    rows.extend(channels.iter().map(row));
    format::table(&rows, &[3, 4, 5])
}

/// The events that happen a few times; nutation extremes would bury them.
fn event_table(overview: &Overview) -> String {
    let rare = 20;
    let counts = counts(overview);
    let rows: Vec<_> = overview
        .events
        .iter()
        .filter(|event| counts[event.name.as_str()] <= rare)
        .map(|event| {
            vec![
                format!("{:.6} s", event.time),
                event.name.clone(),
                event.description.clone(),
            ]
        })
        .collect();
    if rows.is_empty() {
        String::new()
    } else {
        format!("\n{}", format::table(&rows, &[0]))
    }
}

fn json(path: &Path, size: u64, overview: &Overview) -> Value {
    let channel = |channel: &ChannelOverview| {
        json!({
            "topic": channel.topic,
            "schema": channel.schema,
            "encoding": channel.encoding,
            "messages": channel.messages,
            "rate_hz": channel.rate(),
            "bytes": channel.bytes,
            "first_ns": channel.first_ns,
            "last_ns": channel.last_ns,
        })
    };
    json!({
        "file": path.display().to_string(),
        "bytes": size,
        "state": state(overview),
        "damage": overview.damage,
        "run": overview.run,
        "end": overview.end,
        "scenario": overview.scenario,
        "messages": overview.messages(),
        "last_ns": overview.last_ns(),
        "channels": overview.channels.iter().map(channel).collect::<Vec<_>>(),
        "events": overview.events.iter().map(|event| json!({
            "name": event.name,
            "time": event.time,
            "description": event.description,
        })).collect::<Vec<_>>(),
    })
}
