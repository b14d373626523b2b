//! The physics shared by all formulations.

use super::accelerations::{Accelerations, accelerations_about, inertial_terms_with_gravity};
use super::integrals::{Integrals, TermIntegrals};
use super::motion::{Motion, Start};
use super::reaction::{FreeBody, Inertia};
use super::support::{Phase, Support};
use crate::physics::friction::{Contact, Friction, Grip, Turning};
use crate::physics::kinematics::{Euler, Tilt};
use crate::physics::top::{PrecessionRoots, Top};
use nalgebra::Vector3;

/// A top with its friction and support.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// The rigid body and gravity.
    pub top: Top,
    /// The friction at its contact.
    pub friction: Friction,
    /// Support of the peg.
    pub support: Support,
}

impl Model {
    /// The state of the contact for a motion.
    pub fn contact_in(&self, motion: &Motion) -> Contact {
        // The model of a scenario is not on the branches of a phase.
        if self.friction.branch != motion.branch {
            let friction = self.friction.on_branch(motion.branch);
            return Self { friction, ..*self }.contact_in(motion);
        }
        if !self.support.is_free() {
            return self.contact(&motion.tilt);
        }
        let slip = match motion.phase {
            Phase::Sticking => Vector3::zeros(),
            Phase::Sliding | Phase::Flying => motion.slip_velocity(&self.top),
        };
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
        let inertia = Inertia::new(&self.top);
        FreeBody::new(&self.top, &self.friction, &inertia, motion.tilt)
            .departing(motion.peg.departure.as_ref())
    }

    /// The Euler accelerations in a motion with this contact, rad/s².
    ///
    /// [`Model::accelerations`] assumes that the peg's centre does not accelerate. For a free peg, the accelerations
    /// are computed about the centre of mass instead.
    pub fn euler_accelerations(&self, contact: &Contact, motion: &Motion) -> Euler {
        let tilt = &motion.tilt;
        if !self.support.is_free() {
            return self.accelerations(contact, tilt).total();
        }
        let central = self.top.about_center();
        let force = contact.force + Vector3::new(0.0, 0.0, contact.normal_force);
        let losses = contact.losses.unwrap_or_default();
        let torque = self.free_body(motion).arm.cross(&force) + losses;
        accelerations_about(&central, &tilt.lean_to_node(&torque), tilt).total()
    }

    /// Angular momentum about the centre of the peg in the node frame, kg m²/s.
    pub fn momentum_node(&self, motion: &Motion) -> Vector3<f64> {
        if !self.support.is_free() {
            return self.top.angular_momentum_node(&motion.tilt);
        }
        let center = self.top.center_distance * motion.tilt.axis();
        let velocity = motion.center_velocity_lean(&self.top);
        let momentum = self.central_momentum_lean(motion) + self.top.mass * center.cross(&velocity);
        motion.tilt.lean_to_node(&momentum)
    }

    /// Power of friction, W.
    pub fn friction_power(&self, contact: &Contact, tilt: &Tilt) -> f64 {
        if !self.support.is_free() {
            return self.friction_torque(contact, tilt).dot(&tilt.omega_lean);
        }
        let losses = contact.losses.unwrap_or_default();
        contact.force.dot(&contact.slip) + losses.dot(&tilt.omega_lean)
    }

    /// Angular momentum about the centre of mass in the lean frame, kg m²/s.
    pub fn central_momentum_lean(&self, motion: &Motion) -> Vector3<f64> {
        let momentum = self.top.about_center().angular_momentum_node(&motion.tilt);
        motion.tilt.node_to_lean(&momentum)
    }

    /// The top with the moments of inertia about the point about which it nutates: the centre of a fixed peg, or the
    /// centre of mass.
    pub fn nutating_top(&self) -> Top {
        if self.support.is_free() {
            self.top.about_center()
        } else {
            self.top
        }
    }

    /// The equivalent top with a fixed peg for nutation while rolling, at this cos θ; exact for small nutations near
    /// the vertical.
    ///
    /// With the height `h = R + l cos θ` of the centre of mass its moments of inertia are `A + M h²`, about the contact
    /// point, and `I_z + M R h`: because of rolling, the centre of mass circles with the spin.
    pub fn rolling_top(&self, cos: f64) -> Top {
        let top = &self.top;
        let height = top.peg_radius + top.center_distance * cos;
        Top {
            transverse_moment: top.central_moment() + top.mass * height * height,
            axial_moment: top.axial_moment + top.mass * top.peg_radius * height,
            ..*top
        }
    }

    /// The period of nutation without friction in a motion with these least and greatest θ (rad), s: see
    /// [`Top::nutation_period`]. `None` if the motion is not periodic.
    pub fn nutation_period(&self, motion: &Motion, extremes: [f64; 2]) -> Option<f64> {
        let top = if self.rolls(motion.phase) {
            self.rolling_top(motion.tilt.cos)
        } else {
            self.nutating_top()
        };
        top.nutation_period(&motion.tilt, extremes)
    }

