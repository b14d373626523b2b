//! Laws of friction: what each must keep in every state, their limits, sticking, whole lives.

use crate::support::{
    Run, archive, assert_contains, assert_near, scenario, sliding_friction, verified,
};
use nalgebra::Vector3;
use proptest::prelude::*;
use std::collections::BTreeSet;
use std::f64::consts::PI;
use std::sync::Arc;
use toprise::archive::verify::Verdict;
use toprise::archive::writer::Form;
use toprise::physics::dynamics::{BodyRotation, EulerAngles, Formulation, Guard, Model, Phase};
use toprise::physics::formula::Formula;
use toprise::physics::friction::{
    Air, Branch, Dissipation, Drilling, Friction, FrictionLaw, Losses, Smoothing, drilling_torque,
};
use toprise::physics::integrate::System;
use toprise::physics::kinematics::{Euler, Tilt};
use toprise::run::scenario::{KEYS, Kind, LAWS, Law, Scenario};
use toprise::run::simulation::{EventKind, StopReason};

fn model(friction: Friction) -> Model {
    let mut model = scenario("paper", &[]).model;
    model.friction = friction;
    model
}

fn sliding(law: FrictionLaw) -> Model {
    model(sliding_friction(law, Dissipation::Full))
}

fn state() -> impl Strategy<Value = Tilt> {
    let rates = (-20.0..20.0_f64, -20.0..20.0_f64, -300.0..300.0_f64);
    (0.05..3.09_f64, rates).prop_map(|(theta, (phi, theta_dot, psi))| {
        let rates = Euler {
            phi,
            theta: theta_dot,
            psi,
        };
        Tilt::from_rates(theta, rates)
    })
}

fn smoothing() -> impl Strategy<Value = Smoothing> {
    prop_oneof![
        Just(Smoothing::SquareRoot),
        Just(Smoothing::Tanh),
        Just(Smoothing::Rational),
    ]
}

/// Formulas of laws that are not negative at any speed.
const FORMULAS: [&str; 4] = [
    "k",
    "k*tanh(v/a)",
    "k*(1 + 0.5*exp(-(v/a)^2)) + 0.1*v",
    "points(v; 0, k; a, 0.1; 2*a, 0.3)",
];

fn formula(text: &str, k: f64, a: f64) -> FrictionLaw {
    let formula = Formula::parse(text).unwrap();
    let coefficient = formula.with_parameters(&[k, a, 0.0, 0.0, 0.0]).unwrap();
    FrictionLaw::Formula {
        static_k: coefficient.at(0.0),
        coefficient: Arc::new(coefficient),
    }
}

fn law() -> impl Strategy<Value = FrictionLaw> {
    let k = || 0.0..2.0_f64;
    let speed = || 1e-4..2.0_f64;
    prop_oneof![
        Just(FrictionLaw::None),
        k().prop_map(|k| FrictionLaw::Coulomb { k }),
        (k(), speed(), smoothing()).prop_map(|(k, speed, shape)| FrictionLaw::Regularised {
            k,
            speed,
            shape
        }),
        (k(), speed()).prop_map(|(k, speed)| FrictionLaw::Viscous { k, speed }),
        (k(), k(), speed(), 0.0..1.0_f64).prop_map(|(k, static_k, speed, slope)| {
            FrictionLaw::Stribeck {
                k,
                static_k,
                speed,
                slope,
            }
        }),
        (k(), 1e-6..1e-2_f64)
            .prop_map(|(k, patch_radius)| FrictionLaw::Contensou { k, patch_radius }),
        (k(), speed(), 0..FORMULAS.len()).prop_map(|(k, a, index)| formula(FORMULAS[index], k, a)),
    ]
}

fn losses() -> impl Strategy<Value = Losses> {
    let air = (0.0..1e-4_f64, 0.0..1e-4_f64, 0.0..1e-4_f64);
    (0.0..1e-3_f64, 0.0..1.0_f64, 1e-6..1e-2_f64, air).prop_map(
        |(rolling_arm, k, patch_radius, (axial, transverse, disc))| Losses {
            rolling_arm,
            drilling: Drilling { k, patch_radius },
            air: Air {
                axial,
                transverse,
                disc,
            },
        },
    )
}

fn part() -> impl Strategy<Value = Dissipation> {
    prop_oneof![
        Just(Dissipation::Full),
        Just(Dissipation::WithoutNutationPart),
        Just(Dissipation::PrecessionTermOnly),
        Just(Dissipation::SpinTermOnly),
        Just(Dissipation::TiltTorqueOnly),
        Just(Dissipation::SpinTorqueOnly),
    ]
}

