//! Numbers of messages that contradict the end record although the file is intact: other software filtered, cut or added
//! to the recording.

use crate::archive::format::{EVENT_COUNT, Entries, NUTATION_COUNT, SAMPLE_COUNT};
use crate::telemetry::fields::{EVENTS, FREE_PEG, IMPACTS, NUTATION, free_peg, impacts};
use crate::telemetry::{Message, Topic};
use crate::words::grouped;
use std::collections::BTreeMap;
use std::fmt;

/// Messages that topics lack.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Missing {
    /// The topics; those of samples lack equally many.
    pub topics: Vec<Topic>,
    /// Number of missing messages of each topic; `None` if only their existence is known.
    pub count: Option<u64>,
    /// Number of messages that the run has in each topic; `None` if unknown.
    pub expected: Option<u64>,
}

impl Missing {
    /// Whether messages of a topic are missing.
    pub(crate) fn is_of(&self, topic: Topic) -> bool {
        self.topics.contains(&topic)
    }
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let what = self.topics.first().map_or("messages", |topic| noun(*topic));
        match (self.count, self.expected) {
            (Some(count), Some(expected)) => {
                write!(f, "{} of {} {what}", grouped(count), grouped(expected))?;
            }
            (Some(count), None) => write!(f, "{} {what}", grouped(count))?,
            (None, _) => write!(f, "some {what}")?,
        }
        match &self.topics[..] {
            [] => Ok(()),
            [topic] => write!(f, " of {topic}"),
            [topic, other] => write!(f, " of {topic} and {other}"),
            [topic, others @ ..] => write!(f, " of {topic} and {} other topics", others.len()),
        }
    }
}

/// More messages than a run has.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Excess {
    /// The first topic with too many messages.
    pub topic: Topic,
    /// Number of its messages.
    pub found: u64,
    /// Number of messages that the run has in this topic.
    pub expected: u64,
}

impl fmt::Display for Excess {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let topic = self.topic;
        let (found, expected) = (grouped(self.found), grouped(self.expected));
        let what = noun(topic);
        write!(
            f,
            "{found} {what} of {topic}, but {expected} in the end record"
        )
    }
}

/// Whether each sample of a run has a message of the topic. Those of regular precession depend on the state; those of a
/// free peg on the support, and a recording has their channels only if the peg is free.
pub(super) fn is_in_every_sample(topic: Topic) -> bool {
    let info = topic.info();
    info.is_sampled && (!info.is_optional || info.is_free_peg_only)
}

fn noun(topic: Topic) -> &'static str {
    match topic {
        EVENTS => "events",
        NUTATION => "nutations",
        IMPACTS => "impacts",
        _ => "samples",
    }
}

/// A number of an end record.
fn number(end: &Entries, key: &str) -> Option<u64> {
    end.get(key)?.parse().ok()
}

/// Number of messages that a run has in a topic, according to its end record; `None` if that has none.
fn expected(topic: Topic, end: &Entries) -> Option<u64> {
    match topic {
        EVENTS => number(end, EVENT_COUNT),
        NUTATION => number(end, NUTATION_COUNT),
        _ if is_in_every_sample(topic) => number(end, SAMPLE_COUNT),
        _ => None,
    }
}

/// The messages that were read, counted in order to be compared with the end record.
#[derive(Debug, Default)]
pub(super) struct MessageCounts {
    counts: BTreeMap<usize, u64>,
    /// Energy dissipated by the impacts, J.
    impact_loss: f64,
    /// Sum of the magnitudes of its terms, J.
    impact_loss_terms: f64,
    /// Energy dissipated by impacts up to the last sample, as the sample has it, J.
    impact_loss_of_samples: f64,
}

impl MessageCounts {
    /// Takes a message that can't be decoded: it is not missing.
    pub(super) fn take_undecodable(&mut self, topic: Topic) {
        *self.counts.entry(topic.index()).or_default() += 1;
    }

    pub(super) fn take(&mut self, message: &Message<'_>) {
        *self.counts.entry(message.channel).or_default() += 1;
        match message.topic() {
            IMPACTS => {
                let lost = [impacts::LOST_RESTITUTION, impacts::LOST_FRICTION];
                for part in lost.map(|part| part.of(message)) {
                    self.impact_loss += part;
                    self.impact_loss_terms += part.abs();
                }
            }
            FREE_PEG => {
                self.impact_loss_of_samples = free_peg::LOST_RESTITUTION.of(message)
                    + free_peg::LOST_IMPACT_FRICTION.of(message);
            }
            _ => {}
        }
    }

    /// The messages that some topics lack, according to the end record of their run.
    pub(super) fn missing(&self, topics: &[Topic], end: &Entries) -> Vec<Missing> {
        let mut all: Vec<Missing> = Vec::new();
        for topic in topics {
            let Some(missing) = self.missing_from(*topic, end) else {
                continue;
            };
            // One sentence for all topics that lack equally many samples.
            let same = all.iter_mut().find(|known| {
                let mut topics = known.topics.iter().chain([topic]);
                known.count == missing.count && topics.all(|topic| is_in_every_sample(*topic))
            });
            match same {
                Some(known) => known.topics.push(*topic),
                None => all.push(missing),
            }
        }
        all
    }

    /// The first topic that has more messages than its run, according to the end record.
    pub(super) fn excess(&self, topics: &[Topic], end: &Entries) -> Option<Excess> {
        topics.iter().find_map(|topic| {
            let (found, expected) = (self.number(*topic), expected(*topic, end)?);
            (found > expected).then_some(Excess {
                topic: *topic,
                found,
                expected,
            })
        })
    }

    /// Number of messages of a topic.
    pub(super) fn number(&self, topic: Topic) -> u64 {
        self.counts.get(&topic.index()).copied().unwrap_or(0)
    }

    fn missing_from(&self, topic: Topic, end: &Entries) -> Option<Missing> {
        let recorded = self.number(topic);
        if topic == IMPACTS {
            return self.missing_impacts(recorded);
        }
        let expected = expected(topic, end)?;
        (recorded < expected).then(|| Missing {
            topics: vec![topic],
            count: Some(expected - recorded),
            expected: Some(expected),
        })
    }

    /// The end record has no number of impacts: those that are missing follow from the energy that impacts took up to the
    /// last sample. Sequence numbers would not do, as other software may number messages anew.
    fn missing_impacts(&self, recorded: u64) -> Option<Missing> {
        // Both sums have at most as many terms as there are impacts, each of them in two parts.
        let terms = 2.0 * (recorded as f64 + 1.0);
        let size = self.impact_loss_terms.max(self.impact_loss_of_samples);
        let error = 2.0 * terms * f64::EPSILON * size;
        let is_cut = self.impact_loss_of_samples - self.impact_loss > error;
        is_cut.then(|| Missing {
            topics: vec![IMPACTS],
            count: None,
            expected: None,
        })
    }
}
