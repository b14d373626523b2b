//! Kinds of files.

use crate::run::listed::listed;

listed! {
    /// State of the file as determined by opening it; damage inside chunks is only found on reading.
    pub enum Condition {
        /// A complete MCAP file that toprise did not write.
        Foreign = "not a toprise recording",
        /// A recording with its end record, readable throughout.
        Whole = "complete",
        /// A complete file with other messages than its end record or its statistics state.
        Altered = "altered",
        /// A recording of a run that was ended before its end, or a file without its end; without other damage.
        Interrupted = "interrupted",
        /// A file with unreadable parts.
        Damaged = "damaged",
    }
}
