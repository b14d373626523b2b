//! Friction from measured motions: estimates parameters of a scenario and compares friction laws.
//!
//! The model is the simulation itself, sampled at the times of the data. Residuals are (model − data)/σ. [`fit`] first
//! checks what the data can determine, then lets the window of data grow from 0.1 s to all of them.

mod apart;
mod compare;
mod conclusion;
mod error;
mod estimate;
mod failure;
mod note;
mod problem;
mod profile;
mod record;
pub mod report;
mod search;
mod statistics;
pub mod words;

pub use apart::Apart;
pub use conclusion::{Conclusion, Flaw, Rival};
pub use error::FitError;
pub use failure::Failure;
pub use note::{KeptParameter, Note};
pub use problem::law::usual_parameters;
pub use problem::model::{Loss, Problem};
pub use problem::parameter::{Parameter, Target};
pub use problem::request::Request;
pub use record::{RecordError, record};
pub use report::{Report, Verdict};
pub use search::monitor::Progress;

pub use crate::measured::{
    ColumnReading, Data, DataError, Decimal, Delimiter, FileReading, Layout, Lines, Place, Signal,
    SignalSpec, SkipReason, SkippedRows, read, read_bytes,
};

use crate::run::scenario::Scenario;
use crate::telemetry::fields::NumberField;
use estimate::{PointResiduals, correlations, estimates, signals, verdict};
use nalgebra::DMatrix;
use problem::model::Effort;
use problem::{identify, parameter};
use search::first::{self, First};
use search::fitted::{Fitted, Split};
use search::monitor::Monitor;
use search::solve::{Solution, covariance_with_kept};

/// A fitted model.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The report.
    pub report: Report,
    /// The best fit, with the preferred law of a comparison, or the scenario's: it runs to the end of the data.
    pub scenario: Scenario,
    /// The measured values and their residuals, in time order.
    pub residuals: Vec<Residual>,
    /// The fields of the signals.
    pub fields: Vec<NumberField>,
    /// Covariance of the parameters, not rescaled.
    covariance: DMatrix<f64>,
}

impl Fit {
    /// The correlation of two estimates, by their indices in the report; `None` if one of them has no standard deviation.
    pub fn correlation(&self, a: usize, b: usize) -> Option<f64> {
        let scale = (self.covariance[(a, a)] * self.covariance[(b, b)]).sqrt();
        (scale > 0.0).then(|| self.covariance[(a, b)] / scale)
    }
}

/// A measured value and its residual.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residual {
    /// Index of the signal in the report.
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

/// Fits a scenario to data.
///
/// # Errors
/// [`FitError`]; parameters that can't be told apart are an error, found before anything is fitted.
pub fn fit(request: &Request, progress: &dyn Fn(Progress)) -> Result<Fit, FitError> {
    let monitor = Monitor::new(progress);
    let First {
        mut fitted,
        mut notes,
        origin,
        refused,
    } = first::first(request, &monitor)?;
    let mut comparison = None;
    if !request.compare.is_empty() {
        let compared = compare::compare(request, &fitted, refused, &monitor)?;
        comparison = Some(compared.comparison);
        // From here on everything is about the preferred law.
        fitted = compared.preferred.unwrap_or(fitted);
    }
    if !fitted.problem.kept.is_empty() && fitted.solution.is_converged {
        let Fitted {
            problem,
            solution,
            split,
            ..
        } = &mut fitted;
        solution.covariance = covariance_with_kept(problem, &split.fitted, solution);
    }
    let Fitted {
        problem,
        solution,
        split,
        modes,
    } = &fitted;
    let mut profiles = Vec::new();
    // Without a minimum there is nothing from which χ² could grow.
    for name in request.profile.iter().filter(|_| solution.is_converged) {
        let profile = profile::profile(problem, &split.fitted, solution, name, &monitor)?;
        profiles.push(profile);
    }
    let quality = fitted.quality();
    let rescale = if request.rescale {
        quality.chi2 / quality.freedom as f64
    } else {
        1.0
    };
    let held_out = problem
        .residuals(Effort::Final, &solution.values, &split.held_out)
        .ok()
        .filter(|residuals| !residuals.is_empty());
    let signals = signals(
        problem,
        PointResiduals {
            points: &split.fitted,
            residuals: &solution.residuals,
        },
        held_out.as_deref().map(|residuals| PointResiduals {
            points: &split.held_out,
            residuals,
        }),
    );
    let verdict = match &comparison {
        Some(comparison) => comparison.verdict(),
        None => verdict(&quality, &signals),
    };
    let mut parameters = estimates(problem, solution, modes, rescale);
    for (at, estimate) in parameters.iter_mut().enumerate() {
        if solution.held[at] && solution.is_converged {
            let limit = profile::limit(problem, &split.fitted, solution, at, &monitor)?;
            estimate.limit = Some(limit);
        }
    }
    // The motion covers the held-out part, too, if it goes on so long.
    let end = if held_out.is_some() {
        split.last
    } else {
        split.end
    };
    let scenario = problem.scenario_for(&solution.values, end)?;
    if solution.is_converged {
        notes.extend(identify::aliasing(&problem.signals, &scenario));
    }
    let report = Report {
        verdict,
        scenario: request.scenario.name().to_owned(),
        law: fitted.law().to_owned(),
        origin,
        loss: request.loss,
        until: split.end,
        signals,
        files: request.data.files.clone(),
        losses: request.data.losses.clone(),
        notes,
        parameters,
        correlations: correlations(problem, solution),
        quality,
        modes: modes.clone(),
        profiles,
        comparison,
        evaluations: monitor.evaluations(),
    };
    Ok(Fit {
        report,
        scenario,
        residuals: residuals(problem, solution, split, held_out.as_deref()),
        fields: problem.signals.iter().map(|signal| signal.field).collect(),
        covariance: solution.covariance.clone(),
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
    let selected = parameter::select(&request.free, &request.bounds, scenario, data.files.len())?;
    let parameters = selected
        .into_iter()
        .map(|selected| selected.parameter)
        .collect();
    let origin = request.origin.unwrap_or_default();
    let signals = data.signals.clone();
    let problem = Problem::new(scenario, parameters, signals, request.loss, origin)?;
    let start = problem.start();
    let points = &problem.points;
    let here = problem.predict(&start, points)?;
    let fixed = vec![false; start.len()];
    let columns = problem.jacobian(Effort::Final, &start, &here, points, &fixed);
    let names = problem.parameters.iter().map(Parameter::name);
    Ok(names.zip(columns).collect())
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
