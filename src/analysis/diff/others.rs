//! Foreign topics, compared by time and bytes.

use super::field::seconds;
use crate::archive::recording::{FileChannel, Recording, Selection};
use crate::telemetry::Topics;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::iter::Peekable;

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

    fn note(&mut self, time_ns: u64) {
        self.first.get_or_insert(seconds(time_ns));
    }
}

/// Messages at one time, by topic.
type Messages = BTreeMap<String, Vec<Box<[u8]>>>;
/// A time, ns, with its messages.
type Moment = (u64, Messages);

/// Compares topics that both files have; also returns the losses of A and B.
pub(super) fn compare(
    [a, b]: [&Recording; 2],
    topics: &BTreeSet<String>,
    progress: &mut dyn FnMut(u64),
) -> (Vec<TopicBytes>, [Vec<String>; 2]) {
    let mut found: BTreeMap<&str, TopicBytes> = BTreeMap::new();
    for topic in topics {
        let of_topic = TopicBytes {
            topic: topic.clone(),
            is_described_differently: description(a, topic) != description(b, topic),
            ..TopicBytes::default()
        };
        found.insert(topic, of_topic);
    }
    let mut losses = [Vec::new(), Vec::new()];
    let [of_a, of_b] = &mut losses;
    let (mut a, mut b) = (
        moments(a, topics, of_a).peekable(),
        moments(b, topics, of_b).peekable(),
    );
    while let Some((time_ns, [in_a, in_b])) = next(&mut a, &mut b) {
        progress(size(&in_a) + size(&in_b));
        for (topic, found) in &mut found {
            let empty = Vec::new();
            let [x, y] = [&in_a, &in_b].map(|m| m.get(*topic).unwrap_or(&empty));
            compare_moment(found, time_ns, x, y);
        }
    }
    drop((a, b));
    (found.into_values().collect(), losses)
}

fn compare_moment(found: &mut TopicBytes, time_ns: u64, a: &[Box<[u8]>], b: &[Box<[u8]>]) {
    for (a, b) in a.iter().zip(b) {
        if a == b {
            found.equal += 1;
        } else {
            found.different += 1;
            found.note(time_ns);
        }
    }
    let more = [
        a.len().saturating_sub(b.len()),
        b.len().saturating_sub(a.len()),
    ];
    for (unmatched, more) in found.unmatched.iter_mut().zip(more) {
        *unmatched += more as u64;
    }
    if more != [0; 2] {
        found.note(time_ns);
    }
}

/// The earliest messages of both.
fn next(
    a: &mut Peekable<impl Iterator<Item = Moment>>,
    b: &mut Peekable<impl Iterator<Item = Moment>>,
) -> Option<(u64, [Messages; 2])> {
    let times = [a.peek().map(|m| m.0), b.peek().map(|m| m.0)];
    let time = times.into_iter().flatten().min()?;
    let of_a = a.next_if(|moment| moment.0 == time);
    let of_b = b.next_if(|moment| moment.0 == time);
    Some((
        time,
        [of_a, of_b].map(|m| m.map_or_else(BTreeMap::new, |m| m.1)),
    ))
}

/// The messages of some topics in the order of time; `losses` takes what can't be read.
fn moments<'r>(
    recording: &'r Recording,
    topics: &BTreeSet<String>,
    losses: &'r mut Vec<String>,
) -> impl Iterator<Item = Moment> + 'r {
    let selection = Selection {
        topics: Topics::Only(topics.iter().cloned().collect()),
        ..Selection::default()
    };
    let mut reader = recording.reader(selection).in_order_of_time();
    let mut ahead: Option<(u64, String, Box<[u8]>)> = None;
    std::iter::from_fn(move || {
        let mut moment: Option<Moment> = None;
        loop {
            let message = ahead.take().or_else(|| {
                let raw = reader.next_undecoded()?;
                Some((raw.log_time, raw.channel.topic.clone(), raw.data.into()))
            });
            let Some((time_ns, topic, data)) = message else {
                if moment.is_none() {
                    losses.extend(reader.losses().iter().map(ToString::to_string));
                    losses.extend(reader.left_out().map(ToString::to_string));
                }
                return moment;
            };
            let (time, messages) = moment.get_or_insert_with(|| (time_ns, BTreeMap::new()));
            if *time != time_ns {
                ahead = Some((time_ns, topic, data));
                return moment;
            }
            messages.entry(topic).or_default().push(data);
        }
    })
}

fn size(messages: &Messages) -> u64 {
    let all = messages.values().flatten();
    all.map(|data| data.len() as u64).sum()
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
