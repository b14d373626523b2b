//! Integration errors.
//!
//! Each scenario is integrated three times: with its own tolerances, with the tightest useful ones, and with tolerances
//! in between in the other formulation where that is possible. The first run's error is its largest distance from the other
//! two. A difference between A and B within the combined errors is not significant.

use super::averages::AverageErrors;
use super::pairing::{Limits, read_both};
use super::tolerance::Options;
use super::topic::TopicTally;
use crate::analysis::history::RunHistory;
use crate::analysis::subject::Subject;
use crate::run::scenario::{FormulationKind, Scenario};
use crate::run::simulation::{EventKind, StopReason};
use crate::telemetry::Topic;
use crate::telemetry::fields::{NumberField, nutation, state};
use crate::telemetry::side::Side;
use crate::words::{Piece, Sentence, sentence};
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;
#[cfg(not(target_family = "wasm"))]
use std::thread;

/// Minimum tolerances (rounding). The relative one is that of the tightened run: a hundredth of a coarse tolerance would
/// not show chaos that sets in later.
const TIGHTEST_RELATIVE: f64 = 1e-14;
const TIGHTEST_ABSOLUTE: f64 = 1e-18;
/// Factor for tolerances that can't be tightened: a coarser run shows at least the errors of rounding.
const COARSENING: f64 = 10.0;
/// Smallest useful change of a tolerance, as the ratio of the tightened one to the own one.
const MAX_TIGHTENED: f64 = 0.5;

/// Safety factor of the errors.
///
/// Where truncation dominates, both other runs are much more accurate than the first, and 1.2 would suffice. Where
/// rounding dominates, all runs are equally far from the truth, and the distances can be small by chance. If the errors
/// are independent and normal, the difference of A and B exceeds the sum of both estimates (each the larger of two
/// distances) five times in about 5 of 100,000 cases; `val_safety_factor_covers_rounding` repeats the count.
pub(super) const SAFETY: f64 = 5.0;
/// Allowance for the rounding of a number, ulp.
const ROUNDINGS: f64 = 8.0;

/// The errors of both integrations.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct IntegrationErrors {
    /// The errors of A's integration.
    pub a: IntegratorError,
    /// The errors of B's integration.
    pub b: IntegratorError,
}

/// The error of one integration.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct IntegratorError {
    /// The relative tolerance of the run.
    pub relative_tolerance: f64,
    /// The tightened relative tolerance.
    pub compared_with: f64,
    /// The largest error of each field, by its full name, and then of each derived quantity.
    pub fields: Vec<(String, f64)>,
    /// The largest error of an event's time, s: of the end, of an inversion, and of the first event of each kind.
    pub event_time: f64,
    /// The largest error of the mean of θ over a nutation, rad.
    pub theta_mean: f64,
}

impl IntegratorError {
    /// The error of a field.
    pub(super) fn field(&self, field: &str) -> Option<f64> {
        let (_, error) = self.fields.iter().find(|(name, _)| name == field)?;
        Some(*error)
    }

    fn tolerances(&self) -> Sentence {
        sentence!(
            "{} against {}",
            format!("{:e}", self.relative_tolerance),
            format!("{:e}", self.compared_with)
        )
    }
}

impl IntegrationErrors {
    /// The errors of a run.
    pub(super) fn of(&self, side: Side) -> &IntegratorError {
        match side {
            Side::A => &self.a,
            Side::B => &self.b,
        }
    }

    /// The errors of a field, A's and B's together.
    pub(super) fn field(&self, field: &str) -> Option<f64> {
        Some(self.a.field(field)? + self.b.field(field)?)
    }

    /// The largest errors of both runs, and what they are estimated with.
    pub fn sentence(&self) -> Sentence {
        let runs = [&self.a, &self.b];
        let theta = runs.map(|run| run.field(&state::THETA.to_string()).unwrap_or_default());
        let tolerances = if self.a.relative_tolerance == self.b.relative_tolerance {
            self.a.tolerances()
        } else {
            sentence!("{} in A, {} in B", self.a.tolerances(), self.b.tolerances())
        };
        sentence!(
            "Integration errors: θ {}, events {} (tolerance {}). ± has five times those of both runs.",
            Piece::number(theta[0].max(theta[1]), 1, "rad"),
            Piece::number(self.a.event_time.max(self.b.event_time), 1, "s"),
            tolerances
        )
    }
}

/// The error that the integrations of two runs make in a difference of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum IntegrationError {
    /// It was not estimated.
    Unknown,
    /// It is no larger than this.
    Within(f64),
    /// The number depends on the integration: not all integrations of a run have it.
    Undetermined,
}

/// The integrations of both runs.
#[derive(Debug)]
pub(super) struct Integrations {
    pub(super) errors: IntegrationErrors,
    sides: [RepeatedRun; 2],
}

