//! Other minima. The inclination alone shows the spin only through the phase of the nutation, so there is a minimum for
//! each number of nutations that fits in the data.

use super::error::FitError;
use super::fitted::Fitted;
use super::identify::{measures_more_than_theta, spin_rate};
use super::model::{Point, Problem};
use super::monitor::Monitor;
use super::offset::{self, Rivals};
use super::report::Mode;
use super::solve::{DRAFT_ERROR, Draft, Solution, complete, draft, minimise, promising_draft};
use crate::physics::math::ln;

/// Distance of trial spin rates, in radians of phase over the data.
const PHASE_STEP: f64 = 5.0;

/// Probability that the true minimum is excluded.
const EXCLUDED: f64 = 0.05;

/// Δχ² above which minima are not followed: that of the largest number of trials.
const KEPT: f64 = 17.0;

/// Iterations with a spin rate that is held, which only follow the trial before.
const HELD_ITERATIONS: usize = 4;

/// Beyond the start value and the first minimum the scan ends after this many trials in a row that are worse than
/// [`KEPT`].
const FAILURES: usize = 6;

/// Maximum number of trials on each side.
const MAX_TRIALS: usize = 100;

/// A minimum that differs from another by less than this, in σ of the spin rate, is the same.
const SAME: f64 = 0.5;

/// Maximum number of times that a better minimum of an offset is moved to.
const MAX_MOVES: usize = 4;

/// The Δχ² above which one of so many minima is excluded. A cycle of noise, of which a minimum makes use, lowers χ² by a
/// value that is above x with the probability exp(−x/2); the lowest of many is so much lower by chance.
fn highest(count: usize) -> f64 {
    2.0 * ln(count as f64 / EXCLUDED)
}

/// Moves a fit to its best minimum and lists the others. Returns what was looked at, in a sentence.
pub(super) fn settle(
    fitted: &mut Fitted,
    monitor: &Monitor<'_>,
) -> Result<Option<String>, FitError> {
    let mut found = find(fitted, Listed::AllButBest, monitor)?;
    for moves in 1..=MAX_MOVES {
        let Some(better) = found.better else { break };
        offset::move_to(fitted, &better.values, monitor)?;
        // Minima near one that was not excluded are listed already.
        if !better.excludes_own || moves == MAX_MOVES {
            break;
        }
        found = find(fitted, Listed::AllButBest, monitor)?;
    }
    Ok(found.scanned.map(|scanned| scanned.sentence()))
}

/// The minima of an offset that are listed as the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Listed {
    /// All but the best one, to which the fit will move.
    AllButBest,
    /// All but the one that was found, at which the fit stays.
    AllButOwn,
}

/// What a search for other minima has found.
pub(super) struct Found {
    scanned: Option<Scanned>,
    better: Option<Better>,
}

/// The spin rates at the start that were tried.
struct Scanned {
    /// The lowest and the highest one, rad/s.
    range: [f64; 2],
    /// Whether no minimum beyond them was left untried that the data may not exclude.
    is_complete: bool,
}

impl Scanned {
    fn sentence(&self) -> String {
        let [low, high] = self.range;
        let beyond = if self.is_complete {
            ""
        } else {
            "; spins beyond may describe the data as well"
        };
        format!(
            "Without φ or ψ, the phase of the nutation is all that shows the spin: other minima were looked for at initial.psi_dot from {low:.1} to {high:.1} rad/s{beyond}."
        )
    }
}

/// A minimum of an offset that is better than the one that was found, for the points that both bring into the motion.
struct Better {
    values: Vec<f64>,
    /// Whether the one that was found is excluded.
    excludes_own: bool,
}

