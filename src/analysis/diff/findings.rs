//! The findings of a comparison, most important first.
//!
//! A number is compared only if both runs can have it: events are compared as far as both runs go, and only if both
//! have recorded them; counts over the time that both have; ends only if they are of one kind. A number that depends on
//! the integration, because another integration of the same run does not have it, is left out.

mod averaged;
pub(super) mod contrast;
mod crossing;
mod events;
pub(super) mod finding;
pub(super) mod measure;
pub(super) mod quantity;
mod sources;

use self::averaged::{amplitude, axial_spin, crossing, distances, means, phase_lead};
use self::crossing::ripple;
use self::events::events;
use self::finding::{Dependence, Finding};
use self::quantity::{EndCondition, Quantity};
use super::evidence::Evidence;
use super::integration_error::{IntegrationError, combined};
use super::pairing::PairedRun;
use super::tolerance::Options;
use crate::analysis::history::RunHistory;
use crate::run::scenario::Scenario;
use crate::run::simulation::StopReason;
use crate::telemetry::fields::{EVENTS, energy};
use crate::telemetry::side::Side;

/// All findings, the most important first.
pub(super) fn findings(evidence: &Evidence<'_>, options: &Options) -> Vec<Finding> {
    let runs = &evidence.paired.runs;
    // Ends and counts of a part are not those of the run.
    let are_whole = runs.iter().all(is_whole);
    // A free peg may interrupt its nutation anywhere.
    let has_cycles = runs
        .iter()
        .all(|run| !run.history.has_gaps || run.history.peg.is_none());
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
    found.extend(distances(evidence));
    if has_cycles {
        found.extend(means(evidence));
    }
    found.extend(axial_spin(evidence));
    if has_cycles {
        found.extend(phase_lead(evidence));
        found.extend(amplitude(evidence));
    }
    found.extend(energy_lost(evidence));
    found.extend(torque(evidence));
    found.retain(|finding| finding.is_known() && finding.quantity.is_selected(options));
    let mut merged = merge_equal_times(found);
    for finding in &mut merged {
        finding.tolerate(options);
    }
    merged
}

/// Whether nothing of a run is known to be missing.
fn is_whole(run: &PairedRun) -> bool {
    run.losses.is_empty() && !run.history.lacks(EVENTS)
}

/// Merges times of one instant in both runs, e.g. of a rise that ends both: one row, with the dependences of both.
fn merge_equal_times(found: Vec<Finding>) -> Vec<Finding> {
    let mut merged: Vec<Finding> = Vec::new();
    for finding in found {
        let same = merged.iter_mut().find(|other| {
            finding.quantity.is_time_of_event()
                && other.quantity.is_time_of_event()
                && [finding.a, finding.b] == [other.a, other.b]
        });
        match same {
            Some(known) => {
                known.difference = known.difference.or(finding.difference);
                known.dependences.extend(finding.dependences);
                known.integration_error = known.integration_error.or(finding.integration_error);
            }
            None => merged.push(finding),
        }
    }
    merged
}

/// The condition that ends a run; `None` if it is not recorded.
fn end_condition(run: &RunHistory, scenario: Option<&Scenario>) -> Option<EndCondition> {
    let reason = run.stop_reason()?;
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
    Some(EndCondition { reason, limit })
}

/// The conditions that end the runs.
pub(super) fn end_conditions(evidence: &Evidence<'_>) -> [Option<EndCondition>; 2] {
    let histories = evidence.histories();
    Side::BOTH.map(|side| {
        let scenario = evidence.scenarios[side.index()].as_ref();
        end_condition(histories[side.index()], scenario)
    })
}

/// The ends of the runs. Their times have a difference only if one condition ends both.
fn end(evidence: &Evidence<'_>) -> Option<Finding> {
    let ends = end_conditions(evidence);
    let times = evidence
        .histories()
        .map(|run| run.stop_reason().and(run.stop_time()));
    let mut finding = Finding::new(Quantity::End { ends }, times);
    if ends[0] != ends[1] {
        finding.difference = None;
    }
    finding.with_error(end_error(evidence, times))
}

/// The error of the difference of two ends; undetermined if another integration ends for another reason.
fn end_error(evidence: &Evidence<'_>, times: [Option<f64>; 2]) -> IntegrationError {
    let reasons = evidence.histories().map(RunHistory::stop_reason);
    let times = times.map(Option::unwrap_or_default);
    let error = evidence.error(times, |integrations, side| {
        integrations.error_of(side, |run| stop_time_for(run, reasons[side.index()]))
    });
    match error {
        // `stop.duration` is exact.
        IntegrationError::Within(_) if reasons == [Some(StopReason::Duration); 2] => {
            IntegrationError::Within(0.0)
        }
        error => error,
    }
}

