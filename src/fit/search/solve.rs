//! Least squares within bounds.

use super::monitor::Monitor;
use super::objective::Objective;
use crate::fit::error::FitError;
use crate::fit::problem::meeting::check_likeness;
use crate::fit::problem::model::{Effort, Loss, Point, Problem, Refusal};
use crate::fit::problem::parameter::Target;
use crate::fit::statistics::{NULL_EIGENVALUE, ScaledGram};
use nalgebra::{DMatrix, DVector};

/// Maximum number of changes of the set of parameters at bounds.
const MAX_ROUNDS: usize = 8;

/// Number of simulations after which no further round begins: most minima take a few hundred.
const MAX_SIMULATIONS: u64 = 1000;

/// A minimum has been found if a further step would change χ² by less than this, in units of χ²/ν or of 1: parameters
/// are then right to a tenth of their standard deviation, or better.
const CONVERGED: f64 = 1e-2;

/// The first window, s; each further one is twice as long.
const FIRST_WINDOW: f64 = 0.1;

/// The first window after which motion and data must be alike, s: it has several nutations, and a part of the precession.
const LIKENESS_WINDOW: f64 = 1.6;

/// Relative change of χ² at which a window that isn't the last ends.
const WINDOW_PRECISION: f64 = 1e-4;

/// Relative change of χ² at which drafts of motions are replaced by exact ones.
const DRAFT_PRECISION: f64 = 1e-6;

/// Number of points that dense data are thinned to on the way to a minimum.
const DENSE_POINTS: usize = 20_000;

/// A minimum.
#[derive(Clone, Debug)]
pub(in crate::fit) struct Solution {
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
fn approach_minimum(
    problem: &Problem,
    points: &[Point],
    start: &[f64],
    centre: &[f64],
    monitor: &Monitor<'_>,
) -> Result<Vec<f64>, FitError> {
    // A model without free parameters is evaluated, not fitted.
    if start.is_empty() {
        return Ok(Vec::new());
    }
    let held = vec![false; start.len()];
    let mut objective = Objective::new(problem, points, Some(centre), held, monitor);
    objective.run_drafts(start, WINDOW_PRECISION)
}

/// Goes from `start`, whose motion must be complete, towards the minimum, in so many iterations or fewer. `fixed`
/// parameters keep their values.
pub(in crate::fit) fn draft(
    problem: &Problem,
    points: &[Point],
    start: &[f64],
    fixed: Vec<bool>,
    iterations: usize,
    monitor: &Monitor<'_>,
) -> Result<Vec<f64>, FitError> {
    if fixed.iter().all(|is_fixed| *is_fixed) {
        return Ok(start.to_vec());
    }
    Objective::new(problem, points, None, fixed, monitor)
        .limited_to(iterations)
        .run_drafts(start, WINDOW_PRECISION)
}

/// A minimum for drafts of motions.
pub(in crate::fit) struct Draft {
    pub values: Vec<f64>,
    pub loss: f64,
}

/// χ² of a draft above its minimum.
pub(in crate::fit) const DRAFT_ERROR: f64 = 0.5;

/// Goes from `start` to the minimum near it, if its χ² is at most `highest`. Most are given up after a few iterations:
/// those that are then more than `room` above it.
pub(in crate::fit) fn promising_draft(
    problem: &Problem,
    points: &[Point],
    start: &[f64],
    highest: f64,
    room: f64,
    monitor: &Monitor<'_>,
) -> Result<Option<Draft>, FitError> {
    const FIRST_ITERATIONS: usize = 6;
    const LAST_ITERATIONS: usize = 25;
    let mut found = Draft {
        values: start.to_vec(),
        loss: f64::INFINITY,
    };
    for (iterations, limit) in [
        (FIRST_ITERATIONS, highest + room),
        (LAST_ITERATIONS, highest),
    ] {
        let free = vec![false; start.len()];
        found.values = draft(problem, points, &found.values, free, iterations, monitor)?;
        found.loss = match problem.loss_at(Effort::Draft, &found.values, points) {
            Ok(loss) if loss <= limit => loss,
            Ok(_) | Err(_) => return Ok(None),
        };
    }
    Ok(Some(found))
}

/// Finds the minimum from `start`, whose motion must be complete. `fixed` parameters keep their values.
pub(in crate::fit) fn minimise(
    problem: &Problem,
    points: &[Point],
    start: &[f64],
    priors: Option<&[f64]>,
    fixed: &[bool],
    monitor: &Monitor<'_>,
) -> Result<Solution, FitError> {
    /// Iterations from the minimum of a part of dense data to that of all, which differs by a few standard deviations:
    /// Newton's steps double the digits.
    const DENSE_ITERATIONS: usize = 6;
    let search = Search {
        problem,
        points,
        priors,
        fixed,
        monitor,
    };
    let part = thinned(points);
    if part.len() == points.len() {
        return search.minimum(start, None);
    }
    let guide = Search {
        points: &part,
        ..search
    };
    let near = guide.minimum(start, None)?;
    // The motion may end between the last point of the part and that of all.
    let is_complete = problem.predict(&near.values, points).is_ok();
    let start = if is_complete { &near.values } else { start };
    // Data on which no motion fits would take minutes to tell.
    if !near.is_converged && is_complete {
        return search.evaluate(near.values);
    }
    search.minimum(start, Some(DENSE_ITERATIONS))
}

/// A search for the minimum of these points.
#[derive(Clone, Copy)]
struct Search<'a> {
    problem: &'a Problem,
    points: &'a [Point],
    priors: Option<&'a [f64]>,
    fixed: &'a [bool],
    monitor: &'a Monitor<'a>,
}

