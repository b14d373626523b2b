//! Comparison of two runs: scenarios, events, averaged motion, messages.
//!
//! [`compare`] reads two runs in parallel, in one pass and constant memory. The nutations of two similar models lose
//! phase; then differences at equal times are meaningless. The [`Report`] therefore contains averages over the
//! nutation, compares the models at equal states, and estimates the integration errors.
//!
//! Messages of files not written by toprise are compared byte by byte.
//!
//! ```
//! use toprise::analysis::diff::{Options, Verdict, compare};
//! use toprise::run::scenario::{Preset, Scenario};
//!
//! let scenario = |k| {
//!     let mut values = Preset::find("paper")?.values()?;
//!     values.set("stop.duration", "0.1")?;
//!     values.set("friction.k", k)?;
//!     Scenario::new(values)
//! };
//! let (a, b) = (scenario("0.03")?, scenario("0.0303")?);
//! let report = compare(&a, &b, &Options::default())?;
//! assert_eq!(report.verdict, Verdict::Different);
//! assert_eq!(report.setup.scenario[0].key, "friction.k");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod averages;
mod crossing;
mod derived;
mod discrepancy;
mod error;
mod field;
mod findings;
mod floor;
mod observer;
mod others;
mod pairing;
mod report;
mod setup;
mod tolerance;
mod topic;

pub use self::averages::{Averaged, Deviation};
pub use self::discrepancy::{Discrepancy, Residual};
pub use self::error::DiffError;
pub use self::field::FieldDifference;
pub use self::findings::Finding;
pub use self::floor::{Floor, IntegratorError};
pub use self::observer::Observer;
pub use self::others::TopicBytes;
pub use self::report::{ComparedRun, Report, Verdict};
pub use self::setup::{KeyDifference, SetupDifferences};
pub use self::tolerance::{Options, Tolerance, Tolerances, full_name};
pub use self::topic::{ChannelDifference, FirstDifference};
pub use crate::analysis::history::{PegSummary, RunSummary};
pub use crate::analysis::subject::Subject;

use self::field::seconds;
use self::pairing::read_both;
use crate::archive::recording::{FileChannel, Recording};
use crate::run::scenario::Scenario;
use crate::telemetry::Topic;
use std::collections::BTreeSet;

/// Compares two runs.
///
/// # Errors
/// [`DiffError`] if there is nothing to compare, or the options don't apply to the runs.
pub fn compare<'a>(
    a: impl Into<Subject<'a>>,
    b: impl Into<Subject<'a>>,
    options: &Options,
) -> Result<Report, DiffError> {
    compare_observed(a, b, options, &mut ())
}

/// Like [`compare`], and passes all messages and differences to `observer`.
///
/// # Errors
/// As [`compare`], and the observer's errors.
pub fn compare_observed<'a>(
    a: impl Into<Subject<'a>>,
    b: impl Into<Subject<'a>>,
    options: &Options,
    observer: &mut dyn Observer,
) -> Result<Report, DiffError> {
    let mut report = compare_given([a.into(), b.into()], options, observer)?;
    let is_part = !options.topics.is_empty() || !options.tolerances.ignored.is_empty();
    if is_part && [Verdict::Identical, Verdict::SameValues].contains(&report.verdict) {
        report.verdict = Verdict::Equal;
    }
    Ok(report)
}

