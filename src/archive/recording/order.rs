//! The order of messages within each channel.

use super::file::Recording;
use crate::archive::container::channels::FileChannel;
use crate::archive::container::section::MessageRecord;
use crate::run::time::seconds;
use std::fmt;

/// Filters out messages that are repeated or go back in time, e.g. if a file contains a chunk twice.
#[derive(Debug)]
pub(super) struct Order {
    channels: Vec<Channel>,
    misplaced: Option<Misplaced>,
}

#[derive(Debug)]
struct Channel {
    topic: String,
    rule: Rule,
    /// Time (ns) and sequence number of the last message.
    last: Option<(u64, u32)>,
}

/// Ordering rule of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Rule {
    /// Times must increase.
    Time,
    /// Sequence numbers must increase and times must not decrease (events can be simultaneous).
    Sequence,
    /// No rule: foreign channels are not filtered.
    Nothing,
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
        match self.messages {
            1 => f.write_str("1 message that is repeated or goes")?,
            count => write!(f, "{count} messages that repeat others or go")?,
        }
        let time = seconds(self.time_ns);
        write!(
            f,
            " back in time, the first in {} at t = {time} s",
            self.topic
        )
    }
}

impl Order {
    /// For the channels of a recording, in the order of the file.
    pub(super) fn new(recording: &Recording) -> Self {
        let is_ours = recording.is_ours();
        let channel = |channel: &FileChannel| Channel {
            topic: channel.topic.clone(),
            rule: match channel.info() {
                _ if !is_ours => Rule::Nothing,
                Some(info) if info.is_sampled => Rule::Time,
                Some(_) => Rule::Sequence,
                None if channel.is_view() => Rule::Sequence,
                None => Rule::Nothing,
            },
            last: None,
        };
        Self {
            channels: recording.channels().iter().map(channel).collect(),
            misplaced: None,
        }
    }

    /// Sort key of a message: time, then channel and sequence number. Foreign messages with equal times keep the file
    /// order.
    pub(super) fn rank(&self, channel: usize, head: &MessageRecord<'_>) -> (u64, usize, u32) {
        match self.channels[channel].rule {
            Rule::Nothing => (head.log_time, 0, 0),
            Rule::Time | Rule::Sequence => (head.log_time, channel, head.sequence),
        }
    }

    /// Whether a message follows the last accepted message of its channel.
    pub(super) fn accepts(&mut self, channel: usize, time_ns: u64, sequence: u32) -> bool {
        let channel = &mut self.channels[channel];
        let is_later = channel.last.is_none_or(|last| match channel.rule {
            Rule::Time => time_ns > last.0,
            Rule::Sequence => time_ns >= last.0 && sequence > last.1,
            Rule::Nothing => true,
        });
        if is_later {
            channel.last = Some((time_ns, sequence));
        } else {
            let misplaced = self.misplaced.get_or_insert_with(|| Misplaced {
                messages: 0,
                topic: channel.topic.clone(),
                time_ns,
            });
            misplaced.messages += 1;
        }
        is_later
    }

    /// The messages that were not accepted.
    pub(super) fn misplaced(&self) -> Option<&Misplaced> {
        self.misplaced.as_ref()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn accepted(rule: Rule) -> (Vec<bool>, Option<String>) {
        let mut order = Order {
            channels: vec![Channel {
                topic: "/top/state".to_owned(),
                rule,
                last: None,
            }],
            misplaced: None,
        };
        let messages = [(0, 0), (5, 1), (5, 2), (5, 2), (4, 3), (6, 4)];
        let accepts = messages.map(|(time_ns, sequence)| order.accepts(0, time_ns, sequence));
        (accepts.to_vec(), order.misplaced().map(ToString::to_string))
    }

    #[test]
    fn samples_have_times_of_their_own_and_events_need_not() {
        let (samples, misplaced) = accepted(Rule::Time);
        assert_eq!(samples, [true, true, false, false, false, true]);
        let expected = "3 messages that repeat others or go back in time, the first in /top/state at t = 0.000000005 s";
        assert_eq!(misplaced.as_deref(), Some(expected));
        let (events, _) = accepted(Rule::Sequence);
        assert_eq!(events, [true, true, true, false, false, true]);
        let (others, _) = accepted(Rule::Nothing);
        assert_eq!(others, [true; 6]);
    }
}
