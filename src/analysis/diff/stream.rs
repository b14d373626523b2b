//! The messages of one run as they come: out of a file, or out of a simulation.

use super::item::{Item, Written};
use super::plan::ComparisonPlan;
use super::rule::Rule;
use crate::analysis::subject::{Ended, Subject, Undecodable};
use crate::archive::recording::{FileChannel, Recording, Selection, Undecoded};
use crate::telemetry::payload::{MAX_FIELDS, PayloadDecoder, Value};
use crate::telemetry::{Topic, Topics};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::SyncSender;

/// Messages in a batch.
const BATCH: usize = 1024;
/// Memory that the messages of a batch take, bytes: large messages make it shorter.
const LARGEST_BATCH: usize = 1 << 20;
/// Longer messages are not decoded: what they hold is no numbers, or more than are compared one by one.
const LONGEST_DECODED: usize = 1 << 24;
/// No more fields of a file than these are compared, in all topics together.
const MOST_FIELDS: usize = 1 << 18;

/// Messages of one run.
#[derive(Debug, Default)]
pub(super) struct Batch {
    /// The messages; their topics are positions in the plan's list.
    pub(super) messages: Vec<Item>,
    /// Fields that came up with them: a topic, and the fields behind those known so far.
    pub(super) fields: Vec<(usize, Vec<String>)>,
    /// How many more bytes of the file have been read.
    pub(super) bytes: u64,
}

/// What comes out of a run.
#[derive(Debug)]
pub(super) enum Parcel {
    Batch(Batch),
    End {
        ended: Ended,
        /// What must be known of what was read.
        remarks: Vec<String>,
    },
}

/// Reads the topics of a plan from a run to its end, or until nobody takes its batches any more.
///
/// Messages of two runs of toprise are read as the telemetry table has them, those of their other channels as bytes. Of
/// other files all fields are read, or the bytes where they can't be decoded. What is derived for viewers is read as long
/// as it is wanted.
pub(super) fn read(
    run: Subject<'_>,
    plan: &ComparisonPlan,
    are_views_wanted: &AtomicBool,
    out: &SyncSender<Parcel>,
) {
    let topics = &plan.read;
    let mut posting = Posting {
        out,
        batch: Batch::default(),
        memory: 0,
        is_open: true,
    };
    let mut remarks = Vec::new();
    let ended = match run {
        Subject::Recording(recording) if plan.are_ours => read_recording(
            recording,
            plan,
            are_views_wanted,
            &mut posting,
            &mut remarks,
        ),
        run if plan.are_ours => run.read(&of_table(topics), &mut |message, bytes| {
            posting.push(Item::from(message), bytes)
        }),
        Subject::Recording(recording) => {
            read_payloads(recording, topics, &mut posting, &mut remarks)
        }
        Subject::Scenario(_) => {
            posting.announce(topics);
            let position = |topic: Topic| topics.iter().position(|name| name == topic.name());
            let positions: Vec<_> = Topic::all().map(position).collect();
            run.read(&of_table(topics), &mut |message, bytes| {
                let Some(topic) = positions[message.channel] else {
                    return ControlFlow::Continue(());
                };
                let texts = message.texts.iter();
                let texts = texts.map(|text| Value::Text(text.as_str().into()));
                let numbers = message.numbers.iter().map(|number| Value::Real(*number));
                let values: Vec<_> = texts.chain(numbers).collect();
                posting.push(
                    Item {
                        topic,
                        sequence: message.sequence,
                        time_ns: message.time_ns,
                        numbers: values.iter().map(Value::number).collect(),
                        values,
                        ..Item::default()
                    },
                    bytes,
                )
            })
        }
    };
    posting.send();
    let _ = out.send(Parcel::End { ended, remarks });
}

