//! The differences of one field: its numbers in A and B over time, summed up.

use super::moments::Moments;
use super::tolerance::Tolerance;
use crate::physics::math::ulp_distance;
use crate::telemetry::payload::Value;
use schemars::JsonSchema;
use serde::Serialize;

/// More doubles between two numbers than these are no rounding: a sum of thousands of terms, as long as a run has steps,
/// loses some thousand units of the last place, not 2^16.
const ROUNDING_ULPS: u64 = 1 << 16;

/// A field that both have.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct FieldDifference {
    /// The field.
    pub field: String,
    /// The field's unit.
    pub unit: String,
    /// Whether it is computed from others: angles between directions.
    pub is_derived: bool,
    /// Pairs of numbers.
    pub count: u64,
    /// Pairs of which one is not a number.
    pub not_numbers: u64,
    /// Pairs of texts, booleans or other things that differ.
    pub other_values: u64,
    /// Pairs of a zero and a negative zero.
    pub signs_of_zero: u64,
    /// Pairs of NaNs with different bits.
    pub nan_bits: u64,
    /// The difference of largest magnitude; the largest double stands for all that are larger.
    pub largest: f64,
    /// When it was largest, s.
    pub at: f64,
    /// Root of the mean square of the differences.
    pub rms: f64,
    /// Mean of the differences.
    pub mean: f64,
    /// The largest magnitude of the field in either run.
    pub scale: f64,
    /// The largest difference over the scale.
    pub relative: f64,
    /// The largest number of doubles from one to the other, where it is all there is: below 2^16.
    pub ulp: Option<u64>,
    /// When the two were first not the same to the last bit, s.
    pub first_different: Option<f64>,
    /// When they were first apart by more than the tolerance, s.
    pub first_beyond: Option<f64>,
    /// How many pairs are apart by more than the tolerance.
    pub beyond: u64,
    /// The tolerance.
    pub tolerance: Tolerance,
    /// Largest error of interpolating one run at the other's times, as estimated by leaving out every
    /// eighth message; absent where nothing was interpolated.
    pub interpolation_error: Option<f64>,
    /// The errors of both integrators together, if they are known.
    pub floor: Option<f64>,
    /// What the difference may be owed to beside the motions: the errors of the integrators and of interpolation,
    /// as far as they are known, with what their estimates may miss.
    pub errors: Option<f64>,
    /// Whether the difference is not larger than those.
    pub is_below_floor: bool,
}

/// By how much an error may be larger than its estimate. The integrators' are estimated from a run whose own error is as
/// large where both are rounding, and that of interpolation in the middle of every eighth gap.
const UNDERESTIMATED: f64 = 3.0;
/// Roundings of a number that is computed in two ways, in units of the largest that it gets, 2^-52 of it.
const ROUNDINGS: f64 = 8.0;

/// What a difference may be owed to beside the motions, from the integrators' errors, the error of interpolation and
/// the size of the field.
pub(super) fn errors(floor: Option<f64>, interpolation: Option<f64>, scale: f64) -> Option<f64> {
    if floor.is_none() && interpolation.is_none() {
        return None;
    }
    let estimates = floor.unwrap_or(0.0) + interpolation.unwrap_or(0.0);
    Some(UNDERESTIMATED * estimates + ROUNDINGS * f64::EPSILON * scale)
}

/// What is known of a field from its pairs so far, in memory that doesn't grow with their number.
#[derive(Clone, Debug, Default)]
pub(super) struct FieldTally {
    tolerance: Tolerance,
    count: u64,
    not_numbers: u64,
    other_values: u64,
    signs_of_zero: u64,
    nan_bits: u64,
    largest: f64,
    at_ns: u64,
    moments: Moments,
    scale: f64,
    ulp: u64,
    first_different: Option<u64>,
    first_beyond: Option<u64>,
    beyond: u64,
    /// When the difference first reached 2^exponent, for rising exponents.
    rungs: Vec<(i32, u64)>,
    interpolation_error: f64,
}

impl FieldTally {
    pub(super) fn new(tolerance: Tolerance) -> Self {
        Self {
            tolerance,
            ..Self::default()
        }
    }

    /// Takes in A's and B's number of a pair.
    #[inline]
    pub(super) fn add(&mut self, time_ns: u64, a: f64, b: f64) {
        if a.to_bits() == b.to_bits() && !a.is_nan() {
            self.count += 1;
            if a.is_finite() {
                self.scale = self.scale.max(a.abs());
            }
            return;
        }
        self.add_different(time_ns, a, b);
    }

    fn add_different(&mut self, time_ns: u64, a: f64, b: f64) {
        if a.is_nan() && b.is_nan() {
            if a.to_bits() != b.to_bits() {
                self.nan_bits += 1;
                self.first_different.get_or_insert(time_ns);
            }
            return;
        }
        self.signs_of_zero += u64::from(a == b);
        self.ulp = self.ulp.max(ulp_distance(a, b));
        self.add_pair(time_ns, [a, b], b - a, self.tolerance.allows(a, b));
    }

    /// Takes in two numbers that are not the same.
    fn add_pair(&mut self, time_ns: u64, [a, b]: [f64; 2], difference: f64, is_allowed: bool) {
        self.note_difference(time_ns, is_allowed);
        let difference = if a.is_finite() && b.is_finite() {
            // What is more than the largest double is told as that.
            difference.clamp(f64::MIN, f64::MAX)
        } else {
            difference
        };
        if !difference.is_finite() {
            self.not_numbers += 1;
            return;
        }
        self.count += 1;
        self.scale = self.scale.max(a.abs()).max(b.abs());
        self.moments.add(difference);
        if difference.abs() > self.largest.abs() {
            self.largest = difference;
            self.at_ns = time_ns;
            let exponent = exponent(difference);
            if self.rungs.last().is_none_or(|(last, _)| *last < exponent) {
                self.rungs.push((exponent, time_ns));
            }
        }
    }

