//! Integrator steps of random tops with free pegs and all losses.

use crate::random_scenarios::{Random, count, free_tops};
use std::cell::Cell;
use std::rc::Rc;
use toprise::run::scenario::{Scenario, Values};
use toprise::run::simulation::run_without_samples;

/// More steps per second of motion are too many.
const MAX_STEPS: f64 = 1e5;

/// The motion that each top is given, s.
const DURATION: f64 = 2.0;

/// The scenario with drilling, which stops the spin, unless the law of sliding drills itself.
fn drilling(scenario: &Scenario, random: u64) -> Scenario {
    let with = |drills: bool| {
        let mut values = Values::from_toml(&scenario.to_toml()).unwrap();
        values.set_value("stop.duration", DURATION).unwrap();
        if drills && values.get("drilling.k").is_none() {
            values
                .set_value("drilling.k", 0.02 + 0.04 * (random % 8) as f64)
                .unwrap();
            values.set_value("drilling.patch_radius", 2e-4).unwrap();
        }
        Scenario::new(values)
    };
    with(true).or_else(|_| with(false)).unwrap()
}

/// Those of `tops` random tops that fail or take too many steps, each with what happened.
fn costly(seed: u64, tops: usize) -> Vec<String> {
    let mut found = Vec::new();
    for (number, scenario) in (0_u64..).zip(free_tops(Random(seed)).take(tops)) {
        let scenario = drilling(&scenario, number);
        let steps = Rc::new(Cell::new(0.0));
        let counted = Rc::clone(&steps);
        let outcome = run_without_samples(&scenario, move || {
            counted.set(counted.get() + 1.0);
            counted.get() <= MAX_STEPS * DURATION
        });
        let failure = match outcome {
            Err(error) => error.to_string(),
            Ok((end, _)) if steps.get() > MAX_STEPS * DURATION => {
                format!("{} steps took it to {} s", steps.get(), end.time)
            }
            Ok(_) => continue,
        };
        found.push(format!("{number}: {failure}\n{}", scenario.to_toml()));
    }
    found
}

#[test]
fn random_free_tops_finish() {
    let costly = costly(7, 60);
    assert!(costly.is_empty(), "{}", costly.join("\n"));
}

/// Contact points that begin to slip, or come to rest where friction and drilling are one law, may take more: a few in a
/// thousand tops.
#[test]
#[ignore = "takes minutes"]
fn many_random_free_tops_finish() {
    let tops = count().unwrap_or(2000);
    let costly = costly(8, tops);
    println!(
        "of {tops} tops too costly: {}\n{}",
        costly.len(),
        costly.join("\n")
    );
    assert!(500 * costly.len() <= tops, "{}", costly.join("\n"));
}

/// Stalled after a million steps once.
#[test]
fn regress_top_whose_spin_stops_finishes() {
    let keys = [
        ("top.mass", "0.71"),
        ("top.center_distance", "0.008"),
        ("top.transverse_moment", "5.2e-05"),
        ("top.axial_moment", "1.2e-05"),
        ("initial.theta", "1.5"),
        ("initial.phi_dot", "-7"),
        ("friction.k", ""),
        ("initial.height", "0.043"),
        ("initial.peg_z_dot", "0.36"),
        ("friction.viscous_speed", ""),
        ("friction.dissipation", ""),
        ("friction.law", "none"),
        ("drilling.k", "0.24"),
        ("drilling.patch_radius", "0.00022"),
        ("stop.theta_fallen", ""),
        ("stop.duration", "4"),
    ];
    let scenario = crate::support::scenario("free-viscous", &keys);
    let (end, _) = run_without_samples(&scenario, || true).unwrap();
    assert_eq!(end.time, 4.0);
    assert!((end.statistics.accepted as f64) < MAX_STEPS * end.time);
}
