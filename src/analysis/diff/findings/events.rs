//! Findings about events: first times and counts.

use super::finding::Finding;
use super::quantity::Quantity;
use crate::analysis::diff::evidence::Evidence;
use crate::analysis::history::{Interval, PegPhase, RunHistory, in_phase};
use crate::run::simulation::EventKind;

/// Events of one kind are at one level of θ if they are at the same angle within this, rad: a level is met to the
/// resolution of a step, some 1e-16 s, in which θ changes by far less.
const SAME_LEVEL: f64 = 1e-9;

/// Kinds of events whose first times are compared.
const FIRST_EVENTS: [EventKind; 8] = [
    EventKind::Fallen,
    EventKind::UprightPassage,
    EventKind::WeakTop,
    EventKind::SlipStops,
    EventKind::Stick,
    EventKind::LiftOff,
    EventKind::Rest,
    EventKind::Jam,
];

/// First times of events, and the numbers of loops and hops.
pub(super) fn events(evidence: &Evidence<'_>) -> Vec<Finding> {
    let mut found = Vec::new();
    let is_tippe = evidence
        .histories()
        .into_iter()
        .any(RunHistory::is_tippe_top);
    // A tippe top can precess backward without loops.
    if !is_tippe {
        found.extend(evidence.compare_times(Quantity::FirstLoop, |run| {
            first_time(run, EventKind::LoopingBegins)
        }));
        found.extend(evidence.compare_counts(
            |until| Quantity::Loops { until },
            |run, until| Some(count_loops(run, until)),
        ));
    }
    found.extend(peg(evidence));
    for event in FIRST_EVENTS {
        if has_one_level(evidence, event) {
            let quantity = Quantity::FirstEvent { event };
            found.extend(evidence.compare_times(quantity, |run| first_time(run, event)));
        }
    }
    found
}

pub(super) fn first_time(run: &RunHistory, kind: EventKind) -> Option<f64> {
    Some(run.first(kind)?.time)
}

/// Number of loops that begin by a time (s).
pub(super) fn count_loops(run: &RunHistory, until: f64) -> usize {
    run.events_of(EventKind::LoopingBegins)
        .filter(|event| event.time <= until)
        .count()
}

/// Whether the first events of a kind, if they are at a level of θ, are at the same.
fn has_one_level(evidence: &Evidence<'_>, kind: EventKind) -> bool {
    if kind != EventKind::Fallen {
        return true;
    }
    let [a, b] = evidence.histories().map(|run| run.first(kind));
    if let (Some(a), Some(b)) = (a, b) {
        return (a.state.theta - b.state.theta).abs() <= SAME_LEVEL;
    }
    // A run without the event may have a higher level.
    let [a, b] = evidence
        .scenarios
        .each_ref()
        .map(|scenario| scenario.as_ref().map(|scenario| scenario.stop.theta_fallen));
    a == b
}

/// Findings about free pegs.
fn peg(evidence: &Evidence<'_>) -> Vec<Finding> {
    let mut found = Vec::new();
    found.extend(evidence.compare_counts(|until| Quantity::Hops { until }, count_hops));
    found.extend(evidence.compare_times(Quantity::FirstRoll, first_roll));
    // The rolling that lasts to the end must begin before the other run ends.
    let start = evidence.compare_times(Quantity::FirstRoll, |run| Some(final_roll(run)?.from));
    if start.is_some() {
        found
            .extend(evidence.compare(Quantity::FinalRollTheta, |run| Some(final_roll(run)?.theta)));
    }
    found
}

/// Number of times in the air that begin before a time (s).
pub(super) fn count_hops(run: &RunHistory, until: f64) -> Option<usize> {
    let intervals = run.peg.as_ref()?.intervals(until);
    let hops = in_phase(&intervals, PegPhase::Flying);
    Some(hops.iter().filter(|hop| hop.from < until).count())
}

/// Time at which the peg first rolls, s.
pub(super) fn first_roll(run: &RunHistory) -> Option<f64> {
    let intervals = run.peg.as_ref()?.intervals(run.stop_time()?);
    Some(in_phase(&intervals, PegPhase::Rolling).first()?.from)
}

/// The rolling that lasts to the end.
pub(super) fn final_roll(run: &RunHistory) -> Option<Interval> {
    let last = *run.peg.as_ref()?.intervals(run.stop_time()?).last()?;
    (last.phase == PegPhase::Rolling).then_some(last)
}
