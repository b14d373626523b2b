//! Fits of measured motions.

use crate::compare::json;
use crate::errors::{self, FitError};
use crate::guard::compute;
use crate::scenario::{Base, Scenario};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyMapping;
use std::fmt::Display;
use std::path::PathBuf;
use std::str::FromStr;
use toprise::fit::{
    Data, DataError, FitError as Failed, Layout, Loss, Request, Signal, SignalSpec,
};
use toprise::words::{Argument, markdown};

/// The measured values: arrays, or files.
#[derive(FromPyObject)]
pub struct Measured {
    /// Times, s.
    #[pyo3(item)]
    time: Vec<f64>,
    /// Names of fields, values in SI units, and the standard deviation if it is known.
    #[pyo3(item)]
    arrays: Vec<(String, Vec<f64>, Option<f64>)>,
    /// Files, as for `toprise fit`.
    #[pyo3(item)]
    files: Vec<PathBuf>,
    /// Descriptions of their signals, as for `--signal`.
    #[pyo3(item)]
    columns: Vec<String>,
    /// Name of their columns of times.
    #[pyo3(item)]
    time_column: Option<String>,
    /// What separates their cells.
    #[pyo3(item)]
    delimiter: Option<String>,
    /// Their decimal mark.
    #[pyo3(item)]
    decimal: Option<String>,
}

/// Options of a fit; see `toprise.fit`.
#[derive(FromPyObject)]
pub struct Options {
    #[pyo3(item)]
    free: Vec<String>,
    #[pyo3(item)]
    bounds: Vec<(String, [f64; 2])>,
    #[pyo3(item)]
    robust: bool,
    #[pyo3(item)]
    start: Option<f64>,
    #[pyo3(item)]
    until: Option<f64>,
    #[pyo3(item)]
    holdout: f64,
    #[pyo3(item)]
    compare: Vec<String>,
    #[pyo3(item)]
    profile: Vec<String>,
    #[pyo3(item)]
    rescale: bool,
}

/// Index of the signal, time (s), value, standard deviation, residual (σ), and whether the value was held out.
type Residual = (usize, f64, f64, f64, f64, bool);

/// Fits a scenario to measured values; see `toprise.fit`. Returns the report as JSON and as Markdown, the best scenario and
/// the residuals.
#[pyfunction]
pub fn fit(
    py: Python<'_>,
    scenario: Base<'_>,
    overrides: Option<&Bound<'_, PyMapping>>,
    measured: Measured,
    options: Options,
) -> PyResult<(String, String, Scenario, Vec<Residual>)> {
    let request = Request {
        scenario: scenario.scenario(overrides)?,
        data: measured.data()?,
        free: options.free,
        bounds: options.bounds,
        loss: if options.robust {
            Loss::Huber
        } else {
            Loss::Squares
        },
        origin: options.start,
        until: options.until,
        holdout: options.holdout,
        compare: options.compare,
        profile: options.profile,
        rescale: options.rescale,
    };
    let fitted = compute(py, move |interrupt| {
        toprise::fit::fit(&request, &|_| interrupt.unwind_if_requested())
    })?
    .map_err(fit_error)?;
    let mut residuals = Vec::new();
    for value in &fitted.residuals {
        residuals.push((
            value.signal,
            value.time,
            value.value,
            value.sigma,
            value.residual,
            value.is_held_out,
        ));
    }
    let report = fitted.report;
    Ok((
        json(&report)?,
        markdown(&report.words(false).sections, argument),
        Scenario(fitted.scenario),
        residuals,
    ))
}

impl Measured {
    fn data(self) -> PyResult<Data> {
        let layout = Layout {
            delimiter: parsed("delimiter", self.delimiter.as_deref())?,
            decimal: parsed("decimal", self.decimal.as_deref())?,
            time: self.time_column.clone(),
        };
        self.read(&layout).map_err(data_error)
    }

    fn read(&self, layout: &Layout) -> Result<Data, DataError> {
        if !self.files.is_empty() {
            let mut specs = Vec::new();
            for column in &self.columns {
                specs.push(SignalSpec::parse(column)?);
            }
            return toprise::fit::read(&self.files, &specs, layout);
        }
        let mut signals = Vec::new();
        for (name, values, sigma) in &self.arrays {
            let field = SignalSpec::parse(name)?.field;
            signals.push(Signal::from_values(field, &self.time, values, *sigma)?);
        }
        Ok(Data::from_signals(signals))
    }
}

/// An argument that is one of a few words.
fn parsed<T: FromStr>(name: &str, word: Option<&str>) -> PyResult<Option<T>>
where
    T::Err: Display,
{
    let parse = |word: &str| {
        word.parse()
            .map_err(|error| PyValueError::new_err(format!("{name}: {error}")))
    };
    word.map(parse).transpose()
}

fn data_error(error: DataError) -> PyErr {
    fit_error(error.into())
}

fn fit_error(error: Failed) -> PyErr {
    let text = error.sentence().text(argument);
    match error {
        Failed::Data(error) => match error.io() {
            Some(reason) => errors::io(reason, text),
            None => FitError::new_err(text),
        },
        Failed::Scenario(error) => errors::scenario(error),
        _ => FitError::new_err(text),
    }
}

/// An argument as one of `toprise.fit`.
fn argument(argument: &Argument) -> String {
    let name = match argument.name {
        "signal" => "columns",
        "time" => "time_column",
        "set" => "overrides",
        "bound" => "bounds",
        "all" => "the entries of the report",
        name => name,
    };
    match argument.values.first() {
        None => name.to_owned(),
        Some(_) if name == "columns" => list(name, argument),
        Some(_) if name == "overrides" => dict(name, argument),
        Some(value) if matches!(name, "start" | "until") => format!("{name}={value}"),
        Some(value) => format!("{name}={value:?}"),
    }
}

/// An argument whose values are a list.
fn list(name: &str, argument: &Argument) -> String {
    format!("{name}={:?}", argument.values)
}

/// An argument whose values are those of keys.
fn dict(name: &str, argument: &Argument) -> String {
    let mut entries = Vec::new();
    for value in &argument.values {
        let (key, value) = value.split_once('=').unwrap_or((value, ""));
        entries.push(match value.parse::<f64>() {
            Ok(_) => format!("{key:?}: {value}"),
            Err(_) => format!("{key:?}: {value:?}"),
        });
    }
    format!("{name}={{{}}}", entries.join(", "))
}
