//! The lean frame of an orientation that is given as a quaternion.

use crate::physics::kinematics::{Euler, Tilt, UPRIGHT_SINE};
use crate::physics::math::{atan2, hypot, unwrap_near};
use nalgebra::{Quaternion, Vector3};

/// The lean of the symmetry axis: where it points, as seen from above.
///
/// A vertical axis leans nowhere. If it doesn't stay vertical, its lean is the one with which it goes on; so no number jumps
/// between this moment and what follows.
pub(super) struct Lean {
    pub(super) sin: f64,
    pub(super) cos: f64,
    /// Horizontal unit vector in which the axis leans, world; zero where it is vertical and stays so.
    direction: [f64; 2],
}

impl Lean {
    /// The lean of an orientation. A vertical axis, with this cosine of θ, is about to turn about the horizontal part of the
    /// vector `turning`, world.
    #[inline]
    pub(super) fn of(q: &Quaternion<f64>, turning: impl FnOnce(f64) -> Vector3<f64>) -> Self {
        let per_square = 1.0 / q.norm_squared();
        let x = 2.0 * (q.i * q.k + q.j * q.w) * per_square;
        let y = 2.0 * (q.j * q.k - q.i * q.w) * per_square;
        let cos = (q.w * q.w + q.k * q.k - q.i * q.i - q.j * q.j) * per_square;
        let sin = hypot(x, y);
        let direction = if sin > UPRIGHT_SINE {
            [x / sin, y / sin]
        } else {
            leaving(cos, &turning(cos))
        };
        Self {
            sin,
            cos,
            direction,
        }
    }

    /// World components turned into lean components.
    #[inline]
    pub(super) fn of_world(&self, v: &Vector3<f64>) -> Vector3<f64> {
        let [x, y] = self.direction;
        Vector3::new(x * v.x + y * v.y, x * v.y - y * v.x, v.z)
    }

    /// Lean components turned into world components.
    #[inline]
    pub(super) fn in_world(&self, v: &Vector3<f64>) -> Vector3<f64> {
        let [x, y] = self.direction;
        Vector3::new(x * v.x - y * v.y, y * v.x + x * v.y, v.z)
    }

    /// Euler angles of a moment ago for [`euler_angles`](crate::physics::kinematics::euler_angles), which keeps their φ where
    /// the axis is vertical: with the φ of the lean there.
    pub(super) fn reference(&self, before: Euler) -> Euler {
        let [x, y] = self.direction;
        if self.sin > UPRIGHT_SINE || (x == 0.0 && y == 0.0) {
            return before;
        }
        let phi = unwrap_near(atan2(x, -y), before.phi);
        Euler {
            phi,
            psi: before.psi - self.cos.signum() * (phi - before.phi),
            ..before
        }
    }

    /// The rates with which a vertical axis goes on, from its angular momentum (world) and the torque, both over the moment of
    /// inertia across the axis.
    ///
    /// With `n = ±z′` and `L = A n × ṅ + L_n n` the horizontal part of `L̇ = τ` is `±A z′ × n̈ + L_n ṅ = τ`. An axis that moves,
    /// `ṅ = θ̇ e`, turns its lean `e` by `φ̇ = n̈ · (z′ × e)/2θ̇`: so φ̇ is half of `L_z′/A`, less what the torque along `e` does.
    /// An axis that rests is moved by a torque, and its line of nodes is along it; `φ̇ = n⃛ · (z′ × e)/3θ̈` is a third of
    /// `L_z′/A`, because friction keeps its direction at first.
    pub(super) fn going_on(
        &self,
        tilt: Tilt,
        momentum: &Vector3<f64>,
        torque: &Vector3<f64>,
    ) -> Tilt {
        let (momentum, torque) = (self.of_world(momentum), self.of_world(torque));
        let sign = self.cos.signum();
        let phi = if momentum.y != 0.0 {
            0.5 * (momentum.z - torque.x / momentum.y)
        } else if torque.y != 0.0 {
            momentum.z / 3.0
        } else {
            0.0
        };
        Tilt {
            rates: Euler {
                phi,
                theta: tilt.rates.theta,
                psi: sign * (tilt.omega_lean.z - phi),
            },
            ..tilt
        }
    }
}

/// The direction in which a vertical axis with this cosine of θ begins to lean, if it turns about the horizontal part of a
/// vector.
#[cold]
fn leaving(cos: f64, turning: &Vector3<f64>) -> [f64; 2] {
    let across = cos.signum() * hypot(turning.x, turning.y);
    if across == 0.0 {
        [0.0, 0.0]
    } else {
        [turning.y / across, -turning.x / across]
    }
}
