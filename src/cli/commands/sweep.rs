//! `toprise sweep`.

pub(in crate::cli) mod figures;
pub(super) mod report;

use crate::archive::input::{FileFormat, Input, read_file};
use crate::archive::publish::Drafts;
use crate::cli::arguments::{Override, parse_override};
use crate::cli::extension::{FeatureArguments, SweepRow};
use crate::cli::file_kind::FileKind;
use crate::cli::interrupt;
use crate::cli::output;
use crate::cli::progress::Progress;
use crate::cli::report::{self as reports, WrittenFile};
use crate::cli::status::Status;
use crate::sweep::{
    Axis, Base, Counts, Design, Finished, Method, Options, Sample, Shard, Spec, Sweep, SweepError,
    Table, Watch, is_catching, parts_directory, remaining_rows, run, values_of_row,
};
use crate::words::{counted, grouped};
use anyhow::{Context as _, Error, bail};
use clap::builder::PossibleValue;
use clap::{Args, ValueEnum};
use report::{SweepReport, summary};
use std::panic;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Maximum number of threads.
const MAX_JOBS: u64 = 1024;

/// From now on panics that a sweep turns into errors are not printed. The hook belongs to the whole process, so the program
/// sets it, not the library.
pub(super) fn set_panic_hook() {
    let print = panic::take_hook();
    panic::set_hook(Box::new(move |info| {
        if !is_catching() {
            print(info);
        }
    }));
}

/// `--row` of `toprise run`.
#[derive(Args, Clone, Debug, Default, PartialEq)]
pub(in crate::cli) struct RowArgument {
    /// Run this row of a sweep table (SCENARIO is the .parquet file)
    #[arg(long, value_name = "N", value_parser = |text: &str| whole(text, 0, u64::MAX))]
    row: Option<u64>,
}

impl FeatureArguments<&Input, SweepRow> for RowArgument {
    fn plan(&self, input: &Input) -> Result<Option<SweepRow>, Error> {
        let Some(number) = self.row else {
            return Ok(None);
        };
        let Input::Table(table) = input else {
            let name = input.word().display();
            bail!("{name} is not a sweep table: --row needs the .parquet file of a sweep");
        };
        let values = values_of_row(table, number)?;
        Ok(Some(SweepRow { number, values }))
    }
}

/// Methods use their names as command-line values.
impl ValueEnum for Method {
    fn value_variants<'a>() -> &'a [Self] {
        &Self::ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(self.name()).help(self.meaning()))
    }
}

/// Arguments of `toprise sweep`.
#[derive(Args, Debug, Default, PartialEq)]
pub(in crate::cli) struct SweepArguments {
    /// Presets or scenario files to vary, or one sweep spec (TOML file with bases, set, over, sample or table,
    /// max_steps).
    #[arg(value_name = "BASE", default_value = "paper")]
    bases: Vec<String>,

    /// Vary a key: KEY=a..b/N (N values), KEY=a..b/Nlog (log-spaced), KEY=x,y,z (these values).
    /// With --sample: KEY=a..b or KEY=a..b/log. The last --over varies fastest.
    #[arg(long, value_name = "KEY=VALUES", value_parser = parse_override)]
    over: Vec<Override>,

    /// Sample N points instead of a grid
    #[arg(long, value_name = "N", value_parser = |text: &str| whole(text, 1, u64::MAX), conflicts_with = "table")]
    sample: Option<u64>,

    /// Sampling method
    #[arg(long, value_enum, default_value_t, requires = "sample")]
    method: Method,

    /// Seed of the sample; 0 is the unscrambled Sobol sequence
    #[arg(long, value_name = "N", value_parser = |text: &str| whole(text, 0, u64::MAX), default_value = "0", requires = "sample")]
    seed: u64,

    /// Read the values from a .parquet or .csv file; its columns are keys, e.g. friction_k
    #[arg(long, value_name = "FILE", conflicts_with = "over")]
    table: Option<PathBuf>,

    /// Set a key in all bases, e.g. friction.k=0.02.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = parse_override)]
    overrides: Vec<Override>,

    /// Parquet file to write
    #[arg(short, long, value_name = "FILE", default_value = "sweep.parquet")]
    output: PathBuf,

    /// Number of threads [default: number of processors]
    #[arg(short = 'j', long, value_name = "N", value_parser = |text: &str| whole(text, 1, MAX_JOBS))]
    jobs: Option<u64>,

