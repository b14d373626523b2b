//! Questions about runs. Their answers are JSON, as those of the program; `toprise/_reports.py` makes them dictionaries.

use crate::errors::{self, DiffError, RecordingError};
use crate::guard::{Interrupt, compute};
use crate::run::{Origin, Run, open};
use crate::scenario::Base;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde::Serialize;
use std::path::PathBuf;
use std::sync::Arc;
use toprise::analysis::diff::{
    Align, Observer, Offset, Options, Tolerance, Tolerances, compare_observed,
};
use toprise::analysis::explain as stories;
use toprise::analysis::subject::Subject;
use toprise::analysis::verify as checks;
use toprise::archive::given::is_recording;
use toprise::archive::recording::{Condition, Recording};
use toprise::archive::sink::SinkError;
use toprise::run::scenario::{PRESETS, Scenario as Checked};
use toprise::telemetry::Message;
use toprise::telemetry::side::Side;

/// A run to be asked about: one that was simulated or read, or what names one.
pub enum Given<'py> {
    Run(Bound<'py, Run>),
    Base(Base<'py>),
}

impl<'py> FromPyObject<'_, 'py> for Given<'py> {
    type Error = PyErr;

    fn extract(given: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        match given.cast::<Run>() {
            Ok(run) => Ok(Self::Run(run.to_owned())),
            Err(_) => given.extract().map(Self::Base),
        }
    }
}

/// The run that is meant, without its Python object.
enum Meant {
    Recording(Arc<Recording>),
    Scenario(Box<Checked>),
}

impl Given<'_> {
    fn open(self, py: Python<'_>) -> PyResult<Meant> {
        Ok(match self {
            Self::Run(run) => match &run.get().origin {
                Origin::Scenario(scenario, _) => Meant::Scenario(scenario.clone()),
                Origin::Recording(recording) => Meant::Recording(recording.clone()),
            },
            Self::Base(Base::Word(word)) if is_recording(&word) => {
                Meant::Recording(open(py, word)?)
            }
            Self::Base(base) => Meant::Scenario(Box::new(base.scenario(None)?)),
        })
    }
}

impl Meant {
    fn subject(&self) -> Subject<'_> {
        match self {
            Self::Recording(recording) => Subject::Recording(recording),
            Self::Scenario(scenario) => Subject::Scenario(scenario),
        }
    }
}

/// Ends a comparison that nobody wants any more.
struct Watching(Interrupt);

impl Observer for Watching {
    fn message(&mut self, _: Side, _: &Message<'_>) -> Result<(), SinkError> {
        if !self.0.is_asked() {
            return Ok(());
        }
        // Nobody sees it: what the signal's handler has raised goes to the caller.
        Err(SinkError::Viewer("interrupted".into()))
    }

    fn carry_on(&self) -> Box<dyn Fn() -> bool + Send + Sync> {
        let interrupt = self.0.clone();
        Box::new(move || !interrupt.is_asked())
    }
}

/// Compares two runs; see `toprise.diff`.
#[pyfunction]
#[pyo3(signature = (a, b, *, abs, rel, ulp, tolerances, align, max_dt_ns, offset_ns, floor, topics, ignore))]
#[allow(clippy::too_many_arguments)]
pub fn diff(
    py: Python<'_>,
    a: Given<'_>,
    b: Given<'_>,
    abs: f64,
    rel: f64,
    ulp: u64,
    tolerances: Vec<String>,
    align: &str,
    max_dt_ns: Option<u64>,
    offset_ns: Option<i64>,
    floor: bool,
    topics: Vec<String>,
    ignore: Vec<String>,
) -> PyResult<String> {
    let refused = |error: toprise::analysis::diff::DiffError| DiffError::new_err(error.to_string());
    let mut bounds = Tolerances {
        general: Tolerance { abs, rel, ulp },
        ignored: ignore,
        ..Tolerances::default()
    };
    bounds.check().map_err(refused)?;
    for tolerance in tolerances {
        bounds.add(&tolerance).map_err(refused)?;
    }
    let options = Options {
        align: alignment(align)?,
        max_dt: max_dt_ns,
        offset: offset_ns.map_or(Offset::Start, Offset::By),
        tolerances: bounds,
        floor,
        topics,
    };
    let (a, b) = (a.open(py)?, b.open(py)?);
    let report = compute(py, move |interrupt| {
        let watching = &mut Watching(interrupt);
        compare_observed(a.subject(), b.subject(), &options, watching)
    })?;
    json(&report.map_err(refused)?)
}

fn alignment(name: &str) -> PyResult<Align> {
    const ALL: [Align; 4] = [Align::Time, Align::Nutation, Align::Theta, Align::Index];
    let found = ALL.into_iter().find(|align| align.name() == name);
    found.ok_or_else(|| {
        let names = ALL.map(Align::name).join(", ");
        PyValueError::new_err(format!("align = {name:?}: must be one of {names}"))
    })
}

/// Tells the story of a run; see `toprise.explain`.
#[pyfunction]
pub fn explain(py: Python<'_>, run: Given<'_>) -> PyResult<String> {
    let run = run.open(py)?;
    let story = compute(py, move |interrupt| {
        stories::explain_while(run.subject(), &|| !interrupt.is_asked())
    })?;
    json(&story.map_err(|error| DiffError::new_err(error.to_string()))?)
}

/// Checks a recording; see `toprise.verify`.
#[pyfunction]
#[pyo3(signature = (path, *, reproduce))]
pub fn verify(py: Python<'_>, path: PathBuf, reproduce: bool) -> PyResult<String> {
    let recording = open(py, path)?;
    let recorded = recording.refuse_newer();
    recorded.map_err(|error| errors::recording(recording.path(), &error))?;
    let options = checks::Options { reproduce };
    let file = recording.path().display().to_string();
    let report = compute(py, move |interrupt| {
        checks::verify(&recording, options, &|_| interrupt.end_if_asked())
    })?;
    json(&Verified {
        file,
        verdict: report.verdict(),
        state: report.condition,
        checks: &report.checks,
        telemetry: report.telemetry,
        without: &report.without,
        not_covered: &report.not_covered,
    })
}

/// What was found out about a recording, under the names of `toprise verify --format json`.
#[derive(Serialize)]
struct Verified<'a> {
    file: String,
    verdict: checks::Verdict,
    state: Condition,
    checks: &'a [checks::Check],
    telemetry: Option<u32>,
    without: &'a [String],
    not_covered: &'a [String],
}

/// The names of the scenarios that come with toprise, and what they show.
#[pyfunction]
pub fn presets() -> Vec<(&'static str, &'static str)> {
    let told = PRESETS.iter();
    told.map(|preset| (preset.name, preset.description()))
        .collect()
}

fn json(answer: &impl Serialize) -> PyResult<String> {
    serde_json::to_string(answer).map_err(|error| RecordingError::new_err(error.to_string()))
}
