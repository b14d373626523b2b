//! Statements that hold for the whole run, or are not made.

use super::facts;
use crate::support::{Folder, Run, archive, scenario};
use std::f64::consts::FRAC_PI_2;
use std::fs;
use toprise::analysis::explain::{Explanation, Fact, explain};
use toprise::archive::recording::Recording;
use toprise::archive::writer::Form;
use toprise::run::outcome;

/// Keys of a scenario that differ from those of a preset.
type Keys<'a> = &'a [(&'a str, &'a str)];

fn explanation(preset: &str, keys: Keys<'_>) -> Explanation {
    explain(&scenario(preset, keys)).unwrap()
}

fn sentences(explanation: &Explanation) -> Vec<String> {
    facts(explanation)
        .map(|fact| fact.sentence().to_string())
        .collect()
}

/// The last nutation ends long before these runs, and the top goes on to fall, rise or invert.
#[test]
fn val_end_of_the_run_is_not_the_last_nutation() {
    let falls: Keys<'_> = &[
        ("friction.k", "0.95"),
        ("initial.psi_dot", "-129.5"),
        ("initial.phi_dot", "7"),
        ("initial.theta", "0.614"),
        ("stop.duration", "2"),
    ];
    let creeps: Keys<'_> = &[
        ("friction.k", "0.59"),
        ("initial.psi_dot", "62"),
        ("initial.theta", "0.8"),
        ("stop.duration", "4"),
    ];
    let inverts: Keys<'_> = &[("initial.psi_dot", "78.3"), ("stop.duration", "200")];
    let cases = [
        ("falls", "full-coulomb", falls),
        ("creeps", "free-viscous", creeps),
        ("inverts", "tippe-top", inverts),
        ("has no nutation", "drop", &[("stop.duration", "0.01")]),
    ];
    for (name, preset, keys) in cases {
        let last = *Run::with(preset, keys).samples.last().unwrap();
        let explanation = explanation(preset, keys);
        let ends: Vec<f64> = facts(&explanation)
            .filter_map(|fact| match fact {
                Fact::End { theta, .. } => Some(*theta),
                _ => None,
            })
            .collect();
        assert_eq!(ends, [last.angles.theta], "{name}");
    }
    // Where the last nutation is at the end, its mean inclination is enough.
    let has_end = |preset: &str| {
        facts(&explanation(preset, &[])).any(|fact| matches!(fact, Fact::End { .. }))
    };
    assert!(!has_end("paper") && !has_end("frictionless") && !has_end("free-paper"));
}

/// A tippe top that swings past the horizontal and comes back has not inverted.
#[test]
fn val_swing_past_the_horizontal_is_not_an_inversion() {
    let keys = [
        ("initial.theta_dot", "60"),
        ("initial.psi_dot", "1"),
        ("stop.duration", "3"),
    ];
    let run = Run::with("tippe-top", &keys);
    let (beyond, before) = (FRAC_PI_2 + 0.1, 0.1);
    assert!(run.samples.iter().any(|s| s.angles.theta > beyond));
    assert!(run.samples.last().unwrap().angles.theta < before);
    let explanation = explanation("tippe-top", &keys);
    let passes: Vec<&Fact> = facts(&explanation)
        .filter(|fact| {
            matches!(
                fact,
                Fact::Inverted { .. } | Fact::NotInverted { .. } | Fact::PassesHorizontal { .. }
            )
        })
        .collect();
    assert!(
        matches!(passes[..], [Fact::PassesHorizontal { .. }]),
        "{passes:?}"
    );
    let outcome = outcome(&scenario("tippe-top", &keys), || true).unwrap();
    assert!(!outcome.sentence().contains("inverted"));
}

/// The causes that act are named: friction at the contact, air drag, impacts.
#[test]
fn names_the_causes_of_work() {
    let no_contact: Keys<'_> = &[
        ("friction.k", "0"),
        ("air.axial", "1e-6"),
        ("stop.duration", "1"),
    ];
    for (preset, keys, works) in [
        ("paper", &[("stop.duration", "1")] as Keys<'_>, "friction"),
        ("paper", no_contact, "air drag"),
        ("rise-by-loss-of-spin", &[], "friction and air drag"),
        ("drop", &[], "friction and impacts"),
        (
            "drop",
            &[("air.axial", "1e-6")],
            "friction, air drag and impacts",
        ),
    ] {
        let sentences = sentences(&explanation(preset, keys));
        let start = format!("The work of {works} equals this change");
        let found = sentences.iter().any(|s| s.starts_with(&start));
        assert!(found, "{works}: {sentences:#?}");
    }
}

