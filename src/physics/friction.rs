//! Friction forces and torques, and the parts of them that enter the equations of motion.
//!
//! [`FrictionLaw`] computes the sliding friction force. [`Losses`] are torques independent of slip: rolling resistance,
//! drilling, air drag. [`Dissipation`] selects components of the sliding friction torque.

mod branch;
mod breakaway;
mod dissipation;
mod law;
mod losses;
mod patch;

pub use branch::{Branch, Rocking, Turning};
pub(crate) use breakaway::BREAKAWAY_SPEED;
pub use dissipation::Dissipation;
pub use law::{FrictionLaw, Smoothing, drilling_torque};
pub(crate) use losses::NO_ROLLING;
pub use losses::{Air, Drilling, Losses};
pub(crate) use patch::PatchDirection;

use crate::physics::kinematics::Tilt;
use crate::physics::math::hypot;
use crate::physics::top::Top;
use nalgebra::Vector3;
use std::ops::Mul;

/// State of the contact. Vectors are in the lean frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Slip velocity of the contact point over the table, m/s.
    pub slip: Vector3<f64>,
    /// Magnitude of the slip velocity, m/s.
    pub slip_speed: f64,
    /// Normal force, N.
    pub normal_force: f64,
    /// Friction force of the law, N (without the nutation component if the model omits it).
    pub force: Vector3<f64>,
    /// Torque in addition to that of the force, N m: rolling resistance, drilling, air drag. `None` if there are no
    /// such losses.
    pub losses: Option<Vector3<f64>>,
}

/// A force and a couple at the point of contact: in N and N m, or per unit normal force (dimensionless and m).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// The force, horizontal.
    pub force: Vector3<f64>,
    /// The couple.
    pub couple: Vector3<f64>,
}

impl Mul<f64> for Wrench {
    type Output = Self;

    #[inline]
    fn mul(self, factor: f64) -> Self {
        Self {
            force: self.force * factor,
            couple: self.couple * factor,
        }
    }
}

/// A sliding law, its included components, and the losses.
#[derive(Clone, Debug, PartialEq)]
pub struct Friction {
    /// The law of sliding.
    pub law: FrictionLaw,
    /// The included components.
    pub dissipation: Dissipation,
    /// Torques of the losses.
    pub losses: Option<Losses>,
    /// The branches of the set-valued torques.
    pub branch: Branch,
}

/// The force and torque that keep a contact point at rest, and their bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grip {
    /// The required friction torque about the peg's centre, lean frame, N m.
    pub required: Vector3<f64>,
    /// The maximum friction torque, N m.
    pub maximum: f64,
}

impl Grip {
    /// Whether the contact point stays at rest.
    pub fn holds(&self) -> bool {
        self.maximum > 0.0 && self.margin() >= 0.0
    }

    /// Margin of the static torque, N m; negative if it yields.
    pub fn margin(&self) -> f64 {
        self.maximum - self.required.norm()
    }

    /// The friction torque: the required torque, limited to the maximum, N m.
    fn torque(&self) -> Vector3<f64> {
        let required = self.required.norm();
        if required > self.maximum {
            self.required * (self.maximum / required)
        } else {
            self.required
        }
    }
}

impl Friction {
    /// The contact of `top` in the state `tilt` under the normal force `normal_force` (N).
    #[inline(always)]
    pub fn contact(&self, top: &Top, normal_force: f64, tilt: &Tilt) -> Contact {
        let mut contact = self.contact_by_law(top, normal_force, tilt);
        // The slip stays that of the motion; only the direction of friction is another.
        if self.branch.rocking == Rocking::Breakaway {
            let acting = self.breakaway_tilt(top, normal_force, tilt);
            let Contact { force, losses, .. } = self.contact_by_law(top, normal_force, &acting);
            (contact.force, contact.losses) = (force, losses);
        }
        contact
    }

    /// The contact with the friction of the law, in the direction of the slip.
    #[inline(always)]
    fn contact_by_law(&self, top: &Top, normal_force: f64, tilt: &Tilt) -> Contact {
        let slip = tilt.slip_velocity(top.peg_radius);
        let slip_speed = top.slip_speed(tilt);
        let axis = tilt.axis();
        let losses = self.torque_of_losses(slip_speed, normal_force, tilt.omega_lean, axis);
        let (force, losses) = if slip_speed > 0.0 {
            (self.force(&slip, slip_speed, normal_force, tilt), losses)
        } else {
            self.held(top, normal_force, *tilt, losses)
        };
        Contact {
            slip,
            slip_speed,
            normal_force,
            force,
            losses,
        }
    }

