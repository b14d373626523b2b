//! The findings of a comparison, most important first.
//!
//! A number is compared only if both runs can have it: events are compared as far as both runs go, and only if both
//! have recorded them; counts over the time that both have; ends only if they are of one kind. A number that depends on
//! the integration, because another integration of the same run does not have it, is left out.

use super::crossing::{MeanCrossing, ripple};
use super::evidence::Evidence;
use super::finding::{Finding, FindingKind};
use super::floor::combined;
use super::pairing::RunData;
use crate::analysis::history::{PegPhase, RunHistory};
use crate::analysis::phrase::{moment, significant};
use crate::run::scenario::Scenario;
use crate::run::simulation::{EventKind, StopReason};
use crate::telemetry::fields::{EVENTS, NumberField, energy, nutation};

/// Events of one kind are at one level of θ if they are at the same angle within this, rad: a level is met to the
/// resolution of a step, some 1e-16 s, in which θ changes by far less.
const SAME_LEVEL: f64 = 1e-9;

/// First event of a kind in a run, if there is one.
const FIRST_EVENTS: [(EventKind, &str); 8] = [
    (EventKind::Fallen, "falls"),
    (EventKind::UprightPassage, "first passes upright"),
    (EventKind::WeakTop, "becomes weak"),
    (EventKind::SlipStops, "first stops slipping"),
    (EventKind::Stick, "first sticks"),
    (EventKind::LiftOff, "first lifts off"),
    (EventKind::Rest, "comes to rest"),
    (EventKind::Jam, "jams"),
];

/// All findings, the most important first.
pub(super) fn findings(evidence: &Evidence<'_>) -> Vec<Finding> {
    let mut runs = evidence.paired.runs.iter();
    // Ends and counts of a part are not those of the run.
    let are_whole = runs.clone().all(is_whole);
    // A free peg may interrupt its nutation anywhere.
    let has_cycles = runs.all(|run| !run.history.has_gaps || run.history.peg.is_none());
    let mut found = Vec::new();
    if are_whole {
        found.extend(end(evidence));
    }
    if has_cycles {
        found.extend(crossing(evidence));
    }
    if are_whole {
        found.extend(first_reach(evidence));
        found.extend(inversion(evidence));
        if evidence.has_events() {
            found.extend(events(evidence));
        }
    }
    if has_cycles {
        found.extend(means(evidence));
        found.extend(phase_lead(evidence));
        found.extend(amplitude(evidence));
    }
    found.extend(energy_lost(evidence));
    found.extend(torque(evidence));
    found.retain(Finding::is_known);
    merge_equal_times(&mut found);
    found
}

/// Whether nothing of a run is known to be missing.
fn is_whole(run: &RunData) -> bool {
    run.losses.is_empty() && !run.history.lacks(EVENTS)
}

/// Merges times of one instant in both runs, e.g. of a rise that ends both: one row, with the larger uncertainty.
fn merge_equal_times(found: &mut Vec<Finding>) {
    let mut merged: Vec<Finding> = Vec::new();
    for finding in found.drain(..) {
        let is_same = |other: &&mut Finding| {
            let are_times = finding.kind.is_time_of_event() && other.kind.is_time_of_event();
            are_times && [finding.a, finding.b] == [other.a, other.b]
        };
        match merged.iter_mut().find(is_same) {
            Some(known) => {
                known.difference = known.difference.or(finding.difference);
                let errors = [known.uncertainty, finding.uncertainty]
                    .into_iter()
                    .flatten();
                known.uncertainty = errors.reduce(f64::max);
                known.integration_error = known.integration_error.or(finding.integration_error);
            }
            None => merged.push(finding),
        }
    }
    *found = merged;
}

/// The reason for which a run ends, with its level of θ (rad).
fn end_condition(run: &RunHistory, scenario: Option<&Scenario>) -> (String, Option<f64>) {
    let Some(reason) = run.stop_reason() else {
        return (String::new(), None);
    };
    let stop = scenario.map(|scenario| &scenario.stop);
    let limit = stop.and_then(|stop| match reason {
        StopReason::Risen => stop.theta_risen,
        StopReason::Fallen => stop.theta_fallen,
        StopReason::Duration => stop.duration,
        StopReason::SlipStopped
        | StopReason::Rest
        | StopReason::Singular
        | StopReason::Jam
        | StopReason::Pivot
        | StopReason::Interrupted
        | StopReason::Failed => None,
    });
    let name = reason.name().replace('_', " ");
    let text = match (reason, limit) {
        (StopReason::Risen | StopReason::Fallen, Some(level)) => {
            format!("{name} to {} rad", significant(level, 3))
        }
        _ => name,
    };
    (text, limit)
}

