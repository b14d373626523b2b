//! Offsets of clocks: found by a scan, because each cycle of the nutation has a minimum of its own.

use super::error::FitError;
use super::model::{Point, Problem};
use super::parameter::{Parameter, Target};
use super::solve::{Solution, Watch, error_from, minimise};
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
    watch: &Watch<'_>,
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
            let trial = minimise(problem, &both, &start, None, &later, watch)?;
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
    let solution = minimise(problem, &points, &best, None, &fixed, watch)?;
    Ok((solution, points))
}

/// Result of a scan.
struct Scanned {
    /// The best offsets, best first, s.
    offsets: Vec<f64>,
    /// Distance between samples of the model, s.
    step: f64,
}

/// Compares the points of a file with the motion for all offsets that keep them within it.
fn scan(
    problem: &Problem,
    values: &[f64],
    points: &[Point],
    parameter: &Parameter,
    end: f64,
) -> Result<Scanned, FitError> {
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
    let motion = problem.predict(values, &grid).map_err(error_from)?;
    let times = compared.iter().map(|point| point.time);
    let first = times.clone().fold(f64::INFINITY, f64::min);
    let last = times.fold(f64::NEG_INFINITY, f64::max);
    let [low, high] = parameter.bounds;
    let from = (-last).max(low);
    let to = (end - first).min(high);
    let mut costs: Vec<(f64, f64)> = Vec::new();
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
            let value = motion[at] + part * (motion[at + 1] - motion[at]);
            let residual = problem
                .loss
                .transformed((value - point.value) / point.sigma);
            sum += residual * residual;
            within += 1;
        }
        if within as f64 >= MIN_OVERLAP * compared.len() as f64 {
            costs.push((sum / within as f64, offset));
        }
    }
    let mut minima: Vec<(f64, f64)> = Vec::new();
    for at in 0..costs.len() {
        let before = at.checked_sub(1).map(|at| costs[at].0);
        let after = costs.get(at + 1).map(|cost| cost.0);
        let is_lowest = |other: Option<f64>| other.is_none_or(|other| costs[at].0 <= other);
        if is_lowest(before) && is_lowest(after) {
            minima.push(costs[at]);
        }
    }
    minima.sort_by(|a, b| a.0.total_cmp(&b.0));
    let best = minima.iter().take(CANDIDATES);
    let offsets: Vec<f64> = best.map(|(_, offset)| *offset).collect();
    if offsets.is_empty() {
        return Err(FitError::NoOverlap {
            name: parameter.name(),
            first,
            last,
            end,
            low,
            high,
        });
    }
    Ok(Scanned { offsets, step })
}
