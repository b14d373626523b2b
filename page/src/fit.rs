//! Fits of measured motions that are dropped on the page.

use crate::form;
use crate::progress::show_progress;
use crate::scenario_request::ScenarioRequest;
use serde::Deserialize;
use serde_json::{Value as Json, json};
use std::error::Error;
use std::path::Path;
use toprise::fit::{self, Data, Fit, FitError, Progress, Request, SignalSpec, usual_parameters};
use toprise::run::scenario::{Scenario, Value};
use toprise::run::simulation::{SimulationError, sample_at};
use toprise::telemetry::fields::NumberField;

/// Maximum number of measured values of a signal that the page draws.
const MAX_DRAWN: usize = 4000;

/// Number of samples of the best fit that the page draws in a window.
const CURVE_SAMPLES: u32 = 4000;

/// Number of values of a signal in the window in which they can be told apart.
const DETAIL: usize = 50;

/// Advice for a scenario that has no friction to find.
const NO_FRICTION: &str = "the top on the screen has no friction to find: switch friction on, or find only its start (write start)";

/// The data, parameters and errors of a fit. The content of the file is in the buffer of files.
#[derive(Deserialize)]
pub struct FitRequest {
    scenario: ScenarioRequest,
    /// Name of the file, for errors and the command.
    file: String,
    /// Free parameters, separated by commas; the usual ones if empty.
    free: String,
    /// Standard deviation of angles, with a unit; estimated if empty.
    sigma: String,
}

/// Fits the scenario of a request to the content of its file.
pub fn fit(request: &FitRequest, content: &[u8]) -> Result<Json, Box<dyn Error>> {
    let scenario = request.scenario.scenario()?;
    let specs = signals(request, content)?;
    let data = read(request, content, &parsed(&specs)?)?;
    let free: Vec<String> = match request.free.trim() {
        // Without friction only the start would be left, and no fit of it would describe a real top.
        "" if scenario.is_frictionless() => return Err(NO_FRICTION.into()),
        "" => usual_parameters(&scenario),
        names => free_names(names, &scenario),
    };
    let names: Vec<&str> = free.iter().map(String::as_str).collect();
    let fitted = fit::fit(&Request::new(scenario, data, &names), &report_progress)?;
    Ok(json!({
        "report": fitted.report,
        "words": fitted.report.words(false),
        "arguments": arguments(request, &free, &specs),
        "free": free.join(","),
        "set": fitted_values(request, &fitted)?,
        "signals": drawn_signals(&fitted)?,
    }))
}

/// Names of parameters, and the groups that the page calls friction and start.
fn free_names(text: &str, scenario: &Scenario) -> Vec<String> {
    let mut names = Vec::new();
    for name in text.replace(" and ", ",").split(',').map(str::trim) {
        match name {
            "friction" => names.extend(
                usual_parameters(scenario)
                    .into_iter()
                    .filter(|name| name.starts_with("friction.")),
            ),
            "start" => names.push("initial".to_owned()),
            name => names.push(name.to_owned()),
        }
    }
    names
}

/// A standard deviation of angles as people write it: in degrees if there is no unit.
fn sigma_in_degrees(text: &str) -> String {
    let text = text.replace(',', ".");
    match text.parse::<f64>() {
        Ok(_) => format!("{text} deg"),
        Err(_) => text,
    }
}

fn report_progress(progress: Progress) {
    // Derivatives have no χ².
    if progress.chi2.is_finite() {
        show_progress(&progress.to_string());
    }
}

/// The arguments of `--signal`: the columns that are named like fields, if the standard deviation of angles is known.
fn signals(request: &FitRequest, content: &[u8]) -> Result<Vec<String>, Box<dyn Error>> {
    let mut specs = Vec::new();
    if request.sigma.trim().is_empty() {
        return Ok(specs);
    }
    let sigma = sigma_in_degrees(request.sigma.trim());
    for signal in read(request, content, &[])?.signals {
        let sigma = match signal.field.unit() {
            "rad" => format!(":{sigma}"),
            _ => String::new(),
        };
        specs.push(format!("{}={}{sigma}", signal.field.path(), signal.name));
    }
    Ok(specs)
}

/// Reads the signals of the file of a request.
fn read(request: &FitRequest, content: &[u8], specs: &[SignalSpec]) -> Result<Data, FitError> {
    let path = Path::new(&request.file);
    Ok(fit::read_bytes(path, content.to_vec(), specs)?)
}

fn parsed(specs: &[String]) -> Result<Vec<SignalSpec>, FitError> {
    let mut parsed = Vec::new();
    for text in specs {
        parsed.push(SignalSpec::parse(text)?);
    }
    Ok(parsed)
}

/// The arguments with which the program does the same.
fn arguments(request: &FitRequest, free: &[String], specs: &[String]) -> Vec<String> {
    let mut words = vec![
        "fit".to_owned(),
        request.scenario.preset.clone(),
        request.file.clone(),
    ];
    for (key, value) in &request.scenario.set {
        words.extend(["--set".to_owned(), format!("{key}={value}")]);
    }
    for spec in specs {
        words.extend(["--signal".to_owned(), spec.clone()]);
    }
    words.extend(["--free".to_owned(), free.join(",")]);
    words
}

/// The keys that differ from the preset, with the fitted values.
fn fitted_values(request: &FitRequest, fitted: &Fit) -> Result<Json, Box<dyn Error>> {
    let mut values = request.scenario.values()?;
    for estimate in &fitted.report.parameters {
        // With one file, all parameters are keys: only further files have offsets.
        let text = Value::Number(estimate.value).to_set_notation();
        values.set(&estimate.name, &text)?;
    }
    Ok(json!(form::differences(
        &request.scenario.preset()?,
        &values
    )))
}

/// The measured values of each signal, thinned out evenly, and the best fit in windows: the whole time, and its beginning.
fn drawn_signals(fitted: &Fit) -> Result<Vec<Json>, Box<dyn Error>> {
    let until = fitted.report.until;
    let mut drawn = Vec::new();
    for (index, field) in fitted.fields.iter().enumerate() {
        let mut own = Vec::new();
        for value in fitted
            .residuals
            .iter()
            .filter(|value| value.signal == index)
        {
            own.push([value.time, value.value]);
        }
        let mut ends = vec![until];
        if let Some([detail, _]) = own.get(DETAIL)
            && own.len() > 2 * DETAIL
        {
            ends.push(*detail);
        }
        let mut windows = Vec::new();
        for end in ends {
            windows.push(window(&fitted.scenario, *field, end)?);
        }
        let stride = own.len().div_ceil(MAX_DRAWN).max(1);
        // The beginning is drawn in detail, so none of its values is left out.
        let (detail, rest) = own.split_at(DETAIL.min(own.len()));
        let points: Vec<_> = detail.iter().chain(rest.iter().step_by(stride)).collect();
        drawn.push(json!({
            "path": field.path(),
            "unit": field.unit(),
            "points": points,
            "windows": windows,
        }));
    }
    Ok(drawn)
}

/// The best fit of a field from the start to `until`, s.
fn window(scenario: &Scenario, field: NumberField, until: f64) -> Result<Json, SimulationError> {
    let part = until / f64::from(CURVE_SAMPLES);
    let times: Vec<f64> = (0..=CURVE_SAMPLES).map(|at| part * f64::from(at)).collect();
    let mut values = Vec::new();
    sample_at(scenario, &times, &mut |_, sample| {
        values.push(field.of_sample(sample));
    })?;
    Ok(json!({
        "from": 0.0,
        "until": until,
        "curve": { "time": times[..values.len()], "value": values },
    }))
}