impl Search<'_> {
    /// The minimum within the bounds. With a number of iterations, `start` is close to it.
    fn minimum(&self, start: &[f64], iterations: Option<usize>) -> Result<Solution, FitError> {
        let mut values = start.to_vec();
        let mut held = vec![false; values.len()];
        // The optimiser shortens a step that would leave the bounds, and may stall there. So parameters that a bound
        // holds are taken out, and returned when the gradient leads inwards.
        let limit = self.monitor.evaluations() + MAX_SIMULATIONS;
        for _ in 0..MAX_ROUNDS {
            let mut is_exhausted = false;
            let excluded: Vec<bool> = self
                .fixed
                .iter()
                .zip(&held)
                .map(|(a, b)| *a || *b)
                .collect();
            if !excluded.iter().all(|is_excluded| *is_excluded) {
                let Self {
                    problem,
                    points,
                    priors,
                    monitor,
                    ..
                } = *self;
                let mut objective = Objective::new(problem, points, priors, excluded, monitor);
                values = match iterations {
                    Some(iterations) => {
                        objective = objective.limited_to(iterations);
                        objective.run_finally(&values, problem.precision)?
                    }
                    None => descend(&mut objective, problem, points, &values)?,
                };
                is_exhausted = objective.is_exhausted();
            }
            let solution = self.evaluate(values.clone())?;
            let is_over = is_exhausted || self.monitor.evaluations() > limit;
            if solution.held == held || is_over {
                return Ok(solution);
            }
            held = solution.held;
        }
        // A parameter alternates between a bound and the inside: its last state is as good as the one before.
        self.evaluate(values)
    }

    fn evaluate(&self, values: Vec<f64>) -> Result<Solution, FitError> {
        let Self {
            problem,
            points,
            priors,
            fixed,
            monitor,
        } = *self;
        evaluate(problem, points, values, priors, fixed, monitor)
    }
}

/// Descends to a minimum with drafts of motions, then with exact ones.
fn descend(
    objective: &mut Objective<'_>,
    problem: &Problem,
    points: &[Point],
    start: &[f64],
) -> Result<Vec<f64>, FitError> {
    let precision = problem.precision;
    let mut values = objective.run_drafts(start, precision.max(DRAFT_PRECISION))?;
    // The exact motion may end before the data where its draft just reaches them.
    if problem.predict(&values, points).is_err() {
        values = start.to_vec();
    }
    objective.run_finally(&values, precision)
}

/// A part of dense points, evenly.
fn thinned(points: &[Point]) -> Vec<Point> {
    let stride = points.len().div_ceil(DENSE_POINTS).max(1);
    points.iter().step_by(stride).copied().collect()
}

