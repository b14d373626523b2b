//! The paper's own variables: Euler angles and their rates, equations (7).

use super::fixed::{self, FixedPeg};
use super::formulation::{Entered, Formulation, Guard, Started};
use super::integrals::{
    FEW_INTEGRALS, INTEGRALS, Integrals, first_integrals, integrals, with_integrals,
};
use super::model::Model;
use super::motion::{Motion, Peg, Start};
use super::support::Phase;
use crate::physics::integrate::System;
use crate::physics::kinematics::{Euler, Tilt, world_from_body};
use crate::physics::math::{array, sin_cos};
use nalgebra::UnitQuaternion;

/// Equations (7) in Euler angles, as printed. Singular at θ = 0 and θ = π.
///
/// State: φ, θ, ψ (rad), φ̇, θ̇, ψ̇ (rad/s), then the running integrals.
#[derive(Clone, Debug)]
pub struct EulerAngles {
    /// The physics.
    pub model: Model,
    /// Phase of the contact point. While it sticks, θ and ψ are constant. While friction prevents turning about the
    /// vertical, φ̇ follows from ψ̇.
    pub phase: Phase,
}

impl EulerAngles {
    /// Number of state components for the motion; the running integrals follow.
    const VARIABLES: usize = 6;
    /// State length with all running integrals.
    pub const STATE_LENGTH: usize = Self::VARIABLES + INTEGRALS;
    /// State length with only the integrals that an outcome needs.
    pub const SHORT_STATE_LENGTH: usize = Self::VARIABLES + FEW_INTEGRALS;
}

impl<const N: usize> System<N> for EulerAngles {
    const CONTROLLED: usize = Self::VARIABLES;

    #[inline(always)]
    fn derivative(&self, _t: f64, y: &[f64; N]) -> [f64; N] {
        const {
            assert!(N == Self::STATE_LENGTH || N == Self::SHORT_STATE_LENGTH);
        }
        if N == Self::STATE_LENGTH {
            self.slope::<N, INTEGRALS>(y)
        } else {
            self.slope::<N, FEW_INTEGRALS>(y)
        }
    }
}

/// The time derivatives of the rates and of the running integrals.
///
/// The field order is a performance optimisation: it lets the compiler store as pairs what the integrator loads as
/// pairs (store-to-load forwarding).
#[repr(C)]
struct Derivatives<const I: usize> {
    theta_dot: f64,
    psi_dot: f64,
    integrals: [f64; I],
    phi_dot: f64,
}

impl EulerAngles {
    #[inline(always)]
    fn slope<const N: usize, const I: usize>(&self, y: &[f64; N]) -> [f64; N] {
        let rates = self.rates(y);
        let derivatives = self.derivatives::<I>(y[1], rates.phi, rates.theta, rates.psi);
        let first = [
            rates.phi,
            rates.theta,
            rates.psi,
            derivatives.phi_dot,
            derivatives.theta_dot,
            derivatives.psi_dot,
        ];
        array(|i| match i.checked_sub(first.len()) {
            None => first[i],
            Some(integral) => derivatives.integrals[integral],
        })
    }

    /// Not inlined, so that arguments are passed in registers; see [`Derivatives`].
    #[inline(never)]
    fn derivatives<const I: usize>(
        &self,
        theta: f64,
        phi_dot: f64,
        theta_dot: f64,
        psi_dot: f64,
    ) -> Derivatives<I> {
        let tilt = Tilt::from_rates(theta, Euler::new(phi_dot, theta_dot, psi_dot));
        let contact = self.model.contact(&tilt);
        let terms = self.model.accelerations(&contact, &tilt);
        let mut acceleration = terms.total();
        if self.phase == Phase::Sticking {
            (acceleration.theta, acceleration.psi) = (0.0, 0.0);
        }
        let torque = self.model.friction_torque(&contact, &tilt);
        let integrands = if I == INTEGRALS {
            Model::integrands(&contact, &torque, &tilt, &terms, theta)
        } else {
            Model::outcome_integrands(&contact, &torque, &tilt)
        };
        Derivatives {
            theta_dot: acceleration.theta,
            psi_dot: acceleration.psi,
            integrals: first_integrals(&integrands),
            phi_dot: acceleration.phi,
        }
    }

