//! The numbers that a figure needs.

/// Numbers of a channel that a figure draws.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Need {
    pub(super) topic: &'static str,
    pub(super) fields: &'static [&'static str],
}

/// The channel of nutation averages.
pub(super) const NUTATION: &str = "/top/nutation";
