//! The order of messages within each channel.

use crate::telemetry::fields::EVENTS;
use crate::telemetry::{Message, Topic, channels};

/// Tells messages that come in their order from those that repeat others or go back in time, as in a file with a chunk
/// that stands there twice.
#[derive(Clone, Debug, Default)]
pub(crate) struct Order {
    /// Time (ns) and sequence number of the last message of each channel.
    last: Vec<Option<(u64, u32)>>,
    /// How many were out of order, and the first.
    misplaced: u64,
    first: Option<(Topic, u64)>,
}

impl Order {
    /// Whether a message comes after the last one of its channel that did.
    pub(crate) fn accepts(&mut self, message: &Message<'_>) -> bool {
        self.last.resize(channels().len(), None);
        let last = &mut self.last[message.channel];
        let now = (message.time_ns, message.sequence);
        // Several events may happen at the same time.
        let is_later =
            last.is_none_or(|last| now.0 > last.0 || (message.topic() == EVENTS && now > last));
        if is_later {
            *last = Some(now);
        } else {
            self.misplaced += 1;
            self.first.get_or_insert((message.topic(), message.time_ns));
        }
        is_later
    }

    /// What there is to tell of the messages that were out of order.
    pub(crate) fn loss(&self) -> Option<String> {
        let (topic, time_ns) = self.first?;
        let time = time_ns as f64 / 1e9;
        let messages = match self.misplaced {
            1 => "1 message that repeats another or goes".to_owned(),
            count => format!("{count} messages that repeat others or go"),
        };
        Some(format!(
            "{messages} back in time, the first in {topic} at t = {time} s"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::telemetry::fields::STATE;

    fn accepted(topic: Topic, messages: &[(u64, u32)]) -> (Vec<bool>, Option<String>) {
        let mut order = Order::default();
        let accepts = messages.iter().map(|(time_ns, sequence)| {
            order.accepts(&Message {
                channel: topic.index(),
                sequence: *sequence,
                time_ns: *time_ns,
                numbers: &[],
                texts: &[],
            })
        });
        (accepts.collect(), order.loss())
    }

    #[test]
    fn samples_have_times_of_their_own_and_events_need_not() {
        let messages = [(0, 0), (5, 1), (5, 2), (5, 2), (4, 3), (6, 4)];
        let (samples, loss) = accepted(STATE, &messages);
        assert_eq!(samples, [true, true, false, false, false, true]);
        let expected = "3 messages that repeat others or go back in time, the first in /top/state at t = 0.000000005 s";
        assert_eq!(loss.as_deref(), Some(expected));
        let (events, _) = accepted(EVENTS, &messages);
        assert_eq!(events, [true, true, true, false, false, true]);
        assert_eq!(accepted(STATE, &messages[..2]).1, None);
    }
}
