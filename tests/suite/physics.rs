//! `val_*`: laws and closed forms of the top.

use crate::support::{Run, assert_near, scenario};
use nalgebra::Vector3;
use std::f64::consts::{PI, TAU};
use toprise::physics::kinematics::{Euler, Tilt};
use toprise::run::scenario::Scenario;
use toprise::run::simulation::{EventKind, Sample, StopReason};

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |largest, value| largest.max(value.abs()))
}

/// L = 0.011 kg m²/s, to the integrator's tolerance of 1e-12 per step over some 10,000 steps.
const MOMENTUM_DRIFT: f64 = 1e-14;

#[test]
fn val_angular_momentum_about_the_vertical_is_constant() {
    for preset in ["paper", "full-coulomb", "frictionless"] {
        for formulation in ["euler", "body"] {
            let run = Run::with(preset, &[("formulation", formulation)]);
            let start = run.samples[0].momentum.vertical;
            let drift = largest(run.samples.iter().map(|s| s.momentum.vertical - start));
            assert!(drift < MOMENTUM_DRIFT, "{preset} {formulation}: {drift:e}");
        }
    }
}

#[test]
fn val_without_friction_energy_and_momenta_are_constant() {
    for formulation in ["euler", "body"] {
        let run = Run::with("frictionless", &[("formulation", formulation)]);
        let first = &run.samples[0];
        let change = |s: &Sample| s.energy.total() - first.energy.total();
        let energy = largest(run.samples.iter().map(change));
        let change = |s: &Sample| s.momentum.axial - first.momentum.axial;
        let axial = largest(run.samples.iter().map(change));
        assert!(energy < 1e-12, "{energy:e}");
        assert!(axial < MOMENTUM_DRIFT, "{axial:e}");
        assert_eq!(run.end.stop, StopReason::Duration);
    }
}

#[test]
fn val_energy_changes_by_the_work_of_friction() {
    for preset in [
        "paper",
        "full-coulomb",
        "paper-spin-term-only",
        "paper-precession-term-only",
    ] {
        for formulation in ["euler", "body"] {
            let keys = [("formulation", formulation), ("sampling.period", "0.01")];
            let run = Run::with(preset, &keys);
            let start = run.samples[0].energy.total();
            let scale = run.end.energy.abs().max(start);
            for sample in &run.samples {
                let gap = sample.energy.total() - start - sample.integrals.friction_work;
                assert!(gap.abs() < 2e-12 * scale, "{preset} {formulation}: {gap:e}");
                // dE/dt = τ·ω, as logged.
                let power = sample.torque.friction.body.dot(&sample.pose.omega_body);
                let (logged, bound) = (sample.energy.friction_power, 1e-12 * (1.0 + power.abs()));
                assert_near("power", power, logged, bound);
            }
        }
    }
}

#[test]
fn val_energy_lost_is_weight_times_path_under_full_friction() {
    let run = Run::with("full-coulomb", &[]);
    let lost = run.end.energy_at_start - run.end.energy;
    let path = run.end.motion.integrals.slip_path;
    assert_near("loss", lost, 0.03 * 0.110 * 9.81 * path, 1e-12);
}

/// The paper's friction factor K F = k M g R ψ̇/√(θ̇² + ψ̇² sin² θ), N m.
fn k_f(sample: &Sample) -> f64 {
    let Tilt { sin, rates, .. } = sample.tilt;
    let v = (rates.theta * rates.theta + rates.psi * rates.psi * sin * sin).sqrt();
    0.03 * 0.110 * 9.81 * 0.007 * rates.psi / v
}

#[test]
fn val_ablations_change_momenta_by_their_equations() {
    // The rates of L_z′ and L_n that follow from dropping a term, from the logged torques.
    let (ix, iz) = (8.52e-5, 7.25e-5);
    for (preset, precession) in [
        ("paper-precession-term-only", true),
        ("paper-spin-term-only", false),
    ] {
        let keys = [("stop.duration", "5"), ("sampling.period", "0.01")];
        let run = Run::with(preset, &keys);
        for sample in &run.samples {
            let (s, c, kf) = (sample.tilt.sin, sample.tilt.cos, k_f(sample));
            let (vertical, axial) = if precession {
                let vertical = kf * c * (ix * s * s + iz * c * c) / ix;
                (vertical, kf * c * c * iz / ix)
            } else {
                let axial = -kf * (iz * c * c + ix * s * s) / ix;
                (c * axial, axial)
            };
            let torque = sample.torque.friction.node;
            assert_near("axial", torque.z, axial, 1e-17);
            assert_near("vertical", s * torque.y + c * torque.z, vertical, 1e-17);
            let Euler { phi, psi, .. } = sample.accelerations.frictional;
            assert_eq!(if precession { psi } else { phi }, 0.0);
        }
    }
}

