//! The stories of many kinds of runs, sentence by sentence. Each has been read against the numbers of its run: who changes
//! one reads it again.

use crate::support::scenario;
use std::thread;
use toprise::analysis::explain::{Story, explain};

/// The name of a story, its preset, and keys that are set otherwise.
type StoryOf = (
    &'static str,
    &'static str,
    &'static [(&'static str, &'static str)],
);

const RUNS: &[StoryOf] = &[
    ("paper", "paper", &[]),
    ("precession-term-only", "paper-precession-term-only", &[]),
    ("spin-term-only", "paper-spin-term-only", &[]),
    ("full-coulomb", "full-coulomb", &[]),
    ("frictionless", "frictionless", &[]),
    ("nutation-free", "nutation-free", &[]),
    ("tilt-torque-only", "tilt-torque-only", &[]),
    ("spin-torque-only", "spin-torque-only", &[]),
    ("rise-by-loss-of-spin", "rise-by-loss-of-spin", &[]),
    ("viscous", "viscous", &[]),
    ("stribeck", "stribeck", &[]),
    ("contensou", "contensou", &[]),
    ("lifecycle", "lifecycle", &[]),
    (
        "mirrored",
        "paper",
        &[("initial.psi_dot", "-170"), ("initial.phi_dot", "-1.75")],
    ),
    ("negative-spin", "paper", &[("initial.psi_dot", "-170")]),
    (
        "no-spin",
        "paper",
        &[("initial.psi_dot", "0"), ("initial.phi_dot", "0")],
    ),
    (
        "slow-spin",
        "paper",
        &[("initial.psi_dot", "20"), ("initial.phi_dot", "0")],
    ),
    (
        "oblate",
        "full-coulomb",
        &[
            ("top.transverse_moment", "1e-4"),
            ("top.axial_moment", "1.1e-4"),
        ],
    ),
    (
        "equal-moments",
        "full-coulomb",
        &[
            ("top.transverse_moment", "1e-4"),
            ("top.axial_moment", "1e-4"),
            ("stop.duration", "3"),
        ],
    ),
    (
        "fast-root",
        "paper",
        &[("initial.phi_dot", "1103"), ("stop.duration", "5")],
    ),
    (
        "hanging-without-friction",
        "frictionless",
        &[("initial.theta", "2.5"), ("stop.duration", "3")],
    ),
    ("short", "paper", &[("stop.duration", "0.1")]),
    (
        "shorter-than-a-nutation",
        "paper",
        &[("stop.duration", "0.02")],
    ),
    (
        "through-upright",
        "paper",
        &[
            ("formulation", "body"),
            ("stop.theta_risen", ""),
            ("stop.duration", "40"),
        ],
    ),
    (
        "to-where-slip-stops",
        "full-coulomb",
        &[
            ("formulation", "body"),
            ("stop.theta_risen", ""),
            ("stop.duration", "30"),
        ],
    ),
    (
        "cusps",
        "frictionless",
        &[("initial.phi_dot", "0"), ("stop.duration", "3")],
    ),
    (
        "other-sampling",
        "paper",
        &[("sampling.period", "0.0007"), ("stop.duration", "5")],
    ),
    ("coarse-sampling", "paper", &[("sampling.period", "0.05")]),
    (
        "near-hanging",
        "full-coulomb",
        &[
            ("initial.theta", "3.1"),
            ("stop.theta_fallen", ""),
            ("stop.duration", "5"),
        ],
    ),
    (
        "falls-without-turning",
        "full-coulomb",
        &[
            ("formulation", "body"),
            ("stop.on_stick", "continue"),
            ("stop.theta_risen", ""),
            ("initial.psi_dot", "0"),
            ("initial.phi_dot", "0"),
            ("initial.theta", "0.02"),
            ("stop.duration", "3"),
        ],
    ),
    (
        "sticks",
        "full-coulomb",
        &[
            ("formulation", "body"),
            ("stop.on_stick", "continue"),
            ("stop.theta_risen", ""),
            ("stop.theta_fallen", ""),
            ("initial.psi_dot", "0"),
            ("initial.phi_dot", "5"),
            ("initial.theta", "2.9"),
            ("stop.duration", "5"),
        ],
    ),
    (
        "looping",
        "paper",
        &[("initial.phi_dot", "-5"), ("stop.duration", "3")],
    ),
    (
        "starts-upright",
        "full-coulomb",
        &[
            ("formulation", "body"),
            ("initial.theta", "0.001"),
            ("stop.theta_risen", ""),
            ("stop.duration", "3"),
        ],
    ),
    ("free-paper", "free-paper", &[]),
    ("free-rolls", "free-rolls", &[]),
    ("free-viscous", "free-viscous", &[]),
    ("drop", "drop", &[]),
    ("tippe-top", "tippe-top", &[]),
    ("tippe-top-hangs", "tippe-top-hangs", &[]),
    (
        "bounces-elastically",
        "drop",
        &[("support.restitution", "1"), ("stop.duration", "0.5")],
    ),
    (
        "free-without-friction",
        "free-paper",
        &[("friction.k", "0"), ("stop.duration", "2")],
    ),
    (
        "free-without-spin",
        "free-paper",
        &[
            ("initial.psi_dot", "0"),
            ("initial.phi_dot", "0"),
            ("stop.duration", "2"),
        ],
    ),
    (
        "free-with-hardly-any-friction",
        "free-paper",
        &[("friction.k", "0.0005"), ("stop.duration", "5")],
    ),
    (
        "free-with-much-friction",
        "free-paper",
        &[
            ("friction.k", "0.3"),
            ("support.restitution", "0.5"),
            ("stop.duration", "2"),
        ],
    ),
    (
        "free-mirrored",
        "free-paper",
        &[
            ("initial.psi_dot", "-170"),
            ("initial.phi_dot", "-1.75"),
            ("stop.duration", "8"),
        ],
    ),
    (
        "free-and-short",
        "free-paper",
        &[("stop.duration", "0.015")],
    ),
    (
        "tippe-top-with-little-friction",
        "tippe-top",
        &[("friction.k", "0.001"), ("stop.duration", "3")],
    ),
    (
        "free-with-rolling-resistance",
        "free-paper",
        &[
            ("friction.k", "0.1"),
            ("rolling.arm", "2.1e-4"),
            ("stop.duration", "12"),
        ],
    ),
    (
        "free-regularised",
        "free-paper",
        &[
            ("friction.law", "coulomb-sqrt"),
            ("friction.smoothing_speed", "0.007"),
            ("stop.duration", "8"),
        ],
    ),
    (
        "loose-tolerances",
        "frictionless",
        &[
            ("integrator.relative_tolerance", "1e-6"),
            ("integrator.absolute_tolerance", "1e-6"),
            ("stop.duration", "10"),
        ],
    ),
];

/// A story as text, a sentence a line.
fn text(story: &Story) -> String {
    let mut text = format!("{}\n", story.title);
    for chapter in &story.chapters {
        text.push_str(&format!("\n## {}\n", chapter.heading));
        for sentence in &chapter.sentences {
            text.push_str(&format!("{sentence}\n"));
        }
        if let Some((header, rows)) = &chapter.table {
            for row in std::iter::once(header).chain(rows) {
                text.push_str(&format!("{}\n", row.join(" | ")));
            }
        }
    }
    text
}

#[test]
fn regress_stories() {
    let tell = |(name, preset, overrides): &(&'static str, &str, &[(&str, &str)])| {
        let story = explain(&scenario(preset, overrides));
        (
            *name,
            text(&story.unwrap_or_else(|error| panic!("{name}: {error}"))),
        )
    };
    // Told side by side, for some take seconds; compared one after the other.
    let (first, second) = RUNS.split_at(25);
    let stories = thread::scope(|scope| {
        let first = scope.spawn(|| first.iter().map(tell).collect::<Vec<_>>());
        let second: Vec<_> = second.iter().map(tell).collect();
        [first.join().unwrap(), second].concat()
    });
    for (name, story) in stories {
        insta::assert_snapshot!(name, story);
    }
}
