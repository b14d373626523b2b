//! `toprise diff`.

mod content;
mod junit;
#[cfg(feature = "rerun")]
mod viewer;

use super::arguments::{Format, Override, parse_override};
use super::done::Done;
use super::given::{Given, open};
use super::page::Page;
use super::progress::Progress;
use super::report::WrittenFile;
use super::{output, report};
use crate::analysis::diff::{
    Align, DifferenceFile, Matrix, Observer, Offset, Options, Report, Subject, Tolerance,
    Tolerances, Verdict, compare_observed,
};
use crate::archive::given::read_file;
use crate::archive::publish::{Existing, refuse_inputs};
use crate::archive::sink::SinkError;
use crate::telemetry::Message;
use crate::telemetry::encoding::Encoding;
use crate::telemetry::side::Side;
use anyhow::{Context as _, Error, bail};
use clap::{Args, ValueEnum};
use content::Detail;
use serde::Serialize;
use std::path::PathBuf;

/// Arguments of `toprise diff`.
#[derive(Args, Debug, PartialEq)]
pub(super) struct DiffArguments {
    /// Two runs or more: recordings (any MCAP files), presets, scenario files.
    #[arg(required = true, num_args = 2.., value_name = "RUN")]
    runs: Vec<PathBuf>,

    /// Set a key of every scenario that is simulated now, as in friction.k=0.02.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = parse_override)]
    overrides: Vec<Override>,

    /// Set a key of the first scenario.
    #[arg(long = "set-a", value_name = "KEY=VALUE", value_parser = parse_override)]
    overrides_a: Vec<Override>,

    /// Set a key of the second scenario.
    #[arg(long = "set-b", value_name = "KEY=VALUE", value_parser = parse_override)]
    overrides_b: Vec<Override>,

    /// What is compared with what: at equal times, at equal phases of the nutation, at equal means of θ, or in the order of
    /// the messages.
    #[arg(long, value_enum, default_value_t = AlignName::Time)]
    align: AlignName,

    /// Pair messages that are nearest to each other and no farther apart than this, as in 5ms: for clocks that jitter.
    #[arg(long, value_name = "TIME", value_parser = parse_time_span)]
    max_dt: Option<TimeSpan>,

    /// Put the second run's clock forward by this, as in 12.5s, or so that both start at the same time (start).
    #[arg(long, value_name = "TIME", value_parser = parse_offset, allow_hyphen_values = true)]
    offset: Option<OffsetName>,

    /// Largest difference that counts as none, in the unit of each field.
    #[arg(long, value_name = "NUMBER", default_value_t = 0.0)]
    abs: f64,

    /// Largest difference that counts as none, as a part of the larger magnitude.
    #[arg(long, value_name = "NUMBER", default_value_t = 0.0)]
    rel: f64,

    /// Largest difference that counts as none, as a number of doubles from one to the other.
    #[arg(long, value_name = "COUNT", default_value_t = 0)]
    ulp: u64,

    /// Tolerance of some fields, as in '/top/state.theta=1e-9' or '/top/torque.*=rel:1e-6,ulp:4'.
    #[arg(long, value_name = "PATTERN=VALUE")]
    tol: Vec<String>,

    /// A TOML file of tolerances: abs, rel, ulp, and a table [fields] of patterns.
    #[arg(long, value_name = "FILE")]
    tolerances: Option<PathBuf>,

    /// Compare only these topics, separated by commas.
    #[arg(long, value_name = "TOPICS", value_delimiter = ',')]
    topics: Vec<String>,

    /// Ignore these topics and fields, as in /top/pose or '/top/state.*_ddot'; may be given again.
    #[arg(long, value_name = "PATTERN")]
    ignore: Vec<String>,

    /// Don't find the integrators' errors: the scenarios are not simulated again.
    #[arg(long)]
    no_floor: bool,

    /// Show every field that differs, not only the one of each topic that differs most.
    #[arg(long)]
    all_fields: bool,