/// A scenario that is integrated several times.
#[derive(Clone, Debug)]
struct RepeatedRun {
    error: IntegratorError,
    /// With its own tolerances.
    own: RunHistory,
    /// With others, or in the other formulation.
    others: Vec<RunHistory>,
    averages: AverageErrors,
}

/// The error of the difference of two numbers whose own errors are known.
pub(super) fn combined(errors: [f64; 2], numbers: [f64; 2]) -> f64 {
    let rounding = ROUNDINGS * f64::EPSILON * (numbers[0].abs() + numbers[1].abs());
    SAFETY * (errors[0] + errors[1]) + rounding
}

impl Integrations {
    /// The largest distance of a number of a run from those of the other integrations; `None` if not all have it or
    /// all lack it.
    pub(super) fn error_of(
        &self,
        side: Side,
        number: impl Fn(&RunHistory) -> Option<f64>,
    ) -> Option<f64> {
        let RepeatedRun { own, others, .. } = &self.sides[side.index()];
        let own = number(own);
        let mut error = 0.0_f64;
        for other in others {
            match (own, number(other)) {
                (Some(own), Some(other)) => error = error.max((own - other).abs()),
                (None, None) => {}
                (Some(_), None) | (None, Some(_)) => return None,
            }
        }
        Some(error)
    }

    /// A run as it is integrated with its own tolerances, with all topics.
    pub(super) fn own(&self, side: Side) -> &RunHistory {
        &self.sides[side.index()].own
    }

    /// The errors of the averages of a run.
    pub(super) fn averages(&self, side: Side) -> &AverageErrors {
        &self.sides[side.index()].averages
    }
}

