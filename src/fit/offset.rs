//! Offsets of clocks: found by a scan, because each cycle of the nutation has a minimum of its own.
//!
//! Which points of a file are within the motion depends on the offset of its clock. So χ² of two offsets tells which one
//! is better only for the points that both bring into the motion; χ² per point is good enough to choose where to begin.

use super::error::FitError;
use super::fitted::{Fitted, Split};
use super::model::{Effort, Point, Problem};
use super::monitor::Monitor;
use super::parameter::Target;
use super::scan::{Scanned, is_within, scan, step};
use super::sigma;
use super::solve::{Solution, draft, minimise};

/// Number of minima of a scan among which the first one is chosen.
const CANDIDATES: usize = 3;

/// A minimum whose mean loss is this much larger than the lowest one, or than 1, is not refined: the file is elsewhere in
/// its motion, or at rest.
const MAX_RATIO: f64 = 10.0;

/// Maximum number of other minima of a scan that are compared with one that was found, and number of those in a row that
/// are too far above it after which the comparison ends.
const MAX_RIVALS: usize = 24;
const FAILURES: usize = 4;

/// A rival is compared if at least this part of the file's points is within the motion with both offsets.
const MIN_COMMON: f64 = 0.5;

/// Iterations after which a rival goes on only if it is promising. The motion hardly changes from one to the next.
const DRAFT_ITERATIONS: usize = 6;

/// Maximum number of times that the points within the motion are found.
const MAX_ROUNDS: usize = 5;

/// An offset this close to a minimum, in steps of the scan, belongs to it.
const SAME: f64 = 2.0;

