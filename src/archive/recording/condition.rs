//! Kinds of files.

use crate::run::listed::listed;

listed! {
    /// State of the file as determined by opening it; damage inside chunks is only found on reading.
    pub enum Condition {
        /// An MCAP file that toprise did not write.
        Foreign = "not a toprise recording",
        /// A recording with its end record, readable throughout.
        Whole = "complete",
        /// A recording without an end record: the run was interrupted, without other damage.
        Interrupted = "interrupted",
        /// A recording with unreadable parts.
        Damaged = "damaged",
    }
}
