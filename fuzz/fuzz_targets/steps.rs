//! Processing of an input, shared by the fuzz targets and by the test that runs the corpus, so that
//! neither can drift from the other.

use std::fs;
use std::path::Path;
use toprise::analysis::diff::{self, Report, Verdict};
use toprise::analysis::explain::explain;
use toprise::archive::input::Input;
use toprise::archive::recording::{Overview, Recording, Selection};
use toprise::archive::verify::verify;
use toprise::figures::{FIGURES, Figure, RunData};
use toprise::run::scenario::{Scenario, Values};

/// Reads `data` as a recording in every way there is. It is written into the directory `scratch`.
///
/// # Panics
/// If anything is wrong with what is read.
pub fn recording(data: &[u8], scratch: &Path) {
    let path = scratch.join("input.mcap");
    fs::write(&path, data).expect("the input is written");
    let recording = match Recording::open(&path) {
        Ok(recording) => recording,
        Err(error) => {
            consume(&error.to_string());
            return;
        }
    };
    let overview = Overview::new(&recording);
    for loss in &overview.losses {
        consume(&loss.to_string());
    }
    consume(&format!("{overview:?}"));
    let mut reader = recording.reader(Selection::default());
    while let Some(message) = reader.next() {
        if let Err(error) = message {
            consume(&error.to_string());
        }
        reader.progress();
    }
    match verify(&recording, &|_| {}) {
        Ok(report) => consume(&format!("{report:?}")),
        Err(error) => consume(&error.to_string()),
    }
    match Input::open(&path) {
        Ok(input) => consume(&format!("{:?} {:?}", input.values(), input.form())),
        Err(error) => consume(&error.to_string()),
    }
}

/// Asks everything of `recording` that can be asked of runs.
///
/// # Panics
/// If the recording differs from itself, or anything else is wrong.
pub fn analyses(recording: &Recording) {
    match explain(recording) {
        Ok(story) => consume(&format!("{story:?}")),
        Err(error) => consume(&error.to_string()),
    }
    let all: Vec<&Figure> = FIGURES.iter().collect();
    let run = RunData::read(recording, "a", &all, &|_| {});
    for figure in all.iter().filter(|figure| figure.missing(&run).is_none()) {
        let runs = vec![&run; figure.min_runs];
        consume(&figure.draw(&runs, 85.0).svg());
    }
    if let Some(report) = difference(recording, recording) {
        assert_ne!(report.verdict, Verdict::Different, "{report:?}");
    }
}

/// Compares two recordings, without simulating them again.
fn difference(a: &Recording, b: &Recording) -> Option<Report> {
    let options = diff::Options {
        integration_error: false,
        ..diff::Options::default()
    };
    let report = diff::compare(a, b, &options);
    report.map_err(|error| consume(&error.to_string())).ok()
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
        Err(error) => consume(&error.to_string()),
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
                consume(&error.to_string());
            }
        }
    }
    for path in ["name", "description", "gravity"] {
        if let Err(error) = values.set(path, text) {
            consume(&error.to_string());
        }
    }
    match Scenario::new(values) {
        Ok(scenario) => check_scenario(&scenario),
        Err(error) => consume(&error.to_string()),
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
fn consume(text: &str) {
    std::hint::black_box(text);
}
