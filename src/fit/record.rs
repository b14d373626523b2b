//! The recording of a fit: the run of the best fit, the data and residuals beside it, problem and report attached.

use super::Fit;
use crate::archive::format::end_entries;
use crate::archive::writer::{Form, McapWriter};
use crate::fit::problem::model::Loss;
use crate::fit::problem::request::Request;
use crate::run::time::nanoseconds;
use crate::telemetry::supplement::{FIT_DATA, FIT_RESIDUAL, SUPPLEMENTARY_ATTACHMENTS, Supplement};
use crate::telemetry::{RunError, RunMessages, Topics};
use mcap::McapError;
use serde::Serialize;
use std::io::Write;
use thiserror::Error;

/// Error of recording a fit.
#[derive(Debug, Error)]
pub enum RecordError {
    /// The run of the best fit failed.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The target can't be written.
    #[error("cannot write the recording")]
    Mcap(#[from] McapError),
    /// The problem or the report can't be written as JSON.
    #[error("cannot write the report of the fit")]
    Json(#[from] serde_json::Error),
}

/// What was fitted, as it is attached.
#[derive(Serialize)]
struct Problem<'a> {
    /// The scenario with the start values, TOML.
    scenario: String,
    free: &'a [String],
    bounds: &'a [(String, [f64; 2])],
    loss: Loss,
    start: f64,
    until: Option<f64>,
    holdout: f64,
    compare: &'a [String],
    profile: &'a [String],
    rescale: bool,
}

/// Number of numbers in a message of data or residuals.
const NUMBERS: usize = 2;

/// A message of a supplement.
struct SupplementRow {
    time_ns: u64,
    numbers: [f64; NUMBERS],
    /// Index of the signal, whose texts it has.
    signal: usize,
}

/// Records a fit. The bytes follow from the request alone.
///
/// # Errors
/// [`RecordError`].
pub fn record<W: Write>(fit: &Fit, request: &Request, target: W) -> Result<W, RecordError> {
    let scenario = &fit.scenario;
    let mut run = RunMessages::new(scenario, &Topics::All).map_err(RunError::from)?;
    let mut writer = McapWriter::new(target, scenario, run.telemetry(), Form::default())?;
    while let Some(record) = run.next(|message| Ok::<(), RecordError>(writer.write(message)?)) {
        record?;
    }
    let (mut data, mut residuals) = (Vec::new(), Vec::new());
    for value in &fit.residuals {
        // An offset may take a file's first value slightly before the start.
        let time_ns = nanoseconds(value.time.max(0.0));
        let signal = value.signal;
        data.push(SupplementRow {
            time_ns,
            numbers: [value.value, value.sigma],
            signal,
        });
        residuals.push(SupplementRow {
            time_ns,
            numbers: [value.residual, f64::from(u8::from(value.is_held_out))],
            signal,
        });
    }
    let (mut data_texts, mut residual_texts) = (Vec::new(), Vec::new());
    for signal in &fit.report.signals {
        data_texts.push(vec![signal.field.clone(), signal.unit.clone()]);
        residual_texts.push(vec![signal.field.clone()]);
    }
    write_rows(&mut writer, FIT_DATA, &data, &data_texts)?;
    write_rows(&mut writer, FIT_RESIDUAL, &residuals, &residual_texts)?;
    let problem = Problem {
        scenario: request.scenario.to_toml(),
        free: &request.free,
        bounds: &request.bounds,
        loss: request.loss,
        start: fit.report.origin,
        until: request.until,
        holdout: request.holdout,
        compare: &request.compare,
        profile: &request.profile,
        rescale: request.rescale,
    };
    let [problem_kind, report_kind] = SUPPLEMENTARY_ATTACHMENTS;
    writer.attach(problem_kind, &serde_json::to_vec_pretty(&problem)?)?;
    writer.attach(report_kind, &serde_json::to_vec_pretty(&fit.report)?)?;
    let (target, _) = writer.finish(end_entries(&run.end()))?;
    Ok(target)
}

fn write_rows<W: Write>(
    writer: &mut McapWriter<W>,
    topic: &str,
    rows: &[SupplementRow],
    texts: &[Vec<String>],
) -> Result<(), McapError> {
    let supplement = Supplement::find(topic).expect("the table of supplements has the topic");
    let messages = rows
        .iter()
        .map(|row| (row.time_ns, &row.numbers[..], &texts[row.signal][..]));
    writer.write_supplement(supplement, messages)
}
