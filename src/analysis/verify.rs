//! Whether a recording can be trusted: its container, its messages, its physics, and whether the
//! simulation gives it again, bit for bit.
//!
//! [`verify`] reads a recording twice, once as a container and once message by message, in bounded
//! memory. The second time the scenario that is attached is simulated alongside.

mod content;
mod origin;
mod physics;
mod reproduction;

pub use crate::archive::check::{Check, Group, Verdict};
pub use content::Options;

use crate::archive::container_check;
use crate::archive::recording::{Condition, Recording};

/// What was found out about a recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// What kind of file it is.
    pub condition: Condition,
    /// All checks, in order.
    pub checks: Vec<Check>,
    /// The version of the telemetry that it holds; none if it isn't known.
    pub telemetry: Option<u32>,
    /// The topics of toprise that it doesn't have.
    pub without: Vec<String>,
    /// What a reader of the file sees and no check covers: words, and what others have added.
    pub not_covered: Vec<String>,
}

impl Report {
    /// How it ended as a whole: the worst of all checks.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        let has = |verdict| self.checks.iter().any(|check| check.verdict == verdict);
        if has(Verdict::Failed) {
            Verdict::Failed
        } else if has(Verdict::Incomplete) {
            Verdict::Incomplete
        } else if has(Verdict::Partial) {
            Verdict::Partial
        } else {
            Verdict::Passed
        }
    }
}

/// Checks a recording. `progress` is told how many more bytes of the file have been looked at; in the end
/// they are twice the file's.
#[must_use]
pub fn verify(recording: &Recording, options: Options, progress: &dyn Fn(u64)) -> Report {
    let mut checks = container_check::check(recording, progress);
    let (mut without, mut not_covered) = (Vec::new(), Vec::new());
    let mut telemetry = None;
    if recording.condition() == Condition::Foreign {
        let finding = format!(
            "written by {:?}, not by toprise: its messages can't be judged (`toprise info` lists them)",
            recording.library()
        );
        checks.push(Check::new(
            Group::Telemetry,
            "messages",
            Verdict::Failed,
            finding,
        ));
    } else {
        let scenario = recording.scenario();
        let Some(version) = recording.version() else {
            return unknown(recording, checks);
        };
        checks.extend(origin::check(recording, &scenario, &version));
        let scenario = scenario.ok();
        let scenario = scenario.as_ref();
        checks.extend(content::check(
            recording, scenario, &version, options, progress,
        ));
        telemetry = Some(version.number());
        without = origin::without(recording, scenario);
        not_covered = origin::not_covered(recording, scenario, &version);
    }
    let is_damaged = checks
        .iter()
        .any(|check| check.group == Group::Container && check.verdict == Verdict::Failed);
    Report {
        condition: match recording.condition() {
            Condition::Foreign => Condition::Foreign,
            _ if is_damaged => Condition::Damaged,
            condition => condition,
        },
        checks,
        telemetry,
        without,
        not_covered,
    }
}

/// What can be said of a recording whose telemetry this program doesn't know.
fn unknown(recording: &Recording, mut checks: Vec<Check>) -> Report {
    let finding = match recording.refuse_newer() {
        Err(newer) => newer.to_string(),
        Ok(()) => "toprise.run names no version of the telemetry".to_owned(),
    };
    let check = Check::new(Group::Telemetry, "version", Verdict::Failed, finding);
    checks.push(check);
    Report {
        condition: recording.condition(),
        checks,
        telemetry: None,
        without: Vec::new(),
        not_covered: Vec::new(),
    }
}
