//! What is compared with what, decided before the runs are read.

use super::clock::Clock;
use super::error::DiffError;
use super::field::seconds;
use super::interpolation::Method;
use super::options::{Align, Offset, Options};
use super::rule::{Interpolation, Rule};
use super::time_map::TimeMap;
use super::times::{MessageTimes, Times};
use super::topics::ComparedTopics;
use super::touch::CommonLevels;
use crate::analysis::subject::Subject;
use crate::archive::format::SAMPLE_PERIOD;
use crate::telemetry::fields::{EVENTS, NUTATION};
use crate::telemetry::side::Side;
use crate::telemetry::{Topic, Topics};
use std::ops::ControlFlow;

/// The topics that tell what happened and how the motion was on average: small ones.
const STORY: [Topic; 2] = [NUTATION, EVENTS];

/// What is compared with what.
#[derive(Debug)]
pub(super) struct ComparisonPlan {
    /// Whether both runs are toprise's: then topics are those of the telemetry table, and all of a message counts.
    /// Files of others: their numbers are compared.
    pub(super) are_ours: bool,
    /// The topics, by the numbers that messages have as topics. Of two runs of toprise those of the telemetry table come
    /// first, in its order.
    pub(super) topics: Vec<String>,
    /// How to pair the messages of each topic; none for topics that are not compared.
    pub(super) rules: Vec<Option<Rule>>,
    /// Which time of B belongs to which of A.
    pub(super) map: TimeMap,
    /// What is compared with what, in a sentence.
    pub(super) alignment: String,
    /// The topics to read: those that are compared, and of toprise's runs those that tell their story.
    pub(super) read: Vec<String>,
    /// The clock of both.
    pub(super) clock: Clock,
    /// By how much the times of A's and B's messages go backward at most from topic to topic, ns.
    pub(super) disorder: [u64; 2],
    /// Of files of others, when the messages of each topic are in A and in B.
    pub(super) times: Vec<[Option<MessageTimes>; 2]>,
    /// Whether messages are paired by their places, whatever their times are.
    pub(super) is_by_index: bool,
    /// Whether both files are the same to the last byte, and no clock is shifted.
    pub(super) is_same: bool,
    /// Topics that would be compared, but are ignored.
    pub(super) ignored: Vec<String>,
    /// Whether topics or fields are ignored.
    pub(super) has_ignored: bool,
    /// The levels of θ at which a top counts as risen or fallen.
    pub(super) levels: CommonLevels,
    /// Topics that only A and only B has, but for those that are derived for viewers.
    pub(super) alone: [Vec<String>; 2],
}

