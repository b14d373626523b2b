//! The lean frame of a quaternion.

use crate::physics::kinematics::{Euler, Tilt, UPRIGHT_SINE};
use crate::physics::math::{atan2, hypot, unwrap_near};
use nalgebra::{Quaternion, Vector3};

/// Tilt direction of the symmetry axis (its horizontal direction).
///
/// A vertical axis has no tilt direction. If it is about to tilt, the direction of the following motion is used, so
/// that values are continuous.
pub(super) struct Lean {
    pub(super) sin: f64,
    pub(super) cos: f64,
    /// Horizontal unit vector of the tilt direction, world frame; zero if the axis stays vertical.
    direction: [f64; 2],
}

impl Lean {
    /// The tilt direction of an orientation. For a vertical axis, `turning(cos θ)` returns the vector about whose
    /// horizontal part it is about to rotate, world frame.
    #[inline]
    pub(super) fn new(q: &Quaternion<f64>, turning: impl FnOnce(f64) -> Vector3<f64>) -> Self {
        // The integrator doesn't keep the quaternion at unit length.
        let per_square = 1.0 / q.norm_squared();
        let x = 2.0 * (q.i * q.k + q.j * q.w) * per_square;
        let y = 2.0 * (q.j * q.k - q.i * q.w) * per_square;
        let cos = (q.w * q.w + q.k * q.k - q.i * q.i - q.j * q.j) * per_square;
        let sin = hypot(x, y);
        let direction = if sin > UPRIGHT_SINE {
            [x / sin, y / sin]
        } else {
            initial_tilt_direction(cos, &turning(cos))
        };
        Self {
            sin,
            cos,
            direction,
        }
    }

    /// Transforms world to lean components.
    #[inline]
    pub(super) fn world_to_lean(&self, v: &Vector3<f64>) -> Vector3<f64> {
        let [x, y] = self.direction;
        Vector3::new(x * v.x + y * v.y, x * v.y - y * v.x, v.z)
    }

    /// Transforms lean to world components.
    #[inline]
    pub(super) fn lean_to_world(&self, v: &Vector3<f64>) -> Vector3<f64> {
        let [x, y] = self.direction;
        Vector3::new(x * v.x - y * v.y, y * v.x + x * v.y, v.z)
    }

    /// Angles near which [`euler_angles`](crate::physics::kinematics::euler_angles) unwraps φ and ψ. It keeps their φ if
    /// the axis is vertical; in that case they have the φ of the tilt direction.
    pub(super) fn unwrap_reference(&self, before: Euler) -> Euler {
        let [x, y] = self.direction;
        // Without a tilt direction, φ stays as it was.
        if self.sin > UPRIGHT_SINE || (x == 0.0 && y == 0.0) {
            return before;
        }
        let phi = unwrap_near(atan2(x, -y), before.phi);
        Euler {
            phi,
            // Of a vertical axis only φ + ψ (upright) or φ − ψ (inverted) is defined: ψ makes up for the change of φ.
            psi: before.psi - self.cos.signum() * (phi - before.phi),
            ..before
        }
    }

    /// The limits of the Euler rates at a vertical axis, from the angular momentum and the torque (world frame), both
    /// divided by the transverse moment of inertia.
    ///
    /// With `n = ±z′` and `L = A n × ṅ + L_n n`, the horizontal part of `L̇ = τ` is `±A z′ × n̈ + L_n ṅ = τ`. If the
    /// axis is moving, `ṅ = θ̇ e`, then `φ̇ = n̈ · (z′ × e)/2θ̇`: half of `L_z′/A`, minus the contribution of the
    /// torque along `e`. If it is at rest, the line of nodes is along the torque, and
    /// `φ̇ = n⃛ · (z′ × e)/3θ̈ = L_z′/3A`, because friction initially keeps its direction.
    pub(super) fn rates_at_vertical(
        &self,
        tilt: Tilt,
        momentum: &Vector3<f64>,
        torque: &Vector3<f64>,
    ) -> Tilt {
        let (momentum, torque) = (self.world_to_lean(momentum), self.world_to_lean(torque));
        let sign = self.cos.signum();
        let phi = if momentum.y != 0.0 {
            0.5 * (momentum.z - torque.x / momentum.y)
        } else if torque.y != 0.0 {
            momentum.z / 3.0
        } else {
            0.0
        };
        Tilt {
            rates: Euler::new(phi, tilt.rates.theta, sign * (tilt.omega_lean.z - phi)),
            ..tilt
        }
    }
}

/// The quaternion at the start of a state: its components x, y, z, w.
#[inline]
pub(super) fn quaternion<const N: usize>(y: &[f64; N]) -> Quaternion<f64> {
    Quaternion::new(y[3], y[0], y[1], y[2])
}

/// The initial tilt direction of a vertical axis that rotates about the horizontal part of a vector.
#[cold]
fn initial_tilt_direction(cos: f64, turning: &Vector3<f64>) -> [f64; 2] {
    let across = cos.signum() * hypot(turning.x, turning.y);
    if across == 0.0 {
        [0.0, 0.0]
    } else {
        [turning.y / across, -turning.x / across]
    }
}
