//! Numbers that several parts of a report have.

use crate::words::number::{Digits, MIN_PROBABILITY};
use crate::words::{Number, Piece, Sentence, sentence};

/// A time on the clock of the data to the microsecond, s.
pub(super) fn time(seconds: f64) -> Piece {
    Piece::Number(Number::new(seconds, Digits::AtMostDecimals(6), "s"))
}

/// A probability with its symbol.
pub(super) fn labelled_probability(p: f64) -> Sentence {
    if p < MIN_PROBABILITY {
        sentence!("p {}", Piece::probability(p))
    } else {
        sentence!("p = {}", Piece::probability(p))
    }
}

/// A number in a table, or a dash where there is none.
pub(super) fn or_dash(cell: Option<impl Into<Sentence>>) -> Sentence {
    cell.map_or_else(|| "–".into(), Into::into)
}
