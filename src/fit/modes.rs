//! Other minima. The inclination alone shows the spin only through the phase of the nutation, so there is a minimum for
//! each number of nutations that fits in the data.

use super::error::FitError;
use super::identify::{measures_more_than_theta, spin_rate};
use super::model::{Point, Problem};
use super::monitor::Monitor;
use super::report::Mode;
use super::solve::{Solution, complete, minimise};

/// Distance of trial spin rates, in radians of phase over the data.
const PHASE_STEP: f64 = 5.0;

/// Modes within this Δχ² of the best one are kept.
const KEPT: f64 = 6.0;

/// The scan ends after this many trials in a row that are worse than [`KEPT`], and at most after [`MAX_TRIALS`].
const FAILURES: usize = 3;
const MAX_TRIALS: usize = 12;

/// A minimum that differs from another by less than this, in σ of the spin rate, is the same.
const SAME: f64 = 0.5;

/// The best minimum, and the others that the data don't exclude.
pub(super) struct Modes {
    pub best: Solution,
    pub others: Vec<Mode>,
}

/// Scans the spin rate at the start on both sides of a minimum.
pub(super) fn modes(
    problem: &Problem,
    points: &[Point],
    solution: &Solution,
    monitor: &Monitor<'_>,
) -> Result<Modes, FitError> {
    let mut best = solution.clone();
    // Every other quantity depends on the spin itself, not only through the phase of the nutation.
    let at = match spin_rate(problem) {
        Some(at) if !measures_more_than_theta(problem) => at,
        Some(_) | None => {
            return Ok(Modes {
                best,
                others: Vec::new(),
            });
        }
    };
    let end = points.iter().map(|point| point.time).fold(0.0, f64::max);
    let step = PHASE_STEP / end;
    let mut found: Vec<Solution> = vec![best.clone()];
    // On each side the minima get worse with the distance, but not evenly.
    for side in [-1.0, 1.0] {
        let mut failures = 0;
        let mut start = solution.values.clone();
        for trial in 1..=MAX_TRIALS {
            start[at] = solution.values[at] + side * step * trial as f64;
            let Some(minimum) = minimum_from(problem, points, &start, at, monitor)? else {
                break;
            };
            let delta = minimum.chi2 - best.chi2;
            failures = if delta < KEPT { 0 } else { failures + 1 };
            let is_new = found.iter().all(|known| {
                let sd = known.covariance[(at, at)].sqrt();
                (known.values[at] - minimum.values[at]).abs() > SAME * sd
            });
            if minimum.chi2 < best.chi2 {
                best = minimum.clone();
            }
            if is_new {
                found.push(minimum);
            }
            if failures == FAILURES {
                break;
            }
        }
    }
    let mut others = Vec::new();
    for other in &found {
        let delta_chi2 = other.chi2 - best.chi2;
        if other.values != best.values && other.is_converged && delta_chi2 < KEPT {
            others.push(Mode {
                delta_chi2,
                values: other.values.clone(),
                sds: other.covariance.diagonal().map(f64::sqrt).as_slice().into(),
            });
        }
    }
    others.sort_by(|a, b| a.delta_chi2.total_cmp(&b.delta_chi2));
    Ok(Modes { best, others })
}

/// The minimum near a spin rate: first with this rate, then with all parameters free. `None` if there is no complete
/// motion.
fn minimum_from(
    problem: &Problem,
    points: &[Point],
    start: &[f64],
    spin: usize,
    monitor: &Monitor<'_>,
) -> Result<Option<Solution>, FitError> {
    let Ok(start) = complete(problem, points, start.to_vec()) else {
        return Ok(None);
    };
    // With a free spin rate at once, the optimiser would fall back into the minimum that is known.
    let mut fixed = vec![false; start.len()];
    fixed[spin] = true;
    let held = minimise(problem, points, &start, None, &fixed, monitor)?;
    fixed[spin] = false;
    let free = minimise(problem, points, &held.values, None, &fixed, monitor)?;
    Ok(Some(free))
}
