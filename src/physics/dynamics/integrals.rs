//! Integrals over the motion that travel with it.

/// How many running integrals travel with the motion: see [`Integrals`].
pub const INTEGRALS: usize = 3;

/// Integrals over the motion so far, from the start of the run. They are carried along by the
/// integrator and never influence the motion.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Integrals {
    /// Work that friction did on the top, J (negative where it took energy).
    pub friction_work: f64,
    /// Length of the path that the contact point slipped over the table, m.
    pub slip_path: f64,
    /// ∫ θ dt, rad s.
    pub theta: f64,
}

/// The running integrals at the end of a state vector.
#[inline]
pub(super) fn integrals<const N: usize>(state: &[f64; N]) -> Integrals {
    Integrals {
        friction_work: state[N - 3],
        slip_path: state[N - 2],
        theta: state[N - 1],
    }
}
