//! Running integrals over the motion.

use super::accelerations::Accelerations;
use crate::physics::kinematics::Tilt;
use crate::physics::math::array;
use nalgebra::Vector3;

/// Number of all running integrals; see [`Integrals`].
pub const INTEGRALS: usize = 11;

/// Number of integrals needed for an outcome: the first ones, work of friction and slip path. Integrals don't affect
/// the motion, so a state with fewer integrals has a bit-identical motion at less cost.
pub const FEW_INTEGRALS: usize = 2;

/// Integrals over the motion since the start of the run. The integrator computes them without effect on the motion.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Integrals {
    /// Work that friction and impacts did on the top, J (normally negative).
    pub friction_work: f64,
    /// Length of the path that the contact point slipped over the table, m.
    pub slip_path: f64,
    /// ∫ θ dt, rad s.
    pub theta: f64,
    /// Work that friction did about the line of nodes, the perpendicular `n × e_N` and the symmetry axis, J.
    pub work_node: Vector3<f64>,
    /// Work that the force of the friction law does along the slip path, J. Differs from `friction_work` with losses,
    /// and if the model drops a part of friction.
    pub slip_work: f64,
    /// The terms of φ̈ and the frictional one of ψ̈, integrated.
    pub terms: TermIntegrals,
}

/// Integrals of terms of the Euler accelerations, rad/s. They are accumulated only while `sin θ` > [`TERMS_SINE`].
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct TermIntegrals {
    /// ∫ of the gyroscopic term of φ̈.
    pub phi_gyroscopic: f64,
    /// ∫ of the Coriolis term of φ̈.
    pub phi_coriolis: f64,
    /// ∫ of the frictional term of φ̈.
    pub phi_frictional: f64,
    /// ∫ of the frictional term of ψ̈.
    pub psi_frictional: f64,
}

impl TermIntegrals {
    /// Rates of change of the integrals, i.e. the terms themselves, rad/s².
    #[inline(always)]
    pub(super) fn rates(accelerations: &Accelerations, tilt: &Tilt) -> Self {
        if tilt.sin > TERMS_SINE {
            Self {
                phi_gyroscopic: accelerations.gyroscopic.phi,
                phi_coriolis: accelerations.inertial.phi,
                phi_frictional: accelerations.frictional.phi,
                psi_frictional: accelerations.frictional.psi,
            }
        } else {
            Self::default()
        }
    }
}

/// Below this sin θ the terms of φ̈ and ψ̈ are not accumulated: they grow like 1/sin² θ, and the sums would be
/// dominated by rounding.
pub const TERMS_SINE: f64 = 1e-6;

/// The running integrals as the last components of a state vector.
#[inline]
fn as_array(all: &Integrals) -> [f64; INTEGRALS] {
    [
        all.friction_work,
        all.slip_path,
        all.theta,
        all.work_node.x,
        all.work_node.y,
        all.work_node.z,
        all.slip_work,
        all.terms.phi_gyroscopic,
        all.terms.phi_coriolis,
        all.terms.phi_frictional,
        all.terms.psi_frictional,
    ]
}

/// The inverse of [`as_array`].
#[inline]
fn from_array(all: [f64; INTEGRALS]) -> Integrals {
    let [
        friction_work,
        slip_path,
        theta,
        work_node_x,
        work_node_y,
        work_node_z,
        slip_work,
        phi_gyroscopic,
        phi_coriolis,
        phi_frictional,
        psi_frictional,
    ] = all;
    Integrals {
        friction_work,
        slip_path,
        theta,
        work_node: Vector3::new(work_node_x, work_node_y, work_node_z),
        slip_work,
        terms: TermIntegrals {
            phi_gyroscopic,
            phi_coriolis,
            phi_frictional,
            psi_frictional,
        },
    }
}

/// The running integrals at the end of a state vector, after its first `M` components; 0 for absent ones.
#[inline]
pub(super) fn integrals<const M: usize, const N: usize>(state: &[f64; N]) -> Integrals {
    let mut all = [0.0; INTEGRALS];
    // A short state has only the first ones.
    for (value, component) in all.iter_mut().zip(&state[M..]) {
        *value = *component;
    }
    from_array(all)
}

/// The first `I` running integrals, or their rates.
#[inline(always)]
pub(super) fn first_integrals<const I: usize>(integrals: &Integrals) -> [f64; I] {
    const {
        assert!(I == INTEGRALS || I == FEW_INTEGRALS);
    }
    let all = as_array(integrals);
    array(|i| all[i])
}

/// A state vector (or its derivative): `first`, followed by the running integrals.
#[inline(always)]
pub(super) fn with_integrals<const M: usize, const N: usize>(
    first: [f64; M],
    integrals: &Integrals,
) -> [f64; N] {
    const {
        assert!(N == M + INTEGRALS || N == M + FEW_INTEGRALS);
    }
    let integrals = as_array(integrals);
    array(|i| if i < M { first[i] } else { integrals[i - M] })
}
