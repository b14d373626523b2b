//! Figures of runs and of sweeps.

use crate::compare::RunArgument;
use crate::errors::SweepError;
use crate::guard::compute;
use crate::stream::ArrowTable;
use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::path::PathBuf;
use toprise::archive::publish::{self, Existing};
use toprise::figures::{CONTEXT_COLUMNS, Drawing, FIGURES, Figure as Kind, Map, RunData};
use toprise::sweep::Columns;

/// A figure; see `toprise.figures` and `toprise.map`.
#[pyclass(frozen, module = "toprise")]
pub struct Figure(Drawing);

#[pymethods]
impl Figure {
    /// The figure as SVG.
    #[getter]
    fn svg(&self) -> String {
        self.0.svg()
    }

    /// The figure as PNG, 300 dpi.
    fn png<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &self.png_bytes()?))
    }

    /// Writes an `.svg` or `.png` file. An existing file is replaced.
    fn save(&self, path: PathBuf) -> PyResult<()> {
        let bytes = match path.extension().and_then(|kind| kind.to_str()) {
            Some("svg") => self.0.svg().into_bytes(),
            Some("png") => self.png_bytes()?,
            _ => {
                let message = format!("{}: the name must end with .svg or .png", path.display());
                return Err(PyValueError::new_err(message));
            }
        };
        publish::write(&path, Existing::Replace, &bytes)
            .map_err(|error| PyOSError::new_err(error.to_string()))
    }

    fn _repr_svg_(&self) -> String {
        self.0.svg()
    }
}

impl Figure {
    fn png_bytes(&self) -> PyResult<Vec<u8>> {
        self.0
            .png()
            .map_err(|error| PyValueError::new_err(error.to_string()))
    }
}

/// Draws figures of runs, by name; see `toprise.figures`.
#[pyfunction]
#[pyo3(signature = (runs, *, only, width))]
pub fn figures(
    py: Python<'_>,
    runs: Vec<RunArgument<'_>>,
    only: Vec<String>,
    width: f64,
) -> PyResult<Vec<(&'static str, Figure)>> {
    check_width(width)?;
    let kinds = selected_figures(&only, runs.len())?;
    let mut read = Vec::new();
    for run in runs {
        let opened = run.open(py)?;
        let drawn_kinds = kinds.clone();
        let name = unique_name(&opened.subject().name(), &read);
        read.push(compute(py, move |interrupt| {
            RunData::read(opened.subject(), &name, &drawn_kinds, &|_| {
                interrupt.unwind_if_requested();
            })
        })?);
    }
    let mut drawn = Vec::new();
    for kind in kinds {
        match read.iter().find_map(|run| obstacle(kind, run)) {
            None => {
                let runs: Vec<&RunData> = read.iter().collect();
                drawn.push((kind.name, Figure(kind.draw(&runs, width))));
            }
            Some(reason) if !only.is_empty() => {
                return Err(PyValueError::new_err(format!("{}: {reason}", kind.name)));
            }
            Some(_) => {}
        }
    }
    Ok(drawn)
}

/// Draws outcomes of a sweep over one or two of its columns; see `toprise.map`.
#[pyfunction]
#[pyo3(signature = (table, x, y, show, width))]
pub fn map(
    table: &Bound<'_, PyAny>,
    x: &str,
    y: Option<&str>,
    show: &str,
    width: f64,
) -> PyResult<Figure> {
    check_width(width)?;
    let mut names = vec![x, show];
    names.extend(y);
    let columns = if let Ok(path) = table.extract::<PathBuf>() {
        names.extend(CONTEXT_COLUMNS);
        Columns::read(&path, &names)
    } else {
        let ArrowTable { schema, batches } = table.extract()?;
        Columns::from_batches("the table", &names, schema, batches)
    };
    columns
        .and_then(|columns| Map::from_columns(&columns, x, y, show))
        .map_err(|error| SweepError::new_err(error.to_string()))?
        .draw(width)
        .map(Figure)
        .map_err(|error| PyValueError::new_err(error.to_string()))
}

/// The figures that are asked for, or all that show this number of runs.
fn selected_figures(only: &[String], runs: usize) -> PyResult<Vec<&'static Kind>> {
    if only.is_empty() {
        return Ok(FIGURES
            .iter()
            .filter(|kind| kind.min_runs <= runs)
            .collect());
    }
    only.iter()
        .map(|name| match Kind::find(name) {
            Some(kind) if kind.min_runs <= runs => Ok(kind),
            Some(kind) => Err(PyValueError::new_err(format!(
                "{name} compares runs: it needs at least {}",
                kind.min_runs
            ))),
            None => {
                let names: Vec<&str> = FIGURES.iter().map(|kind| kind.name).collect();
                Err(PyValueError::new_err(format!(
                    "no figure {name:?}; figures: {}",
                    names.join(", ")
                )))
            }
        })
        .collect()
}

/// The reason why a figure can't show a run.
fn obstacle(kind: &Kind, run: &RunData) -> Option<String> {
    match kind.exclusion(run) {
        Some(reason) => Some(reason.to_owned()),
        None => kind
            .missing(run)
            .map(|missing| format!("{} has no {missing}", run.name)),
    }
}

/// A name for a legend that no other run has.
fn unique_name(name: &str, others: &[RunData]) -> String {
    let mut unique = name.to_owned();
    let mut number = 1;
    while others.iter().any(|other| other.name == unique) {
        number += 1;
        unique = format!("{name} ({number})");
    }
    unique
}

fn check_width(width: f64) -> PyResult<()> {
    if (80.0..=400.0).contains(&width) {
        return Ok(());
    }
    let message = format!("width = {width}: must be from 80 to 400 (mm)");
    Err(PyValueError::new_err(message))
}
