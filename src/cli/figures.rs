//! `toprise figures`.

use super::arguments::FormArguments;
use super::done::Done;
use super::given::{Given, open};
use super::output;
use super::page::{Page, Section};
use super::progress::Progress;
use super::report;
use super::table::Table;
use crate::analysis::figures::{
    Drawing, FIGURES, Figure, FigureFile, FiguresReport, Lacking, Run, RunLoss,
};
use crate::archive::publish::{self, Existing};
use crate::archive::sink::SinkError;
use crate::run::scenario::Preset;
use anyhow::{Context as _, Error, bail};
use clap::builder::PossibleValuesParser;
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use std::thread;

/// Arguments of `toprise figures`.
#[derive(Args, Debug, PartialEq)]
pub(super) struct FiguresArguments {
    /// Recordings, presets or scenario files; several are drawn over one another. Without any the paper's
    /// runs are simulated.
    #[arg(value_name = "RUN")]
    runs: Vec<PathBuf>,

    /// The directory for the figures.
    #[arg(short, long, value_name = "DIRECTORY", default_value = "figures")]
    output: PathBuf,

    /// Draw only these figures, separated by commas.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = names())]
    only: Vec<String>,

    /// Kinds of files, separated by commas.
    #[arg(
        long,
        value_enum,
        value_delimiter = ',',
        value_name = "KINDS",
        default_value = "svg,png"
    )]
    kinds: Vec<Kind>,

    /// Width of the figures in mm: from 130 mm on there are two columns of plots.
    #[arg(long, value_name = "MM", default_value_t = 85.0, value_parser = parse_width)]
    width: f64,

    /// Replace files that exist.
    #[arg(long)]
    force: bool,

    #[command(flatten)]
    form: FormArguments,
}

/// The kind of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// Lines at any size, for print.
    Svg,
    /// Pixels, 300 per inch.
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
    PossibleValuesParser::new(FIGURES.iter().map(|figure| figure.name))
}

fn parse_width(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|width| (80.0..=400.0).contains(width))
        .ok_or_else(|| "must be a width in mm from 80 to 400".to_owned())
}

/// The runs of the paper's figures: the first of all, the others only of figure 4.
const PAPER: &[&str] = &[
    "paper",
    "paper-precession-term-only",
    "paper-spin-term-only",
];

impl FiguresArguments {
    /// The figures to draw, of those that can be drawn of so many runs.
    fn figures(&self) -> Result<Vec<&'static Figure>, Error> {
        let is_asked = |figure: &&Figure| self.only.iter().any(|name| name == figure.name);
        let runs = if self.runs.is_empty() {
            PAPER.len()
        } else {
            self.runs.len()
        };
        let has_runs = |figure: &&Figure| figure.least_runs <= runs;
        if let Some(figure) = FIGURES.iter().filter(is_asked).find(|f| !has_runs(f)) {
            let Figure {
                name, least_runs, ..
            } = figure;
            bail!("{name} compares runs: name {least_runs} or more, or none for the paper's");
        }
        let all = FIGURES.iter().filter(has_runs);
        Ok(if self.only.is_empty() {
            all.collect()
        } else {
            all.filter(is_asked).collect()
        })
    }

    /// The kinds of files, each once.
    fn kinds(&self) -> impl Iterator<Item = Kind> {
        let kinds = Kind::value_variants().iter().copied();
        kinds.filter(|kind| self.kinds.contains(kind))
    }

    fn path(&self, figure: &Figure, kind: Kind) -> PathBuf {
        let name = format!("{}.{}", figure.name, kind.extension());
        self.output.join(name)
    }

    /// Refuses before anything is computed what would be refused after it.
    fn check_files(&self, figures: &[&Figure]) -> Result<(), SinkError> {
        let all = figures
            .iter()
            .flat_map(|figure| self.kinds().map(|kind| self.path(figure, kind)));
        let all: Vec<_> = all.collect();
        for path in &all {
            publish::refuse_inputs(path, self.runs.iter().map(PathBuf::as_path))?;
        }
        let taken = all.into_iter().find(|path| path.symlink_metadata().is_ok());
        match taken {
            Some(path) if !self.force => Err(SinkError::Exists {
                path,
                advice: "choose another directory, or replace it with --force".to_owned(),
            }),
            _ => Ok(()),
        }
    }

    /// How many of the runs a figure is drawn of: of the paper's it is one, unless it compares.
    fn count(&self, figure: &Figure, runs: usize) -> usize {
        if self.runs.is_empty() && figure.least_runs == 1 {
            1
        } else {
            runs
        }
    }
}

