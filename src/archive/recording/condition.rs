//! Kinds of files.

use schemars::JsonSchema;
use serde::Serialize;

/// State of the file as determined by opening it; damage inside chunks is only found on reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Condition {
    /// An MCAP file that toprise did not write.
    #[serde(rename = "not a toprise recording")]
    Foreign,
    /// A recording with its end record, readable throughout.
    #[serde(rename = "complete")]
    Whole,
    /// A recording without an end record: the run was interrupted, without other damage.
    Interrupted,
    /// A recording with unreadable parts.
    Damaged,
}

impl Condition {
    /// Short name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Foreign => "not a toprise recording",
            Self::Whole => "complete",
            Self::Interrupted => "interrupted",
            Self::Damaged => "damaged",
        }
    }
}
