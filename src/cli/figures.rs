//! `toprise figures`.

#[cfg(feature = "sweep")]
mod sweep;

#[cfg(feature = "sweep")]
use self::sweep::SweepFigure;
use super::arguments::{OUTPUT, parse_number};
use super::input::{Input, open};
use super::output;
use super::page::Section;
use super::progress::Progress;
use super::report;
use super::status::Status;
use super::table::Table;
use crate::archive::publish::{self, Existing};
use crate::archive::sink::SinkError;
use crate::figures::{
    Drawing, FIGURES, Figure, FigureFile, FiguresReport, Lacking, LeftOut, RunData, RunLoss,
};
use anyhow::{Context as _, Error, bail};
use clap::builder::PossibleValuesParser;
use clap::{Args, ValueEnum};
use rayon::iter::{IntoParallelRefIterator as _, ParallelIterator as _};
#[cfg(feature = "sweep")]
use std::path::Path;
use std::path::PathBuf;

/// Arguments of `toprise figures`.
#[derive(Args, Debug, PartialEq)]
pub(super) struct FiguresArguments {
    /// Recordings, presets or scenario files to overlay [default: the paper's runs].
    #[arg(value_name = "RUN")]
    runs: Vec<PathBuf>,

    /// Output directory
    #[arg(short, long, value_name = "DIRECTORY", default_value = "figures", help_heading = OUTPUT)]
    output: PathBuf,

    /// Draw only these figures (comma-separated)
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = names(), hide_possible_values = true)]
    only: Vec<String>,

    /// File types (comma-separated)
    #[arg(
        long,
        value_enum,
        value_delimiter = ',',
        value_name = "KINDS",
        default_value = "svg,png", help_heading = OUTPUT)]
    kinds: Vec<Kind>,

    #[cfg(feature = "sweep")]
    #[command(flatten)]
    sweep: SweepFigure,

    /// Width from 80 to 400 mm; 130 or more gives two columns of plots
    #[arg(long, value_name = "MM", default_value_t = 85.0, value_parser = parse_width, help_heading = OUTPUT)]
    width: f64,

    /// Overwrite existing files.
    #[arg(long, help_heading = OUTPUT)]
    force: bool,
}

/// The kind of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// Vector graphics
    Svg,
    /// Bitmap, 300 dpi
    Png,
}

impl Kind {
    fn extension(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Png => "png",
        }
    }

    fn bytes(self, drawing: &Drawing) -> Result<Vec<u8>, Error> {
        Ok(match self {
            Self::Svg => drawing.svg().into_bytes(),
            Self::Png => drawing.png()?,
        })
    }
}

fn names() -> PossibleValuesParser {
    FIGURES.iter().map(|figure| figure.name).into()
}

fn parse_width(text: &str) -> Result<f64, String> {
    let is_width = |width: &f64| (80.0..=400.0).contains(width);
    parse_number(text, is_width, "must be from 80 to 400 (mm)")
}

/// The runs of the paper's figures: the first of all, the others only of figure 4.
const PAPER: [&str; 3] = [
    "paper",
    "paper-precession-term-only",
    "paper-spin-term-only",
];

impl FiguresArguments {
    /// The runs on the command line, or those of the paper.
    fn words(&self) -> Vec<PathBuf> {
        if self.runs.is_empty() {
            return PAPER.map(PathBuf::from).to_vec();
        }
        self.runs.clone()
    }

