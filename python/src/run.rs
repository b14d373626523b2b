//! Runs: simulated now, or read from a recording.

use crate::errors::{self, RecordingError, RecordingWarning, SimulationError};
use crate::guard::{Interrupt, compute};
use crate::outcome;
use crate::scenario::{Base, Scenario};
use crate::table::{Columns, Table, escaped};
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping};
use std::error::Error;
use std::ffi::CString;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toprise::analysis::subject::Subject;
use toprise::archive::format::{CONTENT_DIGEST, STOP_REASON, STOP_TIME};
use toprise::archive::pipeline::McapSink;
use toprise::archive::publish::Existing;
use toprise::archive::recording::Recording;
use toprise::archive::sink::{Sink, SinkError, record_all};
use toprise::archive::writer::Form;
use toprise::figures::{Figure, RunData};
use toprise::run::outcome::Outcome;
use toprise::run::scenario::Scenario as Checked;
use toprise::run::simulation::StopReason;
use toprise::telemetry::digest::ContentDigest;
use toprise::telemetry::fields::{EVENTS, NUTATION};
use toprise::telemetry::{Message, RunMessages, Topic, Topics};

/// Width of the curves in a notebook, mm.
const CURVES_WIDTH: f64 = 130.0;

/// Origin of a run.
pub enum Origin {
    /// It was simulated, with this outcome.
    Scenario(Box<Checked>, Box<Outcome>),
    /// It was read.
    Recording(Arc<Recording>),
}

/// A run, simulated or read from a recording, with one table per topic.
///
/// `run["/top/state"]` is a `Table`; `run.topics` lists the topics.
#[pyclass(frozen, mapping, module = "toprise")]
pub struct Run {
    pub origin: Origin,
    tables: Vec<(Topic, Py<Table>)>,
    /// The end record of a recording.
    end: End,
    content_digest: Option<String>,
    losses: Vec<String>,
}

/// Simulates a scenario and keeps every message of the run.
///
/// `base` is a preset, a scenario file (TOML), a recording (MCAP; its scenario is used), or a `Scenario`. `overrides`
/// sets keys, as in `{"friction.k": 0.02}`, in SI units and radians; `None` removes a key. With `row`, `base` is a sweep table
/// (Parquet), and that row is run. `topics` selects the topics to keep. By default all are kept, which takes 34 MB for the
/// paper's run.
///
/// The numbers are bit-identical to those recorded by `toprise run`.
///
/// Raises `ScenarioError` if the scenario can't be run, `SimulationError` if the integration can't start. If it
/// fails later, the run up to that point is returned, with a `RecordingWarning`.
#[pyfunction]
#[pyo3(signature = (base, overrides=None, *, row=None, topics=None))]
pub fn run(
    py: Python<'_>,
    base: Base<'_>,
    overrides: Option<&Bound<'_, PyMapping>>,
    row: Option<u64>,
    topics: Option<Vec<String>>,
) -> PyResult<Run> {
    let scenario = match row {
        Some(row) => base.row(row, overrides)?,
        None => base.scenario(overrides)?,
    };
    let topics = wanted(topics)?;
    let support = scenario.model.support;
    let simulated = {
        let (scenario, topics) = (scenario.clone(), topics.clone());
        compute(py, move |interrupt| simulate(&scenario, &topics, interrupt))?
    };
    let (tables, outcome, losses) =
        simulated.map_err(|error| SimulationError::new_err(error.to_string()))?;
    let digest = tables.digest.finish();
    // A selected topic has a table even if no message came, but not if runs with this support never have any.
    let made: Vec<Topic> = Topic::all_with(support)
        .filter(|topic| topics.include(topic))
        .collect();
    let tables = tables
        .columns
        .into_iter()
        .filter(|columns| made.contains(&columns.topic()))
        .map(|columns| (columns, Vec::new()))
        .collect();
    let origin = Origin::Scenario(Box::new(scenario), Box::new(outcome));
    Run::new(py, origin, tables, None, Some(digest), losses)
}