/// The time of the end of a run, if it ends for this reason, s.
fn stop_time_for(run: &RunHistory, reason: Option<StopReason>) -> Option<f64> {
    run.stop_time().filter(|_| run.stop_reason() == reason)
}

/// The level at which both runs end as risen, rad.
fn common_level(evidence: &Evidence<'_>) -> Option<f64> {
    let [a, b] = evidence
        .scenarios
        .each_ref()
        .map(|scenario| scenario.as_ref()?.stop.theta_risen);
    a.filter(|level| b == Some(*level))
}

/// The times at which θ first crosses the common level, which depend on the nutation phase.
fn first_reach(evidence: &Evidence<'_>) -> Option<Finding> {
    let level = common_level(evidence)?;
    let finding = evidence.compare_times(Quantity::FirstReach { level }, RunHistory::rise_time)?;
    let [a, b] = Side::BOTH.map(|side| largest_ripple(evidence, side));
    let by_nutation = a.zip(b).filter(|_| finding.difference.is_some());
    Some(Finding {
        dependences: Vec::from_iter(
            by_nutation.map(|(a, b)| Dependence::Nutation { change: a + b }),
        ),
        ..finding
    })
}

/// The largest shift of the first crossing by the nutation of a run, s.
fn largest_ripple(evidence: &Evidence<'_>, side: Side) -> Option<f64> {
    let recorded = evidence.histories()[side.index()];
    let time = recorded.rise_time()?;
    // A recording may lack the nutations, but the simulation for the integration error has them.
    let simulated = evidence
        .integrations
        .map(|integrations| integrations.own(side));
    let nutating = match simulated {
        Some(simulated) if recorded.cycles.is_empty() => simulated,
        _ => recorded,
    };
    ripple(nutating, time)
}

/// The time at which a tippe top inverts and stays so to its end.
fn inversion(evidence: &Evidence<'_>) -> Option<Finding> {
    let histories = evidence.histories();
    if !histories.into_iter().any(RunHistory::is_tippe_top) {
        return None;
    }
    evidence.compare_times(Quantity::Inversion, inversion_time)
}

/// The time at which a top inverts, s. A top that swings back does not invert.
fn inversion_time(run: &RunHistory) -> Option<f64> {
    run.inverted().filter(|_| run.is_inverted_at_end())
}

/// The energy lost by the last sample that both runs have.
fn energy_lost(evidence: &Evidence<'_>) -> Option<Finding> {
    let [Some(a), Some(b)] = &evidence.paired.common else {
        return None;
    };
    let field = energy::TOTAL.to_string();
    let errors = evidence.integrations.map(|integrations| {
        let errors = &integrations.errors;
        Side::BOTH.map(|side| errors.of(side).field(&field).unwrap_or_default())
    });
    let lost = Side::BOTH.map(|side| {
        // At equal times: `common` has only samples with a partner.
        let energies = [a, b][side.index()];
        let lost = energies.first - energies.last;
        let own = errors.map_or(0.0, |errors| {
            combined([errors[side.index()], 0.0], [energies.first, energies.last])
        });
        // A loss below the error may be an error.
        if lost.abs() <= own { 0.0 } else { lost }
    });
    if lost == [0.0; 2] {
        return None;
    }
    let error = errors.map_or(IntegrationError::Unknown, |errors| {
        IntegrationError::Within(combined(errors, [a.first, b.first]))
    });
    Finding::new(Quantity::EnergyLost { until: a.until }, lost.map(Some)).with_error(error)
}

/// Difference of the models' torques of friction, losses and air drag at the states of A.
fn torque(evidence: &Evidence<'_>) -> Option<Finding> {
    let torque = evidence.discrepancy?.quantities.first()?;
    if torque.largest == 0.0 {
        return None;
    }
    let has_air_drag = evidence
        .scenarios
        .iter()
        .flatten()
        .any(|scenario| scenario.model.friction.has_air_drag());
    Some(Finding::from_difference(
        Quantity::TorqueDifference {
            has_air_drag,
            at: torque.at,
            rms_a: torque.rms_a,
        },
        torque.largest,
    ))
}
