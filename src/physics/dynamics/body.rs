//! The singularity-free formulation: quaternion and angular momentum.

use super::fixed::{self, FixedPeg};
use super::formulation::{Entered, Formulation, Guard, Started};
use super::integrals::{FEW_INTEGRALS, INTEGRALS, Integrals, integrals, with_integrals};
use super::lean::{Lean, quaternion};
use super::model::Model;
use super::motion::{Motion, Peg, Start};
use super::support::Phase;
use crate::physics::friction::Turning;
use crate::physics::integrate::System;
use crate::physics::kinematics::{
    Euler, Tilt, euler_angles, inclination, lean_to_world, world_from_body,
};
use crate::physics::math::atan2;
use crate::physics::top::Top;
use nalgebra::{Quaternion, Unit, UnitQuaternion, Vector3};
use std::f64::consts::SQRT_2;

/// The motion as a rotation of the body: regular in every orientation.
///
/// State: quaternion x, y, z, w (transforms body to world components), angular momentum about the peg's centre in world
/// components (kg m²/s, divided by a unit that follows the top), then the running integrals.
///
/// The world-frame angular momentum varies only with the slow precession, which allows longer steps than the body-frame
/// angular velocity, and its conserved components stay exactly constant. The quaternion norm drifts by rounding only;
/// it is divided out on use.
#[derive(Clone, Debug)]
pub struct BodyRotation {
    /// The physics.
    pub model: Model,
    /// Phase of the contact point. While it sticks, only the vertical angular momentum is used; the other components
    /// follow from it. While friction prevents turning about the vertical, only the horizontal components are used.
    pub phase: Phase,
    /// See [`momentum_unit`].
    momentum_unit: f64,
}

impl BodyRotation {
    /// The equations of a model in a phase.
    pub fn new(model: Model, phase: Phase) -> Self {
        let momentum_unit = momentum_unit(&model.top);
        Self {
            model,
            phase,
            momentum_unit,
        }
    }

    /// Number of state components for the motion; the running integrals follow.
    const VARIABLES: usize = 7;
    /// State length with all running integrals.
    pub const STATE_LENGTH: usize = Self::VARIABLES + INTEGRALS;
    /// State length with only the integrals that an outcome needs.
    pub const SHORT_STATE_LENGTH: usize = Self::VARIABLES + FEW_INTEGRALS;

    /// Angular velocity in the lean frame, rad/s: `ω = L/I_x + (1/I_z − 1/I_x)(L·n) n`.
    #[inline]
    fn tilt(&self, lean: &Lean, momentum: &Vector3<f64>) -> Tilt {
        let top = &self.model.top;
        if self.phase == Phase::Sticking {
            let rate = momentum.z / top.vertical_moment(lean.sin, lean.cos);
            return Tilt::from_omega(lean.sin, lean.cos, Vector3::new(0.0, 0.0, rate));
        }
        let momentum_lean = lean.world_to_lean(momentum);
        if self.model.holds_turning() {
            let omega = top.rocking_rate(&momentum_lean, lean.sin, lean.cos);
            return Tilt::from_omega(lean.sin, lean.cos, omega);
        }
        let axial = lean.sin * momentum_lean.x + lean.cos * momentum_lean.z;
        let excess = axial * (1.0 / top.axial_moment - 1.0 / top.transverse_moment);
        let omega =
            momentum_lean / top.transverse_moment + excess * Vector3::new(lean.sin, 0.0, lean.cos);
        Tilt::from_omega(lean.sin, lean.cos, omega)
    }
}

impl<const N: usize> System<N> for BodyRotation {
    const CONTROLLED: usize = Self::VARIABLES;

    #[inline]
    fn derivative(&self, _t: f64, y: &[f64; N]) -> [f64; N] {
        let q = quaternion(y);
        let lean = Lean::new(&q, |_| self.momentum(y));
        let tilt = self.tilt(&lean, &self.momentum(y));
        let contact = self.model.contact(&tilt);
        let friction = self.model.friction_torque(&contact, &tilt);
        let torque = lean.lean_to_world(&(self.model.top.gravity_torque(&tilt) + friction))
            / self.momentum_unit;
        let omega = lean.lean_to_world(&tilt.omega_lean);
        let turning = Quaternion::from_imag(omega) * q * 0.5;
        let integrands = if N == Self::STATE_LENGTH {
            let theta = atan2(lean.sin, lean.cos);
            let terms = self.model.accelerations(&contact, &tilt);
            Model::integrands(&contact, &friction, &tilt, &terms, theta)
        } else {
            Model::outcome_integrands(&contact, &friction, &tilt)
        };
        let first = [
            turning.i, turning.j, turning.k, turning.w, torque.x, torque.y, torque.z,
        ];
        with_integrals(first, &integrands)
    }
}

impl BodyRotation {
    /// The state at the start from Euler angles (rad) and rates (rad/s).
    pub fn state<const N: usize>(angles: Euler, rates: Euler, model: &Model) -> [f64; N] {
        let q = world_from_body(angles);
        let tilt = Tilt::from_rates(angles.theta, rates);
        let momentum_lean = tilt.node_to_lean(&model.top.angular_momentum_node(&tilt));
        let momentum = lean_to_world(&momentum_lean, angles.phi) / momentum_unit(&model.top);
        let first = [q.i, q.j, q.k, q.w, momentum.x, momentum.y, momentum.z];
        with_integrals(first, &Integrals::default())
    }

