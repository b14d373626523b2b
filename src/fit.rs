//! Friction from measured motions: estimates parameters of a scenario and compares friction laws.
//!
//! The model is the simulation itself, sampled at the times of the data. Residuals are (model − data)/σ. [`fit`] first
//! checks what the data can determine, then lets the window of data grow from 0.1 s to all of them.

mod compare;
mod data;
mod error;
mod estimate;
mod extension;
mod identify;
mod model;
mod modes;
mod offset;
mod parameter;
mod profile;
mod recorded;
pub mod report;
mod signal;
mod solve;
mod statistics;
mod table;
mod unit;

pub use data::{Data, read};
pub use error::{DataError, FitError, SignalError};
pub use model::{Loss, Problem};
pub use parameter::{Parameter, Target};
pub use report::{Report, Verdict};
pub use signal::{Signal, SignalSpec};
pub use solve::Progress;

use crate::run::scenario::Scenario;
use estimate::{correlations, estimates, quality, signals, verdict};
use model::{Effort, Point};
use solve::{Solution, Watch};

/// What to fit, and how.
#[derive(Clone, Debug)]
pub struct Request {
    /// The scenario; free keys start at its values.
    pub scenario: Scenario,
    /// The measured signals.
    pub data: Data,
    /// Names of the free parameters: keys, or `initial` for all of the start that the signals show.
    pub free: Vec<String>,
    /// Bounds of parameters.
    pub bounds: Vec<(String, [f64; 2])>,
    /// How residuals count.
    pub loss: Loss,
    /// Time in the data at which the scenario starts, s. By default that of the first sample, and 0 for recordings of
    /// toprise.
    pub origin: Option<f64>,
    /// Use only the data until this time after the start, s.
    pub until: Option<f64>,
    /// Part of the time at the end that is not fitted, but predicted.
    pub holdout: f64,
    /// Laws to compare.
    pub compare: Vec<String>,
    /// Parameters whose profile likelihoods are wanted.
    pub profile: Vec<String>,
    /// Whether to multiply variances by χ²/ν.
    pub rescale: bool,
}

impl Request {
    /// A request with the default options.
    pub fn new(scenario: Scenario, data: Data, free: &[&str]) -> Self {
        Self {
            scenario,
            data,
            free: free.iter().map(|name| (*name).to_owned()).collect(),
            bounds: Vec::new(),
            loss: Loss::default(),
            origin: None,
            until: None,
            holdout: 0.0,
            compare: Vec::new(),
            profile: Vec::new(),
            rescale: false,
        }
    }
}

/// A fitted model.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The report.
    pub report: Report,
    /// The best fit, with the preferred law of a comparison, or the scenario's: it runs to the end of the data.
    pub scenario: Scenario,
    /// The measured values and their residuals, in time order.
    pub residuals: Vec<Residual>,
}

/// A measured value and its residual.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residual {
    /// Index of its signal in the report.
    pub signal: usize,
    /// Time on the clock of the model, s.
    pub time: f64,
    /// Measured value, SI units.
    pub value: f64,
    /// Standard deviation.
    pub sigma: f64,
    /// (Model − data)/σ.
    pub residual: f64,
    /// Whether the value was held out.
    pub is_held_out: bool,
}

/// Maximum number of times that standard deviations are estimated from the residuals.
const MAX_SIGMA_ROUNDS: usize = 6;
/// Relative change of a standard deviation that counts as none.
const SIGMA_CHANGE: f64 = 1e-3;

/// Points to fit and points to predict.
#[derive(Clone, Debug)]
struct Split {
    fitted: Vec<Point>,
    held_out: Vec<Point>,
    /// End of the fitted part, s.
    end: f64,
}