/// Reads a toprise recording (MCAP).
///
/// `topics` selects the topics to read; by default all.
///
/// Raises `FileNotFoundError` if there is no such file, and `RecordingError` if it is not a toprise recording. If
/// the file is damaged, the readable parts are returned, with a `RecordingWarning`; `run.losses` lists the missing parts.
#[pyfunction]
#[pyo3(signature = (path, *, topics=None))]
pub fn read(py: Python<'_>, path: PathBuf, topics: Option<Vec<String>>) -> PyResult<Run> {
    let recording = open(py, path)?;
    if !recording.is_ours() {
        return Err(RecordingError::new_err(format!(
            "{}: written by {:?}, not by toprise",
            recording.path().display(),
            recording.library()
        )));
    }
    let topics = wanted(topics)?;
    let (tables, end, losses) = {
        let (recording, topics) = (recording.clone(), topics.clone());
        compute(py, move |interrupt| replay(&recording, &topics, &interrupt))?
    };
    let differences = recording.differences();
    let recorded = recording.topics();
    let mut read = Vec::new();
    for columns in tables.columns {
        let topic = columns.topic();
        if recorded.contains(&topic) && topics.include(&topic) {
            let lacking = differences
                .iter()
                .find(|(name, _)| name == topic.name())
                .map_or_else(Vec::new, |(_, fields)| fields.missing.clone());
            read.push((columns, lacking));
        }
    }
    let digest = end
        .as_ref()
        .and_then(|end| end.get(CONTENT_DIGEST).cloned());
    Run::new(py, Origin::Recording(recording), read, end, digest, losses)
}

/// Opens a recording, or any other MCAP file.
pub fn open(py: Python<'_>, path: PathBuf) -> PyResult<Arc<Recording>> {
    let word = path.clone();
    let opened = compute(py, move |_| Recording::open(&word))?;
    let recording = opened.map_err(|error| errors::recording(&path, &error))?;
    Ok(Arc::new(recording))
}

fn wanted(topics: Option<Vec<String>>) -> PyResult<Topics> {
    let Some(names) = topics else {
        return Ok(Topics::All);
    };
    Topics::named(&names).map_err(|error| PyValueError::new_err(error.to_string()))
}

/// Table builders of a run, one per topic, in table order.
struct Tables {
    columns: Vec<Columns>,
    digest: ContentDigest,
}

impl Default for Tables {
    fn default() -> Self {
        Self {
            columns: Topic::all().map(Columns::new).collect(),
            digest: ContentDigest::default(),
        }
    }
}

impl Sink for Tables {
    fn write(&mut self, message: &Message<'_>) -> Result<(), SinkError> {
        self.digest.update(message);
        self.columns[message.channel].push(message);
        Ok(())
    }

    fn flush(&mut self) -> Result<(), SinkError> {
        Ok(())
    }
}

/// Simulates a run. Returns its tables, its outcome and a description of missing parts.
fn simulate(
    scenario: &Checked,
    topics: &Topics,
    interrupt: Interrupt,
) -> Result<(Tables, Outcome, Vec<String>), Box<dyn Error + Send + Sync>> {
    let mut run =
        RunMessages::new(scenario, topics)?.continue_while(move || !interrupt.is_requested());
    let mut tables = Tables::default();
    let recorded = record_all(&mut run, &mut [&mut tables])?;
    let losses = recorded.error.iter().map(ToString::to_string).collect();
    Ok((tables, recorded.outcome, losses))
}

/// Simulates a run and records it in a new file.
fn save(
    scenario: &Checked,
    path: &Path,
    existing: Existing,
    interrupt: Interrupt,
) -> Result<(), Box<dyn Error + Send + Sync>> {
    let mut run =
        RunMessages::new(scenario, &Topics::All)?.continue_while(move || !interrupt.is_requested());
    let form = Form::default();
    let mut sink = McapSink::create(path, existing, scenario, run.telemetry(), form)?;
    let recorded = record_all(&mut run, &mut [&mut sink])?;
    if let Some(error) = recorded.error {
        return Err(error.into());
    }
    sink.finish(&recorded.outcome.end)?;
    Ok(())
}

type End = Option<toprise::archive::format::Entries>;

/// Reads a recording. Returns its tables, its end record and a description of unreadable parts.
fn replay(
    recording: &Recording,
    topics: &Topics,
    interrupt: &Interrupt,
) -> (Tables, End, Vec<String>) {
    let mut tables = Tables::default();
    let ended = Subject::Recording(recording).read(topics, &mut |message, _| {
        tables.columns[message.channel].push(message);
        !interrupt.is_requested()
    });
    (tables, ended.end, ended.losses)
}

/// A figure of a run as SVG, for a page; empty if the run lacks what it shows.
fn draw(figure: &'static Figure, subject: Subject<'_>, name: &str) -> String {
    let run = RunData::read(subject, name, &[figure], &|_| {});
    if figure.missing(&run).is_some() {
        return String::new();
    }
    let svg = figure.draw(&[&run], CURVES_WIDTH).svg();
    // Within a page there is no XML declaration.
    svg.split_once("?>")
        .map_or_else(String::new, |(_, svg)| svg.to_owned())
}

/// A row of a table of names and values.
fn html_row(name: &str, value: &str) -> String {
    let (name, value) = (escaped(name), escaped(value));
    format!("<tr><th>{name}</th><td>{value}</td></tr>")
}