    /// Write the differences into this MCAP file, as channels with the fields of the recordings.
    #[arg(long, value_name = "FILE")]
    mcap: Option<PathBuf>,

    /// Encoding of that file's messages.
    #[arg(long, value_enum, default_value_t = Encoding::Protobuf, requires = "mcap")]
    encoding: Encoding,

    #[cfg(feature = "rerun")]
    #[command(flatten)]
    show: viewer::ShowArguments,

    /// Replace files that exist.
    #[arg(long)]
    force: bool,

    /// Form of the answer.
    #[arg(long, value_enum, default_value_t)]
    format: DiffFormat,

    /// Short for --format markdown.
    #[arg(long, conflicts_with = "format")]
    markdown: bool,
}

/// The form of a comparison's answer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum DiffFormat {
    /// For people, at a terminal.
    #[default]
    Text,
    /// For programs; schemas/toprise.*Report.json describe it.
    Json,
    /// For documents.
    Markdown,
    /// For CI: JUnit's XML, with a test for each topic.
    Junit,
}

/// What is compared with what.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum AlignName {
    /// At equal times.
    Time,
    /// At equal phases of the nutation.
    Nutation,
    /// At equal means of θ over a nutation.
    Theta,
    /// In the order of the messages.
    Index,
}

/// A time with a unit, ns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct TimeSpan(i64);

/// By how much a clock is put forward.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct OffsetName(Offset);

/// Reads a time as in `5ms`, exact to the nanosecond.
fn time_span(text: &str) -> Result<TimeSpan, String> {
    const UNITS: [(&str, i64); 8] = [
        ("ns", 1),
        ("us", 1_000),
        ("µs", 1_000),
        ("ms", 1_000_000),
        ("s", 1_000_000_000),
        ("min", 60_000_000_000),
        ("h", 3_600_000_000_000),
        ("d", 86_400_000_000_000),
    ];
    let refused =
        || "it must be a number with ns, us, ms, s, min, h or d, as in 5ms or -12.5s".to_owned();
    let at = text.find(char::is_alphabetic).ok_or_else(refused)?;
    let (number, unit) = text.split_at(at);
    let (_, factor) = UNITS
        .into_iter()
        .find(|(name, _)| *name == unit)
        .ok_or_else(refused)?;
    let (sign, digits) = match number.strip_prefix('-') {
        Some(digits) => (-1, digits),
        None => (1, number.strip_prefix('+').unwrap_or(number)),
    };
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let all = format!("{whole}{fraction}");
    if !all.bytes().all(|byte| byte.is_ascii_digit()) || all.is_empty() || fraction.len() > 18 {
        return Err(refused());
    }
    let digits = all.parse::<i128>().map_err(|_| refused())?;
    let scaled = digits.checked_mul(factor.into()).ok_or_else(refused)?;
    let ns = scaled / 10_i128.pow(fraction.len() as u32) * sign;
    i64::try_from(ns).map(TimeSpan).map_err(|_| refused())
}

fn parse_time_span(text: &str) -> Result<TimeSpan, String> {
    let span = time_span(text)?;
    if span.0 < 0 {
        return Err("it must not be negative".to_owned());
    }
    Ok(span)
}

fn parse_offset(text: &str) -> Result<OffsetName, String> {
    if text == "start" {
        return Ok(OffsetName(Offset::Start));
    }
    let span = time_span(text).map_err(|reason| format!("{reason}, or start"))?;
    Ok(OffsetName(Offset::By(span.0)))
}

impl From<AlignName> for Align {
    fn from(name: AlignName) -> Self {
        match name {
            AlignName::Time => Self::Time,
            AlignName::Nutation => Self::Nutation,
            AlignName::Theta => Self::Theta,
            AlignName::Index => Self::Index,
        }
    }
}

