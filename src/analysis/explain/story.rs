//! Why a top moves as it does: claims in the order of time.

use super::causes;
use super::claim::Claim;
use super::evidence::Evidence;
use super::time_span::TimeSpan;
use crate::words::{Sentence, sentence};
use schemars::JsonSchema;
use serde::{Serialize, Serializer};

/// The causes of a motion, in the order of time.
///
/// Each claim is carried by numbers of the run. If none of the known causes is shown by them, there is no claim.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Story {
    /// The claims, with their numbers and the time in which they hold.
    #[serde(serialize_with = "with_time_spans")]
    #[schemars(with = "Vec<TimedClaim>")]
    pub claims: Vec<Claim>,
    /// Time of the last sample, s; absent if parts of the run are missing, so that no causes were looked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub end: Option<f64>,
}

/// A claim in reports.
#[derive(Serialize, JsonSchema)]
struct TimedClaim {
    #[serde(flatten)]
    claim: Claim,
    /// The time in which it holds.
    interval: TimeSpan,
}

fn with_time_spans<S: Serializer>(claims: &[Claim], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(claims.iter().map(|claim| TimedClaim {
        interval: claim.interval(),
        claim: claim.clone(),
    }))
}

impl Story {
    /// The claims as sentences, each with its time where that is not the whole run; empty if parts of the run are missing.
    pub fn sentences(&self) -> Vec<Sentence> {
        let Some(end) = self.end else {
            return Vec::new();
        };
        if self.claims.is_empty() {
            return vec![sentence!(
                "The numbers of this run show none of the causes that are checked."
            )];
        }
        self.claims
            .iter()
            .map(|claim| {
                let time_span = claim.interval().within_run(end);
                time_span.introduce(claim.sentence())
            })
            .collect()
    }

    /// The sentences as a paragraph; `None` if parts of the run are missing.
    pub fn paragraph(&self) -> Option<Sentence> {
        self.end?;
        Some(Sentence::join(self.sentences(), " "))
    }

    /// The paragraph as text.
    pub fn text(&self) -> Option<String> {
        self.paragraph().map(|paragraph| paragraph.to_string())
    }
}

/// The causes of a motion whose samples and events are all known.
pub(super) fn story(evidence: &Evidence) -> Story {
    Story {
        claims: causes::claims(evidence),
        end: evidence.history.states.map(|[_, last]| last.time),
    }
}
