//! Events of a top, and reasons why a run ends.

use crate::physics::dynamics::{Motion, Transition};
use crate::physics::top::Top;
use crate::run::listed::listed;
use schemars::JsonSchema;
use serde::Serialize;

/// Something that happened at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// The event.
    pub kind: EventKind,
    /// When, s; exact to the integrator's tolerance.
    pub time: f64,
    /// [`Event::time`] rounded to nanoseconds.
    pub time_ns: u64,
    /// Counts the run's events from 0.
    pub index: u32,
    /// The motion at that moment.
    pub motion: Motion,
    /// The event, as a sentence.
    pub description: String,
}

listed! {
    /// Kinds of events.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, JsonSchema)]
    #[serde(rename_all = "snake_case")]
    pub enum EventKind {
        /// The run begins.
        Start = "start",
        /// θ has fallen to `stop.theta_risen`.
        Risen = "risen",
        /// θ has grown to `stop.theta_fallen`, or to π/2.
        Fallen = "fallen",
        /// θ passes a minimum.
        NutationMinimum = "nutation_minimum",
        /// θ passes a maximum.
        NutationMaximum = "nutation_maximum",
        /// θ passes a minimum within 0.01 rad of zero: the axis swings through the vertical.
        UprightPassage = "upright_passage",
        /// The precession turns retrograde: the axis makes loops.
        LoopingBegins = "looping_begins",
        /// The precession turns back to its normal sense.
        LoopingEnds = "looping_ends",
        /// The spin has become too weak to hold an upright top: a² = 4 M g l / I_x (Klein and Sommerfeld).
        WeakTop = "weak_top",
        /// The spin has become strong enough again: the reverse of [`EventKind::WeakTop`].
        StrongTop = "strong_top",
        /// The contact point has stopped slipping.
        SlipStops = "slip_stops",
        /// The contact point has stopped slipping, and friction holds it: the top turns about the vertical as a
        /// whole.
        Stick = "stick",
        /// Friction does not hold the contact point any longer.
        SlipResumes = "slip_resumes",
        /// A top whose contact point sticks has stopped turning too.
        Rest = "rest",
        /// The Euler angles have become singular: sin θ is nearly 0.
        Singular = "singular",
        /// The peg leaves the table.
        LiftOff = "lift_off",
        /// The peg is on the table again, after one impact or several.
        Landing = "landing",
        /// The peg begins to roll.
        RollBegins = "roll_begins",
        /// The peg rolls no longer.
        RollEnds = "roll_ends",
        /// The peg jams: no force of the table keeps it out of it.
        Jam = "jam",
        /// The top turns about the vertical only; rolling resistance holds it.
        Pivot = "pivot",
    }
}

/// A nutation minimum below this angle counts as a passage through upright, rad.
pub const UPRIGHT: f64 = 0.01;

impl EventKind {
    /// The event of a transition; none where the phases imply it.
    pub(super) fn of(transition: &Transition) -> Option<Self> {
        match transition {
            Transition::Holds => Some(Self::Stick),
            Transition::SlipStops => Some(Self::SlipStops),
            Transition::SlipResumes => Some(Self::SlipResumes),
            Transition::BecomesSingular => Some(Self::Singular),
            Transition::Jams => Some(Self::Jam),
            Transition::Pivots => Some(Self::Pivot),
            Transition::Rolls
            | Transition::RollEnds
            | Transition::LiftsOff
            | Transition::Bounces(_)
            | Transition::Lands(_) => None,
        }
    }

    /// Whether it comes with each nutation, hundreds of times in a run, so that lists of events leave it out.
    #[must_use]
    pub fn is_of_nutation(self) -> bool {
        matches!(self, Self::NutationMinimum | Self::NutationMaximum)
    }

