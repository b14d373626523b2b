//! The constant bytes of a channel's messages.

/// The bytes of a channel's messages without their values.
#[derive(Debug)]
pub(in crate::telemetry) struct Template {
    /// The places of the values.
    pub(super) slots: Vec<Slot>,
    /// The bytes after the last value.
    pub(super) end: Vec<u8>,
}

/// The place of a value in a message.
#[derive(Debug)]
pub(super) struct Slot {
    /// The bytes before the value.
    pub(super) before: Vec<u8>,
    /// Whether the value is a text; otherwise it is a number.
    pub(super) is_text: bool,
}

impl Slot {
    pub(super) fn text(before: Vec<u8>) -> Self {
        Self {
            before,
            is_text: true,
        }
    }

    pub(super) fn number(before: Vec<u8>) -> Self {
        Self {
            before,
            is_text: false,
        }
    }
}
