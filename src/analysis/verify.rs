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
        checks.extend(origin::check(recording, &scenario));
        let scenario = scenario.ok();
        let scenario = scenario.as_ref();
        checks.extend(content::check(recording, scenario, options, progress));
        without = origin::without(recording, scenario);
        not_covered = origin::not_covered(recording, scenario);
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
        without,
        not_covered,
    }
}
