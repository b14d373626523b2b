//! Events of a top, and reasons why a run ends.

use crate::physics::dynamics::{Motion, Transition};
use crate::physics::math::cos;
use crate::physics::top::Top;
use crate::run::listed::listed;
use crate::words::number::Digits;
use crate::words::{Number, Piece, Sentence, and, sentence};

/// An event of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// The event.
    pub kind: EventKind,
    /// Time, s, within the integrator tolerance.
    pub time: f64,
    /// [`Event::time`] rounded to nanoseconds.
    pub time_ns: u64,
    /// Index of the event in the run, from 0.
    pub index: u32,
    /// The motion at that time.
    pub motion: Motion,
}

/// The part of a state that a sentence about an event mentions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EventState {
    /// Inclination θ, rad.
    pub theta: f64,
    /// Precession rate φ̇, rad/s.
    pub phi_dot: f64,
    /// Spin rate ψ̇, rad/s.
    pub psi_dot: f64,
}

impl Event {
    /// A sentence about this event of `top`.
    pub fn sentence(&self, top: &Top) -> Sentence {
        let rates = self.motion.tilt.rates;
        let state = EventState {
            theta: self.motion.angles.theta,
            phi_dot: rates.phi,
            psi_dot: rates.psi,
        };
        self.kind.sentence(top, state)
    }
}

listed! {
    /// Kinds of events.
    pub enum EventKind {
        /// The run begins.
        Start = "start",
        /// θ reached `stop.theta_risen`.
        Risen = "risen",
        /// θ reached `stop.theta_fallen`, or π/2.
        Fallen = "fallen",
        /// Minimum of θ.
        NutationMinimum = "nutation_minimum",
        /// Maximum of θ.
        NutationMaximum = "nutation_maximum",
        /// Minimum of θ within 0.01 rad of zero: the axis passes the vertical.
        UprightPassage = "upright_passage",
        /// The precession becomes retrograde: the axis makes loops.
        LoopingBegins = "looping_begins",
        /// The precession returns to its normal sense.
        LoopingEnds = "looping_ends",
        /// The axis of a tippe top passes the horizontal: the centre of mass rises above the centre of the sphere.
        Inverts = "inverts",
        /// The top becomes weak: the spin can no longer keep it upright, a² < 4 M g l / I_x (Klein and Sommerfeld).
        WeakTop = "weak_top",
        /// The top becomes strong again: the reverse of [`EventKind::WeakTop`].
        StrongTop = "strong_top",
        /// The contact point stops slipping.
        SlipStops = "slip_stops",
        /// The contact point sticks: it stops slipping, friction holds it, and the top turns rigidly about the
        /// vertical.
        Stick = "stick",
        /// Friction can no longer hold the contact point.
        SlipResumes = "slip_resumes",
        /// A top whose contact point sticks also stops turning.
        Rest = "rest",
        /// The Euler angles become singular: sin θ is nearly 0.
        Singular = "singular",
        /// The peg leaves the table.
        LiftOff = "lift_off",
        /// The peg is on the table again, after one or more impacts.
        Landing = "landing",
        /// The peg begins to roll.
        RollBegins = "roll_begins",
        /// The peg no longer rolls.
        RollEnds = "roll_ends",
        /// The peg jams: no contact force can keep it out of the table.
        Jam = "jam",
        /// The top turns about the vertical only, held by rolling resistance.
        Pivot = "pivot",
    }
}

/// Nouns for counts of events that can repeat.
const PLURALS: [(EventKind, &str); 12] = [
    (EventKind::LoopingBegins, "loops"),
    (EventKind::UprightPassage, "upright passages"),
    (EventKind::SlipStops, "slip stops"),
    (EventKind::Stick, "intervals of sticking"),
    (EventKind::LiftOff, "hops"),
    (EventKind::RollBegins, "intervals of rolling"),
    (EventKind::WeakTop, "changes from strong to weak"),
    (EventKind::StrongTop, "changes from weak to strong"),
    (EventKind::Inverts, "inversions"),
    (EventKind::NutationMinimum, "nutation minima"),
    (EventKind::NutationMaximum, "nutation maxima"),
    (EventKind::Fallen, "falls"),
];

