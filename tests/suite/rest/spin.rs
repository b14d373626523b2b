//! Spin ends by friction about the vertical alone, and no energy is lost without work.

use super::scenarios_near_rest;
use crate::random_scenarios::Random;
use crate::support::{Run, assert_near};
use std::f64::consts::PI;
use toprise::run::outcome::outcome;
use toprise::run::simulation::StopReason;

/// A contact patch that rolling resistance keeps from rocking drills with the constant torque `(3π/16) k a N`.
#[test]
fn val_held_contensou_patch_spins_down_by_drilling_alone() {
    let torque = 3.0 * PI / 16.0 * 0.3 * 0.002 * 0.110 * 9.81;
    for formulation in ["euler", "body"] {
        let run = Run::with(
            "full-coulomb",
            &[
                ("formulation", formulation),
                ("friction.law", "contensou"),
                ("friction.k", "0.3"),
                ("friction.patch_radius", "0.002"),
                ("rolling.arm", "0.005"),
                ("initial.theta", "0.0001"),
                ("initial.phi_dot", "0"),
                ("initial.psi_dot", "-18.488"),
                ("stop.on_stick", "continue"),
                ("stop.theta_risen", ""),
                ("stop.duration", "5"),
            ],
        );
        // The moment of inertia about the vertical is within θ² = 1e-8 of I_z, and so is the rate. While the top still
        // rocks, for 30 µs, the torque is smaller.
        let stops = 7.25e-5 * 18.488 / torque;
        assert_eq!(run.end.stop, StopReason::Rest, "{formulation}");
        assert_near("t", run.end.time, stops, 3e-5 + 1e-8 * stops);
        for time in [1.0, 2.5] {
            let rate = run.at(time).tilt.omega_lean.norm();
            let expected = 18.488 - torque / 7.25e-5 * time;
            assert_near(
                formulation,
                rate,
                expected,
                1e-8 * 18.488 + 3e-5 * torque / 7.25e-5,
            );
        }
    }
}

/// `E₁ = E₀ + W` wherever a run ends, also at rest.
///
/// A step and the state at the end of a phase err by at most ten tolerances of 1e-12 in each component. A component of
/// the state changes the energy by at most a rate (below 50 rad/s for these tops) per unit. The errors are added as if
/// they had one sign.
#[test]
fn energy_changes_by_the_work_of_friction_only() {
    let mut random = Random(4);
    for (number, scenario) in (1..=60).zip(scenarios_near_rest(&mut random)) {
        let mut steps = 0;
        let result = outcome(&scenario, || {
            steps += 1;
            steps <= 3000
        });
        let found = result.unwrap();
        let end = &found.end;
        let unexplained = end.energy - end.energy_at_start - end.motion.integrals.friction_work;
        let allowed = 10.0 * 1e-12 * 50.0 * f64::from(steps);
        assert!(
            unexplained.abs() <= allowed,
            "{number}: {unexplained:e} J > {allowed:e} J\n{}",
            scenario.to_toml()
        );
    }
}

/// The torques on a fixed peg are proportional to the mass, so the motion doesn't depend on it.
#[test]
fn motion_with_a_fixed_peg_is_independent_of_mass() {
    let times = [1e-9, 1e-6, 1e-3, 0.11, 1e3].map(|mass: f64| {
        let scaled = |moment: f64| (moment / 0.11 * mass).to_string();
        let run = Run::with(
            "full-coulomb",
            &[
                ("formulation", "body"),
                ("top.mass", &mass.to_string()),
                ("top.transverse_moment", &scaled(8.52e-5)),
                ("top.axial_moment", &scaled(7.25e-5)),
                ("friction.k", "1"),
                ("rolling.arm", "0.02"),
                ("drilling.k", "0.3"),
                ("drilling.patch_radius", "0.002"),
                ("initial.theta", "0.855"),
                ("initial.phi_dot", "-0.612"),
                ("initial.theta_dot", "4.297"),
                ("initial.psi_dot", "0"),
                ("stop.theta_risen", ""),
                ("stop.duration", "1"),
            ],
        );
        let events = run.events.iter();
        (mass, events.map(|e| (e.kind, e.time)).collect::<Vec<_>>())
    });
    let (_, expected) = &times[3];
    for (mass, found) in &times {
        assert_eq!(found.len(), expected.len(), "{mass} kg");
        for ((kind, time), (expected_kind, expected_time)) in found.iter().zip(expected) {
            assert_eq!(kind, expected_kind, "{mass} kg");
            // Units of momentum differ by up to √2 from those of the same relative size.
            assert_near(
                &format!("{kind:?}"),
                *time,
                *expected_time,
                1e-9 * expected_time,
            );
        }
    }
}
