//! The outcomes of runs.

use crate::errors::SimulationError;
use crate::guard::compute;
use crate::scenario::Base;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping};
use toprise::run::outcome::{COLUMNS, Cell, Outcome};
use toprise::run::scenario::Scenario;

/// Runs a scenario and returns only its outcome; twice as fast as `run`.
///
/// `base` and `overrides` are as for `run`. The keys are the columns of a sweep: `stop_reason`, `stop_time`, `rise_time` (s)
/// and so on. `None` means that it did not happen.
///
/// Raises `ScenarioError` if the scenario can't be run, `SimulationError` if the motion can't be integrated to its end.
#[pyfunction]
#[pyo3(signature = (base, overrides=None))]
pub fn outcome<'py>(
    py: Python<'py>,
    base: Base<'_>,
    overrides: Option<&Bound<'_, PyMapping>>,
) -> PyResult<Bound<'py, PyDict>> {
    dictionary(py, &simulate(py, base.scenario(overrides)?)?)
}

/// Simulates a scenario and returns its outcome.
pub fn simulate(py: Python<'_>, scenario: Scenario) -> PyResult<Outcome> {
    let outcome = compute(py, move |interrupt| {
        toprise::run::outcome(&scenario, || !interrupt.is_requested())
    })?;
    outcome.map_err(|error| SimulationError::new_err(error.to_string()))
}

/// An outcome by the names of its columns.
pub fn dictionary<'py>(py: Python<'py>, outcome: &Outcome) -> PyResult<Bound<'py, PyDict>> {
    let dictionary = PyDict::new(py);
    for column in COLUMNS {
        match column.value_of(outcome) {
            Some(Cell::Text(text)) => dictionary.set_item(column.name, text)?,
            Some(Cell::Integer(number)) => dictionary.set_item(column.name, number)?,
            Some(Cell::Number(number)) => dictionary.set_item(column.name, number)?,
            None => dictionary.set_item(column.name, py.None())?,
        }
    }
    Ok(dictionary)
}