    /// Several events of this kind, as in "10 loops"; none for the end of something, and for what happens once.
    #[must_use]
    pub fn plural(self, top: &Top) -> Option<&'static str> {
        match self {
            Self::LoopingBegins if top.center_distance < 0.0 => {
                Some("backward turns of the precession")
            }
            Self::LoopingBegins => Some("loops"),
            Self::UprightPassage => Some("passages through upright"),
            Self::SlipStops => Some("stops of the slip"),
            Self::Stick => Some("intervals of sticking"),
            Self::LiftOff => Some("hops"),
            Self::RollBegins => Some("intervals of rolling"),
            Self::WeakTop => Some("losses of strength"),
            Self::StrongTop => Some("gains of strength"),
            Self::NutationMinimum => Some("nutation minima"),
            Self::NutationMaximum => Some("nutation maxima"),
            Self::Start
            | Self::Risen
            | Self::Fallen
            | Self::LoopingEnds
            | Self::SlipResumes
            | Self::Rest
            | Self::Singular
            | Self::Landing
            | Self::RollEnds
            | Self::Jam
            | Self::Pivot => None,
        }
    }

    /// The event of a top, human-readable.
    #[must_use]
    pub(super) fn describe(self, top: &Top, motion: &Motion) -> String {
        let theta = motion.angles.theta;
        let rates = &motion.tilt.rates;
        match self {
            Self::Start => format!(
                "The top starts inclined by {theta:.4} rad, spinning at {:.2} rad/s and precessing at {:.4} rad/s.",
                rates.psi, rates.phi
            ),
            Self::Risen => format!("The top has risen to within {theta:.4} rad of upright."),
            Self::Fallen => format!(
                "The top has fallen to {theta:.4} rad; its spin is down to {:.2} rad/s.",
                rates.psi
            ),
            Self::NutationMinimum => format!("Nutation: the inclination is least, {theta:.6} rad."),
            Self::NutationMaximum => {
                format!("Nutation: the inclination is greatest, {theta:.6} rad.")
            }
            Self::UprightPassage => {
                format!("The axis swings through upright, {theta:.2e} rad from the vertical.")
            }
            // Regular precession of a tippe top may be backward: that makes no loops.
            Self::LoopingBegins if top.center_distance < 0.0 => {
                format!("The precession turns backward, at {theta:.4} rad.")
            }
            Self::LoopingBegins => {
                format!("The precession turns backward: the axis loops, at {theta:.4} rad.")
            }
            Self::LoopingEnds if top.center_distance < 0.0 => {
                format!("The precession turns forward, at {theta:.4} rad.")
            }
            Self::LoopingEnds => format!("The precession turns forward again, at {theta:.4} rad."),
            Self::WeakTop => format!(
                "The spin, {:.2} rad/s, has become too weak to hold an upright top.",
                rates.psi
            ),
            Self::StrongTop => format!(
                "The spin, {:.2} rad/s, is strong enough to hold an upright top.",
                rates.psi
            ),
            Self::SlipStops => format!("The contact point stops slipping, at {theta:.4} rad."),
            Self::Stick => format!(
                "The contact point sticks: the top turns as a whole, inclined by {theta:.4} rad, at {:.2} rad/s.",
                motion.tilt.omega_lean.z
            ),
            Self::SlipResumes => format!("The contact point slips again, at {theta:.4} rad."),
            Self::Rest => format!("The top rests, inclined by {theta:.4} rad."),
            Self::Singular => {
                format!("The Euler angles are singular here, {theta:.2e} rad from the vertical.")
            }
            Self::LiftOff => format!("The peg leaves the table, at {theta:.4} rad."),
            Self::Landing => format!("The peg is on the table again, at {theta:.4} rad."),
            Self::RollBegins => format!("The peg begins to roll, at {theta:.4} rad."),
            Self::RollEnds => format!("The peg no longer rolls, at {theta:.4} rad."),
            Self::Jam => format!("The peg jams, at {theta:.4} rad."),
            Self::Pivot => format!(
                "The top turns about the vertical only, inclined by {theta:.4} rad; rolling resistance holds it."
            ),
        }
    }
}

listed! {
    /// The reason for a run's end.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
    #[serde(rename_all = "snake_case")]
    pub enum StopReason {
        /// θ fell to `stop.theta_risen`.
        Risen = "risen",
        /// θ grew to `stop.theta_fallen`.
        Fallen = "fallen",
        /// `stop.duration` is over.
        Duration = "duration",
        /// The contact point stopped slipping; `stop.on_stick = "continue"` goes on.
        SlipStopped = "slip_stopped",
        /// The contact point sticks and the top has stopped turning: nothing will change.
        Rest = "rest",
        /// The Euler angles became singular; the `body` formulation goes on there.
        Singular = "singular",
        /// The free peg jammed: no force of the table keeps it out of it.
        Jam = "jam",
        /// The top with a free peg turns about the vertical only, held by rolling resistance.
        Pivot = "pivot",
        /// Nothing in the scenario ended the run: it was broken off.
        Interrupted = "interrupted",
        /// The integrator could not go on.
        Failed = "failed",
    }
}

impl StopReason {
    /// The reason for the run's end, as a sentence.
    #[must_use]
    pub fn sentence(self) -> &'static str {
        match self {
            Self::Risen => "the top has risen",
            Self::Fallen => "the top has fallen",
            Self::Duration => "the duration is over",
            Self::SlipStopped => {
                "the contact point stopped slipping (stop.on_stick = \"continue\" goes on)"
            }
            Self::Rest => "the top rests",
            Self::Singular => {
                "the Euler angles became singular upright (formulation = \"body\" goes on)"
            }
            Self::Jam => "the peg jams: no force of the table keeps it out of it",
            Self::Pivot => "the top turns about the vertical only, held by rolling resistance",
            Self::Interrupted => "interrupted",
            Self::Failed => "the motion could not be computed or recorded further",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_are_found_by_their_names() {
        for kind in EventKind::ALL {
            assert_eq!(EventKind::find(kind.name()), Some(kind));
        }
        assert_eq!(EventKind::find("nutation"), None);
    }
}
