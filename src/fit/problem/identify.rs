//! What the data can determine, found before anything is fitted: from the sensitivities at the start.

use super::degeneracy::{Combination, Degeneracy};
use super::model::{Effort, Point, Problem, Refusal};
use super::parameter::{Parameter, SelectedParameter, Target};
use crate::fit::error::{FitError, change_start, nothing_free, too_few};
use crate::fit::note::{KeptParameter, Note};
use crate::fit::statistics::{NULL_EIGENVALUE, ScaledGram};
use crate::measured::Signal;
use crate::physics::kinematics::Tilt;
use crate::run::scenario::Scenario;
use crate::words::{Piece, Sentence, sentence};
use nalgebra::DMatrix;
use std::f64::consts::TAU;

/// Error of the simulated values, relative to their size: the tolerance. Divided by the step of the
/// differences it is the error of a derivative.
const ROUNDING: f64 = 1e-12;

/// An eigenvalue that is zero within the error of one-sided derivatives, 1e-4.
const ONE_SIDED_EIGENVALUE: f64 = 1e-8;

/// A component of a direction without effect that is zero: well above the error of the derivatives, 1e-5 or less.
const NO_COMPONENT: f64 = 1e-3;

/// What the data can determine.
pub(in crate::fit) struct Identified {
    /// The parameters that the data show.
    pub parameters: Vec<Parameter>,
    /// Parameters of a group that the data show less well than their priors do: they are kept at their start.
    pub kept: Vec<Parameter>,
    /// Remarks on parameters of a group that were left out.
    pub notes: Vec<Note>,
}

