//! Verification: reruns the scenario of a recording and compares the result with the file.
//!
//! Identical bytes verify everything. Otherwise [`verify`] compares messages and reports the first difference. A
//! repacked file (other chunks, compression or order) has the same messages, records and channels, also for readers
//! that use its index. A file of another version is verified by its values: its words may differ from those of this
//! version, and are compared with those of its release.

mod bytes;
mod container;
mod difference;
mod error;
mod fingerprint;
mod index;
mod messages;
mod readings;
mod releases;
mod rerun;
mod scope;
mod words;

use crate::archive::format::{FORMER_WORDS, TELEMETRY, VERSION};
use crate::archive::recording::{Condition, Loss, Recording, RecordingError, Relogged};
pub use crate::archive::supplements::Supplementary;
use crate::archive::writer::{Form, Header};
use crate::run::scenario::Scenario;
use crate::telemetry::{RunMessages, Topic, Topics, table};
pub use difference::Difference;
pub use error::VerifyError;
use messages::RerunComparison;
pub use releases::release_entry;
use releases::{KnownRelease, RELEASES};
use rerun::Rerun;
use schemars::JsonSchema;
use scope::Scope;
use serde::Serialize;

/// The result of a verification.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The file holds what its scenario gives.
    Verified,
    /// All readable messages match, but parts of the run are missing or can't be compared.
    Incomplete,
    /// The file differs from a new run.
    Different,
}

/// Equality of the content of a verified recording and that of a new run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Equality {
    /// All bytes are equal.
    ByteIdentical,
    /// All content is equal; chunks, compression or order differ.
    PackedOtherwise,
    /// Another version made the recording: all its values are equal. Channels for viewers are not compared.
    SameValues,
}

/// Check of the schemas of a recording of another version.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SchemaCheck {
    /// They are compared with those of the release that made the recording.
    Released,
    /// This version doesn't know the schemas of the one that made the recording: names and encodings are compared, units
    /// and descriptions are not.
    Unknown,
}

/// The result of comparing a recording with its scenario, run again.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Report {
    /// The result as a whole.
    pub verdict: Verdict,
    /// The kind of equality; absent unless verified.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub equality: Option<Equality>,
    /// The kind of file.
    pub state: Condition,
    /// The first difference; absent if there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub difference: Option<Difference>,
    /// Number of equal messages; absent if the files are byte-identical.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub equal: Option<u64>,
    /// Number of missing messages; for an interrupted run, only gaps. 0 if there is a difference, after which nothing is
    /// compared.
    pub missing: u64,
    /// How the log times differ from the time stamps of the messages; absent if they are equal. Messages are compared by
    /// their stamps then, and those for viewers as a whole; sequence numbers are not compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub relogged: Option<Relogged>,
    /// Parts that can't be read, at most 1000.
    pub losses: Vec<Loss>,
    /// Number of further parts that can't be read; absent if all are listed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub more_losses: Option<u64>,
    /// Topics that were not recorded.
    pub without: Vec<String>,
    /// Recorded fields and topics that this version doesn't know, so that they are not compared.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub unknown: Vec<String>,
    /// Channels, attachments and metadata records in addition to the run, e.g. its licence or the data of a fit. Their
    /// content is not verified.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub supplements: Vec<Supplementary>,
    /// Metadata records and attachments that are repeated in equal form, by their names.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub repeated: Vec<String>,
    /// The version of toprise that recorded it, if different from this one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recorded_by: Option<String>,
    /// The check of its schemas; absent if this version recorded it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub schemas: Option<SchemaCheck>,
}

/// Runs the scenario of a recording again and compares. `progress` is called with the number of further bytes compared
/// (in total at most twice the file size).
///
/// # Errors
/// [`VerifyError`] if there is nothing to compare, or the comparison takes too much memory.
pub fn verify(recording: &Recording, progress: &dyn Fn(u64)) -> Result<Report, VerifyError> {
    verify_with(recording, RELEASES, progress)
}

/// Verifies with a table of released schemas.
fn verify_with(
    recording: &Recording,
    releases: &str,
    progress: &dyn Fn(u64),
) -> Result<Report, VerifyError> {
    let mut report = Report {
        verdict: Verdict::Different,
        equality: None,
        state: recording.condition(),
        difference: None,
        equal: None,
        missing: 0,
        relogged: recording.relogged(),
        losses: recording.losses().to_vec(),
        more_losses: recording.layout.losses.unlisted(),
        without: Vec::new(),
        unknown: Vec::new(),
        supplements: Vec::new(),
        repeated: Vec::new(),
        recorded_by: other_version(recording),
        schemas: None,
    };
    let (scenario, form, topics) = match rerun_inputs(recording) {
        Ok(found) => found,
        Err(Unrunnable::NoScenario) => return Err(VerifyError::NoScenario),
        Err(Unrunnable::Damaged) => {
            // The damage is one of the losses, and nothing can be compared.
            report.verdict = Verdict::Incomplete;
            report.equal = Some(0);
            return Ok(report);
        }
        Err(Unrunnable::Different(difference)) => {
            report.difference = Some(difference);
            return Ok(report);
        }
    };
    report.without = Topic::all_with(scenario.model.support)
        .filter(|topic| !topics.include(topic) || !recording.has(*topic))
        .map(|topic| topic.to_string())
        .collect();
    // Two runs: bytes are compared first, and the messages of another one only if they differ.
    let started = RunMessages::new(&scenario, &topics)
        .and_then(|first| Ok([first, RunMessages::new(&scenario, &topics)?]));
    let [first, second] = match started {
        Ok(runs) => runs,
        Err(reason) => {
            let values = [None, Some(reason.to_string())];
            report.difference = Some(Difference::new("the run", "", values));
            return Ok(report);
        }
    };
    let header = Header::new(&scenario, first.telemetry(), form);
    // The bytes of an interrupted file end before those of the run.
    if report.state == Condition::Whole
        && bytes::are_equal(recording, first, &header, progress) == Some(true)
    {
        report.verdict = Verdict::Verified;
        report.equality = Some(Equality::ByteIdentical);
        return Ok(report);
    }
    let rerun = Rerun::new(second, &header);
    compare(recording, rerun, releases, &mut report, progress)?;
    Ok(report)
}

