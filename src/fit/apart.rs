//! What is seen of data that the model does not meet.

use crate::words::{Piece, Sentence, sentence};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What was seen of data that the model does not meet.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Apart {
    /// Nothing moves at the beginning.
    RestBefore {
        /// The time in the data until which nothing moves, s.
        until: f64,
    },
    /// Nothing moves at the end.
    RestAfter {
        /// The time in the data from which on nothing moves, s.
        from: f64,
    },
    /// Nothing moves at all.
    Rest,
    /// The precession has another rate than that of the start.
    Precession {
        /// Its rate, in that of the start.
        ratio: f64,
    },
    /// The best motion explains less of the first seconds than a parabola does.
    Unlike,
}

impl Apart {
    /// What was seen, in a sentence. `is_tried` says that a fit without the rest has succeeded.
    pub(in crate::fit) fn sentence(self, is_tried: bool) -> Sentence {
        match self {
            Self::RestBefore { until } if is_tried => sentence!(
                "nothing moves until t = {}: {}",
                Piece::rounded(until, 6, "s"),
                Piece::argument_with("start", rounded(until).to_string())
            ),
            Self::RestBefore { until } => {
                sentence!("nothing moves until t = {}", Piece::rounded(until, 6, "s"))
            }
            Self::RestAfter { from } if is_tried => sentence!(
                "nothing moves after t = {}: {}",
                Piece::rounded(from, 6, "s"),
                Piece::argument_with("until", rounded(from).to_string())
            ),
            Self::RestAfter { from } => {
                sentence!("nothing moves after t = {}", Piece::rounded(from, 6, "s"))
            }
            Self::Rest => sentence!("nothing moves in the data"),
            Self::Precession { ratio } if ratio > 0.0 => sentence!(
                "the top in the data precesses {} times {} than a top like this: is the clock right, and the unit of φ?",
                Piece::number(ratio.max(1.0 / ratio), 2, ""),
                if ratio < 1.0 { "slower" } else { "faster" }
            ),
            Self::Precession { .. } | Self::Unlike => sentence!(
                "no motion of this top is like the first seconds of the data; start closer to the motion ({}), or check what the columns measure",
                Piece::argument("set")
            ),
        }
    }
}

/// A time to the microsecond.
fn rounded(time: f64) -> f64 {
    (time * 1e6).round() / 1e6
}