fn compare_given(
    runs: [Subject<'_>; 2],
    options: &Options,
    observer: &mut dyn Observer,
) -> Result<Report, DiffError> {
    if let [false, _] | [_, false] = runs.map(Subject::is_ours) {
        return compare_files(runs, options, observer);
    }
    let again = resampled(runs);
    let named = runs;
    let runs = match &again {
        Some(scenario) => [runs[0], Subject::Scenario(scenario)],
        None => runs,
    };
    let topics = common_topics(runs, options)?;
    let paired = read_both(runs, &topics, options, observer)?;
    for (run, side) in paired.runs.iter().zip(["A", "B"]) {
        if run.history.messages == 0 && paired.runs.iter().any(|run| run.history.messages > 0) {
            let losses = run.losses.join("; ");
            return Err(DiffError::NoMessages { side, losses });
        }
    }
    let floor = match paired.common_end() {
        Some(end) if options.floor => floor::compute(runs, seconds(end), &observer.carry_on()),
        _ => None,
    };
    let others = match runs {
        [Subject::Recording(a), Subject::Recording(b)] if options.topics.is_empty() => {
            // View channels are derived; compare them only if everything else is equal.
            let with_views = a.encoding() == b.encoding() && paired.is_identical();
            let [of_a, of_b] = runs.map(|run| strangers(run, with_views));
            let mut common: BTreeSet<String> = of_a.intersection(&of_b).cloned().collect();
            common.retain(|topic| !options.tolerances.ignores(topic));
            others::compare([a, b], &common, &mut |_| {}).0
        }
        _ => Vec::new(),
    };
    let mut report = Report::of_runs(runs, &paired, others, floor, options);
    if again.is_some() {
        report.note_resampling(named);
    }
    Ok(report)
}

/// B with A's sampling period, if the periods are incommensurate.
fn resampled(runs: [Subject<'_>; 2]) -> Option<Scenario> {
    let [a, b] = [runs[0].scenario()?, runs[1].scenario()?];
    let periods = [&a, &b].map(|scenario| scenario.sample_period_ns);
    if periods[0].is_multiple_of(periods[1]) || periods[1].is_multiple_of(periods[0]) {
        return None;
    }
    let period = periods[0] as f64 / 1e9;
    b.with([("sampling.period", period.into())]).ok()
}

/// The topics of the table that are compared.
fn common_topics(runs: [Subject<'_>; 2], options: &Options) -> Result<Vec<Topic>, DiffError> {
    let [a, b] = runs.map(Subject::topics);
    let names = |topics: &[Topic]| {
        let names: Vec<String> = topics.iter().map(ToString::to_string).collect();
        names.join(", ")
    };
    let numbers = a.iter().chain(&b).flat_map(|topic| topic.numbers());
    let numbers = numbers.map(|field| field.to_string());
    let known: Vec<String> = numbers
        .chain(runs.into_iter().flat_map(|run| strangers(run, true)))
        .collect();
    options.tolerances.match_any_of(&known)?;
    let is_common = |topic: &Topic| b.contains(topic) && !options.tolerances.ignores(topic.name());
    let common: Vec<Topic> = a.iter().copied().filter(is_common).collect();
    if common.is_empty() {
        let (a, b) = (names(&a), names(&b));
        return Err(DiffError::NoCommonTopics { a, b });
    }
    for name in &options.topics {
        if !common.iter().any(|topic| topic.name() == name) {
            return Err(DiffError::UnknownTopic {
                topic: name.clone(),
                common: names(&common),
            });
        }
    }
    let is_wanted = |topic: &Topic| {
        options.topics.is_empty() || options.topics.iter().any(|name| topic.name() == name)
    };
    Ok(common.into_iter().filter(is_wanted).collect())
}

/// Foreign topics of a toprise recording, optionally with view topics.
fn strangers(run: Subject<'_>, with_views: bool) -> BTreeSet<String> {
    let Subject::Recording(recording) = run else {
        return BTreeSet::new();
    };
    let is_strange =
        |channel: &&FileChannel| channel.table.is_none() && (with_views || !channel.is_view());
    let channels = recording.channels().iter().filter(is_strange);
    channels.map(|channel| channel.topic.clone()).collect()
}

/// Compares two files byte by byte; at least one is not a toprise recording.
fn compare_files(
    runs: [Subject<'_>; 2],
    options: &Options,
    observer: &mut dyn Observer,
) -> Result<Report, DiffError> {
    let [a, b] = match runs {
        [Subject::Recording(a), Subject::Recording(b)] => [a, b],
        [Subject::Scenario(_), _] => return Err(DiffError::Mixed { side: "B" }),
        [_, Subject::Scenario(_)] => return Err(DiffError::Mixed { side: "A" }),
    };
    let all = |recording: &Recording| -> Vec<String> {
        let channels = recording.channels().iter();
        channels.map(|channel| channel.topic.clone()).collect()
    };
    options
        .tolerances
        .match_any_of(&[all(a), all(b)].concat())?;
    let topics = |recording: &Recording| -> BTreeSet<String> {
        let topics = all(recording).into_iter();
        topics
            .filter(|topic| !options.tolerances.ignores(topic))
            .collect()
    };
    let [of_a, of_b] = [a, b].map(topics);
    let names = |topics: &BTreeSet<String>| {
        let names: Vec<&str> = topics.iter().map(String::as_str).collect();
        names.join(", ")
    };
    let mut common: BTreeSet<String> = of_a.intersection(&of_b).cloned().collect();
    if common.is_empty() && !(of_a.is_empty() && of_b.is_empty()) {
        let (a, b) = (names(&of_a), names(&of_b));
        return Err(DiffError::NoCommonTopics { a, b });
    }
    let mut only_in = [&of_a - &of_b, &of_b - &of_a].map(|alone| alone.into_iter().collect());
    if !options.topics.is_empty() {
        if let Some(topic) = options.topics.iter().find(|topic| !common.contains(*topic)) {
            return Err(DiffError::UnknownTopic {
                topic: topic.clone(),
                common: names(&common),
            });
        }
        common.retain(|topic| options.topics.contains(topic));
        only_in = Default::default();
    }
    let (others, losses) = others::compare([a, b], &common, &mut |bytes| observer.progress(bytes));
    Ok(Report::of_files(runs, others, only_in, &losses))
}
