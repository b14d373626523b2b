//! The best fit with its data, in Rerun.

use super::viewer::{ViewerArguments, complete, warn_all};
use crate::archive::publish::{Draft, Drafts, Existing};
use crate::archive::sink::{RecordedRun, Sink, record_all};
use crate::cli::arguments::OUTPUT;
use crate::cli::extension::{FeatureArguments, ShowFit};
use crate::cli::file_kind::FileKind;
use crate::cli::output;
use crate::cli::report::Completed;
use crate::fit::Fit;
use crate::rerun::{
    Destinations, ExplainedSink, Identity, Live, MeasuredSignal, MeasuredValue, Measurement,
};
use crate::run::time::nanoseconds;
use crate::telemetry::{RunMessages, Topic, Topics};
use anyhow::Error;
use clap::Args;
use std::path::{Path, PathBuf};

/// Viewer options of `fit`.
#[derive(Args, Clone, Debug, Default, PartialEq)]
pub(in crate::cli) struct ShowFitArguments {
    /// Write a Rerun recording of the best fit, the data and the residuals to this file
    #[arg(long, value_name = "FILE", help_heading = OUTPUT)]
    rrd: Option<PathBuf>,

    #[command(flatten)]
    viewer: ViewerArguments,
}

/// Where a fit is shown.
struct ShowFitPlan {
    rrd: Option<PathBuf>,
    live: Option<Live>,
}

impl FeatureArguments<(), Box<dyn ShowFit>> for ShowFitArguments {
    fn plan(&self, (): ()) -> Result<Option<Box<dyn ShowFit>>, Error> {
        if let Some(rrd) = &self.rrd {
            FileKind::Rrd.check("--rrd", rrd)?;
        }
        let live = self.viewer.live();
        if self.rrd.is_none() && live.is_none() {
            return Ok(None);
        }
        Ok(Some(Box::new(ShowFitPlan {
            rrd: self.rrd.clone(),
            live,
        })))
    }
}

impl ShowFit for ShowFitPlan {
    fn file(&self) -> Option<&Path> {
        self.rrd.as_deref()
    }

    fn show(
        &self,
        fit: &Fit,
        report: String,
        drafts: &Drafts,
        existing: Existing,
    ) -> Result<Completed, Error> {
        let mut draft = None;
        if let Some(rrd) = &self.rrd {
            draft = Some(Draft::new_in(drafts, rrd, existing)?);
            output::warn_of_link(rrd, existing == Existing::Replace);
        }
        let destinations = Destinations {
            file: draft.as_ref().map(Draft::file).transpose()?,
            live: self.live.clone(),
        };
        let mut sink = ExplainedSink::new(&fit.scenario, &identity(fit, report), destinations);
        let is_viewer_lost = warn_all(&sink.take_warnings());
        record_run(fit, &mut sink)?;
        let mut completed = complete(sink.finish(), draft)?;
        completed.is_viewer_lost |= completed.file.is_none() && is_viewer_lost;
        Ok(completed)
    }
}

/// Simulates the best fit.
fn record_run(fit: &Fit, sink: &mut ExplainedSink) -> Result<(), Error> {
    let mut run = RunMessages::new(&fit.scenario, &Topics::All)?;
    let mut sinks: [&mut dyn Sink; 1] = [sink];
    let RecordedRun { outcome, error } = record_all(&mut run, &mut sinks)?;
    match error {
        Some(error) => output::warn(&error.to_string()),
        None => sink.set_outcome(&outcome),
    }
    Ok(())
}

fn identity(fit: &Fit, report: String) -> Identity {
    let scenario = &fit.scenario;
    let name = format!("fit of {}", scenario.name());
    let topics = Topic::all_with(scenario.model.support).collect();
    Identity::for_fit(&name, scenario, topics, measurement(fit, report))
}

fn measurement(fit: &Fit, report: String) -> Measurement {
    let mut signals = Vec::new();
    for (signal, field) in fit.report.signals.iter().zip(&fit.fields) {
        signals.push(MeasuredSignal {
            field: *field,
            source: signal.source.clone(),
            values: Vec::new(),
        });
    }
    for value in &fit.residuals {
        signals[value.signal].values.push(MeasuredValue {
            // An offset may take a file's first value slightly before the start.
            time_ns: nanoseconds(value.time.max(0.0)),
            value: value.value,
            sigma: value.sigma,
            residual: value.residual,
            is_held_out: value.is_held_out,
        });
    }
    Measurement { signals, report }
}
