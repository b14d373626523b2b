//! `diff`, `explain`, `verify` and `presets`. They return JSON, as the program does; `toprise/_reports.py` converts it to
//! dictionaries.

use crate::errors::{self, DiffError, RecordingError};
use crate::guard::{Interrupt, compute};
use crate::run::{Origin, Run, open};
use crate::scenario::Base;
use pyo3::prelude::*;
use serde::Serialize;
use std::path::PathBuf;
use std::sync::Arc;
use toprise::analysis::diff::{Observer, Options, Tolerance, Tolerances, compare_observed};
use toprise::analysis::explain::explain_while;
use toprise::analysis::subject::Subject;
use toprise::archive::input::Input;
use toprise::archive::recording::Recording;
use toprise::archive::verify as checks;
use toprise::run::scenario::{PRESETS, Scenario as Checked};

/// A run argument: a `Run`, or anything that identifies one.
pub enum RunArgument<'py> {
    Run(Bound<'py, Run>),
    Base(Base<'py>),
}

impl<'py> FromPyObject<'_, 'py> for RunArgument<'py> {
    type Error = PyErr;

    fn extract(input: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        match input.cast::<Run>() {
            Ok(run) => Ok(Self::Run(run.to_owned())),
            Err(_) => input.extract().map(Self::Base),
        }
    }
}

/// The run behind an argument, without its Python object.
pub enum OpenRun {
    Recording(Arc<Recording>),
    Scenario(Box<Checked>),
}

impl RunArgument<'_> {
    /// Opens the run.
    pub fn open(self, py: Python<'_>) -> PyResult<OpenRun> {
        Ok(match self {
            Self::Run(run) => match &run.get().origin {
                Origin::Scenario(scenario, _) => OpenRun::Scenario(scenario.clone()),
                Origin::Recording(recording) => OpenRun::Recording(recording.clone()),
            },
            Self::Base(Base::Scenario(scenario)) => {
                OpenRun::Scenario(Box::new(scenario.get().0.clone()))
            }
            Self::Base(Base::Word(word)) => {
                let opened = compute(py, move |_| Input::open(&word))?;
                match opened.map_err(errors::input)? {
                    Input::Recording(recording) => OpenRun::Recording(Arc::from(recording)),
                    input => {
                        let values = input.values().map_err(errors::input)?;
                        let scenario = Checked::new(values).map_err(errors::scenario)?;
                        OpenRun::Scenario(Box::new(scenario))
                    }
                }
            }
        })
    }
}

impl OpenRun {
    /// The run as reports read it.
    pub fn subject(&self) -> Subject<'_> {
        match self {
            Self::Recording(recording) => Subject::Recording(recording),
            Self::Scenario(scenario) => Subject::Scenario(scenario),
        }
    }
}

/// Observer that ends an interrupted comparison.
struct Watching(Interrupt);

impl Observer for Watching {
    fn carry_on(&self) -> Box<dyn Fn() -> bool + Send + Sync> {
        // The error is not shown: the caller gets the exception of the signal's handler.
        let interrupt = self.0.clone();
        Box::new(move || !interrupt.is_requested())
    }
}

/// Compares two runs; see `toprise.diff`.
#[pyfunction]
#[pyo3(signature = (a, b, *, abs, rel, tolerances, integration_error, topics, ignore))]
#[allow(clippy::too_many_arguments)]
pub fn diff(
    py: Python<'_>,
    a: RunArgument<'_>,
    b: RunArgument<'_>,
    abs: f64,
    rel: f64,
    tolerances: Vec<String>,
    integration_error: bool,
    topics: Vec<String>,
    ignore: Vec<String>,
) -> PyResult<(String, Vec<String>)> {
    let mut bounds = Tolerances {
        general: Tolerance { abs, rel },
        ignored: ignore,
        ..Tolerances::default()
    };
    bounds.check().map_err(diff_error)?;
    for tolerance in tolerances {
        bounds.add(&tolerance).map_err(diff_error)?;
    }
    let options = Options {
        tolerances: bounds,
        integration_error,
        topics,
    };
    let (a, b) = (a.open(py)?, b.open(py)?);
    let report = compute(py, move |interrupt| {
        let watching = &mut Watching(interrupt);
        compare_observed(a.subject(), b.subject(), &options, watching)
    })?
    .map_err(diff_error)?;
    Ok((json(&report)?, report.summary()))
}

fn diff_error(error: toprise::analysis::diff::DiffError) -> PyErr {
    DiffError::new_err(error.to_string())
}

/// Explains a run; see `toprise.explain`.
#[pyfunction]
pub fn explain(py: Python<'_>, run: RunArgument<'_>) -> PyResult<(String, Vec<String>)> {
    let opened = run.open(py)?;
    let explanation = compute(py, move |interrupt| {
        explain_while(opened.subject(), &|| !interrupt.is_requested())
    })?
    .map_err(|error| DiffError::new_err(error.to_string()))?;
    let facts = explanation
        .chapters
        .iter()
        .flat_map(|chapter| &chapter.facts);
    let title = format!("{}.", explanation.title);
    let sentences = [title]
        .into_iter()
        .chain(explanation.story.text())
        .chain(facts.map(|fact| fact.sentence().to_string()));
    Ok((json(&explanation)?, sentences.collect()))
}

/// Verifies a recording; see `toprise.verify`.
#[pyfunction]
pub fn verify(py: Python<'_>, path: PathBuf) -> PyResult<String> {
    let recording = open(py, path)?;
    let file = recording.path().display().to_string();
    let report = compute(py, move |interrupt| {
        checks::verify(&recording, &|_| interrupt.unwind_if_requested())
    })?
    .map_err(|error| RecordingError::new_err(format!("{file}: {error}")))?;
    json(&Verified { file, report })
}

/// The result for a recording, with the keys of `toprise verify --format json`.
#[derive(Serialize)]
struct Verified {
    file: String,
    #[serde(flatten)]
    report: checks::Report,
}

/// Names and descriptions of the built-in scenarios.
#[pyfunction]
pub fn presets() -> Vec<(&'static str, &'static str)> {
    PRESETS
        .iter()
        .map(|preset| (&*preset.name, &*preset.description))
        .collect()
}

pub fn json(report: &impl Serialize) -> PyResult<String> {
    serde_json::to_string(report).map_err(|error| RecordingError::new_err(error.to_string()))
}
