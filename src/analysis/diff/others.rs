//! Topics compared as they stand in the files: time, sequence number, bytes.

use crate::archive::recording::{Recording, Selection};
use crate::archive::replay;
use crate::run::time::seconds;
use crate::telemetry::Topics;
use crate::words::counted;
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::{Number, Value};
use std::collections::{BTreeMap, BTreeSet, VecDeque};

/// A topic of two files whose messages are compared byte by byte.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct TopicBytes {
    /// The topic.
    pub topic: String,
    /// Messages with the same time and the same bytes.
    pub equal: u64,
    /// Messages with the same time and the same values, but other bytes: JSON that is spelled differently.
    pub respelled: u64,
    /// Messages with the same time and other values.
    pub different: u64,
    /// Unmatched messages of A and of B.
    pub unmatched: [u64; 2],
    /// Time of the first message that differs or is unmatched, s; absent if there is none.
    pub first: Option<f64>,
    /// Messages with the same values and another publish time.
    pub other_publish_times: u64,
    /// Messages with the same values and another sequence number.
    pub other_sequences: u64,
    /// Messages with the same values and another place among those of their time.
    pub reordered: u64,
    /// Whether encoding or schema differ.
    pub is_described_differently: bool,
}

impl TopicBytes {
    /// Whether both files have the same messages with the same meaning.
    pub fn is_equal(&self) -> bool {
        self.different == 0 && self.unmatched == [0; 2] && !self.is_described_differently
    }

    /// Whether the messages are the same in every respect.
    pub fn is_identical(&self) -> bool {
        let has_other_heads = self.other_publish_times > 0 || self.other_sequences > 0;
        self.is_equal() && self.respelled == 0 && self.reordered == 0 && !has_other_heads
    }

    /// Number of messages of A and B that were compared with each other.
    pub(super) fn pairs(&self) -> u64 {
        self.equal + self.respelled + self.different
    }

    /// Compares A's and B's messages of one time.
    fn add_simultaneous(&mut self, time_ns: u64, [a, b]: &[Vec<Foreign>; 2]) {
        let [order_a, order_b] = pair(a, b);
        for (place_a, place_b) in order_a.iter().zip(&order_b) {
            let (a, b) = (&a[*place_a], &b[*place_b]);
            if a.data == b.data {
                self.equal += 1;
            } else if a.is_json && b.is_json && is_same_json(&a.data, &b.data) {
                self.respelled += 1;
            } else {
                self.different += 1;
                self.first.get_or_insert(seconds(time_ns));
                continue;
            }
            self.other_publish_times += u64::from(a.publish_time != b.publish_time);
            self.other_sequences += u64::from(a.sequence != b.sequence);
            self.reordered += u64::from(place_a != place_b);
        }
        for (unmatched, own, other) in [(0, a, b), (1, b, a)] {
            if own.len() > other.len() {
                self.unmatched[unmatched] += (own.len() - other.len()) as u64;
                self.first.get_or_insert(seconds(time_ns));
            }
        }
    }
}

/// The places of A's and B's messages in an order in which those to compare have the same index: equal messages wherever
/// they are, then the others as they follow each other in the files.
fn pair(a: &[Foreign], b: &[Foreign]) -> [Vec<usize>; 2] {
    let mut places: BTreeMap<&[u8], VecDeque<usize>> = BTreeMap::new();
    for (place, message) in b.iter().enumerate() {
        places.entry(&message.data).or_default().push_back(place);
    }
    let [mut order_a, mut order_b] = [Vec::new(), Vec::new()];
    let mut others_of_a = Vec::new();
    for (place, message) in a.iter().enumerate() {
        match places.get_mut(&*message.data).and_then(VecDeque::pop_front) {
            Some(equal) => {
                order_a.push(place);
                order_b.push(equal);
            }
            None => others_of_a.push(place),
        }
    }
    let mut others_of_b: Vec<_> = places.into_values().flatten().collect();
    others_of_b.sort_unstable();
    order_a.extend(others_of_a);
    order_b.extend(others_of_b);
    [order_a, order_b]
}

