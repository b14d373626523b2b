//! `toprise info`.

use super::{Done, Format, format, output};
use crate::archive::recording::{ChannelOverview, Condition, Loss, Overview};
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
    let is_all = matches!(overview.condition, Condition::Whole | Condition::Foreign);
    Ok(if is_all && overview.losses.is_empty() {
        Done::Well
    } else {
        Done::WithLosses
    })
}

fn text(path: &Path, size: u64, overview: &Overview) -> String {
    let mut text = String::new();
    let mut line = |label: &str, value: String| {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "  {label:<10} {value}");
    };
    line("state", overview.condition.name().to_owned());
    if overview.condition == Condition::Foreign {
        line("written by", overview.library.clone());
    }
    for loss in &overview.losses {
        line("lost", loss.to_string());
    }
    if let Some(lost) = overview.recovery.as_ref().and_then(|r| r.get("lost")) {
        line("lost", lost.clone());
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
    let loss = |loss: &Loss| {
        json!({
            "offset": loss.offset,
            "length": loss.length,
            "from_ns": loss.span.map(|span| span.from_ns),
            "to_ns": loss.span.and_then(|span| span.to_ns),
            "reason": loss.reason,
        })
    };
    json!({
        "file": path.display().to_string(),
        "bytes": size,
        "state": overview.condition.name(),
        "library": overview.library,
        "losses": overview.losses.iter().map(loss).collect::<Vec<_>>(),
        "recovery": overview.recovery,
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
