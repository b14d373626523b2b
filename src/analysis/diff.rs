//! What differs between two runs, and why: in the set-up, in what happened, in the averaged motion, and point
//! by point.
//!
//! [`compare`] reads two runs side by side, once, in memory that doesn't grow with the number of samples. Two
//! nearly equal models part in the phase of their nutation, after which the difference at equal times says
//! nothing about the models; therefore the [`Report`] separates drift, phase and amplitude, compares the models
//! along one and the same motion, and tells the integrators' own errors beside the differences.
//!
//! Any two MCAP files can be compared: of files that toprise did not write, all messages of common topics, field by field
//! where they can be decoded and byte by byte where not.
//!
//! The files of this folder stand in the order of a comparison: `plan` decides what is compared with what, `reading`
//! pairs the messages, each section of the report has a file with its numbers and what computes them, and `report`
//! puts them together.
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

// What to compare, and what with what.
mod clock;
mod error;
mod observer;
mod options;
mod plan;
mod rule;
mod time_map;
mod times;
mod tolerance;
mod topics;
// Reading and pairing.
mod interpolation;
mod item;
mod lane;
mod reading;
mod stream;
// The sections of the report, with what computes them.
mod averages;
mod budget;
mod derived;
mod discrepancy;
mod divergence;
mod events;
mod field;
mod floor;
mod growth;
mod happened;
mod moments;
mod nutation;
mod parting;
mod passage;
mod setup;
mod signals;
mod topic;
mod touch;
// The report and what is made from it.
mod beside;
mod difference_file;
mod matrix;
mod report;
mod summary;
mod tale;
mod told_average;
mod told_motion;
mod told_peg;
mod verdict;

pub use self::averages::{Averaged, Deviation, EitherWay};
pub use self::budget::Budget;
pub use self::clock::ClockReport;
pub use self::difference_file::{DIFF_RECORD, DifferenceFile};
pub use self::discrepancy::{Discrepancy, Residual};
pub use self::divergence::{Divergence, FieldContext, PairContext};
pub use self::error::DiffError;
pub use self::events::{EventKindDifference, EventMoment, EventPair};
pub use self::field::FieldDifference;
pub use self::floor::{Floor, IntegratorError};
pub use self::growth::{Growth, GrowthLaw};
pub use self::happened::Happened;
pub use self::matrix::{Matrix, MatrixRow};
pub use self::observer::Observer;
pub use self::options::{Align, Offset, Options};
pub use self::parting::{Parting, QuantityKind};
pub use self::report::{ComparedRun, Report};
pub use self::setup::{KeyDifference, SetupDifferences};
pub use self::signals::Signals;
pub use self::times::MessageTimes;
pub use self::tolerance::{Tolerance, Tolerances, full_name};
pub use self::topic::{BytesDifference, ChannelDifference, TextDifference};
pub use self::verdict::Verdict;
pub use crate::analysis::course::{CourseReport, PegReport};
pub use crate::analysis::subject::Subject;

use self::field::seconds;
use self::plan::ComparisonPlan;
use self::reading::read_both;

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
    let runs = [a.into(), b.into()];
    let plan = ComparisonPlan::new(runs, options)?;
    let findings = read_both(runs, &plan, &options.tolerances, observer)?;
    let floor = match findings.common_end() {
        Some(end) if options.floor && plan.are_ours => {
            floor::compute(runs, seconds(end), &observer.carry_on())
        }
        _ => None,
    };
    let mut report = Report::new(runs, &plan, &findings, floor);
    report.summary = report.sentences(["A", "B"]);
    Ok(report)
}