/// Checks which parameters the data can determine. Parameters that belong to a group are left out if nothing shows
/// them.
pub(in crate::fit) fn identify(
    problem: &Problem,
    selected: &[SelectedParameter],
) -> Result<Identified, FitError> {
    let start = problem.start();
    let points = reached(problem, &start)?;
    let predicted = problem.predict(&start, &points)?;
    let fixed = vec![false; start.len()];
    let jacobian = problem.jacobian(Effort::Final, &start, &predicted, &points, &fixed);
    let noise = derivative_noise(&points, &predicted);
    let Visibility {
        mut shown,
        scanned,
        unseen,
        left_out,
    } = visibility(problem, selected, &jacobian, noise);
    // Without any effect, and without one that can be computed, are different things to mend.
    for at in &unseen {
        if problem
            .derivative(Effort::Final, *at, &start, &predicted, &points)
            .is_none()
        {
            return Err(problem.parameters[*at].error(sentence!(
                "no motion with a slightly larger or smaller value can be computed; {}",
                change_start()
            )));
        }
    }
    if !unseen.is_empty() {
        let names = unseen
            .iter()
            .map(|at| problem.parameters[*at].name())
            .collect();
        return Err(not_identifiable(&[Degeneracy::Unseen { names }]));
    }
    if shown.is_empty() {
        return Err(nothing_free());
    }
    // Fewer samples than parameters always leave some undetermined: that says nothing about these parameters.
    let is_too_few = points.len() <= shown.len();
    let too_few = too_few(points.len(), shown.len());
    let hardly_shown = leave_out_weak(problem, selected, &jacobian, &mut shown);
    if shown.is_empty() && is_too_few {
        return Err(too_few);
    }
    if shown.is_empty() {
        return Err(nothing_free());
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
    // One-sided derivatives, at a bound, are less exact.
    let is_at_bound = parameters
        .iter()
        .any(|parameter| parameter.start == parameter.bounds[0]);
    let zero = if is_at_bound {
        ONE_SIDED_EIGENVALUE
    } else {
        NULL_EIGENVALUE
    };
    let mut degeneracies = degeneracies(&parameters, &ScaledGram::new(&gram), zero);
    if !degeneracies.is_empty() && is_too_few {
        return Err(too_few);
    }
    if !degeneracies.is_empty() {
        for degeneracy in &mut degeneracies {
            if let Degeneracy::Combined {
                names,
                combination,
                is_exact,
                delta_chi2,
                ..
            } = degeneracy
            {
                let compared = compare_motions(problem, &points, &predicted, names, *combination);
                *is_exact = compared.is_some_and(Effects::are_of_one_motion);
                *delta_chi2 = compared.map(|effects| effects.together * effects.together);
            }
        }
        return Err(not_identifiable(&degeneracies));
    }
    let mut notes = Vec::new();
    if !left_out.is_empty() {
        notes.push(Note::Unseen {
            parameters: left_out,
        });
    }
    let kept: Vec<Parameter> = hardly_shown
        .into_iter()
        .map(|at| problem.parameters[at].clone())
        .collect();
    if !kept.is_empty() {
        notes.push(Note::Kept {
            parameters: kept.iter().map(KeptParameter::from).collect(),
        });
    }
    Ok(Identified {
        parameters: free,
        kept,
        notes,
    })
}

/// The error of parameters that the data can't tell apart.
fn not_identifiable(degeneracies: &[Degeneracy]) -> FitError {
    let clauses = Sentence::join(degeneracies.iter().map(Degeneracy::sentence), "; ");
    let reason = match degeneracies.first() {
        Some(first) => sentence!(
            "{}; fix {} (leave out of {} what is known)",
            clauses,
            first.fixed(),
            Piece::argument("free")
        ),
        None => clauses,
    };
    match degeneracies {
        [Degeneracy::Unseen { names }] if names.len() == 1 => FitError::of_key(&names[0], reason),
        _ => FitError::refused(reason),
    }
}

/// What the signals show of the parameters: indices, and names of those that are left out.
struct Visibility {
    /// The parameters that the signals depend on.
    shown: Vec<usize>,
    /// Offsets of clocks without an effect here.
    scanned: Vec<usize>,
    /// Parameters that were named, but have no effect.
    unseen: Vec<usize>,
    /// Parameters of a group without an effect.
    left_out: Vec<String>,
}

/// Finds the parameters whose columns of derivatives are more than noise.
fn visibility(
    problem: &Problem,
    selected: &[SelectedParameter],
    jacobian: &[Vec<f64>],
    noise: f64,
) -> Visibility {
    let mut found = Visibility {
        shown: Vec::new(),
        scanned: Vec::new(),
        unseen: Vec::new(),
        left_out: Vec::new(),
    };
    for (at, selected) in selected.iter().enumerate() {
        if norm(&jacobian[at]) * problem.parameters[at].scale > noise {
            found.shown.push(at);
        } else if selected.is_optional {
            found.left_out.push(selected.parameter.name());
        } else if matches!(selected.parameter.target, Target::Offset(_)) {
            // The scan finds an offset also if the clocks differ so much that nothing depends on small changes.
            found.scanned.push(at);
        } else {
            found.unseen.push(at);
        }
    }
    found
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

/// Removes the parameters of a group that the data determine less well than the weak priors from `shown`, and returns
/// them: such directions have no minimum that could be found. Directions that involve a parameter that was named
/// by itself stay.
fn leave_out_weak(
    problem: &Problem,
    selected: &[SelectedParameter],
    jacobian: &[Vec<f64>],
    shown: &mut Vec<usize>,
) -> Vec<usize> {
    /// Square of a component above which a parameter is involved in a direction.
    const INVOLVED: f64 = 0.01;
    let mut left_out = Vec::new();
    // Each removal changes the directions of the others.
    while !shown.is_empty() {
        let gram = gram(jacobian, shown);
        // In units of the priors, their own information is 1 in every direction.
        let in_priors = DMatrix::from_fn(shown.len(), shown.len(), |i, j| {
            let [row, column] = [i, j].map(|index| &problem.parameters[shown[index]]);
            gram[(i, j)] * row.prior * column.prior
        });
        let eigen = in_priors.symmetric_eigen();
        let weakest = eigen.eigenvalues.imin();
        if eigen.eigenvalues[weakest] >= 1.0 {
            return left_out;
        }
        let direction = eigen.eigenvectors.column(weakest);
        for (component, at) in direction.iter().zip(&*shown) {
            if component * component > INVOLVED && !selected[*at].is_optional {
                return left_out;
            }
        }
        let worst = direction.map(f64::abs).imax();
        left_out.push(shown.remove(worst));
    }
    left_out
}

/// The points that the motion at the start reaches.
fn reached(problem: &Problem, start: &[f64]) -> Result<Vec<Point>, FitError> {
    let Err(refusal) = problem.predict(start, &problem.points) else {
        return Ok(problem.points.clone());
    };
    if let Refusal::Ends { time, .. } = refusal {
        // Changed parameters may end the motion slightly earlier.
        let end = 0.98 * time;
        let mut points = problem.points.clone();
        points.retain(|point| problem.model_time(start, point) < end);
        if points.len() > problem.parameters.len() {
            return Ok(points);
        }
    }
    Err(refusal.into())
}

fn norm(column: &[f64]) -> f64 {
    column.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// The directions along which the data don't change.
fn degeneracies(parameters: &[Parameter], gram: &ScaledGram, zero: f64) -> Vec<Degeneracy> {
    let directions = gram.null_directions(zero);
    match &directions[..] {
        [] => Vec::new(),
        [direction] => vec![degeneracy(
            parameters,
            &relative_changes(parameters, gram, direction),
        )],
        // Eigenvectors of equal eigenvalues are any basis of their plane: only who takes part in it is certain.
        _ => {
            let mut names = Vec::new();
            for (at, parameter) in parameters.iter().enumerate() {
                if directions.iter().any(|d| d[at].abs() > NO_COMPONENT) {
                    names.push(parameter.name());
                }
            }
            vec![Degeneracy::Several {
                names,
                directions: directions.len(),
            }]
        }
    }
}

/// Effects of a change of two parameters by 1 %, in standard deviations.
#[derive(Clone, Copy, Debug)]
struct Effects {
    /// The first parameter alone.
    alone: f64,
    /// Both, so that their combination stays the same.
    together: f64,
}

impl Effects {
    /// Whether the motion stays the same if the combination does.
    fn are_of_one_motion(self) -> bool {
        /// Part of the effect of one parameter alone that is an error of the simulation: it is 1e-9 or less after a
        /// minute, and the effect about 1e-2.
        const SAME: f64 = 1e-6;
        self.together < SAME * self.alone
    }
}

/// Changes one parameter, then two whose combination stays the same. `None` if such motions can't be computed.
fn compare_motions(
    problem: &Problem,
    points: &[Point],
    predicted: &[f64],
    names: &[String; 2],
    combination: Combination,
) -> Option<Effects> {
    /// A change whose effect is more than linear.
    const FACTOR: f64 = 1.01;
    let other = match combination {
        Combination::Product => 1.0 / FACTOR,
        Combination::Quotient => FACTOR,
        Combination::Other => return None,
    };
    let mut alone = problem.start();
    let mut together = problem.start();
    for (at, parameter) in problem.parameters.iter().enumerate() {
        if parameter.name() == names[0] {
            alone[at] *= FACTOR;
            together[at] *= FACTOR;
        } else if parameter.name() == names[1] {
            together[at] *= other;
        }
    }
    Some(Effects {
        alone: effect(problem, points, predicted, &alone)?,
        together: effect(problem, points, predicted, &together)?,
    })
}

/// The size of the difference between a motion and the predicted one, in standard deviations.
fn effect(problem: &Problem, points: &[Point], predicted: &[f64], values: &[f64]) -> Option<f64> {
    let moved = problem.predict(values, points).ok()?;
    let mut differences = Vec::new();
    for ((point, moved), before) in points.iter().zip(moved).zip(predicted) {
        differences.push((moved - before) / point.sigma);
    }
    Some(norm(&differences))
}

/// Relative changes of the parameters along a direction; absolute ones, in units of the scale, where the start is 0.
fn relative_changes(parameters: &[Parameter], gram: &ScaledGram, direction: &[f64]) -> Vec<f64> {
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
}

/// What the parameters that change along a single direction have in common.
fn degeneracy(parameters: &[Parameter], changes: &[f64]) -> Degeneracy {
    /// Difference of a power from ±1 that is an error of the derivatives.
    const SAME_POWER: f64 = 0.01;
    let largest = changes.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    let mut involved: Vec<(&Parameter, f64)> = Vec::new();
    for (parameter, change) in parameters.iter().zip(changes) {
        if change.abs() > NO_COMPONENT * largest {
            involved.push((parameter, *change));
        }
    }
    match involved[..] {
        [(a, x), (b, y)] if a.start > 0.0 && b.start > 0.0 => {
            // a^p b is constant along the direction, with p = −(db/b)/(da/a) or its inverse: both are ±1 together.
            let power = -x / y;
            Degeneracy::Combined {
                names: [a.name(), b.name()],
                symbols: [a.symbol(), b.symbol()],
                // The direction is that of small changes.
                is_exact: false,
                delta_chi2: None,
                combination: if (power - 1.0).abs() < SAME_POWER {
                    Combination::Product
                } else if (power + 1.0).abs() < SAME_POWER {
                    Combination::Quotient
                } else {
                    Combination::Other
                },
            }
        }
        _ => Degeneracy::Together {
            names: involved
                .iter()
                .map(|(parameter, _)| parameter.name())
                .collect(),
        },
    }
}

/// A remark if a signal is sampled too slowly for the nutation of this motion.
pub(in crate::fit) fn aliasing(signals: &[Signal], motion: &Scenario) -> Option<Note> {
    let tilt = Tilt::from_rates(motion.angles.theta, motion.rates);
    let top = &motion.model.top;
    let nutation = top.nutation_frequency(tilt.axial_rate()).abs() / TAU;
    let periods = signals.iter().filter_map(Signal::period);
    let rate = 1.0 / periods.fold(0.0, f64::max);
    (rate < 2.0 * nutation).then_some(Note::Aliased {
        nutation,
        sampling: rate,
    })
}

/// Whether the precession or the spin is measured, and not the inclination alone.
pub(in crate::fit) fn measures_more_than_theta(problem: &Problem) -> bool {
    use crate::telemetry::fields::state;
    let theta = [state::THETA, state::THETA_DOT, state::THETA_DDOT];
    problem.signals.iter().any(|s| !theta.contains(&s.field))
}

/// The index of the spin rate at the start among the parameters.
pub(in crate::fit) fn spin_rate(problem: &Problem) -> Option<usize> {
    let mut parameters = problem.parameters.iter();
    parameters.position(|p| matches!(p.target, Target::Key(key) if key.path == "initial.psi_dot"))
}