impl DiffArguments {
    fn options(&self) -> Result<Options, Error> {
        let mut tolerances = match &self.tolerances {
            Some(path) => {
                let context = || path.display().to_string();
                let text = read_file(path).with_context(context)?;
                Tolerances::from_toml(&text).with_context(context)?
            }
            None => Tolerances::default(),
        };
        let general = Tolerance {
            abs: self.abs,
            rel: self.rel,
            ulp: self.ulp,
        };
        // What is not given here stays as the file has it.
        let whole = &mut tolerances.general;
        if general.abs != 0.0 {
            whole.abs = general.abs;
        }
        if general.rel != 0.0 {
            whole.rel = general.rel;
        }
        if general.ulp != 0 {
            whole.ulp = general.ulp;
        }
        tolerances.ignored.clone_from(&self.ignore);
        tolerances.check()?;
        for tolerance in &self.tol {
            tolerances.add(tolerance)?;
        }
        if self.max_dt.is_some() && self.align != AlignName::Time {
            bail!("--max-dt pairs messages by their times: it goes with --align time");
        }
        Ok(Options {
            align: self.align.into(),
            max_dt: self.max_dt.map(|span| span.0 as u64),
            offset: self.offset.map(|offset| offset.0).unwrap_or_default(),
            tolerances,
            floor: !self.no_floor,
            topics: self.topics.clone(),
        })
    }

    /// The files to write.
    fn outputs(&self) -> impl Iterator<Item = &PathBuf> {
        #[cfg(feature = "rerun")]
        let rrd = self.show.rrd();
        #[cfg(not(feature = "rerun"))]
        let rrd = None;
        self.mcap.iter().chain(rrd)
    }

    /// The keys that are set in the scenario of this run alone.
    fn overrides_of(&self, at: usize) -> &[Override] {
        match at {
            0 => &self.overrides_a,
            1 => &self.overrides_b,
            _ => &[],
        }
    }

    /// The file of differences, if one is wanted.
    fn archive(&self, subjects: [Subject<'_>; 2]) -> Result<Option<DifferenceFile>, Error> {
        let Some(path) = &self.mcap else {
            return Ok(None);
        };
        if !subjects.iter().all(|subject| subject.is_ours()) {
            bail!("--mcap writes the fields of toprise's recordings; one of these is another file");
        }
        let existing = Existing::forced(self.force);
        Ok(Some(DifferenceFile::create(
            path,
            existing,
            self.encoding,
            subjects,
        )?))
    }

    fn print(&self, report: &Report) -> Result<(), Error> {
        let detail = if self.all_fields {
            Detail::AllFields
        } else {
            Detail::Short
        };
        let page = || content::page(report, detail);
        self.print_as(report, std::slice::from_ref(report), page)
    }

    /// Prints an answer, which is about these pairs of runs, in the form that was chosen.
    fn print_as(
        &self,
        answer: &impl Serialize,
        pairs: &[Report],
        page: impl FnOnce() -> Page,
    ) -> Result<(), Error> {
        let format = match self.format {
            _ if self.markdown => Format::Markdown,
            DiffFormat::Text => Format::Text,
            DiffFormat::Json => Format::Json,
            DiffFormat::Markdown => Format::Markdown,
            DiffFormat::Junit => {
                output::print(&junit::document(pairs))?;
                return Ok(());
            }
        };
        report::print(answer, format, page)
    }
}

/// Refuses to write to a file that is read, or two things to one file.
fn refuse_outputs(arguments: &DiffArguments) -> Result<(), Error> {
    let mut taken = arguments.runs.clone();
    taken.extend(arguments.tolerances.clone());
    for output in arguments.outputs() {
        refuse_inputs(output, taken.iter().map(PathBuf::as_path))?;
        taken.push(output.clone());
    }
    Ok(())
}

/// Compares runs.
pub(super) fn diff(arguments: &DiffArguments) -> Result<Done, Error> {
    let options = arguments.options()?;
    refuse_outputs(arguments)?;
    let runs = given(arguments)?;
    if let [a, b] = runs.as_slice() {
        return two(arguments, &options, a, b);
    }
    #[cfg(feature = "rerun")]
    if arguments.show.is_asked() {
        bail!("Rerun shows two runs: name two");
    }
    if arguments.mcap.is_some() {
        bail!("--mcap is for two runs");
    }
    if !(arguments.overrides_a.is_empty() && arguments.overrides_b.is_empty()) {
        bail!("--set-a and --set-b are for two runs; --set is for all");
    }
    several(arguments, &options, &runs)
}

fn given(arguments: &DiffArguments) -> Result<Vec<Given>, Error> {
    let words = arguments.runs.iter().enumerate();
    let runs = words.map(|(at, word)| open(word, &arguments.overrides, arguments.overrides_of(at)));
    let runs = runs.collect::<Result<Vec<_>, _>>()?;
    let is_simulated = |run: &Given| matches!(run, Given::Scenario(_));
    if !arguments.overrides.is_empty() && !runs.iter().any(is_simulated) {
        bail!("--set has nothing to set: all runs are recordings");
    }
    Ok(runs)
}

/// Everything that watches a comparison: the progress bar and what is written.
struct Watching<'a> {
    progress: &'a Progress,
    archive: Option<DifferenceFile>,
    #[cfg(feature = "rerun")]
    viewer: Option<viewer::Viewer>,
}