/// Draws figures of runs.
pub(super) fn figures(arguments: &FiguresArguments) -> Result<Done, Error> {
    let figures = arguments.figures()?;
    arguments.check_files(&figures)?;
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
        let (able, lacking) = divided(figure, &runs[..count]);
        report
            .lacking
            .extend(lacking.into_iter().map(|(run, missing)| Lacking {
                figure: figure.name,
                run: run.name.clone(),
                missing,
            }));
        // A comparison without one of its runs would be another.
        let is_able = figure.least_runs == 1 || able.len() == count;
        if is_able && !able.is_empty() {
            drawn.push((figure, able));
        }
    }
    warn(&report);
    if drawn.is_empty() {
        bail!("nothing can be drawn");
    }
    report.files = write_all(arguments, &drawn)?;
    report::print(&report, arguments.form.format(), || page(&report))?;
    Ok(if report.losses.is_empty() && report.lacking.is_empty() {
        Done::Well
    } else {
        Done::WithLosses
    })
}

fn warn(report: &FiguresReport) {
    for RunLoss { run, loss } in &report.losses {
        output::warn(&format!("{run}: {loss}"));
    }
    for Lacking {
        run,
        figure,
        missing,
    } in &report.lacking
    {
        output::warn(&format!("{run}: {figure} needs {missing}, which it lacks"));
    }
}

fn page(report: &FiguresReport) -> Page {
    let wrote = |file: &FigureFile| ("wrote", report::file_line(&file.path, file.bytes));
    let mut section = Section::default();
    section.table(Table::of_facts(report.files.iter().map(wrote).collect()));
    Page::of(section)
}

/// Divides runs into those that a figure can be drawn of, and the others with what they lack.
fn divided<'a>(figure: &Figure, runs: &'a [Run]) -> (Vec<&'a Run>, Vec<(&'a Run, String)>) {
    let (mut able, mut lacking) = (Vec::new(), Vec::new());
    for run in runs {
        match figure.missing(run) {
            None => able.push(run),
            Some(missing) => lacking.push((run, missing)),
        }
    }
    (able, lacking)
}

/// Reads or simulates the runs, all at once.
fn runs(arguments: &FiguresArguments, figures: &[&Figure]) -> Result<Vec<Run>, Error> {
    let given = given(arguments, figures)?;
    let bytes = given.iter().map(|(_, given)| given.bytes()).sum();
    let progress = Progress::of_bytes("reading", bytes);
    let read = |name: &str, given: &Given| {
        Run::read(given.subject(), name, figures, &|bytes| progress.add(bytes))
    };
    let runs = thread::scope(|scope| {
        let start = |(name, given)| {
            let read = &read;
            scope.spawn(move || read(name, given))
        };
        let threads: Vec<_> = given
            .iter()
            .map(|(name, given)| start((name, given)))
            .collect();
        let joined = threads.into_iter().map(thread::ScopedJoinHandle::join);
        joined.collect::<Result<Vec<_>, _>>()
    });
    progress.finish();
    runs.or_else(|panic| std::panic::resume_unwind(panic))
}

/// The runs on the command line with their names in legends.
fn given(arguments: &FiguresArguments, figures: &[&Figure]) -> Result<Vec<(String, Given)>, Error> {
    if arguments.runs.is_empty() {
        let most = figures
            .iter()
            .map(|figure| arguments.count(figure, PAPER.len()));
        let presets = PAPER.iter().take(most.max().unwrap_or(0));
        return presets
            .map(|name| {
                let scenario = Preset::find(name)?.scenario()?;
                Ok(((*name).to_owned(), Given::Scenario(Box::new(scenario))))
            })
            .collect();
    }
    let stem = |word: &PathBuf| word.file_stem().unwrap_or(word.as_os_str()).to_owned();
    let stems: Vec<_> = arguments.runs.iter().map(stem).collect();
    let is_unique = |stem| stems.iter().filter(|other| *other == stem).count() == 1;
    let words = arguments.runs.iter().zip(&stems);
    words
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

/// Draws and writes figures.
fn write_all(
    arguments: &FiguresArguments,
    figures: &[(&'static Figure, Vec<&Run>)],
) -> Result<Vec<FigureFile>, Error> {
    let mut written = Vec::new();
    for (figure, runs) in figures {
        let drawing = figure.draw(runs, arguments.width);
        for kind in arguments.kinds() {
            let path = arguments.path(figure, kind);
            let context = || path.display().to_string();
            let bytes = kind.bytes(&drawing).with_context(context)?;
            publish::write(&path, Existing::forced(arguments.force), &bytes)?;
            written.push(FigureFile {
                figure: figure.name,
                title: figure.title,
                runs: runs.iter().map(|run| run.name.clone()).collect(),
                path: path.display().to_string(),
                bytes: bytes.len() as u64,
            });
        }
    }
    Ok(written)
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
