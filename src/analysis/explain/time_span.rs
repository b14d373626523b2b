//! The time in which a claim holds.

use crate::words::{Piece, Sentence, sentence};
use schemars::JsonSchema;
use serde::Serialize;
use std::cmp::Ordering;

/// The time in which a claim holds; an instant for an event.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct TimeSpan {
    /// Its beginning, s; absent for that of the run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from: Option<f64>,
    /// Its end, s; absent for that of the run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub until: Option<f64>,
}

impl TimeSpan {
    pub(super) const WHOLE: Self = Self {
        from: None,
        until: None,
    };

    pub(super) fn from(time: f64) -> Self {
        Self {
            from: Some(time),
            until: None,
        }
    }

    pub(super) fn between(from: f64, until: f64) -> Self {
        Self {
            from: Some(from),
            until: Some(until),
        }
    }

    pub(super) fn at(time: f64) -> Self {
        Self::between(time, time)
    }

    /// The order of time: by the beginning, then by the end.
    pub(super) fn order(self, other: Self) -> Ordering {
        let [one, other] = [self, other].map(|span| {
            [
                span.from.unwrap_or(0.0),
                span.until.unwrap_or(f64::INFINITY),
            ]
        });
        one[0]
            .total_cmp(&other[0])
            .then(one[1].total_cmp(&other[1]))
    }

    /// The time span in a run whose last sample is at this time, s, without ends that are those of the run. An instant stays
    /// one.
    pub(super) fn within_run(self, end: f64) -> Self {
        if self.from.is_some() && self.from == self.until {
            return self;
        }
        Self {
            from: self.from.filter(|from| *from > 0.0),
            until: self.until.filter(|until| *until < end),
        }
    }

    /// A sentence about what held in this time; it begins with the time, unless that is the whole run.
    pub(super) fn introduce(self, sentence: Sentence) -> Sentence {
        match (self.from, self.until) {
            (None, None) => sentence.capitalized(),
            (None, Some(until)) => sentence!("Until {}, {}", Piece::time(until), sentence),
            (Some(from), None) => sentence!("From {} on, {}", Piece::time(from), sentence),
            (Some(from), Some(until)) if from == until => {
                sentence!("At {}, {}", Piece::time(from), sentence)
            }
            (Some(from), Some(until)) => {
                let [from, until] = [from, until].map(Piece::time);
                sentence!("From {} to {}, {}", from, until, sentence)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sentences_begin_with_their_time() {
        for (interval, expected) in [
            (TimeSpan::WHOLE, "It rose."),
            (TimeSpan::between(0.0, 2.0), "It rose."),
            (TimeSpan::from(0.0), "It rose."),
            (TimeSpan::between(0.0, 1.0), "Until 1.0000 s, it rose."),
            (TimeSpan::from(1.0), "From 1.0000 s on, it rose."),
            (
                TimeSpan::between(0.5, 1.0),
                "From 0.5000 s to 1.0000 s, it rose.",
            ),
            (TimeSpan::at(2.0), "At 2.0000 s, it rose."),
        ] {
            let sentence = interval.within_run(2.0).introduce(sentence!("it rose."));
            assert_eq!(sentence.to_string(), expected);
        }
    }
}
