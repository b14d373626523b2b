//! Least squares within bounds.

use super::error::FitError;
use super::model::{Effort, Loss, Point, Problem, Refusal};
use super::objective::Objective;
use super::parameter::Target;
use super::statistics::ScaledGram;
use nalgebra::DMatrix;
use std::cell::Cell;

/// Maximum number of changes of the set of parameters at bounds.
const MAX_ROUNDS: usize = 8;

/// A minimum has been found if a further step would change χ² by less than this, in units of χ²/ν or of 1: parameters
/// are then right to a tenth of their standard deviation, or better.
const CONVERGED: f64 = 1e-2;

/// Along a direction whose eigenvalue in the scaled JᵀJ is below this, the gradient is noise of the derivatives.
const NULL: f64 = 1e-11;

/// The first window, s; each further one is twice as long.
const FIRST_WINDOW: f64 = 0.1;

/// Relative change of χ² at which a window that isn't the last ends.
const WINDOW_PRECISION: f64 = 1e-4;

/// Relative change of χ² at which drafts of motions are replaced by exact ones.
const DRAFT_PRECISION: f64 = 1e-6;

/// Number of points that all windows but the last are thinned to.
const WINDOW_POINTS: usize = 20_000;

/// Progress of a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// End of the window, s.
    pub window: f64,
    /// χ² in it, with priors.
    pub chi2: f64,
    /// Number of simulations so far.
    pub evaluations: u64,
}

/// Counts simulations and reports progress.
pub(super) struct Watch<'a> {
    report: &'a dyn Fn(Progress),
    evaluations: Cell<u64>,
    window: Cell<f64>,
}

impl<'a> Watch<'a> {
    pub(super) fn new(report: &'a dyn Fn(Progress)) -> Self {
        Self {
            report,
            evaluations: Cell::new(0),
            window: Cell::new(0.0),
        }
    }

    pub(super) fn evaluations(&self) -> u64 {
        self.evaluations.get()
    }

    /// Adds simulations that were counted elsewhere.
    pub(super) fn add(&self, evaluations: u64) {
        self.evaluations.set(self.evaluations.get() + evaluations);
    }

    pub(super) fn count(&self, simulations: usize, chi2: f64) {
        self.evaluations
            .set(self.evaluations.get() + simulations as u64);
        (self.report)(Progress {
            window: self.window.get(),
            chi2,
            evaluations: self.evaluations.get(),
        });
    }
}

/// A minimum.
#[derive(Clone, Debug)]
pub(super) struct Solution {
    /// Values of the parameters.
    pub values: Vec<f64>,
    /// Loss: the sum of the squared residuals, or Huber's.
    pub chi2: f64,
    /// Residuals in σ, in the order of the points.
    pub residuals: Vec<f64>,
    /// Parameters that a bound holds.
    pub held: Vec<bool>,
    /// Half the gradient of χ², for all parameters.
    pub gradient: Vec<f64>,
    /// Curvature: JᵀJ of all parameters, those at bounds included.
    pub gram: DMatrix<f64>,
    /// Covariance of the parameters that are free and not held; zero elsewhere.
    pub covariance: DMatrix<f64>,
    /// Whether it is a minimum, and not where the optimiser gave up.
    pub is_converged: bool,
}

/// Goes from `start`, whose motion must be complete, towards the minimum with weak priors around `centre`: as far as
/// the next, longer window needs.
fn approach(
    problem: &Problem,
    points: &[Point],
    start: &[f64],
    centre: &[f64],
    watch: &Watch<'_>,
) -> Result<Vec<f64>, FitError> {
    // A model without free parameters is evaluated, not fitted.
    if start.is_empty() {
        return Ok(Vec::new());
    }
    let held = vec![false; start.len()];
    let mut objective = Objective::new(problem, points, Some(centre), held, watch);
    objective.run_drafts(start, WINDOW_PRECISION)
}

