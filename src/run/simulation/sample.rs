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
    /// Their sum.
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
    /// Its rates, if they are real.
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
        let frames = |lean: &Vector3<f64>| {
            let node = tilt.lean_to_node(lean);
            Frames {
                body: node_to_body(&node, angles.psi),
                node,
            }
        };
        let world = |lean: &Vector3<f64>| lean_to_world(lean, angles.phi);
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
                axis: world(&Vector3::new(tilt.sin, 0.0, tilt.cos)),
                omega_body: frames(&tilt.omega_lean).body,
                omega_world: world(&tilt.omega_lean),
                peg_position,
            },
            torque: Torques {
                gravity: frames(&gravity),
                friction: frames(&friction),
                total: frames(&(gravity + friction)),
            },
            slip: Slip {
                body: frames(&contact.slip).body,
                world: world(&contact.slip),
                friction_force: world(&contact.force),
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
                world: world(&momentum_lean),
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
