//! Why a law has no fit.

use super::apart::Apart;
use crate::fit::search::step_limit::MAX_RATIO;
use crate::run::simulation::StopReason;
use crate::words::{Piece, Sentence, sentence};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Why a law has no fit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Failure {
    /// The model ends before the data.
    ModelEnds {
        /// End of the model, s.
        end: f64,
        /// Why it ends.
        reason: StopReason,
        /// End of the data, s.
        needed: f64,
    },
    /// Motions take many times the steps of that at the start.
    TooManySteps,
    /// Model and data don't meet.
    Apart(Apart),
    /// Another error, or one of a report without facts, in words.
    Error(String),
}

impl Failure {
    /// What is wrong.
    pub fn sentence(&self) -> Sentence {
        match self {
            Self::ModelEnds {
                end,
                reason,
                needed,
            } => sentence!(
                "the model ends at t = {} ({}), the data at {}",
                Piece::time(*end),
                reason.sentence(),
                Piece::time(*needed)
            ),
            Self::TooManySteps => sentence!(
                "no minimum was found: the motions that come closest to the data take more than {} times the integrator steps of that at the start",
                MAX_RATIO.to_string()
            ),
            Self::Apart(seen) => seen.sentence(false),
            Self::Error(text) => text.into(),
        }
    }
}

/// The members of a failure in reports.
#[derive(Serialize, Deserialize, JsonSchema)]
pub(super) struct FailureMembers {
    /// Why there is no fit; other members are then meaningless.
    #[serde(skip_serializing_if = "Option::is_none")]
    failure: Option<String>,
    /// The failure with its numbers.
    #[serde(skip_serializing_if = "Option::is_none")]
    cause: Option<Failure>,
}

impl FailureMembers {
    #[allow(clippy::ref_option, reason = "serde passes the field")]
    pub(super) fn serialize<S: serde::Serializer>(
        failure: &Option<Failure>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        let members = Self {
            failure: failure
                .as_ref()
                .map(|failure| failure.sentence().to_string()),
            cause: failure.clone(),
        };
        Serialize::serialize(&members, serializer)
    }

    pub(super) fn deserialize<'de, D: serde::Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<Failure>, D::Error> {
        let Self { failure, cause } = Deserialize::deserialize(deserializer)?;
        // Reports of 1.0 have no facts.
        Ok(cause.or_else(|| failure.map(Failure::Error)))
    }
}
