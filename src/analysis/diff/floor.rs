//! Section f of a report: how much of a difference is the integrators' doing.
//!
//! Each scenario is simulated twice more, with its own tolerances and with a hundredth of them, and the two are compared
//! like any runs. Their difference is the error of the coarser one, as far as it is known. A difference between A and B
//! that is no larger than both errors together, the floor, says nothing about the models.

use super::averages;
use super::events::Events;
use super::observer::While;
use super::options::Options;
use super::passage::LevelPassage;
use super::plan::ComparisonPlan;
use super::reading::read_both;
use super::topic::ComparedTopic;
use crate::analysis::subject::Subject;
use crate::run::scenario::Scenario;
use schemars::JsonSchema;
use serde::Serialize;
use std::thread;

/// Factor by which the tolerances are tightened.
const TIGHTER: f64 = 0.01;
/// The tightest tolerances that scenarios may have.
const TIGHTEST_RELATIVE: f64 = 1e-14;
const TIGHTEST_ABSOLUTE: f64 = 1e-18;

/// Section f: how far each run would be from itself with a hundredth of its tolerances.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Floor {
    /// A's error.
    pub a: IntegratorError,
    /// B's error.
    pub b: IntegratorError,
}

/// The error of an integrator.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct IntegratorError {
    /// The relative tolerance of the run.
    pub relative_tolerance: f64,
    /// The relative tolerance that it was compared with.
    pub compared_with: f64,
    /// Fields and their largest differences.
    pub fields: Vec<(String, f64)>,
    /// Largest shift of an event, s, but of those that come with each nutation.
    pub event_shift: f64,
    /// Largest difference of the mean of θ over a nutation, rad.
    pub theta_mean: f64,
}

impl Floor {
    /// The errors of both integrators together in a field (with its topic), if they are known.
    pub(super) fn of(&self, field: &str) -> Option<f64> {
        let of = |error: &IntegratorError| {
            let mut fields = error.fields.iter();
            Some(fields.find(|(name, _)| name == field)?.1)
        };
        Some(of(&self.a)? + of(&self.b)?)
    }
}

/// Finds the errors of both integrators up to a time (s), if both scenarios are known and `carry_on` doesn't say no.
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
    let (a, b) = thread::scope(|scope| {
        let a = scope.spawn(|| error(&a, carry_on));
        (a.join(), error(&b, carry_on))
    });
    Some(Floor { a: a.ok()??, b: b? })
}

fn error(scenario: &Scenario, carry_on: &(dyn Fn() -> bool + Sync)) -> Option<IntegratorError> {
    let tighter = tightened(scenario)?;
    let runs = [Subject::Scenario(scenario), Subject::Scenario(&tighter)];
    let options = Options::default();
    let plan = ComparisonPlan::new(runs, &options).ok()?;
    let findings = read_both(runs, &plan, &options.tolerances, &mut While(carry_on)).ok()?;
    let [first, second] = [0, 1].map(|side| &findings.runs[side].course);
    let passage = LevelPassage::find(first, second, [0.0; 2]);
    let events = Events::compare(first, second, passage.as_ref());
    let means = averages::compare(first, second).map(|averaged| averaged.means);
    let theta = means.and_then(|means| means.first().map(|mean| mean.largest.abs()));
    let largest = |topic: &ComparedTopic| topic.tally.largest().collect::<Vec<_>>();
    Some(IntegratorError {
        relative_tolerance: scenario.tolerances.relative,
        compared_with: tighter.tolerances.relative,
        fields: findings.compared().flat_map(largest).collect(),
        event_shift: events.largest_shift(),
        theta_mean: theta.unwrap_or_default(),
    })
}

/// The scenario, ended at a time (s): its run is the beginning of the whole, to the last bit.
fn until(scenario: &Scenario, time: f64) -> Option<Scenario> {
    if scenario
        .stop
        .duration
        .is_some_and(|duration| duration <= time)
    {
        return Some(scenario.clone());
    }
    scenario.with([("stop.duration", time.into())]).ok()
}

/// The scenario with a hundredth of its tolerances, as far as that goes.
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
