//! `toprise sweep`.

use super::arguments::{FormArguments, Override, parse_override};
use super::done::Done;
use super::interrupt::Interrupt;
use super::numbers::{count, number};
use super::output;
use super::page::{Page, Section, Tone};
use super::progress::Progress;
use super::report::{self, WrittenFile};
use super::table::Table as PageTable;
use crate::archive::given::read_file;
use crate::archive::publish::is_same_file;
use crate::run::simulation::StopReason;
use crate::sweep::{
    Axis, Base, Choice, Counts, Design, Finished, Method, Options, Recordings, Shard, Spec, Sweep,
    Table, Watch, check_recordings, is_in_row, left_to_do, parts_directory, recordings_directory,
    run,
};
use anyhow::{Context as _, Error, bail};
use clap::{Args, ValueEnum};
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;
use std::panic;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// The time spent on runs that tell how long the others will take.
const TRIAL: Duration = Duration::from_millis(500);
/// The most of such runs.
const TRIAL_RUNS: u64 = 16;
/// At most one run in a hundred is tried beforehand, and none before a sweep of fewer: trials are run one after the other.
const RUNS_PER_TRIAL: u64 = 100;

/// The most threads.
const MOST_JOBS: u16 = 1024;

/// Arguments of `toprise sweep`.
#[derive(Args, Debug, Default, PartialEq)]
pub(super) struct SweepArguments {
    /// Presets and scenario files to start from (several are the outermost axis), or one file that says everything, the
    /// spec of a sweep: TOML with the keys bases, set, over, sample or table, max_steps, keep and record.
    #[arg(value_name = "BASE", default_value = "paper")]
    bases: Vec<String>,

    /// Vary a key: KEY=a..b/N for N values from a to b, KEY=a..b/Nlog for evenly spaced logarithms, KEY=x,y,z for these
    /// (a text with a comma in quotes); with --sample KEY=a..b or KEY=a..b/log. The last of several varies fastest.
    #[arg(long, value_name = "KEY=VALUES", value_parser = parse_override)]
    over: Vec<Override>,

    /// Instead of a grid, choose so many points among the values.
    #[arg(long, value_name = "N", value_parser = parse_count, allow_negative_numbers = true, conflicts_with = "table")]
    sample: Option<u64>,

    /// How the points of a sample are chosen.
    #[arg(long, value_enum, default_value_t, requires = "sample")]
    method: MethodName,

    /// Another sample of its kind; 0 is the sequence of Sobol as it is published.
    #[arg(long, value_name = "N", value_parser = parse_seed, allow_negative_numbers = true, default_value = "0", requires = "sample")]
    seed: u64,

    /// Take the values from a table, .parquet or .csv, whose columns are named like keys, as in `friction_k`.
    #[arg(long, value_name = "FILE", conflicts_with = "over")]
    table: Option<PathBuf>,

    /// Set a key in all bases, as in friction.k=0.02.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = parse_override)]
    overrides: Vec<Override>,

    /// The table to write, in Parquet.
    #[arg(short, long, value_name = "FILE", default_value = "sweep.parquet")]
    output: PathBuf,

    /// Number of threads; all processors if left out.
    #[arg(short = 'j', long, value_name = "N", value_parser = parse_jobs, allow_negative_numbers = true)]
    jobs: Option<u16>,

    /// Compute one share of N only, I from 0 to N − 1, as one of several machines; a sweep without --shard then merges
    /// what all of them have written.
    #[arg(long, value_name = "I/N", value_parser = parse_shard, allow_hyphen_values = true)]
    shard: Option<Shard>,

    /// Give up a run after so many steps of the integrator: its row then has an error.
    #[arg(long, value_name = "N", value_parser = parse_count, allow_negative_numbers = true)]
    max_steps: Option<u64>,

