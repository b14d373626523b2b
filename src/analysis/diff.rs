//! Comparison of two runs: scenarios, events, averaged motion, messages.
//!
//! [`compare`] reads two runs in parallel, in one pass and constant memory. The nutations of two similar models lose
//! phase; then differences at equal times are meaningless. The [`Report`] therefore contains averages over the
//! nutation, compares the models at equal states, and estimates the integration errors.
//!
//! Messages of files not written by toprise are compared as they stand in the files. JSON that is only spelled
//! differently has the same values.
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

mod agreement;
mod averages;
mod discrepancy;
mod error;
mod evidence;
mod findings;
mod integration_error;
mod observer;
mod others;
mod pairing;
mod report;
mod setup;
mod tolerance;
mod topic;
mod variation;

pub use self::agreement::{Agreement, Change, Precision, RunEnd};
pub use self::averages::{Averaged, Deviation};
pub use self::discrepancy::{Discrepancy, Residual};
pub use self::error::{DiffError, ToleranceProblem};
pub use self::findings::contrast::Contrast;
pub use self::findings::finding::{Dependence, Finding};
pub use self::findings::quantity::{EndCondition, Quantity};
pub use self::integration_error::{IntegrationErrors, IntegratorError};
pub use self::observer::Observer;
pub use self::others::TopicBytes;
pub use self::report::{ComparedRun, Report, Verdict};
pub use self::setup::{KeyDifference, SetupDifferences};
pub use self::tolerance::{Options, Tolerance, Tolerances, full_name};
pub use self::topic::field::FieldDifference;
pub use self::topic::{ChannelDifference, FirstDifference};
pub use self::variation::by_key::{ByKey, Effect, KeyChange, KeyPlan};
pub use self::variation::matching::{Match, MatchError, find_match};
pub use self::variation::sensitivity::{MEASURED, Sensitivity, sensitivities};
pub use crate::analysis::history::{PegSummary, RunSummary};
pub use crate::analysis::subject::Subject;

use self::pairing::{Limits, Paired, read_both};
use crate::archive::recording::Recording;
use crate::run::time::seconds;
use crate::telemetry::side::Side;
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
    let runs = [a.into(), b.into()];
    let mut report = if runs.iter().all(|run| run.is_ours()) {
        compare_runs(runs, options, observer)?
    } else {
        compare_files(runs, options, observer)?
    };
    // What was left out may differ, so a part is never called identical.
    let is_part = !options.topics.is_empty() || !options.tolerances.ignored.is_empty();
    if is_part && [Verdict::Identical, Verdict::SameValues].contains(&report.verdict) {
        report.verdict = Verdict::Equal;
    }
    if is_part {
        report.agreement = None;
    }
    Ok(report)
}