#[test]
fn val_paper_dissipation_reduces_spin_only() {
    let run = Run::with("paper", &[("stop.duration", "2")]);
    for sample in &run.samples {
        // Equation (6): no friction about the line of nodes, and the magnitude of (4) otherwise.
        let torque = sample.torque.friction.node;
        assert_eq!(torque.x, 0.0);
        let (s, c, kf) = (sample.tilt.sin, sample.tilt.cos, k_f(sample));
        assert_near("perpendicular", torque.y, kf * s * c, 1e-17);
        assert_near("axial", torque.z, -kf * s * s, 1e-17);
    }
}

#[test]
fn val_regular_precession_stays_regular() {
    for formulation in ["euler", "body"] {
        let top = scenario("frictionless", &[("formulation", formulation)])
            .model
            .top;
        let rates = Euler {
            psi: 170.0,
            ..Euler::default()
        };
        let roots = top.precession_roots(&Tilt::from_rates(0.5, rates)).unwrap();
        // Closed form with 24 digits: tests/data/reference.json, elliptic.
        assert_near("slow", roots.slow, 1.753_856_639_711_258_6, 1e-14);
        assert_near("fast", roots.fast, 1_104.093_596_452_813_8, 1e-10);
        for rate in [roots.slow, roots.fast] {
            let keys = [
                ("formulation", formulation),
                ("initial.phi_dot", &format!("{rate:?}")),
                ("stop.duration", "5"),
                ("sampling.period", "0.01"),
            ];
            let run = Run::with("frictionless", &keys);
            let ripple = largest(run.samples.iter().map(|s| s.angles.theta - 0.5));
            let drift = largest(run.samples.iter().map(|s| s.tilt.rates.phi - rate));
            // One local error, 1e-12, per radian of precession, and ten to start with.
            let bound = 1e-12 * (10.0 + 5.0 * rate);
            assert!(ripple < bound, "{formulation} {rate}: {ripple:e}");
            assert!(drift < 1e-9 * rate, "{formulation} {rate}: {drift:e}");
        }
    }
}

/// A top that precesses at the inclination that belongs to its angular momenta does not nutate.
#[test]
fn val_regular_inclination_is_that_of_regular_precession() {
    let frictionless = scenario("frictionless", &[]);
    let top = frictionless.model.top;
    for (theta, spin) in [
        (0.2, 170.0),
        (0.5, 60.0),
        (1.4, -300.0),
        (2.6, 40.0),
        (0.9, 80.0),
    ] {
        let rates = Euler {
            psi: spin,
            ..Euler::default()
        };
        let roots = top
            .precession_roots(&Tilt::from_rates(theta, rates))
            .unwrap();
        for rate in [roots.slow, roots.fast] {
            let tilt = Tilt::from_rates(theta, Euler { phi: rate, ..rates });
            let axial = top.axial_moment * tilt.axial_rate();
            let vertical = top.transverse_moment * rate * tilt.sin * tilt.sin + axial * tilt.cos;
            let found = top.regular_inclination(vertical, axial);
            assert_near("inclination", found, theta, 1e-9);
        }
    }
    // A strong top that stands upright stays so; one without angular momentum hangs down in the end.
    let strong = 1.01 * (4.0 * top.gravity_moment() * top.transverse_moment).sqrt();
    assert!(top.regular_inclination(strong, strong) < 1e-7);
    assert_near("hanging", top.regular_inclination(0.0, 0.0), PI, 1e-9);
}

#[test]
fn val_small_nutations_have_the_frequency_of_the_linear_theory() {
    // ω_n² = (L_n/I_x − 2 φ̇ cos θ)² + (φ̇ sin θ)² = 142.8935164793966882² at the slow root; a nutation of
    // amplitude ε changes it by O(ε²), here 1e-8.
    let keys = [("initial.phi_dot", "1.7538"), ("stop.duration", "2")];
    let run = Run::with("frictionless", &keys);
    let omega = std::f64::consts::TAU / run.cycles[3].period();
    assert_near("ω_n", omega, 142.893_516_479_396_69, 1e-3);
}

