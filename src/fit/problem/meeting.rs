//! Whether model and data meet at all: seen in the first seconds, before anything long runs.

use super::model::{Point, Problem};
use crate::fit::apart::Apart;
use crate::fit::error::FitError;
use crate::fit::search::spin_guess::precession_rate;
use crate::measured::median_size;
use crate::telemetry::fields::{NumberField, state};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;
use std::ops::Range;

/// Refuses data in which an angle that should turn is at rest for long, at the beginning or at the end.
pub(in crate::fit) fn check_rest(problem: &Problem, origin: f64) -> Result<(), FitError> {
    /// The top may move later than the start says, but not so many times.
    const LATE: f64 = 10.0;
    /// Shorter rests are no nuisance, s.
    const MIN_REST: f64 = 0.1;
    for field in [state::PHI, state::PSI] {
        let points = points_of(problem, field);
        let (Some(first), Some(last)) = (points.first(), points.last()) else {
            continue;
        };
        let signal = &problem.signals[first.signal];
        let threshold = 8.0 * signal.sigmas[0].max(signal.scatter());
        let Some(usual) = time_to_move(problem, first.signal, threshold) else {
            continue;
        };
        let long = (LATE * usual).max(MIN_REST);
        let mut backwards = points.clone();
        backwards.reverse();
        let before = rest(&points, threshold);
        let after = rest(&backwards, threshold);
        let is_rest = |edge: &Point, time: f64| {
            let range = edge.time.min(time)..edge.time.max(time);
            range.end - range.start > long && is_still(problem, range)
        };
        let seen = match (before, after) {
            (None, _) | (_, None) if is_rest(first, last.time) => Apart::Rest,
            (Some(until), _) if is_rest(first, until) => Apart::RestBefore {
                until: origin + until,
            },
            (_, Some(from)) if is_rest(last, from) => Apart::RestAfter {
                from: origin + from,
            },
            (Some(_) | None, _) => continue,
        };
        return Err(seen.into());
    }
    Ok(())
}

/// Whether no signal changes in a time by more than its noise.
fn is_still(problem: &Problem, range: Range<f64>) -> bool {
    const NOISE: f64 = 3.0;
    problem.signals.iter().enumerate().all(|(index, signal)| {
        let mut values = Vec::new();
        for point in &problem.points {
            if point.signal == index && problem.is_on_clock(point) && range.contains(&point.time) {
                values.push(point.value);
            }
        }
        values.sort_by(f64::total_cmp);
        let middle = values.get(values.len() / 2).copied().unwrap_or_default();
        let departures: Vec<f64> = values.iter().map(|value| value - middle).collect();
        median_size(&departures) < NOISE * signal.sigmas[0].max(signal.scatter())
    })
}

/// The points of a field that are on the clock of the model, in order of time.
fn points_of(problem: &Problem, field: NumberField) -> Vec<Point> {
    let mut points = problem.points.clone();
    points
        .retain(|point| problem.signals[point.signal].field == field && problem.is_on_clock(point));
    points
}

/// The time of the last point at rest, before an angle is far from where it is at first. It must get there at once: a slow
/// motion is no rest, and has none before it. `None` if the angle never moves.
fn rest(points: &[Point], threshold: f64) -> Option<f64> {
    const FIRST: usize = 5;
    /// A rest is so many times longer than the first part of the motion.
    const SUDDEN: f64 = 10.0;
    let mut first: Vec<f64> = points.iter().take(FIRST).map(|point| point.value).collect();
    first.sort_by(f64::total_cmp);
    let place = *first.get(first.len() / 2)?;
    let edge = points[0].time;
    let moved = first_beyond(points, place, threshold)?;
    let further = first_beyond(points, place, 2.0 * threshold)?;
    let [until, moved, further] =
        [moved.saturating_sub(1), moved, further].map(|at| points[at].time);
    let is_sudden = (until - edge).abs() > SUDDEN * (further - moved).abs();
    Some(if is_sudden { until } else { edge })
}