/// Reads a recording of toprise. Messages that don't fit the table are compared byte by byte, unless their topic is
/// interpolated: then they are told as missing. So are then messages that repeat others, which are compared otherwise.
fn read_recording(
    recording: &Recording,
    plan: &ComparisonPlan,
    are_views_wanted: &AtomicBool,
    posting: &mut Posting<'_>,
    remarks: &mut Vec<String>,
) -> Ended {
    struct Place {
        topic: Option<usize>,
        is_view: bool,
    }
    let positions = plan.topics.iter().map(String::as_str).zip(0..);
    let positions: BTreeMap<&str, usize> = positions.collect();
    let channels = recording.channels().iter();
    let places = channels.map(|channel| Place {
        topic: positions.get(channel.topic.as_str()).copied(),
        is_view: channel.is_view(),
    });
    let places: Vec<Place> = places.collect();
    let encodings = encodings(recording);
    let selection = Selection {
        topics: Topics::Only(plan.read.clone()),
        ..Selection::default()
    };
    let mut undecodable = Undecodable::default();
    let mut misfits: Option<(String, u64)> = None;
    let mut reader = recording.reader(selection).in_order_of_time();
    let is_interpolated = plan.rules.iter().flatten().any(Rule::is_interpolated);
    if !is_interpolated {
        reader = reader.with_misplaced();
    }
    loop {
        let bytes = reader.progress();
        let Some((raw, decoded)) = reader.next_both() else {
            break;
        };
        if places[raw.position].is_view && !are_views_wanted.load(Ordering::Relaxed) {
            continue;
        }
        let encoding = &encodings[raw.position];
        let mut item = match (decoded, places[raw.position].topic) {
            (Some(Ok(message)), _) => Item {
                written: Some(written(&raw, encoding, false)),
                ..Item::from(&message)
            },
            (Some(Err(error)), Some(topic)) if plan.takes_bytes(topic) => {
                misfits.get_or_insert((error.to_string(), 0)).1 += 1;
                item_of_bytes(&raw, encoding, topic)
            }
            (Some(Err(error)), _) => {
                undecodable.add(error);
                continue;
            }
            (None, Some(topic)) => item_of_bytes(&raw, encoding, topic),
            (None, None) => continue,
        };
        item.is_misplaced = reader.is_misplaced();
        if posting.push(item, bytes).is_break() {
            break;
        }
    }
    if !is_interpolated {
        remarks.extend(reader.misplaced().map(ToString::to_string));
    }
    remarks.extend(misfits.map(|(first, count)| match count {
        1 => format!("1 message is compared byte by byte, because it can't be decoded: {first}"),
        _ => format!(
            "{count} messages are compared byte by byte, because they can't be decoded; the first: {first}"
        ),
    }));
    Ended {
        end: recording.end().cloned(),
        losses: undecodable.losses(&reader),
    }
}

/// A message of which only the bytes are compared.
fn item_of_bytes(message: &Undecoded<'_>, encoding: &Arc<str>, topic: usize) -> Item {
    Item {
        topic,
        sequence: message.sequence,
        time_ns: message.log_time,
        rest: Some(message.data.into()),
        written: Some(written(message, encoding, true)),
        ..Item::default()
    }
}

/// How the file has a message; its bytes are left out if they are compared anyway.
fn written(message: &Undecoded<'_>, encoding: &Arc<str>, are_bytes_compared: bool) -> Written {
    Written {
        encoding: Arc::clone(encoding),
        sequence: message.sequence,
        publish_time: message.publish_time,
        bytes: (!are_bytes_compared).then(|| message.data.into()),
    }
}

/// The encodings of a file's channels.
fn encodings(recording: &Recording) -> Vec<Arc<str>> {
    let channels = recording.channels().iter();
    channels
        .map(|channel| channel.encoding.as_str().into())
        .collect()
}

/// The topics of the table among these.
fn of_table(topics: &[String]) -> Topics {
    Topics::Only(topics.iter().filter_map(|name| Topic::find(name)).collect())
}

/// Collects messages into batches.
struct Posting<'a> {
    out: &'a SyncSender<Parcel>,
    batch: Batch,
    /// How much memory the messages of the batch take, bytes.
    memory: usize,
    is_open: bool,
}

impl Posting<'_> {
    /// Tells the fields of topics of the table, to those who don't know the table.
    fn announce(&mut self, topics: &[String]) {
        for (at, name) in topics.iter().enumerate() {
            let topic = Topic::find(name).map(Topic::info);
            let leaves = topic.into_iter().flat_map(|info| info.leaves());
            let names = leaves.map(|leaf| leaf.path.clone()).collect();
            self.batch.fields.push((at, names));
        }
    }

    /// Takes a message, and tells whether anybody wants another.
    fn push(&mut self, message: Item, bytes: u64) -> ControlFlow<()> {
        self.memory += message.memory();
        self.batch.messages.push(message);
        self.batch.bytes += bytes;
        if self.batch.messages.len() >= BATCH || self.memory >= LARGEST_BATCH {
            self.send();
        }
        if self.is_open {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    }

    fn send(&mut self) {
        let batch = std::mem::take(&mut self.batch);
        self.memory = 0;
        self.is_open = self.out.send(Parcel::Batch(batch)).is_ok();
    }
}

/// Reads the messages of a file of others.
fn read_payloads(
    recording: &Recording,
    topics: &[String],
    posting: &mut Posting<'_>,
    remarks: &mut Vec<String>,
) -> Ended {
    let positions: BTreeMap<&str, usize> = topics.iter().map(String::as_str).zip(0..).collect();
    let channels = recording.channels().iter();
    let mut sources: Vec<Option<Payloads>> = channels
        .map(|channel| {
            Some(Payloads::new(
                channel,
                *positions.get(channel.topic.as_str())?,
            ))
        })
        .collect();
    let mut known = KnownFields::new(topics.len());
    let encodings = encodings(recording);
    let mut reader = recording.reader(Selection::default()).in_order_of_time();
    while let Some(message) = reader.next_undecoded() {
        let Some(source) = &mut sources[message.position] else {
            continue;
        };
        let mut item = source.read(message.data, &mut known);
        (item.sequence, item.time_ns) = (message.sequence, message.log_time);
        let are_bytes_compared = item.rest.as_deref() == Some(message.data);
        let encoding = &encodings[message.position];
        item.written = Some(written(&message, encoding, are_bytes_compared));
        let new = std::mem::take(&mut source.new);
        if !new.is_empty() {
            posting.batch.fields.push((source.topic, new));
        }
        let bytes = reader.progress();
        if posting.push(item, bytes).is_break() {
            break;
        }
    }
    let sources = sources.iter().zip(recording.channels());
    remarks.extend(sources.filter_map(|(source, channel)| source.as_ref()?.remark(channel)));
    Ended {
        end: None,
        losses: Undecodable::default().losses(&reader),
    }
}

