//! `toprise diff`.

pub(in crate::cli) mod content;
mod csv;
mod slip;
mod variation;

use self::slip::LawPlot;
use self::variation::{VariationArguments, VariationPlan};
use super::image::Plot;
use crate::analysis::diff::{
    Observer, Options, Report, Tolerance, Tolerances, Verdict, compare_observed,
};
use crate::archive::publish::{Drafts, Existing};
use crate::archive::sink::SinkError;
use crate::cli::arguments::{Format, OUTPUT, Override, parse_override, parse_tolerance};
use crate::cli::extension::{FeatureArguments as _, PairViewer, ShowPair, ShowPairArguments};
use crate::cli::input::{OpenRun, open};
use crate::cli::progress::Progress;
use crate::cli::status::Status;
use crate::cli::{output, report, terminal};
use crate::telemetry::{Message, side::Side};
use crate::words::Section;
use anyhow::{Error, bail};
use clap::Args;
use clap::builder::NonEmptyStringValueParser;
use std::path::PathBuf;

/// Arguments of `toprise diff`.
#[derive(Args, Debug, PartialEq)]
pub(in crate::cli) struct DiffArguments {
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

    #[command(flatten)]
    variation: VariationArguments,

    /// Draw both laws of friction, with the slip speeds of the runs, as SVG or PNG
    #[arg(long, value_name = "FILE", help_heading = OUTPUT)]
    plot: Option<PathBuf>,

    #[command(flatten)]
    show: ShowPairArguments,

    /// Overwrite existing files.
    #[arg(long, help_heading = OUTPUT)]
    force: bool,
}

/// What counts as a difference.
#[derive(Args, Debug, PartialEq)]
#[command(next_help_heading = "Comparison")]
struct ComparisonArguments {
    /// Absolute tolerance, in the unit of each field.
    #[arg(long, value_name = "NUMBER", default_value_t = 0.0, value_parser = parse_tolerance)]
    abs: f64,

    /// Relative tolerance (relative to the larger magnitude)
    #[arg(long, value_name = "NUMBER", default_value_t = 0.0, value_parser = parse_tolerance)]
    rel: f64,

    /// Tolerance for some fields, e.g. '/top/state.theta=1e-9' or '/top/torque.*=rel:1e-6'
    #[arg(long, value_name = "PATTERN=VALUE")]
    tol: Vec<String>,

    /// Compare only these topics (comma-separated)
    #[arg(long, value_name = "TOPICS", value_delimiter = ',', value_parser = NonEmptyStringValueParser::new())]
    topics: Vec<String>,

    /// Ignore these topics or fields, e.g. /top/pose or '/top/state.*_ddot'
    #[arg(long, value_name = "PATTERN")]
    ignore: Vec<String>,

    /// Don't estimate integration errors (much faster)
    #[arg(long, alias = "no-floor")]
    no_integration_error: bool,
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
        // Each --tol checks all tolerances, but there may be none.
        tolerances.check()?;
        for tolerance in &self.tol {
            tolerances.add(tolerance)?;
        }
        Ok(Options {
            tolerances,
            integration_error: !self.no_integration_error,
            topics: self.topics.clone(),
        })
    }
}

/// A comparison and what becomes of it.
struct DiffPlan {
    runs: [OpenRun; 2],
    options: Options,
    /// Whether everything is printed.
    all: bool,
    plot: Option<LawPlot>,
    variation: VariationPlan,
    show: Option<Box<dyn ShowPair>>,
}

