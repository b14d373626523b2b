//! What is read of two runs, and how it is to be paired.

use super::pairing::{Method, Rule};
use super::stream::table_topics;
use super::timing::TimeMap;
use super::{Align, DiffError, Options, Subject};
use crate::course::{Course, Cycle};
use crate::recording::{Recording, Selection};
use crate::sink::Side;
use crate::telemetry::channels;
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
        let common: Vec<String> = in_a
            .iter()
            .filter(|topic| in_b.contains(topic))
            .cloned()
            .collect();
        if common.is_empty() {
            return Err(DiffError::NoCommonTopics {
                a: in_a.join(", "),
                b: in_b.join(", "),
            });
        }
        for topic in &options.topics {
            if !common.contains(topic) {
                return Err(DiffError::UnknownTopic {
                    topic: topic.clone(),
                    common: common.join(", "),
                });
            }
        }
        let is_wanted =
            |topic: &String| options.topics.is_empty() || options.topics.contains(topic);
        let wanted: Vec<String> = common
            .iter()
            .filter(|topic| is_wanted(topic))
            .cloned()
            .collect();
        let alone = |of: &[String], other: &[String]| -> Vec<String> {
            let alone = of
                .iter()
                .filter(|topic| !other.contains(topic) && options.topics.is_empty());
            alone.cloned().collect()
        };
        let alone = [alone(&in_a, &in_b), alone(&in_b, &in_a)];
        let mut plan = if is_ours {
            Self::of_table(a, b, options, &wanted)?
        } else {
            Self::of_numbers(a, b, options.align, wanted)?
        };
        plan.alone = alone;
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
                    (Rule::Interpolated { grid, widest, .. }, true) => {
                        let names: Vec<_> = channel
                            .numbers
                            .iter()
                            .map(|leaf| leaf.path.as_str())
                            .collect();
                        Rule::Interpolated {
                            grid: *grid,
                            methods: Method::by_names(&names),
                            widest: *widest,
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
        let times = [a, b].map(|subject| Times::of(subject, &topics));
        let [in_a, in_b] = &times;
        let rules: Vec<_> = in_a
            .iter()
            .zip(in_b)
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

/// The topics that matter of a run.
fn topics_of(subject: Subject<'_>, is_ours: bool) -> Vec<String> {
    match subject {
        Subject::Scenario(_) => table_topics(),
        Subject::Recording(recording) if is_ours => recording.topics(),
        Subject::Recording(recording) => {
            let mut topics: Vec<String> = Vec::new();
            for channel in recording.channels() {
                if !topics.contains(&channel.topic) {
                    topics.push(channel.topic.clone());
                }
            }
            topics
        }
    }
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
        .get("sample_period_ns")?
        .parse()
        .ok()
        .filter(|period| *period > 0)
}

/// How the channels with samples are paired.
fn sampled_rule(map: &TimeMap, periods: [Option<u64>; 2]) -> Rule {
    let interpolated = |grid, period: Option<u64>| Rule::Interpolated {
        grid,
        methods: Vec::new(),
        widest: period.map_or(u64::MAX / 4, |period| period + period / 2),
    };
    match (map, periods) {
        (TimeMap::Through(..), [_, b]) => interpolated(Side::A, b),
        (TimeMap::Same, [Some(a), Some(b)]) if a != b => {
            let (finer, coarser) = if a < b { (a, b) } else { (b, a) };
            let (finer_side, grid) = if a < b {
                (Side::A, Side::B)
            } else {
                (Side::B, Side::A)
            };
            if coarser.is_multiple_of(finer) {
                Rule::SameTime {
                    finer: Some(finer_side),
                }
            } else {
                interpolated(grid, Some(finer))
            }
        }
        _ => Rule::SameTime { finer: None },
    }
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
    subject.read(&["/top/nutation".to_owned()], &mut |message, _| {
        course.take(message);
        ControlFlow::Continue(())
    });
    course
}

/// When the messages of a topic are.
#[derive(Clone, Debug, Default)]
struct Times {
    count: u64,
    first: u64,
    last: u64,
    /// The first of them.
    beginning: Vec<u64>,
}

impl Times {
    fn of(subject: Subject<'_>, topics: &[String]) -> Vec<Self> {
        let mut all = vec![Self::default(); topics.len()];
        let Subject::Recording(recording) = subject else {
            return all;
        };
        let position = |topic: &String| topics.iter().position(|other| other == topic);
        let positions: Vec<_> = recording
            .channels()
            .iter()
            .map(|c| position(&c.topic))
            .collect();
        let mut reader = reader_of(recording, topics);
        while let Some(message) = reader.next_undecoded() {
            if let Some(at) = positions[message.position] {
                all[at].add(message.log_time);
            }
        }
        all
    }

    fn add(&mut self, time_ns: u64) {
        if self.count == 0 {
            self.first = time_ns;
        }
        self.last = self.last.max(time_ns);
        self.count += 1;
        if self.beginning.len() < TIMES {
            self.beginning.push(time_ns);
        }
    }

    /// The mean time between messages, ns.
    fn spacing(&self) -> f64 {
        self.last.saturating_sub(self.first) as f64 / self.count.saturating_sub(1).max(1) as f64
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

fn reader_of<'r>(recording: &'r Recording, topics: &[String]) -> crate::recording::Reader<'r> {
    recording
        .reader(Selection {
            topics: topics.to_vec(),
            ..Selection::default()
        })
        .in_order_of_time()
}

/// How the messages of a topic of two files are paired.
fn foreign_rule(a: &Times, b: &Times) -> Rule {
    let (coarser, finer, grid, finer_side) = if a.spacing() >= b.spacing() {
        (a, b, Side::A, Side::B)
    } else {
        (b, a, Side::B, Side::A)
    };
    let is_finer = finer.count > 1 && coarser.spacing() >= FINER * finer.spacing();
    if finer.count < 2 || coarser.shared(finer) > 0.5 {
        return Rule::SameTime {
            finer: is_finer.then_some(finer_side),
        };
    }
    Rule::Interpolated {
        grid,
        methods: Vec::new(),
        // Farther apart, there is a gap in the file.
        widest: (5.0 * finer.spacing()) as u64,
    }
}