/// The ends of the runs. Their times have a difference only if one condition ends both.
fn end(evidence: &Evidence<'_>) -> Option<Finding> {
    let histories = evidence.histories();
    let conditions =
        [0, 1].map(|side| end_condition(histories[side], evidence.scenarios[side].as_ref()));
    let [(of_a, _), (of_b, _)] = &conditions;
    let what = match (of_a.as_str(), of_b.as_str()) {
        ("", _) | (_, "") => "ends".to_owned(),
        (a, b) if a == b => format!("ends ({a})"),
        (a, b) => format!("ends ({a}, {b})"),
    };
    let times = histories.map(|run| run.stop_reason().and(run.stop_time()));
    let error = match evidence.integrations {
        Some(integrations) => {
            let [a, b] = [0, 1].map(|side| {
                // Another integration that ends for another reason has no such time.
                let reason = histories[side].stop_reason();
                integrations.error_of(side, |run| {
                    let is_same = run.stop_reason() == reason;
                    run.stop_time().filter(|_| is_same)
                })
            });
            // `stop.duration` is exact.
            let is_exact = reason_of_both(histories) == Some(StopReason::Duration);
            let error = combined([a?, b?], times.map(Option::unwrap_or_default));
            Some(if is_exact { 0.0 } else { error })
        }
        None => None,
    };
    let mut finding = Finding::new(FindingKind::End, what, times, error);
    if conditions[0] != conditions[1] {
        finding.difference = None;
        finding.uncertainty = None;
        finding.integration_error = None;
    }
    Some(finding)
}

fn reason_of_both([a, b]: [&RunHistory; 2]) -> Option<StopReason> {
    a.stop_reason()
        .filter(|_| a.stop_reason() == b.stop_reason())
}

/// The times at which the averaged motions cross a common level.
fn crossing(evidence: &Evidence<'_>) -> Option<Finding> {
    let [a, b] = evidence.histories();
    let errors = match evidence.integrations {
        Some(integrations) => integrations
            .of_averages()
            .map(|errors| combined([errors.largest(nutation::THETA_MEAN), 0.0], [0.0; 2])),
        None => [0.0; 2],
    };
    let found = MeanCrossing::find(a, b, errors)?;
    let what = format!("mean θ crosses {} rad", significant(found.level, 3));
    let error = evidence.integrations.map(|_| found.integration_error);
    Some(Finding {
        uncertainty: Some(found.uncertainty),
        ..Finding::new(
            FindingKind::MeanCrossing,
            what,
            found.times.map(Some),
            error,
        )
    })
}

/// The first crossing times of the common level by θ, which depend on the nutation phase.
fn first_reach(evidence: &Evidence<'_>) -> Option<Finding> {
    let histories = evidence.histories();
    let level = histories[0].rise.as_ref()?.level;
    let is_known = |run: &RunHistory| {
        let shortest = run.cycles.iter().map(|cycle| cycle.period).reduce(f64::min);
        let crossing = run.rise.as_ref();
        crossing.is_some_and(|crossing| crossing.is_known(shortest))
    };
    if !histories.into_iter().all(is_known) {
        return None;
    }
    let time = |run: &RunHistory| run.rise.as_ref()?.time();
    let what = format!("θ first reaches {} rad", significant(level, 3));
    let finding = evidence.compare_times(FindingKind::FirstReach, &what, time)?;
    let by_nutation = |run: &RunHistory| {
        let [earliest, latest] = ripple(run, time(run)?)?;
        Some(earliest.abs().max(latest.abs()))
    };
    let [a, b] = histories.map(by_nutation);
    let uncertainty = a.zip(b).filter(|_| finding.difference.is_some());
    let integration = finding.integration_error;
    Some(Finding {
        uncertainty: uncertainty
            .map(|(a, b)| a + b + integration.unwrap_or(0.0))
            .or(integration),
        ..finding
    })
}