impl Run {
    fn new(
        py: Python<'_>,
        origin: Origin,
        tables: Vec<(Columns, Vec<String>)>,
        end: End,
        content_digest: Option<String>,
        losses: Vec<String>,
    ) -> PyResult<Self> {
        let tables = tables.into_iter().map(|(columns, lacking)| {
            let topic = columns.topic();
            Ok((topic, Py::new(py, columns.into_table(&lacking)?)?))
        });
        let run = Self {
            tables: tables.collect::<PyResult<_>>()?,
            origin,
            end,
            content_digest,
            losses,
        };
        run.warn(py)?;
        Ok(run)
    }

    /// Warns about missing parts.
    fn warn(&self, py: Python<'_>) -> PyResult<()> {
        let Some(first) = self.losses.first() else {
            return Ok(());
        };
        let more = match self.losses.len() - 1 {
            0 => String::new(),
            more => format!(" (and {more} more, see run.losses)"),
        };
        let text = CString::new(format!("{}: {first}{more}", self.name()).replace('\0', "�"))?;
        PyErr::warn(py, &py.get_type::<RecordingWarning>(), &text, 1)
    }

    /// θ and the Euler rates over time, as SVG.
    fn curves(&self, py: Python<'_>) -> PyResult<String> {
        let Some(figure) = Figure::find("figure-2") else {
            return Ok(String::new());
        };
        let name = self.name();
        match &self.origin {
            Origin::Scenario(scenario, _) => {
                let scenario = scenario.clone();
                compute(py, move |_| {
                    draw(figure, Subject::Scenario(&scenario), &name)
                })
            }
            Origin::Recording(recording) => {
                let recording = recording.clone();
                compute(py, move |_| {
                    draw(figure, Subject::Recording(&recording), &name)
                })
            }
        }
    }

    /// The scenario with its changes, and how the run ended.
    fn headline(&self) -> String {
        match &self.origin {
            Origin::Scenario(scenario, outcome) => {
                format!("{}: {}", scenario.title(), outcome.sentence())
            }
            Origin::Recording(recording) => {
                let title = match recording.scenario() {
                    Ok(scenario) => scenario.title(),
                    Err(_) => self.name(),
                };
                format!("{title}: {}", self.recorded_end())
            }
        }
    }

    /// The end of a recorded run, by its end record.
    fn recorded_end(&self) -> String {
        let Some(end) = &self.end else {
            return "interrupted".to_owned();
        };
        let reason = end.get(STOP_REASON).and_then(|name| StopReason::find(name));
        let time = end.get(STOP_TIME).and_then(|time| time.parse::<f64>().ok());
        match (reason, time) {
            (Some(reason), Some(time)) => format!("{} at t = {time:.6} s", reason.sentence()),
            (Some(_), None) | (None, _) => "end unknown".to_owned(),
        }
    }

    fn find(&self, py: Python<'_>, name: &str) -> PyResult<Py<Table>> {
        let found = self.tables.iter().find(|(topic, _)| topic.name() == name);
        found.map(|(_, table)| table.clone_ref(py)).ok_or_else(|| {
            let topics = self.topics().join(", ");
            PyKeyError::new_err(format!("the run has no topic {name}; topics: {topics}"))
        })
    }
}

#[pymethods]
impl Run {
    /// The name of the scenario, or of the recording's file without its extension.
    #[getter]
    fn name(&self) -> String {
        match &self.origin {
            Origin::Scenario(scenario, _) => scenario.name().to_owned(),
            Origin::Recording(recording) => Subject::Recording(recording).name(),
        }
    }

    /// The recording's file; None if the run was simulated.
    #[getter]
    fn path(&self) -> Option<String> {
        match &self.origin {
            Origin::Scenario(..) => None,
            Origin::Recording(recording) => Some(recording.path().display().to_string()),
        }
    }

    /// The scenario that defines the run. Raises `RecordingError` if a damaged recording has lost it.
    #[getter]
    fn scenario(&self) -> PyResult<Scenario> {
        match &self.origin {
            Origin::Scenario(scenario, _) => Ok(Scenario(scenario.as_ref().clone())),
            Origin::Recording(recording) => recording.scenario().map(Scenario).map_err(|error| {
                RecordingError::new_err(format!("{}: {error}", recording.path().display()))
            }),
        }
    }

