//! The normal forces of two runs.

use crate::analysis::history::Extent;
use crate::words::{Piece, Sentence, sentence, span};
use schemars::JsonSchema;
use serde::Serialize;

/// The least and the greatest normal force of the table in the samples of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct NormalForce {
    /// The least, N; 0 if the peg leaves the table.
    pub least: f64,
    /// The greatest, N.
    pub greatest: f64,
}

/// The normal forces of both runs; absent if they are not recorded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct NormalForces {
    /// The normal force of A.
    pub a: Option<NormalForce>,
    /// The normal force of B.
    pub b: Option<NormalForce>,
}

impl From<Extent> for NormalForce {
    fn from(force: Extent) -> Self {
        Self {
            least: force.least,
            greatest: force.greatest,
        }
    }
}

impl NormalForce {
    fn words(self) -> Sentence {
        if self.least == self.greatest {
            return sentence!("a constant {}", Piece::number(self.least, 3, "N"));
        }
        span([self.least, self.greatest], 3, "N")
    }
}

impl NormalForces {
    /// Both normal forces; `None` if their words are the same, or one is not known.
    pub fn sentence(&self) -> Option<Sentence> {
        let (a, b) = self.a.zip(self.b)?;
        let [a, b] = [a, b].map(NormalForce::words);
        (a.to_string() != b.to_string()).then(|| sentence!("Normal force: {} in A, {} in B.", a, b))
    }
}
