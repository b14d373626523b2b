//! Topics compared as they stand in the files: time, sequence number, bytes.

use super::spelling::{MAX_DEPTH, Spelling, compare_json};
use crate::analysis::subject;
use crate::archive::recording::{Recording, Selection};
use crate::run::time::seconds;
use crate::telemetry::Topics;
use crate::telemetry::side::Side;
use crate::words::counted;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::mem;

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
    #[serde(skip)]
    pub reordered: u64,
    /// Messages with other bytes whose JSON is nested too deeply to compare its values. They count as different.
    #[serde(skip)]
    pub too_deep: u64,
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

    /// Compares two messages of the same time.
    fn add(&mut self, time_ns: u64, a: &Foreign, b: &Foreign) {
        let values = a.compare_values(b);
        match values {
            Values::Identical => self.equal += 1,
            Values::Json(Spelling::SameValues) => self.respelled += 1,
            Values::Json(Spelling::Different | Spelling::TooDeep) | Values::Different => {
                self.different += 1;
                self.too_deep += u64::from(values == Values::Json(Spelling::TooDeep));
                self.first.get_or_insert(seconds(time_ns));
                return;
            }
        }
        self.other_publish_times += u64::from(a.publish_time != b.publish_time);
        self.other_sequences += u64::from(a.sequence != b.sequence);
        self.reordered += u64::from(a.place != b.place);
    }

    /// Compares A's and B's messages of one time: equal ones with each other, in any order, then the others in the order
    /// of the files.
    fn add_simultaneous(&mut self, time_ns: u64, [a, b]: [VecDeque<Foreign>; 2]) {
        let mut of_b: BTreeMap<&[u8], VecDeque<&Foreign>> = BTreeMap::new();
        for message in &b {
            of_b.entry(&message.data).or_default().push_back(message);
        }
        let mut others_of_a = Vec::new();
        let mut equal_of_b: BTreeMap<&[u8], usize> = BTreeMap::new();
        for message in &a {
            match of_b.get_mut(&*message.data).and_then(VecDeque::pop_front) {
                Some(equal) => {
                    self.add(time_ns, message, equal);
                    *equal_of_b.entry(&message.data).or_default() += 1;
                }
                None => others_of_a.push(message),
            }
        }
        // The first messages with these bytes have been matched.
        let mut others_of_b = Vec::new();
        for message in &b {
            match equal_of_b.get_mut(&*message.data) {
                Some(left) if *left > 0 => *left -= 1,
                _ => others_of_b.push(message),
            }
        }
        for (of_a, of_b) in others_of_a.iter().zip(&others_of_b) {
            self.add(time_ns, of_a, of_b);
        }
        for _ in others_of_b.len()..others_of_a.len() {
            self.add_unmatched(time_ns, Side::A);
        }
        for _ in others_of_a.len()..others_of_b.len() {
            self.add_unmatched(time_ns, Side::B);
        }
    }

    fn add_unmatched(&mut self, time_ns: u64, side: Side) {
        self.unmatched[side.index()] += 1;
        self.first.get_or_insert(seconds(time_ns));
    }
}

/// A message as it stands in a file.
#[derive(Clone, Debug)]
struct Foreign {
    /// Log time, ns.
    time_ns: u64,
    /// Index of its topic among those compared.
    topic: usize,
    /// Number of messages of the same topic and time before it.
    place: usize,
    publish_time: u64,
    sequence: u32,
    is_json: bool,
    data: Box<[u8]>,
}

/// How two messages compare.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Values {
    /// All bytes are equal.
    Identical,
    /// Other bytes, of JSON.
    Json(Spelling),
    /// Other bytes.
    Different,
}

impl Foreign {
    fn compare_values(&self, other: &Self) -> Values {
        if self.data == other.data {
            Values::Identical
        } else if self.is_json && other.is_json {
            Values::Json(compare_json(&self.data, &other.data))
        } else {
            Values::Different
        }
    }
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
    let [of_a, of_b] = &mut losses;
    let mut a = messages(a, topics, of_a).peekable();
    let mut b = messages(b, topics, of_b).peekable();
    // A's messages at one time, by topic, and B's that differ from them in that order.
    let mut waiting: Vec<[VecDeque<Foreign>; 2]> = vec![Default::default(); topics.len()];
    loop {
        let next = [a.peek(), b.peek()].into_iter().flatten();
        let Some(time_ns) = next.map(|message| message.time_ns).min() else {
            break;
        };
        let mut present = BTreeSet::new();
        while let Some(of_a) = a.next_if(|message| message.time_ns == time_ns) {
            progress(of_a.data.len() as u64);
            present.insert(of_a.topic);
            waiting[of_a.topic][0].push_back(of_a);
        }
        while let Some(of_b) = b.next_if(|message| message.time_ns == time_ns) {
            progress(of_b.data.len() as u64);
            present.insert(of_b.topic);
            let [first, others] = &mut waiting[of_b.topic];
            // Mostly both files have the same order, and nothing has to be searched.
            match first.pop_front_if(|of_a| of_a.data == of_b.data) {
                Some(of_a) => found[of_b.topic].add(time_ns, &of_a, &of_b),
                None => others.push_back(of_b),
            }
        }
        for topic in present {
            let waiting = mem::take(&mut waiting[topic]);
            found[topic].add_simultaneous(time_ns, waiting);
        }
    }
    // They add what can't be read to the losses.
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
    // For each topic, the time of the last message, and the number of messages at that time.
    let mut latest = vec![(0, 0); topics.len()];
    std::iter::from_fn(move || {
        if let Some(raw) = reader.next_undecoded() {
            let topic = topics.binary_search(&raw.channel.topic).ok()?;
            let (time_ns, count) = &mut latest[topic];
            if *time_ns != raw.log_time {
                (*time_ns, *count) = (raw.log_time, 0);
            }
            let place = *count;
            *count += 1;
            return Some(Foreign {
                time_ns: raw.log_time,
                topic,
                place,
                publish_time: raw.publish_time,
                sequence: raw.sequence,
                is_json: raw.channel.encoding == "json",
                data: raw.data.into(),
            });
        }
        losses.extend(subject::losses(recording, &reader));
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
    let too_deep = format!("JSON with more than {MAX_DEPTH} levels is not compared by its values");
    let kinds: [(&str, Count); 5] = [
        (&too_deep, |topic| topic.too_deep),
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
