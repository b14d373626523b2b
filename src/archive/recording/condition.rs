//! Kinds of files.

use schemars::JsonSchema;
use serde::Serialize;

/// Kind of the file, as far as opening it shows: damage inside of chunks is found in reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Condition {
    /// An MCAP file that toprise did not write.
    #[serde(rename = "not a toprise recording")]
    Foreign,
    /// A recording with its end record, readable throughout.
    #[serde(rename = "complete")]
    Whole,
    /// A recording without an end record: the run was cut off, but nothing else is wrong.
    Interrupted,
    /// A recording with unreadable parts.
    Damaged,
}

impl Condition {
    /// In a word or two.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Foreign => "not a toprise recording",
            Self::Whole => "complete",
            Self::Interrupted => "interrupted",
            Self::Damaged => "damaged",
        }
    }
}
