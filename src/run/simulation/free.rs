//! Quantities of a top with a free peg, in addition to those of all tops.

use crate::physics::dynamics::{Dissipated, Impact, Model, Motion, Phase};
use crate::physics::friction::Contact;
use crate::physics::kinematics::{Euler, lean_to_world};
use nalgebra::Vector3;

/// The motion of the peg and the centre of mass at one instant. SI units and radians; vectors in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeSample {
    /// Phase of the contact point.
    pub phase: Phase,
    /// Height of the peg above the table, m.
    pub gap: f64,
    /// Velocity of the peg's centre, m/s.
    pub peg_velocity: Vector3<f64>,
    /// Position of the centre of mass, m.
    pub center: Vector3<f64>,
    /// Velocity of the centre of mass, m/s.
    pub center_velocity: Vector3<f64>,
    /// Acceleration of the centre of mass, m/s².
    pub center_acceleration: Vector3<f64>,
    /// Angular momentum about the centre of mass, kg m²/s.
    pub central_momentum: Vector3<f64>,
    /// Jellett's integral: see [`Model::jellett`].
    pub jellett: f64,
    /// Routh's integral: see [`Model::routh`].
    pub routh: f64,
    /// Kinetic energy of the centre of mass, J.
    pub translational_energy: f64,
    /// Contribution of the acceleration of the peg to the Euler accelerations, rad/s².
    pub driven: Euler,
    /// Energy lost since the start except by sliding.
    pub dissipated: Dissipated,
}

impl FreeSample {
    /// Computes the sample; `None` for a fixed peg.
    pub(super) fn new(model: &Model, motion: &Motion, contact: &Contact) -> Option<Self> {
        if !model.support.is_free() {
            return None;
        }
        let top = &model.top;
        let phi = motion.angles.phi;
        let center_velocity = lean_to_world(&motion.center_velocity_lean(top), phi);
        let force = contact.force + Vector3::new(0.0, 0.0, contact.normal_force);
        // What the terms of a fixed peg leave out is due to the acceleration of the peg.
        let whole = model.euler_accelerations(contact, motion);
        let terms = model.accelerations(contact, &motion.tilt).total();
        Some(Self {
            phase: motion.phase,
            gap: motion.peg.position.z - top.peg_radius,
            peg_velocity: lean_to_world(&motion.peg.velocity_lean, phi),
            center: motion.peg.position
                + top.center_distance * lean_to_world(&motion.tilt.axis(), phi),
            center_velocity,
            center_acceleration: lean_to_world(&force, phi) / top.mass
                - Vector3::new(0.0, 0.0, top.gravity),
            central_momentum: lean_to_world(&model.central_momentum_lean(motion), phi),
            jellett: model.jellett(motion),
            routh: model.routh(motion),
            translational_energy: 0.5 * top.mass * center_velocity.norm_squared(),
            driven: Euler {
                phi: whole.phi - terms.phi,
                theta: whole.theta - terms.theta,
                psi: whole.psi - terms.psi,
            },
            dissipated: motion.peg.dissipated,
        })
    }
}

/// An impact of a free peg on the table. SI units; vectors in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImpactRecord {
    /// Index of the impact in the run, from 0.
    pub index: u32,
    /// Time, s.
    pub time: f64,
    /// The time rounded to nanoseconds.
    pub time_ns: u64,
    /// Impacts since the peg last left the table, or since the start: 1 for the first.
    pub bounce: u32,
    /// Whether the peg stays on the table.
    pub stays: bool,
    /// The point of contact, m.
    pub point: Vector3<f64>,
    /// Impulse of the table, N s.
    pub impulse: Vector3<f64>,
    /// Velocity of the contact point before, m/s: its horizontal part is the slip.
    pub before: Vector3<f64>,
    /// Velocity of the contact point after, m/s.
    pub after: Vector3<f64>,
    /// The effective coefficient of restitution.
    pub restitution: f64,
    /// Energy lost by compression and restitution, J.
    pub normal_loss: f64,
    /// Energy lost by friction, J.
    pub friction_loss: f64,
}

impl ImpactRecord {
    /// An impact with the motion after it.
    pub(super) fn new(hit: &Impact, motion: &Motion, time: f64, time_ns: u64) -> Self {
        let phi = motion.angles.phi;
        let peg = motion.peg.position;
        Self {
            // The queue numbers impacts and bounces when they are emitted.
            index: 0,
            time,
            time_ns,
            bounce: 0,
            stays: motion.phase != Phase::Flying,
            point: Vector3::new(peg.x, peg.y, 0.0),
            impulse: lean_to_world(&hit.impulse, phi),
            before: lean_to_world(&hit.before, phi),
            after: lean_to_world(&hit.after, phi),
            restitution: hit.restitution,
            normal_loss: hit.normal_loss,
            friction_loss: hit.friction_loss,
        }
    }
}