/// Whether two JSON texts have the same values. One that can't be read has no values.
fn is_same_json(a: &[u8], b: &[u8]) -> bool {
    match (serde_json::from_slice(a), serde_json::from_slice(b)) {
        (Ok(a), Ok(b)) => is_same_value(&a, &b),
        _ => false,
    }
}

/// Whether two JSON values are equal. `==` would take 1 and 1.0 for different, and 0.0 and -0.0 for equal.
fn is_same_value(a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => number_key(a) == number_key(b),
        (Value::Array(a), Value::Array(b)) => {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| is_same_value(a, b))
        }
        (Value::Object(a), Value::Object(b)) => {
            a.len() == b.len()
                && a.iter()
                    .all(|(name, a)| b.get(name).is_some_and(|b| is_same_value(a, b)))
        }
        _ => a == b,
    }
}

/// The bits of a number as a double, and the number as an integer. A double can't hold every 64-bit integer, and an integer
/// has no fraction: the two together distinguish all that a [`Number`] can be.
fn number_key(number: &Number) -> (Option<u64>, Option<i128>) {
    let double = number.as_f64();
    let truncated = double.map(|double| double as i128);
    (double.map(f64::to_bits), number.as_i128().or(truncated))
}

/// A message as it stands in a file.
#[derive(Debug)]
struct Foreign {
    /// Log time, ns.
    time_ns: u64,
    /// Index of its topic among those compared.
    topic: usize,
    publish_time: u64,
    sequence: u32,
    is_json: bool,
    data: Box<[u8]>,
}

/// Compares topics that both files have, which are sorted; also returns the losses of A and B.
pub(super) fn compare(
    [a, b]: [&Recording; 2],
    topics: &[String],
    progress: &mut dyn FnMut(u64),
) -> (Vec<TopicBytes>, [Vec<String>; 2]) {
    let described = [descriptions(a), descriptions(b)];
    let mut found = Vec::new();
    for topic in topics {
        found.push(TopicBytes {
            topic: topic.clone(),
            is_described_differently: described[0].get(&**topic) != described[1].get(&**topic),
            ..TopicBytes::default()
        });
    }
    let mut losses = [Vec::new(), Vec::new()];
    let [losses_a, losses_b] = &mut losses;
    let mut files =
        [messages(a, topics, losses_a), messages(b, topics, losses_b)].map(Iterator::peekable);
    loop {
        let next = files.iter_mut().filter_map(|file| file.peek());
        let Some(time_ns) = next.map(|message| message.time_ns).min() else {
            break;
        };
        let mut simultaneous: BTreeMap<usize, [Vec<Foreign>; 2]> = BTreeMap::new();
        for (side, file) in files.iter_mut().enumerate() {
            while let Some(message) = file.next_if(|message| message.time_ns == time_ns) {
                progress(message.data.len() as u64);
                simultaneous.entry(message.topic).or_default()[side].push(message);
            }
        }
        for (topic, messages) in &simultaneous {
            found[*topic].add_simultaneous(time_ns, messages);
        }
    }
    // They add what can't be read to the losses.
    drop(files);
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
            return Some(Foreign {
                time_ns: raw.time_ns,
                topic: topics.binary_search(&raw.channel.topic).ok()?,
                publish_time: raw.publish_time,
                sequence: raw.sequence,
                is_json: raw.channel.encoding == "json",
                data: raw.data.into(),
            });
        }
        losses.extend(replay::losses(recording, &reader));
        None
    })
}

/// Encoding of messages, encoding and name of the schema, and its text.
type Description<'r> = (&'r str, Option<(&'r str, &'r str)>, &'r [u8]);

/// The encodings and schemas of the channels of each topic, each once: a topic may have several publishers.
fn descriptions(recording: &Recording) -> BTreeMap<&str, BTreeSet<Description<'_>>> {
    let mut all: BTreeMap<_, BTreeSet<_>> = BTreeMap::new();
    for channel in recording.channels().iter().filter(|c| !c.is_superseded) {
        let schema = channel.schema.as_deref();
        // Not by identifiers, which other software may give anew.
        let name = schema.map(|schema| (&*schema.encoding, &*schema.name));
        let text = schema.map_or(&[][..], |schema| &schema.data);
        let description = (&*channel.encoding, name, text);
        all.entry(&*channel.topic).or_default().insert(description);
    }
    all
}

