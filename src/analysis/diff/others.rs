//! Foreign topics, compared by time and bytes.

use crate::analysis::subject;
use crate::archive::recording::{FileChannel, Recording, Selection};
use crate::run::time::seconds;
use crate::telemetry::Topics;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::VecDeque;

/// A topic of two files whose messages are compared byte by byte.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct TopicBytes {
    /// The topic.
    pub topic: String,
    /// Messages with the same time and the same bytes.
    pub equal: u64,
    /// Messages with the same time and other bytes.
    pub different: u64,
    /// Unmatched messages of A and of B.
    pub unmatched: [u64; 2],
    /// Time of the first message that differs or is unmatched, s; absent if there is none.
    pub first: Option<f64>,
    /// Whether encoding or schema differ.
    pub is_described_differently: bool,
}

impl TopicBytes {
    /// Whether both files have the same messages with the same meaning.
    pub fn is_equal(&self) -> bool {
        self.different == 0 && self.unmatched == [0; 2] && !self.is_described_differently
    }

    /// Counts a pair of messages, or one that is unmatched.
    fn count(&mut self, time_ns: u64, messages: [Option<Box<[u8]>>; 2]) {
        let count = match messages {
            [Some(a), Some(b)] if a == b => {
                self.equal += 1;
                return;
            }
            [Some(_), Some(_)] => &mut self.different,
            [a, _] => &mut self.unmatched[usize::from(a.is_none())],
        };
        *count += 1;
        self.first.get_or_insert(seconds(time_ns));
    }
}

/// A message: its time (ns), the index of its topic, and its bytes.
type Foreign = (u64, usize, Box<[u8]>);

/// Compares topics that both files have, which are sorted; also returns the losses of A and B.
pub(super) fn compare(
    [a, b]: [&Recording; 2],
    topics: &[String],
    progress: &mut dyn FnMut(u64),
) -> (Vec<TopicBytes>, [Vec<String>; 2]) {
    let of_topic = |topic: &String| TopicBytes {
        topic: topic.clone(),
        is_described_differently: description(a, topic) != description(b, topic),
        ..TopicBytes::default()
    };
    let mut found: Vec<_> = topics.iter().map(of_topic).collect();
    let mut losses = [Vec::new(), Vec::new()];
    let [of_a, of_b] = &mut losses;
    let mut a = messages(a, topics, of_a).peekable();
    let mut b = messages(b, topics, of_b).peekable();
    // A's messages at one time, by topic.
    let mut waiting = vec![VecDeque::new(); topics.len()];
    loop {
        let next = [a.peek(), b.peek()].into_iter().flatten();
        let Some(time_ns) = next.map(|message| message.0).min() else {
            break;
        };
        while let Some((_, topic, data)) = a.next_if(|message| message.0 == time_ns) {
            progress(data.len() as u64);
            waiting[topic].push_back(data);
        }
        while let Some((_, topic, data)) = b.next_if(|message| message.0 == time_ns) {
            progress(data.len() as u64);
            found[topic].count(time_ns, [waiting[topic].pop_front(), Some(data)]);
        }
        for (found, alone) in found.iter_mut().zip(&mut waiting) {
            for data in alone.drain(..) {
                found.count(time_ns, [Some(data), None]);
            }
        }
    }
    drop((a, b));
    (found, losses)
}

/// The messages of some topics, which are sorted, in the order of time; `losses` takes what can't be read.
fn messages<'r>(
    recording: &'r Recording,
    topics: &'r [String],
    losses: &'r mut Vec<String>,
) -> impl Iterator<Item = Foreign> + 'r {
    let selection = Selection {
        topics: Topics::Only(topics.to_vec()),
        ..Selection::default()
    };
    let mut reader = recording.reader(selection).in_order_of_time();
    std::iter::from_fn(move || {
        if let Some(raw) = reader.next_undecoded() {
            let topic = topics.binary_search(&raw.channel.topic).ok()?;
            return Some((raw.log_time, topic, raw.data.into()));
        }
        losses.extend(subject::losses(recording, &reader));
        None
    })
}

/// The encodings and schemas of a topic's channels.
fn description(recording: &Recording, topic: &str) -> Vec<(String, Option<String>, Vec<u8>)> {
    let channels = recording.channels().iter().filter(|c| c.topic == topic);
    let describe = |channel: &FileChannel| {
        let schema = channel.schema.as_deref();
        let name = schema.map(|s| format!("{} {}", s.encoding, s.name));
        let data = schema.map_or_else(Vec::new, |s| s.data.clone());
        (channel.encoding.clone(), name, data)
    };
    let mut all: Vec<_> = channels.map(describe).collect();
    all.sort();
    all
}
