//! Reversals of the precession: real loops, and cusps, where φ̇ only touches zero.

use crate::support::{Run, scenario};
use toprise::run::outcome;
use toprise::run::simulation::EventKind;

/// A tolerance of the integrator, as both keys.
fn tolerances(tolerance: &str) -> [(&str, &str); 2] {
    [
        ("integrator.relative_tolerance", tolerance),
        ("integrator.absolute_tolerance", tolerance),
    ]
}

/// Number of loops of a run without samples.
fn loops(preset: &str, keys: &[(&str, &str)]) -> u64 {
    let outcome = outcome(&scenario(preset, keys), || true).unwrap();
    outcome.tally.count_of(EventKind::LoopingBegins)
}

/// A top released with φ̇ = 0 and θ̇ = 0 returns to this state in each nutation: its path has cusps. The integration
/// error turns about half of them into loops, at any tolerance.
#[test]
fn cusps_are_no_loops() {
    for formulation in ["euler", "body"] {
        for psi_dot in ["60", "170", "-500", "3000"] {
            for tolerance in ["1e-14", "1e-12", "1e-9", "1e-6", "1e-4", "1e-2"] {
                let keys = [
                    ("initial.phi_dot", "0"),
                    ("initial.theta_dot", "0"),
                    ("initial.psi_dot", psi_dot),
                    ("formulation", formulation),
                    ("stop.duration", "3"),
                ];
                let keys = [&keys[..], &tolerances(tolerance)].concat();
                let loops = loops("frictionless", &keys);
                assert_eq!(loops, 0, "{formulation}, {psi_dot} rad/s, {tolerance}");
            }
        }
    }
}

/// The error of the cusps grows with the steps, and so does its bound.
#[test]
fn cusps_of_a_long_run_are_no_loops() {
    for formulation in ["euler", "body"] {
        let keys = [
            ("initial.phi_dot", "0"),
            ("formulation", formulation),
            ("stop.duration", "200"),
        ];
        let keys = [&keys[..], &tolerances("1e-6")].concat();
        assert_eq!(loops("frictionless", &keys), 0, "{formulation}");
    }
}

/// In the air the angular momentum is constant. If it points along the axis, the axis does not precess.
#[test]
fn axis_at_rest_in_the_air_makes_no_loops() {
    let keys = [
        ("initial.phi_dot", "0"),
        ("initial.height", "0.5"),
        ("stop.duration", "0.3"),
    ];
    for tolerance in ["1e-14", "1e-12", "1e-9"] {
        let keys = [&keys[..], &tolerances(tolerance)].concat();
        assert_eq!(loops("drop", &keys), 0, "{tolerance}");
    }
}

/// Released with a small backward precession, a top makes a small loop in each nutation; at 1e-12 the integration error
/// is less than a hundredth of the smallest.
#[test]
fn val_small_loops_are_counted() {
    for formulation in ["euler", "body"] {
        for phi_dot in ["-1e-3", "-1e-4", "-1e-5"] {
            let keys = [
                ("initial.phi_dot", phi_dot),
                ("initial.theta_dot", "0"),
                ("formulation", formulation),
                ("stop.duration", "2"),
            ];
            let run = Run::with("frictionless", &keys);
            // It starts in the middle of a loop, which has no beginning. Loops surround the minima of θ.
            let minima = run.events_of(EventKind::NutationMinimum).count();
            let loops = run.times_of(EventKind::LoopingBegins);
            assert!(minima > 40, "{minima}");
            let ends = run.times_of(EventKind::LoopingEnds);
            assert!(ends[0] > loops[0], "{formulation}, {phi_dot}");
            let difference = minima.abs_diff(loops.len());
            assert!(difference <= 1, "{formulation}, {phi_dot}: {loops:?}");
        }
    }
}
