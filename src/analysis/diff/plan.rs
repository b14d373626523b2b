//! What is read of two runs, and how it is to be paired.

use super::pairing::{Finer, Method, Rule};
use super::stream::table_topics;
use super::timing::TimeMap;
use super::{Align, DiffError, Options, Subject};
use crate::analysis::course::{Course, Cycle};
use crate::archive::format::SAMPLE_PERIOD;
use crate::archive::recording::{FileChannel, Recording, Selection};
use crate::telemetry::Topics;
use crate::telemetry::channels;
use crate::telemetry::fields::NUTATION;
use crate::telemetry::side::Side;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::ControlFlow;

/// So many times at the beginning of a topic tell whether two files have the same times.
const TIMES: usize = 4096;
/// A run with so many more messages is finer, not complete where the other isn't.
const FINER: f64 = 1.5;

/// The topics that tell what happened and how the motion was on average: small ones.
const STORY: [&str; 2] = ["/top/nutation", "/events"];

/// What is compared, and how.
#[derive(Debug)]
pub(super) struct Plan {
    /// Whether both are toprise's: then topics are those of the table.
    pub(super) is_ours: bool,
    /// The topics, by the numbers that messages have as channels.
    pub(super) topics: Vec<String>,
    /// How to pair the messages of each; none for topics that not both have or nobody asked for.
    pub(super) rules: Vec<Option<Rule>>,
    pub(super) map: TimeMap,
    /// In a sentence, what is compared with what.
    pub(super) alignment: String,
    /// What to read: these, and what tells the story of a run.
    pub(super) read: Vec<String>,
    /// By how much the times of A's and B's messages go backward at most in the order of the file, ns.
    pub(super) disorder: [u64; 2],
    /// Topics of both that can't be compared.
    pub(super) uncompared: Vec<String>,
    /// Topics that only A and only B has, but for those that are derived for viewers.
    pub(super) alone: [Vec<String>; 2],
}

impl Plan {
    pub(super) fn new(
        a: Subject<'_>,
        b: Subject<'_>,
        options: &Options,
    ) -> Result<Self, DiffError> {
        let is_ours = a.is_ours() && b.is_ours();
        let [in_a, in_b] = [a, b].map(|subject| topics_of(subject, is_ours));
        let common = in_both(&in_a, &in_b);
        let told = |topics: &[String]| match topics {
            [] => "none".to_owned(),
            some => some.join(", "),
        };
        if common.is_empty() {
            return Err(DiffError::NoCommonTopics {
                a: told(&in_a),
                b: told(&in_b),
            });
        }
        if let Some(topic) = options.topics.iter().find(|topic| !common.contains(topic)) {
            return Err(DiffError::UnknownTopic {
                topic: topic.clone(),
                common: common.join(", "),
            });
        }
        let is_everything = options.topics.is_empty();
        let is_wanted = |topic: &&String| is_everything || options.topics.contains(topic);
        let wanted: Vec<String> = common.iter().filter(is_wanted).cloned().collect();
        let mut plan = if is_ours {
            Self::of_table(a, b, options, &wanted)?
        } else {
            Self::of_numbers(a, b, options.align, wanted)?
        };
        if is_everything {
            let [more_a, more_b] = [a, b].map(|subject| others_of(subject, is_ours));
            plan.uncompared = in_both(&more_a, &more_b);
            let (in_a, in_b) = ([in_a, more_a].concat(), [in_b, more_b].concat());
            plan.alone = [only_in(&in_a, &in_b), only_in(&in_b, &in_a)];
        }
        Ok(plan)
    }

