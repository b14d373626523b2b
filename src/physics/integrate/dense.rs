//! Dense output: the solution within a step.

use crate::physics::math::array;

/// The solution within one accepted step: a polynomial of degree 7 that agrees with the steps in value and
/// slope at both ends (Hairer, Nørsett, Wanner, II.6).
#[derive(Clone, Debug, PartialEq)]
pub struct Dense<const N: usize> {
    /// The start of the step.
    pub t0: f64,
    /// Length of the step, which ends at exactly `t0 + h`.
    pub h: f64,
    /// Coefficients of Hairer's nested form: see [`Dense::component`].
    pub(super) coefficients: [[f64; N]; 8],
}

impl<const N: usize> Dense<N> {
    /// The state at `t0 + s h`, with `s` in [0, 1].
    #[inline]
    pub fn at(&self, s: f64) -> [f64; N] {
        array(|i| self.component(i, s))
    }

    /// The first `count` components of the state at `t0 + s h`, bit-identical to those of [`Dense::at`]; 0 for the
    /// others.
    #[inline]
    pub fn first_at(&self, count: usize, s: f64) -> [f64; N] {
        let mut state = [0.0; N];
        for (i, component) in state.iter_mut().enumerate().take(count) {
            *component = self.component(i, s);
        }
        state
    }

    /// Component `i` of the state at `t0 + s h`, with `s` in [0, 1]: cheaper than [`Dense::at`], and bit-identical.
    ///
    /// # Panics
    /// If `i` is not less than `N`.
    #[inline]
    pub fn component(&self, i: usize, s: f64) -> f64 {
        // The factors s and 1 − s alternate.
        let [c0, c1, c2, c3, c4, c5, c6, c7] = array(|order| self.coefficients[order][i]);
        let r = 1.0 - s;
        c0 + s * (c1 + r * (c2 + s * (c3 + r * (c4 + s * (c5 + r * (c6 + s * c7))))))
    }

    /// The derivative of the state with respect to `s`, which is `h` times that with respect to t.
    #[inline]
    pub fn slope(&self, s: f64) -> [f64; N] {
        array(|i| {
            let c: [f64; 8] = array(|order| self.coefficients[order][i]);
            let (mut value, mut slope) = (c[7], 0.0);
            for (order, c) in c[..7].iter().enumerate().rev() {
                let (factor, sign) = if order % 2 == 0 {
                    (s, 1.0)
                } else {
                    (1.0 - s, -1.0)
                };
                slope = factor * slope + sign * value;
                value = c + factor * value;
            }
            slope
        })
    }
}
