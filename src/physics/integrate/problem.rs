//! Types of the integrator: equations, tolerances, statistics, errors.

use thiserror::Error;

/// A system of ordinary differential equations y′ = f(t, y) with `N` components.
pub trait System<const N: usize> {
    /// The first `CONTROLLED` components enter the error norm and so determine the steps; at least one. The rest are
    /// quadratures (e.g. dissipated energy, path length), which don't affect the steps. No derivative may depend on
    /// them.
    const CONTROLLED: usize = N;

    /// The derivative y′ at (t, y). May be infinite or NaN where it is not defined.
    fn derivative(&self, t: f64, y: &[f64; N]) -> [f64; N];
}

/// Bounds on the local error of a step: `absolute + relative · |y|` for each controlled component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerances {
    /// Part proportional to the component's magnitude, dimensionless. Not negative.
    pub relative: f64,
    /// Fixed part, in the unit of the component. Positive if a component can be zero.
    pub absolute: f64,
}

/// Statistics of an integration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Steps taken.
    pub accepted: u64,
    /// Rejected steps.
    pub rejected: u64,
    /// Evaluations of the derivative for steps and dense output.
    pub evaluations: u64,
    /// Length of the shortest step taken, in the unit of t; 0 before the first.
    pub smallest_step: f64,
    /// Length of the longest step taken, in the unit of t; 0 before the first.
    pub largest_step: f64,
}

/// Error of an integration. Its text leaves out t, which isn't always a time.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum IntegrateError {
    /// The step size fell below the resolution of t: the solution is singular or discontinuous ahead, or the equations
    /// are not defined there.
    #[error("the solution is singular, discontinuous or too steep (step size underflow)")]
    StepSizeUnderflow {
        /// The end of the last accepted step.
        t: f64,
        /// The next step size.
        step: f64,
    },
    /// The state or its derivative is infinite or not a number.
    #[error("the state or its derivative is not finite")]
    NonFiniteState {
        /// Time.
        t: f64,
    },
}
