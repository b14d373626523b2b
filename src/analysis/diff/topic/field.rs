//! Statistics of the differences of one field.

use crate::analysis::diff::tolerance::Tolerance;
use crate::run::time::seconds;
use schemars::JsonSchema;
use serde::Serialize;

/// Difference of one field; B − A throughout.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct FieldDifference {
    /// Name of the field or derived quantity.
    pub field: String,
    /// The unit, empty for pure numbers.
    pub unit: String,
    /// Whether it is derived from fields.
    pub is_derived: bool,
    /// Number of pairs of numbers.
    pub count: u64,
    /// The difference with the largest magnitude.
    pub largest: f64,
    /// Time of that difference, s.
    pub at: f64,
    /// A's and B's value then; absent for an angle between two directions, and if all values are identical.
    pub values: Option<[f64; 2]>,
    /// Root mean square of the differences.
    pub rms: f64,
    /// The largest magnitude of the field in either run.
    pub scale: f64,
    /// Time of the first pair that is not bit-identical, s; absent if there is none.
    pub first_different: Option<f64>,
    /// Number of pairs that differ by more than the tolerance; of a derived quantity: pairs in which a field that it is
    /// derived from does.
    pub beyond: u64,
    /// The tolerance; of a derived quantity: that of the first field that it is derived from.
    pub tolerance: Tolerance,
    /// Combined integration error of A and B; absent if unknown.
    pub integration_error: Option<f64>,
    /// Whether the difference is below three times the integration error and rounding.
    pub is_within_integration_error: bool,
}

impl FieldDifference {
    /// The largest difference relative to the largest magnitude of the field; 0 if the field is 0.
    pub fn relative(&self) -> f64 {
        let relative = self.largest.abs() / self.scale;
        if relative.is_finite() { relative } else { 0.0 }
    }
}

/// Safety factor of the estimated integration error.
const SAFETY: f64 = 3.0;
/// Allowance for rounding, ulp.
const ROUNDINGS: f64 = 8.0;

/// The differences of one field so far.
#[derive(Clone, Debug, Default)]
pub(super) struct FieldTally {
    /// The result so far, without name, RMS and errors.
    pub(super) found: FieldDifference,
    /// The sum of the squares of all finite differences.
    squares: f64,
}

impl FieldTally {
    pub(super) fn new(tolerance: Tolerance) -> Self {
        Self {
            found: FieldDifference {
                tolerance,
                ..FieldDifference::default()
            },
            squares: 0.0,
        }
    }

    /// Adds a number of A and one of B.
    #[inline]
    pub(super) fn add(&mut self, time_ns: u64, a: f64, b: f64) {
        self.found.count += 1;
        if a.is_finite() {
            self.found.scale = self.found.scale.max(a.abs());
        }
        if a.to_bits() != b.to_bits() {
            let is_beyond = !self.found.tolerance.allows(a, b);
            self.add_different(time_ns, a, b, is_beyond);
        }
    }

    /// Adds derived numbers of A and B, of which the fields that they are derived from decide whether they are beyond the
    /// tolerance.
    pub(super) fn add_derived(&mut self, time_ns: u64, [a, b]: [f64; 2], is_beyond: bool) {
        self.found.count += 1;
        if a != b {
            self.add_different(time_ns, a, b, is_beyond);
        }
    }

    fn add_different(&mut self, time_ns: u64, a: f64, b: f64, is_beyond: bool) {
        let found = &mut self.found;
        found.first_different.get_or_insert(seconds(time_ns));
        found.beyond += u64::from(is_beyond);
        if !(a.is_finite() && b.is_finite()) {
            return;
        }
        // The difference of two finite numbers may overflow, and JSON has no infinity.
        let difference = (b - a).clamp(f64::MIN, f64::MAX);
        found.scale = found.scale.max(b.abs());
        self.squares += difference * difference;
        if difference.abs() > found.largest.abs() {
            (found.largest, found.at) = (difference, seconds(time_ns));
            found.values = Some([a, b]);
        }
    }

    /// Whether all pairs agree within the tolerance.
    pub(super) fn is_equal(&self) -> bool {
        self.found.beyond == 0
    }

    /// The differences of a field, whose integrations have this error.
    pub(super) fn report(
        &self,
        field: &str,
        unit: &str,
        integration_error: Option<f64>,
    ) -> FieldDifference {
        let found = &self.found;
        let bound =
            integration_error.map(|error| SAFETY * error + ROUNDINGS * f64::EPSILON * found.scale);
        let differs = found.first_different.is_some();
        FieldDifference {
            field: field.to_owned(),
            unit: unit.to_owned(),
            rms: rms(self.squares, found.count),
            integration_error,
            is_within_integration_error: bound
                .is_some_and(|bound| differs && found.largest.abs() <= bound),
            ..found.clone()
        }
    }
}

/// The RMS of `count` numbers with this sum of squares.
pub(in crate::analysis::diff) fn rms(squares: f64, count: u64) -> f64 {
    (squares / count.max(1) as f64).sqrt().min(f64::MAX)
}
