//! Kinds of files.

use crate::run::listed::listed;

listed! {
    /// State of the file as determined by opening it; damage inside chunks is only found on reading.
    pub enum Condition {
        /// A complete MCAP file that toprise did not write.
        Foreign = "not a toprise recording",
        /// A recording with its end record, readable throughout.
        Whole = "complete",
        /// A complete recording with more or fewer samples or events than its end record states.
        Altered = "altered",
        /// A recording without an end record, or another file without its end; without other damage.
        Interrupted = "interrupted",
        /// A file with unreadable parts.
        Damaged = "damaged",
    }
}
