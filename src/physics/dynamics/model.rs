//! The physics that every formulation shares: a top, its friction, and the accelerations that follow.

#![allow(
    clippy::inline_always,
    reason = "with hints alone the friction is called and not unrolled into the derivative, and runs take a quarter longer"
)]

use super::accelerations::{Accelerations, accelerations_about, inertial_terms_with_gravity};
use super::integrals::{Integrals, TermIntegrals};
use super::motion::Motion;
use super::reaction::{FreeBody, Inertia};
use super::support::Support;
use crate::physics::friction::{Contact, Friction, Grip};
use crate::physics::kinematics::Tilt;
use crate::physics::top::Top;
use nalgebra::Vector3;

/// A top, the friction that acts on it, and how the table holds it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Model {
    /// The rigid body and gravity.
    pub top: Top,
    /// The friction at its contact.
    pub friction: Friction,
    /// How the table holds the peg.
    pub support: Support,
}

/// The torques on a top in the lean frame, N m, about the point to which its support refers them: the centre of the peg
/// if that is fixed, the centre of mass if it is free.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torques {
    /// Of gravity.
    pub gravity: Vector3<f64>,
    /// Of the normal force.
    pub normal: Vector3<f64>,
    /// Of friction, the losses with it.
    pub friction: Vector3<f64>,
}

impl Model {
    /// The contact in a motion.
    #[must_use]
    pub fn contact_in(&self, motion: &Motion) -> Contact {
        if !self.support.is_free() {
            return self.contact(&motion.tilt);
        }
        let slip = motion.slip_velocity(&self.top);
        let body = self.free_body(motion);
        let reaction = body.reaction(motion.phase, &motion.law_slip(&slip));
        let losses = reaction.friction.couple + reaction.air;
        Contact {
            slip,
            slip_speed: slip.norm(),
            normal_force: reaction.normal,
            force: reaction.friction.force,
            losses: self.friction.has_losses().then_some(losses),
        }
    }

    fn free_body(&self, motion: &Motion) -> FreeBody<'_> {
        let inertia = Inertia::of(&self.top);
        FreeBody::new(&self.top, &self.friction, &inertia, motion.tilt)
    }

    /// The torques in a motion with this contact.
    #[must_use]
    pub fn torques(&self, contact: &Contact, motion: &Motion) -> Torques {
        if !self.support.is_free() {
            return Torques {
                gravity: self.top.gravity_torque(&motion.tilt),
                normal: Vector3::zeros(),
                friction: self.friction_torque(contact, &motion.tilt),
            };
        }
        let arm = self.free_body(motion).arm;
        Torques {
            gravity: Vector3::zeros(),
            normal: arm.cross(&Vector3::new(0.0, 0.0, contact.normal_force)),
            friction: arm.cross(&contact.force) + contact.losses.unwrap_or_default(),
        }
    }

    /// The Euler accelerations in a motion with this contact, term by term. Of a top with a free peg the gravitational
    /// term is that of the table's normal force, which turns it about its centre of mass.
    #[must_use]
    pub fn accelerations_in(&self, contact: &Contact, motion: &Motion) -> Accelerations {
        let tilt = &motion.tilt;
        if !self.support.is_free() {
            return self.accelerations(contact, tilt);
        }
        let torques = self.torques(contact, motion);
        let central = self.top.about_center();
        let friction = tilt.lean_to_node(&torques.friction);
        let mut terms = accelerations_about(&central, &friction, tilt);
        if !tilt.is_upright() {
            terms.gravitational.theta = torques.normal.y / central.transverse_moment;
        }
        terms
    }

    /// Kinetic energy in a motion, J.
    #[must_use]
    pub fn kinetic_energy(&self, motion: &Motion) -> f64 {
        if !self.support.is_free() {
            return self.top.kinetic_energy(&motion.tilt);
        }
        let velocity = motion.center_velocity_lean(&self.top);
        self.top.about_center().kinetic_energy(&motion.tilt)
            + 0.5 * self.top.mass * velocity.norm_squared()
    }

    /// Potential energy in a motion, J: zero at the height of the peg's centre if that is fixed, on the table if it is
    /// free.
    #[must_use]
    pub fn potential_energy(&self, motion: &Motion) -> f64 {
        let above_peg = self.top.potential_energy(&motion.tilt);
        match self.support {
            Support::FixedPeg => above_peg,
            Support::FreePeg { .. } => above_peg + self.top.weight() * motion.peg.position.z,
        }
    }

    /// Total energy in a motion, J.
    #[must_use]
    pub fn energy(&self, motion: &Motion) -> f64 {
        self.kinetic_energy(motion) + self.potential_energy(motion)
    }

    /// The contact in the state `tilt`, if the peg's centre is fixed: the table carries the weight.
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
        let frictional = self.friction.euler_accelerations(&self.top, contact, tilt);
        Accelerations {
            frictional,
            ..inertial_terms_with_gravity(&self.top, tilt)
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
            terms: TermIntegrals::of(accelerations, tilt),
        }
    }
}