/// Compares the messages and the rest of the content with a new run.
fn compare(
    recording: &Recording,
    rerun: Rerun<'_>,
    releases: &str,
    report: &mut Report,
    progress: &dyn Fn(u64),
) -> Result<(), VerifyError> {
    let scope = match report.recorded_by {
        Some(_) => Scope::Values,
        None => Scope::Bytes,
    };
    let header = rerun.header;
    let (compared, end) = RerunComparison::new(recording, rerun, scope).run(progress);
    report.losses = compared.losses.list().to_vec();
    report.more_losses = compared.losses.unlisted();
    // Damage inside of chunks is only found on reading.
    let is_damaged = compared
        .losses
        .list()
        .iter()
        .any(|loss| !recording.is_tail(loss));
    if is_damaged {
        report.state = Condition::Damaged;
    }
    if report.state == Condition::Whole && compared.missing > 0 {
        report.state = Condition::Altered;
    }
    let is_part = report.state != Condition::Whole;
    let is_exact = scope == Scope::Bytes && !is_part && report.relogged.is_none();
    report.difference = compared
        .difference
        .or_else(|| container::difference(recording, header, &end, is_part, scope))
        .or(compared.out_of_order.filter(|_| is_exact));
    if scope == Scope::Values {
        let (check, difference) = check_schemas(recording, releases);
        report.schemas = Some(check);
        report.difference = report.difference.take().or(difference);
    }
    // All ways of reading must agree, unless the file is damaged.
    let is_readable = report.losses.is_empty() && recording.layout.is_ended;
    if report.difference.is_none() && is_readable {
        report.difference = readings::difference(recording)?;
    }
    report.unknown = unknown_fields(recording);
    report.supplements = recording.supplements();
    report.repeated = container::repeated(recording);
    report.verdict = if report.difference.is_some() {
        Verdict::Different
    } else if is_part || !report.unknown.is_empty() {
        Verdict::Incomplete
    } else {
        report.equality = Some(match scope {
            Scope::Bytes => Equality::PackedOtherwise,
            Scope::Values => Equality::SameValues,
        });
        Verdict::Verified
    };
    report.equal = Some(compared.equal);
    report.missing = compared.missing;
    Ok(())
}

/// Compares the words of a recording of another version with those of its release.
fn check_schemas(recording: &Recording, releases: &str) -> (SchemaCheck, Option<Difference>) {
    match recording
        .run()
        .and_then(|run| KnownRelease::find(releases, run))
    {
        Some(release) => (SchemaCheck::Released, release.difference(recording)),
        None => (SchemaCheck::Unknown, None),
    }
}

/// The fields and topics of a recording that this version doesn't know, except words that earlier versions recorded.
fn unknown_fields(recording: &Recording) -> Vec<String> {
    let mut unknown = Vec::new();
    for (topic, fields) in recording.differences() {
        for field in fields.unknown {
            let is_former_word = FORMER_WORDS
                .iter()
                .any(|(former, word)| former.name() == topic && *word == field);
            if !is_former_word {
                unknown.push(format!("{topic}: {field}"));
            }
        }
    }
    unknown
}

/// The reason why a recording can't be run again.
enum Unrunnable {
    NoScenario,
    /// The scenario is damaged.
    Damaged,
    Different(Difference),
}

/// The scenario of a recording and how it was recorded.
fn rerun_inputs(recording: &Recording) -> Result<(Scenario, Form, Topics), Unrunnable> {
    let scenario = recording.scenario().map_err(|reason| match reason {
        RecordingError::NoScenario => Unrunnable::NoScenario,
        RecordingError::DamagedScenario => Unrunnable::Damaged,
        reason => {
            let values = [reason.to_string(), "a scenario to run again".to_owned()];
            Unrunnable::Different(Difference::new("scenario.toml", "", values.map(Some)))
        }
    })?;
    let (form, topics) = recording.form().ok_or_else(|| {
        let expected = Some("encoding and topics".to_owned());
        Unrunnable::Different(Difference::new("toprise.run", "", [None, expected]))
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
