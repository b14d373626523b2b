//! The numbers that a figure needs.

use crate::telemetry::Topic;
use crate::telemetry::fields::NumberField;

/// Numbers of one channel that a figure draws.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Need {
    /// The fields, at least one.
    pub(super) fields: &'static [NumberField],
    /// Whether means over each nutation are drawn instead of the samples.
    pub(super) are_means: bool,
}

/// Missing part of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Missing {
    /// All of its messages.
    Messages,
    /// One of the fields.
    Field(NumberField),
}

impl Need {
    /// The channel.
    pub(super) fn topic(&self) -> Topic {
        self.fields[0].topic()
    }
}