    /// The angular momentum in a state, or the torque in its derivative; world frame, kg m²/s or N m.
    #[inline]
    fn momentum<const N: usize>(&self, y: &[f64; N]) -> Vector3<f64> {
        Vector3::new(y[4], y[5], y[6]) * self.momentum_unit
    }

    /// The state with another angular momentum (world frame, kg m²/s).
    fn with_momentum<const N: usize>(&self, y: &[f64; N], momentum: &Vector3<f64>) -> [f64; N] {
        let mut state = *y;
        state[4..7].copy_from_slice((momentum / self.momentum_unit).as_slice());
        state
    }
}

impl<const N: usize> FixedPeg<N> for BodyRotation {
    fn with_model(&self, model: Model, phase: Phase) -> Self {
        Self::new(model, phase)
    }

    fn at_rest(&self, y: &[f64; N], turns: bool) -> [f64; N] {
        if !turns {
            return self.with_momentum(y, &Vector3::zeros());
        }
        let lean = Lean::new(&quaternion(y), |_| self.momentum(y));
        let held = Self::new(self.model.clone(), Phase::Sticking);
        let tilt = held.tilt(&lean, &self.momentum(y));
        let top = &self.model.top;
        let momentum = lean.lean_to_world(&top.turning_momentum(&tilt, tilt.omega_lean.z));
        let mut rested = *y;
        rested[4] = momentum.x / self.momentum_unit;
        rested[5] = momentum.y / self.momentum_unit;
        rested
    }

    fn without_turning(&self, y: &[f64; N]) -> [f64; N] {
        let lean = Lean::new(&quaternion(y), |_| self.momentum(y));
        let held = Self::new(self.model.with_turning(Turning::Held), Phase::Sliding);
        let tilt = held.tilt(&lean, &self.momentum(y));
        let momentum_lean = tilt.node_to_lean(&self.model.top.angular_momentum_node(&tilt));
        self.with_momentum(y, &lean.lean_to_world(&momentum_lean))
    }
}

impl<const N: usize> Formulation<N> for BodyRotation {
    fn start(model: &Model, start: &Start) -> Started<Self, N> {
        let state = Self::state(start.angles, start.rates, model);
        let (model, phase) = (model.clone(), Phase::Sliding);
        fixed::start(&Self::new(model, phase), state, start)
    }

    fn angles(&self, y: &[f64; N], reference: Euler) -> Euler {
        let q = quaternion(y);
        let lean = Lean::new(&q, |_| self.momentum(y));
        euler_angles(&q, lean.unwrap_reference(reference))
    }

    fn motion_without_turns(&self, y: &[f64; N], reference: Euler) -> Motion {
        let q = quaternion(y);
        let lean = Lean::new(&q, |_| self.momentum(y));
        let mut tilt = self.tilt(&lean, &self.momentum(y));
        if tilt.is_upright() {
            let per_moment = 1.0 / self.model.top.transverse_moment;
            let torque = self.momentum(&self.derivative(0.0, y));
            tilt = lean.rates_at_vertical(
                tilt,
                &(self.momentum(y) * per_moment),
                &(torque * per_moment),
            );
        }
        Motion {
            angles: Euler {
                theta: inclination(&q),
                ..reference
            },
            tilt,
            peg: Peg::fixed(self.model.top.peg_radius),
            phase: self.phase,
            branch: self.model.friction.branch,
            integrals: integrals::<{ Self::VARIABLES }, N>(y),
        }
    }

    fn world_from_body(&self, y: &[f64; N]) -> UnitQuaternion<f64> {
        Unit::new_normalize(quaternion(y))
    }

    fn model(&self) -> &Model {
        &self.model
    }

    fn phase(&self) -> Phase {
        self.phase
    }

    fn guards(&self) -> Vec<Guard> {
        fixed::guards(&self.model, self.phase)
    }

    fn guard(&self, guard: Guard, motion: &Motion) -> f64 {
        fixed::guard(&self.model, guard, &motion.tilt)
    }

    fn enter(&self, guard: Guard, y: &[f64; N], reference: Euler) -> Entered<Self, N> {
        Ok(fixed::enter(self, guard, y, reference))
    }
}

/// Transverse moment of inertia of the paper's top, kg m².
const PAPER_MOMENT: f64 = 8.52e-5;

/// Unit of the angular momentum in the state, kg m²/s: the power of two nearest to the ratio of the top's moment of
/// inertia to that of the paper's top.
///
/// The integrator's absolute tolerance acts on the state. In this unit it allows all tops about the same error of the
/// angular velocity, whatever their mass and size: the motion of a fixed peg doesn't depend on the mass. A power of two
/// scales without rounding, and it is 1 for the paper's top.
fn momentum_unit(top: &Top) -> f64 {
    const EXPONENT: u64 = 0x7FF0_0000_0000_0000;
    // Rounded down, powers of two would change at ratios of 1, 2, 4, … instead of halfway between them.
    let ratio = SQRT_2 * (top.transverse_moment / PAPER_MOMENT);
    f64::from_bits(ratio.clamp(f64::MIN_POSITIVE, f64::MAX).to_bits() & EXPONENT)
}