    /// Store whole recordings of the runs whose rows fulfil a condition: a column or key, one of < <= > >= = !=, and a
    /// number, a word or null, as in 'rise_time > 30', 'stop_reason = fallen' or 'weak_time != null'. Of several, all must
    /// hold. They go into a directory beside the table, as out.parquet.runs/000042.mcap for run 42. The conditions of a
    /// spec, `keep = ["rise_time > 30"]`, then don't count.
    #[arg(long, value_name = "CONDITION")]
    keep: Vec<String>,

    /// Store whole recordings of the first N runs that have an outcome; with --keep, of the first N that it chooses. In a
    /// spec: `record = N`.
    #[arg(long, value_name = "N", value_parser = parse_count, allow_negative_numbers = true)]
    record: Option<u64>,

    /// End at the first row with an error, with exit code 2, whether it is computed now or was there.
    #[arg(long)]
    fail_fast: bool,

    /// Tell how many runs there are and how long they will take, and write nothing.
    #[arg(long)]
    dry_run: bool,

    #[command(flatten)]
    form: FormArguments,
}

/// How points are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum MethodName {
    /// Sobol's sequence, which fills the space evenly.
    #[default]
    Sobol,
    /// Each coordinate by itself at random.
    Random,
}

impl From<MethodName> for Method {
    fn from(name: MethodName) -> Self {
        match name {
            MethodName::Sobol => Self::Sobol,
            MethodName::Random => Self::Random,
        }
    }
}

fn parse_count(text: &str) -> Result<u64, String> {
    let number = text.parse().ok().filter(|number| *number > 0);
    number.ok_or_else(|| format!("must be a whole number from 1 to {}", u64::MAX))
}

fn parse_seed(text: &str) -> Result<u64, String> {
    let number = text.parse();
    number.map_err(|_| format!("must be a whole number from 0 to {}", u64::MAX))
}

fn parse_jobs(text: &str) -> Result<u16, String> {
    let number = text.parse().ok();
    number
        .filter(|number| (1..=MOST_JOBS).contains(number))
        .ok_or_else(|| format!("must be a whole number from 1 to {MOST_JOBS}"))
}

fn parse_shard(text: &str) -> Result<Shard, String> {
    let shard = text.split_once('/').and_then(|(index, count)| {
        Some(Shard {
            index: index.parse().ok()?,
            count: count.parse().ok()?,
        })
    });
    shard
        .filter(|shard| shard.index < shard.count)
        .ok_or_else(|| "must be I/N, I from 0 to N − 1, as in 0/4".to_owned())
}

/// What a sweep came to.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct SweepReport {
    /// Number of runs of the whole sweep.
    runs: u64,
    /// Number of runs that were computed now; the others were there, or are left.
    computed: u64,
    /// The table; absent if it is not complete.
    table: Option<WrittenFile>,
    /// The directory of parts; absent once they are merged.
    parts: Option<String>,
    /// Number of runs for each reason why they stopped: of the table, or of those computed now if it is not complete.
    outcomes: BTreeMap<String, u64>,
    /// Number of runs that have an error instead of an outcome.
    errors: u64,
    /// The first run that has an error; absent if none has.
    first_error: Option<crate::sweep::RowError>,
    /// Whole recordings of chosen runs; absent unless they are asked for (--keep, --record), and the rows are there.
    recordings: Option<RecordingsReport>,
    /// Whether the sweep was interrupted.
    interrupted: bool,
    /// How long the runs that are left are expected to take, s, estimated from a few of them; absent unless asked for.
    estimate: Option<f64>,
    /// How long it took, s.
    wall_time: f64,
}

/// Whole recordings of chosen runs.
#[derive(Debug, Serialize, JsonSchema)]
struct RecordingsReport {
    /// The directory that they are in.
    directory: String,
    /// Number of chosen runs: of the table, or of the share that --shard names.
    chosen: u64,
    /// Number of recordings that were written now; the others were there, or are left.
    written: u64,
    /// Number of recordings that end early, because the motion could not be recorded to its end.
    failed: u64,
}

