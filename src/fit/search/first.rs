//! The first fit of a request: of the scenario's law, or of another if that has no complete motion.

use super::fitted::{Fitted, Split};
use super::monitor::Monitor;
use super::solve::{Solution, grow_window, refused_step};
use super::spin_guess::start_with_measured_spin;
use super::step_limit::MAX_MOTIONS;
use super::{modes, offset, sigma};
use crate::fit::apart::Apart;
use crate::fit::error::FitError;
use crate::fit::failure::Failure;
use crate::fit::note::Note;
use crate::fit::problem::law;
use crate::fit::problem::law::Refused;
use crate::fit::problem::meeting;
use crate::fit::problem::model::Problem;
use crate::fit::problem::prepare::{self, Prepared, prepare};
use crate::fit::problem::request::Request;
use crate::fit::report::Verdict;

/// χ² per value above which a minimum may be that of another phase of the nutation; wrong models and standard deviations
/// give less, as a rule.
const FAR: f64 = 100.0;

/// The motions whose steps a search may take that starts with the spin of the data: these took the steps of 40 to 310.
const NEAR_MOTIONS: u64 = MAX_MOTIONS / 2;

/// The part of the data that a model must reach for advice to fit only this part.
const MIN_PART: f64 = 0.25;

/// The first law that can be fitted.
pub(in crate::fit) struct First {
    pub fitted: Fitted,
    pub notes: Vec<Note>,
    /// Time in the data at which the scenario starts, s.
    pub origin: f64,
    /// The laws that were tried before it.
    pub refused: Vec<Refused>,
}

/// Fits the scenario's law. If its motion ends before the data and other laws are to be compared, the first of these
/// that can be fitted takes its place.
pub(in crate::fit) fn first(request: &Request, monitor: &Monitor<'_>) -> Result<First, FitError> {
    // A wrong name is reported before anything is fitted.
    let laws = law::find_laws(&request.compare)?;
    // Another law can help only where the motion ends too early.
    let failure = match fit_law(request, monitor) {
        Err(error) if error.is_of_motion() || error.is_of_law() => error,
        other => return other,
    };
    let own = request.scenario.word("friction.law");
    let mut refused = Vec::new();
    // Another law may contain the motion in which parameters of this one have no effect.
    if let Some(law) = law::find(own).filter(|_| failure.is_of_motion()) {
        refused.push(Refused {
            law: law.name,
            reason: Failure::from(&failure),
        });
    }
    for law in laws.into_iter().filter(|law| law.name != own) {
        let other = law::request_for(request, law)?;
        match fit_law(&other, monitor) {
            Ok(first) => return Ok(First { refused, ..first }),
            Err(error) if error.is_of_motion() => refused.push(Refused {
                law: law.name,
                reason: Failure::from(&error),
            }),
            Err(error) => return Err(error),
        }
    }
    Err(with_tried_advice(failure, request, monitor))
}

/// An error with advice that a fit has followed with success.
fn with_tried_advice(error: FitError, request: &Request, monitor: &Monitor<'_>) -> FitError {
    let succeeds = |origin: Option<f64>, until: Option<f64>| {
        let mut advised = request.clone();
        advised.origin = origin.or(request.origin);
        advised.until = until.or(request.until);
        let fitted = fit_law(&advised, monitor);
        fitted.is_ok_and(|first| first.fitted.verdict() == Verdict::Fitted)
    };
    match error {
        FitError::ModelEnds {
            end,
            reason,
            needed,
            ..
        } if end > MIN_PART * needed => {
            let origin = prepare::origin(request).unwrap_or_default();
            // A later end would be after that of the model.
            let until = origin + (end * 1e3).floor() / 1e3;
            FitError::ModelEnds {
                end,
                reason,
                needed,
                until: Some(until).filter(|until| succeeds(None, Some(*until))),
            }
        }
        FitError::Apart { seen, .. } => FitError::Apart {
            seen,
            is_tried: match seen {
                Apart::RestBefore { until } => succeeds(Some(until), None),
                Apart::RestAfter { from } => succeeds(None, Some(from)),
                Apart::Rest | Apart::Precession { .. } | Apart::Unlike => false,
            },
        },
        error => error,
    }
}