/// Fits a scenario to data.
///
/// # Errors
/// [`FitError`]; parameters that can't be told apart are an error, found before anything is fitted.
pub fn fit(request: &Request, progress: &dyn Fn(Progress)) -> Result<Fit, FitError> {
    let watch = Watch::new(progress);
    let (mut problem, notes, origin) = prepare(request)?;
    let (solution, split) = solve_all(&mut problem, request, &watch)?;
    if !solution.is_converged
        && let Some(refusal) = solve::refused_step(&problem, &split.fitted, &solution)
    {
        return Err(solve::error_from(refusal));
    }
    let modes = modes::modes(&problem, &split.fitted, &solution, &watch)?;
    let (mut solution, mut modes) = (modes.best, modes.others);
    let mut comparison = None;
    if !request.compare.is_empty() {
        let fitted = compare::Fitted {
            problem: &problem,
            solution: &solution,
            split: &split,
        };
        let compared = compare::compare(request, &fitted, &watch)?;
        comparison = Some(compared.comparison);
        // From here on everything is about the preferred law.
        if let Some((preferred, others)) = compared.preferred {
            problem = preferred.problem;
            solution = preferred.solution;
            modes = others;
        }
    }
    let mut profiles = Vec::new();
    for name in &request.profile {
        let profile = profile::profile(&problem, &split.fitted, &solution, name, &watch)?;
        profiles.push(profile);
    }
    let quality = quality(&problem, &split.fitted, &solution);
    let rescale = if request.rescale {
        quality.chi2 / quality.freedom as f64
    } else {
        1.0
    };
    let held_out = problem
        .residuals(Effort::Final, &solution.values, &split.held_out)
        .ok();
    let signals = signals(
        &problem,
        (&split.fitted, &solution.residuals),
        held_out.as_deref().map(|r| (&split.held_out[..], r)),
    );
    let verdict = match &comparison {
        Some(comparison) => comparison.verdict(),
        None => verdict(&quality, &signals),
    };
    let mut parameters = estimates(&problem, &solution, rescale);
    for (at, estimate) in parameters.iter_mut().enumerate() {
        if solution.held[at] {
            let limit = profile::limit(&problem, &split.fitted, &solution, at, &watch)?;
            estimate.limit = Some(limit);
        }
    }
    let report = Report {
        verdict,
        scenario: request.scenario.name().to_owned(),
        law: problem.scenario.word("friction.law").to_owned(),
        origin,
        loss: request.loss,
        until: split.end,
        signals,
        losses: request.data.losses.clone(),
        notes,
        parameters,
        correlations: correlations(&problem, &solution),
        quality,
        modes,
        profiles,
        comparison,
        evaluations: watch.evaluations(),
    };
    Ok(Fit {
        report,
        scenario: problem.scenario_for(&solution.values, split.end)?,
        residuals: residuals(&problem, &solution, &split, held_out.as_deref()),
    })
}

/// The derivatives of the residuals at the start: a column for each free parameter, by name, with a row for each value
/// of each signal. This is the Fisher information's square root: the standard deviations that a measurement would have
/// follow from it.
///
/// # Errors
/// As [`fit`], but parameters need not be identifiable.
pub fn sensitivities(request: &Request) -> Result<Vec<(String, Vec<f64>)>, FitError> {
    let Request { scenario, data, .. } = request;
    let named = parameter::parameters(&request.free, &request.bounds, scenario, data.files)?;
    let parameters = named.into_iter().map(|named| named.parameter).collect();
    let origin = request.origin.unwrap_or_else(|| data.origin());
    let signals = data.signals.clone();
    let problem = Problem::new(scenario, parameters, signals, request.loss, origin)?;
    let start = problem.start();
    let points = &problem.points;
    problem.predict(&start, points).map_err(solve::error_from)?;
    let fixed = vec![false; start.len()];
    let columns = problem.jacobian(Effort::Final, &start, points, &fixed);
    let names = problem.parameters.iter().map(Parameter::name);
    Ok(names.zip(columns).collect())
}

/// The problem of a request after the check of what its data can determine; notes; and the origin, s.
fn prepare(request: &Request) -> Result<(Problem, Vec<String>, f64), FitError> {
    let scenario = &request.scenario;
    let data = &request.data;
    let names = &request.free;
    let named = parameter::parameters(names, &request.bounds, scenario, data.files)?;
    let parameters = named.iter().map(|named| named.parameter.clone());
    let origin = request.origin.unwrap_or_else(|| data.origin());
    let mut signals = data.signals.clone();
    for signal in &mut signals {
        for (field, start) in [
            (crate::telemetry::fields::state::PHI, scenario.angles.phi),
            (crate::telemetry::fields::state::PSI, scenario.angles.psi),
        ] {
            if signal.field == field {
                signal.turn_towards(start);
            }
        }
    }
    check_values(&signals)?;
    let parameters = parameters.collect();
    let mut problem = Problem::new(scenario, parameters, signals, request.loss, origin)?;
    problem.keep_until(request.until);
    check_range(&problem, origin, request.until)?;
    if named.is_empty() {
        return Err(FitError::NothingFree);
    }
    let identified = identify::identify(&problem, &named)?;
    problem.parameters = identified.parameters;
    if problem.points.len() <= problem.parameters.len() {
        return Err(FitError::TooFew {
            samples: problem.points.len(),
            parameters: problem.parameters.len(),
        });
    }
    Ok((problem, identified.notes, origin))
}