/// Rates of L_z′, L_n and E that friction causes, from its torque.
fn changes(model: &Model, tilt: &Tilt) -> [f64; 3] {
    let torque = model.friction_torque(&model.contact(tilt), tilt);
    [
        torque.z,
        tilt.lean_to_node(&torque).z,
        torque.dot(&tilt.omega_lean),
    ]
}

proptest! {
    #[test]
    fn friction_never_adds_energy(tilt in state(), law in law(), losses in losses()) {
        for part in [Dissipation::Full, Dissipation::WithoutNutationPart] {
            let mut friction = sliding_friction(law.clone(), part);
            let alone = model(friction.clone());
            // Exactly: each product of a component and its rate is negative or zero.
            prop_assert!(changes(&alone, &tilt)[2] <= 0.0);
            friction.losses = Some(losses);
            let together = model(friction);
            let contact = together.contact(&tilt);
            let torque = together.friction_torque(&contact, &tilt);
            // The torque of the air mixes directions: four roundings of products.
            let rounding = 4.0 * f64::EPSILON * torque.norm() * tilt.omega_lean.norm();
            prop_assert!(torque.dot(&tilt.omega_lean) <= rounding);
        }
        let (omega, axis) = (tilt.omega_lean, tilt.axis());
        let mut each = [Losses::default(); 3];
        each[0].rolling_arm = losses.rolling_arm;
        each[1].drilling = losses.drilling;
        each[2].air = losses.air;
        for loss in each {
            let torque = loss.torque(1.0, &omega, &axis, &Branch::default());
            let rounding = 4.0 * f64::EPSILON * torque.norm() * omega.norm();
            prop_assert!(torque.dot(&omega) <= rounding);
        }
    }

    #[test]
    fn val_torques_of_the_contact_do_not_depend_on_the_rate(
        tilt in state(), losses in losses(), normal_force in 1e-3..10.0_f64,
    ) {
        // Without slip neither the resistance to rolling nor drilling depends on how fast the top turns.
        let torque = losses.contact_torque(normal_force, &tilt.omega_lean, &Branch::default());
        let rolling = losses.rolling_arm * normal_force;
        let Drilling { k, patch_radius } = losses.drilling;
        let drilling = 3.0 * PI / 16.0 * k * normal_force * patch_radius;
        // Some ten roundings of products and a root.
        let rounding = 10.0 * f64::EPSILON * (rolling + drilling);
        prop_assert!((torque.xy().norm() - rolling).abs() <= rounding);
        prop_assert!((torque.z.abs() - drilling).abs() <= rounding);
    }

    #[test]
    fn force_opposes_slip_within_its_bound(tilt in state(), law in law()) {
        let contact = sliding(law.clone()).contact(&tilt);
        let size = contact.force.norm() * contact.slip_speed;
        prop_assert!(contact.force.cross(&contact.slip).norm() <= 4.0 * f64::EPSILON * size);
        prop_assert!(contact.force.dot(&contact.slip) <= 0.0);
        let bound = law.bound(contact.slip_speed, contact.normal_force);
        prop_assert!(contact.force.norm() <= bound * (1.0 + 4.0 * f64::EPSILON));
    }

    #[test]
    fn val_each_part_changes_momenta_and_energy_as_derived(tilt in state(), law in law(), part in part()) {
        // With τ = −C ω_⊥ and K F = C ψ̇ in general; drilling is left aside, it is about the vertical alone.
        prop_assume!(!matches!(law, FrictionLaw::Contensou { .. }));
        let whole = sliding(law.clone());
        let contact = whole.contact(&tilt);
        let radius = whole.top.peg_radius;
        let c_of_v = radius * radius * law.resistance(contact.slip_speed, tilt.omega_lean.z, contact.normal_force);
        let Tilt { sin: s, cos: c, rates, .. } = tilt;
        let kf = c_of_v * rates.psi;
        let (ix, iz) = (whole.top.transverse_moment, whole.top.axial_moment);
        let axial = iz * tilt.axial_rate();
        let vertical = ix * s * s * rates.phi + axial * c;
        let expected = match part {
            Dissipation::Full => {
                let rate = rates.theta * rates.theta + rates.psi * rates.psi * s * s;
                [0.0, -kf * s * s, -c_of_v * rate]
            }
            Dissipation::WithoutNutationPart => [0.0, -kf * s * s, -kf * rates.psi * s * s],
            Dissipation::PrecessionTermOnly => [
                kf * c * (ix * s * s + iz * c * c) / ix,
                kf * c * c * iz / ix,
                vertical * kf * c / ix,
            ],
            Dissipation::SpinTermOnly => {
                let spin = -kf * (iz * c * c + ix * s * s) / ix;
                [c * spin, spin, -axial * kf * (c * c / ix + s * s / iz)]
            }
            Dissipation::TiltTorqueOnly => [kf * s * s * c, 0.0, kf * s * s * c * rates.phi],
            Dissipation::SpinTorqueOnly => {
                [-kf * s * s * c, -kf * s * s, -kf * s * s * tilt.axial_rate()]
            }
        };
        let found = changes(&model(sliding_friction(law, part)), &tilt);
        // Roundings of a few products of the whole torque, which the parts are differences of. The
        // ablations' accelerations are 1/sin θ ≤ 20 larger.
        let torque = c_of_v * tilt.omega_lean.norm() * (1.0 + ix / iz) / s;
        let scales = [torque, torque, torque * tilt.omega_lean.norm()];
        for ((found, expected), scale) in found.iter().zip(expected).zip(scales) {
            prop_assert!((found - expected).abs() <= 64.0 * f64::EPSILON * scale, "{found:e} {expected:e}");
        }
    }

    #[test]
    fn vanishing_scales_leave_coulomb_friction(tilt in state(), k in 0.0..2.0_f64, shape in smoothing()) {
        let force = |law| sliding(law).contact(&tilt).force;
        let coulomb = force(FrictionLaw::Coulomb { k });
        let slip = sliding(FrictionLaw::None).contact(&tilt).slip_speed;
        prop_assume!(slip > 1e-4);
        let scale = 1e-9;
        for law in [
            FrictionLaw::Regularised { k, speed: scale, shape },
            FrictionLaw::Stribeck { k, static_k: 2.0 * k, speed: scale, slope: 0.0 },
            FrictionLaw::Contensou { k, patch_radius: scale },
        ] {
            // Contensou's scale is that of the rim's speed, 320 rad/s times a.
            let ratio = 320.0 * scale / slip;
            prop_assert!((force(law) - coulomb).norm() <= (ratio + 1e-15) * coulomb.norm());
        }
        let drilling = drilling_torque(k, scale, 1.0, slip, tilt.omega_lean.z);
        prop_assert!(drilling.abs() <= k * scale);
    }

    #[test]
    fn zero_parameters_mean_no_friction(tilt in state(), shape in smoothing(), speed in 1e-4..1.0_f64) {
        for law in [
            FrictionLaw::None,
            FrictionLaw::Coulomb { k: 0.0 },
            FrictionLaw::Regularised { k: 0.0, speed, shape },
            FrictionLaw::Viscous { k: 0.0, speed },
            FrictionLaw::Stribeck { k: 0.0, static_k: 0.0, speed, slope: 0.0 },
            FrictionLaw::Contensou { k: 0.0, patch_radius: speed },
        ] {
            let model = sliding(law);
            prop_assert!(model.friction.is_none());
            prop_assert_eq!(model.friction_torque(&model.contact(&tilt), &tilt).norm(), 0.0);
        }
    }

    #[test]
    fn smooth_laws_are_continuous_at_rest(k in 0.0..2.0_f64, speed in 1e-3..1.0_f64, shape in smoothing(), omega in 1.0..300.0_f64) {
        for law in [
            FrictionLaw::Regularised { k, speed, shape },
            FrictionLaw::Viscous { k, speed },
            FrictionLaw::Contensou { k, patch_radius: speed / omega },
        ] {
            // f ≤ k N v / (scale of the speed), where 8/3π is the smallest factor of a scale.
            for slip in [1e-6, 1e-9, 1e-12] {
                let force = law.resistance(slip, omega, 1.0) * slip;
                prop_assert!(force <= 1.2 * k * slip / speed, "{law:?} {slip}: {force}");
            }
            prop_assert_eq!(law.static_bound(1.0), 0.0);
            let rest = Tilt::from_omega(0.1, 0.99, Vector3::new(0.0, 0.0, omega));
            prop_assert_eq!(sliding(law).contact(&rest).force.norm(), 0.0);
        }
    }

    #[test]
    fn laws_are_continuous_in_the_slip(law in law(), slip in 1e-3..2.0_f64, omega in -300.0..300.0_f64) {
        let force = |slip: f64| law.resistance(slip, omega, 1.0) * slip;
        let step = 1e-9;
        // The steepest is Stribeck's: 2 · 0.86 / 1e-4 s/m.
        prop_assert!((force(slip + step) - force(slip)).abs() < 2e4 * step);
    }

    #[test]
    fn formulations_agree_under_all_laws(tilt in state(), law in law(), losses in losses(), part in part()) {
        // The Euler accelerations turned into dL/dt are the torque: 𝕀 ω̇ + ω × L.
        let model = model(Friction { law, dissipation: part, losses: Some(losses), branch: Branch::default() });
        let contact = model.contact(&tilt);
        let torque = tilt.lean_to_node(&model.friction_torque(&contact, &tilt));
        let frictional = model.accelerations(&contact, &tilt).frictional;
        let (ix, iz) = (model.top.transverse_moment, model.top.axial_moment);
        let from_accelerations = Vector3::new(
            // The ablations of the paper leave out θ̇'s part of the force.
            ix * frictional.theta,
            ix * frictional.phi * tilt.sin,
            iz * (frictional.psi + frictional.phi * tilt.cos),
        );
        let scale = torque.norm() + iz * frictional.psi.abs() + iz * frictional.phi.abs();
        let gap = (from_accelerations - torque).norm();
        prop_assert!(gap <= 32.0 * f64::EPSILON * scale, "{gap:e} of {scale:e}");
    }

    #[test]
    fn contact_at_rest_is_held_within_static_bound(
        theta in 0.0..3.1_f64, omega in -200.0..200.0_f64, k in 0.0..10.0_f64, losses in losses(),
    ) {
        let model = model(Friction { law: FrictionLaw::Coulomb { k }, dissipation: Dissipation::Full, losses: Some(losses), branch: Branch::default() });
        let rates = Euler { phi: omega, theta: 0.0, psi: 0.0 };
        let tilt = Tilt::from_rates(theta, rates);
        let contact = model.contact(&tilt);
        let grip = model.grip(&tilt);
        let bound = k * contact.normal_force;
        prop_assert!(contact.force.norm() <= bound * (1.0 + 1e-14));
        let strongest = bound * model.top.peg_radius + losses.rolling_arm * contact.normal_force;
        prop_assert!((grip.maximum - strongest).abs() <= 1e-15 * strongest);
        if grip.holds() {
            // Nothing but the turning about the vertical changes.
            let total = model.accelerations(&contact, &tilt).total();
            let size = 1.0 + omega * omega;
            prop_assert!(total.theta.abs() < 1e-12 * size, "{total:?}");
            prop_assert!((total.psi * tilt.sin).abs() < 1e-12 * size, "{total:?}");
        }
    }
}

