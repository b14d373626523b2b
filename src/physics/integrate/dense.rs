//! Dense output: the solution within a step.

/// The solution within one accepted step: a polynomial of degree 7 that agrees with the steps in value and
/// slope at both ends (Hairer, Nørsett, Wanner, II.6).
#[derive(Clone, Debug, PartialEq)]
pub struct Dense<const N: usize> {
    /// The start of the step.
    pub t0: f64,
    /// Its length, negative for steps backward. The step ends at exactly `t0 + h`.
    pub h: f64,
    /// Coefficients of Hairer's nested form: see [`Dense::component`].
    pub(super) coefficients: [[f64; N]; 8],
}

/// Lower and upper bound of a varying number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The lower bound.
    pub least: f64,
    /// The upper bound.
    pub greatest: f64,
}

impl Bounds {
    /// Whether all numbers within these bounds have this sign (zero has no sign).
    #[must_use]
    #[inline]
    pub fn have_sign(&self, positive: bool) -> bool {
        if positive {
            self.least > 0.0
        } else {
            self.greatest < 0.0
        }
    }

    /// Whether a number lies within these bounds.
    #[must_use]
    pub fn contains(&self, number: f64) -> bool {
        self.least <= number && number <= self.greatest
    }

    /// Bounds of the magnitude.
    #[must_use]
    #[inline]
    pub fn magnitude(&self) -> Self {
        let (a, b) = (self.least.abs(), self.greatest.abs());
        let (small, large) = if a < b { (a, b) } else { (b, a) };
        let reaches_zero = self.least <= 0.0 && self.greatest >= 0.0;
        Self {
            least: if reaches_zero { 0.0 } else { small },
            greatest: large,
        }
    }

    /// Bounds of the numbers from `a` to `b`, wider by `margin`.
    #[inline]
    fn around(a: f64, b: f64, margin: f64) -> Self {
        let (low, high) = if a < b { (a, b) } else { (b, a) };
        Self {
            least: low - margin,
            greatest: high + margin,
        }
    }
}

/// Bound of the rounding error of a component or slope, relative to the largest term.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

impl<const N: usize> Dense<N> {
    /// The state at `t0 + s h`, with `s` in [0, 1].
    #[must_use]
    #[inline]
    pub fn at(&self, s: f64) -> [f64; N] {
        std::array::from_fn(|i| self.component(i, s))
    }

    /// The first `count` components of the state at `t0 + s h`, bit-identical to those of [`Dense::at`]; 0 for the
    /// others.
    #[must_use]
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
    #[must_use]
    #[inline]
    pub fn component(&self, i: usize, s: f64) -> f64 {
        // The factors s and 1 − s alternate.
        let [c0, c1, c2, c3, c4, c5, c6, c7] = self.coefficients.each_ref().map(|c| c[i]);
        let r = 1.0 - s;
        c0 + s * (c1 + r * (c2 + s * (c3 + r * (c4 + s * (c5 + r * (c6 + s * c7))))))
    }