    /// Outcome of the run, by the names of a sweep's columns: `run.outcome["rise_time"]` (s). `None` means
    /// that it did not happen.
    ///
    /// For a recording, the scenario is simulated again on each call to get it.
    #[getter]
    fn outcome<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        if let Origin::Scenario(_, outcome) = &self.origin {
            return outcome::dictionary(py, outcome);
        }
        let Scenario(scenario) = self.scenario()?;
        outcome::dictionary(py, &outcome::simulate(py, scenario)?)
    }

    /// The topics, in the order in which `toprise schema` lists them.
    #[getter]
    fn topics(&self) -> Vec<&'static str> {
        self.tables.iter().map(|(topic, _)| topic.name()).collect()
    }

    /// The topics; makes a run a mapping.
    fn keys(&self) -> Vec<&'static str> {
        self.topics()
    }

    /// Table of `/events`, one row per event.
    #[getter]
    fn events(&self, py: Python<'_>) -> PyResult<Py<Table>> {
        self.find(py, EVENTS.name())
    }

    /// Table of `/top/nutation`: averages over each nutation, one per row.
    #[getter]
    fn nutations(&self, py: Python<'_>) -> PyResult<Py<Table>> {
        self.find(py, NUTATION.name())
    }

    /// SHA-256 of all messages, as `toprise run` prints it. For a recording it is read from the file
    /// (not checked; use `toprise.verify`). None if the run was interrupted.
    #[getter]
    fn content_digest(&self) -> Option<&str> {
        self.content_digest.as_deref()
    }

    /// Descriptions of missing parts; empty if the run is complete.
    #[getter]
    fn losses(&self) -> Vec<String> {
        self.losses.clone()
    }

    /// Writes the whole run as a recording (MCAP), with the bytes that `toprise run` writes. The file
    /// contains all topics, even if this run has only some; the scenario is simulated again for it.
    ///
    /// A name that ends with `.rrd` writes a recording for the Rerun viewer: with the scene and layout of the program
    /// `toprise` where it is installed, otherwise as Rerun converts it (`pip install rerun-sdk`). With `force`, an existing file is replaced.
    ///
    /// Raises `RecordingError` if the file exists or can't be written.
    #[pyo3(signature = (path, *, force=false))]
    fn save(slf: &Bound<'_, Self>, path: PathBuf, force: bool) -> PyResult<()> {
        let py = slf.py();
        if !force && path.symlink_metadata().is_ok() {
            return Err(RecordingError::new_err(format!(
                "{} exists: choose another name, or pass force=True to replace it",
                path.display()
            )));
        }
        if path.extension().is_some_and(|extension| extension == "rrd") {
            py.import("toprise._viewer")?
                .call_method1("save_rrd", (slf, path))?;
            return Ok(());
        }
        let Scenario(scenario) = slf.get().scenario()?;
        let file = path.clone();
        let saved = compute(py, move |interrupt| {
            save(&scenario, &file, Existing::forced(force), interrupt)
        })?;
        saved.map_err(|error| RecordingError::new_err(format!("{}: {error}", path.display())))
    }

    /// Opens the run in the Rerun viewer, and returns the viewer process. `pip install rerun-sdk` installs the viewer.
    fn rerun<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let viewer = slf.py().import("toprise._viewer")?;
        viewer.call_method1("show", (slf,))
    }

    fn __getitem__(&self, py: Python<'_>, topic: &str) -> PyResult<Py<Table>> {
        self.find(py, topic)
    }

    fn __contains__(&self, topic: &str) -> bool {
        self.tables.iter().any(|(own, _)| own.name() == topic)
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(self.topics().into_pyobject(py)?.try_iter()?.into_any())
    }

    fn __len__(&self) -> usize {
        self.tables.len()
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let mut text = format!("<toprise.Run {}", self.headline().escape_debug());
        for (topic, table) in &self.tables {
            let rows = table.bind(py).len()?;
            text += &format!("\n  {:20} {rows:>9} rows", topic.name());
        }
        Ok(text + ">")
    }

    /// The name, the curves of θ and the rates, and a table of the outcome. For a recording, the
    /// topics instead of the outcome, because the outcome needs a simulation.
    fn _repr_html_(&self, py: Python<'_>) -> PyResult<String> {
        let mut page = format!(
            "<p>{}: <code>run.rerun()</code> opens it in the Rerun viewer</p>{}<table><tbody>",
            escaped(&self.name()),
            self.curves(py)?
        );
        if let Origin::Scenario(_, outcome) = &self.origin {
            for (name, value) in outcome::dictionary(py, outcome)? {
                page += &html_row(&name.to_string(), &value.to_string());
            }
        } else {
            for (topic, table) in &self.tables {
                let rows = table.bind(py).len()?;
                page += &html_row(topic.name(), &format!("{rows} rows"));
            }
        }
        Ok(page + "</tbody></table>")
    }
}
