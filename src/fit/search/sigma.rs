//! Standard deviations that are estimated from the residuals.

use super::fitted::Split;
use super::monitor::Monitor;
use super::solve::{Solution, minimise};
use crate::fit::error::FitError;
use crate::fit::problem::model::{Loss, Problem};

/// Maximum number of times that standard deviations are estimated.
const MAX_ROUNDS: usize = 6;

/// Relative change of a standard deviation that counts as none.
const SMALL_CHANGE: f64 = 1e-3;

/// Estimates the standard deviations that were not given from the residuals of a minimum, and minimises again until they
/// no longer change.
pub(in crate::fit) fn settle(
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
        let was_converged = solution.is_converged;
        solution = minimise(
            problem,
            &split.fitted,
            &solution.values,
            None,
            &fixed,
            monitor,
        )?;
        // Residuals of what is no minimum say little about the noise.
        if !was_converged && !solution.is_converged {
            break;
        }
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
        let (mut deviations, mut before) = (Vec::new(), 1.0);
        for (point, residual) in split.fitted.iter().zip(&solution.residuals) {
            if point.signal == index {
                deviations.push(residual * point.sigma);
                before = point.sigma;
            }
        }
        // Each signal loses its share of the degrees of freedom.
        let freedom: f64 = deviations.len() as f64 * (1.0 - lost);
        let estimate = scale(problem.loss, &deviations, freedom.max(1.0), before);
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

/// Maximum number of steps towards a scale; each multiplies the error by about 0.4.
const MAX_STEPS: usize = 60;

/// Relative change of a scale that counts as none.
const SCALE_PRECISION: f64 = 1e-9;

/// The scale at which the clipped deviations have their expected variance (Huber's proposal 2), near a first guess; for
/// squared residuals, their standard deviation. Outliers, which a robust loss clips, would be most of a plain one.
fn scale(loss: Loss, deviations: &[f64], freedom: f64, guess: f64) -> f64 {
    let mut scale = guess;
    for _ in 0..MAX_STEPS {
        let mut sum = 0.0;
        for deviation in deviations {
            let clipped = loss.clipped(deviation / scale);
            sum += clipped * clipped;
        }
        let ratio = (sum / (freedom * loss.clipped_variance())).sqrt();
        scale *= ratio;
        let has_settled = (ratio - 1.0).abs() < SCALE_PRECISION;
        if has_settled || scale <= 0.0 || !scale.is_finite() {
            break;
        }
    }
    scale
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quantiles of the normal distribution with this standard deviation, by bisection of its distribution.
    fn normal(count: u32, sd: f64) -> Vec<f64> {
        let mut quantiles = Vec::new();
        for i in 0..count {
            let part = (f64::from(i) + 0.5) / f64::from(count);
            let (mut low, mut high) = (-9.0, 9.0);
            for _ in 0..60 {
                let middle = f64::midpoint(low, high);
                if 0.5 * libm::erfc(-middle / std::f64::consts::SQRT_2) < part {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            quantiles.push(sd * low);
        }
        quantiles
    }

    #[test]
    fn scales_of_normal_deviations_are_their_standard_deviation() {
        let deviations = normal(20_000, 0.002);
        for loss in [Loss::Squares, Loss::Huber] {
            for guess in [1e-5, 0.002, 1.0] {
                let found = scale(loss, &deviations, 20_000.0, guess);
                // The quantiles leave out the outer half of the last interval.
                assert!(
                    (found / 0.002 - 1.0).abs() < 1e-3,
                    "{loss:?} {guess} {found}"
                );
            }
        }
    }

    #[test]
    fn outliers_do_not_make_a_robust_scale() {
        let mut deviations = normal(960, 1.0);
        deviations.extend([200.0; 40]);
        assert!(scale(Loss::Squares, &deviations, 1000.0, 1.0) > 39.0);
        // Each counts as 1.345² at most: 0.96 v + 0.04 1.345² = 0.7102 at v = 0.664, that is, σ = 1.06.
        let robust = scale(Loss::Huber, &deviations, 1000.0, 40.0);
        assert!((robust - 1.06).abs() < 0.02, "{robust}");
    }
}
