//! The order of messages within each channel.

use super::file::Recording;
use crate::archive::container::channels::FileChannel;
use crate::archive::container::section::MessageRecord;
use crate::run::time::seconds;
use crate::telemetry::Topic;
use crate::words::counted;
use std::collections::BTreeMap;
use std::fmt;

/// Filters out messages that are repeated or go back in time, e.g. if a file contains a chunk twice.
///
/// Sequence numbers are optional in MCAP, and many writers set all of them to 0. They alone never exclude a message.
#[derive(Debug)]
pub(super) struct MessageOrder {
    /// For each channel of the file, its place among `channels`.
    places: Vec<usize>,
    /// The channels; those of a topic of toprise are one.
    channels: Vec<OrderedChannel>,
    misplaced: Option<Misplaced>,
}

#[derive(Debug)]
struct OrderedChannel {
    topic: String,
    rule: Rule,
    /// Place of the channel among those of a run; none for channels of other software.
    place: Option<usize>,
    /// Accepted messages of the latest time.
    latest: Simultaneous,
}

/// Ordering rule of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Rule {
    /// Times must increase.
    Time,
    /// Times must not decrease, because events can be simultaneous; equal messages are repeated ones.
    Events,
    /// No rule: foreign channels are not filtered.
    Nothing,
}

/// Maximum size of the messages of one time that are kept to find repeated ones, bytes, and their maximum number.
/// Repeated messages beyond that are not noticed.
const MAX_SIMULTANEOUS: (usize, usize) = (1 << 20, 1000);

/// Messages of the same time.
#[derive(Debug, Default)]
struct Simultaneous {
    /// The time, ns; `None` before the first message.
    time_ns: Option<u64>,
    /// Sequence number of each message, and the end of its data.
    messages: Vec<(u32, usize)>,
    /// Data of all messages.
    data: Vec<u8>,
}

impl Simultaneous {
    fn contains(&self, message: &MessageRecord<'_>) -> bool {
        let mut start = 0;
        self.messages.iter().any(|(sequence, end)| {
            let data = &self.data[start..*end];
            start = *end;
            *sequence == message.sequence && data == message.data
        })
    }

    /// Adds a message, which replaces earlier ones.
    fn add(&mut self, message: &MessageRecord<'_>) {
        if self.time_ns != Some(message.time_ns) {
            self.time_ns = Some(message.time_ns);
            self.messages.clear();
            self.data.clear();
        }
        let (max_size, max_count) = MAX_SIMULTANEOUS;
        let size = self.data.len() + message.data.len();
        if size <= max_size && self.messages.len() < max_count {
            self.data.extend_from_slice(message.data);
            self.messages.push((message.sequence, size));
        }
    }
}

/// Messages that repeat others or go back in time.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Misplaced {
    /// Number of messages.
    pub messages: u64,
    /// The topic of the first.
    pub topic: String,
    /// The time of the first, ns.
    pub time_ns: u64,
}

impl fmt::Display for Misplaced {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            messages,
            topic,
            time_ns,
        } = self;
        let (messages, time) = (counted(*messages, "message"), seconds(*time_ns));
        write!(
            f,
            "{messages} skipped: repeated, or not later than the one before; the first in {topic} at t = {time} s"
        )
    }
}

impl MessageOrder {
    /// The order of the channels of a recording.
    pub(super) fn new(recording: &Recording) -> Self {
        let is_ours = recording.is_ours();
        let (mut places, mut channels) = (Vec::new(), Vec::new());
        let mut known: BTreeMap<Topic, usize> = BTreeMap::new();
        for channel in recording.channels() {
            // Two publishers may share a topic; then a message may be repeated in the other channel.
            let topic = channel.table.filter(|_| is_ours);
            if let Some(place) = topic.and_then(|topic| known.get(&topic)) {
                places.push(*place);
                continue;
            }
            known.extend(topic.map(|topic| (topic, channels.len())));
            places.push(channels.len());
            channels.push(OrderedChannel {
                topic: channel.topic.clone(),
                rule: match channel.info() {
                    // Only toprise's own channels have a rule: other software may repeat messages or go back in time.
                    _ if !is_ours => Rule::Nothing,
                    Some(info) if info.is_sampled => Rule::Time,
                    Some(_) => Rule::Events,
                    None => Rule::Nothing,
                },
                place: place(channel).filter(|_| is_ours),
                latest: Simultaneous::default(),
            });
        }
        Self {
            places,
            channels,
            misplaced: None,
        }
    }

    /// Sort key of a message among those of its time: the topic's place in the telemetry table, then the sequence number.
    /// Values derived from a sample must not depend on the order in which other software wrote its topics. Messages with
    /// equal keys keep the file order: those of other software, and those whose writer set no sequence numbers.
    pub(super) fn rank(&self, channel: usize, head: &MessageRecord<'_>) -> Option<(usize, u32)> {
        Some((self.channels[self.places[channel]].place?, head.sequence))
    }

