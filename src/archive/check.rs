//! Checks of recordings and how they end.

use schemars::JsonSchema;
use serde::Serialize;

/// How a check ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// All is as it must be.
    Passed,
    /// All that is there is as it must be; some channels were not recorded.
    Partial,
    /// All that is there is as it must be, but something isn't there.
    Incomplete,
    /// Something is wrong.
    Failed,
    /// The check could not be made, or was not asked for.
    Skipped,
}

impl Verdict {
    /// In a word.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Passed => "passed",
            Self::Partial => "partial",
            Self::Incomplete => "incomplete",
            Self::Failed => "failed",
            Self::Skipped => "skipped",
        }
    }
}

/// A group of checks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
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
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
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
    pub(crate) fn new(group: Group, name: &'static str, verdict: Verdict, finding: String) -> Self {
        Self {
            group,
            name,
            verdict,
            finding,
        }
    }

    /// Passed, unless there are problems.
    pub(crate) fn of(
        group: Group,
        name: &'static str,
        problems: &Problems,
        finding: String,
    ) -> Self {
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
pub(crate) struct Problems {
    pub(crate) first: Option<String>,
    pub(crate) count: u64,
}

impl Problems {
    pub(crate) fn add(&mut self, problem: impl FnOnce() -> String) {
        self.count += 1;
        if self.first.is_none() {
            self.first = Some(problem());
        }
    }

    pub(crate) fn unless(&mut self, is_right: bool, problem: impl FnOnce() -> String) {
        if !is_right {
            self.add(problem);
        }
    }
}