#[test]
fn val_both_formulations_agree() {
    for preset in ["paper", "full-coulomb", "paper-spin-term-only"] {
        let euler = Run::with(preset, &[("sampling.period", "0.1")]);
        let keys = [("sampling.period", "0.1"), ("formulation", "body")];
        let body = Run::with(preset, &keys);
        assert_eq!(euler.samples.len(), body.samples.len());
        assert_near("end", euler.end.time, body.end.time, 2e-9);
        for (a, b) in euler.samples.iter().zip(&body.samples) {
            assert_near("θ", a.angles.theta, b.angles.theta, 1e-9);
            assert_near("φ", a.angles.phi, b.angles.phi, 2e-8);
            assert_near("ψ", a.angles.psi, b.angles.psi, 2e-8);
            let angle = a.pose.world_from_body.angle_to(&b.pose.world_from_body);
            assert!(angle < 4e-8, "{angle:e}");
            let torque = a.torque.total.body - b.torque.total.body;
            // The phase of ψ turns the components: 2e-8 rad of a torque below 0.011 N m.
            assert!(torque.norm() < 1e-9, "{torque}");
        }
    }
}

#[test]
fn val_logged_accelerations_are_the_derivatives_of_the_motion() {
    // Central differences of the logged rates: error h²/6 · the third derivative, about (150 rad/s)³ of
    // the nutation's amplitude.
    let keys = [("stop.duration", "0.5"), ("sampling.period", "0.00001")];
    let run = Run::with("paper", &keys);
    let h = 1e-5;
    for three in run.samples.windows(3).step_by(97) {
        let total = three[1].accelerations.total();
        for (rate, acceleration) in [
            ((|r| r.phi) as fn(&Euler) -> f64, total.phi),
            (|r| r.theta, total.theta),
            (|r| r.psi, total.psi),
        ] {
            let difference = (rate(&three[2].tilt.rates) - rate(&three[0].tilt.rates)) / (2.0 * h);
            assert_near("acceleration", difference, acceleration, 1e-5);
        }
    }
}

#[test]
fn val_logged_torque_drives_the_logged_angular_momentum() {
    // dL/dt = τ in the world, by central differences of 10 µs.
    for preset in [
        "paper",
        "full-coulomb",
        "paper-precession-term-only",
        "paper-spin-term-only",
    ] {
        let keys = [
            ("stop.duration", "0.1"),
            ("sampling.period", "0.00001"),
            ("formulation", "body"),
        ];
        let run = Run::with(preset, &keys);
        for three in run.samples.windows(3).step_by(101) {
            let difference = (three[2].momentum.world - three[0].momentum.world) / 2e-5;
            let torque = three[1].pose.world_from_body * three[1].torque.total.body;
            let gap = (difference - torque).norm();
            assert!(gap < 1e-9, "{preset}: {gap:e}");
        }
    }
}

#[test]
fn val_slip_velocity_is_omega_cross_r() {
    let run = Run::with("full-coulomb", &[("sampling.period", "0.05")]);
    for sample in &run.samples {
        let r = Vector3::new(0.0, 0.0, -0.007);
        let slip = sample.pose.omega_world.cross(&r);
        assert!((slip - sample.slip.world).norm() < 1e-14);
        let in_body = sample.pose.world_from_body.inverse() * slip;
        // ψ reaches 4000 rad, which a double resolves to 5e-13 rad.
        assert!((in_body - sample.slip.body).norm() < 1e-12);
    }
}

/// A strong top that, thrown just so, swings through the vertical: L_z′ = L_n.
fn through_upright(formulation: &str) -> Scenario {
    // L_z′ = I_x s² φ̇ + L_n c equals L_n for I_x s² φ̇ = L_n (1 − c), L_n = I_z (ψ̇ + φ̇ c).
    let (ix, iz, theta, psi_dot) = (8.52e-5_f64, 7.25e-5_f64, 0.5_f64, 30.0_f64);
    let (s, c) = libm::sincos(theta);
    let phi_dot = iz * psi_dot * (1.0 - c) / (ix * s * s - iz * c * (1.0 - c));
    scenario(
        "frictionless",
        &[
            ("formulation", formulation),
            ("initial.phi_dot", &format!("{phi_dot:?}")),
            ("initial.psi_dot", &format!("{psi_dot:?}")),
            ("initial.theta_dot", "-12.0"),
            ("stop.duration", "3"),
        ],
    )
}

#[test]
fn body_formulation_passes_upright() {
    let run = Run::of(&through_upright("body"));
    assert_eq!(run.end.stop, StopReason::Duration);
    assert!(run.events_of(EventKind::UprightPassage).count() >= 3);
    let first = &run.samples[0];
    let least = run
        .events_of(EventKind::UprightPassage)
        .map(|e| e.motion.angles.theta);
    assert!(least.fold(1.0, f64::min) < 1e-5);
    for sample in &run.samples {
        assert_near("E", sample.energy.total(), first.energy.total(), 1e-12);
        assert_near(
            "L_z",
            sample.momentum.vertical,
            first.momentum.vertical,
            1e-15,
        );
        assert_near("L_n", sample.momentum.axial, first.momentum.axial, 1e-13);
    }
    // φ + ψ goes on smoothly even where φ and ψ jump.
    for pair in run.samples.windows(2) {
        let sum = |i: usize| pair[i].angles.phi + pair[i].angles.psi;
        assert!((sum(1) - sum(0)).abs() < 0.2);
    }
}