    /// Whether a message follows the last accepted message of its channel.
    pub(super) fn accepts(&mut self, channel: usize, message: &MessageRecord<'_>) -> bool {
        let channel = &mut self.channels[self.places[channel]];
        if channel.accepts(message) {
            if channel.rule != Rule::Nothing {
                channel.latest.add(message);
            }
            return true;
        }
        let misplaced = self.misplaced.get_or_insert_with(|| Misplaced {
            messages: 0,
            topic: channel.topic.clone(),
            time_ns: message.time_ns,
        });
        misplaced.messages += 1;
        false
    }

    /// The messages that were not accepted.
    pub(super) fn misplaced(&self) -> Option<&Misplaced> {
        self.misplaced.as_ref()
    }
}

/// The place of a channel among those of a run: in the table, or after it for views, which repeat what the table has.
fn place(channel: &FileChannel) -> Option<usize> {
    match channel.table {
        Some(topic) => Some(topic.index()),
        None => channel.is_view().then_some(usize::MAX),
    }
}

impl OrderedChannel {
    /// Whether a message is later than those before it, or simultaneous where that is allowed, and none of them again.
    fn accepts(&self, message: &MessageRecord<'_>) -> bool {
        let Some(last) = self.latest.time_ns else {
            return true;
        };
        match self.rule {
            Rule::Events if message.time_ns == last => !self.latest.contains(message),
            Rule::Time | Rule::Events => message.time_ns > last,
            Rule::Nothing => true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Time, sequence number and data of a message.
    type Numbers = (u64, u32, u8);

    fn accepted(rule: Rule, messages: &[Numbers]) -> (Vec<bool>, Option<String>) {
        let mut order = MessageOrder {
            places: vec![0],
            channels: vec![OrderedChannel {
                topic: "/top/state".to_owned(),
                rule,
                place: None,
                latest: Simultaneous::default(),
            }],
            misplaced: None,
        };
        let mut accepted = Vec::new();
        for (log_time, sequence, data) in messages {
            let message = MessageRecord {
                channel_id: 0,
                sequence: *sequence,
                log_time: *log_time,
                publish_time: *log_time,
                time_ns: *log_time,
                data: &[*data],
            };
            accepted.push(order.accepts(0, &message));
        }
        (accepted, order.misplaced().map(ToString::to_string))
    }

    #[test]
    fn samples_have_unique_times_and_events_need_not() {
        let messages = [
            (0, 0, 0),
            (5, 1, 0),
            (5, 2, 1),
            (5, 2, 1),
            (4, 3, 0),
            (6, 4, 0),
        ];
        let (samples, misplaced) = accepted(Rule::Time, &messages);
        assert_eq!(samples, [true, true, false, false, false, true]);
        let expected = "3 messages skipped: repeated, or not later than the one before; the first in /top/state at t = 0.000000005 s";
        assert_eq!(misplaced.as_deref(), Some(expected));
        let (events, misplaced) = accepted(Rule::Events, &messages);
        assert_eq!(events, [true, true, true, false, false, true]);
        assert!(
            misplaced
                .unwrap()
                .starts_with("2 messages skipped: repeated")
        );
        let (others, _) = accepted(Rule::Nothing, &messages);
        assert_eq!(others, [true; 6]);
    }

    #[test]
    fn sequence_numbers_are_optional() {
        // All zero, decreasing, and equal at the same time: data differ.
        let messages = [
            (0, 0, 0),
            (1, 0, 0),
            (2, 9, 0),
            (3, 8, 0),
            (3, 8, 1),
            (3, 0, 1),
        ];
        for rule in [Rule::Events, Rule::Nothing] {
            assert_eq!(accepted(rule, &messages), (vec![true; 6], None), "{rule:?}");
        }
    }

    #[test]
    fn repeated_messages_need_not_follow_each_other() {
        let messages = [(3, 0, 0), (3, 0, 1), (3, 0, 0), (3, 0, 1)];
        let (events, misplaced) = accepted(Rule::Events, &messages);
        assert_eq!(events, [true, true, false, false]);
        let expected = "2 messages skipped: repeated, or not later than the one before; the first in /top/state at t = 0.000000003 s";
        assert_eq!(misplaced.as_deref(), Some(expected));
    }

    #[test]
    fn simultaneous_messages_take_bounded_memory() {
        let mut latest = Simultaneous::default();
        let data = vec![0; 4096];
        for sequence in 0..2000 {
            latest.add(&MessageRecord {
                channel_id: 0,
                sequence,
                log_time: 0,
                time_ns: 0,
                publish_time: 0,
                data: &data,
            });
        }
        assert_eq!(latest.data.len(), MAX_SIMULTANEOUS.0);
    }
}
