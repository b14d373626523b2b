//! Unreadable or skipped parts of a file.

use crate::run::time::seconds;
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt;

/// A part of a file that can't be read.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
#[schemars(rename = "LossReport")]
pub struct Loss {
    /// Its start in the file, bytes.
    pub offset: u64,
    /// Length, bytes.
    pub length: u64,
    /// Start of the time span with lost messages, ns; absent if none are lost.
    pub from_ns: Option<u64>,
    /// End of that span, ns; absent if unknown.
    pub to_ns: Option<u64>,
    /// Whether it was skipped although it may be intact.
    #[serde(skip)]
    pub is_unread: bool,
    /// The reason why it can't be read.
    pub reason: String,
}

impl fmt::Display for Loss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} bytes at {}", self.length, self.offset)?;
        match (self.from_ns.map(seconds), self.to_ns.map(seconds)) {
            (Some(from), Some(to)) => write!(f, ", from {from} s to {to} s")?,
            (Some(from), None) => write!(f, ", from {from} s on")?,
            (None, _) => {}
        }
        if self.is_unread {
            f.write_str(", skipped")?;
        }
        write!(f, ": {}", self.reason)
    }
}
