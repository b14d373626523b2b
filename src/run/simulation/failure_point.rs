//! Where a run failed, and what may be the cause.

use crate::physics::dynamics::{Model, Motion, Phase};
use crate::physics::friction::FrictionLaw;
use crate::run::scenario::short_number;
use nalgebra::Vector3;
use std::fmt::{self, Display, Formatter};

/// The point of a run at which it failed.
#[derive(Clone, Debug, PartialEq)]
pub struct FailurePoint {
    /// Time, s.
    pub time: f64,
    /// The motion, in the phase in which the run failed.
    pub motion: Motion,
    /// The top, its friction and its support.
    pub model: Model,
}

/// Time and motion in a clause such as "t = 0.5 s, while the peg rolls (θ = 0.3 rad, turning at 150 rad/s)".
impl Display for FailurePoint {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let time = short_number(rounded_down(self.time));
        let theta = short(self.motion.angles.theta, 4);
        let turning = short(self.motion.tilt.omega_lean.norm(), 3);
        write!(
            f,
            "t = {time} s, {} (θ = {theta} rad, turning at {turning} rad/s",
            self.contact()
        )?;
        if self.motion.phase != Phase::Sticking {
            // That with which it hits the table, for a peg in the air.
            let speed = short(self.contact_velocity().norm(), 3);
            write!(f, ", contact point moving at {speed} m/s")?;
        }
        f.write_str(")")
    }
}

impl FailurePoint {
    /// The contact of the peg with the table.
    pub fn contact(&self) -> ContactPhase {
        ContactPhase {
            phase: self.motion.phase,
            is_free: self.model.support.is_free(),
        }
    }

    /// Velocity of the lowest point of the peg in the lean frame, m/s.
    fn contact_velocity(&self) -> Vector3<f64> {
        let vertical = self.motion.peg.velocity_lean.z;
        self.motion.slip_velocity(&self.model.top) + Vector3::new(0.0, 0.0, vertical)
    }

    /// A clause that names the keys whose values may make the forces change too fast in this phase.
    pub(super) fn suspects(&self) -> String {
        self.suspects_of(self.motion.phase != Phase::Flying)
    }

    /// A clause that names the keys whose values may make the forces change too fast, of a top on the table or in the air.
    pub(super) fn suspects_of(&self, is_on_table: bool) -> String {
        let (mut small, mut large) = (Vec::new(), Vec::new());
        if is_on_table {
            add_suspects_of_law(&self.model.friction.law, &mut small, &mut large);
        }
        if let Some(losses) = &self.model.friction.losses {
            for (key, value, acts) in [
                ("rolling.arm", losses.rolling_arm, is_on_table),
                ("drilling.k", losses.drilling.k, is_on_table),
                ("air.axial", losses.air.axial, true),
                ("air.transverse", losses.air.transverse, true),
                ("air.disc", losses.air.disc, true),
            ] {
                if acts && value > 0.0 {
                    large.push(key);
                }
            }
        }
        small.push("moments of inertia");
        let small = format!("{} may be too small", small.join(" or "));
        if large.is_empty() {
            small
        } else {
            format!("{small}, or {} too large", large.join(" or "))
        }
    }

    /// A clause about a duration with which the run ends before; empty if there is none.
    pub(super) fn earlier_end(&self) -> String {
        let time = rounded_down(self.time);
        if time <= 0.0 {
            return String::new();
        }
        format!(
            "; a stop.duration of at most {} s ends the run before",
            short_number(time)
        )
    }
}

/// Adds the keys of a sliding law whose values may be too small, and those whose values may be too large.
fn add_suspects_of_law(
    law: &FrictionLaw,
    small: &mut Vec<&'static str>,
    large: &mut Vec<&'static str>,
) {
    let (scale, size) = match law {
        FrictionLaw::None => return,
        FrictionLaw::Coulomb { .. } => (None, "friction.k"),
        FrictionLaw::Regularised { .. } => (Some("friction.smoothing_speed"), "friction.k"),
        FrictionLaw::Viscous { .. } => (Some("friction.viscous_speed"), "friction.k"),
        FrictionLaw::Stribeck { .. } => (Some("friction.stribeck_speed"), "friction.static_k"),
        FrictionLaw::Contensou { .. } => (Some("friction.patch_radius"), "friction.k"),
    };
    small.extend(scale);
    large.push(size);
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

/// A positive number rounded to this many significant digits, without rows of zeros.
pub(super) fn short(number: f64, digits: usize) -> String {
    short_number(rounded(number, digits))
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
