//! `toprise figures`.

mod files;

use self::files::FigureFiles;
use crate::archive::publish::{Drafts, Existing};
use crate::cli::arguments::{OUTPUT, parse_number};
use crate::cli::commands::image::ImageFormat;
use crate::cli::extension::{FeatureArguments as _, MapArguments, MapTable};
use crate::cli::input::{OpenRun, open};
use crate::cli::output;
use crate::cli::progress::Progress;
use crate::cli::report;
use crate::cli::status::Status;
use crate::figures::{FIGURES, Figure, FiguresReport, Lacking, LeftOut, RunData, RunLoss};
use crate::words::{Section, Table};
use anyhow::{Context as _, bail};
use clap::builder::PossibleValuesParser;
use clap::{Args, ValueEnum};
use rayon::iter::{IntoParallelRefIterator as _, ParallelIterator as _};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// Arguments of `toprise figures`.
#[derive(Args, Debug, PartialEq)]
pub(in crate::cli) struct FiguresArguments {
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
    kinds: Vec<ImageFormat>,

    #[command(flatten)]
    sweep: MapArguments,

    /// Width from 80 to 400 mm; 130 or more gives two columns of plots
    #[arg(long, value_name = "MM", default_value_t = 85.0, value_parser = |text: &str| parse_number(text, 80.0..=400.0, "from 80 to 400 (mm)"), help_heading = OUTPUT)]
    width: f64,

    /// Overwrite existing files.
    #[arg(long, help_heading = OUTPUT)]
    force: bool,
}

fn names() -> PossibleValuesParser {
    FIGURES.iter().map(|figure| figure.name).into()
}

/// The runs of the paper's figures: the first of all, the others only of figure 4.
const PAPER: [&str; 3] = [
    "paper",
    "paper-precession-term-only",
    "paper-spin-term-only",
];

/// The figures to draw, and their files.
struct FigurePlan {
    files: FigureFiles,
    /// Width of the figures, mm.
    width: f64,
    content: FigureSource,
}

/// The source of figures.
enum FigureSource {
    Runs(RunsPlan),
    Sweep(Box<dyn MapTable>),
}

/// Figures of runs.
struct RunsPlan {
    figures: Vec<&'static Figure>,
    runs: Vec<PathBuf>,
    /// Whether these are the paper's runs, of which most figures show only the first.
    is_paper: bool,
    /// Whether the figures were chosen by name: those that don't apply are then reported.
    is_chosen: bool,
}

impl FiguresArguments {
    /// Resolves the arguments, and checks the output files before anything is computed.
    fn plan(&self) -> Result<FigurePlan, anyhow::Error> {
        let files = FigureFiles {
            directory: self.output.clone(),
            // Each once, in one order.
            kinds: ImageFormat::value_variants()
                .iter()
                .copied()
                .filter(|kind| self.kinds.contains(kind))
                .collect(),
            existing: Existing::forced(self.force),
        };
        let sweep: Option<Box<dyn MapTable>> = self.sweep.plan(())?;
        let content = if let Some(sweep) = sweep {
            // Drawing may take minutes: a name that is taken is found before.
            files.check(&[SWEEP.0], &[sweep.path().to_owned()])?;
            FigureSource::Sweep(sweep)
        } else {
            let runs = self.runs_plan()?;
            let names: Vec<_> = runs.figures.iter().map(|figure| figure.name).collect();
            files.check(&names, &self.runs)?;
            FigureSource::Runs(runs)
        };
        Ok(FigurePlan {
            files,
            width: self.width,
            content,
        })
    }

    /// The runs on the command line, or those of the paper, and the figures that apply to this number of runs.
    fn runs_plan(&self) -> Result<RunsPlan, anyhow::Error> {
        let is_paper = self.runs.is_empty();
        let runs = if is_paper {
            PAPER.map(PathBuf::from).to_vec()
        } else {
            self.runs.clone()
        };
        let mut figures = Vec::new();
        for figure in FIGURES {
            let is_chosen = self.only.iter().any(|name| name == figure.name);
            let (name, least) = (figure.name, figure.min_runs);
            if is_chosen && least > runs.len() {
                bail!(
                    "{name} compares runs: name at least {least}, or none to draw the paper's runs"
                );
            }
            if least <= runs.len() && (is_chosen || self.only.is_empty()) {
                figures.push(figure);
            }
        }
        Ok(RunsPlan {
            figures,
            runs,
            is_paper,
            is_chosen: !self.only.is_empty(),
        })
    }
}

impl RunsPlan {
    /// Number of runs in a figure: one of the paper's runs, unless the figure compares runs.
    fn count(&self, figure: &Figure) -> usize {
        if self.is_paper && figure.min_runs == 1 {
            1
        } else {
            self.runs.len()
        }
    }

    /// Reads or simulates the runs in parallel.
    fn read(&self) -> Result<Vec<RunData>, anyhow::Error> {
        let inputs = self.inputs()?;
        let bytes = inputs.iter().map(|(_, input)| input.bytes()).sum();
        let progress = Progress::for_bytes("reading", bytes);
        let runs = inputs
            .par_iter()
            .map(|(name, input)| {
                RunData::read(input.subject(), name, &self.figures, &|bytes| {
                    progress.add(bytes);
                })
            })
            .collect();
        progress.finish();
        Ok(runs)
    }

