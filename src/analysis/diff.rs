//! What differs between two runs, and why: in the set-up, in what happened, in the averaged motion, and point
//! by point.
//!
//! [`compare`] reads two runs side by side, once, in memory that doesn't grow with the number of samples. Two
//! nearly equal models part in the phase of their nutation, after which the difference at equal times says
//! nothing about the models; therefore the [`Report`] separates drift, phase and amplitude, compares the models
//! along one and the same motion, and tells the integrators' own errors beside the differences.
//!
//! Any two MCAP files can be compared: of files that toprise did not write, the numbers of common topics.
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

mod archive;
mod averages;
mod discrepancy;
mod floor;
mod growth;
mod happened;
mod matrix;
mod pairing;
mod pass;
mod plan;
mod report;
mod setup;
mod signals;
mod stream;
mod summary;
mod timing;
mod tolerance;

pub use self::archive::{Archive, DIFF_RECORD};
pub use self::matrix::{Matrix, MatrixRow};
pub use self::report::*;
pub use self::tolerance::{Tolerance, Tolerances, full_name};
pub use crate::analysis::course::CourseReport;
pub use crate::analysis::subject::Subject;
use crate::archive::format::{CONTENT_DIGEST, LIBRARY};
use crate::archive::recording::Condition;
use crate::archive::sink::SinkError;
use crate::telemetry::Message;
use crate::telemetry::side::Side;
use pass::Passed;
use plan::Plan;
use thiserror::Error;

/// What of B is compared with what of A.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Align {
    /// What is at the same time.
    #[default]
    Time,
    /// What is at the same phase of the nutation: after as many cycles.
    Nutation,
    /// What is at the same mean of θ over a nutation.
    Theta,
}

/// How to compare.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// What is compared with what.
    pub align: Align,
    /// What counts as equal.
    pub tolerances: Tolerances,
    /// Whether to find the integrators' errors, by simulating each scenario again with tighter tolerances.
    pub floor: bool,
    /// Only these topics; all if there are none.
    pub topics: Vec<String>,
}

impl Default for Options {
    /// At equal times, bit for bit, all topics, with the integrators' errors.
    fn default() -> Self {
        Self {
            align: Align::Time,
            tolerances: Tolerances::default(),
            floor: true,
            topics: Vec::new(),
        }
    }
}

/// Why two runs can't be compared.
#[derive(Debug, Error)]
pub enum DiffError {
    /// A tolerance that can't be understood.
    #[error("tolerance {text:?}: {reason}")]
    Tolerance {
        /// What was given.
        text: String,
        /// What is wrong with it.
        reason: String,
    },
    /// A pattern for which there is no field.
    #[error("no field is meant by {pattern:?}; {}",
            if near.is_empty() { "there are none".to_owned() } else { format!("the nearest: {near}") })]
    UnknownField {
        /// The pattern.
        pattern: String,
        /// Fields with similar names.
        near: String,
    },
    /// A topic was asked for that not both have.
    #[error("the topic {topic} can't be compared; those that can: {common}")]
    UnknownTopic {
        /// The topic.
        topic: String,
        /// Those that both have.
        common: String,
    },
    /// There is nothing to compare.
    #[error("they have no topic in common: A has {a}; B has {b}")]
    NoCommonTopics {
        /// A's topics.
        a: String,
        /// B's topics.
        b: String,
    },
    /// Neither messages at the same times nor around them.
    #[error("their times don't overlap: A is from {} s to {} s, B from {} s to {} s",
            a.0 as f64 / 1e9, a.1 as f64 / 1e9, b.0 as f64 / 1e9, b.1 as f64 / 1e9)]
    NoOverlap {
        /// The times of A's first and last message, ns.
        a: (u64, u64),
        /// The times of B's first and last message, ns.
        b: (u64, u64),
    },
    /// There are no two messages that could be compared.
    #[error("they have no common times, and none that lie between two of the other")]
    NoCommonTimes,
    /// One of them is empty.
    #[error("{side} has no messages that can be read in the topics that both have: {topics}{}",
            if losses.is_empty() { String::new() } else { format!(" ({losses})") })]
    NoMessages {
        /// Which.
        side: &'static str,
        /// The topics.
        topics: String,
        /// What could not be read.
        losses: String,
    },
    /// The alignment that was asked for is not possible.
    #[error("can't align by {by}: {reason}")]
    Align {
        /// The alignment.
        by: &'static str,
        /// Why not.
        reason: String,
    },
    /// What is written at the same time could not be written.
    #[error(transparent)]
    Sink(#[from] SinkError),
}

/// Somebody who wants to see everything that passes by in a comparison.
///
/// Only messages of the table are shown.
pub trait Observer {
    /// A message of one run.
    ///
    /// # Errors
    /// [`SinkError`] ends the comparison.
    fn message(&mut self, _side: Side, _message: &Message<'_>) -> Result<(), SinkError> {
        Ok(())
    }

    /// B − A of a pair of messages, at A's time.
    ///
    /// # Errors
    /// [`SinkError`] ends the comparison.
    fn difference(&mut self, _message: &Message<'_>) -> Result<(), SinkError> {
        Ok(())
    }

    /// So many more bytes of the files have been read.
    fn progress(&mut self, _bytes: u64) {}
}

/// Nobody.
impl Observer for () {}

/// Compares two runs.
///
/// # Errors
/// [`DiffError`] if there is nothing to compare, or the options don't fit the runs.
pub fn compare<'a>(
    a: impl Into<Subject<'a>>,
    b: impl Into<Subject<'a>>,
    options: &Options,
) -> Result<Report, DiffError> {
    compare_observed(a, b, options, &mut ())
}

/// Compares two runs and shows `observer` what passes by.
///
/// # Errors
/// As [`compare`], and the observer's errors.
pub fn compare_observed<'a>(
    a: impl Into<Subject<'a>>,
    b: impl Into<Subject<'a>>,
    options: &Options,
    observer: &mut dyn Observer,
) -> Result<Report, DiffError> {
    let (a, b) = (a.into(), b.into());
    let plan = Plan::new(a, b, options)?;
    let passed = pass::run(a, b, &plan, &options.tolerances, observer)?;
    let last = passed.spans.iter().flatten().map(|(_, last)| *last).min();
    let floor = match last {
        Some(last) if options.floor && plan.is_ours => floor::compute(a, b, last as f64 / 1e9),
        _ => None,
    };
    let mut report = passed.report(a, b, &plan, floor);
    report.summary = report.sentences(["A", "B"]);
    Ok(report)
}

/// What is said of a run in the report.
fn run(subject: Subject<'_>, passed: &Passed, side: usize, is_ours: bool) -> Run {
    let course = &passed.courses[side];
    let mut run = Run {
        name: subject.name(),
        library: LIBRARY.to_owned(),
        messages: passed.messages[side],
        last: passed.spans[side].map_or(0.0, |(_, last)| last as f64 / 1e9),
        losses: passed.losses[side].clone(),
        course: is_ours.then(|| course.report()),
        ..Run::default()
    };
    if let Subject::Recording(recording) = subject {
        run.file = Some(recording.path().display().to_string());
        run.condition = Some(recording.condition());
        run.library = recording.library().to_owned();
        run.encoding = Some(setup::encodings(recording));
        let end = recording.end();
        run.content_digest = end.and_then(|end| end.get(CONTENT_DIGEST).cloned());
        run.losses
            .splice(0..0, recording.losses().iter().map(ToString::to_string));
        if recording.condition() == Condition::Interrupted {
            run.losses
                .push("the end of the run: it was interrupted".to_owned());
        }
    }
    run
}