/// Computes a sweep.
pub(super) fn sweep(arguments: &SweepArguments) -> Result<Done, Error> {
    let began = Instant::now();
    arguments.refuse_parts()?;
    let sweep = Sweep::new(arguments.spec()?);
    let choice = arguments.choice(&sweep)?;
    if let Some(name) = sweep.spec().shared_name() {
        output::warn(&format!(
            "several scenarios are called {name}, and the table doesn't tell their runs apart: give them other names"
        ));
    }
    let left = left_to_do(&sweep, &arguments.output, arguments.shard)?;
    if choice.is_some() {
        check_recordings(&sweep, &arguments.output)?;
    }
    // Where nothing is written there is nothing to end in order.
    let interrupt = match arguments.dry_run {
        true => Interrupt::default(),
        false => Interrupt::watch()?,
    };
    let carry_on = || !interrupt.is_asked();
    let told = quietly(|| {
        let estimate = arguments.estimate(&sweep, left, &carry_on);
        if arguments.dry_run {
            return Ok((Finished::default(), estimate));
        }
        if left > 0 {
            output::note(&announcement(&sweep, left, estimate));
        }
        let tally = Tally::new(left);
        let watch = Watch {
            carry_on: &carry_on,
            done: &|stop| tally.add(stop),
        };
        let finished = run(&sweep, &arguments.output, &arguments.options(), &watch);
        tally.progress.finish();
        finished.map(|finished| (finished, estimate))
    });
    let (finished, estimate) = told?;
    let computing = began.elapsed();
    let choice = choice.filter(|_| !finished.is_interrupted && !arguments.dry_run);
    let recordings = choice.map(|choice| arguments.record(&sweep, &choice, &carry_on));
    let (recordings, are_cut_short) = recordings.transpose()?.unzip();
    let report = SweepReport {
        runs: sweep.spec().rows(),
        computed: finished.computed,
        table: finished.is_merged.then(|| arguments.table_file()).flatten(),
        parts: (!finished.is_merged && !arguments.dry_run)
            .then(|| parts_directory(&arguments.output).display().to_string()),
        outcomes: finished.counts.stops,
        errors: finished.counts.errors,
        first_error: finished.counts.first_error,
        interrupted: finished.is_interrupted || are_cut_short.unwrap_or_default(),
        recordings,
        estimate: estimate.filter(|_| arguments.dry_run),
        wall_time: began.elapsed().as_secs_f64(),
    };
    report::print(&report, arguments.form.format(), || {
        report.page(arguments, left, computing)
    })?;
    let has_losses = report.errors > 0 || report.interrupted;
    Ok(
        if has_losses || report.recordings.is_some_and(|all| all.failed > 0) {
            Done::WithLosses
        } else {
            Done::Well
        },
    )
}

impl SweepArguments {
    /// Refuses a design that would be taken for a part of the sweep.
    fn refuse_parts(&self) -> Result<(), Error> {
        let parts = parts_directory(&self.output);
        let Some(table) = &self.table else {
            return Ok(());
        };
        let is_part = table.extension().is_some_and(|kind| kind == "parquet")
            && table
                .parent()
                .is_some_and(|folder| is_same_file(folder, &parts));
        if is_part {
            bail!(
                "{} is in {}, where this sweep keeps its parts: move it, or choose another -o",
                table.display(),
                parts.display()
            );
        }
        Ok(())
    }

    /// The spec that the arguments make, or that of their file, where an argument counts more than the file.
    fn spec(&self) -> Result<Spec, Error> {
        let mut spec = self.spec_of_runs()?;
        spec.most_steps = self.max_steps.or(spec.most_steps);
        spec.record = self.record.or(spec.record);
        if !self.keep.is_empty() {
            spec.keep = self.keep.clone();
        }
        Ok(spec)
    }

    /// Which runs are recorded; none if that is not asked for.
    fn choice(&self, sweep: &Sweep) -> Result<Option<Choice>, Error> {
        let choice = Choice::of(sweep);
        if self.keep.is_empty() {
            return choice.with_context(|| self.bases.join(" "));
        }
        Ok(choice?)
    }

