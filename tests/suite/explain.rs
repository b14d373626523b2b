//! The story of a run.

use crate::damage::chunks;
use crate::support::{Run, archive, scenario};
use assert_cmd::Command;
use proptest::prelude::*;
use std::collections::BTreeSet;
use std::fs;
use std::ops::Range;
use tempfile::tempdir;
use toprise::analysis::explain::{Chapter, ExplainError, Story, explain, explain_while};
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
fn a_story_that_nobody_wants_any_more_is_not_told() {
    let asked = std::cell::Cell::new(0);
    let carry_on = || {
        asked.set(asked.get() + 1);
        asked.get() < 100
    };
    // A run of an hour, which takes minutes.
    let scenario = scenario("frictionless", &[("stop.duration", "3600")]);
    let story = explain_while(&scenario, &carry_on);
    assert_eq!(story, Err(ExplainError::Interrupted));
    assert_eq!(asked.get(), 101);
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
    let precession = story.precession.as_ref().unwrap();
    // ∫ K F cos θ/I_x dt, from the samples by the trapezoidal rule, which is good where a nutation has 40 of them.
    let terms: Vec<f64> = run
        .samples
        .iter()
        .map(|s| s.accelerations.frictional.phi)
        .collect();
    let sum = 1e-3 * (terms.iter().sum::<f64>() - 0.5 * (terms[0] + terms[terms.len() - 1]));
    assert!((precession.frictional / sum - 1.0).abs() < 1e-4, "{sum}");
    let told = text(chapter(&story, "What friction does to the precession"));
    let expected = format!(
        "quickened the precession by {:.1} rad/s",
        precession.frictional
    );
    assert!(told.contains(&expected), "{told}");
}

/// The sign of θ̈ at the start follows from where φ̇ is among the rates of regular precession; the simulation has its own.
#[test]
fn val_the_start_lies_where_the_simulation_says() {
    let mut places = BTreeSet::new();
    // A prolate and an oblate top: above the axial moment and below it.
    for transverse_moment in ["3e-4", "1e-4"] {
        for psi_dot in ["-170", "170"] {
            for phi_dot in ["-2000", "-20", "-0.5", "0.5", "20", "2000"] {
                let overrides = [
                    ("top.transverse_moment", transverse_moment),
                    ("top.axial_moment", "1.1e-4"),
                    ("initial.psi_dot", psi_dot),
                    ("initial.phi_dot", phi_dot),
                    ("stop.duration", "0.001"),
                ];
                let scenario = scenario("frictionless", &overrides);
                let story = explain(&scenario).unwrap();
                let told = text(chapter(&story, "Why the axis moves"));
                let theta = Run::of(&scenario).samples[0].euler_accelerations.theta;
                let sign = if theta > 0.0 { "positive" } else { "negative" };
                let found = ["below both", "between them", "above both"]
                    .into_iter()
                    .find(|place| told.contains(&format!(", {place}: θ̈ was {sign}.")));
                let place = found.unwrap_or_else(|| panic!("{overrides:?}: {told}"));
                places.insert((transverse_moment, place));
            }
        }
    }
    assert_eq!(places.len(), 6, "{places:?}");
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
    assert!(text.lines().count() < 70, "{text}");
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
    let terms = [
        balance.gyroscopic.unwrap(),
        balance.coriolis.unwrap(),
        balance.frictional,
    ];
    let change = balance.last - balance.first;
    assert!(
        (terms.iter().sum::<f64>() - change).abs() < 1e-8,
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

/// What a story has to say, and what not.
struct Expected {
    preset: &'static str,
    overrides: &'static [(&'static str, &'static str)],
    told: &'static [&'static str],
    not_told: &'static [&'static str],
}