/// The time at which a tippe top inverts and stays so to its end, if it is exact in both runs.
fn inversion(evidence: &Evidence<'_>) -> Option<Finding> {
    let histories = evidence.histories();
    // A top that swings back does not invert.
    let inverted = |run: &RunHistory| run.inverted.filter(|_| run.is_inverted_at_end());
    let is_exact = |run: &RunHistory| inverted(run).is_none() || run.has_exact_inversion();
    let is_tippe = histories.into_iter().any(RunHistory::is_of_tippe_top);
    if !is_tippe || !histories.into_iter().all(is_exact) {
        return None;
    }
    evidence.compare_times(FindingKind::Inversion, "inverts", inverted)
}

/// First times of events, and the numbers of loops and flights.
fn events(evidence: &Evidence<'_>) -> Vec<Finding> {
    let mut found = Vec::new();
    // A tippe top can precess backward without loops.
    let is_tippe = evidence
        .histories()
        .into_iter()
        .any(RunHistory::is_of_tippe_top);
    if !is_tippe {
        let first = |run: &RunHistory| first_time(run, EventKind::LoopingBegins);
        found.extend(evidence.compare_times(FindingKind::FirstLoop, "first loop", first));
        found.extend(
            evidence.compare_counts(FindingKind::Loops, "loops", |run, end| {
                let loops = run.events_of(EventKind::LoopingBegins);
                Some(loops.filter(|event| event.time <= end).count())
            }),
        );
    }
    found.extend(peg(evidence));
    for (kind, what) in FIRST_EVENTS {
        if has_one_level(evidence, kind) {
            let first = |run: &RunHistory| first_time(run, kind);
            found.extend(evidence.compare_times(FindingKind::FirstEvent, what, first));
        }
    }
    found
}

fn first_time(run: &RunHistory, kind: EventKind) -> Option<f64> {
    Some(run.first(kind)?.time)
}

/// Whether the first events of a kind, if they are at a level of θ, are at the same.
fn has_one_level(evidence: &Evidence<'_>, kind: EventKind) -> bool {
    if kind != EventKind::Fallen {
        return true;
    }
    let [a, b] = evidence.histories().map(|run| run.first(kind));
    if let (Some(a), Some(b)) = (a, b) {
        return (a.theta - b.theta).abs() <= SAME_LEVEL;
    }
    // A run without the event may have a higher level.
    let scenarios = evidence.scenarios.each_ref();
    let [a, b] = scenarios.map(|scenario| scenario.as_ref().map(|s| s.stop.theta_fallen));
    a == b
}

/// Findings about free pegs.
fn peg(evidence: &Evidence<'_>) -> Vec<Finding> {
    let flights = |run: &RunHistory, end: f64| {
        let intervals = run.peg.as_ref()?.intervals(end);
        let flights = intervals.iter().filter(|i| i.phase == PegPhase::Flying);
        Some(flights.filter(|flight| flight.from < end).count())
    };
    let first_roll = |run: &RunHistory| {
        let intervals = run.peg.as_ref()?.intervals(run.stop_time()?);
        let mut rolling = intervals.iter().filter(|i| i.phase == PegPhase::Rolling);
        Some(rolling.next()?.from)
    };
    let last_roll = |run: &RunHistory| {
        let intervals = run.peg.as_ref()?.intervals(run.stop_time()?);
        intervals
            .last()
            .copied()
            .filter(|last| last.phase == PegPhase::Rolling)
    };
    let mut found = Vec::new();
    found.extend(evidence.compare_counts(FindingKind::Flights, "flights", flights));
    found.extend(evidence.compare_times(FindingKind::FirstRoll, "first rolls", first_roll));
    // The rolling that lasts to the end must begin before the other run ends.
    let start = |run: &RunHistory| Some(last_roll(run)?.from);
    if evidence
        .compare_times(FindingKind::FirstRoll, "", start)
        .is_some()
    {
        let theta = |run: &RunHistory| Some(last_roll(run)?.theta);
        let what = "θ at start of final rolling";
        found.extend(evidence.compare(FindingKind::FinalRollTheta, what, theta));
    }
    found
}

/// The error of the difference of two averages from those of A and B; `None` if an integration lacks them.
fn error_of_averages(errors: [Option<f64>; 2], values: [f64; 2]) -> Option<f64> {
    let [Some(a), Some(b)] = errors else {
        return None;
    };
    Some(combined([a, b], values))
}

