//! Where the axis is exactly vertical.

use crate::support::{Run, scenario};
use std::f64::consts::PI;
use toprise::run::scenario::Scenario;
use toprise::run::simulation::Sample;

/// Time between the samples, s.
const PERIOD: f64 = 1e-4;

/// What depends on the directions that φ and ψ have.
fn numbers(sample: &Sample) -> Vec<f64> {
    let Sample { angles, tilt, .. } = sample;
    let mut numbers = vec![angles.phi, angles.theta, angles.psi];
    numbers.extend([tilt.rates.phi, tilt.rates.theta, tilt.rates.psi]);
    for vector in [
        sample.pose.axis,
        sample.pose.omega_world,
        sample.pose.omega_body,
        sample.slip.world,
        sample.slip.body,
        sample.slip.friction_force,
        sample.momentum.world,
    ] {
        numbers.extend(vector.iter());
    }
    numbers
}

/// The first sample is the limit of those that follow: it lies on the line through the next two, up to the second difference
/// there, which is that of the next samples and changes as it does between them. Angles and rates are rounded, and err by the
/// tolerances (1e-12), over the sine of the first inclination.
fn assert_continuous(scenario: &Scenario, what: &str) {
    let run = Run::of(scenario);
    let samples: Vec<_> = run.samples.iter().take(5).map(numbers).collect();
    let sine = run.samples[1].tilt.sin;
    for (i, first) in samples[0].iter().enumerate() {
        let [a, b, c, d] = [1, 2, 3, 4].map(|at| samples[at][i]);
        let (bend, next) = (a - 2.0 * b + c, b - 2.0 * c + d);
        let slack = bend.abs() + 2.0 * (next - bend).abs() + 1e-11 * (1.0 + a.abs()) / sine;
        let gap = (first - (2.0 * a - b)).abs();
        assert!(
            gap <= slack,
            "{what}: number {i} is {first}, then {a}, {b}, {c}"
        );
    }
}

#[test]
fn rates_at_vertical_starts_are_continuous() {
    for preset in [
        "frictionless",
        "paper",
        "full-coulomb",
        "viscous",
        "contensou",
        "free-paper",
        "free-viscous",
        "tippe-top",
    ] {
        let is_free = preset.contains("free-") || preset == "tippe-top";
        for (theta, phi, theta_dot, phi_dot) in [
            (0.0, "0", "1", "1.75"),
            (0.0, "0.3", "-1", "0"),
            (0.0, "-2", "30", "-60"),
            (PI, "0.3", "1", "1.75"),
            (PI, "2", "-3", "0"),
            (0.0, "-2", "0", "5"),
            (PI, "1", "0", "5"),
        ] {
            let theta = format!("{theta:?}");
            let period = format!("{PERIOD:?}");
            let mut keys = vec![
                ("formulation", "body"),
                ("initial.theta", theta.as_str()),
                ("initial.phi", phi),
                ("initial.theta_dot", theta_dot),
                ("initial.phi_dot", phi_dot),
                ("sampling.period", &period),
                ("stop.duration", "0.0005"),
                ("stop.theta_risen", ""),
                ("stop.theta_fallen", ""),
            ];
            if is_free {
                keys.push(("initial.peg_x_dot", "0.3"));
                keys.push(("initial.peg_y_dot", "-0.2"));
                keys.push(("initial.center_x_dot", ""));
                keys.push(("initial.center_y_dot", ""));
            }
            let what = format!("{preset} {theta} {phi} {theta_dot} {phi_dot}");
            assert_continuous(&scenario(preset, &keys), &what);
        }
    }
}
