//! Whether a recording can be trusted: its container, its messages, its physics, and whether the
//! simulation gives it again, bit for bit.
//!
//! [`verify`] reads a recording twice, once as a container and once message by message, in bounded
//! memory. The second time the scenario that is attached is simulated alongside.

mod container;
mod content;
mod physics;
mod reproduction;

use crate::recording::{Condition, Recording};
use serde_json::{Value, json};

/// What to check.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Whether to simulate the scenario again, which takes longest.
    pub reproduce: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { reproduce: true }
    }
}

/// How a check ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// All is as it must be.
    Passed,
    /// All that is there is as it must be, but something isn't there.
    Incomplete,
    /// Something is wrong.
    Failed,
    /// It could not be checked or was not asked for.
    Skipped,
}

impl Verdict {
    /// In a word.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Passed => "passed",
            Self::Incomplete => "incomplete",
            Self::Failed => "failed",
            Self::Skipped => "skipped",
        }
    }
}

/// A group of checks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// The file as an MCAP file.
    Container,
    /// The messages by themselves.
    Telemetry,
    /// What they say about the motion.
    Physics,
    /// Whether the simulation gives them again.
    Reproduction,
}

impl Group {
    /// In a word.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Container => "container",
            Self::Telemetry => "telemetry",
            Self::Physics => "physics",
            Self::Reproduction => "reproduction",
        }
    }
}

/// One check and how it ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// What it belongs to.
    pub group: Group,
    /// What was checked, in a few words.
    pub name: &'static str,
    /// How it ended.
    pub verdict: Verdict,
    /// What was found, in a sentence.
    pub finding: String,
}

impl Check {
    fn new(group: Group, name: &'static str, verdict: Verdict, finding: String) -> Self {
        Self {
            group,
            name,
            verdict,
            finding,
        }
    }

    /// Passed, unless there are problems.
    fn of(group: Group, name: &'static str, problems: &Problems, finding: String) -> Self {
        match &problems.first {
            None => Self::new(group, name, Verdict::Passed, finding),
            Some(first) if problems.count == 1 => {
                Self::new(group, name, Verdict::Failed, first.clone())
            }
            Some(first) => {
                let finding = format!("{first} (the first of {} problems)", problems.count);
                Self::new(group, name, Verdict::Failed, finding)
            }
        }
    }
}

/// Problems of one kind: the first, and how many there are.
#[derive(Clone, Debug, Default)]
struct Problems {
    first: Option<String>,
    count: u64,
}

impl Problems {
    fn add(&mut self, problem: impl FnOnce() -> String) {
        self.count += 1;
        if self.first.is_none() {
            self.first = Some(problem());
        }
    }

    fn unless(&mut self, is_right: bool, problem: impl FnOnce() -> String) {
        if !is_right {
            self.add(problem);
        }
    }
}

/// What was found out about a recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// What kind of file it is.
    pub condition: Condition,
    /// All checks, in order.
    pub checks: Vec<Check>,
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
        } else {
            Verdict::Passed
        }
    }

    /// For programs.
    #[must_use]
    pub fn json(&self) -> Value {
        let check = |check: &Check| {
            json!({
                "group": check.group.name(),
                "name": check.name,
                "verdict": check.verdict.name(),
                "finding": check.finding,
            })
        };
        json!({
            "state": self.condition.name(),
            "verdict": self.verdict().name(),
            "checks": self.checks.iter().map(check).collect::<Vec<_>>(),
        })
    }
}

/// Whether nothing is wrong with a recording as an MCAP file.
pub(crate) fn is_sound_container(recording: &Recording) -> bool {
    let checks = container::check(recording, &|_| {});
    checks.iter().all(|check| check.verdict != Verdict::Failed)
}

/// Checks a recording. `progress` is told how many more bytes of the file have been looked at; in the end
/// they are twice the file's.
#[must_use]
pub fn verify(recording: &Recording, options: Options, progress: &dyn Fn(u64)) -> Report {
    let mut checks = container::check(recording, progress);
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
        checks.extend(content::check(recording, options, progress));
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
    }
}
