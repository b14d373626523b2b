//! Laws that hold in every state.

use crate::support::{Run, sliding_friction};
use nalgebra::Vector3;
use proptest::prelude::*;
use toprise::physics::dynamics::{BodyRotation, EulerAngles, Formulation, Model, Phase, Support};
use toprise::physics::friction::{Dissipation, FrictionLaw};
use toprise::physics::integrate::System;
use toprise::physics::kinematics::{
    Euler, Tilt, euler_angles, lean_to_world, node_to_body, world_from_body,
};
use toprise::physics::top::Top;

fn angles() -> impl Strategy<Value = Euler> {
    (-3.0..3.0, 0.05..3.09, -3.0..3.0).prop_map(|(phi, theta, psi)| Euler { phi, theta, psi })
}

fn rates() -> impl Strategy<Value = Euler> {
    (-20.0..20.0, -20.0..20.0, -300.0..300.0).prop_map(|(phi, theta, psi)| Euler {
        phi,
        theta,
        psi,
    })
}

fn dissipation() -> impl Strategy<Value = Dissipation> {
    prop_oneof![
        Just(Dissipation::Full),
        Just(Dissipation::WithoutNutationPart),
        Just(Dissipation::PrecessionTermOnly),
        Just(Dissipation::SpinTermOnly),
    ]
}

fn model(dissipation: Dissipation, k: f64) -> Model {
    Model {
        top: Top {
            mass: 0.110,
            transverse_moment: 8.52e-5,
            axial_moment: 7.25e-5,
            center_distance: 0.020,
            peg_radius: 0.007,
            gravity: 9.81,
        },
        friction: sliding_friction(FrictionLaw::Coulomb { k }, dissipation),
        support: Support::FixedPeg,
    }
}

