//! The constant bytes of a channel's messages.

/// The bytes of a channel's messages without their values.
#[derive(Debug)]
pub(super) struct Template {
    /// For each value, the bytes before it, and whether it is a text.
    pub(super) slots: Vec<(Vec<u8>, bool)>,
    /// The bytes after the last value.
    pub(super) end: Vec<u8>,
}