/// A nutation minimum below this angle counts as an upright passage, rad.
pub const UPRIGHT: f64 = 0.01;

impl EventKind {
    /// Whether the event is an extreme of θ, which every nutation has; lists omit such events.
    pub fn is_nutation_extreme(self) -> bool {
        matches!(self, Self::NutationMinimum | Self::NutationMaximum)
    }

    /// The event in a few words, for a list in which it stands for `count` events.
    pub fn words(self, count: u64) -> String {
        if self == Self::Fallen && count > 1 {
            "falls".to_owned()
        } else if self == Self::LoopingBegins {
            "precession turns backward".to_owned()
        } else if self == Self::LoopingEnds {
            "precession turns forward".to_owned()
        } else {
            self.name().replace('_', " ")
        }
    }

    /// Plural noun for counts, e.g. "10 loops"; `None` for events that end something or occur once.
    pub fn plural(self, top: &Top) -> Option<&'static str> {
        if self == Self::LoopingBegins && top.center_distance < 0.0 {
            return Some("reversals of the precession");
        }
        let mut plurals = PLURALS.into_iter();
        plurals
            .find(|(kind, _)| *kind == self)
            .map(|(_, noun)| noun)
    }

    /// A sentence about an event of `top` in this state.
    pub fn sentence(self, top: &Top, state: EventState) -> Sentence {
        self.sentence_with(top, state, small_angle(state.theta))
    }

    /// The sentence in the views of recordings, whose bytes must stay: small angles have an exponent of ten after an `e`.
    pub(crate) fn recorded_sentence(self, top: &Top, state: EventState) -> String {
        let angle = format!("{:.2e} rad", state.theta);
        self.sentence_with(top, state, angle.into()).to_string()
    }

    /// A sentence with `from_vertical` for an inclination near zero.
    fn sentence_with(self, top: &Top, state: EventState, from_vertical: Piece) -> Sentence {
        let EventState {
            theta,
            phi_dot,
            psi_dot,
        } = state;
        let spin = Piece::fixed(psi_dot, 2, "rad/s");
        let angle = Piece::fixed(theta, 4, "rad");
        match self {
            Self::Start => start_sentence(theta, phi_dot, psi_dot),
            Self::Risen => sentence!("The top reaches θ = {}.", angle),
            Self::Fallen => {
                sentence!("The top has fallen to θ = {}; its spin is {}.", angle, spin)
            }
            Self::NutationMinimum => sentence!(
                "Nutation: the inclination is least, {}.",
                Piece::fixed(theta, 6, "rad")
            ),
            Self::NutationMaximum => sentence!(
                "Nutation: the inclination is greatest, {}.",
                Piece::fixed(theta, 6, "rad")
            ),
            Self::UprightPassage => sentence!(
                "The axis swings through upright, {} from the vertical.",
                from_vertical
            ),
            // Regular precession of a tippe top may be backward: that makes no loops.
            Self::LoopingBegins if top.center_distance < 0.0 => {
                sentence!("The precession turns backward, at θ = {}.", angle)
            }
            Self::LoopingBegins => sentence!(
                "The precession turns backward: the axis loops, at θ = {}.",
                angle
            ),
            Self::LoopingEnds if top.center_distance < 0.0 => {
                sentence!("The precession turns forward, at θ = {}.", angle)
            }
            Self::LoopingEnds => {
                sentence!("The precession turns forward again, at θ = {}.", angle)
            }
            // A top that swings may come back.
            Self::Inverts => sentence!(
                "The axis passes the horizontal: the top inverts, spinning at {}.",
                spin
            ),
            Self::WeakTop => sentence!(
                "The spin, {}, has become too weak to hold an upright top.",
                spin
            ),
            Self::StrongTop => sentence!(
                "The spin, {}, is strong enough to hold an upright top.",
                spin
            ),
            Self::SlipStops => {
                sentence!("The contact point stops slipping, at θ = {}.", angle)
            }
            Self::Stick => sentence!(
                "The contact point sticks: the top turns as a whole, inclined by θ = {}, at {}.",
                angle,
                Piece::fixed(phi_dot + psi_dot * cos(theta), 2, "rad/s")
            ),
            Self::SlipResumes => sentence!("The contact point slips again, at θ = {}.", angle),
            Self::Rest => sentence!("The top rests, inclined by θ = {}.", angle),
            Self::Singular => sentence!(
                "The Euler angles are singular here, {} from the vertical.",
                from_vertical
            ),
            Self::LiftOff => sentence!("The peg leaves the table, at θ = {}.", angle),
            Self::Landing => sentence!("The peg is on the table again, at θ = {}.", angle),
            Self::RollBegins => sentence!("The peg begins to roll, at θ = {}.", angle),
            Self::RollEnds => sentence!("The peg no longer rolls, at θ = {}.", angle),
            Self::Jam => sentence!("The peg jams, at θ = {}.", angle),
            Self::Pivot => sentence!(
                "The top turns about the vertical only, inclined by θ = {}; rolling resistance holds it.",
                angle
            ),
        }
    }
}

