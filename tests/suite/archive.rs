//! The MCAP files: what is in them, their bytes, and what happens when things go wrong.

use crate::support::{assert_contains, scenario};
use mcap::MessageStream;
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;
use toprise::analysis::diff::{Options, compare};
use toprise::analysis::explain::explain;
use toprise::archive::pipeline::{Archived, McapSink};
use toprise::archive::publish::{Existing, partial_name};
use toprise::archive::recording::{Condition, Overview, Recording, RecordingError};
use toprise::archive::sink::{Sink, SinkError, record, record_all};
use toprise::archive::verify::{Equality, verify};
use toprise::archive::writer::Form;
use toprise::physics::dynamics::Support;
use toprise::run::scenario::Scenario;
use toprise::telemetry::views::VIEW_CHANNELS;
use toprise::telemetry::{RunMessages, Topic, Topics};

fn short() -> Scenario {
    scenario("paper", &[("stop.duration", "0.5")])
}

fn archive(path: &Path, scenario: &Scenario, existing: Existing) -> Result<Archived, SinkError> {
    let mut run = RunMessages::new(scenario, &Topics::All).unwrap();
    let mut sink = McapSink::create(path, existing, scenario, run.telemetry(), Form::default())?;
    let recorded = record_all(&mut run, &mut [&mut sink]).unwrap();
    sink.finish(&recorded.outcome.end)
}

#[test]
fn equal_scenarios_give_equal_bytes() {
    let directory = tempfile::tempdir().unwrap();
    let paths = ["a.mcap", "b.mcap"].map(|name| directory.path().join(name));
    let archived = paths
        .each_ref()
        .map(|p| archive(p, &short(), Existing::Keep).unwrap());
    assert_eq!(archived[0].digest, archived[1].digest);
    assert_eq!(fs::read(&paths[0]).unwrap(), fs::read(&paths[1]).unwrap());
}

/// How many topics the recording of a top with a fixed peg has.
fn topics_of_fixed_peg() -> usize {
    Topic::all_with(Support::FixedPeg).count()
}

#[test]
fn mcap_crate_reads_everything() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let archived = archive(&path, &short(), Existing::Keep).unwrap();
    let bytes = fs::read(&path).unwrap();
    assert_eq!(bytes.len() as u64, archived.bytes);

    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    let statistics = summary.stats.as_ref().unwrap();
    // The views have seven message types.
    assert_eq!(
        usize::from(statistics.schema_count),
        topics_of_fixed_peg() + 7
    );
    assert_eq!(
        (statistics.attachment_count, statistics.metadata_count),
        (1, 2)
    );
    assert_eq!(statistics.message_start_time, 0);
    assert_eq!(statistics.message_end_time, 500_000_000);

    let attachment = mcap::read::attachment(&bytes, &summary.attachment_indexes[0]).unwrap();
    let text = String::from_utf8(attachment.data.into_owned()).unwrap();
    assert_eq!(Scenario::from_toml(&text).unwrap(), short());

    let options = mcap::read::Options::ValidateChunkCrcs.into();
    let mut last = 0;
    let mut counts = std::collections::BTreeMap::new();
    for message in MessageStream::new_with_options(&bytes, options).unwrap() {
        let message = message.unwrap();
        assert!(message.log_time >= last);
        assert_eq!(message.log_time, message.publish_time);
        last = message.log_time;
        let schema = message.channel.schema.as_ref().unwrap();
        let encodings = (
            message.channel.message_encoding.as_str(),
            schema.encoding.as_str(),
        );
        if encodings != ("cdr", "ros2msg") {
            assert_eq!(encodings, ("json", "jsonschema"));
            serde_json::from_slice::<serde_json::Value>(&message.data).unwrap();
        }
        *counts.entry(message.channel.topic.clone()).or_insert(0) += 1;
    }
    assert_eq!(counts["/top/state"], 501);
    assert_eq!(counts["/tf"], 51);
    let views = VIEW_CHANNELS.iter().filter(|view| !view.is_free_peg_only);
    assert_eq!(counts.len(), topics_of_fixed_peg() + views.count());
}

#[test]
fn metadata_describes_the_run() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let archived = archive(&path, &short(), Existing::Keep).unwrap();
    let overview = Overview::read(&path).unwrap();
    assert!(overview.is_whole());
    let run = overview.run.as_ref().unwrap();
    assert_eq!(run["scenario"], "paper");
    assert_eq!(run["scenario_digest"], short().digest());
    assert_eq!(run["epoch"], "simulation start");
    let end = overview.end.as_ref().unwrap();
    assert_eq!(end["stop_reason"], "duration");
    assert_eq!(end["samples"], "501");
    assert_eq!(end["content_digest"], archived.digest);
    assert_eq!(Recording::open(&path).unwrap().end(), Some(end));
    assert_eq!(overview.scenario, Some(short().to_toml()));
    assert_eq!(overview.events[0].name, "start");
    assert_eq!(overview.last_ns(), 500_000_000);
    let state = &overview.channels[0];
    assert_eq!((state.topic.as_str(), state.messages), ("/top/state", 501));
    assert!((state.rate_hz.unwrap() - 1000.0).abs() < 1e-9);
}

#[test]
fn keeps_existing_files() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    fs::write(&path, "precious").unwrap();
    let error = archive(&path, &short(), Existing::Keep).unwrap_err();
    assert!(matches!(error, SinkError::Exists { .. }), "{error}");
    assert_eq!(fs::read(&path).unwrap(), b"precious");
    assert!(!partial_name(&path).exists());
    archive(&path, &short(), Existing::Replace).unwrap();
    assert!(Overview::read(&path).unwrap().is_whole());
}