    /// The derivative of the state with respect to `s`, which is `h` times that with respect to t.
    #[must_use]
    #[inline]
    pub fn slope(&self, s: f64) -> [f64; N] {
        std::array::from_fn(|i| {
            let c = self.coefficients.each_ref().map(|c| c[i]);
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

    /// Bounds of component `i` over the step: those of the chord, widened by the maxima of the other terms.
    ///
    /// # Panics
    /// If `i` is not less than `N`.
    #[must_use]
    #[inline]
    pub fn bounds(&self, i: usize) -> Bounds {
        // The maxima of s(1−s), s²(1−s), s²(1−s)², … up to s⁴(1−s)³, rounded up.
        const LARGEST: [f64; 6] = [0.25, 0.149, 0.0625, 0.0346, 0.0157, 0.0085];
        let c = self.coefficients.each_ref().map(|c| c[i]);
        let (start, end) = (c[0], c[0] + c[1]);
        let margin = weighted_sum(&c, &LARGEST);
        let rounding = ROUNDING * (c[0].abs() + c[1].abs() + margin);
        Bounds::around(start, end, margin + rounding)
    }

    /// Bounds of the derivative of component `i` with respect to `s` over the whole step, found as
    /// [`Dense::bounds`] are.
    ///
    /// # Panics
    /// If `i` is not less than `N`.
    #[must_use]
    #[inline]
    pub fn slope_bounds(&self, i: usize) -> Bounds {
        // The largest slopes of s²(1−s), …, s⁴(1−s)³, rounded up; that of s(1−s) is 1 − 2s.
        const LARGEST: [f64; 6] = [0.0, 1.0, 0.193, 0.136, 0.0537, 0.034];
        let c = self.coefficients.each_ref().map(|c| c[i]);
        let margin = weighted_sum(&c, &LARGEST);
        let rounding = ROUNDING * (c[1].abs() + c[2].abs() + margin);
        Bounds::around(c[1] + c[2], c[1] - c[2], margin + rounding)
    }
}

/// The weighted sum of the magnitudes of the coefficients from the third on.
#[inline]
fn weighted_sum(coefficients: &[f64; 8], weights: &[f64; 6]) -> f64 {
    let mut sum = 0.0;
    for (coefficient, weight) in coefficients[2..].iter().zip(weights) {
        sum += coefficient.abs() * weight;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Coefficients of either sign and very different sizes, from a linear congruential generator.
    fn arbitrary(seed: u64) -> Dense<1> {
        let mut state = seed;
        let mut next = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            let [.., high, low] = (state >> 48).to_be_bytes();
            f64::from(u16::from_be_bytes([high, low])) / 65536.0
        };
        let coefficients = [0; 8].map(|_| {
            let size = match next() {
                x if x < 0.2 => 1e-6,
                x if x < 0.4 => 1e-2,
                x if x < 0.9 => 1.0,
                _ => 1e3,
            };
            [(2.0 * next() - 1.0) * size]
        });
        Dense {
            t0: 0.0,
            h: 1.0,
            coefficients,
        }
    }

    #[test]
    fn bounds_hold_all_values_and_slopes() {
        for seed in 0..2000 {
            let dense = arbitrary(seed);
            let (values, slopes) = (dense.bounds(0), dense.slope_bounds(0));
            for s in (0..=500).map(|s| f64::from(s) / 500.0) {
                let (value, slope) = (dense.component(0, s), dense.slope(s)[0]);
                assert!(
                    values.contains(value) && slopes.contains(slope),
                    "{seed} {s}"
                );
            }
        }
    }

    /// Each term alone comes within 2 % of its bound: no bound is wider than necessary.
    #[test]
    fn bounds_are_close_for_each_term() {
        for term in 2..8 {
            let mut coefficients = [[0.0]; 8];
            coefficients[term] = [1.0];
            let dense = Dense {
                t0: 0.0,
                h: 1.0,
                coefficients,
            };
            let largest = |of: &dyn Fn(f64) -> f64| {
                (0..=1000)
                    .map(|s| of(f64::from(s) / 1000.0).abs())
                    .fold(0.0, f64::max)
            };
            let value = largest(&|s| dense.component(0, s)) / dense.bounds(0).greatest;
            let slope = largest(&|s| dense.slope(s)[0]) / dense.slope_bounds(0).greatest;
            assert!(value > 0.98 && value <= 1.0, "term {term}: {value}");
            assert!(slope > 0.98 && slope <= 1.0, "term {term}: {slope}");
        }
    }

    #[test]
    fn magnitudes_of_bounds() {
        let bounds = |least, greatest| Bounds { least, greatest };
        assert_eq!(bounds(-3.0, -2.0).magnitude(), bounds(2.0, 3.0));
        assert_eq!(bounds(-3.0, 2.0).magnitude(), bounds(0.0, 3.0));
        assert_eq!(bounds(1.0, 2.0).magnitude(), bounds(1.0, 2.0));
        assert!(bounds(1.0, 2.0).have_sign(true) && !bounds(0.0, 2.0).have_sign(true));
        assert!(bounds(-1.0, -0.5).have_sign(false) && !bounds(-1.0, 0.5).have_sign(false));
    }
}
