//! Offsets of clocks: found by a scan, because each cycle of the nutation has a minimum of its own.

use super::error::FitError;
use super::model::{Point, Problem};
use super::monitor::Monitor;
use super::parameter::{Parameter, Target};
use super::solve::{Solution, minimise};
use std::f64::consts::TAU;

/// Samples of the model per cycle of its nutation.
const SAMPLES_PER_CYCLE: f64 = 40.0;

/// Maximum number of samples of the model, and of points of a file that are compared with it.
const MAX_SAMPLES: f64 = 200_000.0;
const MAX_POINTS: usize = 2000;

/// An offset must leave at least this part of the file's points within the motion.
const MIN_OVERLAP: f64 = 0.5;

/// Number of minima of the scan that are refined.
const CANDIDATES: usize = 3;

/// Finds the offsets of the clocks of all files but the first, whose points gave `values`. Returns the solution for all
/// points, and those that are within the motion.
pub(super) fn fit_offsets(
    problem: &Problem,
    values: Vec<f64>,
    end: f64,
    monitor: &Monitor<'_>,
) -> Result<(Solution, Vec<Point>), FitError> {
    let mut best = values;
    let mut points: Vec<Point> = Vec::new();
    for point in &problem.points {
        if problem.signals[point.signal].file == 0 {
            points.push(*point);
        }
    }
    let fixed = vec![false; best.len()];
    let mut solution: Option<Solution> = None;
    for (at, parameter) in problem.parameters.iter().enumerate() {
        let Target::Offset(file) = parameter.target else {
            continue;
        };
        let of_file: Vec<Point> = problem
            .points
            .iter()
            .filter(|point| problem.signals[point.signal].file == file)
            .copied()
            .collect();
        let scanned = scan(problem, &best, &of_file, parameter, end)?;
        let mut found: Option<(Solution, Vec<Point>)> = None;
        for offset in scanned.offsets {
            let mut start = best.clone();
            start[at] = offset;
            let mut both = points.clone();
            for point in &of_file {
                let time = point.time + offset;
                if (scanned.step..=end - scanned.step).contains(&time) {
                    both.push(*point);
                }
            }
            // Offsets of later files are not known yet.
            let mut later = fixed.clone();
            for (index, other) in problem.parameters.iter().enumerate() {
                later[index] = matches!(other.target, Target::Offset(other) if other > file);
            }
            let trial = minimise(problem, &both, &start, None, &later, monitor)?;
            let is_better = found.as_ref().is_none_or(|(best, points)| {
                trial.chi2 / both.len() as f64 <= best.chi2 / points.len() as f64
            });
            if is_better {
                found = Some((trial, both));
            }
        }
        if let Some((trial, both)) = found {
            best.clone_from(&trial.values);
            points = both;
            solution = Some(trial);
        }
    }
    if let Some(solution) = solution {
        return Ok((solution, points));
    }
    let solution = minimise(problem, &points, &best, None, &fixed, monitor)?;
    Ok((solution, points))
}

/// Result of a scan.
struct Scanned {
    /// The best offsets, best first, s.
    offsets: Vec<f64>,
    /// Distance between samples of the model, s.
    step: f64,
}

/// The mean loss of a file's points with an offset.
#[derive(Clone, Copy)]
struct Cost {
    /// The offset, s.
    offset: f64,
    /// Mean loss of the points within the motion.
    loss: f64,
}

/// The offsets whose neighbours don't have a lower loss.
fn local_minima(costs: &[Cost]) -> Vec<Cost> {
    let mut minima = Vec::new();
    for (at, cost) in costs.iter().enumerate() {
        let before = at.checked_sub(1).map(|at| &costs[at]);
        let neighbours = [before, costs.get(at + 1)];
        // At the ends, one neighbour is enough.
        if neighbours
            .into_iter()
            .flatten()
            .all(|other| cost.loss <= other.loss)
        {
            minima.push(*cost);
        }
    }
    minima
}

/// Compares the points of a file with the motion for all offsets that keep them within it.
fn scan(
    problem: &Problem,
    values: &[f64],
    points: &[Point],
    parameter: &Parameter,
    end: f64,
) -> Result<Scanned, FitError> {
    // A small nutation turns with the angular momentum about the axis, divided by I_x.
    let top = &problem.scenario.model.top;
    let spin = problem.scenario.rates.psi.abs().max(1.0);
    let cycle = TAU * top.transverse_moment / (top.axial_moment * spin);
    let step = (cycle / SAMPLES_PER_CYCLE).max(end / MAX_SAMPLES);
    let count = (end / step) as usize + 1;
    let mut compared: Vec<Point> = Vec::new();
    let stride = points.len().div_ceil(MAX_POINTS).max(1);
    compared.extend(points.iter().step_by(stride));
    // The motion in each of the file's signals, on a grid of times.
    let mut signals: Vec<usize> = compared.iter().map(|point| point.signal).collect();
    signals.sort_unstable();
    signals.dedup();
    let mut grid: Vec<Point> = Vec::new();
    for signal in &signals {
        for index in 0..count {
            grid.push(Point {
                signal: *signal,
                // On the clock of the file; its offset is added in the model.
                time: index as f64 * step - problem.offset(values, problem.signals[*signal].file),
                value: 0.0,
                sigma: 1.0,
            });
        }
    }
    let motion = problem.predict(values, &grid)?;
    let (mut first, mut last) = (f64::INFINITY, f64::NEG_INFINITY);
    for point in &compared {
        first = first.min(point.time);
        last = last.max(point.time);
    }
    let [low, high] = parameter.bounds;
    let from = (-last).max(low);
    let to = (end - first).min(high);
    let mut costs: Vec<Cost> = Vec::new();
    for index in 0..=((to - from) / step).max(0.0) as usize {
        let offset = from + index as f64 * step;
        let (mut sum, mut within) = (0.0, 0_usize);
        for point in &compared {
            let place = (point.time + offset) / step;
            if place < 0.0 || place >= (count - 1) as f64 {
                continue;
            }
            let row = signals.iter().position(|s| *s == point.signal);
            let at = row.unwrap_or_default() * count + place as usize;
            let part = place.fract();
            // Between samples of the motion, which are dense enough for a straight line.
            let value = motion[at] + part * (motion[at + 1] - motion[at]);
            let residual = problem
                .loss
                .transformed((value - point.value) / point.sigma);
            sum += residual * residual;
            within += 1;
        }
        // A mean over few points may be low by chance.
        if within as f64 >= MIN_OVERLAP * compared.len() as f64 {
            costs.push(Cost {
                offset,
                loss: sum / within as f64,
            });
        }
    }
    let mut minima = local_minima(&costs);
    minima.sort_by(|a, b| a.loss.total_cmp(&b.loss));
    minima.truncate(CANDIDATES);
    let offsets: Vec<f64> = minima.iter().map(|cost| cost.offset).collect();
    if offsets.is_empty() {
        return Err(FitError::NoOverlap {
            name: parameter.name(),
            first: first - parameter.shift,
            last: last - parameter.shift,
            end,
            bounds: (low > f64::MIN || high < f64::MAX)
                .then(|| [low, high].map(|bound| bound + parameter.shift)),
        });
    }
    Ok(Scanned { offsets, step })
}
