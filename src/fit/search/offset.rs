//! Offsets of clocks: found by a scan, because each cycle of the nutation has a minimum of its own.
//!
//! Which points of a file are within the motion depends on the offset of its clock. So χ² of two offsets tells which one
//! is better only for the points that both bring into the motion; χ² per point is good enough to choose where to begin.

use super::fitted::{Fitted, Split};
use super::monitor::Monitor;
use super::scan::{Scanned, highest_equal, is_within, scan, step};
use super::sigma;
use super::solve::{DRAFT_ERROR, Draft, Solution, choose_turns, minimise, promising_draft};
use crate::fit::error::FitError;
use crate::fit::problem::model::{Point, Problem};
use crate::fit::problem::parameter::Target;

/// Number of minima of a scan among which the first one is chosen.
const CANDIDATES: usize = 3;

/// A minimum whose mean loss is this much larger than the lowest one, or than 1, is not refined: the file is elsewhere in
/// its motion, or at rest.
const MAX_RATIO: f64 = 10.0;

/// Maximum number of other minima of a scan that are compared with one that was found, and number of those in a row that
/// are too far above it after which the comparison ends.
const MAX_RIVALS: usize = 24;
const FAILURES: usize = 4;

/// Minima are compared over the points that all of them bring into the motion: at least this part of those of the one that
/// was found.
const MIN_COMMON: f64 = 0.5;

/// Maximum number of times that the points within the motion are found.
const MAX_ROUNDS: usize = 5;

/// An offset this close to a minimum, in steps of the scan, belongs to it.
const SAME: f64 = 2.0;

/// Finds the offsets of all clocks but that of the model, whose points gave `values`. Returns the solution for all
/// points that are to be fitted and within the motion, and these points.
pub(in crate::fit) fn fit_offsets(
    problem: &Problem,
    values: Vec<f64>,
    split: &Split,
    monitor: &Monitor<'_>,
) -> Result<(Solution, Vec<Point>), FitError> {
    let mut best = values;
    let mut points = split.fitted.clone();
    for (at, file) in clocks(problem) {
        let in_file = problem.points_in_file(file);
        let scanned = scan(problem, &best, &in_file, at, split.end)?;
        // Offsets of later files are not known yet.
        let mut later = vec![false; best.len()];
        for (index, other) in clocks(problem) {
            later[index] = other > file;
        }
        let mut found: Option<(Solution, Vec<Point>)> = None;
        let highest = scanned.lowest().max(1.0) * MAX_RATIO;
        for cost in scanned.minima.iter().take(CANDIDATES) {
            if cost.loss > highest {
                break;
            }
            let mut start = best.clone();
            start[at] = cost.offset;
            let mut both = points.clone();
            for point in &in_file {
                if scanned.is_within(point, cost.offset, split.end) {
                    both.push(*point);
                }
            }
            choose_turns(problem, &start, &mut both)?;
            let trial = minimise(problem, &both, &start, None, &later, monitor)?;
            let mean = trial.chi2 / both.len() as f64;
            // Among those that noise can't tell apart, the first one has the most points.
            let is_better = found.as_ref().is_none_or(|(best, points)| {
                highest_equal(mean, both.len()) < best.chi2 / points.len() as f64
            });
            if is_better {
                found = Some((trial, both));
            }
        }
        if let Some((trial, both)) = found {
            best = trial.values;
            points = both;
        }
    }
    minimise_within(problem, &best, split.end, monitor)
}

/// The minimum for all points that its own offsets bring into the motion, and these points.
fn minimise_within(
    problem: &Problem,
    values: &[f64],
    end: f64,
    monitor: &Monitor<'_>,
) -> Result<(Solution, Vec<Point>), FitError> {
    let fixed = vec![false; values.len()];
    let mut points = points_within(problem, values, end);
    choose_turns(problem, values, &mut points)?;
    let mut solution = minimise(problem, &points, values, None, &fixed, monitor)?;
    // A point at an edge may go in and out.
    for _ in 1..MAX_ROUNDS {
        let mut within = points_within(problem, &solution.values, end);
        choose_turns(problem, &solution.values, &mut within)?;
        if within == points {
            break;
        }
        points = within;
        solution = minimise(problem, &points, &solution.values, None, &fixed, monitor)?;
    }
    Ok((solution, points))
}

/// The points on the model's clock that are to be fitted, and those of the others that are within the motion.
fn points_within(problem: &Problem, values: &[f64], end: f64) -> Vec<Point> {
    let step = step(problem, end);
    let mut points = Vec::new();
    for point in &problem.points {
        let time = problem.model_time(values, point);
        let is_first = problem.is_on_clock(point);
        if (is_first && time <= end) || is_within(time, step, end) {
            points.push(*point);
        }
    }
    points
}

/// The minima of an offset that the data don't exclude, over the points that all of them bring into the motion.
pub(in crate::fit) struct Rivals {
    /// The minima with their χ², lowest first. The one that was found may be any of them.
    pub minima: Vec<Solution>,
    /// Index of the one that was found, if it is among them.
    pub own: Option<usize>,
}

