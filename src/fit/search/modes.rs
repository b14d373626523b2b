//! Other minima. The inclination alone shows the spin only through the phase of the nutation, so there is a minimum for
//! each number of nutations that fits in the data.

use super::fitted::Fitted;
use super::monitor::Monitor;
use super::offset::{self, Rivals};
use super::sigma;
use super::solve::{DRAFT_ERROR, Draft, Solution, complete, draft, minimise, promising_draft};
use crate::fit::error::FitError;
use crate::fit::note::Note;
use crate::fit::problem::identify::{measures_more_than_theta, spin_rate};
use crate::fit::problem::model::{Point, Problem};
use crate::fit::report::Mode;
use crate::physics::math::ln;
use rayon::prelude::*;

/// Distance of trial spin rates, in radians of the nutation's phase over the data: three trials for two minima.
const PHASE_STEP: f64 = 4.25;

/// A trial this close to a minimum that was found, in steps, would find it again.
const COVERED: f64 = 0.5;

/// Probability that the true minimum is excluded.
const EXCLUDED: f64 = 0.05;

/// Δχ² above which minima are not followed: that of the largest number of trials.
const KEPT: f64 = 17.0;

/// Iterations with a spin rate that is held, which only follow the trial before.
const HELD_ITERATIONS: usize = 2;

/// Relative change of χ² that counts as none in minima that are only listed.
const LISTED_PRECISION: f64 = 1e-6;

/// Number of minima that are found at once. The last of them may leave a processor idle.
const MINIMISED_AT_ONCE: usize = 16;

/// Number of motions, in units of the first one's steps, after which the scan ends.
const MAX_MOTIONS: u64 = 10_000;

/// Beyond the start value and the first minimum the scan ends after this many trials in a row that are worse than
/// [`KEPT`].
const FAILURES: usize = 6;

/// The part of the spin by which trials go to both sides while none describes the data.
const MIN_RANGE: f64 = 0.25;

/// Maximum number of trials on each side.
pub(in crate::fit) const MAX_TRIALS: usize = 100;

/// A minimum that differs from another by less than this, in σ of the spin rate, is the same.
const SAME: f64 = 0.5;

/// Maximum number of times that a better minimum of an offset is moved to.
const MAX_MOVES: usize = 4;

/// The Δχ² above which one of so many minima is excluded. A cycle of noise, of which a minimum makes use, lowers χ² by a
/// value that is above x with the probability exp(−x/2); the lowest of many is so much lower by chance.
fn highest(count: usize) -> f64 {
    2.0 * ln(count as f64 / EXCLUDED)
}

/// Moves a fit to its best minimum and lists the others. Returns a remark on the spins that were tried.
pub(in crate::fit) fn settle(
    fitted: &mut Fitted,
    monitor: &Monitor<'_>,
) -> Result<Option<Note>, FitError> {
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
    Ok(found.scanned.map(|scanned| Note::SpinsTried {
        range: scanned.range,
        is_complete: scanned.is_complete,
    }))
}

/// The minima of an offset that are listed as the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::fit) enum Listed {
    /// All but the best one, to which the fit will move.
    AllButBest,
    /// All but the one that was found, at which the fit stays.
    AllButOwn,
}

/// What a search for other minima has found.
#[derive(Default)]
pub(in crate::fit) struct OtherMinima {
    scanned: Option<ScannedSpins>,
    better: Option<Better>,
}

/// The spin rates at the start that were tried.
struct ScannedSpins {
    /// The lowest and the highest one, rad/s.
    range: [f64; 2],
    /// Whether no minimum beyond them was left untried that the data may not exclude.
    is_complete: bool,
}

/// A minimum of an offset that is better than the one that was found, for the points that both bring into the motion.
struct Better {
    values: Vec<f64>,
    /// Whether the one that was found is excluded.
    excludes_own: bool,
}

