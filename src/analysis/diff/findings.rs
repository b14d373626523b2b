//! Findings of a comparison: corresponding numbers of A and B, most important first.

use super::averages::Averaged;
use super::crossing::{MeanCrossing, ripple};
use super::discrepancy::Discrepancy;
use super::floor::Floor;
use super::pairing::Paired;
use crate::analysis::history::{PegSummary, RunHistory, RunSummary};
use crate::analysis::phrase::{duration, moment, signed_duration, significant};
use crate::run::simulation::{EventKind, StopReason};
use crate::telemetry::fields::{NumberField, energy, nutation, state};
use schemars::JsonSchema;
use serde::Serialize;

/// A pair of corresponding numbers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Finding {
    /// The compared quantity.
    pub what: String,
    /// The unit, empty for pure numbers.
    pub unit: String,
    /// A's number; absent if it has none.
    pub a: Option<f64>,
    /// B's number; absent if it has none.
    pub b: Option<f64>,
    /// The difference B − A.
    pub difference: Option<f64>,
    /// Uncertainty of the difference; absent if it is not known.
    pub uncertainty: Option<f64>,
    /// Error of the difference due to the two integrations alone; absent if it is not known.
    pub integration_error: Option<f64>,
}

impl Finding {
    /// A's and B's number with the integration error of their difference, which is also its uncertainty.
    fn new(what: &str, unit: &str, [a, b]: [Option<f64>; 2], error: Option<f64>) -> Self {
        Self {
            what: what.to_owned(),
            unit: unit.to_owned(),
            a,
            b,
            difference: a.zip(b).map(|(a, b)| b - a),
            uncertainty: error,
            integration_error: error,
        }
    }

    /// Whether either run has the number.
    fn is_known(&self) -> bool {
        self.a.is_some() || self.b.is_some() || self.difference.is_some()
    }

    /// Whether the numbers differ by more than the integration error, or exist in one run only.
    pub fn differs(&self) -> bool {
        let error = self.integration_error.unwrap_or(0.0);
        match self.difference {
            Some(difference) => difference.abs() > error,
            None => self.a != self.b,
        }
    }

    /// The cells of a table: what is compared with its unit, A's and B's number, B − A with its uncertainty.
    pub fn cells(&self) -> [String; 4] {
        let known = [self.a, self.b].into_iter().flatten();
        let is_count = self.unit.is_empty()
            && known.clone().count() > 0
            && known.clone().all(|n| n.fract() == 0.0);
        let is_time = self.unit == "s";
        let value = |value: Option<f64>| match value {
            Some(value) if is_time => format!("{value:.4}"),
            Some(value) if is_count => format!("{value}"),
            Some(value) => significant(value, 6),
            None => "–".to_owned(),
        };
        let difference = self.difference.map(|difference| match difference {
            0.0 => "0".to_owned(),
            shift if is_time => signed_duration(shift),
            count if is_count => format!("{count:+}").replace('-', "−"),
            difference => significant(difference, 3),
        });
        // Uncertainties below the displayed digits are omitted.
        let is_shown = |error: &f64| *error > NEGLIGIBLE * self.difference.unwrap_or(0.0).abs();
        let uncertainty = match self.uncertainty.filter(is_shown) {
            Some(error) if is_time => format!(" ± {}", duration(error)),
            Some(error) => format!(" ± {}", significant(error, 2)),
            None => String::new(),
        };
        let what = match self.unit.as_str() {
            "" => self.what.clone(),
            unit => format!("{} [{unit}]", self.what),
        };
        let difference = difference.map_or_else(String::new, |text| text + &uncertainty);
        [what, value(self.a), value(self.b), difference]
    }
}

/// Uncertainties below this fraction of the difference are not shown.
const NEGLIGIBLE: f64 = 1e-3;

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

/// Everything that the findings are computed from.
pub(super) struct Evidence<'e> {
    pub(super) paired: &'e Paired,
    pub(super) averaged: Option<&'e Averaged>,
    pub(super) discrepancy: Option<&'e Discrepancy>,
    pub(super) floor: Option<&'e Floor>,
}

impl Evidence<'_> {
    /// The errors of both integrations of a field together.
    fn error_of(&self, field: NumberField) -> Option<f64> {
        self.floor?.of(&field.to_string())
    }

    /// The errors of both integrations of an event's time together, s.
    fn error_of_time(&self) -> Option<f64> {
        self.floor.map(Floor::event_time)
    }
}