    /// Friction per unit normal force for a slip velocity (m/s) and an angular velocity `omega` (rad/s), both in the
    /// lean frame. All contact friction is proportional to the normal force; air drag is not.
    ///
    /// At rest the sliding force is 0 here; the static friction of a set-valued law is computed separately.
    #[inline(always)]
    pub fn per_normal_force(&self, slip: &Vector3<f64>, omega: &Vector3<f64>) -> Wrench {
        let speed = (slip.x * slip.x + slip.y * slip.y).sqrt();
        let force = if speed > 0.0 {
            -self.law.resistance(speed, omega.z, 1.0) * slip
        } else {
            Vector3::zeros()
        };
        let mut couple = self.losses.map_or_else(Vector3::zeros, |losses| {
            losses.contact_torque(1.0, omega, &self.branch)
        });
        if let FrictionLaw::Contensou { k, patch_radius } = self.law {
            let rate = match self.branch.turning {
                Turning::Held => 0.0,
                Turning::Any | Turning::Forward | Turning::Backward => omega.z,
            };
            couple.z += drilling_torque(k, patch_radius, 1.0, speed, rate);
        }
        Wrench { force, couple }
    }

    /// Torque of the air, N m, in the frame of the angular velocity (rad/s) and the symmetry axis.
    #[inline]
    pub fn torque_of_air(&self, omega: &Vector3<f64>, axis: &Vector3<f64>) -> Vector3<f64> {
        self.losses
            .map_or_else(Vector3::zeros, |losses| losses.air.torque(omega, axis))
    }

    /// Sliding friction force, N.
    #[inline(always)]
    fn force(
        &self,
        slip: &Vector3<f64>,
        slip_speed: f64,
        normal_force: f64,
        tilt: &Tilt,
    ) -> Vector3<f64> {
        let drilling = tilt.omega_lean.z;
        let mut force = -self.law.resistance(slip_speed, drilling, normal_force) * slip;
        if self.dissipation != Dissipation::Full {
            force.x = 0.0;
        }
        force
    }

    /// Whether the torque on a fixed peg is discontinuous at zero slip.
    #[inline]
    pub fn is_set_valued(&self) -> bool {
        self.law.static_bound_at(1.0, 0.0) + self.rolling_arm() > 0.0
    }

    /// Whether the force of the law is discontinuous only where the top doesn't turn about the vertical either: the
    /// contact patch then comes to rest as a whole.
    pub fn rests_as_a_whole(&self) -> bool {
        matches!(self.law, FrictionLaw::Contensou { .. }) && self.is_set_valued()
    }

    /// Speed of the contact patch, m/s: 0 only where the force of the law is discontinuous.
    #[inline]
    pub fn patch_speed(&self, slip_speed: f64, turning_rate: f64) -> f64 {
        let FrictionLaw::Contensou { patch_radius, .. } = self.law else {
            return slip_speed;
        };
        hypot(slip_speed, patch_radius * turning_rate)
    }

    /// Bound of the set-valued torque about the vertical, N m; 0 if the torque is continuous. Coulomb–Contensou
    /// friction is set-valued only while the contact point is at rest.
    pub fn drilling_bound(&self, normal_force: f64, is_at_rest: bool) -> f64 {
        let of_losses = self
            .losses
            .map_or(0.0, |losses| losses.drilling.bound(normal_force));
        if let FrictionLaw::Contensou { k, patch_radius } = self.law
            && is_at_rest
        {
            return of_losses - drilling_torque(k, patch_radius, normal_force, 0.0, 1.0);
        }
        of_losses
    }

    /// The same friction on other branches.
    #[inline]
    pub fn on_branch(&self, branch: Branch) -> Self {
        Self {
            law: self.law.clone(),
            branch,
            ..*self
        }
    }

    /// Whether friction can hold the contact point of a free peg. With Coulomb–Contensou friction, it holds only a
    /// contact patch that doesn't turn either.
    #[inline]
    pub fn holds_slip(&self) -> bool {
        self.law.static_bound_at(1.0, 0.0) > 0.0
    }

    /// Whether the sliding force is discontinuous at zero slip, whatever the rate about the vertical.
    #[inline]
    pub fn is_set_valued_at_rest(&self) -> bool {
        self.law.static_bound(1.0) > 0.0
    }

    /// Whether the contact point can stick: the law is set-valued and no component is dropped.
    #[inline]
    pub fn can_stick(&self) -> bool {
        self.dissipation == Dissipation::Full && self.is_set_valued()
    }

