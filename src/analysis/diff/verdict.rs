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
    /// Every message is the same, to the last bit.
    Identical,
    /// All numbers agree within the tolerances.
    Equal,
    /// Something differs.
    Different,
}

impl Verdict {
    /// Judges what was found. Where a run is cut off, what the other has more of is no difference.
    pub(super) fn of(
        plan: &ComparisonPlan,
        findings: &Findings,
        channels: &[ChannelDifference],
        setup: &SetupDifferences,
        is_cut: [bool; 2],
    ) -> Self {
        let is_mapped = plan.map != TimeMap::Same;
        // At other times than A's, the ends of the runs mean nothing.
        let has_same_messages = is_mapped || !channels.iter().any(|c| has_more(c, is_cut));
        let has_same_disorder =
            || is_mapped || findings.compared().all(|c| c.lane.has_same_out_of_order());
        if !has_same_names(setup, is_cut) || !has_same_messages || !has_same_disorder() {
            return Self::Different;
        }
        let is_everything = plan.are_ours && plan.uncompared.is_empty() && !is_mapped;
        let is_identical = |topic: &ComparedTopic| {
            topic.lane.rule.is_one_to_one() && topic.tally.identical == topic.tally.pairs
        };
        if is_everything && findings.compared().all(is_identical) {
            return Self::Identical;
        }
        if findings.compared().all(|topic| topic.tally.is_equal()) {
            Self::Equal
        } else {
            Self::Different
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
