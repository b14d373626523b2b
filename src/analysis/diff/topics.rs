//! Which topics two runs have in common.

use super::error::DiffError;
use super::tolerance::Tolerances;
use crate::analysis::subject::Subject;
use crate::archive::recording::FileChannel;
use crate::telemetry::views::view_channels;
use std::collections::BTreeSet;

/// Errors name no more topics or losses than this.
const NAMED: usize = 20;

/// The topics of two runs.
#[derive(Debug)]
pub(super) struct ComparedTopics {
    /// Topics that are compared: both runs have them, and they were asked for.
    pub(super) compared: Vec<String>,
    /// Topics of both recordings of toprise that the telemetry table doesn't have: their bytes are compared.
    pub(super) others: Vec<String>,
    /// Topics that only A and only B has, but for those that are derived for viewers.
    pub(super) alone: [Vec<String>; 2],
    /// Topics that would be compared, but are ignored.
    pub(super) ignored: Vec<String>,
}

impl ComparedTopics {
    /// Chooses the topics to compare: those that are `wanted`, or all if none are. What only one of the runs
    /// has counts only where everything is compared.
    pub(super) fn new(
        runs: [Subject<'_>; 2],
        are_ours: bool,
        wanted: &[String],
        tolerances: &Tolerances,
    ) -> Result<Self, DiffError> {
        let mut ignored = Vec::new();
        let counting = |topics: Vec<String>, ignored: &mut Vec<String>| -> Vec<String> {
            let (away, counting) = topics
                .into_iter()
                .partition(|topic| tolerances.ignores(topic));
            ignored.extend::<Vec<String>>(away);
            counting
        };
        let [in_a, in_b] = runs.map(|run| counting(comparable(run, are_ours), &mut ignored));
        let mut compared = in_both(&in_a, &in_b);
        let are_empty = in_a.is_empty() && in_b.is_empty() && ignored.is_empty();
        if compared.is_empty() && !are_empty {
            let [a, b] = [in_a, in_b].map(|topics| some_of(&topics));
            return Err(DiffError::NoCommonTopics { a, b });
        }
        if wanted.is_empty() {
            let [more_a, more_b] = runs.map(|run| counting(others(run, are_ours), &mut ignored));
            let others = in_both(&more_a, &more_b);
            let alone = |topics: Vec<String>, more: Vec<String>| {
                let more = more.into_iter().filter(|topic| !is_view(topic));
                topics.into_iter().chain(more).collect::<Vec<_>>()
            };
            let (in_a, in_b) = (alone(in_a, more_a), alone(in_b, more_b));
            return Ok(Self {
                compared,
                others,
                alone: [only_in(&in_a, &in_b), only_in(&in_b, &in_a)],
                ignored,
            });
        }
        if let Some(topic) = wanted.iter().find(|topic| !compared.contains(topic)) {
            return Err(DiffError::UnknownTopic {
                topic: topic.clone(),
                common: some_of(&compared),
            });
        }
        compared.retain(|topic| wanted.contains(topic));
        Ok(Self {
            compared,
            others: Vec::new(),
            alone: [Vec::new(), Vec::new()],
            ignored,
        })
    }
}

/// A list for an error.
pub(super) fn some_of(list: &[String]) -> String {
    match list {
        [] => "none".to_owned(),
        all if all.len() <= NAMED => all.join(", "),
        all => format!("{} and {} more", all[..NAMED].join(", "), all.len() - NAMED),
    }
}

/// The topics of a run that can be compared: those of the table in recordings of toprise, else all.
fn comparable(run: Subject<'_>, are_ours: bool) -> Vec<String> {
    match run {
        Subject::Recording(recording) if !are_ours => {
            let mut seen = BTreeSet::new();
            let topics = recording.channels().iter().map(|channel| &channel.topic);
            topics
                .filter(|topic| seen.insert(*topic))
                .cloned()
                .collect()
        }
        run => run.topics().iter().map(ToString::to_string).collect(),
    }
}

/// The topics of a recording of toprise that are not of the table.
fn others(run: Subject<'_>, are_ours: bool) -> Vec<String> {
    let Subject::Recording(recording) = run else {
        return Vec::new();
    };
    let is_other = |channel: &&FileChannel| are_ours && channel.table.is_none();
    let others = recording.channels().iter().filter(is_other);
    let others: BTreeSet<String> = others.map(|channel| channel.topic.clone()).collect();
    others.into_iter().collect()
}

/// Whether the messages of a topic of toprise are derived from others, for viewers.
pub(super) fn is_view(topic: &str) -> bool {
    view_channels().iter().any(|view| view.topic == topic)
}

fn in_both(a: &[String], b: &[String]) -> Vec<String> {
    filtered(a, b, true)
}

fn only_in(a: &[String], b: &[String]) -> Vec<String> {
    filtered(a, b, false)
}

/// The topics of A that B has, or that it hasn't.
fn filtered(a: &[String], b: &[String], is_in_b: bool) -> Vec<String> {
    let b: BTreeSet<&String> = b.iter().collect();
    let kept = a.iter().filter(|topic| b.contains(topic) == is_in_b);
    kept.cloned().collect()
}
