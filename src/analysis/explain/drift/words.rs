//! The words of causes of a drift.

use super::{Cause, Drift, DriftPart, Place, Turn};
use crate::analysis::phrase::works;
use crate::words::capitalized;

impl Drift {
    /// The causes in words.
    pub(in crate::analysis::explain) fn words(&self) -> String {
        let mut sentences = Vec::new();
        for (at, part) in self.parts.iter().enumerate() {
            let is_last = at + 1 == self.parts.len();
            let text = self.part_words(*part, is_last);
            sentences.push(match self.time(at) {
                "" => capitalized(&text),
                time => format!("{time}{text}"),
            });
        }
        sentences.join(" ")
    }

    /// Words of time before a part.
    fn time(&self, at: usize) -> &'static str {
        match (self.place, at, self.grips) {
            (Place::Whole, 0, true) => "Until the contact point slips for the last time, ",
            (Place::Whole, _, true) => "Later, but still before that, ",
            (Place::Whole, 0, false) if self.parts.len() == 1 => "",
            (Place::Whole, 0, false) | (Place::Earlier, ..) => "At first, ",
            (Place::Whole, _, false) | (Place::Later, ..) => "Later, ",
        }
    }

    fn part_words(&self, DriftPart { change, cause }: DriftPart, is_last: bool) -> String {
        let rises = change < 0.0;
        let [friction, air] = self.losses;
        let works = works([friction, air, false]);
        // The ending of its verbs.
        let s = if friction && air { "" } else { "s" };
        let moves = self.moves(rises);
        let falls = if is_last && !rises && self.falls {
            ", until the top falls"
        } else {
            ""
        };
        let again = if self.place == Place::Later {
            " again"
        } else {
            ""
        };
        match cause {
            None => format!("the axis {moves}{again}{falls}."),
            Some(Cause::Momenta(turn)) => {
                format!("{} {moves}{falls}.", turn_words(turn, rises, works, s))
            }
            Some(Cause::Damping) => format!(
                "{works} damp{s} the nutation. The mean inclination of large nutations differs from that at which the top would precess without nutation. As the nutation shrinks, the axis approaches this inclination: on average, it {moves}{falls}."
            ),
            Some(Cause::Growth) => {
                let inclined = if rises { "less" } else { "more" };
                format!(
                    "{works} change{s} the angular momenta and the energy so that the nutation grows: the axis reaches smaller and larger inclinations than before, and on average it is {inclined} inclined."
                )
            }
            Some(Cause::Absent) => format!(
                "{works} hardly change{s} the inclination about which the axis nutates: on average, it hardly rises or sinks."
            ),
        }
    }

    /// What the axis does. The centre of mass of a tippe top goes the other way.
    fn moves(&self, rises: bool) -> &'static str {
        match (self.is_tippe_top, rises) {
            (false, true) => "rises",
            (false, false) => "sinks",
            (true, true) => "becomes less inclined",
            (true, false) => "becomes more inclined",
        }
    }
}

/// How friction changes the inclination without nutation, up to the motion of the axis; with verbs of this ending.
fn turn_words(turn: Option<Turn>, rises: bool, works: &str, s: &str) -> String {
    const REGULAR: &str = "the inclination at which the top would precess without nutation";
    let increases = if rises { "decreases" } else { "increases" };
    match turn {
        Some(Turn::Momentum { by_line }) => {
            let line = line_words(by_line);
            let upright = if rises {
                "more upright"
            } else {
                "away from the vertical"
            };
            format!(
                "{works} turn{s} {line}the angular momentum {upright}, and so {REGULAR} {increases}. The axis follows it, and"
            )
        }
        Some(Turn::Axis { by_line }) => {
            let line = line_words(by_line);
            let (slow, larger, more) = if rises {
                ("speed", "smaller", "less")
            } else {
                ("slow", "larger", "more")
            };
            let up = if rises { " up" } else { "" };
            format!(
                "{works} {slow}{s}{up} the rotation about the axis. Without nutation, the axis would then be at a {larger} angle to {line}the angular momentum, and {more} inclined. It follows, and"
            )
        }
        None => format!(
            "{works} change{s} the angular momenta about the axis and about the vertical, and so {REGULAR} {increases}. The axis follows it, and"
        ),
    }
}

fn line_words(by_line: bool) -> &'static str {
    if by_line { "the line of " } else { "" }
}
