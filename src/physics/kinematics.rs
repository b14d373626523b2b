//! Kinematics of a top: orientation, rates, slip velocity.
//!
//! Conventions are the paper's (V. Tanrıverdi, arXiv:2204.14060): z-x-z Euler angles, φ the
//! precession about the vertical, θ the nutation (inclination) about the line of nodes, ψ the spin
//! about the symmetry axis.
//!
//! Four frames are used, all right-handed:
//!
//! | frame | x | y | z |
//! |---|---|---|---|
//! | world | horizontal, where the line of nodes is at φ = 0 | horizontal | vertical, up |
//! | body | fixed in the top | fixed in the top | symmetry axis `n` |
//! | node | line of nodes `e_N` | `e_2 = n × e_N` | symmetry axis `n` |
//! | lean | horizontal direction of the tilt | line of nodes `e_N` | vertical, up |
//!
//! The lean frame rotates with the precession only; contact forces are simplest in it.

use crate::physics::math::{atan2, hypot, sin_cos, unwrap_near};
use nalgebra::{Quaternion, Unit, UnitQuaternion, Vector3};
use std::f64::consts::PI;
use std::ops::Add;

/// Below this sin θ the axis counts as vertical: φ and ψ can't be distinguished, and their rates would overflow.
pub const UPRIGHT_SINE: f64 = 1e-60;

/// One number per Euler angle: the angles, their rates or their accelerations.
///
/// Units: rad, rad/s or rad/s².
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Euler {
    /// Precession, about the vertical.
    pub phi: f64,
    /// Nutation (inclination), about the line of nodes.
    pub theta: f64,
    /// Spin, about the symmetry axis.
    pub psi: f64,
}

impl Euler {
    /// From φ, θ and ψ, or their derivatives.
    #[inline]
    pub const fn new(phi: f64, theta: f64, psi: f64) -> Self {
        Self { phi, theta, psi }
    }
}

impl Add for Euler {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self::new(
            self.phi + other.phi,
            self.theta + other.theta,
            self.psi + other.psi,
        )
    }
}

/// Inclination and angular velocity: everything that does not depend on φ and ψ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tilt {
    /// sin θ.
    pub sin: f64,
    /// cos θ.
    pub cos: f64,
    /// Angular velocity in the lean frame, rad/s: `(ψ̇ sin θ, θ̇, φ̇ + ψ̇ cos θ)`.
    pub omega_lean: Vector3<f64>,
    /// Euler rates, rad/s.
    pub rates: Euler,
}

impl Tilt {
    /// From the inclination θ in rad and the Euler rates in rad/s.
    #[inline]
    pub fn from_rates(theta: f64, rates: Euler) -> Self {
        let (sin, cos) = inclined_by(theta);
        let omega_lean = Vector3::new(rates.psi * sin, rates.theta, rates.phi + rates.psi * cos);
        Self {
            sin,
            cos,
            omega_lean,
            rates,
        }
    }

    /// From sine and cosine of θ and the angular velocity in the lean frame, rad/s.
    ///
    /// Where the axis is vertical (sin θ = 0), φ̇ is taken as 0.
    #[inline]
    pub fn from_omega(sin: f64, cos: f64, omega_lean: Vector3<f64>) -> Self {
        let (phi_dot, psi_dot) = if sin > UPRIGHT_SINE {
            let psi_dot = omega_lean.x / sin;
            (omega_lean.z - psi_dot * cos, psi_dot)
        } else {
            (0.0, omega_lean.z * cos)
        };
        Self {
            sin,
            cos,
            omega_lean,
            rates: Euler::new(phi_dot, omega_lean.y, psi_dot),
        }
    }

    /// Whether the axis is so close to the vertical that φ and ψ are undefined.
    #[inline]
    pub fn is_upright(&self) -> bool {
        self.sin <= UPRIGHT_SINE
    }

    /// Direction of the symmetry axis in the lean frame.
    #[inline]
    pub fn axis(&self) -> Vector3<f64> {
        Vector3::new(self.sin, 0.0, self.cos)
    }

    /// Angular velocity about the symmetry axis, `ψ̇ + φ̇ cos θ`, in rad/s.
    #[inline]
    pub fn axial_rate(&self) -> f64 {
        self.sin * self.omega_lean.x + self.cos * self.omega_lean.z
    }

