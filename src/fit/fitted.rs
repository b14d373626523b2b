//! The fit of one law, before it is reported.

use super::compare::Refused;
use super::error::FitError;
use super::estimate::quality;
use super::model::{Point, Problem};
use super::prepare::{Prepared, prepare};
use super::report::{Mode, Quality};
use super::solve::{Solution, Watch, error_from, grow, refused_step};
use super::{Request, law, modes, offset, sigma};

/// Points to fit and points to predict.
#[derive(Clone, Debug)]
pub(super) struct Split {
    pub fitted: Vec<Point>,
    pub held_out: Vec<Point>,
    /// End of the fitted part, s.
    pub end: f64,
    /// End of the data of the first file, s.
    pub last: f64,
}

/// The fit of one law.
#[derive(Clone, Debug)]
pub(super) struct Fitted {
    pub problem: Problem,
    pub solution: Solution,
    pub split: Split,
    /// The other minima that the data don't exclude.
    pub modes: Vec<Mode>,
}

impl Fitted {
    /// The name of the law.
    pub(super) fn law(&self) -> &str {
        self.problem.scenario.word("friction.law")
    }

    pub(super) fn quality(&self) -> Quality {
        quality(&self.problem, &self.split.fitted, &self.solution)
    }
}

/// The first law that can be fitted.
pub(super) struct First {
    pub fitted: Fitted,
    pub notes: Vec<String>,
    /// Time in the data at which the scenario starts, s.
    pub origin: f64,
    /// The laws that were tried before it.
    pub refused: Vec<Refused>,
}

/// Fits the scenario's law. If its motion ends before the data and other laws are to be compared, the first of these
/// that can be fitted takes its place.
pub(super) fn first(request: &Request, watch: &Watch<'_>) -> Result<First, FitError> {
    let laws = law::find_laws(&request.compare)?;
    let failure = match fit_law(request, watch) {
        Err(error @ FitError::ModelEnds { .. }) => error,
        other => return other,
    };
    let own = request.scenario.word("friction.law");
    let mut refused = Vec::new();
    if let Some(law) = law::find(own) {
        refused.push(Refused {
            law: law.name,
            reason: failure.to_string(),
        });
    }
    for law in laws.into_iter().filter(|law| law.name != own) {
        let other = law::request_for(request, law)?;
        match fit_law(&other, watch) {
            Ok(first) => return Ok(First { refused, ..first }),
            Err(error @ FitError::ModelEnds { .. }) => refused.push(Refused {
                law: law.name,
                reason: error.to_string(),
            }),
            Err(error) => return Err(error),
        }
    }
    Err(failure)
}

/// Fits the law of a request's scenario.
fn fit_law(request: &Request, watch: &Watch<'_>) -> Result<First, FitError> {
    let Prepared {
        mut problem,
        notes,
        origin,
    } = prepare(request)?;
    let (solution, split) = solve_all(&mut problem, request, watch)?;
    if !solution.is_converged
        && let Some(refusal) = refused_step(&problem, &split.fitted, &solution)
    {
        return Err(error_from(refusal));
    }
    let modes = modes::modes(&problem, &split.fitted, &solution, watch)?;
    Ok(First {
        fitted: Fitted {
            problem,
            solution: modes.best,
            split,
            modes: modes.others,
        },
        notes,
        origin,
        refused: Vec::new(),
    })
}

/// Fits all signals; estimates standard deviations that are not given.
fn solve_all(
    problem: &mut Problem,
    request: &Request,
    watch: &Watch<'_>,
) -> Result<(Solution, Split), FitError> {
    let mut split = split_first_file(problem, request.holdout);
    let has_offsets = request.data.files > 1;
    let start = problem.start();
    let mut solution = grow(problem, &split.fitted, &start, has_offsets, watch)?;
    if has_offsets {
        let (joint, points) = offset::fit_offsets(problem, solution.values, split.end, watch)?;
        solution = joint;
        split.fitted = points;
        hold_out_other_files(problem, &solution, &mut split);
    }
    let solution = sigma::settle(problem, &mut split, solution, watch)?;
    Ok((solution, split))
}

/// Holds out the points of the other files in the time in which those of the first are.
fn hold_out_other_files(problem: &Problem, solution: &Solution, split: &mut Split) {
    for point in &problem.points {
        let time = problem.model_time(&solution.values, point);
        let is_held_out = time > split.end && time <= split.last;
        if problem.signals[point.signal].file > 0 && is_held_out {
            split.held_out.push(*point);
        }
    }
}

/// The points of the first file, whose clock is the model's.
fn split_first_file(problem: &Problem, holdout: f64) -> Split {
    let mut first: Vec<Point> = Vec::new();
    for point in &problem.points {
        if problem.signals[point.signal].file == 0 {
            first.push(*point);
        }
    }
    let last = first.iter().map(|point| point.time).fold(0.0, f64::max);
    let end = last * (1.0 - holdout);
    let (fitted, held_out) = first.into_iter().partition(|point| point.time <= end);
    Split {
        fitted,
        held_out,
        end,
        last,
    }
}