/// A scenario in which friction can stick.
fn sticking(overrides: &[(&str, &str)]) -> Scenario {
    let common = [
        ("stop.theta_risen", ""),
        ("stop.on_stick", "continue"),
        ("sampling.period", "0.01"),
    ];
    scenario("full-coulomb", &[&common[..], overrides].concat())
}

#[test]
fn full_friction_sticks_just_short_of_upright() {
    for formulation in ["euler", "body"] {
        let keys = [("formulation", formulation), ("stop.duration", "30")];
        let run = Run::of(&sticking(&keys));
        assert_eq!(run.end.stop, StopReason::Duration);
        let stick = run.first(EventKind::Stick);
        // |(I_z − I_x) Ω² cos θ − M g l| sin θ ≤ k M g R.
        let omega = stick.motion.tilt.omega_lean.z;
        let theta = stick.motion.angles.theta;
        let needed =
            (1.27e-5 * omega * omega * libm::cos(theta) + 0.110 * 9.81 * 0.020) * libm::sin(theta);
        assert!(needed <= 0.03 * 0.110 * 9.81 * 0.007, "{needed:e}");
        // From then on it turns rigidly about the vertical: the contact point is at rest, and nothing is lost.
        let before = &run.samples[0];
        for sample in run.samples.iter().filter(|s| s.time_ns > stick.time_ns) {
            assert_eq!(sample.contact.slip_speed, 0.0);
            assert_eq!(sample.tilt.rates.psi, 0.0);
            assert_near("θ", sample.angles.theta, theta, 1e-12);
            assert_near("Ω", sample.tilt.omega_lean.z, omega, 1e-8);
            assert_eq!(sample.energy.friction_power, 0.0);
            let held = sample.torque.friction.node.norm();
            assert_near("held", held, needed, 1e-9 * needed);
            let [now, then] = [sample, before].map(|s| s.momentum.vertical);
            assert_near("L_z", now, then, 1e-14);
        }
        let last = run.samples.last().unwrap();
        let change = last.energy.total() - before.energy.total();
        assert_near("E", change, last.integrals.friction_work, 1e-12);
    }
}