    /// The spec as the file has it, or with the bases and designs of the arguments.
    fn spec_of_runs(&self) -> Result<Spec, Error> {
        if let [word] = &self.bases[..]
            && let path = Path::new(word)
            && path.is_file()
            && path.extension().is_some_and(|kind| kind == "toml")
        {
            let text = read_file(path).with_context(|| format!("cannot read {word}"))?;
            if Spec::is_spec(&text) {
                return self.spec_of_file(&text, path).with_context(|| word.clone());
            }
        }
        let open = |word: &String| Base::open(word, Path::new(""), &self.overrides);
        let bases = self.bases.iter().map(open).collect::<Result<_, _>>()?;
        let axes = self.over.iter().map(|(key, text)| Axis::parse(key, text));
        let axes = axes.collect::<Result<Vec<_>, _>>()?;
        let sample = self
            .sample
            .map(|count| (count, self.method.into(), self.seed));
        let table = self.table.as_deref().map(Table::read).transpose()?;
        let design = Design::of(axes, sample, table)?;
        Ok(Spec::new(bases, design, None)?)
    }

    fn spec_of_file(&self, text: &str, path: &Path) -> Result<Spec, Error> {
        if !self.over.is_empty() || self.sample.is_some() || self.table.is_some() {
            bail!("the file says what varies: leave --over, --sample and --table out");
        }
        let folder = path.parent().unwrap_or(Path::new(""));
        Ok(Spec::from_toml(text, folder, &self.overrides)?)
    }

    /// Writes the recordings that are missing; tells of them, and whether that was interrupted.
    fn record(
        &self,
        sweep: &Sweep,
        choice: &Choice,
        carry_on: &(dyn Fn() -> bool + Sync),
    ) -> Result<(RecordingsReport, bool), Error> {
        let recordings = Recordings::find(sweep, &self.output, choice, self.shard)?;
        let missing = recordings.missing();
        if missing > 0 {
            output::note(&format!("recording {}", runs(missing)));
        }
        let progress = Progress::of_runs(missing);
        let watch = Watch {
            carry_on,
            done: &|_| progress.add(1),
        };
        let recorded = recordings.write(&self.options(), &watch);
        progress.finish();
        let recorded = recorded?;
        for run in recordings.early() {
            output::warn(&format!(
                "the recording of run {run}, which was there, ends early"
            ));
        }
        for (run, reason) in &recorded.failed {
            let reason = match reason {
                Some(reason) => format!(": {reason}"),
                None => String::new(),
            };
            output::warn(&format!("the recording of run {run} ends early{reason}"));
        }
        let report = RecordingsReport {
            directory: recordings_directory(&self.output).display().to_string(),
            chosen: recordings.chosen(),
            written: recorded.written,
            failed: (recordings.early().len() + recorded.failed.len()) as u64,
        };
        Ok((report, recorded.is_interrupted))
    }

    fn options(&self) -> Options {
        Options {
            threads: self.jobs.map_or(0, usize::from),
            shard: self.shard,
            fail_fast: self.fail_fast,
        }
    }

    fn threads(&self) -> usize {
        let all = || thread::available_parallelism().map_or(1, usize::from);
        self.jobs.map_or_else(all, usize::from)
    }

    /// How long the rows that are left will take, s, judged by some of them; none if there are none or few, or the user
    /// asked for an end.
    fn estimate(
        &self,
        sweep: &Sweep,
        left: u64,
        carry_on: &(dyn Fn() -> bool + Sync),
    ) -> Option<f64> {
        let began = Instant::now();
        let watch = Watch {
            // A single run may take long.
            carry_on: &|| carry_on() && began.elapsed() < 2 * TRIAL,
            done: &|_| {},
        };
        let rows = sweep.spec().rows();
        let worth = match self.dry_run {
            true => left,
            false => left / RUNS_PER_TRIAL,
        };
        let tried = TRIAL_RUNS.min(worth);
        let mut done = 0;
        while done < tried && began.elapsed() < TRIAL {
            // Spread over the sweep, beginning in its middle.
            let row = (rows / 2 + done * rows / tried) % rows;
            sweep.batch(row..row + 1, &watch)?;
            done += 1;
        }
        let mean = began.elapsed().as_secs_f64() / done as f64;
        (done > 0).then(|| mean * left as f64 / self.threads() as f64)
    }