/// Lists the other minima of a fit for its points, and moves to the best one of its spin rates.
pub(super) fn find(
    fitted: &mut Fitted,
    listed: Listed,
    monitor: &Monitor<'_>,
) -> Result<Found, FitError> {
    fitted.modes.clear();
    let scanned = find_spin_rates(fitted, monitor)?;
    let mut better = None;
    // A fit that has given up has no minimum to compare.
    let clocks = offset::clocks(&fitted.problem);
    for clock in clocks.into_iter().filter(|_| fitted.solution.is_converged) {
        let Rivals { minima, own } = offset::rivals(fitted, clock, highest, monitor)?;
        let lowest = minima[0].chi2;
        if own != Some(0) {
            better = Some(Better {
                values: minima[0].values.clone(),
                excludes_own: own.is_none(),
            });
        }
        let held = match listed {
            Listed::AllButBest => Some(0),
            Listed::AllButOwn => own,
        };
        for (index, minimum) in minima.iter().enumerate() {
            if Some(index) == held {
                continue;
            }
            let mode = mode(&fitted.problem, minimum, minimum.chi2 - lowest);
            fitted.modes.push(mode);
        }
    }
    fitted
        .modes
        .sort_by(|a, b| a.delta_chi2.total_cmp(&b.delta_chi2));
    Ok(Found { scanned, better })
}

/// Scans the spin rate at the start: from its start value to the minimum that was found, and beyond both. Returns the
/// range of the scan, rad/s.
fn find_spin_rates(
    fitted: &mut Fitted,
    monitor: &Monitor<'_>,
) -> Result<Option<Scanned>, FitError> {
    let Fitted {
        problem,
        solution,
        split,
        modes,
    } = fitted;
    // Every other quantity depends on the spin itself, not only through the phase of the nutation.
    let Some(at) = spin_rate(problem).filter(|_| !measures_more_than_theta(problem)) else {
        return Ok(None);
    };
    let points = &split.fitted;
    let mut scan = Scan {
        problem,
        points,
        spin: at,
        step: PHASE_STEP / points.iter().map(|point| point.time).fold(0.0, f64::max),
        reach: SAME * solution.covariance[(at, at)].sqrt(),
        drafts: vec![Draft {
            values: solution.values.clone(),
            loss: solution.chi2,
        }],
        trials: 1,
        is_complete: true,
        monitor,
    };
    let low = scan.side(solution, -1.0)?;
    let high = scan.side(solution, 1.0)?;
    let scanned = Scanned {
        range: [low, high],
        is_complete: scan.is_complete,
    };
    let highest = highest(scan.trials);
    // Noise may have favoured another spin than that of the first minimum.
    let mut minima = scan.minima(solution, highest)?;
    minima.sort_by(|a, b| a.chi2.total_cmp(&b.chi2));
    *solution = minima.remove(0);
    minima.retain(|other| other.is_converged && other.chi2 - solution.chi2 < highest);
    for other in &minima {
        modes.push(mode(problem, other, other.chi2 - solution.chi2));
    }
    Ok(Some(scanned))
}

/// Another minimum as reports have it.
fn mode(problem: &Problem, minimum: &Solution, delta_chi2: f64) -> Mode {
    let variances = minimum.covariance.diagonal();
    Mode {
        delta_chi2,
        sds: variances.iter().map(|variance| variance.sqrt()).collect(),
        values: problem
            .parameters
            .iter()
            .zip(&minimum.values)
            .map(|(parameter, value)| parameter.reported(*value))
            .collect(),
    }
}

/// A scan of the spin rate at the start.
struct Scan<'a> {
    problem: &'a Problem,
    points: &'a [Point],
    /// Index of the spin rate among the parameters.
    spin: usize,
    /// Distance of trials, rad/s.
    step: f64,
    /// A minimum that differs by less is the same, rad/s.
    reach: f64,
    /// Number of minima that were looked for.
    trials: usize,
    /// Whether both sides ended before the last trial, at spin rates that the data or the bounds exclude.
    is_complete: bool,
    /// The minima that were found, each once.
    drafts: Vec<Draft>,
    monitor: &'a Monitor<'a>,
}