impl ComparisonPlan {
    /// Decides how to compare two runs.
    pub(super) fn new(runs: [Subject<'_>; 2], options: &Options) -> Result<Self, DiffError> {
        let are_ours = runs.iter().all(|run| run.is_ours());
        let topics = ComparedTopics::new(runs, are_ours, &options.topics, &options.tolerances)?;
        if are_ours {
            Self::of_table(runs, options, topics)
        } else {
            Self::of_files(runs, options, topics)
        }
    }

    /// The plan for two runs of toprise.
    fn of_table(
        runs: [Subject<'_>; 2],
        options: &Options,
        found: ComparedTopics,
    ) -> Result<Self, DiffError> {
        let Options { align, topics, .. } = options;
        let map = TimeMap::new(runs, *align)?;
        let periods = runs.map(period);
        let asked = Rule::asked(*align, options.max_dt);
        let of_samples = asked.unwrap_or_else(|| Rule::of_samples(&map, periods));
        let clock = Clock::new(
            runs.map(|run| first_time(run, options.offset)),
            options.offset,
        );
        let rule = |topic: Topic| {
            let is_compared = found
                .compared
                .iter()
                .any(|compared| compared == topic.name());
            let rule = if topic.info().is_sampled {
                of_samples.clone().with_methods(Method::of_channel(topic))
            } else if *align == Align::Index {
                Rule::SameIndex
            } else {
                Rule::SameSequence
            };
            is_compared.then_some(rule)
        };
        let names =
            |topics: &[Topic]| -> Vec<String> { topics.iter().map(ToString::to_string).collect() };
        let all: Vec<Topic> = Topic::all().collect();
        let bytes = Rule::asked(*align, options.max_dt);
        let bytes = bytes.unwrap_or(Rule::SameTime { finer: None });
        let others = found.others.iter().map(|_| Some(bytes.clone()));
        Ok(Self {
            are_ours: true,
            rules: Topic::all().map(rule).chain(others).collect(),
            topics: [names(&all), found.others.clone()].concat(),
            alignment: describe(*align, &of_samples, periods),
            is_by_index: *align == Align::Index,
            is_same: are_same(runs, clock),
            clock,
            times: Vec::new(),
            map,
            read: if topics.is_empty() {
                [names(&all), found.others].concat()
            } else {
                [found.compared, names(&STORY)].concat()
            },
            disorder: [0; 2],
            levels: CommonLevels::of(runs),
            ignored: found.ignored,
            has_ignored: !options.tolerances.ignored.is_empty(),
            alone: found.alone,
        })
    }

    /// The plan for two files of which not both are toprise's.
    fn of_files(
        runs: [Subject<'_>; 2],
        options: &Options,
        found: ComparedTopics,
    ) -> Result<Self, DiffError> {
        let align = options.align;
        if !matches!(align, Align::Time | Align::Index) {
            return Err(DiffError::Align {
                by: align.name(),
                reason: "that takes two recordings of toprise; align by time or index".to_owned(),
            });
        }
        let topics = found.compared;
        let [(in_a, disorder_a), (in_b, disorder_b)] = runs.map(|run| Times::read(run, &topics));
        let [a, b] = runs;
        let first = [(a, &in_a), (b, &in_b)].map(|(run, times)| match run {
            Subject::Scenario(_) => Some(0),
            Subject::Recording(_) => {
                let first = times.iter().filter_map(|times| Some(times.span()?.0));
                first.min()
            }
        });
        let clock = Clock::new(first, options.offset);
        let asked = Rule::asked(align, options.max_dt);
        let in_both = in_a.iter().zip(&in_b);
        let rule = |(a, b)| asked.clone().unwrap_or_else(|| Rule::of_times(a, b, clock));
        let rules: Vec<_> = in_both.clone().map(rule).collect();
        let times = in_both.map(|(a, b)| {
            [(Side::A, a), (Side::B, b)]
                .map(|(side, times)| times.report(|ns| seconds(clock.time(side, ns))))
        });
        let interpolated = rules.iter().filter(|rule| rule.is_interpolated()).count();
        let alignment = match (asked, interpolated) {
            (Some(asked), _) => asked.name(),
            (None, 0) => "messages with equal times".to_owned(),
            (None, some) => format!(
                "messages with equal times; in {some} of {} topics the finer file at the times of the coarser: \
                 numbers with a fraction on straight lines, all else as it was last",
                topics.len()
            ),
        };
        Ok(Self {
            are_ours: false,
            times: times.collect(),
            is_by_index: align == Align::Index,
            is_same: are_same(runs, clock),
            clock,
            rules: rules.into_iter().map(Some).collect(),
            map: TimeMap::Same,
            alignment,
            read: topics.clone(),
            topics,
            disorder: [disorder_a, disorder_b],
            levels: CommonLevels::default(),
            ignored: found.ignored,
            has_ignored: !options.tolerances.ignored.is_empty(),
            alone: found.alone,
        })
    }
}

impl ComparisonPlan {
    /// Whether messages of a topic can be compared byte by byte: there are no bytes between two messages.
    pub(super) fn takes_bytes(&self, topic: usize) -> bool {
        let rule = self.rules.get(topic).and_then(Option::as_ref);
        rule.is_some_and(|rule| !rule.is_interpolated())
    }

    /// Whether the times of A's and B's messages, ns, overlap on the clock of both.
    pub(super) fn overlap(&self, a: (u64, u64), b: (u64, u64)) -> bool {
        let of = |side, (first, last)| (self.clock.time(side, first), self.clock.time(side, last));
        let (a, b) = (of(Side::A, a), of(Side::B, b));
        a.1 >= b.0 && b.1 >= a.0
    }
}

/// Whether two runs are files with the same bytes, on one clock.
fn are_same(runs: [Subject<'_>; 2], clock: Clock) -> bool {
    match runs {
        [Subject::Recording(a), Subject::Recording(b)] => !clock.is_shifted() && a.has_bytes_of(b),
        _ => false,
    }
}

/// The time of the first message of a run of toprise, ns, if the clocks are put so that it counts.
fn first_time(run: Subject<'_>, offset: Offset) -> Option<u64> {
    if offset != Offset::Start {
        return Some(0);
    }
    let mut first = None;
    run.read(&Topics::All, &mut |message, _| {
        first = Some(message.time_ns);
        ControlFlow::Break(())
    });
    first
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
        (_, asked @ (Rule::SameIndex | Rule::Nearest(_))) => asked.name(),
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
