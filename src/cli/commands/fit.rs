//! `toprise fit`.

use crate::archive::publish::{
    Draft, Drafts, Existing, check_not_an_input, check_target, is_same_file,
};
use crate::cli::arguments::{ArgumentError, Override, parse_number, parse_override};
use crate::cli::extension::{FeatureArguments as _, ShowFit, ShowFitArguments};
use crate::cli::file_kind::FileKind;
use crate::cli::input::open_scenario;
use crate::cli::interrupt;
use crate::cli::progress::Progress;
use crate::cli::report::{self, Completed, WrittenFile};
use crate::cli::status::Status;
use crate::cli::terminal;
use crate::figures;
use crate::fit::{
    self, Decimal, Delimiter, Fit, FitError, Layout, Loss, Report, Request, SignalSpec, Verdict,
};
use crate::run::scenario::Scenario;
use crate::words::{Section, markdown};
use anyhow::{Context as _, bail};
use clap::builder::PossibleValue;
use clap::{Args, ValueEnum};
use schemars::JsonSchema;
use serde::Serialize;
use std::io::{BufWriter, IntoInnerError, Write as _};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// An error of a fit, with arguments as options.
#[derive(Debug, Error)]
#[error("{}", .0.sentence().text(terminal::option))]
pub(super) struct FitFailure(FitError);

impl FitFailure {
    /// The key of the scenario that is wrong, if it is a single one.
    pub(super) fn key(&self) -> Option<&str> {
        self.0.key()
    }
}

impl<E: Into<FitError>> From<E> for FitFailure {
    fn from(error: E) -> Self {
        Self(error.into())
    }
}

/// Arguments of `toprise fit`.
#[derive(Args, Debug, Default, PartialEq)]
pub(in crate::cli) struct FitArguments {
    /// Preset, scenario file or recording with the known keys and the start values of the free ones
    #[arg(value_name = "SCENARIO")]
    scenario: PathBuf,

    /// Measured data: CSV files, recordings, MCAP files with JSON messages. Files share one clock; `--free offset` gives
    /// those after the first clocks of their own
    #[arg(value_name = "DATA", required = true)]
    data: Vec<PathBuf>,

    /// Free parameters: keys (comma-separated), `initial` for all of the start that the signals show, and `offset` for the
    /// clocks of further files
    #[arg(long, value_name = "KEYS", value_delimiter = ',', required = true, value_parser = parse_name)]
    free: Vec<String>,

    /// A signal: its field, column (or topic and path) and standard deviation, e.g. theta="tilt (deg)":2mrad; without
    /// standard deviation it is estimated [default: columns named like fields]
    #[arg(long = "signal", value_name = "FIELD=COLUMN:SIGMA", value_parser = parse_signal)]
    signals: Vec<SignalSpec>,

    /// The column of times, or the member of JSON messages [default: that which is named so; log times]
    #[arg(long, value_name = "COLUMN")]
    time: Option<String>,

    /// What separates the cells: comma, semicolon or tab [default: what makes rows of the first lines]
    #[arg(long, value_name = "CHARACTER")]
    delimiter: Option<Delimiter>,

    /// The decimal mark: point or comma [default: both where no commas separate the cells]
    #[arg(long, value_name = "MARK")]
    decimal: Option<Decimal>,