/// Fits the law of a request's scenario.
fn fit_law(request: &Request, monitor: &Monitor<'_>) -> Result<First, FitError> {
    let Prepared {
        mut problem,
        mut notes,
        origin,
    } = prepare(request)?;
    let (solution, split) = solve_from_any(&mut problem, &mut notes, request, monitor)?;
    if problem.step_limit.is_exceeded() && !solution.is_converged {
        notes.push(Note::GivenUp {
            motions: MAX_MOTIONS,
        });
    }
    if !solution.is_converged
        && let Some(refusal) = refused_step(&problem, &split.fitted, &solution)
    {
        return Err(refusal);
    }
    // What follows a minimum is bounded by itself.
    problem.step_limit.lift();
    let mut fitted = Fitted {
        problem,
        solution,
        split,
        modes: Vec::new(),
    };
    let scanned = modes::settle(&mut fitted, monitor)?;
    // A minimum far from the data is that of another spin, and says nothing about the model.
    if scanned.is_some() && fitted.verdict() == Verdict::BadFit {
        fitted.solution.is_converged = false;
        fitted.modes.clear();
    }
    notes.extend(scanned);
    fitted.align_held_out();
    Ok(First {
        fitted,
        notes,
        origin,
        refused: Vec::new(),
    })
}

/// Whether the motion of a minimum is far from the data, whose errors are known.
fn is_far(problem: &Problem, solution: &Solution, split: &Split) -> bool {
    let knows_errors = !problem
        .signals
        .iter()
        .any(|signal| signal.is_sigma_estimated);
    knows_errors && solution.chi2 > FAR * split.fitted.len() as f64
}

/// Whether another minimum is better than what was found; any is better than none.
fn is_better(other: &Solution, found: &Result<(Solution, Split), FitError>) -> bool {
    match found {
        Ok((solution, _)) if solution.is_converged => other.chi2 < solution.chi2,
        Ok(_) | Err(_) => true,
    }
}

/// Fits all signals, from the start of the request or, if that leads nowhere, with the spin that the precession shows.
fn solve_from_any(
    problem: &mut Problem,
    notes: &mut Vec<Note>,
    request: &Request,
    monitor: &Monitor<'_>,
) -> Result<(Solution, Split), FitError> {
    let unsolved = problem.clone();
    let solved = solve_all(problem, request, &unsolved.start(), MAX_MOTIONS, monitor);
    let leads_nowhere = match &solved {
        Ok((solution, split)) => !solution.is_converged || is_far(problem, solution, split),
        Err(error) => error.is_of_motion(),
    };
    let guess = start_with_measured_spin(&unsolved);
    let Some(start) = guess.filter(|_| leads_nowhere) else {
        return solved.map_err(|error| explain(error, problem));
    };
    let mut again = unsolved;
    match solve_all(&mut again, request, &start.values, NEAR_MOTIONS, monitor) {
        Ok((solution, split)) if solution.is_converged && is_better(&solution, &solved) => {
            *problem = again;
            notes.push(Note::Restarted { spin: start.spin });
            Ok((solution, split))
        }
        Err(error) if !error.is_of_motion() => Err(error),
        Ok(_) | Err(_) => solved.map_err(|error| explain(error, problem)),
    }
}

/// An error with what is seen of data that no motion is like.
fn explain(error: FitError, problem: &Problem) -> FitError {
    match error {
        FitError::Apart {
            seen: Apart::Unlike,
            ..
        } => meeting::explained(problem).into(),
        error => error,
    }
}

/// Fits all signals; estimates standard deviations that are not given.
fn solve_all(
    problem: &mut Problem,
    request: &Request,
    start: &[f64],
    max_motions: u64,
    monitor: &Monitor<'_>,
) -> Result<(Solution, Split), FitError> {
    let mut split = Split::on_clock(problem, request.holdout);
    let clocks = 1 + offset::clocks(problem).len() as u64;
    let has_offsets = clocks > 1;
    problem.limit_steps(&split.fitted, max_motions * clocks);
    // The points on the model's clock give a motion with which the other clocks are compared.
    let mut solution = grow_window(problem, &mut split.fitted, start, has_offsets, monitor)?;
    if has_offsets {
        let (joint, points) = offset::fit_offsets(problem, solution.values, &split, monitor)?;
        split.fit_points(problem, &joint.values, points);
        solution = joint;
    }
    let solution = sigma::settle(problem, &mut split, solution, monitor)?;
    Ok((solution, split))
}
