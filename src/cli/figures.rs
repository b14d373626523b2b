//! `toprise figures`.

use super::given::{Given, open};
use super::progress::Progress;
use super::{Done, format, output};
use crate::analysis::figures::{
    Drawing, FIGURES, Figure, FigureFile, FiguresReport, Lacking, Run, RunLoss,
};
use crate::archive::publish::{self, Existing};
use crate::archive::sink::SinkError;
use crate::run::scenario::Preset;
use anyhow::{Context as _, Error, bail};
use clap::builder::PossibleValuesParser;
use clap::{Args, ValueEnum};
use std::path::{Path, PathBuf};
use std::thread;

/// Arguments of `toprise figures`.
#[derive(Args, Debug, PartialEq)]
pub(super) struct FiguresArguments {
    /// Recordings, presets or scenario files; several are drawn over one another. Without any the paper's
    /// runs are simulated.
    #[arg(value_name = "RUN")]
    runs: Vec<String>,

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
    format: Vec<Kind>,

    /// Width of the figures in mm: from 130 mm on there are two columns of plots.
    #[arg(long, value_name = "MM", default_value_t = 85.0, value_parser = parse_width)]
    width: f64,

    /// Replace files that exist.
    #[arg(long)]
    force: bool,
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
        kinds.filter(|kind| self.format.contains(kind))
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
            publish::refuse_inputs(path, self.runs.iter().map(Path::new))?;
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
        for loss in &run.losses {
            output::warn(&format!("{}: {loss}", run.name));
            report.losses.push(RunLoss {
                run: run.name.clone(),
                loss: loss.clone(),
            });
        }
    }
    let mut drawn = Vec::new();
    for figure in figures {
        let count = arguments.count(figure, runs.len());
        let (able, lacking) = divided(figure, &runs[..count]);
        for (run, missing) in lacking {
            output::warn(&format!(
                "{}: {} needs {missing}, which it lacks",
                run.name, figure.name
            ));
            report.lacking.push(Lacking {
                run: run.name.clone(),
                figure: figure.name,
                missing,
            });
        }
        // A comparison without one of its runs would be another.
        let is_able = figure.least_runs == 1 || able.len() == count;
        if is_able && !able.is_empty() {
            drawn.push((figure, able));
        }
    }
    if drawn.is_empty() {
        bail!("nothing can be drawn");
    }
    report.files = write_all(arguments, &drawn)?;
    Ok(if report.losses.is_empty() && report.lacking.is_empty() {
        Done::Well
    } else {
        Done::WithLosses
    })
}

/// Those of which a figure can be drawn, and the others with what they lack.
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
    let stem = |word: &str| {
        let stem = Path::new(word).file_stem();
        stem.map_or_else(
            || word.to_owned(),
            |stem| stem.to_string_lossy().into_owned(),
        )
    };
    let stems: Vec<_> = arguments.runs.iter().map(|word| stem(word)).collect();
    let is_unique = |name: &String| stems.iter().filter(|other| *other == name).count() == 1;
    let name = |word: &String, stem: &String| if is_unique(stem) { stem } else { word }.clone();
    let words = arguments.runs.iter().zip(&stems);
    words
        .map(|(word, stem)| Ok((name(word, stem), open(word, &[], &[])?)))
        .collect()
}

/// Draws and writes figures, and tells of each file.
fn write_all(
    arguments: &FiguresArguments,
    figures: &[(&'static Figure, Vec<&Run>)],
) -> Result<Vec<FigureFile>, Error> {
    let mut files = Vec::new();
    for (figure, runs) in figures {
        let drawing = figure.draw(runs, arguments.width);
        for kind in arguments.kinds() {
            let path = arguments.path(figure, kind);
            let context = || path.display().to_string();
            let bytes = kind.bytes(&drawing).with_context(context)?;
            publish::write(&path, Existing::forced(arguments.force), &bytes)?;
            let size = format::bytes(bytes.len() as u64);
            output::print(&format!("wrote {}  {size}", path.display()))?;
            files.push(FigureFile {
                figure: figure.name,
                title: figure.title,
                runs: runs.iter().map(|run| run.name.clone()).collect(),
                path: path.display().to_string(),
                bytes: bytes.len() as u64,
            });
        }
    }
    Ok(files)
}