/// Finds the offsets of the clocks of all files but the first, whose points gave `values`. Returns the solution for all
/// points that are to be fitted and within the motion, and these points.
pub(super) fn fit_offsets(
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
        let highest = scanned.minima[0].loss.max(1.0) * MAX_RATIO;
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
            let trial = minimise(problem, &both, &start, None, &later, monitor)?;
            let is_better = found.as_ref().is_none_or(|(best, points)| {
                trial.chi2 / both.len() as f64 <= best.chi2 / points.len() as f64
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
    let mut solution = minimise(problem, &points, values, None, &fixed, monitor)?;
    // A point at an edge may go in and out.
    for _ in 1..MAX_ROUNDS {
        let within = points_within(problem, &solution.values, end);
        if within == points {
            break;
        }
        points = within;
        solution = minimise(problem, &points, &solution.values, None, &fixed, monitor)?;
    }
    Ok((solution, points))
}

/// The points of the first file that are to be fitted, and those of the others that are within the motion.
fn points_within(problem: &Problem, values: &[f64], end: f64) -> Vec<Point> {
    let step = step(problem, end);
    let mut points = Vec::new();
    for point in &problem.points {
        let time = problem.model_time(values, point);
        let is_first = problem.signals[point.signal].file == 0;
        if (is_first && time <= end) || is_within(time, step, end) {
            points.push(*point);
        }
    }
    points
}

/// Moves a fit to a better minimum of an offset, with all points that it brings into the motion.
pub(super) fn move_to(
    fitted: &mut Fitted,
    better: &Rival,
    monitor: &Monitor<'_>,
) -> Result<(), FitError> {
    let Fitted {
        problem,
        solution,
        split,
        ..
    } = fitted;
    let values = &better.solution.values;
    let (moved, points) = minimise_within(problem, values, split.end, monitor)?;
    split.fit_points(problem, &moved.values, points);
    *solution = sigma::settle(problem, split, moved, monitor)?;
    Ok(())
}

/// Another minimum of an offset.
pub(super) struct Rival {
    /// Its solution for the points that are within the motion with both offsets.
    pub solution: Solution,
    /// χ² of these points, above that of the minimum that was found.
    pub delta_chi2: f64,
}

/// The other minima of the offsets whose χ² is less than `highest` above that of `solution`, or below it; lowest first.
pub(super) fn rivals(
    fitted: &Fitted,
    highest: f64,
    monitor: &Monitor<'_>,
) -> Result<Vec<Rival>, FitError> {
    let Fitted {
        problem,
        solution,
        split,
        ..
    } = fitted;
    let mut rivals = Vec::new();
    for (at, file) in clocks(problem) {
        let in_file = problem.points_in_file(file);
        let search = Search {
            fitted,
            at,
            file,
            scanned: scan(problem, &solution.values, &in_file, at, split.end)?,
            highest,
            monitor,
        };
        rivals.extend(search.rivals()?);
    }
    rivals.sort_by(|a, b| a.delta_chi2.total_cmp(&b.delta_chi2));
    Ok(rivals)
}

/// A search for other minima of one offset.
struct Search<'a> {
    /// The minimum that was found.
    fitted: &'a Fitted,
    /// Index of the offset among the parameters.
    at: usize,
    /// Its file.
    file: usize,
    scanned: Scanned,
    highest: f64,
    monitor: &'a Monitor<'a>,
}

impl Search<'_> {
    fn rivals(&self) -> Result<Vec<Rival>, FitError> {
        let mut known = vec![self.fitted.solution.values[self.at]];
        let mut rivals = Vec::new();
        let mut failures = 0;
        for cost in self.scanned.minima.iter().take(MAX_RIVALS) {
            if self.is_known(&known, cost.offset) {
                continue;
            }
            match self.rival_near(cost.offset)? {
                Some(rival) if !self.is_known(&known, rival.solution.values[self.at]) => {
                    known.push(rival.solution.values[self.at]);
                    rivals.push(rival);
                    failures = 0;
                }
                Some(_) | None => failures += 1,
            }
            if failures == FAILURES {
                break;
            }
        }
        Ok(rivals)
    }

    /// Whether an offset belongs to one of the minima that are known.
    fn is_known(&self, known: &[f64], offset: f64) -> bool {
        let reach = SAME * self.scanned.step;
        known.iter().any(|known| (known - offset).abs() <= reach)
    }

    /// The minimum near an offset, unless it is too far above the one that was found.
    fn rival_near(&self, offset: f64) -> Result<Option<Rival>, FitError> {
        let Fitted {
            problem,
            solution,
            split,
            ..
        } = self.fitted;
        let (mut common, mut chi2) = (Vec::new(), 0.0);
        let (mut of_file, mut lost) = (0, 0);
        for (point, residual) in split.fitted.iter().zip(&solution.residuals) {
            let is_of_file = problem.signals[point.signal].file == self.file;
            of_file += usize::from(is_of_file);
            if is_of_file && !self.scanned.is_within(point, offset, split.end) {
                lost += 1;
                continue;
            }
            let deviate = problem.loss.transformed(*residual);
            chi2 += deviate * deviate;
            common.push(*point);
        }
        if lost as f64 > (1.0 - MIN_COMMON) * of_file as f64 {
            return Ok(None);
        }
        let mut start = solution.values.clone();
        start[self.at] = offset;
        let free = vec![false; start.len()];
        let values = draft(
            problem,
            &common,
            &start,
            free.clone(),
            DRAFT_ITERATIONS,
            self.monitor,
        )?;
        match problem.loss_at(Effort::Final, &values, &common) {
            // Drafts end a little above their minimum.
            Ok(loss) if loss < chi2 + 2.0 * self.highest => {}
            Ok(_) | Err(_) => return Ok(None),
        }
        let rival = minimise(problem, &common, &values, None, &free, self.monitor)?;
        let own = minimise(
            problem,
            &common,
            &solution.values,
            None,
            &free,
            self.monitor,
        )?;
        let delta_chi2 = rival.chi2 - own.chi2;
        let is_rival = rival.is_converged && delta_chi2 < self.highest;
        Ok(is_rival.then_some(Rival {
            solution: rival,
            delta_chi2,
        }))
    }
}

/// The offsets: the index of the parameter, and the file.
fn clocks(problem: &Problem) -> Vec<(usize, usize)> {
    let mut clocks = Vec::new();
    for (at, parameter) in problem.parameters.iter().enumerate() {
        if let Target::Offset(file) = parameter.target {
            clocks.push((at, file));
        }
    }
    clocks
}