#[test]
fn what_is_told_is_what_happened() {
    let cases = [
        // Sums over samples alias its nutation of up to 317 Hz; φ̇ in the last sample less that in the first is recorded.
        Expected {
            preset: "paper-precession-term-only",
            overrides: &[],
            told: &["φ̇ changed by −0.326 rad/s, from 1.750 to 1.424 rad/s"],
            not_told: &["1.11 rad/s"],
        },
        Expected {
            preset: "paper",
            overrides: &[("initial.psi_dot", "20"), ("initial.phi_dot", "0")],
            told: &[
                "the top falls",
                "had fallen, at θ = 1.571 rad",
                "completed no nutation",
            ],
            not_told: &["neither rose nor sank", "averaged over nutations"],
        },
        Expected {
            preset: "paper",
            overrides: &[("initial.psi_dot", "0"), ("initial.phi_dot", "0")],
            told: &["the top falls", "had fallen"],
            not_told: &["neither rose nor sank", "slowed", "quickened"],
        },
        // Partial cycles are no means.
        Expected {
            preset: "frictionless",
            overrides: &[("initial.theta", "2.5"), ("stop.duration", "3")],
            told: &["neither rises nor sinks", "stayed at 2.49999 rad"],
            not_told: &["the axis sank:", "the axis rose:"],
        },
        Expected {
            preset: "paper",
            overrides: &[("stop.duration", "0.1")],
            told: &[
                "the axis rose: θ, averaged over nutations, fell from 0.499642 to 0.498925 rad",
            ],
            not_told: &["sank:"],
        },
        Expected {
            preset: "paper",
            overrides: &[("initial.psi_dot", "-170"), ("stop.duration", "5")],
            told: &["quickened the precession"],
            not_told: &["slowed the precession"],
        },
        Expected {
            preset: "rise-by-loss-of-spin",
            overrides: &[],
            told: &["kept to the fast rate", "the axis rose"],
            not_told: &["kept to the slow rate", "and the axis sinks"],
        },
        Expected {
            preset: "paper",
            overrides: &[("initial.phi_dot", "1103"), ("stop.duration", "2")],
            told: &["kept to the fast rate", "the axis sank"],
            not_told: &["the axis rose", "axis rises;"],
        },
        Expected {
            preset: "paper",
            overrides: &[
                ("formulation", "body"),
                ("stop.theta_risen", ""),
                ("stop.duration", "35"),
            ],
            told: &["rises, comes near upright and sinks", "From 26.0715 s to"],
            not_told: &["slept", "in the last"],
        },
        Expected {
            preset: "lifecycle",
            overrides: &[],
            told: &["the top rises, sleeps, weakens and falls"],
            not_told: &["the axis sank:", "45.1 %"],
        },
        Expected {
            preset: "paper-spin-term-only",
            overrides: &[("stop.duration", "5")],
            told: &["Nothing of friction is in the equation of the precession"],
            not_told: &["slowed the precession", "e-18"],
        },
        Expected {
            preset: "frictionless",
            overrides: &[("initial.phi_dot", "0"), ("stop.duration", "1")],
            told: &["neither rose nor sank"],
            not_told: &["loops"],
        },
        Expected {
            preset: "full-coulomb",
            overrides: &[
                ("formulation", "body"),
                ("stop.on_stick", "continue"),
                ("stop.theta_risen", ""),
                ("stop.theta_fallen", ""),
                ("initial.psi_dot", "0"),
                ("initial.phi_dot", "5"),
                ("initial.theta", "2.9"),
                ("stop.duration", "5"),
            ],
            told: &[
                "sinks and sticks",
                "the contact point stuck, and the top turned as a whole",
            ],
            not_told: &["−2.576"],
        },
    ];
    for Expected {
        preset,
        overrides,
        told,
        not_told,
    } in cases
    {
        let story = explain(&scenario(preset, overrides)).unwrap();
        let all: String = story.chapters.iter().map(|c| text(c) + " ").collect();
        let all = format!("{} {all}", story.title);
        for sentence in told {
            assert!(
                all.contains(sentence),
                "{preset} {overrides:?}: no {sentence}: {all}"
            );
        }
        for sentence in not_told {
            assert!(
                !all.contains(sentence),
                "{preset} {overrides:?}: {sentence}: {all}"
            );
        }
    }
}

#[test]
fn the_integrals_survive_a_missing_chunk() {
    let run = Pieces::of("full-coulomb");
    let (story, _) = told_and_drawn(&run.whole).unwrap();
    let whole = story.unwrap().precession.unwrap();
    let kept = (0..run.chunks.len()).filter(|index| *index != 2);
    let (story, _) = told_and_drawn(&run.with(kept.map(|index| run.chunk(index)))).unwrap();
    let story = story.unwrap();
    assert_eq!(story.precession.as_ref(), Some(&whole));
    // The hole is no motion without nutation.
    assert!(story.stages.iter().all(|stage| stage.nutations > 0));
}

#[test]
fn channels_that_are_missing_are_named() {
    let directory = tempdir().unwrap();
    let path = directory.path().join("a.mcap");
    let scenario = scenario("paper", &[("stop.duration", "0.5")]);
    let topics = ["/top/state", "/top/acceleration", "/top/energy", "/events"];
    archive(&path, &scenario, &topics, Form::default()).unwrap();
    let story = explain(&Recording::open(&path).unwrap()).unwrap();
    let told = text(chapter(&story, "What can't be told"));
    for topic in ["/top/momentum", "/top/nutation", "/top/contact"] {
        assert!(told.contains(topic), "{told}");
    }
}

#[test]
fn recordings_of_0_1_0_are_told_drawn_and_compared() {
    let directory = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/0.1.0");
    for (name, sentences) in [
        (
            "paper",
            ["quickened the precession by 409", "together added"],
        ),
        (
            "full-coulomb",
            ["quickened the precession by 41", "kept to the slow rate"],
        ),
        (
            "paper-spin-term-only",
            ["weakens and falls", "had become too weak"],
        ),
    ] {
        let path = directory.join(name).with_extension("mcap");
        let bytes = fs::read(&path).unwrap();
        let (story, _) = told_and_drawn(&bytes).unwrap();
        let story = story.unwrap();
        let all: String = story.chapters.iter().map(|c| text(c) + " ").collect();
        let all = format!("{} {all}", story.title);
        for sentence in sentences {
            assert!(all.contains(sentence), "{name}: no {sentence}: {all}");
        }
        assert!(!all.contains("NaN"), "{name}: {all}");
    }
    let [old, new] = ["tests/data/0.1.0", "recordings/reference"].map(|directory| {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(directory);
        Recording::open(&root.join("frictionless.mcap")).unwrap()
    });
    let options = toprise::analysis::diff::Options::default();
    let report = toprise::analysis::diff::compare(&old, &new, &options);
    assert!(report.is_ok(), "{report:?}");
}