impl<'a> Watching<'a> {
    /// A comparison that is only watched, by the progress bar.
    fn alone(progress: &'a Progress) -> Self {
        Self {
            progress,
            archive: None,
            #[cfg(feature = "rerun")]
            viewer: None,
        }
    }

    /// Everything that is written and takes the messages.
    fn takers(&mut self) -> impl Iterator<Item = &mut dyn Observer> {
        let archive = self
            .archive
            .as_mut()
            .map(|archive| archive as &mut dyn Observer);
        #[cfg(feature = "rerun")]
        let viewer = self
            .viewer
            .as_mut()
            .map(|viewer| viewer as &mut dyn Observer);
        #[cfg(not(feature = "rerun"))]
        let viewer = None;
        archive.into_iter().chain(viewer)
    }

    /// Completes what is written, and says what was.
    fn finish(self, report: &Report) -> Result<(), Error> {
        let tell = |file: &WrittenFile| output::note(&format!("wrote {}", file.line()));
        if let Some(archive) = self.archive {
            let written = archive.finish(report)?;
            tell(&WrittenFile::new(&written.path, written.bytes));
        }
        #[cfg(feature = "rerun")]
        if let Some(viewer) = self.viewer {
            let page = content::page(report, Detail::Short);
            let (target, written) = viewer.finish(&page.markdown())?;
            if let Some(file) = written {
                tell(&file);
            }
            viewer::serve(target)?;
        }
        Ok(())
    }
}

impl Observer for Watching<'_> {
    fn message(&mut self, side: Side, message: &Message<'_>) -> Result<(), SinkError> {
        self.takers()
            .try_for_each(|taker| taker.message(side, message))
    }

    fn difference(&mut self, message: &Message<'_>) -> Result<(), SinkError> {
        self.takers()
            .try_for_each(|taker| taker.difference(message))
    }

    fn progress(&mut self, bytes: u64) {
        self.progress.add(bytes);
    }
}

fn two(arguments: &DiffArguments, options: &Options, a: &Given, b: &Given) -> Result<Done, Error> {
    let subjects = [a, b].map(Given::subject);
    let progress = Progress::of_bytes("comparing", a.bytes() + b.bytes());
    let mut watching = Watching::alone(&progress);
    watching.archive = arguments.archive(subjects)?;
    #[cfg(feature = "rerun")]
    {
        let existing = Existing::forced(arguments.force);
        watching.viewer = arguments.show.open(subjects, existing)?;
    }
    let compared = compare_observed(subjects[0], subjects[1], options, &mut watching);
    progress.finish();
    let report = compared?;
    arguments.print(&report)?;
    watching.finish(&report)?;
    Ok(done(std::iter::once(&report)))
}