    /// The force and torque that keep the contact point at rest while the top turns about the vertical as a whole.
    ///
    /// Without losses it is `((I_z − I_x) Ω² cos θ − M g l) sin θ` about the line of nodes.
    pub fn grip(&self, top: &Top, normal_force: f64, tilt: &Tilt) -> Grip {
        let omega = Vector3::new(0.0, 0.0, tilt.omega_lean.z);
        let losses = self
            .torque_of_losses(0.0, normal_force, omega, tilt.axis())
            .unwrap_or_default();
        let required = top.turning_torque(tilt, losses.z) - top.gravity_torque(tilt) - losses;
        Grip {
            required: Vector3::new(required.x, required.y, 0.0),
            maximum: top.peg_radius * self.static_force(normal_force, tilt)
                + self.rolling_arm() * normal_force,
        }
    }

    /// Bound of the static force on a fixed peg, N.
    #[inline]
    fn static_force(&self, normal_force: f64, tilt: &Tilt) -> f64 {
        // Only whether the top turns matters here, which the branch says exactly.
        let rate = self.branch.turning.rate_of(tilt.omega_lean.z);
        self.law.static_bound_at(normal_force, rate)
    }

    /// Arm of rolling resistance, m.
    #[inline]
    pub fn rolling_arm(&self) -> f64 {
        self.losses.map_or(0.0, |losses| losses.rolling_arm)
    }

    /// Static force and losses, which share the required torque. Not inlined, because it is rare.
    #[cold]
    fn held(
        &self,
        top: &Top,
        normal_force: f64,
        tilt: Tilt,
        losses: Option<Vector3<f64>>,
    ) -> (Vector3<f64>, Option<Vector3<f64>>) {
        if !self.can_stick() {
            return (Vector3::zeros(), losses);
        }
        let grip = self.grip(top, normal_force, &tilt);
        let torque = grip.torque();
        if grip.maximum == 0.0 {
            return (Vector3::zeros(), losses);
        }
        // Sliding friction and rolling resistance carry the torque in proportion to their bounds.
        let share = top.peg_radius * self.static_force(normal_force, &tilt) / grip.maximum;
        let force = share / top.peg_radius * Vector3::new(-torque.y, torque.x, 0.0);
        (force, losses.map(|losses| losses + (1.0 - share) * torque))
    }

    /// Torque of friction about the peg's centre in addition to that of the force, N m, in any frame whose z axis is
    /// vertical, from slip speed (m/s), normal force (N), and in that frame angular velocity (rad/s) and direction of the
    /// symmetry axis. `None` if there are no losses.
    #[inline(always)]
    pub fn torque_of_losses(
        &self,
        slip_speed: f64,
        normal_force: f64,
        omega: Vector3<f64>,
        axis: Vector3<f64>,
    ) -> Option<Vector3<f64>> {
        // Keep rare losses out of the inner loop.
        self.has_losses()
            .then(|| self.sum_of_losses(slip_speed, normal_force, omega, axis))
    }

    #[inline(never)]
    fn sum_of_losses(
        &self,
        slip_speed: f64,
        normal_force: f64,
        omega: Vector3<f64>,
        axis: Vector3<f64>,
    ) -> Vector3<f64> {
        let mut torque = self.losses.map_or_else(Vector3::zeros, |losses| {
            losses.torque(normal_force, &omega, &axis, &self.branch)
        });
        if let FrictionLaw::Contensou { k, patch_radius } = self.law {
            // Only without slip does the torque jump where the top stops turning.
            let rate = if slip_speed == 0.0 {
                self.branch.turning.rate_of(omega.z)
            } else {
                omega.z
            };
            torque.z += drilling_torque(k, patch_radius, normal_force, slip_speed, rate);
        }
        torque
    }

    /// Whether there is no friction and no other loss.
    pub fn is_none(&self) -> bool {
        self.law.is_none() && self.losses.is_none_or(|losses| losses.is_none())
    }

    /// Whether there is friction at the point of contact: sliding, rolling resistance or drilling.
    pub fn acts_at_contact(&self) -> bool {
        let at_contact = Losses {
            air: Air::default(),
            ..self.losses.unwrap_or_default()
        };
        !self.law.is_none() || !at_contact.is_none()
    }

    /// Whether there is air drag.
    pub fn has_air_drag(&self) -> bool {
        self.losses
            .is_some_and(|losses| losses.air != Air::default())
    }

    /// Whether there are torques in addition to that of the force: [`Contact::losses`].
    #[inline]
    pub fn has_losses(&self) -> bool {
        self.losses.is_some() || matches!(self.law, FrictionLaw::Contensou { .. })
    }

    /// Whether a torque about the vertical acts.
    pub fn turns_about_vertical(&self) -> bool {
        let drills = matches!(self.law, FrictionLaw::Contensou { .. }) && !self.law.is_none();
        !self.dissipation.is_of_force()
            || drills
            || self
                .losses
                .is_some_and(|losses| losses.turns_about_vertical())
    }
}