    /// Set a key of the scenario, e.g. friction.k=0.02
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = parse_override)]
    overrides: Vec<Override>,

    /// Bounds of a free parameter, e.g. friction.k=0..0.1
    #[arg(long = "bound", value_name = "KEY=LOW..HIGH", value_parser = parse_bound)]
    bounds: Vec<ParameterBounds>,

    /// Time in the data at which the scenario starts, s [default: the first sample; 0 for recordings of toprise]
    #[arg(long, value_name = "TIME", value_parser = parse_finite)]
    start: Option<f64>,

    /// Use only the data until this time on their clock, s
    #[arg(long, value_name = "TIME", value_parser = parse_finite)]
    until: Option<f64>,

    /// How residuals count: squares, or huber for data with outliers
    #[arg(long, value_enum, default_value_t, hide_possible_values = true)]
    loss: Loss,

    /// Multiply variances by χ²/ν, as if all standard deviations were wrong by one factor
    #[arg(long)]
    rescale: bool,

    /// Compare friction laws (comma-separated); `toprise laws` lists them
    #[arg(long, value_name = "LAWS", value_delimiter = ',', value_parser = parse_name)]
    compare: Vec<String>,

    /// Predict this part of the data at the end instead of fitting it, e.g. 0.2
    #[arg(long, value_name = "PART", default_value = "0", hide_default_value = true, value_parser = |text: &str| parse_number(text, 0.0..=0.9, "a number from 0 to 0.9"))]
    holdout: f64,

    /// Profile likelihood of parameters (comma-separated)
    #[arg(long, value_name = "KEYS", value_delimiter = ',', value_parser = parse_name)]
    profile: Vec<String>,

    /// Show all numbers
    #[arg(long)]
    all: bool,

    /// Record the best fit, with the preferred law, as an MCAP file, with the data and residuals
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Write the best fit, with the preferred law, as a scenario file
    #[arg(long = "scenario", value_name = "FILE")]
    best: Option<PathBuf>,

    /// Draw data, residuals, profiles and correlations as SVG files in this directory
    #[arg(long, value_name = "DIRECTORY")]
    figures: Option<PathBuf>,

    #[command(flatten)]
    show: ShowFitArguments,

    /// Overwrite existing files
    #[arg(long)]
    force: bool,
}

/// Width of figures, mm: two columns of plots.
const FIGURE_WIDTH: f64 = 170.0;

impl ValueEnum for Loss {
    fn value_variants<'a>() -> &'a [Self] {
        &[Self::Squares, Self::Huber]
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(match self {
            Self::Squares => "squares",
            Self::Huber => "huber",
        }))
    }
}

/// A parameter and its bounds.
type ParameterBounds = (String, [f64; 2]);

/// The arguments of the command, resolved.
struct FitPlan<'a> {
    arguments: &'a FitArguments,
    request: Request,
    inputs: Vec<PathBuf>,
    show: Option<Box<dyn ShowFit>>,
    existing: Existing,
}

/// The report of the command.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "FitReport")]
pub(super) struct FitReport {
    /// The fit.
    #[serde(flatten)]
    fit: Report,
    /// The files that were written.
    written: Vec<WrittenFile>,
}

impl FitReport {
    /// The report of the fit, and the files that were written.
    fn sections(&self, all: bool) -> Vec<Section> {
        let mut sections = self.fit.words(all).sections;
        if !self.written.is_empty() {
            let lines = self.written.iter().map(WrittenFile::line);
            sections.push(Section::from_lines("Written", lines));
        }
        sections
    }
}

/// Fits a scenario to data.
pub(super) fn fit(arguments: &FitArguments, drafts: &Drafts) -> Result<Status, anyhow::Error> {
    let plan = arguments.plan()?;
    let progress = Progress::for_state();
    let result = fit::fit(&plan.request, &|state| show(&progress, state));
    progress.finish();
    let fitted = match result {
        Ok(fitted) => fitted,
        Err(error) if error.is_of_motion() => {
            // The fit came to nothing, but for a reason that lies in the motion and not in the input.
            let message = FitFailure(error).to_string();
            crate::cli::output::error(&message);
            report::print_error(&message, None);
            return Ok(Status::Partial);
        }
        Err(error) => return Err(FitFailure(error).into()),
    };
    let complete = plan.write(&fitted, drafts)?;
    let sections = fitted.report.words(arguments.all).sections;
    let text = markdown(&sections, terminal::option);
    let shown = match &plan.show {
        Some(show) => show.show(&fitted, text, drafts, plan.existing)?,
        None => Completed::default(),
    };
    // Until here an interruption leaves all files as they were. From here on the first one is too late.
    interrupt::watch(drafts)?;
    let mut written = publish(complete)?;
    written.extend(shown.file);
    let report = FitReport {
        fit: fitted.report,
        written,
    };
    report::print(&report, || report.sections(arguments.all))?;
    if shown.is_viewer_lost {
        return Ok(Status::Partial);
    }
    Ok(status(&report.fit))
}

/// The status of a fit.
fn status(report: &Report) -> Status {
    // A verdict on a part of the data is not one on the data.
    if !report.losses.is_empty() {
        return Status::Partial;
    }
    match report.verdict {
        Verdict::Fitted => Status::Success,
        Verdict::BadFit | Verdict::Undecided => Status::Different,
        Verdict::NotConverged => Status::Partial,
    }
}