/// The state of a fit at these values: residuals, gradient, curvature and covariance.
pub(in crate::fit) fn evaluate(
    problem: &Problem,
    points: &[Point],
    values: Vec<f64>,
    priors: Option<&[f64]>,
    fixed: &[bool],
    monitor: &Monitor<'_>,
) -> Result<Solution, FitError> {
    let here = problem.predict(&values, points)?;
    let residuals = Problem::residuals_of(&here, points);
    let jacobian = problem.jacobian(Effort::Final, &values, &here, points, fixed);
    monitor.count(1 + 2 * jacobian.len() as u64, f64::NAN);
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
    // The change of χ² in a Newton step. Along directions without information, the gradient is noise of the derivatives.
    let slope = DVector::from_column_slice(&gradient);
    let remaining = slope.dot(&(scaled.pseudo_inverse(NULL_EIGENVALUE) * &slope));
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

/// The covariance of a solution with what is not known of the parameters that were kept: an error of such a parameter by its
/// width moves the minimum.
pub(in crate::fit) fn covariance_with_kept(
    problem: &Problem,
    points: &[Point],
    solution: &Solution,
) -> DMatrix<f64> {
    let mut covariance = solution.covariance.clone();
    let mut whole = problem.clone();
    whole.parameters.extend(problem.kept.iter().cloned());
    let mut values = solution.values.clone();
    values.extend(problem.kept.iter().map(|kept| kept.start));
    let Ok(here) = whole.predict(&values, points) else {
        return covariance;
    };
    let fixed = vec![false; values.len()];
    let jacobian = whole.jacobian(Effort::Final, &values, &here, points, &fixed);
    let own = solution.values.len();
    let mut free = solution.gram.clone();
    for j in (0..own).filter(|j| solution.held[*j]) {
        free.row_mut(j).fill(0.0);
        free.column_mut(j).fill(0.0);
    }
    let inverse = ScaledGram::new(&free).inverse();
    for (kept, column) in problem.kept.iter().zip(&jacobian[own..]) {
        let coupling = DVector::from_fn(own, |j, _| {
            let products = jacobian[j].iter().zip(column).zip(&solution.residuals);
            products
                .map(|((a, b), residual)| {
                    let slope = problem.loss.slope(*residual);
                    a * b * slope * slope
                })
                .sum()
        });
        let moved = &inverse * coupling * kept.prior;
        covariance += &moved * moved.transpose();
    }
    covariance
}

/// The end of the motion that stopped the optimiser where it gave up: that of the next step, shortened until it is small.
pub(in crate::fit) fn refused_step(
    problem: &Problem,
    points: &[Point],
    solution: &Solution,
) -> Option<FitError> {
    /// Lengths of the step.
    const PARTS: [f64; 4] = [1.0, 0.1, 0.01, 0.001];
    let slope = DVector::from_column_slice(&solution.gradient);
    let mut free = solution.gram.clone();
    for j in (0..solution.held.len()).filter(|j| solution.held[*j]) {
        free.row_mut(j).fill(0.0);
        free.column_mut(j).fill(0.0);
    }
    let step = ScaledGram::new(&free).pseudo_inverse(NULL_EIGENVALUE) * slope;
    let mut refusal = None;
    for part in PARTS {
        let mut values = solution.values.clone();
        for (j, value) in values.iter_mut().enumerate() {
            *value = problem.parameters[j].clamp(*value - part * step[j]);
        }
        // A step that is possible shows that something else stopped the optimiser.
        refusal = Some(problem.predict(&values, points).err()?);
    }
    match refusal? {
        refusal @ Refusal::Ends { .. } => Some(refusal.into()),
        Refusal::Invalid(_) | Refusal::Failed(_) | Refusal::TooManySteps => None,
    }
}

/// Lets the window grow from the first tenth of a second to all `points`. Weak priors hold what a short window doesn't
/// show; the last window has none unless `keeps_priors`.
pub(in crate::fit) fn grow_window(
    problem: &Problem,
    points: &mut [Point],
    start: &[f64],
    keeps_priors: bool,
    monitor: &Monitor<'_>,
) -> Result<Solution, FitError> {
    /// Maximum number of times that turns are chosen by the last motion.
    const MAX_ROUNDS: usize = 3;
    let mut values = start.to_vec();
    let fixed = vec![false; values.len()];
    let end = points
        .iter()
        .map(|point| problem.model_time(start, point))
        .fold(0.0, f64::max);
    let mut window = FIRST_WINDOW;
    // A short window has one minimum; each solution is close enough to that of a window twice as long.
    while window < end {
        let mut within: Vec<Point> = Vec::new();
        for point in &*points {
            if problem.model_time(start, point) <= window {
                within.push(*point);
            }
        }
        // Short windows only guide the way: a part of dense data does that as well.
        let mut part = thinned(&within);
        if !part.is_empty() {
            monitor.set_window(window, end);
            values = complete(problem, &part, values)?;
            choose_turns(problem, &values, &mut part)?;
            values = approach_minimum(problem, &part, &values, start, monitor)?;
            // Longer windows would only cost more.
            if window >= LIKENESS_WINDOW
                && let Ok(residuals) = problem.residuals(Effort::Draft, &values, &part)
            {
                check_likeness(problem, &part, &residuals)?;
            }
        }
        window *= 2.0;
    }
    monitor.set_window(end, end);
    values = complete(problem, points, values)?;
    choose_turns(problem, &values, points)?;
    let priors = keeps_priors.then_some(start);
    let mut solution = minimise(problem, points, &values, priors, &fixed, monitor)?;
    for _ in 1..MAX_ROUNDS {
        if !choose_turns(problem, &solution.values, points)? {
            break;
        }
        solution = minimise(problem, points, &solution.values, priors, &fixed, monitor)?;
    }
    Ok(solution)
}

/// Chooses turns by the motion of these values. Returns whether any has changed.
pub(in crate::fit) fn choose_turns(
    problem: &Problem,
    values: &[f64],
    points: &mut [Point],
) -> Result<bool, FitError> {
    if !problem.has_equivalences() {
        return Ok(false);
    }
    let predicted = problem.predict(values, points)?;
    Ok(problem.choose_turns(&predicted, points))
}

/// Values whose motion is complete: the friction is halved while the model rises before the data end.
pub(in crate::fit) fn complete(
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
        let mut can_halve = false;
        for (parameter, value) in problem.parameters.iter().zip(&mut values) {
            let is_friction = match parameter.target {
                Target::Key(key) => ["friction.k", "friction.static_k"].contains(&key.path),
                Target::Offset(_) => false,
            };
            if is_friction && *value > parameter.bounds[0] {
                *value = parameter.clamp(0.5 * *value);
                can_halve = true;
            }
        }
        if !can_halve {
            return Err(refusal.into());
        }
    }
    problem
        .predict(&values, points)
        .map_err(FitError::from)
        .map(|_| values)
}
