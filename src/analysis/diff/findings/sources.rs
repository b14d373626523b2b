//! The fields that findings are made of: options that select topics or fields, or that tolerate differences, apply to
//! findings, too.

use super::finding::Finding;
use super::quantity::Quantity;
use crate::analysis::diff::tolerance::{Options, Tolerance};
use crate::telemetry::fields::{NumberField, energy, events, nutation, state, torque};

impl Quantity {
    /// The fields that a number of this quantity is made of, the one with its unit first.
    pub(super) fn fields(self) -> Vec<NumberField> {
        match self {
            Self::MeanCrossing { .. } => vec![nutation::START, nutation::THETA_MEAN],
            Self::End { .. }
            | Self::FirstReach { .. }
            | Self::Inversion
            | Self::FirstLoop
            | Self::FirstEvent { .. }
            | Self::FirstRoll
            | Self::Loops { .. }
            | Self::Hops { .. } => vec![events::TIME],
            Self::FinalRollTheta => vec![events::THETA],
            Self::MeanTheta { .. } => vec![nutation::THETA_MEAN],
            Self::MeanPrecession { .. } => vec![nutation::PHI_DOT_MEAN],
            Self::MeanSpin { .. } => vec![nutation::PSI_DOT_MEAN],
            Self::AxialSpin { .. } => vec![state::PSI_DOT, state::PHI_DOT, state::THETA],
            Self::AxisDistance { .. } => vec![state::THETA, state::PHI],
            Self::InclinationDistance { .. } => vec![state::THETA],
            Self::PhaseLead { .. } => vec![nutation::START],
            Self::Amplitude { .. } => vec![nutation::THETA_DOT_MAX, nutation::THETA_DOT_MIN],
            Self::EnergyLost { .. } => vec![energy::TOTAL],
            Self::TorqueDifference { .. } => torque::FRICTION_BODY.components().to_vec(),
        }
    }

    /// Whether the options leave the fields of the quantity in the comparison.
    pub(super) fn is_selected(self, options: &Options) -> bool {
        self.fields().into_iter().all(|field| {
            let topic = field.topic().name();
            let is_of_topics =
                options.topics.is_empty() || options.topics.iter().any(|name| name == topic);
            is_of_topics && !options.tolerances.ignores(&field.to_string())
        })
    }

    /// The tolerance of a number.
    fn tolerance(self, options: &Options) -> Tolerance {
        let field = self.fields().into_iter().next();
        field.map_or_else(Tolerance::default, |field| {
            options
                .tolerances
                .for_field(field.topic().name(), field.path())
        })
    }
}

impl Finding {
    /// Marks the finding as equal if the numbers of both runs are within the tolerances. An event that only one run has never
    /// is.
    pub(super) fn tolerate(&mut self, options: &Options) {
        let tolerance = self.quantity.tolerance(options);
        self.is_tolerated = match (self.a.zip(self.b), self.difference) {
            (Some((a, b)), Some(_)) => a != b && tolerance.allows(a, b),
            (None, Some(difference)) => {
                let bound = tolerance
                    .abs
                    .max(tolerance.rel * self.quantity.scale().unwrap_or(0.0));
                difference.abs() <= bound && difference != 0.0
            }
            (_, None) => false,
        };
    }
}