/// Compares two runs of toprise.
fn compare_runs(
    runs: [Subject<'_>; 2],
    options: &Options,
    observer: &mut dyn Observer,
) -> Result<Report, DiffError> {
    let topics = runs.map(Subject::topics);
    let mut fields = Vec::new();
    for topic in topics.iter().flatten() {
        fields.extend(topic.numbers().map(|field| field.to_string()));
    }
    let others: Vec<_> = runs
        .into_iter()
        .flat_map(|run| foreign_topics(run, true))
        .collect();
    options.tolerances.check_names(&fields, &others)?;
    let names = topics.map(|of_run| of_run.iter().map(ToString::to_string).collect());
    let (common, mut only_in) = common_topics(&names, options)?;
    if options.topics.is_empty() {
        add_foreign_topics(&mut only_in, runs, options);
    }
    let setup = setup::compare(runs, only_in);
    let carry_on = observer.carry_on();
    let limits = Limits {
        topics: &common,
        until: None,
    };
    let paired = read_both(runs, &limits, options, observer, &carry_on)?;
    check_messages(runs, &paired)?;
    let integrations = match paired.common_end() {
        Some(end) if options.integration_error => {
            let runs =
                Side::BOTH.map(|side| (runs[side.index()], &paired.runs[side.index()].history));
            let limits = Limits {
                until: Some(seconds(end)),
                ..limits
            };
            integration_error::compute(runs, &limits, &carry_on)
        }
        _ => None,
    };
    let others = match runs {
        [Subject::Recording(a), Subject::Recording(b)] if options.topics.is_empty() => {
            compare_bytes([a, b], &paired, &common, options)
        }
        _ => Vec::new(),
    };
    Ok(Report::from_runs(
        runs,
        &paired,
        setup,
        others,
        integrations,
        options,
    ))
}

/// Checks that both runs have messages if one has, and that a damaged or interrupted run shares some with the other. Of
/// two runs without messages only those of one scenario are equal: each has all that it should have.
fn check_messages(runs: [Subject<'_>; 2], paired: &Paired) -> Result<(), DiffError> {
    let has_messages = paired.runs.each_ref().map(|run| run.history.messages > 0);
    if has_messages == [false; 2] {
        let [a, b] = runs.map(|run| run.scenario().map(|scenario| scenario.digest()));
        if a.is_none() || a != b {
            return Err(DiffError::NoMessages);
        }
    }
    for (run, side) in paired.runs.iter().zip(Side::BOTH) {
        if run.history.messages == 0 && has_messages != [false; 2] {
            return Err(DiffError::NoReadableMessages {
                side,
                losses: run.losses.clone(),
            });
        }
    }
    let is_whole = paired.runs.iter().all(|run| run.losses.is_empty());
    if is_whole || paired.pairs() > 0 {
        Ok(())
    } else {
        Err(DiffError::NothingInCommon)
    }
}

/// Adds the topics that are not in the telemetry table and that only one of the runs has. View topics are left out:
/// they repeat what other topics have. So are supplements: they are no part of a run, and the set-up lists them.
fn add_foreign_topics(only_in: &mut [Vec<String>; 2], runs: [Subject<'_>; 2], options: &Options) {
    let foreign = runs.map(|run| match run {
        Subject::Scenario(_) => BTreeSet::new(),
        Subject::Recording(recording) => {
            let mut topics = foreign_topics(run, false);
            let supplements = recording.channels().iter().filter(|c| c.is_supplement());
            supplements.for_each(|channel| _ = topics.remove(&channel.topic));
            topics
        }
    });
    for (side, only) in only_in.iter_mut().enumerate() {
        let unmatched = foreign[side].difference(&foreign[1 - side]);
        only.extend(
            unmatched
                .filter(|topic| !options.tolerances.ignores(topic))
                .cloned(),
        );
    }
}

/// Compares the messages of two recordings as they stand in the files: those of foreign topics, and if the values of
/// the compared topics are identical and equally encoded by one version, those of all topics.
fn compare_bytes(
    [a, b]: [&Recording; 2],
    paired: &Paired,
    compared: &[String],
    options: &Options,
) -> Vec<TopicBytes> {
    // Another version may word its schemas, and draw in its channels for viewers, what it likes.
    let is_one_form = a.library() == b.library() && a.encoding() == b.encoding();
    let is_identical = is_one_form && paired.is_identical();
    let has_views = is_identical && [a, b].iter().all(|run| run.relogged().is_none());
    let [mut topics, of_b] =
        [a, b].map(|recording| foreign_topics(Subject::Recording(recording), has_views));
    topics.retain(|topic| of_b.contains(topic) && !options.tolerances.ignores(topic));
    if is_identical && options.tolerances.ignored.is_empty() {
        topics.extend(compared.iter().cloned());
    }
    others::compare([a, b], &Vec::from_iter(topics), &mut |_| {}).0
}

/// The topics that are compared, and those that only A and only B has. Ignored topics are left out, and others than those
/// that are asked for.
fn common_topics(
    [a, b]: &[Vec<String>; 2],
    options: &Options,
) -> Result<(Vec<String>, [Vec<String>; 2]), DiffError> {
    let divided = [(a, b), (b, a)].map(|(run, other)| {
        let other: BTreeSet<_> = other.iter().collect();
        let mut topics = run.clone();
        topics.retain(|topic| !options.tolerances.ignores(topic));
        topics.into_iter().partition(|topic| other.contains(topic))
    });
    let [(mut common, of_a), (_, of_b)]: [(Vec<_>, Vec<_>); 2] = divided;
    let mut all = a.iter().chain(b).peekable();
    if all.peek().is_some() && all.all(|topic| options.tolerances.ignores(topic)) {
        return Err(DiffError::AllIgnored);
    }
    if common.is_empty() {
        return Err(DiffError::NoCommonTopics {
            topics: [of_a, of_b],
        });
    }
    if let Some(topic) = options.topics.iter().find(|topic| !common.contains(topic)) {
        return Err(DiffError::TopicNotCommon {
            topic: topic.clone(),
            common,
        });
    }
    if options.topics.is_empty() {
        return Ok((common, [of_a, of_b]));
    }
    common.retain(|topic| options.topics.contains(topic));
    Ok((common, Default::default()))
}

/// Foreign topics of a toprise recording, optionally with view topics.
fn foreign_topics(run: Subject<'_>, with_views: bool) -> BTreeSet<String> {
    let Subject::Recording(recording) = run else {
        return BTreeSet::new();
    };
    recording
        .channels()
        .iter()
        .filter(|channel| channel.table.is_none() && (with_views || !channel.is_view()))
        .map(|channel| channel.topic.clone())
        .collect()
}

/// Compares two files byte by byte; at least one is not a toprise recording.
fn compare_files(
    runs: [Subject<'_>; 2],
    options: &Options,
    observer: &mut dyn Observer,
) -> Result<Report, DiffError> {
    let [Subject::Recording(a), Subject::Recording(b)] = runs else {
        let side = if runs[0].is_ours() { Side::B } else { Side::A };
        return Err(DiffError::OnlyWithFile { side });
    };
    let topics = [a, b].map(|recording| {
        let channels = recording.channels().iter();
        let topics: BTreeSet<_> = channels.map(|channel| channel.topic.clone()).collect();
        Vec::from_iter(topics)
    });
    if options.tolerances.are_set() {
        return Err(DiffError::TolerancesNeedFields);
    }
    options.tolerances.check_names(&[], &topics.concat())?;
    let is_empty = topics.iter().all(Vec::is_empty);
    let (common, only_in) = if is_empty && options.topics.is_empty() {
        Default::default()
    } else {
        common_topics(&topics, options)?
    };
    let (others, losses) = others::compare([a, b], &common, &mut |bytes| observer.progress(bytes));
    let is_cut = losses.iter().any(|losses| !losses.is_empty());
    if is_cut && others.iter().all(|topic| topic.pairs() == 0) {
        return Err(DiffError::NothingInCommon);
    }
    let setup = setup::compare(runs, only_in);
    Ok(Report::from_files(runs, setup, others, &losses))
}