proptest! {
    #[test]
    fn quaternion_is_product_of_three_rotations(a in angles()) {
        use nalgebra::UnitQuaternion as Q;
        let about = |axis, angle| Q::from_axis_angle(&axis, angle);
        let product = about(Vector3::z_axis(), a.phi) * about(Vector3::x_axis(), a.theta)
            * about(Vector3::z_axis(), a.psi);
        prop_assert!(product.angle_to(&world_from_body(a)) < 1e-7);
        let q = world_from_body(a);
        let v = Vector3::new(0.3, -0.7, 0.2);
        prop_assert!((product * v - q * v).norm() < 1e-14);
    }

    #[test]
    fn euler_angles_round_trip_unwrapped(a in angles(), turns_phi in -5..5, turns_psi in -500..500) {
        let turn = std::f64::consts::TAU;
        let far = Euler {
            phi: a.phi + turn * f64::from(turns_phi),
            theta: a.theta,
            psi: a.psi + turn * f64::from(turns_psi),
        };
        let back = euler_angles(&world_from_body(far), far);
        for (x, y) in [(back.phi, far.phi), (back.theta, far.theta), (back.psi, far.psi)] {
            // ψ up to 3000 rad: sin and cos see it with an error of 3000 ε.
            prop_assert!((x - y).abs() < 4e-12, "{x} {y}");
        }
    }

    #[test]
    fn slip_velocity_is_omega_cross_r_and_equation_3(a in angles(), r in rates()) {
        let tilt = Tilt::from_rates(a.theta, r);
        let radius = 0.007;
        let slip = lean_to_world(&tilt.slip_velocity(radius), a.phi);
        let omega = lean_to_world(&tilt.omega_lean, a.phi);
        let crossed = omega.cross(&Vector3::new(0.0, 0.0, -radius));
        prop_assert!((slip - crossed).norm() < 1e-15);
        // The paper's equation (3), in body axes.
        let (s, c) = libm::sincos(a.theta);
        let (sp, cp) = libm::sincos(a.psi);
        let printed = radius * Vector3::new(
            r.theta * c * sp + r.psi * s * cp,
            r.theta * c * cp - r.psi * s * sp,
            -r.theta * s,
        );
        let body = node_to_body(&tilt.lean_to_node(&tilt.slip_velocity(radius)), a.psi);
        prop_assert!((body - printed).norm() < 1e-14);
        // Equation (2).
        let omega_body = node_to_body(&tilt.omega_node(), a.psi);
        let printed = Vector3::new(
            r.theta * cp + r.phi * s * sp,
            -r.theta * sp + r.phi * s * cp,
            r.psi + r.phi * c,
        );
        prop_assert!((omega_body - printed).norm() < 1e-12);
    }

    #[test]
    fn friction_is_equation_4_corrected(a in angles(), r in rates()) {
        // K/V (−θ̇ cosψ + ψ̇ s c sinψ, θ̇ sinψ + ψ̇ s c cosψ, −ψ̇ s²): the paper prints cot θ for cos θ in y.
        let model = model(Dissipation::Full, 0.03);
        let tilt = Tilt::from_rates(a.theta, r);
        let torque = model.friction_torque(&model.contact(&tilt), &tilt);
        let body = node_to_body(&tilt.lean_to_node(&torque), a.psi);
        let (s, c) = libm::sincos(a.theta);
        let (sp, cp) = libm::sincos(a.psi);
        let v = (r.theta * r.theta + r.psi * r.psi * s * s).sqrt();
        prop_assume!(v > 1e-3);
        let printed = 0.03 * 0.110 * 9.81 * 0.007 / v * Vector3::new(
            -r.theta * cp + r.psi * s * c * sp,
            r.theta * sp + r.psi * s * c * cp,
            -r.psi * s * s,
        );
        prop_assert!((body - printed).norm() < 1e-17);
        // Gravity, equation (5): −M g l s (−cosψ x + sinψ y).
        let gravity = node_to_body(&tilt.lean_to_node(&model.top.gravity_torque(&tilt)), a.psi);
        let printed = 0.110 * 9.81 * 0.020 * s * Vector3::new(cp, -sp, 0.0);
        prop_assert!((gravity - printed).norm() < 1e-16);
    }

    #[test]
    fn friction_dissipates_and_has_no_vertical_torque(
        a in angles(), r in rates(), k in 0.0..2.0,
        part in prop_oneof![Just(Dissipation::Full), Just(Dissipation::WithoutNutationPart)],
    ) {
        let model = model(part, k);
        let tilt = Tilt::from_rates(a.theta, r);
        let contact = model.contact(&tilt);
        let torque = model.friction_torque(&contact, &tilt);
        prop_assert!(torque.dot(&tilt.omega_lean) <= 0.0);
        prop_assert_eq!(torque.z, 0.0);
        prop_assert!(contact.force.norm() <= k * contact.normal_force * (1.0 + 1e-15));
        prop_assert!(contact.force.dot(&contact.slip) <= 0.0);
    }

    #[test]
    fn both_formulations_have_the_same_derivative(a in angles(), r in rates(), part in dissipation()) {
        // Take a tiny Euler step with each formulation's derivative and compare the motions.
        let model = model(part, 0.03);
        let phase = Phase::Sliding;
        let (euler, body) = (EulerAngles { model: model.clone(), phase }, BodyRotation::new(model.clone(), phase));
        let h = 1e-7;
        let y: [f64; EulerAngles::STATE_LENGTH] = EulerAngles::state(a, r, &model);
        let dy = euler.derivative(0.0, &y);
        let y_next: [f64; EulerAngles::STATE_LENGTH] = std::array::from_fn(|i| y[i] + h * dy[i]);
        let z: [f64; BodyRotation::STATE_LENGTH] = BodyRotation::state(a, r, &model);
        let dz = body.derivative(0.0, &z);
        let z_next: [f64; BodyRotation::STATE_LENGTH] = std::array::from_fn(|i| z[i] + h * dz[i]);
        let first = euler.motion(&y_next, a);
        let second = body.motion(&z_next, a);
        // Terms of order (h ω)², ω up to 600 rad/s (1/sin θ times the rates near upright): 4e-9.
        let s = libm::sin(a.theta);
        let tolerance = 4e-9 / (s * s);
        for (x, y, scale) in [
            (first.angles.theta, second.angles.theta, 1.0),
            (first.angles.phi, second.angles.phi, 1.0),
            (first.angles.psi, second.angles.psi, 1.0),
            (first.tilt.rates.theta, second.tilt.rates.theta, 1e3),
            (first.tilt.rates.phi, second.tilt.rates.phi, 1e3),
            (first.tilt.rates.psi, second.tilt.rates.psi, 1e3),
        ] {
            prop_assert!((x - y).abs() < scale * tolerance, "{x} {y}");
        }
        for i in 0..3 {
            let (x, y) = (dy[dy.len() - 3 + i], dz[dz.len() - 3 + i]);
            prop_assert!((x - y).abs() < 1e-10 * (1.0 + x.abs()), "{x} {y}");
        }
    }

    #[test]
    fn precession_roots_solve_their_equation(a in angles(), psi in -300.0..300.0_f64) {
        let top = model(Dissipation::Full, 0.0).top;
        let tilt = Tilt::from_rates(a.theta, Euler { phi: 0.0, theta: 0.0, psi });
        if let Some(roots) = top.precession_roots(&tilt) {
            for phi in [roots.slow, roots.fast] {
                let terms = [
                    (top.transverse_moment - top.axial_moment) * tilt.cos * phi * phi,
                    -top.axial_moment * psi * phi,
                    top.gravity_moment(),
                ];
                let scale: f64 = terms.iter().map(|term| term.abs()).sum();
                prop_assert!(terms.iter().sum::<f64>().abs() < 1e-14 * scale);
            }
            prop_assert!(roots.slow.abs() <= roots.fast.abs());
        }
    }
}