    /// The rates of regular precession at this inclination and spin rate: [`Top::precession_roots`] for a fixed peg or
    /// frictionless sliding.
    ///
    /// For a rolling peg, with the height `h = R + l cos θ` of the centre of mass, they are the roots of
    /// `((A − I_z) cos θ + M l h) φ̇² − (I_z + M R h) ψ̇ φ̇ + M g l = 0`: the centre of mass moves in a circle, and
    /// friction provides the centripetal force.
    ///
    /// In the air no torque acts about the centre of mass: the slow rate is 0, and the fast one is that of a top without
    /// gravity.
    pub fn precession_roots(&self, tilt: &Tilt, phase: Phase) -> Option<PrecessionRoots> {
        let top = &self.top;
        if phase == Phase::Flying {
            let weightless = Top {
                gravity: 0.0,
                ..self.nutating_top()
            };
            let fast = weightless.precession_roots(tilt)?.fast;
            // The slow root would be −0 for a negative spin.
            return Some(PrecessionRoots { slow: 0.0, fast });
        }
        if !self.rolls(phase) {
            return self.nutating_top().precession_roots(tilt);
        }
        let moment = top.mass * (top.peg_radius + top.center_distance * tilt.cos);
        let quadratic =
            (top.central_moment() - top.axial_moment) * tilt.cos + top.center_distance * moment;
        let spin = (top.axial_moment + top.peg_radius * moment) * tilt.rates.psi;
        PrecessionRoots::new(quadratic, spin, top.gravity_moment())
    }

    /// Whether the peg rolls in a phase.
    fn rolls(&self, phase: Phase) -> bool {
        self.support.is_free() && phase == Phase::Sticking
    }

    /// Jellett's integral `l L_n + R L_z′` about the centre of mass, kg m³/s: not changed by any force at the contact
    /// point (J. H. Jellett, A Treatise on the Theory of Friction, 1872).
    pub fn jellett(&self, motion: &Motion) -> f64 {
        let momentum = self.central_momentum_lean(motion);
        let axial = momentum.dot(&motion.tilt.axis());
        self.top.center_distance * axial + self.top.peg_radius * momentum.z
    }

    /// Routh's integral of a rolling top, kg m²/s: `L_n/I_z · √(A I_z + M I_z (l + R cos θ)² + M A R² sin² θ)` with the
    /// transverse moment `A` about the centre of mass.
    pub fn routh(&self, motion: &Motion) -> f64 {
        let tilt = &motion.tilt;
        tilt.axial_rate() * self.top.rolling_moments(tilt.sin, tilt.cos).sqrt()
    }

    /// Kinetic energy in a motion, J.
    pub fn kinetic_energy(&self, motion: &Motion) -> f64 {
        if !self.support.is_free() {
            return self.top.kinetic_energy(&motion.tilt);
        }
        let velocity = motion.center_velocity_lean(&self.top);
        self.top.about_center().kinetic_energy(&motion.tilt)
            + 0.5 * self.top.mass * velocity.norm_squared()
    }

    /// Potential energy in a motion, J; zero if the centre of mass is at z = R, the height of the centre of a peg on
    /// the table.
    pub fn potential_energy(&self, motion: &Motion) -> f64 {
        let above_peg = self.top.potential_energy(&motion.tilt);
        match self.support {
            Support::FixedPeg => above_peg,
            Support::FreePeg { .. } => {
                let gap = motion.peg.position.z - self.top.peg_radius;
                above_peg + self.top.weight() * gap
            }
        }
    }

    /// Upper bound of the slip speed in a motion that gains no energy, m/s.
    pub fn largest_slip_speed(&self, start: &Start) -> f64 {
        let top = self.nutating_top();
        let tilt = Tilt::from_rates(start.angles.theta, start.rates);
        let distance = top.center_distance.abs();
        let height = start.peg_position.z - top.peg_radius;
        // Above the lowest place that the centre of mass may have.
        let drop = height + top.center_distance * tilt.cos + distance;
        let energy = top.kinetic_energy(&tilt) + top.weight() * drop;
        let least_moment = top.transverse_moment.min(top.axial_moment);
        if !self.support.is_free() {
            return top.peg_radius * (2.0 * energy / least_moment).sqrt();
        }
        let center = top.center_distance * tilt.omega_lean.cross(&tilt.axis());
        let speed = start.peg_velocity.norm() + center.norm();
        let energy = energy + 0.5 * top.mass * speed * speed;
        (2.0 * energy / top.mass).sqrt()
            + (top.peg_radius + distance) * (2.0 * energy / least_moment).sqrt()
    }