#[test]
fn sticking_stops_the_run_by_default() {
    let run = Run::with("full-coulomb", &[("stop.theta_risen", "")]);
    assert_eq!(run.end.stop, StopReason::SlipStopped);
    let last = run.events.last().unwrap();
    assert_eq!(last.kind, EventKind::SlipStops);
}

/// An oblate top that turns about the vertical as a whole at the rate where gravity and centrifugal torque
/// are in balance, and is slowed down by the air.
fn balanced(k: &str) -> Scenario {
    let (ix, iz, moment) = (1.0e-4_f64, 1.1e-4_f64, 0.110 * 9.81 * 0.020);
    let omega = (moment / ((iz - ix) * libm::cos(0.5))).sqrt();
    sticking(&[
        ("top.transverse_moment", "1.0e-4"),
        ("top.axial_moment", "1.1e-4"),
        ("initial.phi_dot", &format!("{omega:?}")),
        ("initial.psi_dot", "0"),
        ("friction.k", k),
        ("air.axial", "1e-6"),
        ("air.transverse", "1e-6"),
        ("stop.duration", "60"),
    ])
}

#[test]
fn overloaded_contact_slips_again() {
    for formulation in ["euler", "body"] {
        let mut values = balanced("0.3").clone().to_toml();
        values = values.replace("\"euler\"", &format!("\"{formulation}\""));
        let run = Run::of(&Scenario::from_toml(&values).unwrap());
        assert_eq!(run.events[1].kind, EventKind::Stick);
        assert_eq!(run.events[1].time, 0.0);
        let slip = run.first(EventKind::SlipResumes);
        // There friction's torque is all of K = k M g R.
        let model = balanced("0.3").model;
        let needed = model.grip(&slip.motion.tilt).required.norm();
        assert_near("K", needed, 0.3 * 0.110 * 9.81 * 0.007, 1e-12);
        // Until then the air alone slows it: d(L_z)/dt = −c Ω with c_n = c_t.
        let moment = 1.0e-4 + 1.0e-5 * libm::cos(0.5) * libm::cos(0.5);
        let decay = libm::exp(-1e-6 / moment * slip.time);
        let omega = run.samples[0].tilt.omega_lean.z * decay;
        assert_near("Ω", slip.motion.tilt.omega_lean.z, omega, 1e-9);
        // Then it falls.
        assert_eq!(run.end.stop, StopReason::Fallen);
    }
    assert_eq!(Run::of(&balanced("10")).end.stop, StopReason::Duration);
}

