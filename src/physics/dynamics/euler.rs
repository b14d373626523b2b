//! The paper's own variables: Euler angles and their rates, equations (7).

#![allow(
    clippy::inline_always,
    reason = "the derivative is unrolled where it is called with few integrals, so that the others cost nothing"
)]

use super::bounds::EulerBounds;
use super::fixed::{self, FixedPeg};
use super::formulation::{Entry, Formulation, Guard, Passage};
use super::integrals::{INTEGRALS, Integrals, Kept, integrals, with_integrals};
use super::model::Model;
use super::motion::{Motion, Peg, Start};
use super::support::Phase;
use crate::physics::integrate::{Dense, IntegrateError, System};
use crate::physics::kinematics::{Euler, Tilt, world_from_body};
use nalgebra::UnitQuaternion;

/// Equations (7) in Euler angles, as printed. Singular at θ = 0 and θ = π.
///
/// State: φ, θ, ψ (rad), φ̇, θ̇, ψ̇ (rad/s), then the running integrals.
#[derive(Clone, Copy, Debug)]
pub struct EulerAngles {
    /// The physics.
    pub model: Model,
    /// What the contact point does. Where it sticks, θ and ψ stay as they are.
    pub phase: Phase,
}

impl EulerAngles {
    /// Slipping.
    #[must_use]
    pub fn new(model: Model) -> Self {
        Self {
            model,
            phase: Phase::Sliding,
        }
    }
}

const SIZE: usize = 6 + INTEGRALS;

impl System<SIZE> for EulerAngles {
    const CONTROLLED: usize = 6;

    #[inline]
    fn derivative(&self, _t: f64, y: &[f64; SIZE]) -> [f64; SIZE] {
        self.slope(y, Kept::All)
    }
}

impl EulerAngles {
    /// The state at the start from Euler angles (rad) and rates (rad/s).
    #[must_use]
    pub fn state(angles: Euler, rates: Euler, _model: &Model) -> [f64; SIZE] {
        let first = [
            angles.phi,
            angles.theta,
            angles.psi,
            rates.phi,
            rates.theta,
            rates.psi,
        ];
        with_integrals(first, &Integrals::default())
    }

    /// The state with the contact point brought to rest at the same angular momentum about the vertical.
    #[must_use]
    pub fn brought_to_rest(&self, y: &[f64; SIZE]) -> [f64; SIZE] {
        let top = &self.model.top;
        let tilt = Tilt::from_rates(y[1], rates(y));
        let vertical = tilt.node_to_lean(&top.angular_momentum_node(&tilt)).z;
        let mut rested = *y;
        rested[3] = vertical / top.vertical_moment(tilt.sin, tilt.cos);
        (rested[4], rested[5]) = (0.0, 0.0);
        rested
    }
}

impl FixedPeg<SIZE> for EulerAngles {
    fn in_phase(self, phase: Phase) -> Self {
        Self { phase, ..self }
    }

    fn rested(&self, y: &[f64; SIZE]) -> [f64; SIZE] {
        self.brought_to_rest(y)
    }
}

impl Formulation<SIZE> for EulerAngles {
    fn start(model: &Model, start: &Start, may_hold: bool) -> (Self, [f64; SIZE], Option<Passage>) {
        let state = Self::state(start.angles, start.rates, model);
        fixed::start(Self::new(*model), state, start, may_hold)
    }

    #[inline(always)]
    fn slope(&self, y: &[f64; SIZE], kept: Kept) -> [f64; SIZE] {
        let rates = rates(y);
        let tilt = Tilt::from_rates(y[1], rates);
        let contact = self.model.contact(&tilt);
        let terms = self.model.accelerations(&contact, &tilt);
        let mut acceleration = terms.total();
        if self.phase == Phase::Holding {
            (acceleration.theta, acceleration.psi) = (0.0, 0.0);
        }
        let torque = self.model.friction_torque(&contact, &tilt);
        let integrands = match kept {
            Kept::All => self
                .model
                .integrands(&contact, &torque, &tilt, &terms, y[1]),
            Kept::Few => self.model.few_integrands(&contact, &torque, &tilt),
        };
        let first = [
            rates.phi,
            rates.theta,
            rates.psi,
            acceleration.phi,
            acceleration.theta,
            acceleration.psi,
        ];
        with_integrals(first, &integrands)
    }

    #[inline]
    fn motion_without_turns(&self, y: &[f64; SIZE], _reference: Euler) -> Motion {
        // Here φ and ψ cost nothing.
        let angles = angles(y);
        Motion {
            angles,
            tilt: Tilt::from_rates(angles.theta, rates(y)),
            peg: Peg::fixed(self.model.top.peg_radius),
            phase: self.phase,
            integrals: integrals(y),
        }
    }

    fn angles(&self, y: &[f64; SIZE], _reference: Euler) -> Euler {
        angles(y)
    }

    #[inline]
    fn bounds<const M: usize>(&self, step: &Dense<M>) -> Option<EulerBounds> {
        Some(EulerBounds::of(step))
    }

    fn world_from_body(&self, y: &[f64; SIZE]) -> UnitQuaternion<f64> {
        world_from_body(angles(y))
    }

    fn model(&self) -> &Model {
        &self.model
    }

    fn phase(&self) -> Phase {
        self.phase
    }

    fn guards(&self) -> &'static [Guard] {
        match (self.phase, self.model.friction.is_set_valued()) {
            (Phase::Sliding, true) => &[Guard::Slip, Guard::Regular],
            (Phase::Sliding, false) => &[Guard::Regular],
            _ => &[Guard::Grip],
        }
    }

    fn guard(&self, guard: Guard, motion: &Motion) -> f64 {
        fixed::guard(&self.model, guard, &motion.tilt)
    }

    fn guard_is_positive(&self, guard: Guard, bounds: &EulerBounds) -> bool {
        fixed::guard_is_positive(&self.model, guard, bounds)
    }

    fn enter(
        &self,
        guard: Guard,
        y: &[f64; SIZE],
        reference: Euler,
    ) -> Result<Entry<Self, SIZE>, IntegrateError> {
        Ok(fixed::enter(self, guard, y, reference))
    }
}

#[inline]
fn angles(y: &[f64; SIZE]) -> Euler {
    Euler {
        phi: y[0],
        theta: y[1],
        psi: y[2],
    }
}

#[inline]
fn rates(y: &[f64; SIZE]) -> Euler {
    Euler {
        phi: y[3],
        theta: y[4],
        psi: y[5],
    }
}
