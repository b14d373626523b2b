//! The arithmetic of formulas.

use crate::physics::math;

/// A function of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Function {
    Negate,
    Exp,
    Ln,
    Log10,
    Sqrt,
    Abs,
    Tanh,
    Sin,
    Cos,
    Atan,
}

/// A function of two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Min,
    Max,
}

impl Function {
    /// The functions that have names.
    pub(super) const ALL: [(&str, Self); 9] = [
        ("exp", Self::Exp),
        ("ln", Self::Ln),
        ("log10", Self::Log10),
        ("sqrt", Self::Sqrt),
        ("abs", Self::Abs),
        ("tanh", Self::Tanh),
        ("sin", Self::Sin),
        ("cos", Self::Cos),
        ("atan", Self::Atan),
    ];

    #[inline]
    pub(super) fn apply(self, x: f64) -> f64 {
        match self {
            Self::Negate => -x,
            Self::Exp => math::exp(x),
            Self::Ln => math::ln(x),
            Self::Log10 => math::log10(x),
            Self::Sqrt => x.sqrt(),
            Self::Abs => x.abs(),
            Self::Tanh => math::tanh(x),
            Self::Sin => math::sin(x),
            Self::Cos => math::cos(x),
            Self::Atan => math::atan(x),
        }
    }
}

impl Operator {
    /// The operators that are written as functions, of two numbers or more.
    pub(super) const FUNCTIONS: [(&str, Self); 2] = [("min", Self::Min), ("max", Self::Max)];

    #[inline]
    pub(super) fn apply(self, x: f64, y: f64) -> f64 {
        match self {
            Self::Add => x + y,
            Self::Subtract => x - y,
            Self::Multiply => x * y,
            Self::Divide => x / y,
            Self::Power => power(x, y),
            // `f64::min` ignores what isn't a number, and may return either zero.
            Self::Min if x < y || x.is_nan() => x,
            Self::Max if x > y || x.is_nan() => x,
            Self::Min | Self::Max => y,
        }
    }
}

/// `x` to the power of `y`; not a number for 0⁰, which has no value.
#[inline]
fn power(x: f64, y: f64) -> f64 {
    // Squares are frequent, and the general power takes as long as ten products.
    if y == 2.0 {
        x * x
    } else if x == 0.0 && y == 0.0 {
        f64::NAN
    } else {
        math::pow(x, y)
    }
}
