//! The result of a comparison as a whole.

use schemars::JsonSchema;
use serde::Serialize;

/// The result of a comparison as a whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Messages are bit-identical and nothing else differs.
    Identical,
    /// All values are bit-identical, but encoding, attachments, metadata or the scenario name differ.
    SameValues,
    /// All compared messages agree within the tolerances.
    Equal,
    /// The compared parts agree within the tolerances, but not every message was compared: parts of a run can't be read, or
    /// one has samples between those of the other.
    Agreeing,
    /// Something differs.
    Different,
}

impl Verdict {
    /// The verdict in words.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Identical => "Identical (bit for bit)",
            Self::SameValues => "All values identical; the files differ",
            Self::Equal => "Equal within the tolerances",
            Self::Agreeing => "Equal in the compared part",
            Self::Different => "Different",
        }
    }
}
