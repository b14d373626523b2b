//! The two sides of a comparison, A and B.

use schemars::JsonSchema;
use serde::Serialize;

/// One of the two runs of a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// The first run: the reference.
    A,
    /// The second run, which is compared with the first.
    B,
}

impl Side {
    /// Both sides, in the order of arrays.
    pub const BOTH: [Self; 2] = [Self::A, Self::B];

    /// Index in arrays of both sides: 0 for A, 1 for B.
    pub fn index(self) -> usize {
        self as usize
    }

    /// The other side.
    pub fn other(self) -> Self {
        match self {
            Self::A => Self::B,
            Self::B => Self::A,
        }
    }

    /// Display name: `A` or `B`.
    pub fn name(self) -> &'static str {
        match self {
            Self::A => "A",
            Self::B => "B",
        }
    }

    /// Letter in topics and file names: `a` or `b`.
    pub fn letter(self) -> &'static str {
        match self {
            Self::A => "a",
            Self::B => "b",
        }
    }
}