/// Compares the minimum that a fit has found with others of one offset, the parameter with the index `at` of a file's
/// clock. Those whose χ² is more than `highest(n)` above the lowest of n are excluded.
pub(in crate::fit) fn rivals(
    fitted: &Fitted,
    (at, file): (usize, usize),
    highest: fn(usize) -> f64,
    monitor: &Monitor<'_>,
) -> Result<Rivals, FitError> {
    let Fitted {
        problem,
        solution,
        split,
        ..
    } = fitted;
    let in_file = problem.points_in_file(file);
    let scanned = scan(problem, &solution.values, &in_file, at, split.end)?;
    let own = solution.values[at];
    let mut group = Group {
        offsets: Vec::new(),
        common: split.fitted.clone(),
        file,
    };
    group.collect(fitted, &scanned, own);
    let common = group.common;
    let free = vec![false; solution.values.len()];
    // Without the points that only its own offset brings into the motion, the minimum is a little elsewhere.
    let first = minimise(problem, &common, &solution.values, None, &free, monitor)?;
    let mut lowest = first.chi2;
    let mut drafts: Vec<Draft> = Vec::new();
    let (mut compared, mut failures) = (1, 0);
    let kept = highest(MAX_RIVALS + 1);
    for offset in group.offsets {
        let mut start = solution.values.clone();
        start[at] = offset;
        compared += 1;
        let promising = promising_draft(problem, &common, &start, lowest + kept, kept, monitor)?;
        // Two starts may end in the same minimum.
        let new = promising.filter(|found| {
            let mut known = vec![own];
            known.extend(drafts.iter().map(|draft| draft.values[at]));
            let reach = SAME * scanned.step;
            known
                .iter()
                .all(|known| (known - found.values[at]).abs() > reach)
        });
        match new {
            Some(found) => {
                lowest = lowest.min(found.loss);
                drafts.push(found);
                failures = 0;
            }
            None => failures += 1,
        }
        if failures == FAILURES {
            break;
        }
    }
    let highest = highest(compared);
    let mut minima = vec![first.clone()];
    for Draft { values, loss } in drafts {
        if loss < lowest + highest + DRAFT_ERROR {
            let minimum = minimise(problem, &common, &values, None, &free, monitor)?;
            if minimum.is_converged {
                minima.push(minimum);
            }
        }
    }
    minima.sort_by(|a, b| a.chi2.total_cmp(&b.chi2));
    let lowest = minima[0].chi2;
    minima.retain(|minimum| minimum.chi2 - lowest < highest);
    Ok(Rivals {
        own: minima
            .iter()
            .position(|minimum| minimum.values == first.values),
        minima,
    })
}

/// Offsets that are compared, and the points that all of them bring into the motion.
struct Group {
    offsets: Vec<f64>,
    common: Vec<Point>,
    file: usize,
}

impl Group {
    /// Collects the minima of a scan that describe the common points best, without the one that was found.
    fn collect(&mut self, fitted: &Fitted, scanned: &Scanned<'_>, own: f64) {
        let Fitted { problem, split, .. } = fitted;
        let mut others: Vec<(f64, f64)> = Vec::new();
        for cost in &scanned.minima {
            // The minimum that was found is on the grid of the scan or between two of its offsets.
            if (cost.offset - own).abs() > SAME * scanned.step {
                others.push((scanned.excess(cost.offset, own), cost.offset));
            }
        }
        // The best first, because each one that joins may leave fewer points in common.
        others.sort_by(|a, b| a.0.total_cmp(&b.0));
        let needed = MIN_COMMON * self.count(problem, &self.common) as f64;
        for (_, offset) in others {
            let mut common = Vec::new();
            for point in &self.common {
                let is_of_file = problem.signals[point.signal].file == self.file;
                if !is_of_file || scanned.is_within(point, offset, split.end) {
                    common.push(*point);
                }
            }
            if self.count(problem, &common) as f64 >= needed {
                self.common = common;
                self.offsets.push(offset);
            }
            if self.offsets.len() == MAX_RIVALS {
                break;
            }
        }
    }

    /// Number of points of the file.
    fn count(&self, problem: &Problem, points: &[Point]) -> usize {
        points
            .iter()
            .filter(|point| problem.signals[point.signal].file == self.file)
            .count()
    }
}

/// Moves a fit to another minimum of an offset, with all points that it brings into the motion.
pub(in crate::fit) fn move_to(
    fitted: &mut Fitted,
    values: &[f64],
    monitor: &Monitor<'_>,
) -> Result<(), FitError> {
    let Fitted {
        problem,
        solution,
        split,
        ..
    } = fitted;
    let (moved, points) = minimise_within(problem, values, split.end, monitor)?;
    split.fit_points(problem, &moved.values, points);
    *solution = sigma::settle(problem, split, moved, monitor)?;
    Ok(())
}

/// The offsets: the index of the parameter, and the file.
pub(in crate::fit) fn clocks(problem: &Problem) -> Vec<(usize, usize)> {
    let mut clocks = Vec::new();
    for (at, parameter) in problem.parameters.iter().enumerate() {
        if let Target::Offset(file) = parameter.target {
            clocks.push((at, file));
        }
    }
    clocks
}
