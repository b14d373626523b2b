//! The point at which a run failed.

use crate::physics::dynamics::{Motion, Phase};
use crate::run::scenario::short_number;
use std::fmt::{self, Display, Formatter};

/// The point of a run at which it failed.
#[derive(Clone, Debug, PartialEq)]
pub struct FailurePoint {
    /// Time, s.
    pub time: f64,
    /// Number of steps from the start of the run.
    pub steps: u64,
    /// The motion, in the phase in which the run failed.
    pub motion: Motion,
    /// Whether the peg is free.
    pub is_free: bool,
}

/// A clause such as "at t = 0.5 s, after 900 steps, while the peg rolls (θ = 0.3 rad, turning at 150 rad/s)".
impl Display for FailurePoint {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let contact = ContactPhase {
            phase: self.motion.phase,
            is_free: self.is_free,
        };
        write!(
            f,
            "at t = {} s, after {} steps, {contact} (θ = {} rad, turning at {} rad/s)",
            short_number(rounded_down(self.time)),
            self.steps,
            short_number(rounded(self.motion.angles.theta, 4)),
            short_number(rounded(self.motion.tilt.omega_lean.norm(), 3)),
        )
    }
}

impl FailurePoint {
    /// A clause that names a change with which the run succeeds or may succeed.
    pub(super) fn remedy(&self) -> String {
        let time = rounded_down(self.time);
        if time > 0.0 {
            let time = short_number(time);
            format!("a stop.duration of at most {time} s ends the run before")
        } else {
            "initial rates may be too large, or moments of inertia too small".to_owned()
        }
    }
}

/// The phase of the contact between a fixed or a free peg and the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ContactPhase {
    /// The phase.
    pub phase: Phase,
    /// Whether the peg is free.
    pub is_free: bool,
}

impl ContactPhase {
    pub(super) fn noun(self) -> &'static str {
        match self.phase {
            Phase::Sliding => "sliding",
            Phase::Sticking if self.is_free => "rolling",
            Phase::Sticking => "sticking",
            Phase::Flying => "flight",
        }
    }
}

/// A clause such as "while the contact point slips".
impl Display for ContactPhase {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(match self.phase {
            Phase::Sliding => "while the contact point slips",
            Phase::Sticking if self.is_free => "while the peg rolls",
            Phase::Sticking => "while the contact point sticks",
            Phase::Flying => "while the peg is in the air",
        })
    }
}

/// A number rounded to this many significant digits.
fn rounded(number: f64, digits: usize) -> f64 {
    // Rust reads every number that it writes.
    format!("{number:.*e}", digits - 1)
        .parse()
        .unwrap_or(number)
}

/// A time to six digits that is not after it: the run may not be able to reach a later one.
fn rounded_down(time: f64) -> f64 {
    const DIGITS: usize = 6;
    let nearest = rounded(time, DIGITS);
    if nearest <= time {
        return nearest;
    }
    let text = format!("{time:.17e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let digits = mantissa.get(..=DIGITS).unwrap_or(mantissa);
    format!("{digits}e{exponent}").parse().unwrap_or(time)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_not_rounded_up() {
        for (time, text) in [
            (0.028_059_149_653_138_91, "0.0280591"),
            (0.005_030_670_250_129_06, "0.00503067"),
            (2.667_161_726_558_615_8e-5, "2.66716e-5"),
            (1.999_999_9, "1.99999"),
            (0.3, "0.3"),
            (0.04, "0.04"),
            (24.719_386, "24.7193"),
            (0.0, "0"),
        ] {
            let rounded = rounded_down(time);
            assert_eq!(short_number(rounded), text);
            assert!(rounded <= time, "{time}");
        }
    }
}