    fn of_table(
        a: Subject<'_>,
        b: Subject<'_>,
        Options { align, topics, .. }: &Options,
        wanted: &[String],
    ) -> Result<Self, DiffError> {
        let (align, is_everything) = (*align, topics.is_empty());
        let story = STORY.map(str::to_owned);
        let map = time_map(a, b, align)?;
        let periods = [a, b].map(period);
        let sampled = sampled_rule(&map, periods);
        let topics = table_topics();
        let rule = |(topic, channel): (&String, &crate::telemetry::ChannelInfo)| {
            wanted
                .contains(topic)
                .then(|| match (&sampled, channel.is_sampled) {
                    (_, false) => Rule::SameSequence,
                    (
                        Rule::Interpolated {
                            grid, widest, gap, ..
                        },
                        true,
                    ) => {
                        let names: Vec<_> = channel
                            .numbers
                            .iter()
                            .map(|leaf| leaf.path.as_str())
                            .collect();
                        Rule::Interpolated {
                            grid: *grid,
                            methods: Method::by_names(&names),
                            widest: *widest,
                            gap: *gap,
                        }
                    }
                    (rule, true) => rule.clone(),
                })
        };
        Ok(Self {
            is_ours: true,
            rules: topics.iter().zip(channels()).map(rule).collect(),
            topics,
            alignment: describe(align, &sampled, periods),
            map,
            read: if is_everything {
                table_topics()
            } else {
                [wanted, &story].concat()
            },
            disorder: [0; 2],
            uncompared: Vec::new(),
            alone: [Vec::new(), Vec::new()],
        })
    }

    fn of_numbers(
        a: Subject<'_>,
        b: Subject<'_>,
        align: Align,
        topics: Vec<String>,
    ) -> Result<Self, DiffError> {
        if align != Align::Time {
            return Err(DiffError::Align {
                by: align.name(),
                reason: "that takes two recordings of toprise; align by time".to_owned(),
            });
        }
        let [(in_a, disorder_a), (in_b, disorder_b)] =
            [a, b].map(|subject| Times::of(subject, &topics));
        let rules: Vec<_> = in_a
            .iter()
            .zip(&in_b)
            .map(|(a, b)| Some(foreign_rule(a, b)))
            .collect();
        let is_interpolated =
            |rule: &&Option<Rule>| matches!(rule, Some(Rule::Interpolated { .. }));
        let interpolated = rules.iter().filter(is_interpolated).count();
        let alignment = match interpolated {
            0 => "messages with equal times".to_owned(),
            some => format!(
                "messages with equal times; in {some} of {} topics the finer file on straight lines at the \
                 times of the coarser",
                topics.len()
            ),
        };
        Ok(Self {
            is_ours: false,
            topics,
            rules,
            map: TimeMap::Same,
            alignment,
            read: Vec::new(),
            disorder: [disorder_a, disorder_b],
            uncompared: Vec::new(),
            alone: [Vec::new(), Vec::new()],
        })
    }
}

impl Align {
    /// Its name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Nutation => "nutation",
            Self::Theta => "theta",
        }
    }
}

/// The topics of a run that can be compared.
fn topics_of(subject: Subject<'_>, is_ours: bool) -> Vec<String> {
    match subject {
        Subject::Recording(recording) if !is_ours => {
            let mut seen = BTreeSet::new();
            let topics = recording.channels().iter().map(|channel| &channel.topic);
            topics
                .filter(|topic| seen.insert(*topic))
                .cloned()
                .collect()
        }
        subject => subject.topics().iter().map(ToString::to_string).collect(),
    }
}

/// The topics of a recording of ours that are neither of the table nor derived for viewers.
fn others_of(subject: Subject<'_>, is_ours: bool) -> Vec<String> {
    let Subject::Recording(recording) = subject else {
        return Vec::new();
    };
    let is_other =
        |channel: &&FileChannel| is_ours && channel.table.is_none() && !channel.is_view();
    let others = recording.channels().iter().filter(is_other);
    others.map(|channel| channel.topic.clone()).collect()
}

fn in_both(a: &[String], b: &[String]) -> Vec<String> {
    let b: BTreeSet<&String> = b.iter().collect();
    a.iter()
        .filter(|topic| b.contains(topic))
        .cloned()
        .collect()
}

fn only_in(a: &[String], b: &[String]) -> Vec<String> {
    let b: BTreeSet<&String> = b.iter().collect();
    a.iter()
        .filter(|topic| !b.contains(topic))
        .cloned()
        .collect()
}