    /// Compute only shard I (from 0) of N, e.g. on one of N machines; run without --shard to merge.
    #[arg(long, value_name = "I/N", value_parser = parse_shard, allow_hyphen_values = true)]
    shard: Option<Shard>,

    /// Maximum number of integrator steps per run; a longer run is an error
    #[arg(long, value_name = "N", value_parser = |text: &str| whole(text, 1, u64::MAX))]
    max_steps: Option<u64>,

    /// Stop at the first failed row, with exit code 2
    #[arg(long)]
    fail_fast: bool,

    /// Print the number of runs still to be computed, and write nothing.
    #[arg(long)]
    dry_run: bool,
}

/// Error in the value of an option.
#[derive(Debug, thiserror::Error)]
enum ValueError {
    #[error("must be a whole number from {least} to {most}")]
    Whole { least: u64, most: u64 },
    #[error("must be I/N with I from 0 to N − 1, e.g. 0/4")]
    Shard,
}

/// Reads a whole number of a range.
fn whole(text: &str, least: u64, most: u64) -> Result<u64, ValueError> {
    match text.parse() {
        Ok(number) if (least..=most).contains(&number) => Ok(number),
        Ok(_) | Err(_) => Err(ValueError::Whole { least, most }),
    }
}

/// Reads the value of `--shard`.
fn parse_shard(text: &str) -> Result<Shard, ValueError> {
    let (index, count) = text.split_once('/').ok_or(ValueError::Shard)?;
    match (index.parse(), count.parse()) {
        (Ok(index), Ok(count)) if index < count => Ok(Shard { index, count }),
        _ => Err(ValueError::Shard),
    }
}

/// Computes a sweep.
pub(super) fn sweep(arguments: &SweepArguments, drafts: &Drafts) -> Result<Status, Error> {
    let began = Instant::now();
    FileKind::Parquet.check("-o", &arguments.output)?;
    let sweep = Sweep::new(arguments.spec()?);
    if let Some(name) = sweep.spec().shared_name() {
        output::warn(&format!(
            "several scenarios have the name {name}: give them different names"
        ));
    }
    if sweep.spec().rows() == 1 {
        output::warn("the sweep has one run: vary a key, e.g. --over friction.k=0.01..0.1/10");
    }
    let left = remaining_rows(&sweep, &arguments.output, arguments.shard)?;
    // From here on Ctrl-C keeps the parts that are complete.
    interrupt::watch(drafts)?;
    let finished = if arguments.dry_run {
        Finished::default()
    } else {
        compute(arguments, &sweep, left)?
    };
    let report = SweepReport {
        runs: sweep.spec().rows(),
        computed: finished.computed,
        table: finished.is_merged.then(|| arguments.table_file()).flatten(),
        parts: (!finished.is_merged && !arguments.dry_run)
            .then(|| parts_directory(&arguments.output).display().to_string()),
        outcomes: finished.counts.stops,
        errors: finished.counts.errors,
        first_error: finished.counts.first_error,
        interrupted: finished.is_interrupted,
        wall_time: began.elapsed().as_secs_f64(),
    };
    reports::print(&report, || {
        report.page(left, arguments.dry_run, arguments.shard)
    })?;
    Ok(Status::from_whole(
        report.errors == 0 && !report.interrupted,
    ))
}

/// Computes what is left, and shows the progress with counts of outcomes.
fn compute(arguments: &SweepArguments, sweep: &Sweep, left: u64) -> Result<Finished, SweepError> {
    let rows = sweep.spec().rows();
    if left > 0 && left < rows {
        let left = grouped(left);
        output::note(&format!(
            "{}, {left} still to be computed",
            counted(rows, "run")
        ));
    }
    let progress = Progress::new(
        Some(left),
        // At most 52 columns; the counts of outcomes take what is left of the line.
        "{bar:16} {percent:>3} %  {per_sec}  [{elapsed}, {eta} left]  {wide_msg}",
    );
    let counts = Mutex::new((Counts::default(), Instant::now()));
    let watch = Watch {
        carry_on: &|| !interrupt::is_requested(),
        row_done: &|stop| {
            progress.add(1);
            let mut guard = counts.lock().unwrap_or_else(PoisonError::into_inner);
            let (counts, shown) = &mut *guard;
            match stop {
                Some(stop) => counts.count_stop(stop),
                None => counts.errors += 1,
            }
            // More often would take longer than a short run.
            if shown.elapsed() > Duration::from_millis(100) {
                *shown = Instant::now();
                progress.set_text(summary(&counts.stops, counts.errors));
            }
        },
    };
    let options = Options {
        threads: arguments.jobs.map_or(0, |jobs| jobs as usize),
        shard: arguments.shard,
        fail_fast: arguments.fail_fast,
    };
    let finished = run(sweep, &arguments.output, &options, &watch);
    progress.finish();
    finished
}

