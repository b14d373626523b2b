//! Profile likelihoods: χ² as a function of one parameter, minimised over all others.

use super::error::{FitError, not_free};
use super::estimate::ONE_SIDED;
use super::report::{Limit, Profile};
use crate::fit::problem::model::{Point, Problem};
use crate::fit::problem::parameter::PROFILE;
use crate::fit::search::monitor::Monitor;
use crate::fit::search::solve::{Solution, minimise};

/// Distance of the values, in standard deviations.
const STEP: f64 = 0.5;

/// The profile goes on until Δχ² is above this: that of 95.4 %, with room for interpolation.
const HIGHEST: f64 = 4.5;

/// Maximum number of values on each side.
const MAX_VALUES: usize = 20;

/// After so many equal steps, in which a parabola is above [`HIGHEST`], distances grow by a factor.
const EVEN_STEPS: usize = 6;
const GROWTH: f64 = 1.5;

/// Values around a level whose √Δχ² differ by more than this are too coarse to interpolate.
const MAX_GAP: f64 = 0.6;

/// Maximum number of values that are added around a level on one side.
const MAX_REFINEMENTS: usize = 14;

/// Computes the profile of a parameter around a minimum.
pub(super) fn profile(
    problem: &Problem,
    points: &[Point],
    solution: &Solution,
    name: &str,
    monitor: &Monitor<'_>,
) -> Result<Profile, FitError> {
    let mut parameters = problem.parameters.iter();
    let Some(at) = parameters.position(|parameter| parameter.name() == name) else {
        return Err(not_free(name, PROFILE));
    };
    let parameter = &problem.parameters[at];
    let best = solution.values[at];
    let sd = solution.covariance[(at, at)].sqrt();
    // A parameter at a bound has no standard deviation: its scale is only a first guess.
    let has_sd = sd > 0.0 && !solution.held[at];
    let sd = if has_sd { sd } else { parameter.scale };
    let mut curve = vec![(best, 0.0)];
    let mut fixed = vec![false; solution.values.len()];
    fixed[at] = true;
    for side in [-1.0, 1.0] {
        // Distances from the minimum, ascending, and their Δχ².
        let mut reached = vec![(0.0, 0.0)];
        let mut values = solution.values.clone();
        let mut distance = 0.0;
        for step in 0..MAX_VALUES {
            distance = if step < EVEN_STEPS {
                distance + STEP * sd
            } else {
                GROWTH * distance
            };
            let value = parameter.clamp(best + side * distance);
            if values[at] == value {
                break;
            }
            values[at] = value;
            if problem.predict(&values, points).is_err() {
                break;
            }
            let found = minimise(problem, points, &values, None, &fixed, monitor)?;
            values = found.values;
            reached.push(((value - best).abs(), found.chi2 - solution.chi2));
            if found.chi2 - solution.chi2 > HIGHEST {
                break;
            }
        }
        for level in [1.0, 4.0] {
            for _ in 0..MAX_REFINEMENTS {
                let Some((place, distance)) = coarse_gap(&reached, level) else {
                    break;
                };
                let mut values = solution.values.clone();
                values[at] = parameter.clamp(best + side * distance);
                if problem.predict(&values, points).is_err() {
                    break;
                }
                let found = minimise(problem, points, &values, None, &fixed, monitor)?;
                reached.insert(place, (distance, found.chi2 - solution.chi2));
            }
        }
        for (distance, delta) in &reached[1..] {
            curve.push((best + side * distance, *delta));
        }
    }
    curve.sort_by(|a, b| a.0.total_cmp(&b.0));
    let interval_1 = crossings(&curve, best, 1.0);
    let interval_4 = crossings(&curve, best, 4.0);
    let mut curvature_error: Option<f64> = None;
    for side in interval_4.iter().flatten().filter(|_| has_sd) {
        let error = ((side - best).abs() / (2.0 * sd) - 1.0).abs();
        curvature_error = Some(curvature_error.map_or(error, |known| known.max(error)));
    }
    Ok(Profile {
        parameter: name.to_owned(),
        values: curve
            .iter()
            .map(|(value, _)| value + parameter.shift)
            .collect(),
        delta_chi2: curve.iter().map(|(_, delta)| *delta).collect(),
        interval_1: interval_1.map(|bound| bound.map(|bound| bound + parameter.shift)),
        interval_4: interval_4.map(|bound| bound.map(|bound| bound + parameter.shift)),
        curvature_error,
    })
}