impl Scan<'_> {
    /// Tries spin rates on one side of a minimum; the last of them is returned, rad/s.
    fn side(&mut self, from: &Solution, side: f64) -> Result<f64, FitError> {
        let centre = from.values[self.spin];
        // The start value is what a person knows of the spin: all minima between it and the one that was found count.
        let expected = side * (self.problem.parameters[self.spin].start - centre);
        let mut values = from.values.clone();
        let mut failures = 0;
        for trial in 1..=MAX_TRIALS {
            let distance = self.step * trial as f64;
            let last = values[self.spin];
            values[self.spin] = self.problem.parameters[self.spin].clamp(centre + side * distance);
            if values[self.spin] == last {
                return Ok(last);
            }
            let Some(held) = self.minimum_at(&values)? else {
                return Ok(last);
            };
            // The other parameters change little from one trial to the next.
            values = held;
            let is_failure = self.is_worse_from(&values)?;
            let counts = is_failure && distance > expected;
            failures = if counts { failures + 1 } else { 0 };
            self.trials += 1;
            if failures == FAILURES {
                return Ok(values[self.spin]);
            }
        }
        self.is_complete = false;
        Ok(values[self.spin])
    }

    /// The other parameters for which a spin rate describes the data best. `None` if there is no complete motion.
    fn minimum_at(&self, values: &[f64]) -> Result<Option<Vec<f64>>, FitError> {
        let Ok(start) = complete(self.problem, self.points, values.to_vec()) else {
            return Ok(None);
        };
        // With a free spin rate at once, the optimiser would fall back into the minimum that is known.
        let mut fixed = vec![false; start.len()];
        fixed[self.spin] = true;
        draft(
            self.problem,
            self.points,
            &start,
            fixed,
            HELD_ITERATIONS,
            self.monitor,
        )
        .map(Some)
    }

    /// Adds the minimum near these values to those that were found; whether it is worse than the best by [`KEPT`].
    fn is_worse_from(&mut self, values: &[f64]) -> Result<bool, FitError> {
        let highest = self.best() + KEPT;
        let promising = promising_draft(
            self.problem,
            self.points,
            values,
            highest,
            KEPT,
            self.monitor,
        )?;
        let Some(found) = promising else {
            return Ok(true);
        };
        let (spin, reach) = (self.spin, self.reach);
        // The step between trials is a little less than the distance of minima, so some are found twice.
        let known = self
            .drafts
            .iter_mut()
            .find(|known| (known.values[spin] - found.values[spin]).abs() <= reach);
        match known {
            Some(known) if found.loss < known.loss => *known = found,
            Some(_) => {}
            None => self.drafts.push(found),
        }
        Ok(false)
    }

    /// The lowest loss of the minima that were found.
    fn best(&self) -> f64 {
        self.drafts
            .iter()
            .map(|known| known.loss)
            .fold(f64::INFINITY, f64::min)
    }

    /// The minima that may be kept, each once. `first` is one of them.
    fn minima(self, first: &Solution, highest: f64) -> Result<Vec<Solution>, FitError> {
        let highest = self.best() + highest + DRAFT_ERROR;
        let mut minima = vec![first.clone()];
        for draft in self.drafts.iter().filter(|draft| draft.loss < highest) {
            let free = vec![false; draft.values.len()];
            let minimum = minimise(
                self.problem,
                self.points,
                &draft.values,
                None,
                &free,
                self.monitor,
            )?;
            let same = minima.iter_mut().find(|known| {
                let sd = known.covariance[(self.spin, self.spin)].sqrt();
                (known.values[self.spin] - minimum.values[self.spin]).abs() <= SAME * sd
            });
            match same {
                Some(known) if minimum.chi2 < known.chi2 => *known = minimum,
                Some(_) => {}
                None => minima.push(minimum),
            }
        }
        Ok(minima)
    }
}