    /// Total energy in a motion, J.
    pub fn energy(&self, motion: &Motion) -> f64 {
        self.kinetic_energy(motion) + self.potential_energy(motion)
    }

    /// The contact of a fixed peg in the state `tilt`; the normal force equals the weight.
    #[inline(always)]
    pub fn contact(&self, tilt: &Tilt) -> Contact {
        let contact = self.friction.contact(&self.top, self.top.weight(), tilt);
        if self.holds_turning() {
            self.with_holding_torque(contact, tilt)
        } else {
            contact
        }
    }

    /// Whether friction holds a top with a fixed peg that doesn't turn about the vertical.
    #[inline(always)]
    pub fn holds_turning(&self) -> bool {
        self.friction.branch.turning == Turning::Held
    }

    /// The contact of a fixed peg with the drilling torque that prevents turning about the vertical.
    #[cold]
    fn with_holding_torque(&self, contact: Contact, tilt: &Tilt) -> Contact {
        let torque = self.top.gravity_torque(tilt) + self.friction_torque(&contact, tilt);
        let acceleration = self.top.angular_acceleration(&torque, tilt).z;
        let holding = -acceleration / self.turning_response(tilt);
        let losses = contact.losses.unwrap_or_default() + Vector3::new(0.0, 0.0, holding);
        Contact {
            losses: Some(losses),
            ..contact
        }
    }

    /// Angular acceleration about the vertical per torque about the vertical, 1/(kg m²).
    fn turning_response(&self, tilt: &Tilt) -> f64 {
        let cos_squared = tilt.cos * tilt.cos;
        cos_squared / self.top.axial_moment + (1.0 - cos_squared) / self.top.transverse_moment
    }

    /// Angular acceleration about the vertical that a fixed peg would have without the torque that prevents turning,
    /// rad/s².
    pub(super) fn turning_acceleration(&self, tilt: &Tilt) -> f64 {
        // A held top has no drilling torque of its own: only the balance determines it.
        let held = self.with_turning(Turning::Held);
        let contact = held.friction.contact(&self.top, self.top.weight(), tilt);
        let torque = self.top.gravity_torque(tilt) + self.friction_torque(&contact, tilt);
        self.top.angular_acceleration(&torque, tilt).z
    }

    /// Margin of the drilling friction that prevents turning about the vertical, N m; negative if it yields.
    pub(super) fn turning_margin(&self, tilt: &Tilt) -> f64 {
        let required = self.turning_acceleration(tilt) / self.turning_response(tilt);
        self.friction.drilling_bound(self.top.weight(), false) - required.abs()
    }

    /// The torque that keeps the contact point at rest in the state `tilt`, and its bound.
    #[inline(never)]
    pub fn grip(&self, tilt: &Tilt) -> Grip {
        self.friction.grip(&self.top, self.top.weight(), tilt)
    }

    /// Torque of friction about the peg's centre in the lean frame, N m.
    #[inline(always)]
    pub fn friction_torque(&self, contact: &Contact, tilt: &Tilt) -> Vector3<f64> {
        self.friction.torque(&self.top, contact, tilt)
    }

    /// The Euler accelerations, term by term.
    ///
    /// Upright, where φ and ψ are undefined, φ̈ and ψ̈ are 0 except for friction about the vertical.
    #[inline(always)]
    pub fn accelerations(&self, contact: &Contact, tilt: &Tilt) -> Accelerations {
        let frictional = self.friction.euler_accelerations(&self.top, contact, tilt);
        Accelerations {
            frictional,
            ..inertial_terms_with_gravity(&self.top, tilt)
        }
    }

    /// Rates of the running integrals that an outcome needs, [`FEW_INTEGRALS`](super::FEW_INTEGRALS); 0 for the others.
    #[inline(always)]
    pub(super) fn outcome_integrands(
        contact: &Contact,
        friction_torque: &Vector3<f64>,
        tilt: &Tilt,
    ) -> Integrals {
        Integrals {
            friction_work: friction_torque.dot(&tilt.omega_lean),
            slip_path: contact.slip_speed,
            ..Integrals::default()
        }
    }

    /// Rates of change of the running integrals.
    #[inline(always)]
    pub(super) fn integrands(
        contact: &Contact,
        friction_torque: &Vector3<f64>,
        tilt: &Tilt,
        accelerations: &Accelerations,
        theta: f64,
    ) -> Integrals {
        let torque = tilt.lean_to_node(friction_torque);
        Integrals {
            theta,
            work_node: torque.component_mul(&tilt.omega_node()),
            slip_work: contact.force.dot(&contact.slip),
            terms: TermIntegrals::rates(accelerations, tilt),
            ..Self::outcome_integrands(contact, friction_torque, tilt)
        }
    }
}