listed! {
    /// Reason for the end of a run.
    pub enum StopReason {
        /// θ reached `stop.theta_risen`.
        Risen = "risen",
        /// θ reached `stop.theta_fallen`.
        Fallen = "fallen",
        /// The run reached `stop.duration`.
        Duration = "duration",
        /// The contact point stopped slipping; use `stop.on_stick = "continue"` to continue.
        SlipStopped = "slip_stopped",
        /// The contact point sticks and the top is at rest.
        Rest = "rest",
        /// The Euler angles became singular; use the `body` formulation to continue.
        Singular = "singular",
        /// The free peg jammed: no contact force can keep it out of the table.
        Jam = "jam",
        /// The top with a free peg turns about the vertical only, held by rolling resistance.
        Pivot = "pivot",
        /// The run was interrupted.
        Interrupted = "interrupted",
        /// The simulation failed.
        Failed = "failed",
    }
}

/// An inclination near zero, with a power of ten.
fn small_angle(theta: f64) -> Piece {
    Piece::Number(Number::new(theta, Digits::Power(3), "rad"))
}

/// The start of the run, with the rates that are not zero.
fn start_sentence(theta: f64, phi_dot: f64, psi_dot: f64) -> Sentence {
    let mut rates = Vec::new();
    if psi_dot != 0.0 {
        rates.push(sentence!(
            "spinning at {}",
            Piece::fixed(psi_dot, 2, "rad/s")
        ));
    }
    if phi_dot != 0.0 {
        rates.push(sentence!(
            "precessing at {}",
            Piece::fixed(phi_dot, 4, "rad/s")
        ));
    }
    let comma = if rates.is_empty() { "" } else { ", " };
    sentence!(
        "The top starts at θ = {}{}{}.",
        Piece::fixed(theta, 4, "rad"),
        comma,
        and(rates)
    )
}

/// The consequences of a transition for a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Consequences {
    /// The event, if the transition is one.
    pub event: Option<EventKind>,
    /// The reason for which the run ends, if it does.
    pub stop: Option<StopReason>,
}

/// The event of a transition, and whether it ends the run.
pub(super) fn consequences(transition: Transition) -> Consequences {
    let (event, stop) = match transition {
        Transition::Sticks => (Some(EventKind::Stick), None),
        Transition::SlipStops => (Some(EventKind::SlipStops), None),
        Transition::SlipResumes => (Some(EventKind::SlipResumes), None),
        Transition::BecomesSingular => (Some(EventKind::Singular), Some(StopReason::Singular)),
        Transition::Jams => (Some(EventKind::Jam), Some(StopReason::Jam)),
        Transition::Pivots { is_final } => (
            Some(EventKind::Pivot),
            is_final.then_some(StopReason::Pivot),
        ),
        Transition::Rests => (Some(EventKind::Rest), Some(StopReason::Rest)),
        // Rolling, flight and landing are events of a change of phase, whatever the transition.
        Transition::Departs
        | Transition::RockingStops
        | Transition::RockingResumes
        | Transition::TurningStops
        | Transition::TurningResumes
        | Transition::Rolls
        | Transition::RollEnds
        | Transition::LiftsOff
        | Transition::Bounces
        | Transition::Lands => (None, None),
    };
    Consequences { event, stop }
}

