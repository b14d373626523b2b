//! The physics that every formulation shares: a top, its friction, and the accelerations that follow.

#![allow(
    clippy::inline_always,
    reason = "with hints alone the friction is called and not unrolled into the derivative, and runs take a quarter longer"
)]

use super::integrals::{Integrals, TERMS_SINE, TermIntegrals};
use crate::physics::friction::{Contact, Friction, Grip};
use crate::physics::kinematics::{Euler, Tilt};
use crate::physics::top::Top;
use nalgebra::Vector3;

/// A top and the friction that acts on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Model {
    /// The rigid body and gravity.
    pub top: Top,
    /// The friction at its contact.
    pub friction: Friction,
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

    /// What the running integrals grow by per second.
    #[inline(always)]
    pub(super) fn integrands(
        &self,
        contact: &Contact,
        friction_torque: &Vector3<f64>,
        tilt: &Tilt,
        accelerations: &Accelerations,
        theta: f64,
    ) -> Integrals {
        let torque = tilt.lean_to_node(friction_torque);
        Integrals {
            friction_work: friction_torque.dot(&tilt.omega_lean),
            slip_path: contact.slip_speed,
            theta,
            work_node: torque.component_mul(&tilt.omega_node()),
            slip_work: contact.force.dot(&contact.slip),
            terms: if tilt.sin > TERMS_SINE {
                TermIntegrals {
                    phi_gyroscopic: accelerations.gyroscopic.phi,
                    phi_coriolis: accelerations.inertial.phi,
                    phi_frictional: accelerations.frictional.phi,
                    psi_frictional: accelerations.frictional.psi,
                }
            } else {
                TermIntegrals::default()
            },
        }
    }
}