/// Differences of the averaged motions at equal times.
fn means(evidence: &Evidence<'_>) -> Vec<Finding> {
    let means = [
        (FindingKind::MeanTheta, nutation::THETA_MEAN, "mean θ"),
        (
            FindingKind::MeanPrecession,
            nutation::PHI_DOT_MEAN,
            "mean φ̇",
        ),
        (FindingKind::MeanSpin, nutation::PSI_DOT_MEAN, "mean ψ̇"),
    ];
    let mut found = Vec::new();
    for (kind, field, name) in means {
        found.extend(mean(evidence, kind, field, name));
    }
    found
}

fn mean(
    evidence: &Evidence<'_>,
    kind: FindingKind,
    field: NumberField,
    name: &str,
) -> Option<Finding> {
    let deviation = evidence.averaged?.of(field)?;
    let error = match evidence.integrations {
        Some(integrations) => {
            let errors = integrations.of_averages();
            let errors = errors.map(|errors| errors.of_field(field, deviation.at));
            Some(error_of_averages(errors, deviation.values)?)
        }
        None => None,
    };
    let what = format!("{name} at {}", moment(deviation.at));
    Some(Finding::new(kind, what, deviation.values.map(Some), error))
}

fn phase_lead(evidence: &Evidence<'_>) -> Option<Finding> {
    let phase = evidence.averaged?.phase.as_ref()?;
    let error = match evidence.integrations {
        Some(integrations) => {
            let errors = integrations.of_averages();
            let errors = errors.map(|errors| errors.of_phase(phase.at));
            // The lead is the difference of two numbers of cycles.
            let cycles = evidence.histories().map(|run| run.cycles.len() as f64);
            Some(error_of_averages(errors, cycles)?)
        }
        None => None,
    };
    let what = format!("nutation phase lead in cycles at {}", moment(phase.at));
    Some(Finding::of_difference(
        FindingKind::PhaseLead,
        what,
        phase.ahead,
        error,
    ))
}

fn amplitude(evidence: &Evidence<'_>) -> Option<Finding> {
    let averaged = evidence.averaged?;
    let amplitudes = averaged.amplitudes?;
    let error = match evidence.integrations {
        Some(integrations) => {
            let errors = integrations.of_averages();
            let errors = errors.map(|errors| errors.of_amplitude(averaged.to));
            Some(error_of_averages(errors, amplitudes)?)
        }
        None => None,
    };
    let what = format!("nutation amplitude of θ̇ at {}", moment(averaged.to));
    let values = amplitudes.map(Some);
    Some(Finding::new(FindingKind::Amplitude, what, values, error))
}

/// The energy lost by the last sample that both runs have.
fn energy_lost(evidence: &Evidence<'_>) -> Option<Finding> {
    let [Some(a), Some(b)] = &evidence.paired.common else {
        return None;
    };
    let energies = [a, b];
    let what = format!("energy lost by {}", moment(a.until));
    let field = energy::TOTAL.to_string();
    let errors = evidence.integrations.map(|integrations| {
        let floor = &integrations.floor;
        [&floor.a, &floor.b].map(|error| error.of(&field).unwrap_or_default())
    });
    let lost = [0, 1].map(|side| {
        let energies = energies[side];
        let lost = energies.first - energies.last;
        let own = errors.map_or(0.0, |errors| {
            combined([errors[side], 0.0], [energies.first, energies.last])
        });
        if lost.abs() <= own { 0.0 } else { lost }
    });
    if lost == [0.0; 2] {
        return None;
    }
    let error = errors.map(|errors| combined(errors, [a.first, b.first]));
    Some(Finding::new(
        FindingKind::EnergyLost,
        what,
        lost.map(Some),
        error,
    ))
}

/// Difference of the models' torques of friction, losses and air drag at the states of A.
fn torque(evidence: &Evidence<'_>) -> Option<Finding> {
    let torque = evidence.discrepancy?.quantities.first()?;
    let mut scenarios = evidence.scenarios.iter().flatten();
    let has_air_drag = scenarios.any(|scenario| scenario.model.friction.has_air_drag());
    let what = if has_air_drag {
        "max. friction and air drag torque difference at A's states"
    } else {
        "max. friction torque difference at A's states"
    };
    Some(Finding::of_difference(
        FindingKind::TorqueDifference,
        what,
        torque.largest,
        None,
    ))
}
