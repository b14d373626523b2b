//! Standard deviations that are estimated from the residuals.

use super::error::FitError;
use super::fitted::Split;
use super::model::Problem;
use super::monitor::Monitor;
use super::solve::{Solution, minimise};

/// Maximum number of times that standard deviations are estimated.
const MAX_ROUNDS: usize = 6;

/// Relative change of a standard deviation that counts as none.
const SMALL_CHANGE: f64 = 1e-3;

/// Estimates the standard deviations that were not given from the residuals of a minimum, and minimises again until they
/// no longer change.
pub(super) fn settle(
    problem: &mut Problem,
    split: &mut Split,
    mut solution: Solution,
    monitor: &Monitor<'_>,
) -> Result<Solution, FitError> {
    let fixed = vec![false; solution.values.len()];
    for _ in 0..MAX_ROUNDS {
        if !estimate(problem, split, &solution) {
            break;
        }
        solution = minimise(
            problem,
            &split.fitted,
            &solution.values,
            None,
            &fixed,
            monitor,
        )?;
    }
    Ok(solution)
}

/// Sets the standard deviations that were not given to those of the residuals. Returns whether one has changed.
fn estimate(problem: &mut Problem, split: &mut Split, solution: &Solution) -> bool {
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
        // Noise-free data would have σ = 0.
        let sigma = estimate.max(problem.signals[index].rounding());
        has_changed |= (sigma / before - 1.0).abs() > SMALL_CHANGE;
        problem.set_sigma(index, sigma);
        let points = split.fitted.iter_mut().chain(&mut split.held_out);
        for point in points.filter(|point| point.signal == index) {
            point.sigma = sigma;
        }
    }
    has_changed
}