/// All findings, the most important first.
pub(super) fn findings(evidence: &Evidence<'_>) -> Vec<Finding> {
    let summaries = [0, 1].map(|side| evidence.paired.runs[side].history.summary());
    let mut runs = evidence.paired.runs.iter();
    // Ends and counts of a part are not those of the run.
    let are_whole = runs.clone().all(|run| run.losses.is_empty());
    // A free peg may interrupt its nutation anywhere.
    let has_cycles = runs.all(|run| !run.history.has_gaps || run.history.peg.is_none());
    let mut found = Vec::new();
    found.extend(are_whole.then(|| end(evidence, &summaries)));
    found.extend(crossing(evidence).filter(|_| has_cycles));
    if are_whole {
        found.extend(rise(evidence));
        found.extend(events(evidence));
        found.extend(peg(evidence, &summaries));
    }
    found.extend(averages(evidence).into_iter().filter(|_| has_cycles));
    found.extend(energy_lost(evidence));
    found.extend(torque(evidence));
    found.retain(Finding::is_known);
    found
}

fn end(evidence: &Evidence<'_>, summaries: &[RunSummary; 2]) -> Finding {
    let reasons = summaries.each_ref().map(|run| run.stop_reason.as_deref());
    let what = match reasons {
        [Some(a), Some(b)] if a == b => format!("ends ({a})"),
        [Some(a), Some(b)] => format!("ends ({a}, {b})"),
        _ => "ends".to_owned(),
    };
    // `stop.duration` is exact.
    let are_events = reasons != [Some(StopReason::Duration.name()); 2];
    let error = evidence.error_of_time().filter(|_| are_events);
    let times = summaries.each_ref().map(|run| run.stop_time);
    Finding::new(&what.replace('_', " "), "s", times, error)
}

/// The times at which the averaged motions cross a common level.
fn crossing(evidence: &Evidence<'_>) -> Option<Finding> {
    let [a, b] = &evidence.paired.runs;
    let integrators = evidence
        .floor
        .map_or([0.0; 2], |floor| [floor.a.theta_mean, floor.b.theta_mean]);
    let found = MeanCrossing::find(&a.history, &b.history, integrators)?;
    let what = format!("mean θ crosses {} rad", significant(found.level, 3));
    let times = found.times.map(Some);
    let error = evidence.floor.map(|_| found.integration_error);
    Some(Finding {
        uncertainty: Some(found.uncertainty),
        ..Finding::new(&what, "s", times, error)
    })
}

/// The first crossing times of the common level by θ, which depend on the nutation phase.
fn rise(evidence: &Evidence<'_>) -> Option<Finding> {
    let runs = &evidence.paired.runs;
    let crossings = runs.each_ref().map(|run| run.history.rise.as_ref());
    let level = crossings[0]?.level;
    let is_known = |side: usize| {
        let cycles = runs[side].history.cycles.iter();
        let shortest = cycles.map(|cycle| cycle.period).reduce(f64::min);
        crossings[side].is_some_and(|crossing| crossing.is_known(shortest))
    };
    if !is_known(0) || !is_known(1) {
        return None;
    }
    let risen = crossings.map(|crossing| crossing?.time());
    let by_nutation = |side: usize| {
        let [earliest, latest] = ripple(&runs[side].history, risen[side]?)?;
        Some(earliest.abs().max(latest.abs()))
    };
    let errors = evidence.error_of_time();
    let uncertainty = by_nutation(0).zip(by_nutation(1));
    let uncertainty = uncertainty.map(|(a, b)| a + b + errors.unwrap_or(0.0));
    let what = format!("θ first reaches {} rad", significant(level, 3));
    Some(Finding {
        uncertainty: uncertainty.or(errors),
        ..Finding::new(&what, "s", risen, errors)
    })
}

/// First times of events, and the number of loops.
fn events(evidence: &Evidence<'_>) -> Vec<Finding> {
    let histories = evidence.paired.runs.each_ref().map(|run| &run.history);
    let errors = evidence.error_of_time();
    let time = |kind: EventKind| histories.map(|run| run.first(kind).map(|event| event.time));
    let count = |kind| histories.map(|run| Some(run.events_of(kind).count() as f64));
    let is_tippe = histories.iter().any(|run| run.is_of_tippe_top());
    let mut found = Vec::new();
    if is_tippe {
        let inverted = histories.map(|run| run.inverted);
        let is_exact = |run: &RunHistory| run.inverted.is_none() || run.has_exact_inversion();
        if histories.into_iter().all(is_exact) {
            found.push(Finding::new("inverts", "s", inverted, errors));
        }
    }
    // A tippe top can precess backward without loops.
    let loops = count(EventKind::LoopingBegins);
    if !is_tippe && loops != [Some(0.0); 2] {
        let first = time(EventKind::LoopingBegins);
        found.push(Finding::new("first loop", "s", first, errors));
        found.push(Finding::new("loops", "", loops, None));
    }
    for (kind, what) in FIRST_EVENTS {
        found.push(Finding::new(what, "s", time(kind), errors));
    }
    found
}