/// The time between samples, ns, if it is known.
fn period(subject: Subject<'_>) -> Option<u64> {
    if let Some(scenario) = subject.scenario() {
        return Some(scenario.sample_period_ns);
    }
    let Subject::Recording(recording) = subject else {
        return None;
    };
    recording
        .run()?
        .get(SAMPLE_PERIOD)?
        .parse()
        .ok()
        .filter(|period| *period > 0)
}

/// How the channels with samples are paired.
fn sampled_rule(map: &TimeMap, periods: [Option<u64>; 2]) -> Rule {
    let interpolated = |grid, own: Option<u64>, other: Option<u64>| Rule::Interpolated {
        grid,
        methods: Vec::new(),
        widest: other.map_or(u64::MAX, gap),
        gap: own.map_or(u64::MAX, gap),
    };
    let [a, b] = periods;
    match (map, a, b) {
        (TimeMap::Through(..), ..) => Rule::Interpolated {
            grid: Side::A,
            methods: Vec::new(),
            widest: b.map_or(u64::MAX, gap),
            // Times are stretched: nothing is known of B's messages in between.
            gap: u64::MAX,
        },
        (TimeMap::Same, Some(x), Some(y)) if x != y => {
            let finer = if x < y { Side::A } else { Side::B };
            if x.max(y).is_multiple_of(x.min(y)) {
                Rule::SameTime {
                    finer: Some(Finer {
                        side: finer,
                        gap: gap(x.max(y)),
                    }),
                }
            } else {
                interpolated(finer.other(), Some(x.max(y)), Some(x.min(y)))
            }
        }
        _ => Rule::SameTime { finer: None },
    }
}

/// With this period, more than this between two messages is a gap, ns.
fn gap(period: u64) -> u64 {
    period.saturating_add(period / 2)
}

fn describe(align: Align, sampled: &Rule, periods: [Option<u64>; 2]) -> String {
    let milliseconds = |period: Option<u64>| period.map_or(0.0, |ns| ns as f64 / 1e6);
    let [a, b] = periods.map(milliseconds);
    match (align, sampled) {
        (Align::Nutation, _) => "B where its nutation has the same phase as A's, by Hermite's \
                                 interpolation"
            .to_owned(),
        (Align::Theta, _) => "B where its θ, averaged over a nutation, is the same as A's, by \
                              Hermite's interpolation"
            .to_owned(),
        (_, Rule::Interpolated { grid, .. }) => format!(
            "at {}'s times, the other run by Hermite's interpolation (A has a sample each {a} ms, B each {b} ms)",
            grid.name()
        ),
        (_, Rule::SameTime { finer: Some(_) }) => {
            format!("at the times that both have (A has a sample each {a} ms, B each {b} ms)")
        }
        _ => "samples with equal times, cycles and events with equal numbers".to_owned(),
    }
}

/// Which time of B belongs to which of A.
fn time_map(a: Subject<'_>, b: Subject<'_>, align: Align) -> Result<TimeMap, DiffError> {
    if align == Align::Time {
        return Ok(TimeMap::Same);
    }
    let impossible = |reason: String| DiffError::Align {
        by: align.name(),
        reason,
    };
    let [a, b] = [a, b].map(cycles);
    for (course, name) in [(&a, "A"), (&b, "B")] {
        if course.cycles.len() < 4 {
            let found = course.cycles.len();
            return Err(impossible(format!(
                "{name} has {found} nutation cycles (/top/nutation), at least 4 are needed"
            )));
        }
    }
    let mean = |cycle: &Cycle| cycle.means[0];
    let (from, to) = match align {
        Align::Theta => (a.of_cycles(mean), b.of_cycles(mean).inverse()),
        _ => (a.phase(), b.phase().inverse()),
    };
    let is_same = match align {
        Align::Theta => from == b.of_cycles(mean),
        _ => from == b.phase(),
    };
    if is_same {
        return Ok(TimeMap::Same);
    }
    let has_target = |cycle: &Cycle| {
        from.at(cycle.middle())
            .is_some_and(|phase| to.at(phase).is_some())
    };
    if !a.cycles.iter().any(has_target) {
        let what = if align == Align::Theta {
            "averages of θ"
        } else {
            "nutations"
        };
        return Err(impossible(format!("the two have no {what} in common")));
    }
    Ok(TimeMap::Through(from, to))
}

