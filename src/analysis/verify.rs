//! Verification: reruns the scenario of a recording and compares the result with the file.
//!
//! Identical bytes verify everything. Otherwise [`verify`] compares messages and reports the first difference. A
//! repacked file (other chunks or compression) has the same messages, records and channels.

mod again;
mod bytes;
mod container;
mod difference;
mod index;
mod messages;

use crate::archive::format::{TELEMETRY, VERSION};
use crate::archive::recording::{Condition, Recording};
use crate::archive::writer::Form;
use crate::run::scenario::Scenario;
use crate::telemetry::{Telemetry, Topic, Topics, table};
use again::Again;
pub use difference::Difference;
use messages::Comparison;
use schemars::JsonSchema;
use serde::Serialize;

/// The result of a verification.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The file is byte-identical to a new run.
    Verified,
    /// The content is identical, but chunks or compression differ.
    PackedOtherwise,
    /// Recorded by another version; all common values match.
    OtherVersion,
    /// All readable messages match, but parts of the run are missing.
    Incomplete,
    /// The file differs from a new run.
    Different,
}

/// The result of comparing a recording with its scenario, run again.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Report {
    /// The result as a whole.
    pub verdict: Verdict,
    /// The kind of file.
    pub state: Condition,
    /// The first difference; absent if there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub difference: Option<Difference>,
    /// Number of equal messages; absent if the files are byte-identical.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub equal: Option<u64>,
    /// Number of missing messages; for an interrupted run, only gaps.
    pub missing: u64,
    /// Topics that were not recorded.
    pub without: Vec<String>,
    /// The version of toprise that recorded it, if different from this one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recorded_by: Option<String>,
}

/// Runs the scenario of a recording again and compares. `progress` is called with the number of further bytes compared
/// (in total at most twice the file size).
pub fn verify(recording: &Recording, progress: &dyn Fn(u64)) -> Report {
    let mut report = Report {
        verdict: Verdict::Different,
        state: recording.condition(),
        difference: None,
        equal: None,
        missing: 0,
        without: Vec::new(),
        recorded_by: other_version(recording),
    };
    let (scenario, form, topics) = match what_to_run(recording) {
        Ok(found) => found,
        Err(difference) => {
            report.difference = Some(difference);
            return report;
        }
    };
    let telemetry = || Telemetry::with_topics(&topics);
    let left_out = Topic::all_with(scenario.model.support).filter(|t| !topics.include(t));
    report.without = left_out.map(|topic| topic.to_string()).collect();
    // Skip the byte comparison for interrupted files.
    if report.state == Condition::Whole
        && !recording.is_interrupted()
        && bytes::are_equal(recording, &scenario, telemetry(), form, progress) == Some(true)
    {
        report.verdict = Verdict::Verified;
        return report;
    }
    match Again::start(&scenario, telemetry(), form) {
        Ok(again) => compare(recording, again, &mut report, progress),
        Err(reason) => {
            report.difference = Some(Difference::of("the run", "", [None, Some(reason)]));
        }
    }
    report
}

/// Compares the messages and the rest of the content with a new run.
fn compare(recording: &Recording, again: Again, report: &mut Report, progress: &dyn Fn(u64)) {
    let is_by_value = report.recorded_by.is_some();
    let (compared, opening, end) = Comparison::new(recording, again, is_by_value).run(progress);
    let is_whole = report.state == Condition::Whole && compared.losses == 0;
    let is_part = !is_whole || recording.is_interrupted() || compared.missing > 0;
    let of_container = || container::difference(recording, &opening, &end, is_part, is_by_value);
    let is_exact = !is_by_value && !is_part;
    report.difference = compared
        .difference
        .or_else(of_container)
        .or(compared.out_of_order.filter(|_| is_exact));
    // Data and index must agree, unless the file is damaged.
    let has_index =
        report.state != Condition::Damaged && compared.losses == 0 && recording.layout.is_ended;
    if report.difference.is_none() && has_index {
        report.difference = index::index_difference(recording);
    }
    report.verdict = match (&report.difference, &report.recorded_by) {
        (Some(_), _) => Verdict::Different,
        (None, _) if is_part => Verdict::Incomplete,
        (None, Some(_)) => Verdict::OtherVersion,
        (None, None) => Verdict::PackedOtherwise,
    };
    if report.state == Condition::Whole && compared.losses > 0 {
        report.state = Condition::Damaged;
    }
    report.equal = Some(compared.equal);
    report.missing = compared.missing;
}

/// The scenario of a recording and how it was recorded, or what is missing.
fn what_to_run(recording: &Recording) -> Result<(Scenario, Form, Topics), Difference> {
    let scenario = recording.scenario().map_err(|reason| {
        let values = [reason.to_string(), "a scenario to run again".to_owned()];
        Difference::of("scenario.toml", "", values.map(Some))
    })?;
    let (form, topics) = recording.form().ok_or_else(|| {
        let expected = Some("encoding and topics".to_owned());
        Difference::of("toprise.run", "", [None, expected])
    })?;
    Ok((scenario, form, topics))
}

/// The version of toprise or of its telemetry that made a recording, if it is not this one.
fn other_version(recording: &Recording) -> Option<String> {
    let run = recording.run()?;
    let version = run.get(VERSION)?;
    let telemetry = run.get(TELEMETRY).map_or("1", String::as_str);
    let is_this = version == env!("CARGO_PKG_VERSION") && telemetry == table::VERSION.to_string();
    (!is_this).then(|| format!("{version} (telemetry {telemetry})"))
}