    /// The figures to draw, limited to those that apply to this number of runs.
    fn figures(&self) -> Result<Vec<&'static Figure>, Error> {
        let is_asked = |figure: &&Figure| self.only.iter().any(|name| name == figure.name);
        let runs = self.words().len();
        let has_runs = |figure: &&Figure| figure.min_runs <= runs;
        if let Some(figure) = FIGURES.iter().filter(is_asked).find(|f| !has_runs(f)) {
            let (name, least) = (figure.name, figure.min_runs);
            bail!("{name} compares runs: name at least {least}, or none to draw the paper's runs");
        }
        let is_wanted = |figure: &&Figure| self.only.is_empty() || is_asked(figure);
        Ok(FIGURES.iter().filter(has_runs).filter(is_wanted).collect())
    }

    /// The kinds of files, each once.
    fn kinds(&self) -> impl Iterator<Item = Kind> {
        let kinds = Kind::value_variants().iter().copied();
        kinds.filter(|kind| self.kinds.contains(kind))
    }

    fn path(&self, figure: &str, kind: Kind) -> PathBuf {
        self.output.join(format!("{figure}.{}", kind.extension()))
    }

    /// Checks the output files before computing anything.
    fn check_files(&self, figures: &[&str]) -> Result<(), SinkError> {
        let inputs = self.runs.iter();
        #[cfg(feature = "sweep")]
        let inputs = inputs.chain(self.sweep.table());
        let paths = |&figure| self.kinds().map(move |kind| self.path(figure, kind));
        for path in figures.iter().flat_map(paths) {
            publish::refuse_inputs(&path, inputs.clone().map(PathBuf::as_path))?;
            if !self.force && path.symlink_metadata().is_ok() {
                let advice = "choose another directory, or replace it with --force".to_owned();
                return Err(SinkError::Exists { path, advice });
            }
        }
        Ok(())
    }

    /// Number of runs in a figure: one of the paper's runs, unless the figure compares runs.
    fn count(&self, figure: &Figure, runs: usize) -> usize {
        if self.runs.is_empty() && figure.min_runs == 1 {
            1
        } else {
            runs
        }
    }

    /// Whether a figure shows a run; otherwise the report says why not.
    fn can_draw(&self, figure: &Figure, run: &RunData, report: &mut FiguresReport) -> bool {
        let (name, run_name) = (figure.name, run.name.clone());
        if let Some(because) = figure.exclusion(run) {
            let is_expected = figure.is_expected_for(run) || !self.only.is_empty();
            report.left_out.extend(is_expected.then_some(LeftOut {
                figure: name,
                run: run_name,
                because,
            }));
            return false;
        }
        let missing = figure.missing(run);
        let is_whole = missing.is_none();
        report.lacking.extend(missing.map(|missing| Lacking {
            figure: name,
            run: run_name,
            missing: missing.to_string(),
        }));
        is_whole
    }
}

/// Draws figures of runs.
pub(super) fn figures(arguments: &FiguresArguments) -> Result<Status, Error> {
    #[cfg(feature = "sweep")]
    if let Some(table) = arguments.sweep.table() {
        return sweep_figure(arguments, table);
    }
    let figures = arguments.figures()?;
    let names: Vec<_> = figures.iter().map(|figure| figure.name).collect();
    arguments.check_files(&names)?;
    let runs = runs(arguments, &figures)?;
    let mut report = FiguresReport::default();
    for run in &runs {
        report.losses.extend(run.losses.iter().map(|loss| RunLoss {
            run: run.name.clone(),
            loss: loss.clone(),
        }));
    }
    let mut drawn = Vec::new();
    for figure in figures {
        let count = arguments.count(figure, runs.len());
        let able = runs[..count].iter();
        let able = able.filter(|run| arguments.can_draw(figure, run, &mut report));
        let able: Vec<_> = able.collect();
        // Skip comparisons with a missing run.
        let is_able = figure.min_runs == 1 || able.len() == count;
        if is_able && !able.is_empty() {
            drawn.push((figure, able));
        }
    }
    warn(&report);
    if drawn.is_empty() {
        match report.left_out.first() {
            Some(left) => bail!(
                "nothing to draw: {} does not apply to {}: {}",
                left.figure,
                left.run,
                left.because
            ),
            None => bail!("nothing can be drawn"),
        }
    }
    for (figure, runs) in drawn {
        let drawing = figure.draw(&runs, arguments.width);
        let names: Vec<_> = runs.iter().map(|run| run.name.clone()).collect();
        let files = write(arguments, (figure.name, figure.title), &names, &drawing)?;
        report.files.extend(files);
    }
    report::print(&report, || page(&report))?;
    let is_whole = report.losses.is_empty() && report.lacking.is_empty();
    Ok(Status::of_whole(is_whole))
}

fn warn(report: &FiguresReport) {
    for RunLoss { run, loss } in &report.losses {
        output::warn(&format!("{run}: {loss}"));
    }
    for lack in &report.lacking {
        let (run, figure, missing) = (&lack.run, lack.figure, &lack.missing);
        output::warn(&format!(
            "{figure} of {run} skipped: the run has no {missing}"
        ));
    }
}