/// The number of messages of a topic that differ in some way.
type Count = fn(&TopicBytes) -> u64;

/// Sentences about what differs besides the values, for all topics together.
pub(super) fn notes(topics: &[TopicBytes]) -> Vec<String> {
    let kinds: [(&str, Count); 4] = [
        ("Publish times differ", |topic| topic.other_publish_times),
        ("Sequence numbers differ", |topic| topic.other_sequences),
        ("JSON is spelled differently", |topic| topic.respelled),
        // After a missing message, every place is a different one.
        ("The order of messages of the same time differs", |topic| {
            if topic.is_equal() { topic.reordered } else { 0 }
        }),
    ];
    let mut notes = Vec::new();
    for (what, count) in kinds {
        let counts = topics
            .iter()
            .map(|topic| (topic.topic.as_str(), count(topic)));
        notes.extend(note(what, counts));
    }
    notes
}

/// A sentence about a kind of difference, from its topics and the number of messages of each.
pub(super) fn note<'t>(what: &str, counts: impl Iterator<Item = (&'t str, u64)>) -> Option<String> {
    let counts: Vec<_> = counts.filter(|(_, count)| *count > 0).collect();
    let (first, _) = counts.first()?;
    let total: u64 = counts.iter().map(|(_, count)| count).sum();
    let messages = counted(total, "message");
    let others = match counts.len() - 1 {
        0 => String::new(),
        1 => " and one more topic".to_owned(),
        more => format!(" and {more} more topics"),
    };
    Some(format!("{what} in {messages} of {first}{others}."))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn compares_json_by_value() {
        for (a, b, expected) in [
            (
                r#"{"a":1,"b":[2.5]}"#,
                r#"{ "b": [25e-1], "a": 1.0 }"#,
                true,
            ),
            (r#""é""#, r#""\u00e9""#, true),
            ("1e2", "100", true),
            ("-0.0", "-0", true),
            ("0.1", "0.10000000000000001", true),
            ("0.1", "0.10000000000000002", false),
            ("-0.0", "0.0", false),
            ("1", "-1", false),
            ("0.5", "0", false),
            // Integers of 64 bits are exact, other numbers are doubles.
            ("9007199254740993", "9007199254740992", false),
            ("9007199254740993", "9007199254740992.0", false),
            ("18446744073709551615", "18446744073709551614", false),
            ("-9223372036854775808", "-9223372036854775807", false),
            ("18446744073709551615", "18446744073709551616", false),
            ("18446744073709551616", "18446744073709551617", true),
            ("1.0000000000000000001", "1", true),
            ("1e30", "1000000000000000000000000000000", true),
            ("1e400", "10e399", false),
            (r#"{"1": "2", "a": [3.0]}"#, r#"{"a": [3], "1": "2"}"#, true),
            ("[1,2]", "[2,1]", false),
            ("[1,2]", "[1]", false),
            ("null", "0", false),
            (r#"{"a":1}"#, r#"{"a":1,"b":null}"#, false),
            (r#"{"a":1}"#, r#"{"b":1}"#, false),
            // The last member of a name counts, as for most readers.
            (r#"{"a":1,"a":2}"#, r#"{"a":2}"#, true),
            (r#"{"a":1,"a":2}"#, r#"{"a":1}"#, false),
            ("{", "{ ", false),
            ("1", "1 2", false),
        ] {
            assert_eq!(
                is_same_json(a.as_bytes(), b.as_bytes()),
                expected,
                "{a} {b}"
            );
            assert_eq!(
                is_same_json(b.as_bytes(), a.as_bytes()),
                expected,
                "{b} {a}"
            );
        }
    }

    #[test]
    fn json_nested_too_deeply_to_be_read_is_different() {
        for (depth, expected) in [(127, true), (128, false), (100_000, false)] {
            let [a, b] =
                ["", " "].map(|space| format!("{}{space}{}", "[".repeat(depth), "]".repeat(depth)));
            assert_eq!(
                is_same_json(a.as_bytes(), b.as_bytes()),
                expected,
                "{depth}"
            );
        }
    }
}
