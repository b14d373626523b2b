//! How a comparison ended.

use super::plan::ComparisonPlan;
use super::reading::Findings;
use super::setup::SetupDifferences;
use super::time_map::TimeMap;
use super::topic::{ChannelDifference, ComparedTopic};
use schemars::JsonSchema;
use serde::Serialize;

/// How a comparison ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Both say the same in the same messages, to the last bit, and so do the files beside their messages.
    Identical,
    /// All values are the same, to the last bit, but something differs beside them: the encoding, attachments, metadata.
    SameValues,
    /// Both have the same messages, which agree within the tolerances.
    Equal,
    /// What was compared agrees within the tolerances, but not every message was compared with one of the other run: parts
    /// of a run can't be read, or one was interpolated, or has messages between those of the other.
    Agreeing,
    /// Something differs.
    Different,
}

impl Verdict {
    /// Whether all values are the same, to the last bit.
    #[must_use]
    pub fn has_same_values(self) -> bool {
        matches!(self, Self::Identical | Self::SameValues)
    }

    /// Whether both have the same messages, within the tolerances.
    #[must_use]
    pub fn has_same_messages(self) -> bool {
        self.has_same_values() || self == Self::Equal
    }

    /// Judges what was found in the values: identical if they all are the same. Where a run is cut off, what the other has more of is no difference.
    pub(super) fn of(
        plan: &ComparisonPlan,
        findings: &Findings,
        channels: &[ChannelDifference],
        setup: &SetupDifferences,
        is_cut: [bool; 2],
    ) -> Self {
        if plan.is_same {
            return Self::Identical;
        }
        let is_mapped = plan.map != TimeMap::Same;
        // At other times than A's, the ends of the runs mean nothing.
        let has_same_messages = is_mapped || !channels.iter().any(|c| has_more(c, is_cut));
        let agrees = || findings.compared().all(|topic| topic.tally.is_equal());
        if !has_same_names(setup, is_cut) || !has_same_messages || !agrees() {
            return Self::Different;
        }
        let is_passed_over = |channel: &ChannelDifference| {
            channel.between_in_a > 0 || channel.between_in_b > 0 || {
                // Beyond the damage of the other run.
                channel.only_in_a + channel.only_in_b + channel.beyond_in_a + channel.beyond_in_b
                    > 0
            }
        };
        let is_whole = is_cut == [false; 2]
            && !is_mapped
            && !findings
                .compared()
                .any(|topic| topic.lane.rule.is_interpolated())
            && !channels.iter().any(is_passed_over);
        let is_identical = |topic: &ComparedTopic| {
            topic.lane.rule.is_exact() && topic.tally.identical == topic.tally.pairs
        };
        if !is_whole {
            Self::Agreeing
        } else if !plan.clock.is_shifted()
            && !plan.has_ignored
            && findings.compared().all(is_identical)
        {
            Self::Identical
        } else {
            Self::Equal
        }
    }
}

/// Whether both have the same topics and fields.
fn has_same_names(setup: &SetupDifferences, [is_a_cut, is_b_cut]: [bool; 2]) -> bool {
    let in_a = [&setup.topics_only_in_a, &setup.fields_only_in_a];
    let in_b = [&setup.topics_only_in_b, &setup.fields_only_in_b];
    let are_empty = |lists: [&Vec<String>; 2]| lists.iter().all(|list| list.is_empty());
    (is_b_cut || are_empty(in_a)) && (is_a_cut || are_empty(in_b))
}

/// Whether one has messages that the other hasn't.
fn has_more(channel: &ChannelDifference, [is_a_cut, is_b_cut]: [bool; 2]) -> bool {
    let in_a = channel.only_in_a + channel.beyond_in_a;
    let in_b = channel.only_in_b + channel.beyond_in_b;
    (in_a > 0 && !is_b_cut) || (in_b > 0 && !is_a_cut)
}