/// Lists the other minima of a fit for its points, and moves to the best one of its spin rates.
pub(in crate::fit) fn find(
    fitted: &mut Fitted,
    listed: Listed,
    monitor: &Monitor<'_>,
) -> Result<OtherMinima, FitError> {
    fitted.modes.clear();
    // A fit that has given up has no minimum to compare.
    if !fitted.solution.is_converged {
        return Ok(OtherMinima::default());
    }
    let scanned = find_spin_rates(fitted, monitor)?;
    let mut better = None;
    for clock in offset::clocks(&fitted.problem) {
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
    Ok(OtherMinima { scanned, better })
}

/// Scans the spin rate at the start: from its start value to the minimum that was found, and beyond both. Returns the
/// range of the scan, rad/s.
fn find_spin_rates(
    fitted: &mut Fitted,
    monitor: &Monitor<'_>,
) -> Result<Option<ScannedSpins>, FitError> {
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
    // The other parameters of a minimum far from the data lead astray, and its spin may be on either side.
    let is_far = !describes(problem, points, solution.chi2);
    let from = if is_far {
        problem.start()
    } else {
        solution.values.clone()
    };
    let step = step(problem, points);
    let scan = Scan {
        problem,
        points,
        spin: at,
        centre: from[at],
        range: if is_far {
            MIN_RANGE * from[at].abs()
        } else {
            0.0
        },
        step,
        reach: SAME * solution.covariance[(at, at)].sqrt(),
    };
    let [low, high] = scan.both_sides(&from, solution.chi2, monitor)?;
    let scanned = ScannedSpins {
        range: [low.last(at), high.last(at)],
        is_complete: low.is_complete && high.is_complete,
    };
    let highest = highest(1 + low.trials + high.trials);
    let mut minima = scan.minima(solution, [low, high], highest, monitor)?;
    minima.sort_by(|a, b| a.chi2.total_cmp(&b.chi2));
    // Noise may have favoured another spin than that of the first minimum.
    let best = minima.remove(0);
    if best.values != solution.values {
        let free = vec![false; best.values.len()];
        let moved = minimise(problem, points, &best.values, None, &free, monitor)?;
        *solution = sigma::settle(problem, split, moved, monitor)?;
    }
    minima.retain(|other| other.is_converged && other.chi2 - solution.chi2 < highest);
    for other in &minima {
        modes.push(mode(problem, other, other.chi2 - solution.chi2));
    }
    Ok(Some(scanned))
}

/// Whether a χ² is that of a motion near the data, whose noise is given or seen in the scatter of neighbours.
fn describes(problem: &Problem, points: &[Point], chi2: f64) -> bool {
    /// χ² of noise that is a little larger than it seems.
    const FACTOR: f64 = 1.5;
    let mut expected = 0.0;
    for (index, signal) in problem.signals.iter().enumerate() {
        let own = points.iter().filter(|point| point.signal == index).count() as f64;
        let noise = if signal.is_sigma_estimated {
            signal.scatter() / signal.sigmas[0]
        } else {
            1.0
        };
        expected += own * noise * noise;
    }
    chi2 < FACTOR * expected
}

/// Distance of trial spin rates, rad/s.
fn step(problem: &Problem, points: &[Point]) -> f64 {
    let duration = points.iter().map(|point| point.time).fold(0.0, f64::max);
    let phase_per_rate = problem.scenario.model.top.nutation_frequency(1.0) * duration;
    PHASE_STEP / phase_per_rate
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
    /// The spin rate of the minimum that was found, rad/s.
    centre: f64,
    /// The trials go at least so far to both sides while none describes the data, rad/s.
    range: f64,
    /// Distance of trials, rad/s.
    step: f64,
    /// A minimum that differs by less is the same, rad/s.
    reach: f64,
}

impl Scan<'_> {
    /// Tries spin rates below and above that of the minimum that was found.
    fn both_sides(
        &self,
        from: &[f64],
        chi2: f64,
        monitor: &Monitor<'_>,
    ) -> Result<[SideOfSpins; 2], FitError> {
        let mut low = SideOfSpins::new(-1.0, from, chi2);
        let mut high = SideOfSpins::new(1.0, from, chi2);
        let most = self.problem.step_limit.after(MAX_MOTIONS);
        while !(low.is_over && high.is_over) {
            let (a, b) = rayon::join(|| low.advance(self), || high.advance(self));
            monitor.set_spins(low.trials + high.trials);
            monitor.count(a? + b?, chi2);
            if self.problem.step_limit.taken() > most {
                low.give_up();
                high.give_up();
            }
        }
        Ok([low, high])
    }

    /// The other parameters for which a spin rate describes the data best. `None` if there is no complete motion.
    fn minimum_at(
        &self,
        values: &[f64],
        monitor: &Monitor<'_>,
    ) -> Result<Option<Vec<f64>>, FitError> {
        let Ok(start) = complete(self.problem, self.points, values.to_vec()) else {
            return Ok(None);
        };
        // With a free spin rate at once, the optimiser would fall back into the minimum that is known.
        let mut fixed = vec![false; start.len()];
        fixed[self.spin] = true;
        let held = draft(
            self.problem,
            self.points,
            &start,
            fixed,
            HELD_ITERATIONS,
            monitor,
        )?;
        Ok(Some(held))
    }

    /// The minima that may be kept, each once. `first` is one of them.
    fn minima(
        &self,
        first: &Solution,
        sides: [SideOfSpins; 2],
        highest: f64,
        monitor: &Monitor<'_>,
    ) -> Result<Vec<Solution>, FitError> {
        let highest = sides[0].best.min(sides[1].best) + highest + DRAFT_ERROR;
        let mut drafts: Vec<Draft> = sides.into_iter().flat_map(|side| side.drafts).collect();
        drafts.retain(|draft| draft.loss < highest);
        let mut coarse = self.problem.clone();
        coarse.precision = LISTED_PRECISION;
        let mut minima = vec![first.clone()];
        for part in drafts.chunks(MINIMISED_AT_ONCE) {
            let found: Vec<Result<_, FitError>> = part
                .par_iter()
                .map(|draft| {
                    let silent = Monitor::new(&|_| {});
                    let free = vec![false; draft.values.len()];
                    let minimum =
                        minimise(&coarse, self.points, &draft.values, None, &free, &silent)?;
                    Ok((minimum, silent.evaluations()))
                })
                .collect();
            for result in found {
                let (minimum, evaluations) = result?;
                monitor.count(evaluations, minimum.chi2);
                self.insert(minimum, &mut minima);
            }
        }
        Ok(minima)
    }

    /// Adds a minimum to those that are known, or replaces the same one if it is worse.
    fn insert(&self, minimum: Solution, minima: &mut Vec<Solution>) {
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
}

/// The spin rates that were tried on one side of a minimum.
struct SideOfSpins {
    /// −1 below, 1 above.
    sign: f64,
    /// The last trial.
    values: Vec<f64>,
    /// Number of trials.
    trials: usize,
    /// Number of trials in a row that are much worse than the best.
    failures: usize,
    /// The minima that were found, each once.
    drafts: Vec<Draft>,
    /// The lowest loss of these, and of the minimum from which the scan started.
    best: f64,
    is_over: bool,
    /// Whether it ended before the last trial, at a spin rate that the data or the bounds exclude.
    is_complete: bool,
}

impl SideOfSpins {
    fn new(sign: f64, from: &[f64], chi2: f64) -> Self {
        Self {
            sign,
            values: from.to_vec(),
            trials: 0,
            failures: 0,
            drafts: Vec::new(),
            best: chi2,
            is_over: false,
            is_complete: true,
        }
    }

    /// The last spin rate that was tried, rad/s.
    fn last(&self, spin: usize) -> f64 {
        self.values[spin]
    }

    fn give_up(&mut self) {
        self.is_complete = self.is_over && self.is_complete;
        self.is_over = true;
    }

    /// Tries the next spin rate. Returns the number of simulations.
    fn advance(&mut self, scan: &Scan<'_>) -> Result<u64, FitError> {
        let silent = Monitor::new(&|_| {});
        if self.is_over {
            return Ok(0);
        }
        if self.trials == MAX_TRIALS {
            self.give_up();
            return Ok(0);
        }
        let parameter = &scan.problem.parameters[scan.spin];
        let distance = scan.step * (self.trials + 1) as f64;
        let trial = parameter.clamp(scan.centre + self.sign * distance);
        if trial == self.values[scan.spin] {
            self.is_over = true;
            return Ok(0);
        }
        self.trials += 1;
        if let Some(found) = self.minimum_near(trial, scan) {
            self.values = found;
            self.values[scan.spin] = trial;
            self.failures = 0;
            return Ok(0);
        }
        let mut values = self.values.clone();
        values[scan.spin] = trial;
        let Some(held) = scan.minimum_at(&values, &silent)? else {
            self.is_over = true;
            return Ok(silent.evaluations());
        };
        // The other parameters change little from one trial to the next.
        self.values = held;
        let is_failure = self.is_worse(scan, &silent)?;
        // The start value is what a person knows of the spin: all minima between it and the one that was found count.
        let is_within = distance < scan.range && !describes(scan.problem, scan.points, self.best);
        let counts =
            is_failure && !is_within && distance > self.sign * (parameter.start - scan.centre);
        self.failures = if counts { self.failures + 1 } else { 0 };
        self.is_over = self.failures == FAILURES;
        Ok(silent.evaluations())
    }

    /// The values of the minimum that a trial with this spin rate, rad/s, would find again.
    fn minimum_near(&self, trial: f64, scan: &Scan<'_>) -> Option<Vec<f64>> {
        self.drafts
            .iter()
            .find(|draft| (draft.values[scan.spin] - trial).abs() < COVERED * scan.step)
            .map(|draft| draft.values.clone())
    }

    /// Adds the minimum near the last trial to those that were found; whether it is worse than the best by [`KEPT`].
    fn is_worse(&mut self, scan: &Scan<'_>, monitor: &Monitor<'_>) -> Result<bool, FitError> {
        let highest = self.best + KEPT;
        let Scan {
            problem,
            points,
            spin,
            reach,
            ..
        } = *scan;
        let promising = promising_draft(problem, points, &self.values, highest, KEPT, monitor)?;
        let Some(found) = promising else {
            return Ok(true);
        };
        self.best = self.best.min(found.loss);
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
}
