//! When the messages of a file are, where no scenario tells.

use crate::analysis::subject::Subject;
use crate::archive::recording::Selection;
use std::collections::BTreeMap;

/// Number of times at the beginning of a topic that tell whether two files have the same times.
const TIMES: usize = 4096;

/// The times of the messages of a topic at the beginning of a file, ns, in rising order.
#[derive(Clone, Debug, Default)]
pub(super) struct Times(Vec<u64>);

impl Times {
    /// Reads the times of each topic, and by how much they go backward at most in the order of the file, ns.
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
        let mut reader = recording.reader(Selection::default()).in_order_of_time();
        while let Some(message) = reader.next_undecoded() {
            let Some(topic) = topic[message.position] else {
                continue;
            };
            latest = latest.max(message.log_time);
            disorder = disorder.max(latest - message.log_time);
            if all[topic].0.len() < TIMES {
                all[topic].0.push(message.log_time);
            }
        }
        for times in &mut all {
            times.0.sort_unstable();
        }
        (all, disorder)
    }

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
