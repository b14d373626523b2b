//! All recorded quantities at one instant.

use super::free::FreeSample;
use super::regime::Regime;
use crate::physics::dynamics::{Accelerations, Integrals, Model, Motion, Phase};
use crate::physics::friction::Contact;
use crate::physics::kinematics::{Euler, Tilt, lean_to_world, node_to_body};
use crate::physics::top::PrecessionRoots;
use nalgebra::{UnitQuaternion, Vector3};

/// A vector in two frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frames {
    /// Components along the body axes.
    pub body: Vector3<f64>,
    /// Components along the line of nodes, the perpendicular `n × e_N`, and the symmetry axis.
    pub node: Vector3<f64>,
}

/// State, derivatives, forces and torques at one instant. SI units and radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Index of the sample in the run, from 0.
    pub index: u32,
    /// Time since the start: `index` times the sample period, ns.
    pub time_ns: u64,
    /// Euler angles, unwrapped, rad.
    pub angles: Euler,
    /// Inclination and angular velocity.
    pub tilt: Tilt,
    /// Terms of the Euler accelerations, without the acceleration of the peg, rad/s².
    pub accelerations: Accelerations,
    /// The total Euler accelerations, rad/s², including the acceleration of a free peg.
    pub euler_accelerations: Euler,
    /// Orientation, angular velocity and position.
    pub pose: Pose,
    /// Torques about the peg's centre.
    pub torque: Torques,
    /// State of the contact, in the lean frame.
    pub contact: Contact,
    /// Slip and friction at the point of contact.
    pub slip: Slip,
    /// Energies.
    pub energy: Energies,
    /// Integrals since the start.
    pub integrals: Integrals,
    /// Angular momentum about the peg's centre.
    pub momentum: Momenta,
    /// Regular precession at this inclination and spin.
    pub precession: Precession,
    /// Quantities of a free peg.
    pub free: Option<FreeSample>,
}

/// Orientation, angular velocity and position of a top.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Orientation: transforms body to world components.
    pub world_from_body: UnitQuaternion<f64>,
    /// Direction of the symmetry axis, world.
    pub axis: Vector3<f64>,
    /// Angular velocity in body axes, rad/s.
    pub omega_body: Vector3<f64>,
    /// Angular velocity in the world, rad/s.
    pub omega_world: Vector3<f64>,
    /// Position of the peg's centre in the world, m; the table is z = 0.
    pub peg_position: Vector3<f64>,
}

/// Torques about the peg's centre, N m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torques {
    /// Torque of gravity.
    pub gravity: Frames,
    /// Torque of friction.
    pub friction: Frames,
    /// Sum of both torques.
    pub total: Frames,
}

/// Slip and friction at the point of contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slip {
    /// Slip velocity in body axes, m/s.
    pub body: Vector3<f64>,
    /// Slip velocity in the world, m/s.
    pub world: Vector3<f64>,
    /// Friction force in the world, N.
    pub friction_force: Vector3<f64>,
    /// The contact point in the world, m.
    pub contact_point: Vector3<f64>,
}

/// Energies, and the power of friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Energies {
    /// Kinetic energy, J.
    pub kinetic: f64,
    /// Potential energy, J; zero at the height of the peg's centre.
    pub potential: f64,
    /// Power of friction, W.
    pub friction_power: f64,
}

impl Frames {
    /// A vector of the lean frame of a motion.
    fn from_lean(lean: &Vector3<f64>, motion: &Motion) -> Self {
        let node = motion.tilt.lean_to_node(lean);
        Self {
            body: node_to_body(&node, motion.angles.psi),
            node,
        }
    }
}

impl Energies {
    /// Total energy, J.
    pub fn total(&self) -> f64 {
        self.kinetic + self.potential
    }
}

/// Angular momentum about the peg's centre, kg m²/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Momenta {
    /// About the vertical.
    pub vertical: f64,
    /// About the symmetry axis.
    pub axial: f64,
    /// The vector in the world.
    pub world: Vector3<f64>,
}

/// Regular precession at an inclination and a spin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Precession {
    /// The precession rates, if they are real.
    pub roots: Option<PrecessionRoots>,
    /// Above 1 for a strong top, below 1 for a weak one; see [`crate::physics::top::Top::strength_ratio`].
    pub strength_ratio: f64,
}

impl Sample {
    /// All quantities of a motion.
    pub(super) fn new(
        index: u32,
        time_ns: u64,
        model: &Model,
        motion: &Motion,
        world_from_body: UnitQuaternion<f64>,
    ) -> Self {
        let (angles, tilt) = (motion.angles, motion.tilt);
        let top = &model.top;
        let contact = model.contact_in(motion);
        let friction = model.friction_torque(&contact, &tilt);
        let gravity = top.gravity_torque(&tilt);
        let momentum_node = model.momentum_node(motion);
        let momentum_lean = tilt.node_to_lean(&momentum_node);
        let free = FreeSample::new(model, motion, &contact);
        let peg_position = motion.peg.position;
        Self {
            index,
            time_ns,
            angles,
            tilt,
            accelerations: model.accelerations(&contact, &tilt),
            euler_accelerations: model.euler_accelerations(&contact, motion),
            pose: Pose {
                world_from_body,
                axis: lean_to_world(&Vector3::new(tilt.sin, 0.0, tilt.cos), angles.phi),
                omega_body: Frames::from_lean(&tilt.omega_lean, motion).body,
                omega_world: lean_to_world(&tilt.omega_lean, angles.phi),
                peg_position,
            },
            torque: Torques {
                gravity: Frames::from_lean(&gravity, motion),
                friction: Frames::from_lean(&friction, motion),
                total: Frames::from_lean(&(gravity + friction), motion),
            },
            slip: Slip {
                body: Frames::from_lean(&contact.slip, motion).body,
                world: lean_to_world(&contact.slip, angles.phi),
                friction_force: lean_to_world(&contact.force, angles.phi),
                contact_point: peg_position - Vector3::new(0.0, 0.0, top.peg_radius),
            },
            contact,
            energy: Energies {
                kinetic: model.kinetic_energy(motion),
                potential: model.potential_energy(motion),
                friction_power: model.friction_power(&contact, &tilt),
            },
            integrals: motion.integrals,
            momentum: Momenta {
                vertical: momentum_lean.z,
                axial: momentum_node.z,
                world: lean_to_world(&momentum_lean, angles.phi),
            },
            precession: Precession {
                roots: model.precession_roots(&tilt, motion.phase),
                strength_ratio: model.nutating_top().strength_ratio(&tilt),
            },
            free,
        }
    }

    /// Regime of the contact. A peg that slides without slip at this instant counts as sticking.
    pub fn regime(&self) -> Regime {
        match self.free.map(|free| free.phase) {
            Some(Phase::Flying) => Regime::Flying,
            Some(Phase::Sliding) | None if self.contact.slip_speed > 0.0 => Regime::Slipping,
            Some(Phase::Sticking | Phase::Sliding) | None => Regime::Sticking,
        }
    }
}