#[test]
fn euler_formulation_stops_at_singularity() {
    let mut simulation =
        toprise::run::simulation::Simulation::new(&through_upright("euler")).unwrap();
    let failed = simulation.by_ref().any(|record| record.is_err());
    let stop = simulation.end().stop;
    assert!(
        stop == StopReason::Singular || (failed && stop == StopReason::Failed),
        "{stop:?}"
    );
    assert!(simulation.end().time < 0.2);
}

#[test]
fn sleeping_top_stays_upright() {
    let keys = [
        ("formulation", "body"),
        ("initial.theta", "0"),
        ("initial.phi_dot", "0"),
        ("stop.duration", "2"),
    ];
    let run = Run::with("frictionless", &keys);
    for sample in &run.samples {
        assert_eq!(sample.angles.theta, 0.0);
        assert_near("spin", sample.tilt.rates.psi, 170.0, 1e-10);
        assert!(sample.accelerations.total().phi.is_finite());
        assert_near(
            "angle",
            sample.angles.psi + sample.angles.phi,
            170.0 * sample.time_ns as f64 / 1e9,
            1e-8,
        );
    }
}

#[test]
fn full_friction_stops_the_slip_just_short_of_upright() {
    let keys = [("formulation", "body"), ("stop.theta_risen", "")];
    let run = Run::with("full-coulomb", &keys);
    assert_eq!(run.end.stop, StopReason::SlipStopped);
    assert!(run.end.motion.angles.theta < 1e-3);
}

#[test]
fn the_strength_ratio_is_one_at_the_sleeping_threshold() {
    // w_z = 2 √(M g l I_x)/I_z = 37.40740921223311 rad/s.
    let top = scenario("paper", &[]).model.top;
    let tilt = Tilt::from_rates(
        1e-3,
        Euler {
            phi: 0.0,
            theta: 0.0,
            psi: 37.407_409_212_233_11,
        },
    );
    assert_near("ratio", top.strength_ratio(&tilt), 1.0, 1e-14);
}

/// By a regular precession, small nutations have ω² = a² + φ̇² sin² θ − 4 (M g l/I_x) cos θ, with a = I_z Ω/I_x: gravity
/// changes ω by less than 1/(2 r²), where r is the strength ratio |a|/√(4 M g l/I_x).
#[test]
fn val_small_nutations_of_a_fast_top() {
    let top = scenario("paper", &[]).model.top;
    let theta = 0.5;
    for psi in [200.0, 2e3, 2e4] {
        let spin = Tilt::from_rates(
            theta,
            Euler {
                phi: 0.0,
                theta: 0.0,
                psi,
            },
        );
        let phi = top.precession_roots(&spin).unwrap().slow;
        let tilt = Tilt::from_rates(
            theta,
            Euler {
                phi,
                theta: 0.0,
                psi,
            },
        );
        let exact = TAU / top.nutation_period(&tilt, [theta, theta]).unwrap();
        let ratio = top.nutation_frequency(tilt.axial_rate()) / exact;
        let strength = top.strength_ratio(&tilt);
        let gravity = 0.5 / (strength * strength);
        assert!((ratio - 1.0).abs() < gravity, "{psi} rad/s: {ratio}");
    }
}

#[test]
fn shorter_run_is_prefix_of_longer_run() {
    for formulation in ["euler", "body"] {
        let run = |duration| {
            Run::with(
                "paper",
                &[("formulation", formulation), ("stop.duration", duration)],
            )
        };
        let (short, long) = (run("1.2345"), run("3"));
        assert_eq!(short.samples.len(), 1235);
        assert_eq!(short.samples, long.samples[..short.samples.len()]);
        assert_eq!(short.events, long.events[..short.events.len()]);
    }
}

#[test]
fn motion_ignores_sampling() {
    let run = |period| {
        Run::with(
            "paper",
            &[("sampling.period", period), ("stop.duration", "2")],
        )
    };
    let (fine, coarse) = (run("0.0001"), run("0.1"));
    assert_eq!(fine.end.statistics, coarse.end.statistics);
    assert_eq!(fine.events, coarse.events);
    for (i, sample) in coarse.samples.iter().enumerate() {
        assert_eq!(sample.angles, fine.samples[i * 1000].angles);
    }
}
