//! What is compared with what, decided before the runs are read.

use super::error::DiffError;
use super::interpolation::Method;
use super::options::{Align, Options};
use super::rule::{Interpolation, Rule};
use super::time_map::TimeMap;
use super::times::Times;
use super::topics::Topics;
use crate::analysis::subject::Subject;
use crate::archive::format::SAMPLE_PERIOD;
use crate::telemetry::Topic;
use crate::telemetry::fields::{EVENTS, NUTATION};

/// The topics that tell what happened and how the motion was on average: small ones.
const STORY: [Topic; 2] = [NUTATION, EVENTS];

/// What is compared with what.
#[derive(Debug)]
pub(super) struct ComparisonPlan {
    /// Whether both runs are toprise's: then topics are those of the telemetry table, and all of a message counts.
    /// Files of others: their numbers are compared.
    pub(super) are_ours: bool,
    /// The topics, by the numbers that messages have as channels.
    pub(super) topics: Vec<String>,
    /// How to pair the messages of each topic; none for topics that are not compared.
    pub(super) rules: Vec<Option<Rule>>,
    /// Which time of B belongs to which of A.
    pub(super) map: TimeMap,
    /// What is compared with what, in a sentence.
    pub(super) alignment: String,
    /// The topics to read: those that are compared, and of toprise's runs those that tell their story.
    pub(super) read: Vec<String>,
    /// By how much the times of A's and B's messages go backward at most in the order of the file, ns. Messages
    /// of toprise's runs that go backward are out of order.
    pub(super) disorder: [u64; 2],
    /// Topics of both that can't be compared.
    pub(super) uncompared: Vec<String>,
    /// Topics that only A and only B has, but for those that are derived for viewers.
    pub(super) alone: [Vec<String>; 2],
}

impl ComparisonPlan {
    /// Decides how to compare two runs.
    pub(super) fn new(runs: [Subject<'_>; 2], options: &Options) -> Result<Self, DiffError> {
        let are_ours = runs.iter().all(|run| run.is_ours());
        let topics = Topics::new(runs, are_ours, &options.topics)?;
        if are_ours {
            Self::of_table(runs, options, topics)
        } else {
            Self::of_numbers(runs, options.align, topics)
        }
    }

    /// The plan for two runs of toprise.
    fn of_table(
        runs: [Subject<'_>; 2],
        Options { align, topics, .. }: &Options,
        found: Topics,
    ) -> Result<Self, DiffError> {
        let map = TimeMap::new(runs, *align)?;
        let periods = runs.map(period);
        let of_samples = Rule::of_samples(&map, periods);
        let rule = |topic: Topic| {
            let is_compared = found
                .compared
                .iter()
                .any(|compared| compared == topic.name());
            let rule = if topic.info().is_sampled {
                of_samples.clone().with_methods(Method::of_channel(topic))
            } else {
                Rule::SameSequence
            };
            is_compared.then_some(rule)
        };
        let names =
            |topics: &[Topic]| -> Vec<String> { topics.iter().map(ToString::to_string).collect() };
        let all: Vec<Topic> = Topic::all().collect();
        Ok(Self {
            are_ours: true,
            rules: Topic::all().map(rule).collect(),
            topics: names(&all),
            alignment: describe(*align, &of_samples, periods),
            map,
            read: if topics.is_empty() {
                names(&all)
            } else {
                [found.compared, names(&STORY)].concat()
            },
            disorder: [0; 2],
            uncompared: found.uncompared,
            alone: found.alone,
        })
    }

    /// The plan for two files of which not both are toprise's.
    fn of_numbers(runs: [Subject<'_>; 2], align: Align, found: Topics) -> Result<Self, DiffError> {
        if align != Align::Time {
            return Err(DiffError::Align {
                by: align.name(),
                reason: "that takes two recordings of toprise; align by time".to_owned(),
            });
        }
        let topics = found.compared;
        let [(in_a, disorder_a), (in_b, disorder_b)] = runs.map(|run| Times::read(run, &topics));
        let pairs = in_a.iter().zip(&in_b);
        let rules: Vec<_> = pairs.map(|(a, b)| Rule::of_times(a, b)).collect();
        let interpolated = rules.iter().filter(|rule| rule.is_interpolated()).count();
        let alignment = match interpolated {
            0 => "messages with equal times".to_owned(),
            some => format!(
                "messages with equal times; in {some} of {} topics the finer file on straight lines at the \
                 times of the coarser",
                topics.len()
            ),
        };
        Ok(Self {
            are_ours: false,
            rules: rules.into_iter().map(Some).collect(),
            map: TimeMap::Same,
            alignment,
            read: topics.clone(),
            topics,
            disorder: [disorder_a, disorder_b],
            uncompared: found.uncompared,
            alone: found.alone,
        })
    }
}

/// The time between samples, ns, if it is known.
fn period(run: Subject<'_>) -> Option<u64> {
    if let Some(scenario) = run.scenario() {
        return Some(scenario.sample_period_ns);
    }
    let Subject::Recording(recording) = run else {
        return None;
    };
    let period = recording.run()?.get(SAMPLE_PERIOD)?;
    period.parse().ok().filter(|period| *period > 0)
}

fn describe(align: Align, of_samples: &Rule, periods: [Option<u64>; 2]) -> String {
    let milliseconds = |period: Option<u64>| period.map_or(0.0, |ns| ns as f64 / 1e6);
    let [a, b] = periods.map(milliseconds);
    match (align, of_samples) {
        (Align::Nutation, _) => "B where its nutation has the same phase as A's, by Hermite's \
                                 interpolation"
            .to_owned(),
        (Align::Theta, _) => "B where its θ, averaged over a nutation, is the same as A's, by \
                              Hermite's interpolation"
            .to_owned(),
        (_, Rule::Interpolated(Interpolation { grid, .. })) => format!(
            "at {}'s times, the other run by Hermite's interpolation (A has a sample each {a} ms, B each {b} ms)",
            grid.name()
        ),
        (_, Rule::SameTime { finer: Some(_) }) => {
            format!("at the times that both have (A has a sample each {a} ms, B each {b} ms)")
        }
        _ => "samples with equal times, cycles and events with equal numbers".to_owned(),
    }
}