fn page(report: &FiguresReport) -> Vec<Section> {
    let wrote = |file: &FigureFile| ("wrote", report::file_line(&file.path, file.bytes));
    let mut section = Section::default();
    section.table(Table::of_facts(report.files.iter().map(wrote)));
    for left in &report.left_out {
        let (figure, run, because) = (left.figure, &left.run, left.because);
        section.line(format!("skipped: {figure} of {run}; {because}"));
    }
    vec![section]
}

/// Reads or simulates the runs in parallel.
fn runs(arguments: &FiguresArguments, figures: &[&Figure]) -> Result<Vec<RunData>, Error> {
    let inputs = inputs(arguments, figures)?;
    let bytes = inputs.iter().map(|(_, input)| input.bytes()).sum();
    let progress = Progress::of_bytes("reading", bytes);
    let read = |(name, input): &(String, Input)| {
        RunData::read(input.subject(), name, figures, &|bytes| progress.add(bytes))
    };
    let runs = inputs.par_iter().map(read).collect();
    progress.finish();
    Ok(runs)
}

/// The runs with their names in legends.
fn inputs(
    arguments: &FiguresArguments,
    figures: &[&Figure],
) -> Result<Vec<(String, Input)>, Error> {
    let mut words = arguments.words();
    let counts = figures
        .iter()
        .map(|figure| arguments.count(figure, words.len()));
    words.truncate(counts.max().unwrap_or(0));
    let stem = |word: &PathBuf| word.file_stem().unwrap_or(word.as_os_str()).to_owned();
    let stems: Vec<_> = words.iter().map(stem).collect();
    let is_unique = |stem| stems.iter().filter(|other| *other == stem).count() == 1;
    words
        .iter()
        .zip(&stems)
        .map(|(word, stem)| {
            let name = if is_unique(stem) {
                stem
            } else {
                word.as_os_str()
            };
            let name = name.to_string_lossy().into_owned();
            Ok((name, open(word, &[], &[])?))
        })
        .collect()
}

/// Writes the files of a figure, given its name and title.
fn write(
    arguments: &FiguresArguments,
    (figure, title): (&'static str, &'static str),
    runs: &[String],
    drawing: &Drawing,
) -> Result<Vec<FigureFile>, Error> {
    let write = |kind: Kind| {
        let path = arguments.path(figure, kind);
        let context = || path.display().to_string();
        let bytes = kind.bytes(drawing).with_context(context)?;
        output::warn_of_link(&path, arguments.force);
        publish::write(&path, Existing::forced(arguments.force), &bytes)?;
        Ok(FigureFile {
            figure,
            title,
            runs: runs.to_vec(),
            path: context(),
            bytes: bytes.len() as u64,
        })
    };
    arguments.kinds().map(write).collect()
}

/// Name and title of the figure of a sweep.
#[cfg(feature = "sweep")]
const SWEEP: (&str, &str) = ("sweep", "Outcomes of the runs of a sweep");

/// Draws a map or curves of a sweep.
#[cfg(feature = "sweep")]
fn sweep_figure(arguments: &FiguresArguments, table: &Path) -> Result<Status, Error> {
    arguments.check_files(&[SWEEP.0])?;
    let name = table.display().to_string();
    let map = arguments.sweep.read(table)?;
    let drawing = map.draw(arguments.width).with_context(|| name.clone())?;
    let report = FiguresReport {
        files: write(arguments, SWEEP, &[name], &drawing)?,
        ..FiguresReport::default()
    };
    report::print(&report, || page(&report))?;
    Ok(Status::Success)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::arguments::parse;

    #[test]
    fn figures_are_chosen_by_their_names() {
        let base = parse::<FiguresArguments>("").unwrap();
        assert_eq!(base.kinds, [Kind::Svg, Kind::Png]);
        assert_eq!(base.width, 85.0);
        assert_eq!(
            parse::<FiguresArguments>("a.mcap paper --only figure-2,figure-4 --kinds png").unwrap(),
            FiguresArguments {
                runs: vec!["a.mcap".into(), "paper".into()],
                only: vec!["figure-2".to_owned(), "figure-4".to_owned()],
                kinds: vec![Kind::Png],
                ..base
            }
        );
        for line in ["--only figure-7", "--width 20", "--kinds pdf"] {
            assert!(parse::<FiguresArguments>(line).is_err(), "{line}");
        }
    }
}