#[test]
fn overloaded_contact_at_rest_begins_to_slip() {
    // θ̇ and ψ̇ vanish together, and friction is far too weak to hold the top.
    let runs = ["euler", "body"].map(|formulation| {
        Run::of(&sticking(&[
            ("formulation", formulation),
            ("initial.psi_dot", "0"),
            ("initial.phi_dot", "20"),
            ("stop.duration", "0.1"),
        ]))
    });
    let first = &runs[0].samples[0];
    assert_eq!(first.contact.slip_speed, 0.0);
    let bound = 0.03 * first.contact.normal_force;
    assert_near("f", first.slip.friction_force.norm(), bound, 1e-14);
    for run in &runs {
        assert_eq!(run.events_of(EventKind::Stick).count(), 0);
        for sample in &run.samples {
            let gap = sample.energy.total() - first.energy.total() - sample.integrals.friction_work;
            assert!(gap.abs() < 1e-12, "{gap:e}");
        }
    }
    // The force jumps at the start. There a step may err by the absolute tolerance, 1e-12 kg m²/s of the
    // momentum, which is 1.2e-8 rad/s.
    let [a, b] = runs.map(|run| run.end.motion.angles);
    assert_near("θ", a.theta, b.theta, 1e-7);
    assert_near("φ", a.phi, b.phi, 1e-7);
}

#[test]
fn drilling_stops_a_sticking_top() {
    let run = Run::of(&sticking(&[
        ("initial.psi_dot", "0"),
        ("initial.phi_dot", "10"),
        ("friction.k", "10"),
        ("drilling.k", "10"),
        ("drilling.patch_radius", "1e-3"),
        ("stop.duration", "60"),
    ]));
    assert_eq!(run.end.stop, StopReason::Rest);
    // Ω falls evenly by (3π/16) k N a / I, I the moment about the vertical.
    let (s, c) = libm::sincos(0.5);
    let moment = 8.52e-5 * s * s + 7.25e-5 * c * c;
    let torque = 3.0 * std::f64::consts::PI / 16.0 * 10.0 * 0.110 * 9.81 * 1e-3;
    assert_near("t", run.end.time, 10.0 * moment / torque, 1e-10);
}