/// The integrations of two runs. Fields and averages are compared up to the time of `limits`, events up to the end of
/// each run; `None` if a scenario is unknown.
pub(super) fn compute(
    [a, b]: [(Subject<'_>, &RunHistory); 2],
    limits: &Limits<'_>,
    carry_on: &(dyn Fn() -> bool + Sync),
) -> Option<Integrations> {
    let (a, b) = (as_far_as_run(a)?, as_far_as_run(b)?);
    if a.digest() == b.digest() {
        // Integrating one scenario twice would show nothing new.
        let repeated = repeat(&a, limits, carry_on)?;
        return Some(Integrations::new([repeated.clone(), repeated]));
    }
    #[cfg(not(target_family = "wasm"))]
    let (a, b) = thread::scope(|scope| {
        let a = scope.spawn(|| repeat(&a, limits, carry_on));
        let b = repeat(&b, limits, carry_on);
        (a.join().ok().flatten(), b)
    });
    #[cfg(target_family = "wasm")]
    let (a, b) = (repeat(&a, limits, carry_on), repeat(&b, limits, carry_on));
    Some(Integrations::new([a?, b?]))
}

impl Integrations {
    fn new(sides: [RepeatedRun; 2]) -> Self {
        let [a, b] = sides.each_ref().map(|side| side.error.clone());
        Self {
            errors: IntegrationErrors { a, b },
            sides,
        }
    }
}

/// The scenario of a run; if the run did not come to its end, ending where it was interrupted.
fn as_far_as_run((run, history): (Subject<'_>, &RunHistory)) -> Option<Scenario> {
    let scenario = run.scenario()?;
    let reason = history.stop_reason();
    if reason.is_some_and(StopReason::is_complete) {
        return Some(scenario);
    }
    let time = history.stop_time()?;
    let duration = scenario.stop.duration;
    if duration.is_some_and(|duration| duration <= time) {
        return Some(scenario);
    }
    scenario.with([("stop.duration", time.into())]).ok()
}

fn repeat(
    scenario: &Scenario,
    limits: &Limits<'_>,
    carry_on: &(dyn Fn() -> bool + Sync),
) -> Option<RepeatedRun> {
    let own = &scenario.tolerances;
    let relative = other_tolerance(own.relative);
    let absolute = (own.absolute * (relative / own.relative)).max(TIGHTEST_ABSOLUTE);
    let first = with_tolerances(scenario, relative, absolute)?;
    // Halfway between the two, in logarithms.
    let between = with_tolerances(
        scenario,
        (own.relative * relative).sqrt(),
        (own.absolute * absolute).sqrt(),
    )?;
    let mut repeated = RepeatedRun {
        error: IntegratorError {
            relative_tolerance: own.relative,
            compared_with: relative,
            ..IntegratorError::default()
        },
        own: RunHistory::default(),
        others: Vec::new(),
        averages: AverageErrors::default(),
    };
    let mut fields = BTreeMap::new();
    repeated.add(scenario, &first, limits, &mut fields, carry_on)?;
    // In Euler angles a run ends where they are singular: then the formulations can't be compared.
    match in_other_formulation(&between).filter(|_| !ends_singular(&repeated.own)) {
        Some(second) => {
            // Kept, because only the finished run shows that it ends where Euler angles are singular.
            let known = repeated.clone();
            repeated.add(scenario, &second, limits, &mut fields, carry_on)?;
            if repeated.others.last().is_some_and(ends_singular) {
                repeated = known;
                repeated.add(scenario, &between, limits, &mut fields, carry_on)?;
            }
        }
        None => repeated.add(scenario, &between, limits, &mut fields, carry_on)?,
    }
    for field in scenario_fields(scenario) {
        repeated
            .error
            .fields
            .extend(fields.remove_entry(&field.to_string()));
    }
    repeated.error.fields.extend(fields);
    repeated.error.event_time = repeated.event_time();
    repeated.error.theta_mean = repeated.averages.largest(nutation::THETA_MEAN);
    Some(repeated)
}

fn ends_singular(run: &RunHistory) -> bool {
    run.stop_reason() == Some(StopReason::Singular)
}

/// All fields of a scenario's recordings.
fn scenario_fields(scenario: &Scenario) -> impl Iterator<Item = NumberField> {
    Topic::all_with(scenario.model.support).flat_map(Topic::numbers)
}

impl RepeatedRun {
    /// Integrates a scenario and a variant of it. `fields` has the largest difference of each field.
    fn add(
        &mut self,
        scenario: &Scenario,
        variant: &Scenario,
        limits: &Limits<'_>,
        fields: &mut BTreeMap<String, f64>,
        carry_on: &dyn Fn() -> bool,
    ) -> Option<()> {
        // Runs are compared while they are read, so the first one is integrated again with each variant.
        let runs = [scenario, variant].map(Subject::Scenario);
        let topics: Vec<String> = Topic::all_with(scenario.model.support)
            .map(|topic| topic.to_string())
            .collect();
        let all_topics = Limits {
            topics: &topics,
            ..*limits
        };
        let options = Options::default();
        let paired = read_both(runs, &all_topics, &options, &mut (), carry_on).ok()?;
        for (name, difference) in paired.compared().flat_map(TopicTally::largest) {
            let largest = fields.entry(name).or_insert(0.0);
            *largest = difference.max(*largest);
        }
        let [own, other] = paired.runs.map(|run| run.history);
        self.averages
            .add(&own, &other, limits.until.unwrap_or(f64::INFINITY));
        self.own = own;
        self.others.push(other);
        Some(())
    }

    /// The largest error of the time of the end, of an inversion, or of the first event of a kind, s.
    fn event_time(&self) -> f64 {
        let mut largest = 0.0_f64;
        for other in &self.others {
            let mut pairs = vec![
                (self.own.stop_time(), other.stop_time()),
                (self.own.inverted(), other.inverted()),
            ];
            for kind in EventKind::ALL {
                let [own, other] = [&self.own, other].map(|run| Some(run.first(kind)?.time));
                pairs.push((own, other));
            }
            for pair in pairs {
                if let (Some(own), Some(other)) = pair {
                    largest = largest.max((own - other).abs());
                }
            }
        }
        largest
    }
}

/// The tightened relative tolerance, or a coarser one where rounding allows no tighter one.
fn other_tolerance(own: f64) -> f64 {
    if TIGHTEST_RELATIVE <= MAX_TIGHTENED * own {
        TIGHTEST_RELATIVE
    } else {
        COARSENING * own
    }
}

fn with_tolerances(scenario: &Scenario, relative: f64, absolute: f64) -> Option<Scenario> {
    scenario
        .with([
            ("integrator.relative_tolerance", relative.into()),
            ("integrator.absolute_tolerance", absolute.into()),
        ])
        .ok()
}

/// The scenario in the other formulation, if it can be integrated in it.
fn in_other_formulation(scenario: &Scenario) -> Option<Scenario> {
    let other = match scenario.formulation {
        FormulationKind::Euler => "body",
        FormulationKind::Body => "euler",
    };
    // `Scenario::new` refuses what can't be integrated in it: free pegs, a vertical start, terms of the Euler
    // equations.
    scenario.with([("formulation", other.into())]).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Normal numbers, the same on every machine: sums of twelve uniform ones.
    fn normal(bits: &mut u64) -> f64 {
        let mut sum = -6.0;
        for _ in 0..12 {
            *bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            sum += (*bits >> 11) as f64 / (1_u64 << 53) as f64;
        }
        sum
    }

    #[test]
    fn val_safety_factor_covers_rounding() {
        const CASES: u32 = 100_000;
        let mut bits = 1;
        let mut beyond = 0;
        for _ in 0..CASES {
            let runs = [(); 2].map(|()| [(); 3].map(|()| normal(&mut bits)));
            let errors = runs.map(|[own, one, other]| (own - one).abs().max((own - other).abs()));
            let difference = runs[0][0] - runs[1][0];
            beyond += u32::from(difference.abs() > SAFETY * (errors[0] + errors[1]));
        }
        // The expectation is 5.5; 15 has a probability of 1e-3.
        assert!((1..15).contains(&beyond), "{beyond}");
    }
}