/// Without sliding friction, nothing of it is omitted.
#[test]
fn frictionless_model_omits_no_friction() {
    for (k, is_omitted) in [("0", false), ("0.03", true)] {
        let keys = [
            ("friction.k", k),
            ("air.axial", "1e-6"),
            ("stop.duration", "1"),
        ];
        let explanation = explanation("paper", &keys);
        let found = facts(&explanation).any(|fact| matches!(fact, Fact::ModelPart { .. }));
        assert_eq!(found, is_omitted, "k = {k}");
    }
}

#[test]
fn energy_change_is_rounded_to_its_error() {
    for (change, within, text) in [
        (0.25, 1e-15, "0.2500 J"),
        (2.7e-15, 2e-15, "3 × 10⁻¹⁵ J"),
        (2.512e-13, 2e-15, "2.51 × 10⁻¹³ J"),
        (0.25, 0.0, "0.2500 J"),
    ] {
        let fact = Fact::Energy {
            first: 0.0,
            last: -change,
            time: 1.0,
            within,
        };
        let sentence = fact.sentence().to_string();
        let expected = format!("energy decreased by {text}.");
        assert!(sentence.ends_with(&expected), "{sentence}");
    }
}

/// Without weight there is hardly any friction: the change of energy is less than the error of the balance.
#[test]
fn energy_change_below_its_error_is_constant() {
    for preset in ["paper", "full-coulomb", "viscous"] {
        let keys = [("gravity", "1e-12"), ("stop.duration", "2")];
        let explanation = explanation(preset, &keys);
        let is_constant = |fact: &Fact| matches!(fact, Fact::EnergyConstant { .. });
        assert!(facts(&explanation).any(is_constant), "{preset}");
    }
}

/// A recording of a free peg whose middle can't be read.
fn with_a_hole(folder: &Folder) -> Recording {
    let path = folder.at("hole.mcap");
    archive(&path, &scenario("free-paper", &[]), &[], Form::default()).unwrap();
    let mut bytes = fs::read(&path).unwrap();
    // While the peg hops, so that events and nutations are lost.
    let place = bytes.len() / 3;
    bytes[place..place + 64].fill(0);
    fs::write(&path, &bytes).unwrap();
    Recording::open(&path).unwrap()
}

#[test]
fn counts_nothing_in_a_recording_with_a_hole() {
    let folder = Folder::new();
    let explanation = explain(&with_a_hole(&folder)).unwrap();
    assert!(!explanation.losses.is_empty());
    assert!(explanation.events.is_empty() && explanation.stages.is_empty());
    let peg = explanation.summary.peg.unwrap();
    assert_eq!(explanation.summary.nutations, None);
    assert_eq!(
        (peg.hops, peg.impacts, peg.time_rolling),
        (None, None, None)
    );
}

/// Whether the peg rolls to the end is known only if the recording has one.
#[test]
fn incomplete_runs_do_not_roll_to_the_end() {
    let folder = Folder::new();
    let path = folder.at("run.mcap");
    let scenario = scenario("drop", &[]);
    archive(&path, &scenario, &[], Form::default()).unwrap();
    let bytes = fs::read(&path).unwrap();
    fs::write(folder.at("cut.mcap"), &bytes[..bytes.len() * 9 / 10]).unwrap();
    for (name, is_known) in [("run.mcap", true), ("cut.mcap", false)] {
        let explanation = explain(&Recording::open(&folder.at(name)).unwrap()).unwrap();
        let found = facts(&explanation).any(|fact| matches!(fact, Fact::Rolls { .. }));
        assert_eq!(found, is_known, "{name}: {:#?}", sentences(&explanation));
        let peg = explanation.summary.peg.unwrap();
        assert!(peg.first_roll.is_some(), "{name}");
        assert_eq!(peg.rolls_to_end_from.is_some(), is_known, "{name}");
    }
}

