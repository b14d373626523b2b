//! The scope of a verification.

/// The compared part of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scope {
    /// All bytes of messages, schemas and attachments.
    Bytes,
    /// The values in messages, and whether the rest is there: words belong to the version that recorded them.
    Values,
}
