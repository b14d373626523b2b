//! Root mean square without overflow.

/// Streaming sum of squares.
///
/// Scaled by a power of two near the largest number to avoid overflow without rounding.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moments {
    /// Zero as long as all numbers are.
    unit: f64,
    squares: f64,
}

impl Moments {
    /// Takes in a finite number.
    #[inline]
    pub(super) fn add(&mut self, number: f64) {
        if number == 0.0 {
            return;
        }
        if number.abs() >= 2.0 * self.unit {
            let unit = libm::ldexp(1.0, libm::frexp(number.abs()).1 - 1);
            let ratio = self.unit / unit;
            self.squares *= ratio * ratio;
            self.unit = unit;
        }
        let scaled = number / self.unit;
        self.squares += scaled * scaled;
    }

    /// The RMS over `count` numbers; numbers not added count as zero.
    pub(super) fn rms(&self, count: u64) -> f64 {
        let rms = (self.squares / count.max(1) as f64).sqrt() * self.unit;
        rms.min(f64::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_of_any_size_have_a_mean() {
        for scale in [1.0, 1e-200, 5e-324, 4e307] {
            let mut moments = Moments::default();
            for number in [1.0, -2.0, 4.0] {
                moments.add(number * scale);
            }
            let near = |found: f64, expected: f64| {
                let relative = (found - expected).abs() / expected;
                // The smallest double has no fractions.
                relative < 1e-15 || (found - expected).abs() < 5e-324 * 1.01
            };
            assert!(
                near(moments.rms(3), 7_f64.sqrt() * scale),
                "{scale}: {moments:?}"
            );
        }
        let mut moments = Moments::default();
        for number in [f64::MAX, f64::MIN, f64::MIN, 1.0] {
            moments.add(number);
        }
        assert!((moments.rms(3) / f64::MAX - 1.0).abs() < 1e-15);
        assert_eq!(Moments::default().rms(5), 0.0);
    }
}