proptest! {
    // Each case is two runs.
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn mirrored_start_gives_mirrored_motion(theta in 0.2..1.2_f64, phi in 0.5..4.0_f64, psi in 100.0..200.0_f64) {
        let run = |sign: f64| Run::with("paper", &[
            ("initial.theta", &format!("{theta:?}")),
            ("initial.phi_dot", &format!("{:?}", sign * phi)),
            ("initial.psi_dot", &format!("{:?}", sign * psi)),
            ("stop.duration", "1"),
        ]);
        let (a, b) = (run(1.0), run(-1.0));
        for (a, b) in a.samples.iter().zip(&b.samples) {
            prop_assert_eq!(a.angles.theta, b.angles.theta);
            prop_assert_eq!(a.angles.phi, -b.angles.phi);
            prop_assert_eq!(a.angles.psi, -b.angles.psi);
        }
        let kinds = |run: &Run| run.events.iter().map(|e| (e.kind, e.time_ns)).collect::<Vec<_>>();
        prop_assert_eq!(kinds(&a), kinds(&b));
    }

    #[test]
    fn motion_depends_on_product_of_k_and_radius(scale in 0.5..2.0_f64) {
        let run = |k: f64, radius: f64| Run::with("paper", &[
            ("friction.k", &format!("{k:?}")),
            ("top.peg_radius", &format!("{radius:?}")),
            ("stop.duration", "2"),
        ]);
        let (a, b) = (run(0.03, 0.007), run(0.03 / scale, 0.007 * scale));
        for (a, b) in a.samples.iter().zip(&b.samples) {
            prop_assert!((a.angles.theta - b.angles.theta).abs() < 1e-12);
        }
    }

    #[test]
    fn gravity_scales_time(lambda in 0.5..2.0_f64) {
        // g → λ² g and rates → λ: the same motion, λ times as fast.
        let run = |lambda: f64| Run::with("paper", &[
            ("gravity", &format!("{:?}", 9.81 * lambda * lambda)),
            ("initial.phi_dot", &format!("{:?}", 1.75 * lambda)),
            ("initial.psi_dot", &format!("{:?}", 170.0 * lambda)),
            ("stop.duration", "60"),
        ]);
        let (a, b) = (run(1.0), run(lambda));
        let gap = a.end.time - b.end.time * lambda;
        prop_assert!(gap.abs() < 1e-8, "{gap}");
    }

    #[test]
    fn motion_is_independent_of_azimuth(phi in -3.0..3.0_f64, psi in -3.0..3.0_f64) {
        for formulation in ["euler", "body"] {
            let run = |phi: f64, psi: f64| Run::with("paper", &[
                ("formulation", formulation),
                ("initial.phi", &format!("{phi:?}")),
                ("initial.psi", &format!("{psi:?}")),
                ("stop.duration", "2"),
            ]);
            let (a, b) = (run(0.0, 0.0), run(phi, psi));
            for (a, b) in a.samples.iter().zip(&b.samples) {
                prop_assert!((a.angles.theta - b.angles.theta).abs() < 1e-11);
                prop_assert!((a.angles.phi + phi - b.angles.phi).abs() < 1e-10);
            }
        }
    }

    #[test]
    fn frictionless_motion_is_reversible(theta in 0.2..1.2_f64, phi in 0.5..4.0_f64) {
        let there = Run::with("frictionless", &[
            ("initial.theta", &format!("{theta:?}")),
            ("initial.phi_dot", &format!("{phi:?}")),
            ("stop.duration", "1"),
        ]);
        let end = there.samples.last().unwrap();
        let back = Run::with("frictionless", &[
            ("initial.theta", &format!("{:?}", end.angles.theta)),
            ("initial.theta_dot", &format!("{:?}", -end.tilt.rates.theta)),
            ("initial.phi_dot", &format!("{:?}", -end.tilt.rates.phi)),
            ("initial.psi_dot", &format!("{:?}", -end.tilt.rates.psi)),
            ("stop.duration", "1"),
        ]);
        let home = back.samples.last().unwrap();
        prop_assert!((home.angles.theta - theta).abs() < 1e-10);
        prop_assert!((home.tilt.rates.phi + phi).abs() < 1e-8);
    }
}
