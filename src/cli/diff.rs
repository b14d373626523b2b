//! `toprise diff`.

mod content;
#[cfg(feature = "rerun")]
mod viewer;

use super::arguments::{Format, Override, parse_override};
use super::input::{Input, open};
use super::progress::Progress;
use super::status::Status;
use super::{output, report};
use crate::analysis::diff::{Observer, Options, Tolerance, Tolerances, Verdict, compare_observed};
#[cfg(feature = "rerun")]
use crate::archive::sink::SinkError;
#[cfg(feature = "rerun")]
use crate::telemetry::{Message, side::Side};
use anyhow::{Error, bail};
use clap::Args;
use std::path::PathBuf;

/// Arguments of `toprise diff`.
#[derive(Args, Debug, PartialEq)]
pub(super) struct DiffArguments {
    /// Two runs: presets, scenario files or recordings; or any two MCAP files.
    #[arg(required = true, num_args = 2, value_names = ["A", "B"])]
    runs: Vec<PathBuf>,

    /// Set a key of both scenarios, e.g. friction.k=0.02.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = parse_override)]
    overrides: Vec<Override>,

    /// Set a key of scenario A.
    #[arg(long = "set-a", value_name = "KEY=VALUE", value_parser = parse_override)]
    overrides_a: Vec<Override>,

    /// Set a key of scenario B.
    #[arg(long = "set-b", value_name = "KEY=VALUE", value_parser = parse_override)]
    overrides_b: Vec<Override>,

    /// Show every field, the averaged motion and the integration errors
    #[arg(long)]
    all: bool,

    #[command(flatten)]
    comparison: ComparisonArguments,

    #[cfg(feature = "rerun")]
    #[command(flatten)]
    show: viewer::ShowArguments,
}

/// What counts as a difference.
#[derive(Args, Debug, PartialEq)]
#[command(next_help_heading = "Comparison")]
struct ComparisonArguments {
    /// Absolute tolerance, in the unit of each field.
    #[arg(long, value_name = "NUMBER", default_value_t = 0.0)]
    abs: f64,

    /// Relative tolerance (relative to the larger magnitude)
    #[arg(long, value_name = "NUMBER", default_value_t = 0.0)]
    rel: f64,

    /// Tolerance for some fields, e.g. '/top/state.theta=1e-9' or '/top/torque.*=rel:1e-6'
    #[arg(long, value_name = "PATTERN=VALUE")]
    tol: Vec<String>,

    /// Compare only these topics (comma-separated)
    #[arg(long, value_name = "TOPICS", value_delimiter = ',')]
    topics: Vec<String>,

    /// Ignore these topics or fields, e.g. /top/pose or '/top/state.*_ddot'
    #[arg(long, value_name = "PATTERN")]
    ignore: Vec<String>,

    /// Don't estimate integration errors (much faster)
    #[arg(long)]
    no_floor: bool,
}

impl ComparisonArguments {
    fn options(&self) -> Result<Options, Error> {
        let mut tolerances = Tolerances {
            general: Tolerance {
                abs: self.abs,
                rel: self.rel,
            },
            ignored: self.ignore.clone(),
            ..Tolerances::default()
        };
        tolerances.check()?;
        for tolerance in &self.tol {
            tolerances.add(tolerance)?;
        }
        Ok(Options {
            tolerances,
            floor: !self.no_floor,
            topics: self.topics.clone(),
        })
    }
}

impl DiffArguments {
    fn inputs(&self) -> Result<[Input; 2], Error> {
        let a = open(&self.runs[0], &self.overrides, &self.overrides_a)?;
        let b = open(&self.runs[1], &self.overrides, &self.overrides_b)?;
        let is_recording = |run: &Input| matches!(run, Input::Recording(_));
        if !self.overrides.is_empty() && is_recording(&a) && is_recording(&b) {
            bail!("--set requires a preset or scenario file, but both runs are recordings");
        }
        Ok([a, b])
    }
}

/// Compares two runs.
pub(super) fn diff(arguments: &DiffArguments) -> Result<Status, Error> {
    let options = arguments.comparison.options()?;
    let [a, b] = arguments.inputs()?;
    let subjects = [&a, &b].map(Input::subject);
    let progress = Progress::of_bytes("comparing", a.bytes() + b.bytes());
    let mut watching = Observers {
        progress: &progress,
        #[cfg(feature = "rerun")]
        viewer: arguments.show.open(subjects, &arguments.runs)?,
    };
    let compared = compare_observed(subjects[0], subjects[1], &options, &mut watching);
    progress.finish();
    let report = compared?;
    // A document has room for whole values.
    let is_cut = !arguments.all && output::format() == Format::Text;
    report::print(&report, || content::page(&report, arguments.all, is_cut))?;
    #[cfg(feature = "rerun")]
    if let Some(viewer) = watching.viewer {
        viewer.finish(&report)?;
    }
    Ok(match report.verdict {
        Verdict::Different => Status::Different,
        Verdict::Agreeing => Status::Partial,
        Verdict::Identical | Verdict::SameValues | Verdict::Equal => Status::Success,
    })
}

/// Observers of a comparison: progress bar and viewer.
struct Observers<'a> {
    progress: &'a Progress,
    #[cfg(feature = "rerun")]
    viewer: Option<viewer::Viewer>,
}

impl Observer for Observers<'_> {
    #[cfg(feature = "rerun")]
    fn message(&mut self, side: Side, message: &Message<'_>) -> Result<(), SinkError> {
        if let Some(viewer) = &mut self.viewer {
            viewer.sink.write(side, message);
        }
        Ok(())
    }

    #[cfg(feature = "rerun")]
    fn difference(&mut self, message: &Message<'_>) -> Result<(), SinkError> {
        if let Some(viewer) = &mut self.viewer {
            viewer.sink.difference(message);
        }
        Ok(())
    }

    fn progress(&mut self, bytes: u64) {
        self.progress.add(bytes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::arguments::parse;

    #[test]
    fn runs_and_tolerances_are_named() {
        let base = parse::<DiffArguments>("a b").unwrap();
        let line = "a b --rel 1e-9 --tol *=rel:1e-6 --topics /events,/top/state";
        let comparison = ComparisonArguments {
            rel: 1e-9,
            tol: vec!["*=rel:1e-6".to_owned()],
            topics: vec!["/events".to_owned(), "/top/state".to_owned()],
            ..base.comparison
        };
        assert_eq!(
            parse::<DiffArguments>(line).unwrap(),
            DiffArguments { comparison, ..base }
        );
        for line in ["a", "a b c", "a b --rel x", "a b --align time"] {
            assert!(parse::<DiffArguments>(line).is_err(), "{line}");
        }
    }
}