fn several(arguments: &DiffArguments, options: &Options, runs: &[Given]) -> Result<Done, Error> {
    let bytes: u64 = runs.iter().map(Given::bytes).sum();
    // Each is read once for each of the others.
    let progress = Progress::of_bytes("comparing", bytes * (runs.len() as u64 - 1));
    let matrix = Matrix::new(runs.len(), |i, j| {
        // The integrators' errors are only told of the pairs that are reported.
        let options = Options {
            floor: options.floor && i == 0,
            ..options.clone()
        };
        let [a, b] = [&runs[i], &runs[j]].map(Given::subject);
        compare_observed(a, b, &options, &mut Watching::alone(&progress)).with_context(|| {
            let [a, b] = [i, j].map(|at| arguments.runs[at].display());
            format!("{a} and {b}")
        })
    });
    progress.finish();
    let matrix = matrix?;
    let page = || content::matrix_page(&matrix);
    arguments.print_as(&matrix, &matrix.against_first, page)?;
    Ok(done(&matrix.against_first))
}

/// How the comparisons ended as a whole: a difference counts more than something that is missing.
fn done<'a>(reports: impl IntoIterator<Item = &'a Report>) -> Done {
    let mut done = Done::Well;
    for report in reports {
        if report.verdict == Verdict::Different {
            return Done::Differing;
        }
        if report.verdict == Verdict::Agreeing {
            done = Done::WithLosses;
        }
    }
    done
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::arguments::parse;

    #[test]
    fn runs_and_tolerances_are_named() {
        let base = parse::<DiffArguments>("a b").unwrap();
        assert_eq!(
            parse::<DiffArguments>("a b --rel 1e-9 --tol *=ulp:4 --topics /events,/top/state")
                .unwrap(),
            DiffArguments {
                rel: 1e-9,
                tol: vec!["*=ulp:4".to_owned()],
                topics: vec!["/events".to_owned(), "/top/state".to_owned()],
                ..base
            }
        );
        for line in [
            "a",
            "a b --rel x",
            "a b --align phase",
            "a b --encoding json",
        ] {
            assert!(parse::<DiffArguments>(line).is_err(), "{line}");
        }
    }

    #[test]
    fn times_have_units_and_keep_their_nanoseconds() {
        for (text, ns) in [
            ("5ms", 5_000_000),
            ("12.5s", 12_500_000_000),
            ("-1.000000001s", -1_000_000_001),
            ("+3us", 3_000),
            ("0.5min", 30_000_000_000),
            ("9223372036854775807ns", i64::MAX),
        ] {
            assert_eq!(time_span(text), Ok(TimeSpan(ns)), "{text}");
        }
        for text in [
            "5",
            "ms",
            "-s",
            "1e3s",
            "1.2.3s",
            "5 ms",
            "9999999999h",
            "١s",
        ] {
            assert!(time_span(text).is_err(), "{text}");
        }
        assert!(parse_time_span("-5ms").is_err());
        assert_eq!(parse_offset("start"), Ok(OffsetName(Offset::Start)));
        let line = "a b --offset -1.5s --max-dt 2ms";
        let options = parse::<DiffArguments>(line).unwrap().options().unwrap();
        assert_eq!(
            (options.offset, options.max_dt),
            (Offset::By(-1_500_000_000), Some(2_000_000))
        );
    }

    #[test]
    fn what_is_given_beside_a_file_of_tolerances_counts() {
        let arguments = parse::<DiffArguments>("a b --abs 0.5 --ulp 3").unwrap();
        let general = arguments.options().unwrap().tolerances.general;
        assert_eq!((general.abs, general.rel, general.ulp), (0.5, 0.0, 3));
    }
}