    fn table_file(&self) -> Option<WrittenFile> {
        let bytes = self.output.metadata().ok()?.len();
        Some(WrittenFile::new(&self.output, bytes))
    }
}

/// Does something during which panics of rows, which stand in the table, are not told on standard error too.
fn quietly<T>(task: impl FnOnce() -> T) -> T {
    let before = panic::take_hook();
    panic::set_hook(Box::new(|told| {
        if !is_in_row() {
            output::error(&told.to_string());
        }
    }));
    let result = task();
    panic::set_hook(before);
    result
}

fn announcement(sweep: &Sweep, left: u64, estimate: Option<f64>) -> String {
    let runs = runs(sweep.spec().rows());
    let left = if left == sweep.spec().rows() {
        String::new()
    } else {
        format!(", {} of them left", count(left))
    };
    let estimate = estimate.map_or_else(String::new, |seconds| format!("; {}", about(seconds)));
    format!("{runs}{left}{estimate}")
}

/// A number of runs.
fn runs(number: u64) -> String {
    let noun = if number == 1 { "run" } else { "runs" };
    format!("{} {noun}", count(number))
}

/// A time that is not known well.
fn about(seconds: f64) -> String {
    match seconds {
        ..1.0 => "less than a second".to_owned(),
        ..100.0 => format!("about {} s", number(seconds, 0)),
        ..6000.0 => format!("about {} min", number(seconds / 60.0, 0)),
        ..360_000.0 => format!("about {} h", number(seconds / 3600.0, 1)),
        _ => format!("about {} days", number(seconds / 86_400.0, 1)),
    }
}

/// Shows how far the sweep has come, and how the runs came out.
struct Tally {
    progress: Progress,
    counts: Mutex<(Counts, Instant)>,
}

impl Tally {
    fn new(rows: u64) -> Self {
        Self {
            progress: Progress::of_runs(rows),
            counts: Mutex::new((Counts::default(), Instant::now())),
        }
    }

    fn add(&self, stop: Option<StopReason>) {
        self.progress.add(1);
        let mut guard = self.counts.lock().unwrap_or_else(PoisonError::into_inner);
        let (counts, told) = &mut *guard;
        counts.count(0, stop.map(StopReason::name).ok_or(""));
        if told.elapsed() > Duration::from_millis(100) {
            *told = Instant::now();
            self.progress.tell(summary(&counts.stops, counts.errors));
        }
    }
}

/// How rows came out, in a few words.
fn summary(stops: &BTreeMap<String, u64>, errors: u64) -> String {
    let mut all: Vec<_> = stops.iter().collect();
    all.sort_by_key(|(_, number)| std::cmp::Reverse(**number));
    let mut words: Vec<_> = all
        .into_iter()
        .map(|(stop, number)| format!("{} {}", count(*number), stop.replace('_', " ")))
        .collect();
    if errors > 0 {
        words.push(format!("{} without an outcome", count(errors)));
    }
    words.join(", ")
}

impl RecordingsReport {
    fn line(&self) -> String {
        let Self {
            chosen,
            written,
            directory,
            failed,
        } = self;
        if *chosen == 0 {
            return "no run is chosen".to_owned();
        }
        let (chosen, written) = (runs(*chosen), count(*written));
        let early = match failed {
            0 => String::new(),
            failed => format!(", {} of them end early", count(*failed)),
        };
        format!("{chosen} in {directory}, {written} written now{early}")
    }
}