/// Finds the minimum from `start`, whose motion must be complete. `fixed` parameters keep their values.
pub(super) fn minimise(
    problem: &Problem,
    points: &[Point],
    start: &[f64],
    priors: Option<&[f64]>,
    fixed: &[bool],
    watch: &Watch<'_>,
) -> Result<Solution, FitError> {
    let mut values = start.to_vec();
    let mut held = vec![false; values.len()];
    // The optimiser shortens a step that would leave the bounds, and may stall there. So parameters that a bound holds
    // are taken out, and returned when the gradient leads inwards.
    for _ in 0..MAX_ROUNDS {
        let out: Vec<bool> = fixed.iter().zip(&held).map(|(a, b)| *a || *b).collect();
        if out.iter().any(|out| !out) {
            values = descend(problem, points, &values, priors, out, watch)?;
        }
        let solution = evaluate(problem, points, values.clone(), priors, fixed, watch)?;
        if solution.held == held {
            return Ok(solution);
        }
        held = solution.held;
    }
    evaluate(problem, points, values, priors, fixed, watch)
}

/// Descends to a minimum with drafts of motions, then with exact ones.
fn descend(
    problem: &Problem,
    points: &[Point],
    start: &[f64],
    priors: Option<&[f64]>,
    out: Vec<bool>,
    watch: &Watch<'_>,
) -> Result<Vec<f64>, FitError> {
    let mut objective = Objective::new(problem, points, priors, out, watch);
    let precision = problem.precision;
    let mut values = objective.run_drafts(start, precision.max(DRAFT_PRECISION))?;
    // The exact motion may end before the data where its draft just reaches them.
    if problem.predict(&values, points).is_err() {
        values = start.to_vec();
    }
    objective.run_finally(&values, precision)
}

/// The state of a fit at these values: residuals, gradient, curvature and covariance.
pub(super) fn evaluate(
    problem: &Problem,
    points: &[Point],
    values: Vec<f64>,
    priors: Option<&[f64]>,
    fixed: &[bool],
    watch: &Watch<'_>,
) -> Result<Solution, FitError> {
    let residuals = problem
        .residuals(Effort::Final, &values, points)
        .map_err(error_from)?;
    let jacobian = problem.jacobian(Effort::Final, &values, points, fixed);
    watch.count(1 + 2 * jacobian.len(), f64::NAN);
    let size = values.len();
    let loss = problem.loss;
    let mut chi2 = 0.0;
    let mut gradient = vec![0.0; size];
    let mut gram = DMatrix::zeros(size, size);
    // For Huber's loss: curvature counts inliers only, and the spread of the gradient is that of the clipped residuals.
    let mut spread = DMatrix::zeros(size, size);
    for (at, residual) in residuals.iter().enumerate() {
        let deviate = loss.transformed(*residual);
        let pull = deviate * loss.slope(*residual);
        chi2 += deviate * deviate;
        let is_inlier = pull == *residual;
        for i in 0..size {
            gradient[i] += pull * jacobian[i][at];
            for j in 0..=i {
                let product = jacobian[i][at] * jacobian[j][at];
                gram[(i, j)] += if is_inlier { product } else { 0.0 };
                spread[(i, j)] += pull * pull * product;
            }
        }
    }
    if let Some(centre) = priors {
        for j in 0..size {
            let prior = problem.parameters[j].prior;
            let deviate = (values[j] - centre[j]) / prior;
            chi2 += deviate * deviate;
            gradient[j] += deviate / prior;
            gram[(j, j)] += 1.0 / (prior * prior);
        }
    }
    gram.fill_upper_triangle_with_lower_triangle();
    spread.fill_upper_triangle_with_lower_triangle();
    let mut held = vec![false; size];
    for j in 0..size {
        let [low, high] = problem.parameters[j].bounds;
        let is_low = values[j] <= low && gradient[j] > 0.0;
        let is_high = values[j] >= high && gradient[j] < 0.0;
        held[j] = !fixed[j] && (is_low || is_high);
    }
    let mut free = gram.clone();
    for j in (0..size).filter(|j| held[*j] || fixed[*j]) {
        free.row_mut(j).fill(0.0);
        free.column_mut(j).fill(0.0);
    }
    // Scaled, because k and ψ̇₀ differ by four orders of magnitude, and their squares by eight.
    let scaled = ScaledGram::new(&free);
    let inverse = scaled.inverse();
    let covariance = match loss {
        Loss::Squares => inverse,
        Loss::Huber => &inverse * spread * &inverse,
    };
    let slope = nalgebra::DVector::from_column_slice(&gradient);
    let remaining = slope.dot(&(scaled.pseudo_inverse(NULL) * &slope));
    let freedom = points.len().saturating_sub(size).max(1) as f64;
    let is_converged = remaining <= CONVERGED * (chi2 / freedom).max(1.0);
    Ok(Solution {
        values,
        chi2,
        residuals,
        held,
        gradient,
        gram,
        covariance,
        is_converged,
    })
}

