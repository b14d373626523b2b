//! Why the mean inclination of the axis changes, in terms of precession without nutation.
//!
//! Without friction, the angular momenta about the vertical and the axis are constant, and the axis nutates about the
//! inclination at which a top with these precesses regularly. Friction changes the mean inclination in two ways: it
//! changes the angular momenta, and with them that inclination; and it changes the nutation, in which the mean differs
//! from that inclination if the nutation is large. The change is the sum of the two parts.

use super::evidence::{Evidence, ROUNDED};
use super::momentum::MomentumState;
use crate::analysis::history::Cycle;
use crate::analysis::phrase::{capitalized, works};
use crate::run::simulation::EventKind;
use crate::telemetry::fields::nutation;
use std::cmp::Ordering;
use std::ops::Range;

/// The ratio of a part to the change of the mean inclination for which that part is the larger one, and in the same
/// direction; a part that is much larger than the change says little, because the other one takes most of it back.
const LARGER_PART: Range<f64> = 0.5..2.0;

/// The cause of a change of the mean inclination by friction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Drift {
    cause: Cause,
    /// Whether friction at the contact point acts, and whether air drag does.
    losses: [bool; 2],
    is_tippe_top: bool,
    /// Whether the contact point grips for good, some time after the start.
    grips_later: bool,
    falls: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cause {
    /// The angular momenta change, and with them the inclination without nutation.
    Momenta { change: MomentaChange, rises: bool },
    /// The nutation shrinks.
    Damping { rises: bool },
    /// The nutation grows, upwards and downwards.
    Growth { rises: bool },
    /// The mean inclination does not change.
    Absent,
}

/// What friction does to the sizes of the angular momenta about the vertical and about the axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct MomentaChange {
    vertical: Ordering,
    axial: Ordering,
}

/// The cause of the change of the mean inclination while the contact point slips; `None` if the numbers don't show it.
pub(super) fn drift(evidence: &Evidence) -> Option<Drift> {
    if evidence.scenario.is_frictionless() {
        return None;
    }
    evidence.history.stop_reason()?;
    let friction = &evidence.scenario.model.friction;
    let slide = Slide::new(evidence)?;
    Some(Drift {
        cause: slide.cause(evidence)?,
        losses: [friction.acts_at_contact(), friction.has_air_drag()],
        is_tippe_top: evidence.history.is_tippe_top(),
        grips_later: evidence.observations.grip.is_some(),
        falls: evidence.history.first(EventKind::Fallen).is_some(),
    })
}

/// The time from the first nutation to the sample before the contact point grips for good, or to the last. Static friction
/// changes the angular momenta of a rolling top to and fro, and holds one that sticks.
struct Slide<'a> {
    /// The first nutation and the last.
    cycles: [&'a Cycle; 2],
    /// Mean inclination in the first nutation and in the last, rad; at the end, if the axis no longer nutates then.
    theta: [f64; 2],
    momentum: [MomentumState; 2],
    nutates_to_end: bool,
}

impl<'a> Slide<'a> {
    /// `None` if it has fewer than two nutations.
    fn new(evidence: &'a Evidence) -> Option<Self> {
        let observations = &evidence.observations;
        let whole = observations.momentum.whole()?;
        let [_, last_state] = evidence.history.states?;
        let (end, theta, momentum) = match observations.grip {
            Some(grip) => (grip.from, grip.theta_at_start, grip.momentum_before?),
            None => (f64::INFINITY, last_state.theta, whole.to),
        };
        let cycles = &evidence.history.cycles;
        let count = cycles.partition_point(|cycle| cycle.end() <= end);
        let [first, .., last] = &cycles[..count] else {
            return None;
        };
        let nutates_to_end = !last.is_last_before(end.min(last_state.time));
        let theta = if nutates_to_end { last.means[0] } else { theta };
        Some(Self {
            cycles: [first, last],
            theta: [first.means[0], theta],
            momentum: [observations.momentum_in_first_nutation?, momentum],
            nutates_to_end,
        })
    }

    fn cause(&self, evidence: &Evidence) -> Option<Cause> {
        if evidence.is_constant_theta(self.theta) {
            return Some(Cause::Absent);
        }
        let top = evidence.scenario.model.nutating_top();
        let [from, to] = self
            .momentum
            .map(|state| top.regular_inclination(state.vertical, state.axial));
        let change = self.theta[1] - self.theta[0];
        let rises = change < 0.0;
        let by_momenta = (to - from) / change;
        if LARGER_PART.contains(&by_momenta) {
            let change = self.momenta_change(evidence)?;
            return Some(Cause::Momenta { change, rises });
        }
        // Impacts change the nutation, too.
        if evidence.may_have_impacts() {
            return None;
        }
        let by_nutation = 1.0 - by_momenta;
        let [[first_least, first_greatest], [least, greatest]] = self.cycles.map(extremes);
        let shrinks = greatest - least < 0.5 * (first_greatest - first_least);
        if LARGER_PART.contains(&by_nutation) && shrinks {
            Some(Cause::Damping { rises })
        } else if self.nutates_to_end && least < first_least && greatest > first_greatest {
            Some(Cause::Growth { rises })
        } else {
            None
        }
    }

    /// `None` if nothing changes.
    fn momenta_change(&self, evidence: &Evidence) -> Option<MomentaChange> {
        let [from, to] = self.momentum;
        let known = ROUNDED * evidence.observations.momentum.largest();
        let change = MomentaChange {
            vertical: size_change(from.vertical, to.vertical, known),
            axial: size_change(from.axial, to.axial, known),
        };
        (change.vertical.is_ne() || change.axial.is_ne()).then_some(change)
    }
}