#[test]
fn val_the_sleeping_top_nutates_under_viscous_friction() {
    // The fast mode I_x Ω² − L_n Ω + M g l = 0 grows like exp(γ t), γ = c (w − Ω)/(2 I_x Ω − L_n).
    let (ix, iz, moment) = (8.52e-5_f64, 7.25e-5_f64, 0.110 * 9.81 * 0.020);
    let c = 0.007 * 0.007 * 0.03 * 0.110 * 9.81 / 0.5;
    let spin = 151.0;
    let axial = iz * spin;
    let omega = (axial + (axial * axial - 4.0 * ix * moment).sqrt()) / (2.0 * ix);
    let rate = c * (spin - omega) / (2.0 * ix * omega - axial);
    assert_near("closed form", rate, 0.007_331_71, 1e-8);
    let theta = 1e-4;
    let keys = [
        ("formulation", "body"),
        ("initial.theta", &format!("{theta:?}")),
        ("initial.theta_dot", &format!("{:?}", rate * theta)),
        ("initial.phi_dot", &format!("{omega:?}")),
        ("initial.psi_dot", &format!("{:?}", spin - omega)),
        ("stop.theta_risen", ""),
        ("stop.duration", "60"),
        ("sampling.period", "0.1"),
    ];
    let run = Run::with("viscous", &keys);
    let grown = libm::log(run.at(60.0).angles.theta / run.at(0.0).angles.theta) / 60.0;
    // The closed form is the first order in c. The second only changes the frequency, so that the
    // relative error is of the order (c/L_n)² = 8e-8.
    assert_near("growth", grown, rate, 1e-6 * rate);
}

#[test]
fn val_the_tilt_torque_alone_raises_at_constant_axial_momentum() {
    for formulation in ["euler", "body"] {
        let run = Run::with("tilt-torque-only", &[("formulation", formulation)]);
        assert_eq!(run.end.stop, StopReason::Risen);
        let axial = run.samples[0].momentum.axial;
        for sample in &run.samples {
            assert_near("L_n", sample.momentum.axial, axial, 1e-13);
        }
        // Leading order of the average: θ̇ = −K cos θ/L_n, whose error is of the order φ̇/ω_n and of the
        // nutation's amplitude over the last θ: a few per cent.
        let time = axial / (0.03 * 0.110 * 9.81 * 0.007)
            * (inverse_gudermann(0.5) - inverse_gudermann(0.02));
        assert_near("t", run.end.time, time, 0.04 * time);
    }
    let spin = Run::with("spin-torque-only", &[("sampling.period", "0.1")]);
    assert_eq!(spin.end.stop, StopReason::Fallen);
    assert!(spin.samples.iter().all(|s| s.angles.theta > 0.49));
}

/// artanh(sin θ).
fn inverse_gudermann(theta: f64) -> f64 {
    libm::atanh(libm::sin(theta))
}

#[test]
fn loss_of_spin_raises_top_at_constant_precession() {
    let run = Run::with("rise-by-loss-of-spin", &[]);
    assert_eq!(run.end.stop, StopReason::Risen);
    for pair in run.cycles.windows(2) {
        let rates = |i: usize| pair[i].mean_rates;
        assert!(rates(1).phi.abs() < rates(0).phi.abs());
        assert!(rates(1).psi.abs() < rates(0).psi.abs());
        assert!(pair[1].theta_mean < pair[0].theta_mean);
    }
}

#[test]
fn a_top_in_air_rises_sleeps_weakens_and_falls() {
    let run = Run::with("lifecycle", &[("sampling.period", "0.01")]);
    assert_eq!(run.end.stop, StopReason::Fallen);
    assert!(run.end.time < 120.0);
    let weak = run.first(EventKind::WeakTop).time;
    let largest = |from: f64, to: f64| {
        let within = run.samples.iter().filter(|s| {
            let t = s.time_ns as f64 / 1e9;
            t >= from && t <= to
        });
        within.map(|s| s.angles.theta).fold(0.0, f64::max)
    };
    let asleep = largest(35.0, weak - 5.0);
    assert!(asleep < 0.02, "{asleep}");
    assert!(largest(weak, run.end.time) > 1.5);
}

