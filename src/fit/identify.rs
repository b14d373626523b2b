//! What the data can determine, found before anything is fitted: from the sensitivities at the start.

use super::error::FitError;
use super::model::{Effort, Point, Problem, Refusal};
use super::parameter::{Named, Parameter, Target};
use super::solve::error_from;
use super::statistics::ScaledGram;
use crate::run::plural::plural;
use nalgebra::DMatrix;
use std::f64::consts::TAU;

/// Error of the simulated values, relative to their size: the tolerance. Divided by the step of the
/// differences it is the error of a derivative.
const ROUNDING: f64 = 1e-12;

/// An eigenvalue of the scaled JᵀJ below this is zero within the error of the derivatives: its square root is 3e-6.
const NULL: f64 = 1e-11;

/// A component of a direction that is zero within that error.
const NO_COMPONENT: f64 = 1e-3;

/// What the data can determine.
pub(super) struct Identified {
    /// The parameters that the data show.
    pub parameters: Vec<Parameter>,
    /// Sentences on parameters of a group that were left out, and on the sampling.
    pub notes: Vec<String>,
}

/// Checks which parameters the data can determine. Parameters that belong to a group are left out if nothing shows
/// them.
pub(super) fn identify(problem: &Problem, named: &[Named]) -> Result<Identified, FitError> {
    let start = problem.start();
    let points = reached(problem, &start)?;
    let predicted = problem.predict(&start, &points).map_err(error_from)?;
    let fixed = vec![false; start.len()];
    let jacobian = problem.jacobian(Effort::Final, &start, &points, &fixed);
    let noise = derivative_noise(&points, &predicted);
    let (mut shown, mut unseen, mut left_out) = (Vec::new(), Vec::new(), Vec::new());
    let mut scanned = Vec::new();
    for (at, named) in named.iter().enumerate() {
        if norm(&jacobian[at]) * problem.parameters[at].scale > noise {
            shown.push(at);
        } else if named.is_optional {
            left_out.push(named.parameter.name());
        } else if matches!(named.parameter.target, Target::Offset(_)) {
            // The scan finds an offset also if the clocks differ so much that nothing depends on small changes.
            scanned.push(at);
        } else if problem
            .derivative(Effort::Final, at, &start, &points)
            .is_none()
        {
            return Err(FitError::NoDerivative {
                name: named.parameter.name(),
            });
        } else {
            unseen.push(named.parameter.name());
        }
    }
    if !unseen.is_empty() {
        let sentence = format!(
            "no signal depends on {}: fix {} (leave {0} out of --free)",
            unseen.join(" or "),
            if unseen.len() == 1 { "it" } else { "them" },
        );
        return Err(FitError::NotIdentifiable {
            sentences: vec![sentence],
        });
    }
    if shown.is_empty() {
        return Err(FitError::NothingFree);
    }
    let hardly_shown = leave_out_weak(problem, named, &jacobian, &mut shown);
    if shown.is_empty() {
        return Err(FitError::NothingFree);
    }
    let gram = gram(&jacobian, &shown);
    let mut parameters: Vec<Parameter> = Vec::new();
    for at in &shown {
        parameters.push(problem.parameters[*at].clone());
    }
    let mut free = parameters.clone();
    for at in scanned {
        free.push(problem.parameters[at].clone());
    }
    let sentences = degeneracies(&parameters, &ScaledGram::new(&gram));
    if !sentences.is_empty() {
        return Err(FitError::NotIdentifiable { sentences });
    }
    let mut notes = Vec::new();
    if !left_out.is_empty() {
        notes.push(format!(
            "No signal depends on {}: kept at the scenario's {}.",
            left_out.join(" or "),
            plural(left_out.len() as u64, "value"),
        ));
    }
    if !hardly_shown.is_empty() {
        notes.push(format!(
            "The signals hardly depend on {}: kept at the scenario's {}, so the other estimates presuppose {}.",
            listed(&hardly_shown),
            plural(hardly_shown.len() as u64, "value"),
            if hardly_shown.len() == 1 { "it" } else { "them" },
        ));
    }
    notes.extend(aliasing(problem));
    Ok(Identified {
        parameters: free,
        notes,
    })
}

/// The size of a column of derivatives, times the scale of its parameter, that errors of the simulation can make.
fn derivative_noise(points: &[Point], predicted: &[f64]) -> f64 {
    let pairs = points.iter().zip(predicted);
    let sizes = pairs.map(|(point, value)| value.abs() / point.sigma);
    let largest = sizes.fold(0.0, f64::max);
    (points.len() as f64).sqrt() * largest * ROUNDING / Effort::Final.step()
}

/// JᵀJ of some columns.
fn gram(jacobian: &[Vec<f64>], columns: &[usize]) -> DMatrix<f64> {
    DMatrix::from_fn(columns.len(), columns.len(), |i, j| {
        let pairs = jacobian[columns[i]].iter().zip(&jacobian[columns[j]]);
        pairs.map(|(a, b)| a * b).sum()
    })
}

/// Takes out parameters of a group that the data determine less well than the weak priors: such directions have no
/// minimum that could be found. Directions that involve a parameter that was named by itself stay.
fn leave_out_weak(
    problem: &Problem,
    named: &[Named],
    jacobian: &[Vec<f64>],
    shown: &mut Vec<usize>,
) -> Vec<String> {
    /// Square of a component above which a parameter is involved in a direction.
    const INVOLVED: f64 = 0.01;
    let mut left_out = Vec::new();
    while !shown.is_empty() {
        let gram = gram(jacobian, shown);
        let prior = |at: usize| problem.parameters[shown[at]].prior;
        let in_priors = DMatrix::from_fn(shown.len(), shown.len(), |i, j| {
            gram[(i, j)] * prior(i) * prior(j)
        });
        let eigen = in_priors.symmetric_eigen();
        let weakest = eigen.eigenvalues.imin();
        if eigen.eigenvalues[weakest] >= 1.0 {
            return left_out;
        }
        let direction = eigen.eigenvectors.column(weakest);
        let is_of_group = |at: &usize| named[shown[*at]].is_optional;
        let mut involved = (0..shown.len()).filter(|at| direction[*at] * direction[*at] > INVOLVED);
        if !involved.all(|at| is_of_group(&at)) {
            return left_out;
        }
        let worst = direction.map(f64::abs).imax();
        left_out.push(problem.parameters[shown.remove(worst)].name());
    }
    left_out
}

