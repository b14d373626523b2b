//! The result of a comparison as a whole.

use schemars::JsonSchema;
use serde::Serialize;

/// The result of a comparison as a whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Both have the same messages, to the last bit, and nothing else differs either.
    Identical,
    /// All values are the same, to the last bit, but something else differs: the encoding, attachments, metadata,
    /// the scenario's name.
    SameValues,
    /// Both have the same messages, which agree within the tolerances; or what was not ignored is the same.
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
            Self::Identical => "Identical, to the last bit",
            Self::SameValues => "All values are the same, to the last bit; the files differ",
            Self::Equal => "Equal within the tolerances",
            Self::Agreeing => "Equal as far as they were compared",
            Self::Different => "Different",
        }
    }
}