#[test]
fn val_logged_torques_of_all_laws_drive_the_logged_momentum() {
    // dL/dt = τ in the world by central differences of 10 µs, whose error is h²/6 · (150 rad/s)³ · L.
    let all: &[(&str, &str)] = &[
        ("rolling.arm", "1e-4"),
        ("air.axial", "1e-6"),
        ("air.transverse", "2e-6"),
        ("air.disc", "1e-7"),
    ];
    let drilling: &[(&str, &str)] = &[("drilling.k", "0.1"), ("drilling.patch_radius", "1e-3")];
    for (preset, more) in [
        ("viscous", drilling),
        ("stribeck", drilling),
        ("contensou", &[]),
        ("tilt-torque-only", drilling),
        ("spin-torque-only", drilling),
        ("paper-spin-term-only", drilling),
    ] {
        for formulation in ["euler", "body"] {
            let common = [
                ("formulation", formulation),
                ("stop.duration", "0.1"),
                ("sampling.period", "0.00001"),
            ];
            let run = Run::with(preset, &[&common[..], all, more].concat());
            for three in run.samples.windows(3).step_by(101) {
                let difference = (three[2].momentum.world - three[0].momentum.world) / 2e-5;
                let torque = three[1].pose.world_from_body * three[1].torque.total.body;
                let gap = (difference - torque).norm();
                assert!(gap < 2e-9, "{preset} {formulation}: {gap:e}");
            }
        }
    }
}

#[test]
fn recordings_of_all_laws_are_verified() {
    let directory = tempfile::tempdir().unwrap();
    let all: &[(&str, &str)] = &[
        ("drilling.k", "0.3"),
        ("drilling.patch_radius", "1.4e-3"),
        ("rolling.arm", "1e-4"),
        ("air.axial", "1e-6"),
        ("air.transverse", "1e-6"),
        ("air.disc", "1e-8"),
    ];
    let smooth: &[(&str, &str)] = &[
        ("friction.law", "coulomb-tanh"),
        ("friction.smoothing_speed", "0.01"),
    ];
    let rational: &[(&str, &str)] = &[
        ("friction.law", "coulomb-rational"),
        ("friction.smoothing_speed", "0.01"),
        ("formulation", "body"),
    ];
    let rolling: &[(&str, &str)] = &[("rolling.arm", "2e-4"), ("stop.duration", "30")];
    let scenarios = [
        scenario("viscous", all),
        scenario("stribeck", &[]),
        scenario("contensou", &[]),
        scenario("contensou", &all[2..]),
        scenario("tilt-torque-only", &[]),
        scenario("spin-torque-only", all),
        scenario("paper-precession-term-only", &all[2..]),
        scenario("full-coulomb", smooth),
        scenario("full-coulomb", rational),
        scenario("frictionless", rolling),
        scenario("lifecycle", &[]),
        scenario("rise-by-loss-of-spin", &[]),
        sticking(&[&[("stop.duration", "40")][..], all].concat()),
        balanced("0.3"),
    ];
    for (index, scenario) in scenarios.iter().enumerate() {
        let mut values = scenario.to_toml();
        values = values.replace("period = 0.001", "period = 0.01");
        let scenario = Scenario::from_toml(&values).unwrap();
        let path = directory.path().join(format!("{index}.mcap"));
        archive(&path, &scenario, &[], Form::default()).unwrap();
        let report = verified(&path);
        assert_eq!(report.verdict, Verdict::Verified, "{index}: {report:#?}");
    }
}

#[test]
fn every_law_name_selects_its_law() {
    let key = KEYS.iter().find(|key| key.path == "friction.law").unwrap();
    let Kind::Choice(words) = key.kind else {
        panic!("{:?}", key.kind);
    };
    let listed: Vec<_> = LAWS.iter().filter(|law| law.is_sliding()).collect();
    assert_eq!(listed.iter().map(|law| law.name).collect::<Vec<_>>(), words);
    let sections = ["friction", "rolling", "drilling", "air"];
    let is_parameter = |path: &str| {
        let section = path.split_once('.').map_or("", |(section, _)| section);
        let words = ["friction.law", "friction.formula", "friction.dissipation"];
        sections.contains(&section) && !words.contains(&path)
    };
    let all: BTreeSet<_> = KEYS
        .iter()
        .map(|key| key.path)
        .filter(|path| is_parameter(path))
        .collect();
    let listed: BTreeSet<_> = LAWS
        .iter()
        .flat_map(Law::parameters)
        .map(|key| key.path)
        .collect();
    assert_eq!(listed, all);
    for law in &LAWS[1..] {
        assert!(law.parameters().count() > 0, "{}", law.name);
        assert!(!law.formula.is_empty() && !law.typical.is_empty() && !law.source.is_empty());
        if law.is_sliding() {
            // In tables of Markdown, a bar is escaped.
            let force = law.formula.replace('|', "\\|");
            let force = force.split([';', ',']).next().unwrap();
            let row = format!(
                "| `{}` | {}",
                law.name,
                force.replace(" with μ(v) = friction.formula", "")
            );
            assert_contains(include_str!("../../docs/laws.md"), &row);
        }
    }
}