/// The points that the motion at the start reaches.
fn reached(problem: &Problem, start: &[f64]) -> Result<Vec<Point>, FitError> {
    match problem.predict(start, &problem.points) {
        Ok(_) => Ok(problem.points.clone()),
        Err(Refusal::Ends {
            time,
            reason,
            needed,
        }) => {
            // Changed parameters may end the motion slightly earlier.
            let end = 0.98 * time;
            let mut points = problem.points.clone();
            points.retain(|point| problem.model_time(start, point) < end);
            if points.len() > problem.parameters.len() {
                return Ok(points);
            }
            Err(error_from(Refusal::Ends {
                time,
                reason,
                needed,
            }))
        }
        Err(refusal) => Err(error_from(refusal)),
    }
}

fn norm(column: &[f64]) -> f64 {
    column.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Sentences on the directions along which the data don't change.
fn degeneracies(parameters: &[Parameter], gram: &ScaledGram) -> Vec<String> {
    let directions = gram.null_directions(NULL);
    if directions.is_empty() {
        return Vec::new();
    }
    // Relative changes of the parameters along a direction; absolute ones where the start is 0.
    let relative = |direction: &[f64]| -> Vec<f64> {
        let mut changes = Vec::new();
        for (at, parameter) in parameters.iter().enumerate() {
            let unit = if parameter.start == 0.0 {
                parameter.scale
            } else {
                parameter.start
            };
            changes.push(direction[at] / gram.norms[at] / unit);
        }
        changes
    };
    let [direction] = &directions[..] else {
        let mut involved = Vec::new();
        for (at, parameter) in parameters.iter().enumerate() {
            if directions.iter().any(|d| d[at].abs() > NO_COMPONENT) {
                involved.push(parameter.name());
            }
        }
        let known = involved.len() - directions.len();
        return vec![format!(
            "of {} only {known} {} determined: fix {} of them",
            listed(&involved),
            if known == 1 {
                "combination is"
            } else {
                "combinations are"
            },
            directions.len(),
        )];
    };
    let changes = relative(direction);
    let largest = changes.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    let mut involved: Vec<(usize, f64)> = Vec::new();
    for (at, change) in changes.iter().enumerate() {
        if change.abs() > NO_COMPONENT * largest {
            involved.push((at, *change));
        }
    }
    let name = |at: usize| parameters[at].name();
    match involved[..] {
        [(a, x), (b, y)] if parameters[a].start > 0.0 && parameters[b].start > 0.0 => {
            let power = -x / y;
            let [first, second] = [a, b].map(|at| parameters[at].symbol());
            let (combination, motion) = if (power - 1.0).abs() < 0.01 {
                let same = format!("{first} × 2 and {second} ÷ 2 is the same motion");
                (format!("{first}·{second}"), same)
            } else if (power + 1.0).abs() < 0.01 {
                let same = format!("{first} × 2 and {second} × 2 is the same motion");
                (format!("{first}/{second}"), same)
            } else {
                let same = format!("{first} and {second} can change together");
                (format!("a combination of {first} and {second}"), same)
            };
            let names = [name(a), name(b)];
            vec![format!(
                "only {combination} is determined ({motion}): fix {}",
                names.join(" or ")
            )]
        }
        _ => {
            let names: Vec<String> = involved.iter().map(|(at, _)| name(*at)).collect();
            vec![format!(
                "{} can change together without any effect: fix one of them",
                listed(&names)
            )]
        }
    }
}

/// Names as a list with "and".
fn listed(names: &[String]) -> String {
    match names {
        [rest @ .., last] if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        _ => names.concat(),
    }
}

/// A sentence if a signal is sampled too slowly for the nutation.
fn aliasing(problem: &Problem) -> Option<String> {
    let scenario = &problem.scenario;
    let tilt = crate::physics::kinematics::Tilt::from_rates(scenario.angles.theta, scenario.rates);
    let top = &scenario.model.top;
    // A small nutation turns with the angular momentum about the axis, divided by I_x.
    let nutation = (top.axial_moment * tilt.axial_rate() / top.transverse_moment).abs() / TAU;
    let periods = problem.signals.iter().filter_map(super::Signal::period);
    let rate = 1.0 / periods.fold(0.0, f64::max);
    (rate < 2.0 * nutation).then(|| {
        format!(
            "The nutation at {nutation:.1} Hz is sampled at {rate:.1} Hz: it appears at other frequencies, and there may be several solutions."
        )
    })
}

/// Whether the precession or the spin is measured, and not the inclination alone.
pub(super) fn measures_more_than_theta(problem: &Problem) -> bool {
    use crate::telemetry::fields::state;
    let theta = [state::THETA, state::THETA_DOT, state::THETA_DDOT];
    problem.signals.iter().any(|s| !theta.contains(&s.field))
}

/// The index of the spin rate at the start among the parameters.
pub(super) fn spin_rate(problem: &Problem) -> Option<usize> {
    let mut parameters = problem.parameters.iter();
    parameters.position(|p| matches!(p.target, Target::Key(key) if key.path == "initial.psi_dot"))
}