/// The nutation cycles of a run, and nothing else.
fn cycles(subject: Subject<'_>) -> Course {
    let mut course = Course::default();
    subject.read(&Topics::Only(vec![NUTATION]), &mut |message, _| {
        course.take(message);
        ControlFlow::Continue(())
    });
    course
}

/// When the messages of a topic are.
#[derive(Clone, Debug, Default)]
struct Times {
    count: u64,
    /// The first of them.
    beginning: Vec<u64>,
}

impl Times {
    /// The times of each topic, and by how much they go backward at most in the order of the file, ns.
    fn of(subject: Subject<'_>, topics: &[String]) -> (Vec<Self>, u64) {
        let mut all = vec![Self::default(); topics.len()];
        let Subject::Recording(recording) = subject else {
            return (all, 0);
        };
        let places: BTreeMap<&str, usize> = topics.iter().map(String::as_str).zip(0..).collect();
        let places: Vec<_> = recording
            .channels()
            .iter()
            .map(|channel| places.get(channel.topic.as_str()).copied())
            .collect();
        let (mut latest, mut disorder) = (0, 0);
        let mut reader = reader_of(recording, topics);
        while let Some(message) = reader.next_undecoded() {
            latest = latest.max(message.log_time);
            disorder = disorder.max(latest - message.log_time);
            if let Some(at) = places[message.position] {
                all[at].add(message.log_time);
            }
        }
        for times in &mut all {
            times.beginning.sort_unstable();
        }
        (all, disorder)
    }

    fn add(&mut self, time_ns: u64) {
        self.count += 1;
        if self.beginning.len() < TIMES {
            self.beginning.push(time_ns);
        }
    }

    /// A time between messages that a quarter of those at the beginning don't exceed, ns: messages that are
    /// lost don't change it.
    fn spacing(&self) -> Option<u64> {
        let pairs = self.beginning.windows(2);
        let mut steps: Vec<u64> = pairs.map(|pair| pair[1] - pair[0]).collect();
        steps.sort_unstable();
        steps.get(steps.len() / 4).copied()
    }

    /// The part of the times at the beginning that another topic has too, of those within its beginning.
    fn shared(&self, other: &Self) -> f64 {
        let (Some(first), Some(last)) = (other.beginning.first(), other.beginning.last()) else {
            return 0.0;
        };
        let within = self
            .beginning
            .iter()
            .filter(|time| (first..=last).contains(time));
        let (mut count, mut shared) = (0_u64, 0_u64);
        for time in within {
            count += 1;
            shared += u64::from(other.beginning.binary_search(time).is_ok());
        }
        shared as f64 / count.max(1) as f64
    }
}

fn reader_of<'r>(
    recording: &'r Recording,
    topics: &[String],
) -> crate::archive::recording::Reader<'r> {
    recording
        .reader(Selection {
            topics: Topics::Only(topics.to_vec()),
            ..Selection::default()
        })
        .in_order_of_time()
}

/// How the messages of a topic of two files are paired.
fn foreign_rule(a: &Times, b: &Times) -> Rule {
    let same = Rule::SameTime { finer: None };
    let (Some(x), Some(y)) = (a.spacing(), b.spacing()) else {
        return same;
    };
    let (coarser, finer, side) = if x >= y {
        (a, b, Side::B)
    } else {
        (b, a, Side::A)
    };
    let (long, short) = (x.max(y), x.min(y));
    let is_finer = long as f64 >= FINER * short as f64;
    if coarser.shared(finer) > 0.5 {
        let gap = gap(long);
        return Rule::SameTime {
            finer: is_finer.then_some(Finer { side, gap }),
        };
    }
    Rule::Interpolated {
        grid: side.other(),
        methods: Vec::new(),
        // Farther apart, there is a gap in the file.
        widest: short.saturating_mul(5),
        gap: long.saturating_mul(5),
    }
}