impl DiffArguments {
    /// Resolves the arguments, and opens the runs.
    fn plan(&self) -> Result<DiffPlan, Error> {
        let options = self.comparison.options()?;
        let a = open(&self.runs[0], &self.overrides, &self.overrides_a)?;
        let b = open(&self.runs[1], &self.overrides, &self.overrides_b)?;
        if !self.overrides.is_empty() && a.is_recording() && b.is_recording() {
            bail!("--set requires a preset or scenario file, but both runs are recordings");
        }
        let existing = Existing::forced(self.force);
        let plot = match &self.plot {
            Some(path) => {
                let plot = Plot::new(path, existing, &self.runs)?;
                Some(LawPlot::new(plot, [&a, &b])?)
            }
            None => None,
        };
        // The estimate of the integration errors takes longer, too.
        let is_sensitive = self.all && options.integration_error;
        let variation = self.variation.plan([&a, &b], is_sensitive)?;
        Ok(DiffPlan {
            runs: [a, b],
            variation,
            options,
            all: self.all,
            plot,
            show: self.show.plan((self.runs.as_slice(), existing))?,
        })
    }
}

/// Compares two runs.
pub(super) fn diff(arguments: &DiffArguments, drafts: &Drafts) -> Result<Status, Error> {
    let DiffPlan {
        runs: [a, b],
        options,
        all,
        plot,
        variation,
        show,
    } = arguments.plan()?;
    let subjects = [a.subject(), b.subject()];
    let names = [a.name(), b.name()];
    let progress = Progress::for_bytes("comparing", a.bytes() + b.bytes());
    let shown = names.each_ref().map(String::as_str);
    let viewer = match show {
        Some(show) => Some(show.open(subjects, shown, drafts)?),
        None => None,
    };
    let mut observers = Observers {
        progress: &progress,
        viewer,
    };
    let compared = compare_observed(subjects[0], subjects[1], &options, &mut observers);
    progress.finish();
    let mut report = compared?;
    // Runs are called as on the command line, which the comparison doesn't know.
    [report.a.name, report.b.name] = names;
    variation.add_to(&mut report)?;
    // A document has room for whole values.
    let is_cut = !all && output::format() == Format::Text;
    match output::format() {
        Format::Csv => output::print(&csv::table(&report))?,
        Format::Text | Format::Json | Format::Markdown => {
            report::print(&report, || page(&report, all, is_cut))?;
        }
    }
    if let Some(plot) = plot {
        plot.write(&report, drafts)?;
    }
    let is_viewer_lost = match observers.viewer {
        Some(viewer) => viewer.finish(&report)?,
        None => false,
    };
    Ok(match report.verdict {
        Verdict::Different => Status::Different,
        Verdict::Agreeing => Status::Partial,
        // The comparison is complete, but not what was to be shown of it.
        _ if is_viewer_lost => Status::Partial,
        Verdict::Identical | Verdict::SameValues | Verdict::Equal => Status::Success,
    })
}

/// The page, with the numbers of programs where a program reads it.
fn page(report: &Report, all: bool, is_cut: bool) -> Vec<Section> {
    let mut sections = content::page(report, all, is_cut);
    if output::is_for_programs() {
        for section in &mut sections {
            *section = section.with_plain_numbers(terminal::option);
        }
    }
    sections
}

/// Observers of a comparison: progress bar and viewer.
struct Observers<'a> {
    progress: &'a Progress,
    viewer: Option<Box<dyn PairViewer>>,
}

impl Observer for Observers<'_> {
    fn message(&mut self, side: Side, message: &Message<'_>) -> Result<(), SinkError> {
        if let Some(viewer) = &mut self.viewer {
            viewer.write(side, message);
        }
        Ok(())
    }

    fn difference(&mut self, message: &Message<'_>) -> Result<(), SinkError> {
        if let Some(viewer) = &mut self.viewer {
            viewer.write_difference(message);
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
    fn parses_runs_and_tolerances() {
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
        // The only file that it writes has the letter that other commands have for theirs.
        let is_written = parse::<DiffArguments>("a b -o pair.rrd").is_ok();
        assert_eq!(is_written, cfg!(feature = "rerun"));
        for line in ["a", "a b c", "a b --rel x", "a b --align time"] {
            assert!(parse::<DiffArguments>(line).is_err(), "{line}");
        }
    }
}
