//! Maps errors to the exceptions defined in `toprise/_errors.py`.

use pyo3::exceptions::{PyFileNotFoundError, PyPermissionError};
use pyo3::{PyErr, import_exception};
use std::io;
use std::path::Path;
use toprise::archive::input::InputError;
use toprise::archive::recording::RecordingError as CannotRead;
use toprise::run::scenario::ScenarioError as WrongScenario;
use toprise::sweep::{SweepError as WrongSweep, TableError};

import_exception!(toprise._errors, DiffError);
import_exception!(toprise._errors, FitError);
import_exception!(toprise._errors, InternalError);
import_exception!(toprise._errors, RecordingError);
import_exception!(toprise._errors, RecordingWarning);
import_exception!(toprise._errors, ScenarioError);
import_exception!(toprise._errors, SimulationError);
import_exception!(toprise._errors, SweepError);

/// Error of a scenario, with its key and value as attributes.
pub fn scenario(error: WrongScenario) -> PyErr {
    scenario_with_text(&error, error.to_string())
}

/// Error of a scenario, with a text that also says where the scenario comes from.
fn scenario_with_text(error: &WrongScenario, text: String) -> PyErr {
    ScenarioError::new_err((text, error.key.clone(), error.value.clone()))
}

/// Error of a sweep.
pub fn sweep(error: WrongSweep) -> PyErr {
    let text = error.to_string();
    match error {
        WrongSweep::Scenario(error) => scenario(error),
        WrongSweep::Base { source, .. } => scenario_with_text(&source, text),
        WrongSweep::Input(error) => input(error),
        WrongSweep::Spec(_)
        | WrongSweep::Axis { .. }
        | WrongSweep::Table { .. }
        | WrongSweep::Unusable { .. }
        | WrongSweep::Row(_)
        | WrongSweep::Parquet(_)
        | WrongSweep::Threads(_)
        | WrongSweep::Sink(_) => SweepError::new_err(text),
    }
}

/// Error of a table of runs.
pub fn table(error: TableError) -> PyErr {
    match error {
        TableError::Key(error) => scenario(error),
        error => ScenarioError::new_err(error.to_string()),
    }
}

/// Error for an argument that is not a scenario.
pub fn input(error: InputError) -> PyErr {
    let text = error.to_string();
    match error {
        InputError::Io { reason, .. } => io(&reason, text),
        InputError::Recording { reason, .. } => recording_with_text(&reason, text),
        InputError::UnknownPreset(reason) | InputError::Scenario { reason, .. } => {
            scenario_with_text(&reason, text)
        }
        InputError::Table { .. } => ScenarioError::new_err(text),
    }
}

/// Error for a recording that can't be read.
pub fn recording(path: &Path, error: &CannotRead) -> PyErr {
    recording_with_text(error, format!("{}: {error}", path.display()))
}

fn recording_with_text(error: &CannotRead, text: String) -> PyErr {
    match error {
        CannotRead::Io(reason) => io(reason, text),
        CannotRead::Directory
        | CannotRead::Empty
        | CannotRead::NotMcap
        | CannotRead::AmbiguousTopic(_)
        | CannotRead::MergedRuns(_)
        | CannotRead::NoScenario
        | CannotRead::DamagedScenario
        | CannotRead::LargeScenario(_)
        | CannotRead::ScenarioText(_)
        | CannotRead::UnusableScenario(_) => RecordingError::new_err(text),
    }
}

/// An I/O error, as the matching subclass of OSError if Python has one.
pub fn io(reason: &io::Error, text: String) -> PyErr {
    match reason.kind() {
        io::ErrorKind::NotFound => PyFileNotFoundError::new_err(text),
        io::ErrorKind::PermissionDenied => PyPermissionError::new_err(text),
        _ => RecordingError::new_err(text),
    }
}