/// How the size of a number compares to that of an earlier one; equal up to a difference of `known`.
fn size_change(from: f64, to: f64, known: f64) -> Ordering {
    let growth = to.abs() - from.abs();
    if growth.abs() <= known {
        Ordering::Equal
    } else {
        growth.total_cmp(&0.0)
    }
}

/// The least and the greatest inclination in a nutation, rad.
fn extremes(cycle: &Cycle) -> [f64; 2] {
    [nutation::THETA_MIN, nutation::THETA_MAX].map(|field| cycle.field(field))
}

impl Drift {
    /// The cause in words.
    pub(super) fn words(self) -> String {
        let [friction, air] = self.losses;
        let works = works([friction, air, false]);
        // The ending of its verbs.
        let s = if friction && air { "" } else { "s" };
        let sentences = match self.cause {
            Cause::Momenta { change, rises } => {
                let increases = if rises { "decreases" } else { "increases" };
                let falls = if self.falls {
                    ", until the top falls"
                } else {
                    ""
                };
                format!(
                    "{works} {}, and so the inclination at which the top would precess without nutation {increases}. The axis follows it, and {}{falls}.",
                    change.words(s),
                    self.moves(rises)
                )
            }
            Cause::Damping { rises } => format!(
                "{works} damp{s} the nutation. The mean inclination of large nutations differs from that at which the top would precess without nutation. As the nutation shrinks, the axis approaches this inclination: on average, it {}.",
                self.moves(rises)
            ),
            Cause::Growth { rises } => {
                let inclined = if rises { "less" } else { "more" };
                format!(
                    "{works} change{s} the angular momenta and the energy so that the nutation grows: the axis reaches smaller and larger inclinations than at first, and on average it is {inclined} inclined."
                )
            }
            Cause::Absent => format!(
                "{works} hardly change{s} the inclination about which the axis nutates: on average, it neither rises nor sinks."
            ),
        };
        if self.grips_later {
            format!("While the contact point slips, {sentences}")
        } else {
            capitalized(&sentences)
        }
    }

    /// What the axis does. The centre of mass of a tippe top goes the other way.
    fn moves(self, rises: bool) -> &'static str {
        match (self.is_tippe_top, rises) {
            (false, true) => "rises",
            (false, false) => "sinks",
            (true, true) => "turns upwards",
            (true, false) => "turns downwards",
        }
    }
}

impl MomentaChange {
    /// The change in words, with verbs of this ending.
    fn words(self, s: &str) -> String {
        let (vertical, axial) = (verb(self.vertical), verb(self.axial));
        match (self.vertical, self.axial) {
            (_, Ordering::Equal) => {
                format!("{vertical}{s} the angular momentum about the vertical")
            }
            (Ordering::Equal, _) => format!("{axial}{s} the angular momentum about the axis"),
            (one, other) if one == other => {
                format!("{axial}{s} the angular momenta about the axis and about the vertical")
            }
            (_, _) => format!(
                "{axial}{s} the angular momentum about the axis and {vertical}{s} that about the vertical"
            ),
        }
    }
}

/// What is done to a number that then compares so to the earlier one.
fn verb(change: Ordering) -> &'static str {
    match change {
        Ordering::Less => "reduce",
        Ordering::Equal => "keep",
        Ordering::Greater => "increase",
    }
}

#[cfg(test)]
mod tests {
    use crate::analysis::explain::explain;
    use crate::run::scenario::{Preset, Scenario};

    #[test]
    fn names_why_the_mean_inclination_changes() {
        for (preset, keys, expected) in [
            (
                "lifecycle",
                &["initial.theta = 1.45"][..],
                "precess without nutation increases. The axis follows it, and sinks, until the top falls",
            ),
            (
                "spin-torque-only",
                &["initial.theta = 1.45"],
                "Friction reduces the angular momenta",
            ),
            (
                "paper-precession-term-only",
                &["friction.k = 0.3"],
                "precess without nutation decreases. The axis follows it, and rises",
            ),
            (
                "tilt-torque-only",
                &["initial.psi_dot = 30"],
                "Friction increases the angular momentum about the vertical, and so",
            ),
            (
                "paper-spin-term-only",
                &["initial.phi_dot = 30"],
                "the nutation grows",
            ),
            (
                "free-viscous",
                &[
                    "initial.psi_dot = 35",
                    "initial.theta = 0.3",
                    "friction.k = 0.01",
                    "stop.duration = 10",
                ],
                "damps the nutation",
            ),
            (
                "free-paper",
                &["initial.psi_dot = 30"],
                "While the contact point slips, friction increases the angular momentum about the axis and reduces that about the vertical",
            ),
            ("drop", &["friction.k = 0.003"], "and rises"),
            (
                "rise-by-loss-of-spin",
                &["initial.theta = 1.45"],
                "because of its motion at the start",
            ),
        ] {
            let mut values = Preset::find(preset).unwrap().values().unwrap();
            for (key, value) in keys.iter().filter_map(|key| key.split_once(" = ")) {
                values.set(key, value).unwrap();
            }
            let explanation = explain(&Scenario::new(values).unwrap()).unwrap();
            let text = explanation.story.text().unwrap_or_default();
            assert!(text.contains(expected), "{preset}, {keys:?}: {text}");
        }
    }
}
