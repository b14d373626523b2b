//! Statistics of the differences of one field.

use super::tolerance::Tolerance;
use schemars::JsonSchema;
use serde::Serialize;

/// Difference of one field; B − A throughout.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct FieldDifference {
    /// Name of the field or derived quantity.
    pub field: String,
    /// Its unit, empty for pure numbers.
    pub unit: String,
    /// Whether it is derived from fields.
    pub is_derived: bool,
    /// Number of pairs of numbers.
    pub count: u64,
    /// The difference with the largest magnitude.
    pub largest: f64,
    /// Time of that, s.
    pub at: f64,
    /// Root of the mean square of the differences.
    pub rms: f64,
    /// The largest magnitude of the field in either run.
    pub scale: f64,
    /// Time of the first pair that is not bit-identical, s; absent if there is none.
    pub first_different: Option<f64>,
    /// Number of pairs that differ by more than the tolerance.
    pub beyond: u64,
    /// The tolerance.
    pub tolerance: Tolerance,
    /// Combined integration error of A and B; absent if unknown.
    pub floor: Option<f64>,
    /// Whether the difference is below three times the integration error and rounding.
    pub is_below_floor: bool,
}

/// Safety factor of the estimated integration error.
const UNDERESTIMATED: f64 = 3.0;
/// Allowance for rounding, ulp.
const ROUNDINGS: f64 = 8.0;

/// The differences of one field so far.
#[derive(Clone, Debug, Default)]
pub(super) struct FieldTally {
    tolerance: Tolerance,
    count: u64,
    largest: f64,
    at_ns: u64,
    moments: Moments,
    scale: f64,
    first_different: Option<u64>,
    beyond: u64,
}

impl FieldTally {
    pub(super) fn new(tolerance: Tolerance) -> Self {
        Self {
            tolerance,
            ..Self::default()
        }
    }

    /// Takes a number of A and one of B.
    #[inline]
    pub(super) fn add(&mut self, time_ns: u64, a: f64, b: f64) {
        self.count += 1;
        if a.is_finite() {
            self.scale = self.scale.max(a.abs());
        }
        if a.to_bits() != b.to_bits() {
            self.add_different(time_ns, a, b);
        }
    }

    fn add_different(&mut self, time_ns: u64, a: f64, b: f64) {
        self.first_different.get_or_insert(time_ns);
        if !self.tolerance.allows(a, b) {
            self.beyond += 1;
        }
        if !(a.is_finite() && b.is_finite()) {
            return;
        }
        let difference = (b - a).clamp(f64::MIN, f64::MAX);
        self.scale = self.scale.max(b.abs());
        self.moments.add(difference);
        if difference.abs() > self.largest.abs() {
            (self.largest, self.at_ns) = (difference, time_ns);
        }
    }

    /// The largest magnitude of a difference.
    pub(super) fn largest(&self) -> f64 {
        self.largest.abs()
    }

    /// Whether all pairs agree within the tolerance.
    pub(super) fn is_equal(&self) -> bool {
        self.beyond == 0
    }

    /// The differences; `floor` are the integrators' errors.
    pub(super) fn report(&self, field: &str, unit: &str, floor: Option<f64>) -> FieldDifference {
        let errors = floor.map(|f| UNDERESTIMATED * f + ROUNDINGS * f64::EPSILON * self.scale);
        let differs = self.first_different.is_some();
        FieldDifference {
            field: field.to_owned(),
            unit: unit.to_owned(),
            is_derived: false,
            count: self.count,
            largest: self.largest,
            at: seconds(self.at_ns),
            rms: self.moments.rms(self.count),
            scale: self.scale,
            first_different: self.first_different.map(seconds),
            beyond: self.beyond,
            tolerance: self.tolerance,
            floor,
            is_below_floor: errors.is_some_and(|e| differs && self.largest.abs() <= e),
        }
    }
}

/// Streaming sum of squares.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moments {
    squares: f64,
}

impl Moments {
    /// Takes in a finite number.
    #[inline]
    pub(super) fn add(&mut self, number: f64) {
        self.squares += number * number;
    }

    /// The RMS over `count` numbers; numbers not added count as zero.
    pub(super) fn rms(&self, count: u64) -> f64 {
        (self.squares / count.max(1) as f64).sqrt().min(f64::MAX)
    }
}

/// A time in s.
pub(super) fn seconds(time_ns: u64) -> f64 {
    time_ns as f64 / 1e9
}
