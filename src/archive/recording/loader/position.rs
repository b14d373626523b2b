//! Places of records.

/// The place of a record in a file, which orders records as they are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Position {
    /// Offset of the section in the file.
    pub(super) section: u64,
    /// Start of the record in the content of the section.
    pub(super) start: usize,
}
