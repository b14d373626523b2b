//! Bounds of the inclination and the Euler rates within a step.

use crate::physics::integrate::{Bounds, Dense};
use std::f64::consts::{FRAC_2_PI, PI};

/// Bounds of the inclination and the Euler rates over a step.
#[derive(Clone, Copy, Debug)]
pub struct EulerBounds {
    /// Inclination θ, rad.
    pub theta: Bounds,
    /// Precession rate φ̇, rad/s.
    pub phi_dot: Bounds,
    /// Nutation rate θ̇, rad/s.
    pub theta_dot: Bounds,
    /// Derivative of the interpolation polynomial of θ̇, rad/s².
    pub theta_dot_slope: Bounds,
    /// Spin rate ψ̇, rad/s.
    pub psi_dot: Bounds,
}

impl EulerBounds {
    /// The bounds over a step; the state must begin with φ, θ, ψ, φ̇, θ̇, ψ̇.
    #[inline]
    pub(super) fn of<const N: usize>(dense: &Dense<N>) -> Self {
        let slope = dense.slope_bounds(4);
        let (a, b) = (slope.least / dense.h, slope.greatest / dense.h);
        let (least, greatest) = if dense.h > 0.0 { (a, b) } else { (b, a) };
        Self {
            theta: dense.bounds(1),
            phi_dot: dense.bounds(3),
            theta_dot: dense.bounds(4),
            theta_dot_slope: Bounds { least, greatest },
            psi_dot: dense.bounds(5),
        }
    }

    /// A lower bound of sin θ (the chord of the sine); negative if θ may leave (0, π).
    #[must_use]
    #[inline]
    pub fn least_sine(&self) -> f64 {
        let (from_upright, from_inverted) = (self.theta.least, PI - self.theta.greatest);
        let least = if from_upright < from_inverted {
            from_upright
        } else {
            from_inverted
        };
        FRAC_2_PI * least
    }

    /// Bounds of the magnitude of the angular velocity about the symmetry axis, `|ψ̇ + φ̇ cos θ|`, rad/s.
    #[must_use]
    #[inline]
    pub fn axial_rate(&self) -> Bounds {
        let (spin, precession) = (self.psi_dot.magnitude(), self.phi_dot.magnitude());
        Bounds {
            least: spin.least - precession.greatest,
            greatest: spin.greatest + precession.greatest,
        }
    }
}