/// The first of several points in a row that are beyond a distance from a place.
fn first_beyond(points: &[Point], place: f64, distance: f64) -> Option<usize> {
    const IN_A_ROW: usize = 3;
    let is_beyond = |point: &Point| {
        let step = point.value - place;
        (step - (step / TAU).round() * TAU).abs() > distance
    };
    points
        .windows(IN_A_ROW)
        .position(|row| row.iter().all(is_beyond))
}

/// The time in which the motion at the start moves an angle by so much, s; `None` if it does not in a second.
fn time_to_move(problem: &Problem, signal: usize, threshold: f64) -> Option<f64> {
    const STEP: f64 = 1e-3;
    const STEPS: u32 = 1000;
    let times: Vec<Point> = (0..=STEPS)
        .map(|at| Point {
            signal,
            time: STEP * f64::from(at),
            value: 0.0,
            sigma: 1.0,
        })
        .collect();
    let motion = problem.predict(&problem.start(), &times).ok()?;
    let moved = motion
        .iter()
        .position(|value| (value - motion[0]).abs() > threshold)?;
    Some(STEP * moved.max(1) as f64)
}

/// Refuses a motion, with these residuals in σ, that is far from the first seconds of data, and explains less of them than
/// a parabola for each signal does.
pub(in crate::fit) fn check_likeness(
    problem: &Problem,
    points: &[Point],
    residuals: &[f64],
) -> Result<(), FitError> {
    /// Median of the residuals above which a motion is far, in σ.
    const FAR: f64 = 10.0;
    if median_size(residuals) < FAR {
        return Ok(());
    }
    let (mut of_motion, mut of_parabolas) = (0.0, 0.0);
    for signal in 0..problem.signals.len() {
        let (mut rows, mut values) = (Vec::new(), Vec::new());
        for (point, residual) in points.iter().zip(residuals) {
            if point.signal == signal {
                of_motion += problem.loss.of(*residual);
                rows.extend([1.0, point.time, point.time * point.time]);
                values.push(point.value / point.sigma);
            }
        }
        let matrix = DMatrix::from_row_slice(values.len(), 3, &rows);
        let values = DVector::from_vec(values);
        if let Ok(parabola) = matrix.clone().svd(true, true).solve(&values, 1e-12) {
            for residual in &(matrix * parabola - values) {
                of_parabolas += problem.loss.of(*residual);
            }
        }
    }
    if of_motion < of_parabolas {
        return Ok(());
    }
    Err(Apart::Unlike.into())
}

/// Refuses a precession that is many times slower or faster than that of the start. A start may well spin three times too
/// fast, or the wrong way.
pub(in crate::fit) fn check_precession(problem: &Problem) -> Result<(), FitError> {
    const FACTOR: f64 = 6.0;
    match seen(problem, FACTOR) {
        Apart::Unlike => Ok(()),
        seen => Err(seen.into()),
    }
}

/// What is seen of data that no motion is like.
pub(in crate::fit) fn explained(problem: &Problem) -> Apart {
    const FACTOR: f64 = 3.0;
    seen(problem, FACTOR)
}

/// A precession whose rate differs from that of the start by more than a factor.
fn seen(problem: &Problem, factor: f64) -> Apart {
    let points = points_of(problem, state::PHI);
    let (Some(measured), Some(first)) = (precession_rate(problem), points.first()) else {
        return Apart::Unlike;
    };
    let ends = [0.0, 1.0].map(|time| Point { time, ..*first });
    let Ok(motion) = problem.predict(&problem.start(), &ends) else {
        return Apart::Unlike;
    };
    let ratio = measured / (motion[1] - motion[0]);
    if (1.0 / factor..factor).contains(&ratio.abs()) {
        Apart::Unlike
    } else {
        Apart::Precession { ratio }
    }
}
