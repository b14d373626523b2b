//! The lean frame of an orientation that is given as a quaternion.

use crate::physics::math::hypot;
use nalgebra::{Quaternion, Vector3};

/// The lean of the symmetry axis: where it points, as seen from above.
pub(super) struct Lean {
    pub(super) sin: f64,
    pub(super) cos: f64,
    /// Horizontal unit vector in which the axis leans, world; the x direction where it leans nowhere.
    direction: [f64; 2],
}

impl Lean {
    #[inline]
    pub(super) fn of(q: &Quaternion<f64>) -> Self {
        let per_square = 1.0 / q.norm_squared();
        let x = 2.0 * (q.i * q.k + q.j * q.w) * per_square;
        let y = 2.0 * (q.j * q.k - q.i * q.w) * per_square;
        let cos = (q.w * q.w + q.k * q.k - q.i * q.i - q.j * q.j) * per_square;
        let sin = hypot(x, y);
        let direction = if sin > 0.0 {
            [x / sin, y / sin]
        } else {
            [1.0, 0.0]
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
}
