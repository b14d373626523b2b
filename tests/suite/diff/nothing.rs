//! Differences of nothing: runs of the same physics have no findings, however they are integrated and sampled.

use super::*;
use crate::random_scenarios::{count, ordinary_held_tops};
use toprise::run::outcome;
use toprise::run::simulation::StopReason;

/// The scenario, integrated and sampled in another way; `None` if that is impossible.
fn varied(scenario: &Scenario, random: &mut Random) -> Option<Scenario> {
    let tolerance = [1e-9, 1e-10, 1e-11, 1e-12, 3e-13][random.below(5)];
    let period = [0.001, 0.002, 0.004][random.below(3)];
    let formulation = ["euler", "body"][random.below(2)];
    let changes = [
        ("integrator.relative_tolerance", tolerance.into()),
        ("integrator.absolute_tolerance", tolerance.into()),
        ("sampling.period", period.into()),
    ];
    let varied = scenario.with(changes).ok()?;
    let other = varied.with([("formulation", formulation.into())]);
    // A free peg has one formulation only.
    Some(other.unwrap_or(varied))
}

/// Whether a run can be integrated in either formulation, in a reasonable number of steps.
fn is_regular(scenario: &Scenario) -> bool {
    const MAX_STEPS: u32 = 300_000;
    let mut steps = 0;
    let outcome = outcome(scenario, || {
        steps += 1;
        steps <= MAX_STEPS
    });
    // In Euler angles a run ends where they are singular, in the other formulation it does not.
    let are_irregular = [
        StopReason::Singular,
        StopReason::Interrupted,
        StopReason::Failed,
    ];
    outcome.is_ok_and(|outcome| !are_irregular.contains(&outcome.end.stop))
}

/// The findings about differences of two runs of the same physics.
fn differences_of_nothing(scenario: &Scenario, random: &mut Random) -> Option<Vec<String>> {
    let (a, b) = (varied(scenario, random)?, varied(scenario, random)?);
    if !is_regular(&a) || !is_regular(&b) {
        return None;
    }
    let mut found = Vec::new();
    for (x, y) in [(&a, &b), (&b, &a)] {
        let report = compare(x, y, &Options::default()).unwrap();
        for finding in report.findings.iter().filter(|finding| finding.differs()) {
            found.push(format!("{finding:?}"));
        }
    }
    if !found.is_empty() {
        found.push(format!("{}\n--- B:\n{}", a.to_toml(), b.to_toml()));
    }
    Some(found)
}

#[track_caller]
fn assert_nothing(scenarios: impl Iterator<Item = Scenario>, seed: u64, count: usize) {
    let mut random = Random(seed);
    let mut all = Vec::new();
    let mut tried = 0;
    for scenario in scenarios {
        if tried == count {
            break;
        }
        if let Some(found) = differences_of_nothing(&scenario, &mut random) {
            tried += 1;
            all.extend(found);
        }
    }
    println!("tried {count}, {} findings", all.len());
    assert!(all.is_empty(), "{}", all.join("\n"));
}

#[test]
fn equal_physics_has_no_findings() {
    assert_nothing(ordinary_held_tops(Random(31)), 1, 12);
    assert_nothing(free_tops(Random(32)), 2, 8);
}

#[test]
#[ignore = "takes minutes"]
fn many_tops_of_equal_physics_have_no_findings() {
    let count = count().unwrap_or(200);
    assert_nothing(ordinary_held_tops(Random(33)), 3, count);
    assert_nothing(free_tops(Random(34)), 4, count);
}

/// Events, ends and inversions have errors like everything else.
#[test]
fn events_of_equal_physics_have_no_findings() {
    for (name, changes) in [
        (
            "full-coulomb",
            [
                ("integrator.relative_tolerance", "1e-9"),
                ("stop.duration", "30"),
            ],
        ),
        (
            "full-coulomb",
            [
                ("integrator.relative_tolerance", "1e-10"),
                ("stop.duration", "30"),
            ],
        ),
        (
            "full-coulomb",
            [("formulation", "body"), ("stop.duration", "30")],
        ),
        (
            "tippe-top",
            [
                ("integrator.relative_tolerance", "1e-9"),
                ("stop.duration", "8"),
            ],
        ),
        (
            "lifecycle",
            [
                ("integrator.relative_tolerance", "1e-9"),
                ("stop.duration", "40"),
            ],
        ),
    ] {
        let a = scenario(name, &changes[1..]);
        let b = scenario(name, &changes);
        let report = compare(&a, &b, &Options::default()).unwrap();
        let found: Vec<_> = report.findings.iter().filter(|f| f.differs()).collect();
        assert!(found.is_empty(), "{name} {changes:?}: {found:?}");
        // They are compared, and their errors are not without bounds.
        let end = finding(&report, "ends").unwrap();
        assert!(end.integration_error.unwrap() < 1e-5, "{end:?}");
    }
}

/// Also tolerances that can't be tightened have an error.
#[test]
fn estimates_the_error_of_any_tolerance() {
    let run = |tolerance| {
        scenario(
            "full-coulomb",
            &[
                ("integrator.relative_tolerance", tolerance),
                ("stop.duration", "1"),
            ],
        )
    };
    for tolerance in ["1e-14", "1.5e-14", "3e-13", "7e-12", "1e-2"] {
        let report = compare(&run(tolerance), &run("1e-12"), &Options::default()).unwrap();
        let errors = report
            .integration_errors
            .unwrap_or_else(|| panic!("{tolerance}: no error"));
        let found = &errors
            .a
            .fields
            .iter()
            .find(|(name, _)| name == "/top/state.theta");
        assert!(found.unwrap().1 > 0.0, "{tolerance}");
        let found: Vec<_> = report.findings.iter().filter(|f| f.differs()).collect();
        assert!(found.is_empty(), "{tolerance}: {found:?}");
    }
}

/// Presets with events: ends, inversions, loops, sticking, rolling.
#[test]
#[ignore = "takes minutes"]
fn presets_of_equal_physics_have_no_findings() {
    let mut random = Random(5);
    let mut all = Vec::new();
    for name in [
        "paper",
        "paper-precession-term-only",
        "paper-spin-term-only",
        "full-coulomb",
        "nutation-free",
        "tilt-torque-only",
        "spin-torque-only",
        "rise-by-loss-of-spin",
        "viscous",
        "stribeck",
        "contensou",
        "lifecycle",
        "free-paper",
        "free-rolls",
        "free-viscous",
        "drop",
        "tippe-top",
        "tippe-top-hangs",
    ] {
        let short = scenario(name, &[]).with([("stop.duration", 40.0.into())]);
        let found = differences_of_nothing(&short.unwrap(), &mut random);
        println!("{name}: {found:?}");
        all.extend(found.into_iter().flatten());
    }
    assert!(all.is_empty(), "{}", all.join("\n"));
}
