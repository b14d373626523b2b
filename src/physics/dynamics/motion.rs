//! The motion at one instant, and initial conditions.

use super::integrals::Integrals;
use super::support::Phase;
use crate::physics::friction::Branch;
use crate::physics::kinematics::{Euler, Tilt};
use crate::physics::top::Top;
use nalgebra::Vector3;

/// The motion at one instant, independent of the formulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Euler angles, rad; φ and ψ unwrapped.
    pub angles: Euler,
    /// Inclination and angular velocity.
    pub tilt: Tilt,
    /// Position and velocity of the peg.
    pub peg: Peg,
    /// Phase of the contact point.
    pub phase: Phase,
    /// Branches of the set-valued torques in the phase.
    pub branch: Branch,
    /// Integrals since the start.
    pub integrals: Integrals,
}

/// Slip speeds below this count as zero, m/s.
pub(crate) const NO_SLIP: f64 = 1e-9;

/// Below this slip speed after a departure from rest, friction uses the departure direction, m/s: the slip velocity is
/// too small to define a direction.
pub(super) const DEPARTING: f64 = NO_SLIP;

/// A slowly slipping contact point sticks again, instead of departing, if friction can hold it with this relative
/// margin (well above rounding).
pub(super) const HELD_AGAIN: f64 = 1e-6;

impl Motion {
    /// Slip velocity of the contact point in the lean frame, m/s; in flight, the velocity of the lowest point.
    #[inline]
    pub fn slip_velocity(&self, top: &Top) -> Vector3<f64> {
        let velocity = self.peg.velocity_lean + self.tilt.slip_velocity(top.peg_radius);
        Vector3::new(velocity.x, velocity.y, 0.0)
    }

    /// The slip velocity used in the friction law: that of the departure while the slip is too slow.
    #[inline]
    pub(super) fn law_slip(&self, slip: &Vector3<f64>) -> Vector3<f64> {
        self.peg.departure.map_or(*slip, |departing| departing.slip)
    }

    /// Velocity of the centre of mass in the lean frame, m/s.
    #[inline]
    pub fn center_velocity_lean(&self, top: &Top) -> Vector3<f64> {
        let turning = self.tilt.omega_lean.cross(&self.tilt.axis());
        self.peg.velocity_lean + top.center_distance * turning
    }
}

/// Motion of a contact that begins to slip, as it enters the friction law: the slip itself is too slow to define the
/// direction of friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Departing {
    /// Slip velocity in the lean frame, m/s.
    pub slip: Vector3<f64>,
    /// Rate about the vertical, rad/s.
    pub turning_rate: f64,
}

/// Whether a slip velocity (m/s) is too small to define a direction.
#[inline]
pub(super) fn is_departing(slip: &Vector3<f64>) -> bool {
    slip.norm_squared() < DEPARTING * DEPARTING
}

/// Position and velocity of the centre of the peg, and the energy lost in impacts. A fixed peg does not move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peg {
    /// Position of its centre in the world, m; the table is z = 0.
    pub position: Vector3<f64>,
    /// Velocity of its centre in the lean frame, m/s.
    pub velocity_lean: Vector3<f64>,
    /// The departure from rest, while the slip is too slow to define a direction.
    pub departure: Option<Departing>,
    /// Energy lost in impacts and losses.
    pub dissipated: Dissipated,
}

/// Energy that a top with a free peg has lost since the start, J, except by sliding.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Dissipated {
    /// By compression and restitution in impacts.
    pub impact_normal: f64,
    /// By friction in impacts.
    pub impact_friction: f64,
    /// By rolling resistance, drilling and air.
    pub losses: f64,
}

impl Peg {
    /// A fixed peg of this radius (m) above the origin.
    #[inline]
    pub fn fixed(radius: f64) -> Self {
        Self {
            position: Vector3::new(0.0, 0.0, radius),
            velocity_lean: Vector3::zeros(),
            departure: None,
            dissipated: Dissipated::default(),
        }
    }
}

/// Start of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// Euler angles, rad.
    pub angles: Euler,
    /// Euler rates, rad/s.
    pub rates: Euler,
    /// Position of the peg's centre in the world, m.
    pub peg_position: Vector3<f64>,
    /// Velocity of the peg's centre in the world, m/s.
    pub peg_velocity: Vector3<f64>,
}

impl Start {
    /// Whether a free peg of this radius (m) starts in the air, or on the table with a vertical velocity.
    pub fn is_in_flight(&self, peg_radius: f64) -> bool {
        self.peg_position.z > peg_radius || self.peg_velocity.z != 0.0
    }
}
