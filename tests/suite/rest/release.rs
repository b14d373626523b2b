//! Contacts that friction holds for a while and then releases.

use super::{Comparisons, MAX_STEPS};
use crate::random_scenarios::{Random, count};
use crate::support::{Run, assert_near, scenario};
use std::collections::BTreeMap;
use toprise::physics::friction::FrictionLaw;
use toprise::run::outcome::outcome;
use toprise::run::scenario::{Preset, Scenario, Values};
use toprise::run::simulation::{EventKind, StopReason};

/// Keys with which a motion ends only at its duration.
const ENDLESS: [(&str, &str); 3] = [
    ("stop.theta_risen", ""),
    ("stop.theta_fallen", ""),
    ("stop.on_stick", "continue"),
];

/// A hanging top that turns about the vertical while friction holds its contact point. Drilling slows it down until its
/// weight is no longer carried around, and the contact point slips.
const CAROUSEL: [(&str, &str); 5] = [
    ("initial.theta", "2.2"),
    ("initial.phi_dot", "20"),
    ("initial.psi_dot", "0"),
    ("friction.k", "1.848"),
    ("stop.duration", "2"),
];

#[test]
fn formulations_agree_after_a_release() {
    let drilling = [("drilling.k", "0.5"), ("drilling.patch_radius", "2e-3")];
    let rolling = [("rolling.arm", "1e-3")];
    let air = [("air.axial", "1e-4")];
    for (name, losses) in [
        ("drilling", &drilling[..]),
        (
            "drilling and rolling resistance",
            &[drilling[0], drilling[1], rolling[0]],
        ),
        ("air and rolling resistance", &[air[0], rolling[0]]),
    ] {
        let [euler, body] = ["euler", "body"].map(|formulation| {
            let mut keys = [&ENDLESS[..], &CAROUSEL, losses].concat();
            keys.push(("formulation", formulation));
            let found = outcome(&scenario("full-coulomb", &keys), || true).unwrap();
            assert_eq!(found.end.stop, StopReason::Duration, "{name} {formulation}");
            assert!(found.tally.count_of(EventKind::SlipResumes) > 0, "{name}");
            let steps = found.end.statistics.accepted as f64;
            assert!(steps <= MAX_STEPS * 2.0, "{name} {formulation}: {steps}");
            found
        });
        assert_eq!(
            euler.tally.count_of(EventKind::SlipResumes),
            body.tally.count_of(EventKind::SlipResumes),
            "{name}"
        );
        // The absolute tolerance, 1e-12, is that of the momentum in kg m²/s in one of them, 1e-8 rad/s: a step moves the
        // axis by up to 1e-8 rad in a second. There are up to a thousand independent ones before a release.
        let [a, b] = [euler.end.motion, body.end.motion];
        assert_near(name, a.angles.theta, b.angles.theta, 1e-8 * 32.0 * 2.0);
    }
}

#[test]
fn released_contact_patches_move_on() {
    let mut released = 0;
    // Each runs until after the first release.
    for (theta, psi_dot, patch_radius, duration) in [
        ("0.3", "5", "1e-3", "1.4"),
        ("0.3", "5", "3e-3", "0.7"),
        ("0.3", "20", "1e-3", "3.8"),
        ("0.3", "20", "3e-3", "1.4"),
        ("0.1", "5", "1e-3", "1.4"),
        ("0.1", "5", "3e-3", "0.5"),
        ("0.1", "20", "1e-3", "3.8"),
        ("0.1", "20", "3e-3", "1.5"),
    ] {
        let mut keys = ENDLESS.to_vec();
        keys.extend([
            ("initial.theta", theta),
            ("initial.phi_dot", "0"),
            ("initial.psi_dot", psi_dot),
            ("initial.peg_x_dot", "0.1"),
            ("friction.law", "contensou"),
            ("friction.k", "1"),
            ("friction.patch_radius", patch_radius),
            ("stop.duration", duration),
        ]);
        let name = format!("{theta} {psi_dot} {patch_radius}");
        let found = outcome(&scenario("free-paper", &keys), || true).unwrap();
        assert_eq!(found.end.stop, StopReason::Duration, "{name}");
        released += found.tally.count_of(EventKind::RollEnds);
        // Friction never adds energy.
        assert!(found.end.energy < found.end.energy_at_start, "{name}");
        let change = found.end.energy - found.end.energy_at_start;
        assert_near(
            &name,
            change,
            found.end.motion.integrals.friction_work,
            1e-10,
        );
    }
    assert!(released > 0);
}

