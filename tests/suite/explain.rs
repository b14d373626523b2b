//! The story of a run.

use crate::support::{Run, archive, scenario};
use assert_cmd::Command;
use std::fs;
use tempfile::tempdir;
use toprise::analysis::explain::{Chapter, ExplainError, Story, explain};
use toprise::archive::recording::Recording;
use toprise::archive::writer::Form;
use toprise::run::scenario::PRESETS;

fn chapter<'s>(story: &'s Story, heading: &str) -> &'s Chapter {
    let found = story
        .chapters
        .iter()
        .find(|chapter| chapter.heading == heading);
    found.unwrap_or_else(|| panic!("no {heading}"))
}

fn text(chapter: &Chapter) -> String {
    chapter.sentences.join(" ")
}

/// A cell of a table as a number.
fn cell(chapter: &Chapter, row: usize, column: &str) -> f64 {
    let (header, rows) = chapter.table.as_ref().unwrap();
    let column = header.iter().position(|name| name == column).unwrap();
    rows[row][column].replace('−', "-").parse().unwrap()
}

#[test]
fn every_preset_has_a_story() {
    for preset in PRESETS {
        let scenario = scenario(preset.name, &[("stop.duration", "3.0")]);
        let story = explain(&scenario).unwrap_or_else(|error| panic!("{}: {error}", preset.name));
        assert!(story.title.starts_with(preset.name));
        for heading in [
            "The top",
            "Why the axis moves",
            "Where the energy goes",
            "What happened",
        ] {
            assert!(!chapter(&story, heading).sentences.is_empty());
        }
        let all: String = story.chapters.iter().map(text).collect();
        assert!(
            !all.contains("NaN") && !all.contains("inf"),
            "{}: {all}",
            preset.name
        );
    }
}

#[test]
fn val_friction_drives_the_rise() {
    let scenario = scenario("paper", &[]);
    let story = explain(&scenario).unwrap();
    assert_eq!(story.title, "paper: the top rises in 24.7194 s");
    let why = chapter(&story, "Why the axis moves");
    let run = Run::of(&scenario);
    // The drift that cancels friction is that of the averaged equation, θ̇ = −K sin θ cos θ ψ̇/(V L_n) to the
    // order of φ̇/ψ̇: the table's mean θ̇ follows it as closely as it is printed, in each part.
    for row in 0..6 {
        let (found, demanded) = (cell(why, row, "θ̇ [rad/s]"), cell(why, row, "θ̇ demanded"));
        assert!(
            (found / demanded - 1.0).abs() < 0.01,
            "{row}: {found} {demanded}"
        );
    }
    // The first part as the cycles of the run have it.
    let cycles: Vec<_> = run
        .cycles
        .iter()
        .take_while(|cycle| cycle.end < 3.95)
        .collect();
    let mean = cycles.iter().map(|cycle| cycle.theta_mean).sum::<f64>() / cycles.len() as f64;
    assert!((cell(why, 0, "θ [rad]") - mean).abs() < 1e-3);
    let precession = text(chapter(&story, "What friction does to the precession"));
    // ∫ K F cos θ/I_x dt, from the samples by the trapezoidal rule.
    let terms: Vec<f64> = run
        .samples
        .iter()
        .map(|s| s.accelerations.frictional.phi)
        .collect();
    let sum = 1e-3 * (terms.iter().sum::<f64>() - 0.5 * (terms[0] + terms[terms.len() - 1]));
    assert!(
        precession.contains(&format!("quickened the precession by {sum:.0} rad/s")),
        "{sum}: {precession}"
    );
}

#[test]
fn dropping_a_term_is_told_from_dropping_a_torque() {
    let story = explain(&scenario("paper-precession-term-only", &[])).unwrap();
    let dropped = text(chapter(&story, "What the model leaves out"));
    assert!(dropped.contains("not dropping a torque"), "{dropped}");
    assert!(dropped.contains("the model pumps it in"), "{dropped}");
    assert!(dropped.contains("24.7309 s"), "{dropped}");
    let story = explain(&scenario("paper", &[])).unwrap();
    let dropped = text(chapter(&story, "What the model leaves out"));
    assert!(dropped.contains("still a torque of a force"), "{dropped}");
    let story = explain(&scenario("full-coulomb", &[("stop.duration", "1")])).unwrap();
    assert!(
        story
            .chapters
            .iter()
            .all(|chapter| chapter.heading != "What the model leaves out")
    );
}

#[test]
fn recordings_and_simulations_have_the_same_story() {
    let directory = tempdir().unwrap();
    let path = directory.path().join("a.mcap");
    let scenario = scenario("paper", &[("stop.duration", "2.0")]);
    archive(&path, &scenario, &[], Form::default()).unwrap();
    let recording = Recording::open(&path).unwrap();
    assert_eq!(explain(&recording).unwrap(), explain(&scenario).unwrap());
    // What is there of one that was cut off.
    let bytes = fs::read(&path).unwrap();
    let cut = directory.path().join("cut.mcap");
    fs::write(&cut, &bytes[..bytes.len() / 2]).unwrap();
    let story = explain(&Recording::open(&cut).unwrap()).unwrap();
    assert!(
        story.title.contains("what is there of the run"),
        "{}",
        story.title
    );
}

#[test]
fn what_can_t_be_explained_says_why() {
    let directory = tempdir().unwrap();
    let path = directory.path().join("a.mcap");
    let scenario = scenario("paper", &[("stop.duration", "0.1")]);
    archive(&path, &scenario, &["/top/state"], Form::default()).unwrap();
    let error = explain(&Recording::open(&path).unwrap()).unwrap_err();
    assert!(
        matches!(
            error,
            ExplainError::Channel {
                missing: "/top/acceleration"
            }
        ),
        "{error}"
    );
    let mut command = Command::cargo_bin("toprise").unwrap();
    let output = command
        .arg("explain")
        .arg(&path)
        .assert()
        .code(2)
        .get_output()
        .clone();
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(
        error.contains("a.mcap") && error.contains("/top/acceleration"),
        "{error}"
    );
    let data =
        std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/foreign/json_a.mcap");
    let error = explain(&Recording::open(&data).unwrap()).unwrap_err();
    assert_eq!(error, ExplainError::Foreign);
}

#[test]
fn the_command_prints_a_page() {
    let mut command = Command::cargo_bin("toprise").unwrap();
    let run = ["explain", "paper", "--set", "stop.duration=1"];
    let output = command
        .args(run)
        .assert()
        .success()
        .get_output()
        .stdout
        .clone();
    let text = String::from_utf8(output).unwrap();
    assert!(text.lines().count() < 60, "{text}");
    assert!(
        text.lines().all(|line| line.chars().count() <= 104),
        "{text}"
    );
    let mut command = Command::cargo_bin("toprise").unwrap();
    let output = command
        .args(run)
        .arg("--markdown")
        .assert()
        .success()
        .get_output()
        .stdout
        .clone();
    assert!(
        String::from_utf8(output)
            .unwrap()
            .contains("## Why the axis moves")
    );
}
