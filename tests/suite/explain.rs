//! The story of a run.

use crate::damage::chunks;
use crate::support::{Run, archive, scenario};
use assert_cmd::Command;
use proptest::prelude::*;
use std::fs;
use std::ops::Range;
use tempfile::tempdir;
use toprise::analysis::explain::{Chapter, ExplainError, Story, explain};
use toprise::analysis::figures::{FIGURES, Run as Drawn};
use toprise::archive::recording::Recording;
use toprise::archive::writer::Form;
use toprise::run::scenario::PRESETS;
use toprise::telemetry::fields::ACCELERATION;

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
                missing: ACCELERATION
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

/// A recording in pieces: what stands before the chunks, the chunks, and what stands after them.
struct Pieces {
    whole: Vec<u8>,
    chunks: Vec<Range<usize>>,
}

impl Pieces {
    fn of(preset: &str) -> Self {
        let directory = tempdir().unwrap();
        let path = directory.path().join("run.mcap");
        let scenario = scenario(preset, &[("stop.duration", "0.5")]);
        archive(&path, &scenario, &[], Form::default()).unwrap();
        let whole = fs::read(&path).unwrap();
        let chunks = chunks(&whole);
        assert!(chunks.len() > 4);
        Self { whole, chunks }
    }

    /// The recording with other chunks, in any order.
    fn with<'a>(&self, chunks: impl IntoIterator<Item = &'a [u8]>) -> Vec<u8> {
        let end = self.chunks.last().unwrap().end;
        let mut bytes = self.whole[..self.chunks[0].start].to_vec();
        bytes.extend(chunks.into_iter().flatten());
        bytes.extend_from_slice(&self.whole[end..]);
        bytes
    }

    fn chunk(&self, index: usize) -> &[u8] {
        &self.whole[self.chunks[index].clone()]
    }
}

/// Explains and reads for all figures what bytes give, if they can be opened.
fn told_and_drawn(bytes: &[u8]) -> Option<(Result<Story, ExplainError>, Drawn)> {
    let directory = tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    fs::write(&path, bytes).unwrap();
    let recording = Recording::open(&path).ok()?;
    let figures: Vec<_> = FIGURES.iter().collect();
    let drawn = Drawn::read(&recording, "run", &figures, &|_| {});
    for figure in FIGURES
        .iter()
        .filter(|figure| figure.missing(&drawn).is_none())
    {
        let drawing = figure.draw(&[&drawn], 85.0);
        assert!(!drawing.svg().contains("NaN"), "{}", figure.name);
    }
    Some((explain(&recording), drawn))
}

#[test]
fn repeated_and_reordered_chunks_change_neither_story_nor_figures() {
    let run = Pieces::of("full-coulomb");
    let (story, drawn) = told_and_drawn(&run.whole).unwrap();
    let story = story.unwrap();
    assert!(story.losses.is_empty() && drawn.losses.is_empty());
    let last = run.chunks.len() - 1;
    let repeated: Vec<usize> = (0..=last).chain([1, 2, 1]).collect();
    let reversed: Vec<usize> = (0..=last).rev().collect();
    for (order, is_repeated) in [(repeated, true), (reversed, false)] {
        let bytes = run.with(order.iter().map(|index| run.chunk(*index)));
        let (found, found_drawn) = told_and_drawn(&bytes).unwrap();
        let found = found.unwrap();
        assert_eq!(found.chapters, story.chapters, "{order:?}");
        assert_eq!(found.course, story.course, "{order:?}");
        let told = "messages that repeat others or go back in time";
        let is_told = |losses: &[String]| losses.iter().any(|loss| loss.contains(told));
        assert_eq!(is_told(&found.losses), is_repeated, "{:?}", found.losses);
        assert_eq!(
            is_told(&found_drawn.losses),
            is_repeated,
            "{:?}",
            found_drawn.losses
        );
        let mut found_drawn = found_drawn;
        found_drawn.losses.clone_from(&drawn.losses);
        assert!(found_drawn == drawn, "{order:?}");
    }
}

#[test]
fn nothing_in_a_recording_makes_explain_or_figures_panic() {
    let [run, other] = ["full-coulomb", "paper"].map(Pieces::of);
    let (own, foreign) = (run.chunks.len(), other.chunks.len());
    let config = ProptestConfig::with_cases(64);
    let orders = prop::collection::vec(0..own + foreign, 0..10);
    let flips = prop::collection::vec((any::<prop::sample::Index>(), 0_u8..8), 0..3);
    proptest!(config, |(order in orders, flips in flips, length in any::<prop::sample::Index>(), is_cut in any::<bool>())| {
        let chunk = |index: &usize| match index.checked_sub(own) {
            None => run.chunk(*index),
            Some(index) => other.chunk(index),
        };
        let mut bytes = run.with(order.iter().map(chunk));
        for (at, bit) in flips {
            let at = at.index(bytes.len());
            bytes[at] ^= 1 << bit;
        }
        if is_cut {
            bytes.truncate(length.index(bytes.len()));
        }
        let _ = told_and_drawn(&bytes);
    });
}

#[test]
fn what_is_told_follows_from_numbers_that_are_given_too() {
    let story = explain(&scenario("paper", &[("stop.duration", "3.0")])).unwrap();
    let balance = story.precession.as_ref().unwrap();
    let change = balance.gyroscopic + balance.coriolis + balance.frictional;
    assert!(
        change.abs() < 1e-2 * balance.frictional.abs(),
        "{balance:?}"
    );
    assert_eq!(story.stages.len(), 6);
    assert!(story.stages.is_sorted_by(|a, b| a.to <= b.from));
    assert!(story.stages.iter().all(|stage| stage.slow_root.is_some()));
    let json = serde_json::to_value(&story).unwrap();
    assert_eq!(json["stages"][0]["theta"], story.stages[0].theta);
    assert_eq!(json["course"]["stop_time"], 3.0);
    assert!(json["chapters"][0].get("table").is_none());
}