/// A random top whose contact point is at rest at first, or soon, under friction that may hold it for a while.
fn scenario_of_a_release(random: &mut Random) -> Option<Scenario> {
    let is_free = random.below(2) == 0;
    let preset = if is_free {
        "free-paper"
    } else {
        "full-coulomb"
    };
    let mut values = Preset::find(preset).unwrap().values().unwrap();
    for (key, value) in ENDLESS {
        values.set(key, value).unwrap();
    }
    values.set("sampling.period", "0.1").unwrap();
    let numbers = if is_free {
        set_rolling(random, &mut values)
    } else {
        set_carousel(random, &mut values)
    };
    for (key, value) in numbers {
        values.set_value(key, value).unwrap();
    }
    Scenario::new(values).ok()
}

/// A top with a fixed peg that turns about the vertical, held, until losses slow it down.
fn set_carousel(random: &mut Random, values: &mut Values) -> Vec<(&'static str, f64)> {
    let formulation = ["euler", "body"][random.below(2)];
    values.set("formulation", formulation).unwrap();
    let mut numbers = vec![
        ("initial.theta", 1.8 + random.unit()),
        ("initial.phi_dot", 10.0 + 20.0 * random.unit()),
        ("initial.psi_dot", 0.0),
        ("friction.k", 0.5 + 2.0 * random.unit()),
        ("drilling.k", 0.1 + random.unit()),
        ("drilling.patch_radius", 2e-3),
        ("stop.duration", 0.6),
    ];
    if random.below(2) == 0 {
        numbers.push(("rolling.arm", 5e-3 * random.unit()));
    }
    numbers
}

/// A top with a free peg that rolls or rests as a whole, and rocks.
fn set_rolling(random: &mut Random, values: &mut Values) -> Vec<(&'static str, f64)> {
    let mut numbers = vec![
        ("initial.theta", 0.1 + 0.5 * random.unit()),
        ("initial.phi_dot", 0.0),
        ("initial.psi_dot", 8.0 * random.symmetric()),
        ("friction.k", 0.4 + 0.9 * random.unit()),
        ("stop.duration", 0.5),
    ];
    if random.below(4) > 0 {
        values.set("friction.law", "contensou").unwrap();
        numbers.push(("friction.patch_radius", 1e-3 + 3e-3 * random.unit()));
    } else {
        numbers.push(("drilling.k", 0.5 * random.unit()));
        numbers.push(("drilling.patch_radius", 1e-3));
    }
    numbers
}

/// Compares random motions with a release to the regularised model; returns those that are wrong.
fn find_wrong_releases(seed: u64, wanted: usize) -> Vec<String> {
    let mut random = Random(seed);
    let mut comparisons = Comparisons::default();
    let mut kinds = BTreeMap::new();
    let mut number = 0;
    while number < wanted {
        let Some(scenario) = scenario_of_a_release(&mut random) else {
            continue;
        };
        let limit = MAX_STEPS * scenario.stop.duration.unwrap();
        let mut steps = 0.0;
        let found = outcome(&scenario, || {
            steps += 1.0;
            steps <= limit
        });
        let is_released = found.is_err()
            || found.is_ok_and(|found| {
                let releases = [EventKind::SlipResumes, EventKind::RollEnds];
                releases.iter().any(|kind| found.tally.count_of(*kind) > 0)
            });
        if !is_released {
            continue;
        }
        number += 1;
        let is_patch = matches!(scenario.model.friction.law, FrictionLaw::Contensou { .. });
        *kinds
            .entry((scenario.model.support.is_free(), is_patch))
            .or_insert(0) += 1;
        comparisons.compare(number, &scenario);
    }
    println!("{wanted} releases, by (free, patch) {kinds:?}: {comparisons}");
    let Comparisons { agree, slow, .. } = comparisons;
    // Steps are short while slip is slow: in proportion to the time that a load takes to exceed its bound by some factor.
    assert!(5 * slow <= wanted, "{slow} of {wanted} are slow");
    assert!(2 * agree > wanted, "{agree} of {wanted} agree");
    comparisons.wrong
}

