//! When the messages of a file are, where no scenario tells.

use super::clock::Clock;
use super::field::seconds;
use crate::analysis::subject::Subject;
use crate::archive::recording::Selection;
use crate::telemetry::side::Side;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;

/// Number of times at the beginning of a topic that tell whether two files have the same times.
const TIMES: usize = 4096;

/// The times of the messages of a topic of a file.
#[derive(Clone, Debug, Default)]
pub(super) struct Times {
    /// Those at the beginning, ns, in rising order.
    first: Vec<u64>,
    /// How many there are.
    count: u64,
    /// The least and the greatest, ns.
    span: Option<(u64, u64)>,
    /// That of the last message, ns.
    last: u64,
    duplicates: u64,
    backward: u64,
    /// The longest time without a message and when it began, ns.
    longest_gap: (u64, u64),
}

/// When the messages of a topic are in one of the files.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct MessageTimes {
    /// Mean rate, Hz; absent for fewer than two messages.
    pub rate: Option<f64>,
    /// Messages with the time of the one before.
    pub duplicates: u64,
    /// Messages that stand behind later ones of their topic.
    pub out_of_order: u64,
    /// The longest time from one message to the next, s; absent for fewer than two messages.
    pub longest_gap: Option<f64>,
    /// When that began, s.
    pub longest_gap_at: Option<f64>,
}

impl Times {
    /// Reads the times of each topic, and by how much they go backward at most between topics in the order of the file,
    /// ns. What goes backward within its topic doesn't count.
    ///
    /// A scenario has none: what it logs is in order.
    pub(super) fn read(run: Subject<'_>, topics: &[String]) -> (Vec<Self>, u64) {
        let mut all = vec![Self::default(); topics.len()];
        let Subject::Recording(recording) = run else {
            return (all, 0);
        };
        let topic: BTreeMap<&str, usize> = topics.iter().map(String::as_str).zip(0..).collect();
        let channels = recording.channels().iter();
        let topic: Vec<Option<usize>> = channels
            .map(|channel| topic.get(channel.topic.as_str()).copied())
            .collect();
        let (mut latest, mut disorder) = (0, 0);
        let mut reader = recording.reader(Selection::default()).bounded();
        while let Some(message) = reader.next_undecoded() {
            let Some(topic) = topic[message.position] else {
                continue;
            };
            latest = latest.max(message.log_time);
            if all[topic].add(message.log_time) {
                disorder = disorder.max(latest - message.log_time);
            }
        }
        for times in &mut all {
            times.first.sort_unstable();
        }
        (all, disorder)
    }

    /// Takes in the next time, and tells whether it is no earlier than those before.
    fn add(&mut self, time_ns: u64) -> bool {
        if self.first.len() < TIMES {
            self.first.push(time_ns);
        }
        let (least, greatest) = self.span.unwrap_or((time_ns, time_ns));
        let is_forward = time_ns >= greatest;
        if self.count > 0 {
            self.duplicates += u64::from(time_ns == self.last);
            self.backward += u64::from(!is_forward);
            let gap = time_ns.saturating_sub(greatest);
            if gap > self.longest_gap.0 {
                self.longest_gap = (gap, greatest);
            }
        }
        self.count += 1;
        self.last = time_ns;
        self.span = Some((least.min(time_ns), greatest.max(time_ns)));
        is_forward
    }

    /// The times of the first and the last message, ns, if there are any.
    pub(super) fn span(&self) -> Option<(u64, u64)> {
        self.span
    }

    /// What is told of them; `since` gives the time of a moment, s.
    pub(super) fn report(&self, since: impl Fn(u64) -> f64) -> Option<MessageTimes> {
        let (least, greatest) = self.span?;
        let has_rate = greatest > least;
        let (gap, at) = self.longest_gap;
        Some(MessageTimes {
            rate: has_rate.then(|| (self.count - 1) as f64 * 1e9 / (greatest - least) as f64),
            duplicates: self.duplicates,
            out_of_order: self.backward,
            longest_gap: has_rate.then(|| seconds(gap)),
            longest_gap_at: has_rate.then(|| since(at)),
        })
    }

    /// The beginning on the clock of both runs.
    pub(super) fn beginning(&self, side: Side, clock: Clock) -> Beginning {
        let first = self.first.iter();
        Beginning(first.map(|time| clock.time(side, *time)).collect())
    }
}

/// The times at the beginning of a topic on the clock of both runs, ns, in rising order.
#[derive(Clone, Debug)]
pub(super) struct Beginning(Vec<u64>);

impl Beginning {
    /// A time between messages that a quarter of those at the beginning don't exceed, ns: messages that are
    /// lost don't change it.
    pub(super) fn spacing(&self) -> Option<u64> {
        let pairs = self.0.windows(2);
        let mut steps: Vec<u64> = pairs.map(|pair| pair[1] - pair[0]).collect();
        steps.sort_unstable();
        steps.get(steps.len() / 4).copied()
    }

    /// The part of the times that another topic has too, of those within the other's beginning.
    pub(super) fn shared(&self, other: &Self) -> f64 {
        let (Some(first), Some(last)) = (other.0.first(), other.0.last()) else {
            return 0.0;
        };
        let within = self.0.iter().filter(|time| (first..=last).contains(time));
        let (mut count, mut shared) = (0_u64, 0_u64);
        for time in within {
            count += 1;
            shared += u64::from(other.0.binary_search(time).is_ok());
        }
        shared as f64 / count.max(1) as f64
    }
}
