//! Breakaway: friction on a peg whose contact point has just begun to slip.
//!
//! This is no law of friction but a regularisation of the first instants after a hold, which the laws leave stiff.

use super::Friction;
use crate::physics::kinematics::Tilt;
use crate::physics::top::Top;
use nalgebra::Vector3;

/// Slip speed at which the breakaway ends and the direction of friction is that of the law, m/s.
///
/// Where a hold gives way, its load exceeds the bound by nothing at first, and the slip speed grows as `v = c t²/2`.
/// Meanwhile friction turns the slip into the direction of the load within a time proportional to `v`. An explicit
/// method has to resolve that time, in a number of steps proportional to `1/√v` of the slowest `v`. Slip below this
/// speed is given the direction that it would take anyway. Friction turns it within `v/(k g)`, at this speed 1e-7 s, and
/// what the slip misses in that time is below the tolerances: with a tenth of this speed, later events of sticking and
/// slipping tops move by 2e-12 s, and by 1e-11 s with rolling resistance; with a hundredth, those of a rolling free peg by
/// 3e-12 s.
pub(crate) const BREAKAWAY_SPEED: f64 = 1e-7;

impl Friction {
    /// The inclination and angular velocity whose friction acts on a top in the state `tilt` with a fixed peg, after a
    /// hold has given way: with the horizontal angular velocity turned towards the torque that friction resists, the
    /// more the slower it is.
    ///
    /// Equal to `tilt` if friction can hold the top again.
    #[cold]
    pub(super) fn breakaway_tilt(&self, top: &Top, normal_force: f64, tilt: &Tilt) -> Tilt {
        let load = self.load(top, normal_force, tilt);
        let strength = load.norm();
        if strength <= self.grip(top, normal_force, tilt).maximum {
            // Friction in the direction of the load would push the top backward.
            return *tilt;
        }
        let omega = tilt.omega_lean;
        let rate = omega.xy().norm();
        // From the direction of the load at rest to that of the rotation at the breakaway speed.
        let share = top.slip_speed(tilt) / BREAKAWAY_SPEED;
        let rocking = (1.0 - share) * rate / strength * load + share * omega;
        Tilt {
            omega_lean: Vector3::new(rocking.x, rocking.y, omega.z),
            ..*tilt
        }
    }

    /// The horizontal torque that friction has to resist lest the angular velocity of a fixed peg changes in the lean
    /// frame, which turns with the axis, N m.
    fn load(&self, top: &Top, normal_force: f64, tilt: &Tilt) -> Vector3<f64> {
        let omega = tilt.omega_lean;
        let turning = Vector3::new(0.0, 0.0, omega.z);
        let losses = self
            .torque_of_losses(0.0, normal_force, turning, tilt.axis())
            .unwrap_or_default();
        let free = top.angular_acceleration(&(top.gravity_torque(tilt) + losses), tilt);
        let excess = free - turning.cross(&omega);
        // The horizontal torque that causes this acceleration: the top's inverse inertia about x and y is diagonal.
        let axial = tilt.sin * tilt.sin;
        let per_torque = axial / top.axial_moment + (1.0 - axial) / top.transverse_moment;
        Vector3::new(excess.x / per_torque, excess.y * top.transverse_moment, 0.0)
    }
}