#[test]
fn val_random_releases_agree_with_regularised_friction() {
    let wrong = find_wrong_releases(11, 10);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
#[ignore = "takes minutes"]
fn val_many_random_releases_agree_with_regularised_friction() {
    let wrong = find_wrong_releases(12, count().unwrap_or(300));
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Took 102,000 steps a second once: the load of rolling resistance exceeds its bound by little at first.
#[test]
fn slowly_overloaded_rolling_resistance_takes_few_steps() {
    let mut keys = ENDLESS.to_vec();
    keys.extend([
        ("initial.theta", "0.07620288173424761"),
        ("initial.phi_dot", "14.384035466779084"),
        ("initial.psi_dot", "0"),
        ("friction.law", "viscous"),
        ("friction.k", "0.9203528931682238"),
        ("friction.viscous_speed", "0.5"),
        ("rolling.arm", "0.0014569723203383758"),
        ("stop.duration", "0.3"),
    ]);
    let found = outcome(&scenario("free-paper", &keys), || true).unwrap();
    let steps = found.end.statistics.accepted;
    assert!(steps < 5000, "{steps} steps");
    // With the law from 1e-9 rad/s on, in 30,778 steps, whose errors of up to 1e-12 add up to this at most.
    let [omega_y, tolerance] = [2.7778610137509245, 30_778.0 * 1e-12];
    assert_near(
        "ω_y",
        found.end.motion.tilt.omega_lean.y,
        omega_y,
        tolerance,
    );
}

/// Took 104,000 steps a second once: friction resisted the direction of the slip from 1e-9 m/s on.
#[test]
fn rolling_top_gives_way_in_few_steps() {
    let mut keys = ENDLESS.to_vec();
    keys.extend([
        ("initial.theta", "0.9107119979039868"),
        ("initial.phi_dot", "-18.799806779706252"),
        ("initial.psi_dot", "0"),
        ("friction.k", "1.0081285348968305"),
        ("rolling.arm", "9.138121385183824e-5"),
        ("stop.duration", "0.3"),
    ]);
    let found = outcome(&scenario("free-paper", &keys), || true).unwrap();
    assert_eq!(found.tally.count_of(EventKind::RollEnds), 2);
    let steps = found.end.statistics.accepted;
    assert!(steps < 10_000, "{steps} steps");
    // With the law from 1e-9 m/s on, in 31,206 steps, whose errors of up to 1e-12 add up to this at most.
    let [theta, tolerance] = [1.0513240268843684, 31_206.0 * 1e-12];
    assert_near("θ", found.end.motion.angles.theta, theta, tolerance);
}

/// A top that is dropped upright does not move any more.
#[test]
fn landing_at_rest_is_not_rolling() {
    let mut keys = ENDLESS.to_vec();
    keys.extend([
        ("initial.theta", "0"),
        ("initial.phi_dot", "0"),
        ("initial.psi_dot", "0"),
        ("initial.height", "1e-3"),
        ("support.restitution", "0"),
        ("friction.k", "0.3"),
        ("rolling.arm", "1e-4"),
        ("stop.duration", "1"),
    ]);
    let run = Run::with("free-paper", &keys);
    let events: Vec<_> = run.events.iter().map(|event| event.kind.name()).collect();
    assert_eq!(events, ["start", "landing", "rest"]);
    assert_eq!(run.impacts.len(), 1);
    assert_eq!(run.end.stop, StopReason::Rest);
    // Free fall from rest.
    let fall = (2.0 * 1e-3 / 9.81_f64).sqrt();
    assert_near("t", run.end.time, fall, 1e-12);
}