    /// The Euler rates, rad/s.
    #[inline(always)]
    fn rates<const N: usize>(&self, y: &[f64; N]) -> Euler {
        if self.model.holds_turning() {
            not_turning(y[1], rates(y))
        } else {
            rates(y)
        }
    }

    /// The state at the start from Euler angles (rad) and rates (rad/s).
    pub fn state<const N: usize>(angles: Euler, rates: Euler, _model: &Model) -> [f64; N] {
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
}

impl<const N: usize> FixedPeg<N> for EulerAngles {
    fn with_model(&self, model: Model, phase: Phase) -> Self {
        Self { model, phase }
    }

    fn at_rest(&self, y: &[f64; N], turns: bool) -> [f64; N] {
        if !turns {
            return with_rates(y, Euler::default());
        }
        let top = &self.model.top;
        let tilt = Tilt::from_rates(y[1], rates(y));
        let vertical = tilt.node_to_lean(&top.angular_momentum_node(&tilt)).z;
        let mut rested = *y;
        rested[3] = vertical / top.vertical_moment(tilt.sin, tilt.cos);
        (rested[4], rested[5]) = (0.0, 0.0);
        rested
    }

    fn without_turning(&self, y: &[f64; N]) -> [f64; N] {
        with_rates(y, not_turning(y[1], rates(y)))
    }
}

impl<const N: usize> Formulation<N> for EulerAngles {
    fn start(model: &Model, start: &Start) -> Started<Self, N> {
        let state = Self::state(start.angles, start.rates, model);
        let (model, phase) = (model.clone(), Phase::Sliding);
        fixed::start(&Self { model, phase }, state, start)
    }

    #[inline]
    fn motion_without_turns(&self, y: &[f64; N], _reference: Euler) -> Motion {
        // φ and ψ are part of the state.
        let angles = angles(y);
        Motion {
            angles,
            tilt: Tilt::from_rates(angles.theta, self.rates(y)),
            peg: Peg::fixed(self.model.top.peg_radius),
            phase: self.phase,
            branch: self.model.friction.branch,
            integrals: integrals::<{ Self::VARIABLES }, N>(y),
        }
    }

    fn angles(&self, y: &[f64; N], _reference: Euler) -> Euler {
        angles(y)
    }

    fn world_from_body(&self, y: &[f64; N]) -> UnitQuaternion<f64> {
        world_from_body(angles(y))
    }

    fn model(&self) -> &Model {
        &self.model
    }

    fn phase(&self) -> Phase {
        self.phase
    }

    fn guards(&self) -> Vec<Guard> {
        let mut guards = fixed::guards(&self.model, self.phase);
        if self.phase == Phase::Sliding {
            guards.push(Guard::Regular);
        }
        guards
    }

    fn guard(&self, guard: Guard, motion: &Motion) -> f64 {
        fixed::guard(&self.model, guard, &motion.tilt)
    }

    fn enter(&self, guard: Guard, y: &[f64; N], reference: Euler) -> Entered<Self, N> {
        Ok(fixed::enter(self, guard, y, reference))
    }
}

#[inline]
fn angles<const N: usize>(y: &[f64; N]) -> Euler {
    Euler::new(y[0], y[1], y[2])
}

/// These rates with the φ̇ of a top that does not turn about the vertical: `φ̇ = −ψ̇ cos θ`.
#[cold]
fn not_turning(theta: f64, rates: Euler) -> Euler {
    Euler {
        phi: -rates.psi * sin_cos(theta).1,
        ..rates
    }
}

fn with_rates<const N: usize>(y: &[f64; N], rates: Euler) -> [f64; N] {
    let mut state = *y;
    state[3..6].copy_from_slice(&[rates.phi, rates.theta, rates.psi]);
    state
}

#[inline]
fn rates<const N: usize>(y: &[f64; N]) -> Euler {
    Euler::new(y[3], y[4], y[5])
}
