//! The only place for transcendental functions.
//!
//! The platform's `sin`, `cos`, … can differ in the last bit between platforms. All values that can reach a recording
//! are computed with these wrappers of the portable `libm` crate; `clippy.toml` forbids the methods of `f64`.

use std::f64::consts::{PI, TAU};

/// Sine of an angle in radians.
pub fn sin(angle: f64) -> f64 {
    libm::sin(angle)
}

/// Cosine of an angle in radians.
pub fn cos(angle: f64) -> f64 {
    libm::cos(angle)
}

/// Sine and cosine of an angle in radians.
pub fn sin_cos(angle: f64) -> (f64, f64) {
    libm::sincos(angle)
}

/// The angle in (−π, π] of the point (x, y) in the plane, in radians.
pub fn atan2(y: f64, x: f64) -> f64 {
    libm::atan2(y, x)
}

/// Natural logarithm.
pub fn ln(x: f64) -> f64 {
    libm::log(x)
}

/// `e` to the power of x.
pub fn exp(x: f64) -> f64 {
    libm::exp(x)
}

/// Hyperbolic tangent.
pub fn tanh(x: f64) -> f64 {
    libm::tanh(x)
}

/// Decimal logarithm; minus infinity for 0.
pub fn log10(x: f64) -> f64 {
    libm::log10(x)
}

/// The angle in [−π/2, π/2] whose tangent is x, in radians.
pub fn atan(x: f64) -> f64 {
    libm::atan(x)
}

/// `x` to the power of `y`.
pub fn pow(x: f64, y: f64) -> f64 {
    libm::pow(x, y)
}

/// `sqrt(x² + y²)`, without protection against overflow and underflow.
///
/// Faster than `libm::hypot`; inputs here are far from the limits.
pub fn hypot(x: f64, y: f64) -> f64 {
    (x * x + y * y).sqrt()
}

/// The angle equal to `angle` up to whole turns that lies nearest to `reference`, in radians.
pub fn unwrap_near(angle: f64, reference: f64) -> f64 {
    angle + TAU * ((reference - angle + PI) / TAU).floor()
}

/// An array of numbers. [`std::array::from_fn`] and `map` of arrays would not be inlined in a development build, whose
/// units are compiled apart, and are called for each step of a simulation.
#[inline(always)]
pub fn array<const N: usize>(component: impl Fn(usize) -> f64) -> [f64; N] {
    let mut all = [0.0; N];
    for (i, place) in all.iter_mut().enumerate() {
        *place = component(i);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unwrapping_returns_the_nearest_equivalent_angle() {
        for (angle, reference) in [(0.1, 12.5), (-3.0, 100.0), (3.1, -3.1), (0.0, 0.0)] {
            let near = unwrap_near(angle, reference);
            assert!((near - reference).abs() <= PI + 1e-12);
            let turns = (near - angle) / TAU;
            assert!((turns - turns.round()).abs() < 1e-12);
        }
    }
}
