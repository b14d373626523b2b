//! Selections of messages.

use crate::telemetry::Topics;

/// Selection of messages.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Selection {
    /// Only these topics.
    pub topics: Topics<String>,
    /// From this time on, ns.
    pub from_ns: Option<u64>,
    /// Up to this time, ns.
    pub to_ns: Option<u64>,
}

impl Selection {
    /// Whether it may have messages in a time span, ns.
    pub(super) fn wants_span(&self, (first, last): (u64, u64)) -> bool {
        self.from_ns.is_none_or(|from| from <= last) && self.to_ns.is_none_or(|to| first <= to)
    }
}