#[test]
fn refuses_to_replace_directories_and_devices() {
    let directory = tempfile::tempdir().unwrap();
    for existing in [Existing::Keep, Existing::Replace] {
        let error = archive(directory.path(), &short(), existing).unwrap_err();
        assert_contains(&error.to_string(), "not a regular file");
    }
    if cfg!(unix) {
        let error = archive(Path::new("/dev/null"), &short(), Existing::Replace).unwrap_err();
        assert_contains(&error.to_string(), "not a regular file");
    }
}

#[test]
fn keeps_partial_recordings() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    fs::write(partial_name(&path), "interrupted").unwrap();
    let error = archive(&path, &short(), Existing::Keep).unwrap_err();
    assert_contains(&error.to_string(), "partial");
    assert_eq!(fs::read(partial_name(&path)).unwrap(), b"interrupted");
}

#[test]
fn keeps_files_created_during_the_run() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let mut run = RunMessages::new(&short(), &Topics::All).unwrap();
    let (telemetry, form) = (run.telemetry(), Form::default());
    let mut sink = McapSink::create(&path, Existing::Keep, &short(), telemetry, form).unwrap();
    let recorded = record_all(&mut run, &mut [&mut sink]).unwrap();
    fs::write(&path, "came in between").unwrap();
    let error = sink.finish(&recorded.outcome.end).unwrap_err();
    assert!(matches!(error, SinkError::Exists { .. }), "{error}");
    assert_eq!(fs::read(&path).unwrap(), b"came in between");
    assert!(Overview::read(&partial_name(&path)).unwrap().is_whole());
}

#[test]
fn abandoned_recordings_stay_readable() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let mut run = RunMessages::new(&short(), &Topics::All).unwrap();
    let (telemetry, form) = (run.telemetry(), Form::default());
    let mut sink = McapSink::create(&path, Existing::Keep, &short(), telemetry, form).unwrap();
    let mut samples = 0;
    let stop_early = |_: &_, sinks: &mut [&mut dyn Sink]| {
        samples += 1;
        if samples < 300 {
            return Ok(ControlFlow::Continue(()));
        }
        sinks[0].flush()?;
        Ok(ControlFlow::Break(()))
    };
    record(&mut run, &mut [&mut sink], stop_early).unwrap();
    drop(sink);
    assert!(!path.exists());
    let overview = Overview::read(&partial_name(&path)).unwrap();
    assert!(overview.run.is_some() && overview.end.is_none() && !overview.is_whole());
    // 300 records: samples, events and cycles; every one of them was flushed.
    let records: u64 = overview
        .channels
        .iter()
        .filter(|c| ["/top/state", "/top/nutation", "/events"].contains(&c.topic.as_str()))
        .map(|c| c.messages)
        .sum();
    assert_eq!(records, 300);
}

#[test]
fn distinguishes_damaged_from_foreign_files() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    archive(&path, &short(), Existing::Keep).unwrap();
    let whole = fs::read(&path).unwrap();

    let truncated = directory.path().join("truncated.mcap");
    fs::write(&truncated, &whole[..whole.len() * 2 / 3]).unwrap();
    let overview = Overview::read(&truncated).unwrap();
    assert_eq!(overview.condition, Condition::Interrupted);
    assert!(overview.losses.len() == 1 && overview.messages() > 0 && overview.end.is_none());

    let flipped = directory.path().join("flipped.mcap");
    let mut bytes = whole.clone();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&flipped, bytes).unwrap();
    let overview = Overview::read(&flipped).unwrap();
    assert_eq!(overview.condition, Condition::Damaged);
    assert!(overview.messages() > 0 && overview.end.is_some());

    let other = directory.path().join("other");
    fs::write(&other, b"").unwrap();
    let error = Overview::read(&other).unwrap_err();
    assert!(matches!(error, RecordingError::Empty), "{error}");
    for bytes in [&b"not an mcap file, but long enough"[..], b"\x89"] {
        fs::write(&other, bytes).unwrap();
        let error = Overview::read(&other).unwrap_err();
        assert!(matches!(error, RecordingError::NotMcap), "{error}");
    }
    let error = Overview::read(directory.path()).unwrap_err();
    assert!(matches!(error, RecordingError::Directory), "{error}");
    assert_eq!(Recording::open(&truncated).unwrap().end(), None);
}

/// Recordings of older versions open and are explained and compared. They hold what their scenarios give, except where a
/// fault was mended before 1.0.
#[test]
fn recordings_of_older_versions_are_read_and_verified() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/older");
    for (telemetry, difference) in [
        // The ranges of the rates in a nutation were those of the samples.
        (2, Some("/top/nutation")),
        (3, None),
        // A peg in the air had the slow rate of one on the table.
        (4, Some("/top/precession")),
        (5, None),
    ] {
        let path = folder.join(format!("telemetry-{telemetry}.mcap"));
        let recording = Recording::open(&path).unwrap();
        let overview = Overview::new(&recording);
        assert_eq!(overview.condition, Condition::Whole, "{telemetry}");
        assert!(overview.events[0].description.is_some(), "{telemetry}");
        assert!(explain(&recording).is_ok(), "{telemetry}");
        let scenario = recording.scenario().unwrap();
        let compared = compare(&recording, &scenario, &Options::default()).unwrap();
        assert!(compared.is_complete, "{telemetry}");
        let report = verify(&recording, &|_| {}).unwrap();
        let found = report.difference.as_ref().map(|found| found.place.as_str());
        assert_eq!(found, difference, "{telemetry}: {report:#?}");
        if difference.is_none() {
            assert_eq!(report.equality, Some(Equality::SameValues), "{report:#?}");
        }
    }
}