impl StopReason {
    /// Whether the run ended by itself, neither interrupted nor failed.
    pub fn is_complete(self) -> bool {
        !matches!(self, Self::Interrupted | Self::Failed)
    }

    /// The reason for the run's end in a few words, for counts and headings.
    pub fn words(self) -> String {
        if self == Self::Duration {
            "at the time limit".to_owned()
        } else {
            self.name().replace('_', " ")
        }
    }

    /// The reason for the run's end, as a sentence.
    pub fn sentence(self) -> &'static str {
        match self {
            Self::Risen => "risen",
            Self::Fallen => "fallen",
            Self::Duration => "stopped at the time limit",
            Self::SlipStopped => {
                "the contact point stopped slipping (to continue, set stop.on_stick = \"continue\")"
            }
            Self::Rest => "the top is at rest",
            Self::Singular => {
                "the Euler angles became singular (to continue, set formulation = \"body\")"
            }
            Self::Jam => "the peg jammed: no contact force can keep it out of the table",
            Self::Pivot => "the top turns about the vertical only, held by rolling resistance",
            Self::Interrupted => "interrupted",
            Self::Failed => "the simulation or recording failed",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::scenario::Preset;

    #[test]
    fn kinds_are_found_by_their_names() {
        for kind in EventKind::ALL {
            assert_eq!(EventKind::find(kind.name()), Some(kind));
        }
        assert_eq!(EventKind::find("nutation"), None);
    }

    #[test]
    fn words_agree_with_sentences() {
        let top = Preset::find("tippe-top")
            .unwrap()
            .scenario()
            .unwrap()
            .model
            .top;
        let state = EventState {
            theta: 0.5,
            phi_dot: -1.0,
            psi_dot: 80.0,
        };
        for kind in [EventKind::LoopingBegins, EventKind::LoopingEnds] {
            let sentence = kind.sentence(&top, state).to_string().to_lowercase();
            assert!(sentence.contains(&kind.words(1)), "{sentence}");
        }
        assert_eq!(EventKind::Fallen.words(1), "fallen");
        assert_eq!(EventKind::Fallen.words(57), "falls");
    }

    #[test]
    fn small_angles_have_powers_of_ten_outside_recordings() {
        let top = Preset::find("paper").unwrap().scenario().unwrap().model.top;
        let state = EventState {
            theta: 0.008,
            phi_dot: 0.0,
            psi_dot: 0.0,
        };
        for kind in [EventKind::UprightPassage, EventKind::Singular] {
            let sentence = kind.sentence(&top, state).to_string();
            assert!(sentence.contains(", 8.00 × 10⁻³ rad "));
            assert!(
                kind.recorded_sentence(&top, state)
                    .contains(", 8.00e-3 rad ")
            );
        }
        assert_eq!(small_angle(0.0).to_string(), "0 rad");
    }

    #[test]
    fn start_names_nonzero_rates() {
        for (phi_dot, psi_dot, sentence) in [
            (0.0, 0.0, "The top starts at θ = 0.5000 rad."),
            (
                0.0,
                -6.92,
                "The top starts at θ = 0.5000 rad, spinning at −6.92 rad/s.",
            ),
            (
                1.5,
                170.0,
                "The top starts at θ = 0.5000 rad, spinning at 170.00 rad/s and precessing at 1.5000 rad/s.",
            ),
        ] {
            assert_eq!(start_sentence(0.5, phi_dot, psi_dot).to_string(), sentence);
        }
    }
}