    /// Angular velocity in the node frame, in rad/s: `(θ̇, φ̇ sin θ, ψ̇ + φ̇ cos θ)`.
    #[inline]
    pub fn omega_node(&self) -> Vector3<f64> {
        self.lean_to_node(&self.omega_lean)
    }

    /// Transforms lean to node components.
    #[inline]
    pub fn lean_to_node(&self, v: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(
            v.y,
            self.sin * v.z - self.cos * v.x,
            self.sin * v.x + self.cos * v.z,
        )
    }

    /// Transforms node to lean components.
    #[inline]
    pub fn node_to_lean(&self, v: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(
            self.sin * v.z - self.cos * v.y,
            v.x,
            self.sin * v.y + self.cos * v.z,
        )
    }

    /// Velocity of the contact point of a sphere of radius `radius` (m) with a fixed centre, in the lean frame, m/s:
    /// `ω × r` with `r = −R z′` (the paper's equation (3)).
    #[inline]
    pub fn slip_velocity(&self, radius: f64) -> Vector3<f64> {
        Vector3::new(-radius * self.omega_lean.y, radius * self.omega_lean.x, 0.0)
    }
}

/// Sine and cosine of an inclination, rad. The double closest to π is treated as π.
#[inline]
fn inclined_by(theta: f64) -> (f64, f64) {
    if theta == PI {
        (0.0, -1.0)
    } else {
        sin_cos(theta)
    }
}

/// Orientation of the top: transforms body to world components.
pub fn world_from_body(angles: Euler) -> UnitQuaternion<f64> {
    let (sin_tilt, cos_tilt) = if angles.theta == PI {
        (1.0, 0.0)
    } else {
        sin_cos(0.5 * angles.theta)
    };
    let (sin_sum, cos_sum) = sin_cos(0.5 * (angles.phi + angles.psi));
    let (sin_difference, cos_difference) = sin_cos(0.5 * (angles.phi - angles.psi));
    Unit::new_unchecked(Quaternion::new(
        cos_tilt * cos_sum,
        sin_tilt * cos_difference,
        sin_tilt * sin_difference,
        cos_tilt * sin_sum,
    ))
}

/// Euler angles of an orientation, φ and ψ unwrapped to lie nearest to those of `reference`.
///
/// The quaternion need not be of unit length, but its sign must be continuous with `reference`. If the axis is
/// vertical, only φ + ψ (upright) or φ − ψ (inverted) is defined, and φ is taken from `reference`.
pub fn euler_angles(quaternion: &Quaternion<f64>, reference: Euler) -> Euler {
    let [x, y, z, w] = [quaternion.i, quaternion.j, quaternion.k, quaternion.w];
    let half_sum = unwrap_near(atan2(z, w), 0.5 * (reference.phi + reference.psi));
    let half_difference = unwrap_near(atan2(y, x), 0.5 * (reference.phi - reference.psi));
    let (phi, psi) = if hypot(x, y) <= UPRIGHT_SINE {
        (reference.phi, 2.0 * half_sum - reference.phi)
    } else if hypot(z, w) <= UPRIGHT_SINE {
        (reference.phi, reference.phi - 2.0 * half_difference)
    } else {
        (half_sum + half_difference, half_sum - half_difference)
    };
    Euler::new(phi, inclination(quaternion), psi)
}

/// Inclination θ of an orientation, rad. The quaternion need not be of unit length.
pub fn inclination(quaternion: &Quaternion<f64>) -> f64 {
    let [x, y, z, w] = [quaternion.i, quaternion.j, quaternion.k, quaternion.w];
    2.0 * atan2(hypot(x, y), hypot(w, z))
}

/// Transforms node to body components, for the spin ψ in rad.
pub fn node_to_body(v: &Vector3<f64>, psi: f64) -> Vector3<f64> {
    let (sin, cos) = sin_cos(-psi);
    Vector3::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y, v.z)
}

/// Transforms world to lean components, for the precession φ in rad.
pub fn world_to_lean(v: &Vector3<f64>, phi: f64) -> Vector3<f64> {
    let (sin, cos) = sin_cos(phi);
    Vector3::new(sin * v.x - cos * v.y, cos * v.x + sin * v.y, v.z)
}

/// Transforms lean to world components, for the precession φ in rad.
pub fn lean_to_world(v: &Vector3<f64>, phi: f64) -> Vector3<f64> {
    let (sin, cos) = sin_cos(phi);
    Vector3::new(sin * v.x + cos * v.y, sin * v.y - cos * v.x, v.z)
}
