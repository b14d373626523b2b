//! How exact two runs are: what of their difference is the integrators' doing.

use super::plan::Plan;
use super::report::{Floor, IntegratorError};
use super::{Options, Subject, Tolerances, averages, happened, pass};
use crate::run::scenario::Scenario;
use std::thread;

/// The factor by which the tolerances are tightened.
const TIGHTER: f64 = 0.01;
/// The tightest tolerances that scenarios may have.
const TIGHTEST_RELATIVE: f64 = 1e-14;
const TIGHTEST_ABSOLUTE: f64 = 1e-18;

/// Finds the errors of both integrators up to a time (s), if both scenarios are known.
pub(super) fn compute(a: Subject<'_>, b: Subject<'_>, to: f64) -> Option<Floor> {
    let (a, b) = (until(&a.scenario()?, to)?, until(&b.scenario()?, to)?);
    if a.digest() == b.digest() {
        let error = error(&a)?;
        return Some(Floor {
            a: error.clone(),
            b: error,
        });
    }
    let (a, b) = thread::scope(|scope| {
        let a = scope.spawn(|| error(&a));
        (a.join(), error(&b))
    });
    Some(Floor { a: a.ok()??, b: b? })
}

fn error(scenario: &Scenario) -> Option<IntegratorError> {
    let tighter = tightened(scenario)?;
    let (a, b) = (Subject::Scenario(scenario), Subject::Scenario(&tighter));
    let options = Options::default();
    let plan = Plan::new(a, b, &options).ok()?;
    let passed = pass::run(a, b, &plan, &Tolerances::default(), &mut ()).ok()?;
    let [first, second] = &passed.courses;
    let happened = happened::compare(first, second, true);
    let shifts = happened.kinds.iter().filter_map(|kind| kind.largest_shift);
    let means = averages::compare(first, second).map(|averaged| averaged.means);
    let theta = means.and_then(|means| means.first().map(|mean| mean.largest.abs()));
    Some(IntegratorError {
        relative_tolerance: scenario.tolerances.relative,
        compared_with: tighter.tolerances.relative,
        fields: passed
            .channels
            .iter()
            .flatten()
            .flat_map(|channel| channel.largest())
            .collect(),
        event_shift: shifts.map(f64::abs).fold(0.0, f64::max),
        theta_mean: theta.unwrap_or_default(),
    })
}

/// The scenario up to a time, s: its beginning, to the last bit.
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