fn show(progress: &Progress, state: fit::Progress) {
    if state.chi2.is_finite() {
        progress.set_text(state.to_string());
    }
}

impl FitArguments {
    fn plan(&self) -> Result<FitPlan<'_>, anyhow::Error> {
        let inputs = self.inputs();
        let show = self.show.plan(())?;
        self.check_outputs(&inputs, show.as_deref())?;
        let scenario = open_scenario(&self.scenario, &self.overrides)?;
        let layout = Layout {
            time: self.time.clone(),
            delimiter: self.delimiter,
            decimal: self.decimal,
        };
        let data = fit::read(&self.data, &self.signals, &layout).map_err(FitFailure::from)?;
        Ok(FitPlan {
            arguments: self,
            request: Request {
                scenario,
                data,
                free: self.free.clone(),
                bounds: self.bounds.clone(),
                loss: self.loss,
                origin: self.start,
                until: self.until,
                holdout: self.holdout,
                compare: self.compare.clone(),
                profile: self.profile.clone(),
                rescale: self.rescale,
            },
            inputs,
            show,
            existing: Existing::forced(self.force),
        })
    }

    /// The files that are read.
    fn inputs(&self) -> Vec<PathBuf> {
        let mut inputs = vec![self.scenario.clone()];
        inputs.extend(self.data.iter().cloned());
        inputs
    }

    /// Refuses outputs that can't be written before anything is fitted.
    fn check_outputs(
        &self,
        inputs: &[PathBuf],
        show: Option<&dyn ShowFit>,
    ) -> Result<(), anyhow::Error> {
        if let Some(output) = &self.output {
            FileKind::Mcap.check("-o", output)?;
        }
        let outputs = self.outputs(show);
        for (place, output) in outputs.iter().enumerate() {
            check_not_an_input(output, inputs.iter().map(PathBuf::as_path))?;
            if outputs[..place]
                .iter()
                .any(|other| is_same_file(other, output))
            {
                bail!("two outputs are the same file, {}", output.display());
            }
        }
        // An input as an output is the graver mistake.
        if let Some(best) = &self.best {
            FileKind::Scenario.check("--scenario", best)?;
        }
        if let Some(directory) = self.figures.as_ref().filter(|path| path.is_file()) {
            bail!(
                "--figures {} is a file: name a directory",
                directory.display()
            );
        }
        for output in &outputs {
            check_target(output, Existing::forced(self.force))?;
        }
        Ok(())
    }

    /// The files that will be written.
    fn outputs(&self, show: Option<&dyn ShowFit>) -> Vec<PathBuf> {
        let mut outputs: Vec<PathBuf> = self.output.iter().chain(&self.best).cloned().collect();
        outputs.extend(show.and_then(|show| show.file()).map(Path::to_owned));
        if let Some(directory) = &self.figures {
            for name in figures::fit::names(&self.free, &self.profile, self.data.len()) {
                outputs.push(figure_path(directory, &name));
            }
        }
        outputs
    }
}

impl FitPlan<'_> {
    /// Writes the files that were asked for, still without their names.
    fn write(&self, fitted: &Fit, drafts: &Drafts) -> Result<Vec<Draft>, anyhow::Error> {
        let mut written = Vec::new();
        if let Some(path) = &self.arguments.best {
            let draft = self.create(drafts, path)?;
            written.push(write_scenario(draft, &fitted.scenario)?);
        }
        if let Some(path) = &self.arguments.output {
            let draft = self.create(drafts, path)?;
            written.push(write_recording(draft, fitted, &self.request)?);
        }
        if let Some(directory) = &self.arguments.figures {
            written.extend(self.write_figures(fitted, drafts, directory)?);
        }
        Ok(written)
    }

    fn write_figures(
        &self,
        fitted: &Fit,
        drafts: &Drafts,
        directory: &Path,
    ) -> Result<Vec<Draft>, anyhow::Error> {
        let created = std::fs::create_dir_all(directory);
        created.with_context(|| format!("cannot create {}", directory.display()))?;
        let mut written = Vec::new();
        for (name, drawing) in figures::fit::draw(fitted, FIGURE_WIDTH)? {
            let path = figure_path(directory, &name);
            let mut draft = self.create(drafts, &path)?;
            let result = draft.write_all(drawing.svg().as_bytes());
            result.with_context(|| format!("cannot write {}", path.display()))?;
            written.push(draft);
        }
        Ok(written)
    }

    /// Creates the draft of a file. The inputs are checked again, because links may have changed since.
    fn create(&self, drafts: &Drafts, path: &Path) -> Result<Draft, anyhow::Error> {
        check_not_an_input(path, self.inputs.iter().map(PathBuf::as_path))?;
        let draft = Draft::new_in(drafts, path, self.existing)?;
        crate::cli::output::warn_of_link(path, self.existing == Existing::Replace);
        Ok(draft)
    }
}