impl SweepReport {
    fn page(&self, arguments: &SweepArguments, left: u64, computing: Duration) -> Page {
        let mut facts = Vec::new();
        let outcomes = summary(&self.outcomes, self.errors);
        if !outcomes.is_empty() {
            facts.push(("outcomes", outcomes));
        }
        if let Some(error) = &self.first_error {
            facts.push(("first error", format!("run {}: {}", error.run, error.error)));
        }
        if arguments.dry_run {
            facts.push(("left", runs(left)));
            if let Some(seconds) = self.estimate {
                let threads = arguments.threads();
                facts.push(("time", format!("{}, {threads} at once", about(seconds))));
            }
        } else {
            let computing = computing.as_secs_f64();
            let computed = match self.computed {
                0 if left > 0 => "nothing".to_owned(),
                0 => "nothing: nothing was left to do".to_owned(),
                computed => format!(
                    "{} in {} s, {} a second",
                    runs(computed),
                    number(computing, 2),
                    number(computed as f64 / computing, 1)
                ),
            };
            facts.push(("computed", computed));
        }
        if let Some(table) = &self.table {
            facts.push(("table", table.line()));
        }
        if let Some(parts) = &self.parts {
            facts.push(("parts", parts.clone()));
            let how = if arguments.shard.is_some() && !self.interrupted {
                "once all shards are done, the command without --shard merges them"
            } else {
                "the same command goes on"
            };
            facts.push(("", how.to_owned()));
        }
        if let Some(recordings) = &self.recordings {
            facts.push(("recordings", recordings.line()));
        }
        let mut section = Section::default();
        section.table(PageTable::of_facts(facts));
        let (title, tone) = self.title(arguments);
        Page {
            title,
            tone,
            ..Page::of(section)
        }
    }

    fn title(&self, arguments: &SweepArguments) -> (String, Tone) {
        let runs = runs(self.runs);
        if self.interrupted {
            (format!("{runs}: interrupted"), Tone::Weak)
        } else if arguments.dry_run {
            (runs, Tone::Neutral)
        } else if let Some(Shard { index, count }) =
            arguments.shard.filter(|_| self.table.is_none())
        {
            (
                format!("{runs}: shard {index} of {count} is done"),
                Tone::Good,
            )
        } else if self.errors > 0 {
            let errors = count(self.errors);
            (
                format!("{runs}, {errors} of them without an outcome"),
                Tone::Weak,
            )
        } else {
            (runs, Tone::Good)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::arguments::parse;

    #[test]
    fn a_sweep_is_described() {
        let arguments = parse::<SweepArguments>(
            "paper viscous --over friction.k=0.01..0.1/4log --set stop.duration=1 -j 2 --shard 1/3",
        )
        .unwrap();
        assert_eq!(arguments.spec().unwrap().rows(), 8);
        let shard = Shard { index: 1, count: 3 };
        assert_eq!(arguments.options().shard, Some(shard));
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
    fn wrong_numbers_are_told_in_plain_words() {
        for (line, told) in [
            ("-j 0", "must be a whole number from 1 to 1024"),
            ("-j -1", "must be a whole number from 1 to 1024"),
            ("-j 70000", "must be a whole number from 1 to 1024"),
            ("--max-steps 0", "must be a whole number from 1 to 184"),
            ("--max-steps -1", "must be a whole number from 1 to 184"),
            ("--record 0", "must be a whole number from 1 to 184"),
            ("--sample 1e3", "must be a whole number from 1 to 184"),
            ("--sample 9 --seed -1", "must be a whole number from 0 to "),
            ("--shard -1/3", "must be I/N"),
            ("--shard 3/3", "must be I/N"),
        ] {
            let error = parse::<SweepArguments>(line).unwrap_err().to_string();
            assert!(error.contains(told), "{line}: {error}");
            assert!(!error.contains("-- -"), "{line}: {error}");
        }
        let seed = |line| parse::<SweepArguments>(line).unwrap().seed;
        assert_eq!((seed(""), seed("--sample 9 --seed 7")), (0, 7));
    }
}