/// Events of free pegs.
fn peg(evidence: &Evidence<'_>, summaries: &[RunSummary; 2]) -> Vec<Finding> {
    let pegs = summaries.each_ref().map(|run| run.peg.as_ref());
    if pegs == [None, None] {
        return Vec::new();
    }
    let of = |get: fn(&PegSummary) -> Option<f64>| pegs.map(|peg| peg.and_then(get));
    let flights = of(|peg| peg.hops.map(|count| count as f64));
    let first_roll = of(|peg| peg.first_roll);
    let rolls_at = of(|peg| peg.rolls_to_end_at);
    let mut found = Vec::new();
    if flights.iter().flatten().any(|count| *count > 0.0) {
        found.push(Finding::new("flights", "", flights, None));
    }
    let errors = [evidence.error_of_time(), evidence.error_of(state::THETA)];
    found.push(Finding::new("first rolls", "s", first_roll, errors[0]));
    let what = "θ at start of final rolling";
    found.push(Finding::new(what, "rad", rolls_at, errors[1]));
    found
}

/// Differences of the averaged motions at equal times.
fn averages(evidence: &Evidence<'_>) -> Vec<Finding> {
    let Some(averaged) = evidence.averaged else {
        return Vec::new();
    };
    let mean = |field, name: &str| {
        let deviation = averaged.of(field)?;
        let what = format!("{name} at {}", moment(deviation.at));
        let (unit, values) = (&deviation.unit, deviation.values.map(Some));
        Some(Finding::new(&what, unit, values, evidence.error_of(field)))
    };
    let runs = &evidence.paired.runs;
    let is_tippe = runs.iter().any(|run| run.history.is_of_tippe_top());
    let means = [
        (nutation::THETA_MEAN, "mean θ"),
        (nutation::PHI_DOT_MEAN, "mean φ̇"),
        (nutation::PSI_DOT_MEAN, "mean ψ̇"),
    ];
    // For a tippe top near the vertical, precession and spin are not separable.
    let means = means
        .into_iter()
        .take(if is_tippe { 1 } else { 3 })
        .filter_map(|(field, name)| mean(field, name));
    let phase = averaged.phase.as_ref().map(|phase| {
        let last = runs[0].history.successive_cycles().last();
        let of_start = evidence.error_of(nutation::START).zip(last);
        let what = format!("nutation phase lead in cycles at {}", moment(phase.at));
        let error = of_start.map(|(error, last)| error / last.period);
        Finding {
            difference: Some(phase.ahead),
            ..Finding::new(&what, "", [None; 2], error)
        }
    });
    let amplitudes = averaged.amplitudes.map(|amplitudes| {
        let what = format!("nutation amplitude of θ̇ at {}", moment(averaged.to));
        let bounds = [nutation::THETA_DOT_MIN, nutation::THETA_DOT_MAX];
        let [least, greatest] = bounds.map(|bound| evidence.error_of(bound));
        let error = least.zip(greatest).map(|(a, b)| 0.5 * (a + b));
        Finding::new(&what, "rad/s", amplitudes.map(Some), error)
    });
    means.chain(phase).chain(amplitudes).collect()
}

/// The energy lost by the last sample that both runs have.
fn energy_lost(evidence: &Evidence<'_>) -> Option<Finding> {
    let common = &evidence.paired.common;
    let what = format!("energy lost by {}", moment(common[0]?.until));
    let field = energy::TOTAL.to_string();
    let errors = evidence.floor.map_or([None; 2], |floor| {
        [&floor.a, &floor.b].map(|error| error.of(&field))
    });
    let lost = [0, 1].map(|side| {
        let lost = common[side].map(|energies| energies.first - energies.last)?;
        let is_error = lost.abs() <= errors[side].unwrap_or(0.0);
        Some(if is_error { 0.0 } else { lost })
    });
    let error = evidence.error_of(energy::TOTAL);
    (lost != [Some(0.0); 2]).then(|| Finding::new(&what, "J", lost, error))
}

/// Difference of the models' friction torques at the states of A.
fn torque(evidence: &Evidence<'_>) -> Option<Finding> {
    let torque = evidence.discrepancy?.quantities.first()?;
    let what = "max. friction torque difference at A's states";
    Some(Finding {
        difference: Some(torque.largest),
        ..Finding::new(what, &torque.unit, [None; 2], None)
    })
}