    fn note_difference(&mut self, time_ns: u64, is_allowed: bool) {
        self.first_different.get_or_insert(time_ns);
        if !is_allowed {
            self.first_beyond.get_or_insert(time_ns);
            self.beyond += 1;
        }
    }

    /// Takes in A's and B's values of a pair, and tells whether they are the same to the last bit.
    pub(super) fn add_values(&mut self, time_ns: u64, a: &Value, b: &Value) -> bool {
        let numbers = [a.number(), b.number()];
        match (a, b) {
            (Value::Real(x), Value::Real(y)) => {
                self.add(time_ns, *x, *y);
                return x.to_bits() == y.to_bits();
            }
            _ if a == b => {
                if !numbers[0].is_nan() {
                    self.add(time_ns, numbers[0], numbers[1]);
                }
                return true;
            }
            _ if a.is_number() && b.is_number() => match (whole(a), whole(b)) {
                // One and 1.0.
                (Some(x), Some(y)) if x == y => self.add(time_ns, numbers[0], numbers[0]),
                (Some(x), Some(y)) => {
                    let is_allowed = self.tolerance.allows_integers(x, y);
                    self.add_pair(time_ns, numbers, (y - x) as f64, is_allowed);
                }
                _ => self.add(time_ns, numbers[0], numbers[1]),
            },
            // One of them is a number.
            _ if a.is_number() || b.is_number() => {
                self.not_numbers += 1;
                self.note_difference(time_ns, false);
            }
            _ => {
                self.other_values += 1;
                self.note_difference(time_ns, false);
            }
        }
        false
    }

    /// Takes in how large the error of interpolation can be.
    pub(super) fn add_interpolation_error(&mut self, error: f64) {
        self.interpolation_error = self.interpolation_error.max(error);
    }

    /// The magnitude of the largest difference.
    pub(super) fn largest(&self) -> f64 {
        self.largest.abs()
    }

    /// The largest magnitude of the field in either run.
    pub(super) fn scale(&self) -> f64 {
        self.scale
    }

    /// How large the error of interpolation is.
    pub(super) fn interpolation_error(&self) -> f64 {
        self.interpolation_error
    }

    /// Whether all pairs agree within the tolerance.
    pub(super) fn is_equal(&self) -> bool {
        self.beyond == 0
    }

    /// When the difference first reached the threshold, rounded up to the next power of two; ns.
    pub(super) fn reached(&self, threshold: f64) -> Option<u64> {
        let needed = if threshold > 0.0 {
            exponent(threshold) + 1
        } else {
            i32::MIN
        };
        let rung = self.rungs.iter().find(|(exponent, _)| *exponent >= needed);
        rung.map(|(_, time_ns)| *time_ns)
    }

    /// What was found, but for the integrators' errors.
    pub(super) fn report(&self, field: &str, unit: &str, is_interpolated: bool) -> FieldDifference {
        FieldDifference {
            field: field.to_owned(),
            unit: unit.to_owned(),
            count: self.count,
            not_numbers: self.not_numbers,
            other_values: self.other_values,
            signs_of_zero: self.signs_of_zero,
            nan_bits: self.nan_bits,
            largest: self.largest,
            at: seconds(self.at_ns),
            rms: self.moments.rms(self.count),
            mean: self.moments.mean(self.count),
            scale: self.scale,
            relative: if self.scale > 0.0 {
                self.largest.abs() / self.scale
            } else {
                0.0
            },
            ulp: (self.ulp < ROUNDING_ULPS).then_some(self.ulp),
            first_different: self.first_different.map(seconds),
            first_beyond: self.first_beyond.map(seconds),
            beyond: self.beyond,
            tolerance: self.tolerance,
            interpolation_error: is_interpolated.then_some(self.interpolation_error),
            ..FieldDifference::default()
        }
    }
}

/// The integer that a number is, if it is one; beyond these bounds doubles are.
fn whole(value: &Value) -> Option<i128> {
    const LARGEST: f64 = 1e30;
    match value {
        Value::Real(real) => {
            (real.trunc() == *real && real.abs() < LARGEST).then_some(*real as i128)
        }
        other => other.as_integer(),
    }
}

/// The exponent of the largest power of two that is not larger than a magnitude.
fn exponent(value: f64) -> i32 {
    libm::frexp(value.abs()).1 - 1
}

/// A time in s.
pub(super) fn seconds(time_ns: u64) -> f64 {
    time_ns as f64 / 1e9
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thresholds_are_reached_within_a_factor_of_two() {
        let mut tally = FieldTally::new(Tolerance::default());
        for i in 0..1000_u64 {
            tally.add(i, 0.0, 1e-9 * i as f64);
        }
        for threshold in [1e-9, 3.3e-8, 5e-7] {
            let time = tally.reached(threshold).unwrap() as f64 * 1e-9;
            assert!(
                time >= threshold * 0.999_999 && time <= 2.0 * threshold + 1e-9,
                "{threshold}: {time}"
            );
        }
        assert_eq!(tally.reached(1e-6), None);
        // Anything at all.
        assert_eq!(tally.reached(0.0), Some(1));
    }

    #[test]
    fn ulps_are_told_of_roundings_only() {
        for (distance, told) in [(1, Some(1)), (65_535, Some(65_535)), (65_536, None)] {
            let mut tally = FieldTally::new(Tolerance::default());
            tally.add(0, 1.0, f64::from_bits(1.0_f64.to_bits() + distance));
            assert_eq!(tally.report("x", "", false).ulp, told);
        }
    }
}
