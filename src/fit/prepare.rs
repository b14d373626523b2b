//! From a request to a problem, with the checks that come before a fit.

use super::error::FitError;
use super::model::Problem;
use super::request::Request;
use super::signal::Signal;
use super::{identify, parameter};
use crate::telemetry::fields::state;

/// A problem whose data determine its parameters.
pub(super) struct Prepared {
    pub problem: Problem,
    /// Remarks on the data and on what they determine.
    pub notes: Vec<String>,
    /// Time in the data at which the scenario starts, s.
    pub origin: f64,
}

/// The problem of a request, after the check of what its data can determine.
pub(super) fn prepare(request: &Request) -> Result<Prepared, FitError> {
    let scenario = &request.scenario;
    let data = &request.data;
    let selected = parameter::select(&request.free, &request.bounds, scenario, data.files)?;
    let parameters = selected
        .iter()
        .map(|selected| selected.parameter.clone())
        .collect();
    let origin = request.origin.unwrap_or_else(|| data.origin());
    let mut signals = data.signals.clone();
    // An angle may be measured from another whole turn than the scenario's start.
    for signal in &mut signals {
        for (field, start) in [
            (state::PHI, scenario.angles.phi),
            (state::PSI, scenario.angles.psi),
        ] {
            if signal.field == field {
                signal.turn_towards(start);
            }
        }
    }
    check_values(&signals)?;
    let mut problem = Problem::new(scenario, parameters, signals, request.loss, origin)?;
    problem.keep_until(request.until);
    check_range(&problem, origin, request.until)?;
    if selected.is_empty() {
        return Err(FitError::NothingFree);
    }
    let identified = identify::identify(&problem, &selected)?;
    problem.parameters = identified.parameters;
    if problem.points.len() <= problem.parameters.len() {
        return Err(FitError::TooFew {
            samples: problem.points.len(),
            parameters: problem.parameters.len(),
        });
    }
    Ok(Prepared {
        problem,
        notes: identified.notes,
        origin,
    })
}

/// Refuses values that the sums of squares can't hold.
fn check_values(signals: &[Signal]) -> Result<(), FitError> {
    /// Well below the residual of a refused motion, and its square is finite.
    const MAX_SIZE: f64 = 1e25;
    for signal in signals {
        for (at, value) in signal.values.iter().enumerate() {
            let size = value.abs().max((value / signal.sigmas[at]).abs());
            if size.is_nan() || size > MAX_SIZE {
                return Err(FitError::Size {
                    field: signal.field.to_string(),
                    time: signal.times[at],
                    value: *value,
                    sigma: signal.sigmas[at],
                });
            }
        }
    }
    Ok(())
}

/// Refuses signals of the first file without a value in the time that is fitted.
fn check_range(problem: &Problem, origin: f64, until: Option<f64>) -> Result<(), FitError> {
    for (index, signal) in problem.signals.iter().enumerate() {
        let mut points = problem.points.iter();
        if signal.file == 0 && !points.any(|point| point.signal == index) {
            return Err(FitError::OutOfRange {
                field: signal.field.to_string(),
                first: signal.times.first().copied().unwrap_or(f64::NAN),
                last: signal.times.last().copied().unwrap_or(f64::NAN),
                origin,
                until: until.map(|until| origin + until),
            });
        }
    }
    Ok(())
}
