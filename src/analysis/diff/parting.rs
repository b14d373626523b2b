//! In which order fields parted: causes before effects.

use super::field::{FieldTally, seconds};
use crate::telemetry::Quantity;
use crate::telemetry::fields::NumberField;
use schemars::JsonSchema;
use serde::Serialize;

/// A field parts where its difference first reaches this part of its largest magnitude: well above the tolerances of
/// integration, 1e-12 by default, and what grows from them, well below what can be seen.
const PARTED: f64 = 1e-6;
/// Where the integrators' errors are larger, the difference must be so many times as large as they are: the
/// times of threshold crossings are then off by a tenth at most where differences grow in proportion to time.
const ABOVE_FLOOR: f64 = 10.0;

/// When a field parted.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Parting {
    /// When the difference reached the threshold, s. The threshold is rounded up to the next power of two.
    pub time: f64,
    /// Topic and field.
    pub field: String,
    /// The kind of quantity that the field is.
    pub kind: QuantityKind,
    /// The threshold, in the field's unit.
    pub threshold: f64,
}

/// Kinds of quantities, from cause to effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum QuantityKind {
    /// A force.
    Force,
    /// A torque.
    Torque,
    /// An acceleration.
    Acceleration,
    /// A velocity or the rate of an angle.
    Rate,
    /// An angle or a direction.
    Angle,
    /// Something else.
    Other,
}

impl QuantityKind {
    /// The kind of a field, if it is one of the table.
    fn of(number: Option<NumberField>) -> Self {
        match number.map(|number| number.leaf().quantity) {
            Some(Quantity::Force) => Self::Force,
            Some(Quantity::Torque) => Self::Torque,
            Some(Quantity::Acceleration) => Self::Acceleration,
            Some(Quantity::Rate | Quantity::Velocity) => Self::Rate,
            Some(Quantity::Angle | Quantity::Direction | Quantity::Orientation) => Self::Angle,
            _ => Self::Other,
        }
    }

    /// The kind in a word.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Force => "force",
            Self::Torque => "torque",
            Self::Acceleration => "acceleration",
            Self::Rate => "rate",
            Self::Angle => "angle",
            Self::Other => "other",
        }
    }
}

impl Parting {
    /// Finds when a field parted, if it did, with the integrators' error.
    pub(super) fn find(
        name: String,
        number: Option<NumberField>,
        tally: &FieldTally,
        floor: f64,
    ) -> Option<Self> {
        let threshold = (PARTED * tally.scale()).max(ABOVE_FLOOR * floor);
        Some(Self {
            time: seconds(tally.reached(threshold)?),
            kind: QuantityKind::of(number),
            field: name,
            threshold,
        })
    }
}
