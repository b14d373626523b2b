//! The equations of motion of a top whose peg's centre stays in place.
//!
//! A [`Model`] holds the physics that every formulation shares: the forces, the torques and the
//! terms of the Euler accelerations. A [`Formulation`] chooses the variables in which the motion is
//! integrated:
//!
//! * [`EulerAngles`]: the paper's equations (7) as printed; singular upright.
//! * [`BodyRotation`]: orientation and angular momentum; regular everywhere.
//!
//! The function that gives the friction to the integrator, [`Friction::contact`], is the one whose
//! numbers are logged.

#![allow(
    clippy::inline_always,
    reason = "with hints alone the friction is called and not unrolled into the derivative, and runs take a quarter longer"
)]

mod body;
mod euler;

pub use body::BodyRotation;
pub use euler::EulerAngles;

use crate::physics::friction::{Contact, Friction, Grip};
use crate::physics::kinematics::{Euler, Tilt};
use crate::physics::top::Top;
use nalgebra::{UnitQuaternion, Vector3};

/// How many running integrals travel with the motion: see [`Integrals`].
pub const INTEGRALS: usize = 3;

/// A top and the friction that acts on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Model {
    /// The rigid body and gravity.
    pub top: Top,
    /// The friction at its contact.
    pub friction: Friction,
}

/// What the contact point does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Regime {
    /// It slips, or no friction keeps it from doing so.
    #[default]
    Slipping,
    /// It stays at rest: the top turns about the vertical as a whole.
    Sticking,
}

/// Integrals over the motion so far, from the start of the run. They are carried along by the
/// integrator and never influence the motion.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Integrals {
    /// Work that friction did on the top, J (negative where it took energy).
    pub friction_work: f64,
    /// Length of the path that the contact point slipped over the table, m.
    pub slip_path: f64,
    /// ∫ θ dt, rad s.
    pub theta: f64,
}

/// The motion at one instant, whatever the formulation that computed it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Euler angles, rad; φ and ψ unwrapped.
    pub angles: Euler,
    /// Inclination and angular velocity.
    pub tilt: Tilt,
    /// Integrals since the start.
    pub integrals: Integrals,
}

/// The Euler accelerations, term by term, rad/s²: the paper's equations (7).
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Accelerations {
    /// The terms with the axial angular momentum `I_z (ψ̇ + φ̇ cos θ)`.
    pub gyroscopic: Euler,
    /// The terms quadratic in the rates without `I_z`: centrifugal in θ̈, Coriolis in φ̈ and ψ̈.
    pub inertial: Euler,
    /// The terms of gravity (in θ̈ only).
    pub gravitational: Euler,
    /// The terms of friction.
    pub frictional: Euler,
}

impl Accelerations {
    /// The whole Euler accelerations, rad/s².
    #[must_use]
    #[inline]
    pub fn total(&self) -> Euler {
        let sum = |part: fn(&Euler) -> f64| {
            part(&self.gyroscopic)
                + part(&self.inertial)
                + part(&self.gravitational)
                + part(&self.frictional)
        };
        Euler {
            phi: sum(|e| e.phi),
            theta: sum(|e| e.theta),
            psi: sum(|e| e.psi),
        }
    }
}

impl Model {
    /// The contact in the state `tilt`. The peg's centre is fixed, so the table carries the weight.
    #[must_use]
    #[inline(always)]
    pub fn contact(&self, tilt: &Tilt) -> Contact {
        self.friction.contact(&self.top, self.top.weight(), tilt)
    }

    /// What it takes to keep the contact point at rest in the state `tilt`.
    #[must_use]
    #[inline(never)]
    pub fn grip(&self, tilt: &Tilt) -> Grip {
        self.friction.grip(&self.top, self.top.weight(), tilt)
    }

    /// Torque of friction about the peg's centre in the lean frame, N m.
    #[must_use]
    #[inline(always)]
    pub fn friction_torque(&self, contact: &Contact, tilt: &Tilt) -> Vector3<f64> {
        self.friction.torque(&self.top, contact, tilt)
    }

    /// The Euler accelerations, term by term.
    ///
    /// Upright, where φ and ψ have no meaning of their own, their accelerations are 0 but for
    /// the friction about the vertical.
    #[must_use]
    #[inline(always)]
    pub fn accelerations(&self, contact: &Contact, tilt: &Tilt) -> Accelerations {
        let Tilt {
            sin, cos, rates, ..
        } = *tilt;
        let frictional = self.friction.euler_accelerations(&self.top, contact, tilt);
        if tilt.is_upright() {
            return Accelerations {
                frictional,
                ..Accelerations::default()
            };
        }
        let axial = self.top.axial_moment * (rates.psi + rates.phi * cos);
        let gyroscopic = axial / self.top.transverse_moment;
        let nutation_over_sine = rates.theta / sin;
        let precession_gyroscopic = nutation_over_sine * gyroscopic;
        let precession_coriolis = -2.0 * nutation_over_sine * rates.phi * cos;
        Accelerations {
            gyroscopic: Euler {
                phi: precession_gyroscopic,
                theta: -rates.phi * sin * gyroscopic,
                psi: -precession_gyroscopic * cos,
            },
            inertial: Euler {
                phi: precession_coriolis,
                theta: rates.phi * rates.phi * sin * cos,
                psi: rates.theta * rates.phi * sin - precession_coriolis * cos,
            },
            gravitational: Euler {
                theta: self.top.gravity_moment() * sin / self.top.transverse_moment,
                ..Euler::default()
            },
            frictional,
        }
    }

    /// What the running integrals grow by per second: W, m/s and rad.
    #[inline]
    fn integrands(
        &self,
        contact: &Contact,
        friction_torque: &Vector3<f64>,
        tilt: &Tilt,
        theta: f64,
    ) -> [f64; INTEGRALS] {
        [
            friction_torque.dot(&tilt.omega_lean),
            contact.slip_speed,
            theta,
        ]
    }
}

/// A choice of variables for the equations of motion, with `N` numbers as state, of which the last
/// [`INTEGRALS`] are the running integrals.
pub trait Formulation<const N: usize>: crate::physics::integrate::System<N> + Copy {
    /// The state at the start from Euler angles (rad) and rates (rad/s).
    fn state(angles: Euler, rates: Euler, model: &Model) -> [f64; N];

    /// The motion that a state describes. `reference` are Euler angles of a moment ago, from which φ
    /// and ψ go on without jumps of whole turns.
    fn motion(&self, state: &[f64; N], reference: Euler) -> Motion;

    /// The orientation in a state: turns body components into world components.
    fn world_from_body(&self, state: &[f64; N]) -> UnitQuaternion<f64>;

    /// The physics.
    fn model(&self) -> &Model;

    /// What the contact point does.
    fn regime(&self) -> Regime;

    /// The same equations in a regime.
    fn in_regime(self, regime: Regime) -> Self;

    /// The state with the contact point brought to rest at the same angular momentum about the vertical.
    fn brought_to_rest(&self, state: &[f64; N]) -> [f64; N];
}

/// The running integrals at the end of a state vector.
#[inline]
fn integrals<const N: usize>(state: &[f64; N]) -> Integrals {
    Integrals {
        friction_work: state[N - 3],
        slip_path: state[N - 2],
        theta: state[N - 1],
    }
}