    /// The runs that are drawn, with their names in legends.
    fn inputs(&self) -> Result<Vec<(String, OpenRun)>, anyhow::Error> {
        let counts = self.figures.iter().map(|figure| self.count(figure));
        // Of the paper's runs, two are simulated only for the figure that compares them.
        let words = &self.runs[..counts.max().unwrap_or(0)];
        let stems: Vec<&OsStr> = words.iter().map(|word| stem(word)).collect();
        let mut inputs = Vec::new();
        for (word, stem) in words.iter().zip(&stems) {
            // Files of one name in several directories need their directories in the legend.
            let is_unique = stems.iter().filter(|other| *other == stem).count() == 1;
            let name = if is_unique { stem } else { word.as_os_str() };
            inputs.push((name.to_string_lossy().into_owned(), open(word, &[], &[])?));
        }
        Ok(inputs)
    }

    /// Whether a figure shows a run; otherwise the report says why not.
    fn can_draw(&self, figure: &Figure, run: &RunData, report: &mut FiguresReport) -> bool {
        let (name, run_name) = (figure.name, run.name.clone());
        if let Some(because) = figure.exclusion(run) {
            if self.is_chosen || figure.is_expected_for(run) {
                report.left_out.push(LeftOut {
                    figure: name,
                    run: run_name,
                    because,
                });
            }
            return false;
        }
        if let Some(missing) = figure.missing(run) {
            report.lacking.push(Lacking {
                figure: name,
                run: run_name,
                missing: missing.to_string(),
            });
            return false;
        }
        true
    }
}

/// The name of a run in a legend.
fn stem(word: &Path) -> &OsStr {
    word.file_stem().unwrap_or(word.as_os_str())
}

/// Draws figures.
pub(super) fn figures(
    arguments: &FiguresArguments,
    drafts: &Drafts,
) -> Result<Status, anyhow::Error> {
    let plan = arguments.plan()?;
    let report = match &plan.content {
        FigureSource::Runs(runs) => draw_runs(&plan, runs, drafts)?,
        FigureSource::Sweep(sweep) => draw_sweep(&plan, sweep.as_ref(), drafts)?,
    };
    report::print(&report, || page(&report))?;
    let is_whole = report.losses.is_empty() && report.lacking.is_empty();
    Ok(Status::from_whole(is_whole))
}

/// Draws figures of runs.
fn draw_runs(
    plan: &FigurePlan,
    content: &RunsPlan,
    drafts: &Drafts,
) -> Result<FiguresReport, anyhow::Error> {
    let runs = content.read()?;
    let mut report = FiguresReport::default();
    for run in &runs {
        for loss in &run.losses {
            report.losses.push(RunLoss {
                run: run.name.clone(),
                loss: loss.clone(),
            });
        }
    }
    let mut drawn = Vec::new();
    for figure in &content.figures {
        let count = content.count(figure);
        let mut able = Vec::new();
        for run in &runs[..count] {
            if content.can_draw(figure, run, &mut report) {
                able.push(run);
            }
        }
        // A comparison without one of its runs would compare something else.
        let is_able = figure.min_runs == 1 || able.len() == count;
        if is_able && !able.is_empty() {
            drawn.push((figure, able));
        }
    }
    // First, because the warnings say why nothing is drawn.
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
        let drawing = figure.draw(&runs, plan.width);
        let names: Vec<_> = runs.iter().map(|run| run.name.clone()).collect();
        let title = (figure.name, figure.title);
        report
            .files
            .extend(plan.files.write(drafts, title, &names, &drawing)?);
    }
    Ok(report)
}

/// Name and title of the figure of a sweep.
const SWEEP: (&str, &str) = ("sweep", "Outcomes of the runs of a sweep");

/// Draws a map or curves of a sweep.
fn draw_sweep(
    plan: &FigurePlan,
    sweep: &dyn MapTable,
    drafts: &Drafts,
) -> Result<FiguresReport, anyhow::Error> {
    let name = sweep.path().display().to_string();
    let map = sweep.read()?;
    let drawing = map.draw(plan.width).with_context(|| name.clone())?;
    Ok(FiguresReport {
        files: plan.files.write(drafts, SWEEP, &[name], &drawing)?,
        ..FiguresReport::default()
    })
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
    let mut section = Section::default();
    section.table(Table::from_facts(
        report
            .files
            .iter()
            .map(|file| ("wrote", report::file_line(&file.path, file.bytes))),
    ));
    for left in &report.left_out {
        let (figure, run, because) = (left.figure, &left.run, left.because);
        section.line(format!("skipped: {figure} of {run}; {because}"));
    }
    vec![section]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::arguments::parse;

    #[test]
    fn parses_figures_and_kinds() {
        let base = parse::<FiguresArguments>("").unwrap();
        assert_eq!(base.kinds, [ImageFormat::Svg, ImageFormat::Png]);
        assert_eq!(base.width, 85.0);
        assert_eq!(
            parse::<FiguresArguments>("a.mcap paper --only figure-2,figure-4 --kinds png").unwrap(),
            FiguresArguments {
                runs: vec!["a.mcap".into(), "paper".into()],
                only: vec!["figure-2".to_owned(), "figure-4".to_owned()],
                kinds: vec![ImageFormat::Png],
                ..base
            }
        );
        for line in ["--only figure-7", "--width 20", "--kinds pdf"] {
            assert!(parse::<FiguresArguments>(line).is_err(), "{line}");
        }
    }
}
