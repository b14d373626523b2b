//! What is done with an input: shared by the fuzz targets and by the test that runs the corpus, so that
//! neither can drift from the other.

use std::fs;
use std::path::Path;
use toprise::analysis::diff::{self, Report, Verdict};
use toprise::analysis::explain::explain;
use toprise::analysis::figures::{FIGURES, Figure, Run};
use toprise::analysis::verify::{Options, verify};
use toprise::archive::convert::convert;
use toprise::archive::publish::Existing;
use toprise::archive::recording::{Condition, Overview, Recording, Selection};
use toprise::archive::recover::recover;
use toprise::archive::writer::Archived;
use toprise::run::scenario::{Scenario, Values};
use toprise::telemetry::encoding::Encoding;
use toprise::telemetry::fields::state;

/// Reads `data` as a recording in every way there is. Files are written to the directory `scratch`.
///
/// # Panics
/// If what is written in turn can't be read, or anything else is wrong.
pub fn recording(data: &[u8], scratch: &Path) {
    let path = scratch.join("input.mcap");
    fs::write(&path, data).expect("the input is written");
    let recording = match Recording::open(&path) {
        Ok(recording) => recording,
        Err(error) => {
            told(&error.to_string());
            return;
        }
    };
    let overview = Overview::of(&recording);
    for loss in &overview.losses {
        told(&loss.to_string());
    }
    let rates = overview.channels.iter().filter_map(|c| c.rate());
    told(&format!("{overview:?} {:?}", rates.collect::<Vec<_>>()));
    let mut reader = recording.reader(Selection::default());
    while let Some(message) = reader.next_of_any() {
        if let Err(error) = message {
            told(&error.to_string());
        }
        reader.progress();
    }
    match recording.series(state::THETA) {
        Ok(series) => assert_eq!(series.times_ns.len(), series.values.len()),
        Err(error) => told(&error.to_string()),
    }
    let report = verify(&recording, Options { reproduce: false }, &|_| {});
    told(&format!("{report:?}"));
    let output = scratch.join("output.mcap");
    let write = |encoding: Option<Encoding>| match encoding {
        None => {
            let recovered = recover(&recording, &output, Existing::Replace, &|_| {});
            recovered.map(|r| r.archived).map_err(|e| e.to_string())
        }
        Some(encoding) => {
            let converted = convert(&recording, &output, Existing::Replace, encoding, &|_| {});
            converted.map_err(|e| e.to_string())
        }
    };
    for encoding in [None, Some(Encoding::Json), Some(Encoding::Protobuf)] {
        match write(encoding) {
            Ok(archived) => check_written(&archived),
            Err(error) => told(&error),
        }
        let _ = fs::remove_file(&output);
    }
}

/// Asks everything of `recording` that can be asked of runs.
///
/// # Panics
/// If the recording differs from itself, or anything else is wrong.
pub fn analyses(recording: &Recording) {
    match explain(recording) {
        Ok(story) => told(&format!("{story:?}")),
        Err(error) => told(&error.to_string()),
    }
    let all: Vec<&Figure> = FIGURES.iter().collect();
    let run = Run::read(recording, "a", &all, &|_| {});
    for figure in all.iter().filter(|figure| figure.missing(&run).is_none()) {
        let runs = vec![&run; figure.least_runs];
        told(&figure.draw(&runs, 85.0).svg());
    }
    if let Some(report) = difference(recording, recording) {
        assert_ne!(report.verdict, Verdict::Different, "{report:?}");
    }
}

/// Compares two recordings, without simulating them again.
fn difference(a: &Recording, b: &Recording) -> Option<Report> {
    let options = diff::Options {
        floor: false,
        ..diff::Options::default()
    };
    let report = diff::compare(a, b, &options);
    report.map_err(|error| told(&error.to_string())).ok()
}

/// What is saved or converted is a recording without faults, whatever it was made from.
fn check_written(archived: &Archived) {
    let written = Recording::open(&archived.path).expect("what was written can be opened");
    let overview = Overview::of(&written);
    assert!(
        matches!(overview.condition, Condition::Whole | Condition::Recovered),
        "what was written is {:?}: {:?}",
        overview.condition,
        overview.losses
    );
    let noted = overview
        .end
        .as_ref()
        .and_then(|end| end.get("content_digest"));
    assert_eq!(noted, Some(&archived.digest));
}

/// Reads `data` as a scenario, whole and in pieces.
///
/// # Panics
/// If a scenario doesn't survive being written, or anything else is wrong.
pub fn scenario(data: &[u8]) {
    let Ok(text) = str::from_utf8(data) else {
        return;
    };
    match Scenario::from_toml(text) {
        Ok(scenario) => check_scenario(&scenario),
        Err(error) => told(&error.to_string()),
    }
    let mut values = Values::from_toml(text).unwrap_or_default();
    let mut section = String::new();
    for line in text.lines() {
        if let Some(name) = line.strip_prefix('[') {
            section = format!("{}.", name.trim_end_matches(']'));
            continue;
        }
        let (name, value) = line.split_once('=').unwrap_or(("description", line));
        let path = format!("{section}{}", name.trim());
        for path in [path.as_str(), name.trim()] {
            if let Err(error) = values.set(path, value.trim()) {
                told(&error.to_string());
            }
        }
    }
    for path in ["name", "description", "gravity"] {
        if let Err(error) = values.set(path, text) {
            told(&error.to_string());
        }
    }
    match Scenario::new(values) {
        Ok(scenario) => check_scenario(&scenario),
        Err(error) => told(&error.to_string()),
    }
}

fn check_scenario(scenario: &Scenario) {
    let text = scenario.to_toml();
    let again = Scenario::from_toml(&text).expect("what was written is a scenario");
    assert_eq!(again, *scenario);
    assert_eq!(again.digest(), scenario.digest());
    assert_eq!(again.to_toml(), text);
    assert!(scenario.slip_speed_at_start() >= 0.0 || scenario.slip_speed_at_start().is_nan());
}

/// Errors and findings are for people: their texts are made, too.
fn told(text: &str) {
    std::hint::black_box(text);
}