/// The file of a figure.
fn figure_path(directory: &Path, name: &str) -> PathBuf {
    directory.join(format!("{name}.svg"))
}

/// Gives complete files their names.
fn publish(complete: Vec<Draft>) -> Result<Vec<WrittenFile>, anyhow::Error> {
    let mut written = Vec::new();
    for draft in complete {
        written.push(WrittenFile::publish(draft)?);
    }
    Ok(written)
}

fn write_scenario(mut draft: Draft, scenario: &Scenario) -> Result<Draft, anyhow::Error> {
    let written = draft.write_all(scenario.to_toml().as_bytes());
    written.with_context(|| format!("cannot write {}", draft.path().display()))?;
    Ok(draft)
}

/// Records the best fit with its data.
fn write_recording(draft: Draft, fitted: &Fit, request: &Request) -> Result<Draft, anyhow::Error> {
    let problem = format!("cannot write {}", draft.path().display());
    let buffer =
        fit::record(fitted, request, BufWriter::new(draft)).with_context(|| problem.clone())?;
    // The rest of the buffer is written here; when dropped, an error would be lost.
    buffer
        .into_inner()
        .map_err(IntoInnerError::into_error)
        .with_context(|| problem)
}

fn parse_signal(text: &str) -> Result<SignalSpec, FitFailure> {
    Ok(SignalSpec::parse(text)?)
}

/// Parses a name in a list that is separated by commas.
fn parse_name(text: &str) -> Result<String, FitArgumentError> {
    match text.trim() {
        "" => Err(FitArgumentError::EmptyName),
        name => Ok(name.to_owned()),
    }
}

fn parse_bound(text: &str) -> Result<ParameterBounds, FitArgumentError> {
    let (key, range) = text.split_once('=').ok_or(FitArgumentError::Bound)?;
    let (low, high) = range.split_once("..").ok_or(FitArgumentError::Bound)?;
    match (low.trim().parse::<f64>(), high.trim().parse::<f64>()) {
        (Ok(low), Ok(high)) if low < high => Ok((key.trim().to_owned(), [low, high])),
        (Ok(low), Ok(high)) => Err(FitArgumentError::BoundOrder { low, high }),
        (Ok(_) | Err(_), Ok(_) | Err(_)) => Err(FitArgumentError::Bound),
    }
}

fn parse_finite(text: &str) -> Result<f64, ArgumentError> {
    parse_number(text, f64::MIN..=f64::MAX, "a number")
}

/// Error in the value of an option.
#[derive(Clone, Debug, PartialEq, Error)]
enum FitArgumentError {
    #[error("must be KEY=LOW..HIGH, as in friction.k=0..0.1")]
    Bound,
    #[error("the lower bound, {low}, must be less than the upper one, {high}")]
    BoundOrder { low: f64, high: f64 },
    #[error("a name in the list is empty")]
    EmptyName,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::arguments::parse;

    #[test]
    fn parses_a_fit() {
        let line =
            "paper data.csv --free friction.k,initial --bound friction.k=0..0.1 --loss huber";
        let arguments = parse::<FitArguments>(line).unwrap();
        assert_eq!(arguments.free, ["friction.k", "initial"]);
        assert_eq!(arguments.bounds, [("friction.k".to_owned(), [0.0, 0.1])]);
        assert_eq!(arguments.loss, Loss::Huber);
        for line in [
            "paper --free friction.k",
            "paper data.csv",
            "paper data.csv --free friction.k --bound friction.k=1..0",
            "paper data.csv --free friction.k --holdout 1",
            "paper data.csv --free friction.k --signal theta:0",
            "paper data.csv --free friction.k,,initial",
            "paper data.csv --free friction.k --profile ,",
        ] {
            assert!(parse::<FitArguments>(line).is_err(), "{line}");
        }
    }
}