#[test]
fn losses_act_without_sliding_friction() {
    // Rolling resistance has the form of the paper's friction with arm k R.
    let coulomb = Run::with("full-coulomb", &[("stop.duration", "5")]);
    let arm = format!("{:?}", 0.03 * 0.007);
    let keys = [("rolling.arm", &*arm), ("stop.duration", "5")];
    let rolling = Run::with("frictionless", &keys);
    for (a, b) in coulomb.samples.iter().zip(&rolling.samples) {
        assert_near("θ", a.angles.theta, b.angles.theta, 1e-11);
        assert_near("E", a.energy.total(), b.energy.total(), 1e-12);
        assert_eq!(b.slip.friction_force.norm(), 0.0);
    }
}

#[test]
fn formulations_agree_on_derivatives_at_rest() {
    let model = balanced("0.3").model;
    let angles = Euler {
        phi: 0.3,
        theta: 0.5,
        psi: 0.2,
    };
    let rates = Euler {
        phi: 50.0,
        ..Euler::default()
    };
    let phase = Phase::Sticking;
    let euler = EulerAngles {
        model: model.clone(),
        phase,
    };
    let body = BodyRotation::new(model.clone(), phase);
    let y: [f64; EulerAngles::STATE_LENGTH] = EulerAngles::state(angles, rates, &model);
    let z: [f64; BodyRotation::STATE_LENGTH] = BodyRotation::state(angles, rates, &model);
    // dL_z/dt = I φ̈, and the work is that of the air.
    let (s, c) = libm::sincos(0.5);
    let moment = model.top.vertical_moment(s, c);
    let (dy, dz) = (euler.derivative(0.0, &y), body.derivative(0.0, &z));
    assert_near("torque", dy[3] * moment, dz[6], 1e-18);
    assert_near("power", dy[6], dz[7], 1e-15);
    let entered = euler.enter(Guard::Grip, &y, angles).unwrap();
    assert_eq!(entered.state[4..6], [0.0, 0.0]);
    // What a state carries along changes nothing of what it describes.
    let y: [f64; EulerAngles::SHORT_STATE_LENGTH] = EulerAngles::state(angles, rates, &model);
    let z: [f64; BodyRotation::SHORT_STATE_LENGTH] = BodyRotation::state(angles, rates, &model);
    assert_eq!(euler.derivative(0.0, &y), dy[..y.len()]);
    assert_eq!(body.derivative(0.0, &z), dz[..z.len()]);
}

#[test]
fn unfinished_nutation_is_not_counted() {
    for (preset, duration) in [("stribeck", "2"), ("paper", "6.75")] {
        let run = Run::with(preset, &[("stop.duration", duration)]);
        assert_eq!(run.end.nutations, run.cycles.len() as u64, "{preset}");
    }
}

#[test]
fn val_drilling_stops_the_spin_of_an_upright_free_top() {
    let changes = [
        ("friction.law", "none"),
        ("friction.k", ""),
        ("friction.viscous_speed", ""),
        ("friction.dissipation", ""),
        ("initial.theta", "0"),
        ("initial.psi_dot", "2"),
        ("initial.phi_dot", "0"),
        ("drilling.k", "1"),
        ("drilling.patch_radius", "1e-3"),
        ("stop.theta_risen", ""),
        ("stop.duration", "1"),
    ];
    let scenario = scenario("free-viscous", &changes);
    let top = scenario.model.top;
    let slowing = 3.0 * PI / 16.0 * top.weight() * 1e-3 / top.axial_moment;
    let run = Run::of(&scenario);
    // An upright top that doesn't turn needs no friction to stay so.
    assert_eq!(run.end.stop, StopReason::Rest);
    assert_near("end", run.end.time, 2.0 / slowing, 1e-10);
    assert_eq!(run.end.motion.tilt.omega_lean, Vector3::zeros());
    for sample in &run.samples {
        let left = (2.0 - slowing * (sample.time_ns as f64 / 1e9)).max(0.0);
        assert_near("spin", sample.pose.omega_world.z, left, 1e-10);
    }
    assert!(run.end.statistics.accepted < 1000);
}