impl SweepArguments {
    /// The spec from the file, or from the bases and axes given as arguments.
    fn spec(&self) -> Result<Spec, Error> {
        // Scenarios and specs have the same extension: the content decides.
        if let [word] = &self.bases[..]
            && let path = Path::new(word)
            && path.is_file()
            && path.extension().is_some_and(|kind| kind == "toml")
            && FileFormat::detect(path) == FileFormat::Text
        {
            let text = read_file(path).with_context(|| format!("cannot read {word}"))?;
            if Spec::is_spec(&text) {
                return self.spec_of_file(&text, path).with_context(|| word.clone());
            }
        }
        let mut bases = Vec::new();
        for word in &self.bases {
            bases.push(Base::open(word, Path::new(""), &self.overrides)?);
        }
        let mut axes = Vec::new();
        for (key, text) in &self.over {
            axes.push(Axis::parse(key, text)?);
        }
        let sample = self.sample.map(|count| Sample {
            count,
            method: self.method,
            seed: self.seed,
        });
        let table = self.table.as_deref().map(Table::read).transpose()?;
        let design = Design::new(axes, sample, table)?;
        Ok(Spec::new(bases, design, self.max_steps)?)
    }

    fn spec_of_file(&self, text: &str, path: &Path) -> Result<Spec, Error> {
        if !self.over.is_empty() || self.sample.is_some() || self.table.is_some() {
            bail!("the spec file defines the axes: remove --over, --sample and --table");
        }
        // A spec names files relative to its own folder, so that it can be moved together with them.
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut spec = Spec::from_toml(text, folder, &self.overrides)?;
        spec.max_steps = self.max_steps.or(spec.max_steps);
        Ok(spec)
    }

    fn table_file(&self) -> Option<WrittenFile> {
        let bytes = self.output.metadata().ok()?.len();
        Some(WrittenFile::new(&self.output, bytes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::arguments::parse;

    #[test]
    fn parses_a_sweep() {
        let arguments = parse::<SweepArguments>(
            "paper viscous --over friction.k=0.01..0.1/4log --set stop.duration=1 -j 2 --shard 1/3",
        )
        .unwrap();
        assert_eq!(arguments.spec().unwrap().rows(), 8);
        let shard = Shard { index: 1, count: 3 };
        assert_eq!(arguments.shard, Some(shard));
        for line in [
            "--shard 3/3",
            "--shard 1",
            "-j 0",
            "--method sobol",
            "--sample 10 --table a.csv",
            "--over friction.k=1 --table a.csv",
        ] {
            assert!(parse::<SweepArguments>(line).is_err(), "{line}");
        }
    }

    #[test]
    fn explains_wrong_numbers() {
        for (line, message) in [
            ("-j 0", "must be a whole number from 1 to 1024"),
            ("-j -1", "must be a whole number from 1 to 1024"),
            ("-j 70000", "must be a whole number from 1 to 1024"),
            ("--max-steps 0", "must be a whole number from 1 to 184"),
            ("--max-steps -1", "must be a whole number from 1 to 184"),
            ("--sample 1e3", "must be a whole number from 1 to 184"),
            ("--sample 9 --seed -1", "must be a whole number from 0 to "),
            ("--shard -1/3", "must be I/N"),
            ("--shard 3/3", "must be I/N"),
        ] {
            let error = parse::<SweepArguments>(line).unwrap_err().to_string();
            assert!(error.contains(message), "{line}: {error}");
            assert!(!error.contains("-- -"), "{line}: {error}");
        }
        for (line, seed) in [("", 0), ("--sample 9 --seed 7", 7)] {
            assert_eq!(parse::<SweepArguments>(line).unwrap().seed, seed, "{line}");
        }
    }
}
