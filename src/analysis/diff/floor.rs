//! Integration errors.
//!
//! Each scenario is simulated twice more, with its own tolerances and with a hundredth of them. Their difference
//! estimates the error of the coarser run. A difference between A and B below the combined error is not significant.

use super::averages;
use super::pairing::{Paired, read_both};
use super::tolerance::Options;
use super::topic::TopicTally;
use crate::analysis::history::RunHistory;
use crate::analysis::subject::Subject;
use crate::run::scenario::Scenario;
use crate::run::simulation::EventKind;
use crate::telemetry::Topic;
use crate::telemetry::fields::nutation;
use schemars::JsonSchema;
use serde::Serialize;
#[cfg(not(target_family = "wasm"))]
use std::thread;

/// Factor for the tightened tolerances.
const TIGHTER: f64 = 0.01;
/// Minimum tolerances (rounding).
const TIGHTEST_RELATIVE: f64 = 1e-14;
const TIGHTEST_ABSOLUTE: f64 = 1e-18;

/// The errors of both integrations.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Floor {
    /// A's.
    pub a: IntegratorError,
    /// B's.
    pub b: IntegratorError,
}

/// The error of one integration.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct IntegratorError {
    /// The relative tolerance of the run.
    pub relative_tolerance: f64,
    /// The tightened relative tolerance.
    pub compared_with: f64,
    /// The largest error of each field, by its full name.
    pub fields: Vec<(String, f64)>,
    /// The largest error of an event's time, s.
    pub event_time: f64,
    /// The largest error of the mean of θ over a nutation, rad.
    pub theta_mean: f64,
}

impl IntegratorError {
    /// The error of a field.
    pub(super) fn of(&self, field: &str) -> Option<f64> {
        let mut fields = self.fields.iter();
        Some(fields.find(|(name, _)| name == field)?.1)
    }
}

impl Floor {
    /// The errors of a field, A's and B's together.
    pub(super) fn of(&self, field: &str) -> Option<f64> {
        Some(self.a.of(field)? + self.b.of(field)?)
    }

    /// The error of the difference of the times of two events, s.
    pub(super) fn event_time(&self) -> f64 {
        self.a.event_time + self.b.event_time
    }
}

/// Computes both errors up to a time (s); `None` if a scenario is missing or can't be tightened.
pub(super) fn compute(
    [a, b]: [Subject<'_>; 2],
    to: f64,
    carry_on: &(dyn Fn() -> bool + Sync),
) -> Option<Floor> {
    let (a, b) = (until(&a.scenario()?, to)?, until(&b.scenario()?, to)?);
    if a.digest() == b.digest() {
        let error = error(&a, carry_on)?;
        return Some(Floor {
            a: error.clone(),
            b: error,
        });
    }
    #[cfg(not(target_family = "wasm"))]
    let (a, b) = thread::scope(|scope| {
        let a = scope.spawn(|| error(&a, carry_on));
        let b = error(&b, carry_on);
        (a.join().ok().flatten(), b)
    });
    #[cfg(target_family = "wasm")]
    let (a, b) = (error(&a, carry_on), error(&b, carry_on));
    Some(Floor { a: a?, b: b? })
}

fn error(scenario: &Scenario, carry_on: &(dyn Fn() -> bool + Sync)) -> Option<IntegratorError> {
    let tighter = tightened(scenario)?;
    let runs = [Subject::Scenario(scenario), Subject::Scenario(&tighter)];
    let topics = Topic::all_with(scenario.model.support);
    let topics: Vec<_> = topics.map(|topic| topic.to_string()).collect();
    let paired = read_both(runs, &topics, &Options::default(), &mut (), carry_on).ok()?;
    let Paired { runs: [a, b], .. } = &paired;
    let averaged = averages::compare(&a.history, &b.history);
    let theta = averaged.and_then(|averaged| Some(averaged.of(nutation::THETA_MEAN)?.largest));
    Some(IntegratorError {
        relative_tolerance: scenario.tolerances.relative,
        compared_with: tighter.tolerances.relative,
        fields: paired.compared().flat_map(TopicTally::largest).collect(),
        event_time: event_time(&a.history, &b.history),
        theta_mean: theta.unwrap_or_default().abs(),
    })
}

/// The largest difference of the first times of events of a kind.
fn event_time(a: &RunHistory, b: &RunHistory) -> f64 {
    let first = |history: &RunHistory, kind| history.first(kind).map(|event| event.time);
    let shifts = EventKind::ALL
        .into_iter()
        .filter_map(|kind| Some((first(b, kind)? - first(a, kind)?).abs()));
    shifts.fold(0.0, f64::max)
}

/// A scenario that ends no later than this, s.
fn until(scenario: &Scenario, time: f64) -> Option<Scenario> {
    let duration = scenario.stop.duration;
    if duration.is_some_and(|duration| duration <= time) {
        return Some(scenario.clone());
    }
    scenario.with([("stop.duration", time.into())]).ok()
}

fn tightened(scenario: &Scenario) -> Option<Scenario> {
    let relative = (scenario.tolerances.relative * TIGHTER).max(TIGHTEST_RELATIVE);
    let absolute = (scenario.tolerances.absolute * TIGHTER).max(TIGHTEST_ABSOLUTE);
    let tighter = scenario.with([
        ("integrator.relative_tolerance", relative.into()),
        ("integrator.absolute_tolerance", absolute.into()),
    ]);
    tighter
        .ok()
        .filter(|_| relative < scenario.tolerances.relative)
}