/// The fields of each topic that have come up so far.
struct KnownFields {
    /// For each topic, where its fields stand in the topic's rows.
    places: Vec<BTreeMap<String, usize>>,
    count: usize,
}

impl KnownFields {
    fn new(topics: usize) -> Self {
        Self {
            places: vec![BTreeMap::new(); topics],
            count: 0,
        }
    }

    /// Where a field stands in the rows of its topic, and whether it is new; none if there are too many fields.
    fn place(&mut self, topic: usize, field: &str) -> Option<(usize, bool)> {
        let places = &mut self.places[topic];
        if let Some(place) = places.get(field) {
            return Some((*place, false));
        }
        if self.count == MOST_FIELDS {
            return None;
        }
        self.count += 1;
        let place = places.len();
        places.insert(field.to_owned(), place);
        Some((place, true))
    }
}

/// The messages of a channel of a file.
struct Payloads {
    /// Its topic's position.
    topic: usize,
    /// What decodes them; none if nothing can.
    decoder: Option<PayloadDecoder>,
    values: Vec<Value>,
    /// Where its fields stand in the topic's rows.
    places: Vec<Option<usize>>,
    /// How long its rows must be.
    width: usize,
    /// Fields that are new to the topic.
    new: Vec<String>,
    /// The first message that can't be decoded although the channel can, and how many there are.
    malformed: Option<(String, u64)>,
    /// Messages that have more fields than are compared one by one.
    wide: u64,
}

impl Payloads {
    fn new(channel: &FileChannel, topic: usize) -> Self {
        Self {
            topic,
            decoder: channel.payload_decoder().ok(),
            values: Vec::new(),
            places: Vec::new(),
            width: 0,
            new: Vec::new(),
            malformed: None,
            wide: 0,
        }
    }

    /// Reads a message: its fields, or its bytes where they don't say it all.
    fn read(&mut self, data: &[u8], known: &mut KnownFields) -> Item {
        let mut item = Item {
            topic: self.topic,
            ..Item::default()
        };
        let is_long = data.len() > LONGEST_DECODED;
        let Some(decoder) = self.decoder.as_mut().filter(|_| !is_long) else {
            self.wide += u64::from(self.decoder.is_some());
            item.rest = Some(data.into());
            return item;
        };
        let decoded = decoder.decode(data, &mut self.values);
        let rest = decoder.unsaid(data).map(Into::into);
        self.place_fields(known);
        if let Err(error) = decoded {
            let (_, count) = self.malformed.get_or_insert((error.to_string(), 0));
            *count += 1;
            item.rest = Some(data.into());
            return item;
        }
        item.values = vec![Value::Absent; self.width];
        let mut is_wide = false;
        for (place, value) in self.places.iter().zip(&mut self.values) {
            match place {
                Some(place) => item.values[*place] = std::mem::take(value),
                None => is_wide |= !value.is_absent(),
            }
        }
        item.numbers = item.values.iter().map(Value::number).collect();
        item.rest = if is_wide { Some(data.into()) } else { rest };
        self.wide += u64::from(is_wide || item.rest.as_ref().is_some_and(|rest| **rest == *data));
        item
    }

    /// Finds the places of fields that have come up.
    fn place_fields(&mut self, known: &mut KnownFields) {
        let fields = self
            .decoder
            .as_ref()
            .map_or(&[][..], PayloadDecoder::fields);
        for field in &fields[self.places.len()..] {
            let place = known.place(self.topic, field);
            if let Some((_, true)) = place {
                self.new.push(field.clone());
            }
            let place = place.map(|(place, _)| place);
            self.width = self.width.max(place.map_or(0, |place| place + 1));
            self.places.push(place);
        }
    }

    /// What must be known of how its messages are compared.
    fn remark(&self, channel: &FileChannel) -> Option<String> {
        let topic = &channel.topic;
        match (&self.malformed, self.wide) {
            (Some((first, count)), _) => Some(format!(
                "{topic}: {count} messages are compared byte by byte, because they can't be decoded; the first is \
                 {first}"
            )),
            (None, 0) => None,
            (None, count) => Some(format!(
                "{topic}: {count} messages are compared byte by byte, because they are longer than {} MiB, have more than \
                 {MAX_FIELDS} fields or say something twice (no more than {MOST_FIELDS} fields of a file are compared one \
                 by one)",
                LONGEST_DECODED >> 20
            )),
        }
    }
}