/// The one-sided 95 % limit of a parameter that a bound holds: where χ², minimised over the others, has grown by 1.645².
pub(super) fn limit(
    problem: &Problem,
    points: &[Point],
    solution: &Solution,
    at: usize,
    monitor: &Monitor<'_>,
) -> Result<Limit, FitError> {
    /// The distance from the bound is found to this factor, or given up after so many trials.
    const PRECISION: f64 = 1.02;
    const TRIALS: usize = 24;
    const FACTOR: f64 = 4.0;
    let parameter = &problem.parameters[at];
    let [low, high] = parameter.bounds;
    let is_low = solution.values[at] <= low;
    let mut fixed = vec![false; solution.values.len()];
    fixed[at] = true;
    let (mut inside, mut outside) = (0.0_f64, f64::INFINITY);
    let mut distance = 1e-2 * parameter.scale.max(parameter.start.abs());
    for _ in 0..TRIALS {
        let mut values = solution.values.clone();
        values[at] = if is_low {
            low + distance
        } else {
            high - distance
        };
        // A motion that ends before the data contradicts them.
        let growth = match problem.predict(&values, points) {
            Ok(_) => {
                minimise(problem, points, &values, None, &fixed, monitor)?.chi2 - solution.chi2
            }
            Err(_) => f64::INFINITY,
        };
        if growth < ONE_SIDED * ONE_SIDED {
            inside = distance;
        } else {
            outside = distance;
        }
        distance = if outside.is_infinite() {
            FACTOR * inside
        } else if inside == 0.0 {
            outside / FACTOR
        } else {
            (inside * outside).sqrt()
        };
        if distance >= high - low {
            return Ok(Limit::None);
        }
        if outside < PRECISION * inside {
            break;
        }
    }
    Ok(match (outside.is_finite(), is_low) {
        (true, true) => Limit::Below(low + distance + parameter.shift),
        (true, false) => Limit::Above(high - distance + parameter.shift),
        (false, _) => Limit::None,
    })
}

/// The place and distance of a value between two that bracket a level but differ too much. Distances of a wrong scale
/// shrink by factors.
fn coarse_gap(reached: &[(f64, f64)], level: f64) -> Option<(usize, f64)> {
    /// Factor towards a minimum at distance 0.
    const FACTOR: f64 = 0.25;
    for (at, pair) in reached.windows(2).enumerate() {
        let [(near, low), (far, high)] = [pair[0], pair[1]];
        if low <= level && high > level {
            let gap = high.sqrt() - low.max(0.0).sqrt();
            let distance = if near > 0.0 {
                (near * far).sqrt()
            } else {
                FACTOR * far
            };
            return (gap > MAX_GAP).then_some((at + 1, distance));
        }
    }
    None
}

/// Where a profile reaches a level on both sides of its minimum.
fn crossings(curve: &[(f64, f64)], best: f64, level: f64) -> [Option<f64>; 2] {
    // √Δχ² is nearly a straight line on each side: interpolate that.
    let height = level.sqrt();
    let mut found = [None, None];
    for pair in curve.windows(2) {
        let [(a, low), (b, high)] = [pair[0], pair[1]].map(|(v, d)| (v, d.max(0.0).sqrt()));
        if (low - height) * (high - height) <= 0.0 && low != high {
            let crossing = a + (height - low) / (high - low) * (b - a);
            let side = usize::from(crossing > best);
            // On the left the last crossing before the minimum counts, on the right the first.
            if side == 0 || found[1].is_none() {
                found[side] = Some(crossing);
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refines_a_profile_whose_first_step_is_too_long() {
        // Δχ² at a bound grows linearly; the first distance is 10⁵ times too long.
        let slope = 1e5;
        let mut reached = vec![(0.0, 0.0), (1.0, slope)];
        for level in [1.0, 4.0] {
            for _ in 0..MAX_REFINEMENTS {
                if let Some((place, distance)) = coarse_gap(&reached, level) {
                    reached.insert(place, (distance, slope * distance));
                }
            }
            let [_, crossing] = crossings(&reached, 0.0, level);
            let error = crossing.unwrap() * slope / level - 1.0;
            assert!(error.abs() < 0.15, "{level}: {error}");
        }
    }

    #[test]
    fn crossings_of_a_parabola_are_exact() {
        let curve: Vec<(f64, f64)> = (-5..=5)
            .map(|i| {
                (
                    f64::from(i) * 0.5,
                    (f64::from(i) * 0.5) * (f64::from(i) * 0.5),
                )
            })
            .collect();
        for (level, width) in [(1.0, 1.0), (4.0, 2.0)] {
            let [low, high] = crossings(&curve, 0.0, level).map(Option::unwrap);
            assert!((low + width).abs() < 1e-12 && (high - width).abs() < 1e-12);
        }
        assert_eq!(crossings(&curve[5..], 0.0, 1.0), [None, Some(1.0)]);
    }
}