/// Why the optimiser could not go on from where it gave up: the refusal of the next step, shortened until it is small.
pub(super) fn refused_step(
    problem: &Problem,
    points: &[Point],
    solution: &Solution,
) -> Option<Refusal> {
    /// Lengths of the step.
    const PARTS: [f64; 4] = [1.0, 0.1, 0.01, 0.001];
    let slope = nalgebra::DVector::from_column_slice(&solution.gradient);
    let mut free = solution.gram.clone();
    for j in (0..solution.held.len()).filter(|j| solution.held[*j]) {
        free.row_mut(j).fill(0.0);
        free.column_mut(j).fill(0.0);
    }
    let step = ScaledGram::new(&free).pseudo_inverse(NULL) * slope;
    let mut refusal = None;
    for part in PARTS {
        let mut values = solution.values.clone();
        for (j, value) in values.iter_mut().enumerate() {
            *value = problem.parameters[j].clamp(*value - part * step[j]);
        }
        // A step that is possible shows that something else stopped the optimiser.
        refusal = Some(problem.predict(&values, points).err()?);
    }
    refusal
}

/// The error of a motion that is not complete.
pub(super) fn error_from(refusal: Refusal) -> FitError {
    match refusal {
        Refusal::Invalid(error) => FitError::Scenario(error),
        Refusal::Failed(error) => FitError::Simulation(error),
        Refusal::Ends {
            time,
            reason,
            needed,
        } => FitError::ModelEnds {
            end: time,
            reason: reason.sentence().to_owned(),
            needed,
        },
    }
}

/// Lets the window grow from the first tenth of a second to all `points`. Weak priors hold what a short window doesn't
/// show; the last window has none unless `keeps_priors`.
pub(super) fn grow(
    problem: &Problem,
    points: &[Point],
    start: &[f64],
    keeps_priors: bool,
    watch: &Watch<'_>,
) -> Result<Solution, FitError> {
    let mut values = start.to_vec();
    let fixed = vec![false; values.len()];
    let times = points.iter().map(|p| problem.model_time(start, p));
    let end = times.fold(0.0, f64::max);
    let mut window = FIRST_WINDOW;
    // A short window has one minimum; each solution is close enough to that of a window twice as long.
    while window < end {
        let mut within: Vec<Point> = Vec::new();
        for point in points {
            if problem.model_time(start, point) <= window {
                within.push(*point);
            }
        }
        let stride = within.len().div_ceil(WINDOW_POINTS).max(1);
        let thinned: Vec<Point> = within.into_iter().step_by(stride).collect();
        if !thinned.is_empty() {
            watch.window.set(window);
            values = complete(problem, &thinned, values)?;
            values = approach(problem, &thinned, &values, start, watch)?;
        }
        window *= 2.0;
    }
    watch.window.set(end);
    values = complete(problem, points, values)?;
    let priors = keeps_priors.then_some(start);
    minimise(problem, points, &values, priors, &fixed, watch)
}

/// Values whose motion is complete: the friction is halved while the model rises before the data end.
pub(super) fn complete(
    problem: &Problem,
    points: &[Point],
    mut values: Vec<f64>,
) -> Result<Vec<f64>, FitError> {
    /// Maximum number of times that friction is halved.
    const MAX_HALVINGS: u32 = 12;
    // The less friction, the later the top rises.
    for _ in 0..MAX_HALVINGS {
        let Err(refusal) = problem.predict(&values, points) else {
            return Ok(values);
        };
        let frictions = problem.parameters.iter().map(|p| match p.target {
            Target::Key(key) => ["friction.k", "friction.static_k"].contains(&key.path),
            Target::Offset(_) => false,
        });
        let mut can_halve = false;
        for (at, is_friction) in frictions.enumerate() {
            if is_friction && values[at] > problem.parameters[at].bounds[0] {
                values[at] = problem.parameters[at].clamp(0.5 * values[at]);
                can_halve = true;
            }
        }
        if !can_halve {
            return Err(error_from(refusal));
        }
    }
    problem
        .predict(&values, points)
        .map_err(error_from)
        .map(|_| values)
}