/// Refuses values that the sums of squares can't hold.
fn check_values(signals: &[Signal]) -> Result<(), FitError> {
    /// Well below the residual of a refused motion, and its square is finite.
    const MAX_SIZE: f64 = 1e25;
    for signal in signals {
        for (at, value) in signal.values.iter().enumerate() {
            let size = value.abs().max((value / signal.sigmas[at]).abs());
            if size.is_nan() || size > MAX_SIZE {
                return Err(FitError::Size {
                    field: signal.field.to_string(),
                    time: signal.times[at],
                    value: *value,
                    sigma: signal.sigmas[at],
                });
            }
        }
    }
    Ok(())
}

/// Refuses signals of the first file without a value in the time that is fitted.
fn check_range(problem: &Problem, origin: f64, until: Option<f64>) -> Result<(), FitError> {
    for (index, signal) in problem.signals.iter().enumerate() {
        let mut points = problem.points.iter();
        if signal.file == 0 && !points.any(|point| point.signal == index) {
            return Err(FitError::OutOfRange {
                field: signal.field.to_string(),
                first: signal.times.first().copied().unwrap_or(f64::NAN),
                last: signal.times.last().copied().unwrap_or(f64::NAN),
                origin,
                until: until.map(|until| origin + until),
            });
        }
    }
    Ok(())
}

/// Fits all signals; estimates standard deviations that are not given.
fn solve_all(
    problem: &mut Problem,
    request: &Request,
    watch: &Watch<'_>,
) -> Result<(Solution, Split), FitError> {
    let mut split = split_first_file(problem, request.holdout);
    let has_offsets = request.data.files > 1;
    let start = problem.start();
    let mut solution = solve::grow(problem, &split.fitted, &start, has_offsets, watch)?;
    if has_offsets {
        let end = split.end;
        let (joint, points) = offset::fit_offsets(problem, solution.values, end, watch)?;
        solution = joint;
        split.fitted = points;
    }
    let fixed = vec![false; start.len()];
    for _ in 0..MAX_SIGMA_ROUNDS {
        if !estimate_sigmas(problem, &mut split, &solution) {
            break;
        }
        let values = solution.values.clone();
        solution = solve::minimise(problem, &split.fitted, &values, None, &fixed, watch)?;
    }
    Ok((solution, split))
}

/// The points of the first file, whose clock is the model's.
fn split_first_file(problem: &Problem, holdout: f64) -> Split {
    let mut first: Vec<Point> = Vec::new();
    for point in &problem.points {
        if problem.signals[point.signal].file == 0 {
            first.push(*point);
        }
    }
    let last = first.iter().map(|point| point.time).fold(0.0, f64::max);
    let end = last * (1.0 - holdout);
    let (fitted, held_out) = first.into_iter().partition(|point| point.time <= end);
    Split {
        fitted,
        held_out,
        end,
    }
}

/// Sets the standard deviations that were not given to those of the residuals. Returns whether one has changed.
fn estimate_sigmas(problem: &mut Problem, split: &mut Split, solution: &Solution) -> bool {
    let mut has_changed = false;
    let all = split.fitted.len() as f64;
    let lost = problem.parameters.len() as f64 / all;
    for index in 0..problem.signals.len() {
        if !problem.signals[index].is_sigma_estimated {
            continue;
        }
        let (mut sum, mut count, mut before) = (0.0, 0.0, 1.0);
        for (point, residual) in split.fitted.iter().zip(&solution.residuals) {
            if point.signal == index {
                sum += residual * residual * point.sigma * point.sigma;
                count += 1.0;
                before = point.sigma;
            }
        }
        // Each signal loses its share of the degrees of freedom.
        let freedom: f64 = count * (1.0 - lost);
        let estimate = (sum / freedom.max(1.0)).sqrt();
        let sigma = estimate.max(problem.signals[index].rounding());
        has_changed |= (sigma / before - 1.0).abs() > SIGMA_CHANGE;
        problem.set_sigma(index, sigma);
        let points = split.fitted.iter_mut().chain(&mut split.held_out);
        for point in points.filter(|point| point.signal == index) {
            point.sigma = sigma;
        }
    }
    has_changed
}

/// All measured values with their residuals, in time order.
fn residuals(
    problem: &Problem,
    solution: &Solution,
    split: &Split,
    held_out: Option<&[f64]>,
) -> Vec<Residual> {
    let mut all = Vec::new();
    for (points, residuals, is_held_out) in [
        (&split.fitted, &solution.residuals[..], false),
        (&split.held_out, held_out.unwrap_or_default(), true),
    ] {
        for (point, residual) in points.iter().zip(residuals) {
            all.push(Residual {
                signal: point.signal,
                time: problem.model_time(&solution.values, point),
                value: point.value,
                sigma: point.sigma,
                residual: *residual,
                is_held_out,
            });
        }
    }
    all.sort_by(|a, b| a.time.total_cmp(&b.time).then(a.signal.cmp(&b.signal)));
    all
}
