//! Steps of the evaluation of a formula, and the names in it.

use super::function::{Function, Operator};

/// Names of the parameters, in the order of [`Parameters`].
pub const PARAMETERS: [&str; 5] = ["k", "a", "b", "c", "d"];

/// Values of the parameters of a formula.
pub type Parameters = [f64; PARAMETERS.len()];

/// The name of the slip speed.
pub(super) const SPEED: &str = "v";
/// The name of the circle constant.
pub(super) const PI: &str = "pi";
/// The name of the function for measured points.
pub(super) const POINTS: &str = "points";

/// A step and where it is in the text.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Located {
    pub(super) step: Step,
    /// Byte offset.
    pub(super) at: usize,
}

/// A step of the evaluation with a stack of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Step {
    /// Pushes a number.
    Number(f64),
    /// Pushes the slip speed.
    Speed,
    /// Pushes a parameter.
    Parameter(usize),
    /// Replaces the last number.
    Apply(Function),
    /// Replaces the last two numbers.
    Combine(Operator),
    /// Replaces a number and so many points after it: speeds and coefficients in turn.
    Points(usize),
}