/// That the peg starts in the air follows from the scenario, where no event or sample shows it.
#[test]
fn start_in_the_air_follows_from_the_scenario() {
    let folder = Folder::new();
    let drop = scenario(
        "drop",
        &[("initial.height", "0.5"), ("stop.duration", "0.3")],
    );
    let topics = ["/top/state", "/top/acceleration", "/top/energy", "/events"];
    archive(&folder.at("drop.mcap"), &drop, &topics, Form::default()).unwrap();
    let explanation = explain(&Recording::open(&folder.at("drop.mcap")).unwrap()).unwrap();
    let peg = explanation.summary.peg.unwrap();
    assert_eq!((peg.hops, peg.time_in_air), (Some(1), Some(0.3)));
}

/// Impacts are within the flights that are counted: no count of flights may seem to deny them.
#[test]
fn flights_with_bounces_are_named_so() {
    for (preset, keys) in [("drop", &[][..]), ("free-paper", &[])] {
        let sentences = sentences(&explanation(preset, keys));
        let flights = sentences
            .iter()
            .find(|sentence| sentence.contains("flight"));
        let flights = flights.unwrap_or_else(|| panic!("{preset}: {sentences:#?}"));
        assert!(
            flights.ends_with("(bounces do not end a flight)."),
            "{flights}"
        );
        assert!(
            sentences
                .iter()
                .any(|s| s.starts_with("The peg hit the table"))
        );
    }
}

#[test]
fn reports_friction_that_creates_energy() {
    for (preset, creates) in [
        ("paper-precession-term-only", true),
        ("paper", false),
        ("frictionless", false),
    ] {
        let sentences = sentences(&explanation(preset, &[]));
        let is_named = sentences.iter().any(|s| s.contains("creates energy"));
        assert_eq!(is_named, creates, "{preset}: {sentences:#?}");
    }
}

#[test]
fn frictionless_run_has_no_friction_term() {
    let explanation = explanation("frictionless", &[]);
    let chapter = &explanation.chapters[1];
    assert_eq!(chapter.heading, "How the axis moves");
    assert!(
        !chapter.facts.contains(&Fact::NoFrictionOnPrecession),
        "{chapter:?}"
    );
    let sentences = sentences(&explanation);
    assert!(
        !sentences.iter().any(|s| s.contains("friction term")),
        "{sentences:#?}"
    );
}

/// A text that calls the energy constant names no size, which would depend on its zero.
#[test]
fn constant_energy_is_stated_with_its_error() {
    let sentences = sentences(&explanation("frictionless", &[]));
    let constant = sentences
        .iter()
        .find(|s| s.starts_with("Energy was constant"));
    assert!(
        constant
            .unwrap()
            .starts_with("Energy was constant in all samples (±")
    );
}

/// The angular momentum of a top that spins the other way is negative, and so less than any limit.
#[test]
fn weak_top_has_little_angular_momentum() {
    for [spin, precession] in [["170", "1.75"], ["-170", "-1.75"]] {
        let keys = [("initial.psi_dot", spin), ("initial.phi_dot", precession)];
        let sentences = sentences(&explanation("lifecycle", &keys));
        let limit = sentences
            .iter()
            .find(|s| s.starts_with("The top is weak where"));
        let limit = limit.unwrap_or_else(|| panic!("{sentences:#?}"));
        assert!(limit.contains("its size is less than"), "{limit}");
    }
}

#[test]
fn story_is_in_the_order_of_time() {
    for (preset, parts) in [
        (
            "lifecycle",
            &[
                "Until ",
                "the top rose because friction and air drag together turned",
                "At ",
                "the top fell because friction and air drag together had slowed the spin",
            ][..],
        ),
        ("paper", &["The top rose because", "In the paper's terms"]),
        (
            "paper-precession-term-only",
            &["In the paper's terms, the friction term of φ̈"],
        ),
    ] {
        let text = explanation(preset, &[]).story.text().unwrap();
        let mut rest = text.as_str();
        for part in parts {
            let (_, after) = rest
                .split_once(part)
                .unwrap_or_else(|| panic!("{preset}: {part:?} is not in its place: {text}"));
            rest = after;
        }
    }
}
