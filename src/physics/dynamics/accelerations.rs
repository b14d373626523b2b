//! The Euler accelerations, term by term.

use crate::physics::kinematics::{Euler, Tilt};
use crate::physics::top::Top;
use nalgebra::Vector3;

/// The Euler accelerations, term by term, rad/s²: the paper's equations (7).
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Accelerations {
    /// The terms with the axial angular momentum `I_z (ψ̇ + φ̇ cos θ)`.
    pub gyroscopic: Euler,
    /// The terms quadratic in the rates without `I_z`: centrifugal in θ̈, Coriolis in φ̈ and ψ̈.
    pub inertial: Euler,
    /// The terms of gravity (in θ̈ only).
    pub gravitational: Euler,
    /// The terms of friction.
    pub frictional: Euler,
}

impl Accelerations {
    /// The total Euler accelerations, rad/s².
    #[inline]
    pub fn total(&self) -> Euler {
        self.gyroscopic + self.inertial + self.gravitational + self.frictional
    }
}

/// The inertial terms of the Euler accelerations; zero if upright.
#[inline(always)]
fn inertial_terms(top: &Top, tilt: &Tilt) -> Accelerations {
    if tilt.is_upright() {
        return Accelerations::default();
    }
    let Tilt {
        sin, cos, rates, ..
    } = *tilt;
    let axial = top.axial_moment * (rates.psi + rates.phi * cos);
    let gyroscopic = axial / top.transverse_moment;
    let nutation_over_sine = rates.theta / sin;
    let precession_gyroscopic = nutation_over_sine * gyroscopic;
    let precession_coriolis = -2.0 * nutation_over_sine * rates.phi * cos;
    // Without a torque about the symmetry axis, ψ̇ + φ̇ cos θ is constant: ψ̈ = φ̇ θ̇ sin θ − φ̈ cos θ.
    Accelerations {
        gyroscopic: Euler {
            phi: precession_gyroscopic,
            theta: -rates.phi * sin * gyroscopic,
            psi: -precession_gyroscopic * cos,
        },
        inertial: Euler {
            phi: precession_coriolis,
            theta: rates.phi * rates.phi * sin * cos,
            psi: rates.theta * rates.phi * sin - precession_coriolis * cos,
        },
        ..Accelerations::default()
    }
}

/// The inertial and gravitational terms for a fixed peg; zero if upright.
#[inline(always)]
pub(super) fn inertial_terms_with_gravity(top: &Top, tilt: &Tilt) -> Accelerations {
    let mut terms = inertial_terms(top, tilt);
    if !tilt.is_upright() {
        terms.gravitational.theta = top.gravity_moment() * tilt.sin / top.transverse_moment;
    }
    terms
}

/// The inertial terms, and those of a torque (node frame, N m) about the reference point of the moments of inertia.
#[inline(always)]
pub(super) fn accelerations_about(top: &Top, torque: &Vector3<f64>, tilt: &Tilt) -> Accelerations {
    Accelerations {
        frictional: top.euler_accelerations(torque, tilt),
        ..inertial_terms(top, tilt)
    }
}
