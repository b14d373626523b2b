//! The messages of one run as they come: out of a file, or out of a simulation.

use crate::analysis::subject::{Ended, Subject, Undecodable};
use crate::archive::memory::Owned;
use crate::archive::recording::{FileChannel, NumberDecoder, Recording, Selection};
use crate::telemetry::{Topic, Topics};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::mpsc::SyncSender;

/// Messages in a batch.
const BATCH: usize = 1024;
/// Numbers in a batch: wide messages make it shorter.
const NUMBERS: usize = 1 << 16;
/// No more fields of a file than these are compared, in all topics together.
const MOST_FIELDS: usize = 1 << 18;

/// Messages of one run.
#[derive(Debug, Default)]
pub(super) struct Batch {
    /// The messages; their channels are positions in the plan's list of topics.
    pub(super) messages: Vec<Owned>,
    /// Fields that came up with them: a topic, and the fields behind those known so far.
    pub(super) fields: Vec<(usize, Vec<String>)>,
    /// How many more bytes of the file have been read.
    pub(super) bytes: u64,
}

/// What comes out of a run.
#[derive(Debug)]
pub(super) enum Parcel {
    Batch(Batch),
    End(Ended),
}

/// Reads these topics of a run to its end, or until nobody takes its batches any more.
///
/// Messages of two runs of toprise (`are_ours`) are read as the telemetry table has them; else their numbers,
/// whatever they are.
pub(super) fn read(run: Subject<'_>, are_ours: bool, topics: &[String], out: &SyncSender<Parcel>) {
    let mut posting = Posting {
        out,
        batch: Batch::default(),
        numbers: 0,
        is_open: true,
    };
    let ended = match run {
        run if are_ours => run.read(&of_table(topics), &mut |message, bytes| {
            posting.push(Owned::from(message), bytes)
        }),
        Subject::Recording(recording) => read_numbers(recording, topics, &mut posting),
        Subject::Scenario(_) => {
            posting.announce(topics);
            let position = |topic: Topic| topics.iter().position(|name| name == topic.name());
            let positions: Vec<_> = Topic::all().map(position).collect();
            run.read(&of_table(topics), &mut |message, bytes| {
                let Some(channel) = positions[message.channel] else {
                    return ControlFlow::Continue(());
                };
                posting.push(
                    Owned {
                        channel,
                        ..Owned::from(message)
                    },
                    bytes,
                )
            })
        }
    };
    posting.send();
    let _ = out.send(Parcel::End(ended));
}

/// The topics of the table among these.
fn of_table(topics: &[String]) -> Topics {
    Topics::Only(topics.iter().filter_map(|name| Topic::find(name)).collect())
}

/// Collects messages into batches.
struct Posting<'a> {
    out: &'a SyncSender<Parcel>,
    batch: Batch,
    /// How many numbers are in the batch.
    numbers: usize,
    is_open: bool,
}

impl Posting<'_> {
    /// Tells the fields of topics of the table, to those who don't know the table.
    fn announce(&mut self, topics: &[String]) {
        for (at, name) in topics.iter().enumerate() {
            let numbers = Topic::find(name).into_iter().flat_map(Topic::numbers);
            let names = numbers.map(|number| number.path().to_owned()).collect();
            self.batch.fields.push((at, names));
        }
    }

    /// Takes a message, and tells whether anybody wants another.
    fn push(&mut self, message: Owned, bytes: u64) -> ControlFlow<()> {
        self.numbers += message.numbers.len();
        self.batch.messages.push(message);
        self.batch.bytes += bytes;
        if self.batch.messages.len() >= BATCH || self.numbers >= NUMBERS {
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
        self.numbers = 0;
        self.is_open = self.out.send(Parcel::Batch(batch)).is_ok();
    }
}

/// Reads the numbers of a file.
fn read_numbers(recording: &Recording, topics: &[String], posting: &mut Posting<'_>) -> Ended {
    let mut undecodable = Undecodable::default();
    let positions: BTreeMap<&str, usize> = topics.iter().map(String::as_str).zip(0..).collect();
    let channels = recording.channels().iter();
    let mut sources: Vec<Option<ChannelNumbers>> = channels
        .map(|channel| {
            let topic = *positions.get(channel.topic.as_str())?;
            ChannelNumbers::new(channel, topic, &mut undecodable)
        })
        .collect();
    let mut known = KnownFields::new(topics.len());
    let mut values = Vec::new();
    let mut reader = recording.reader(Selection::default()).in_order_of_time();
    while let Some(message) = reader.next_undecoded() {
        let Some(source) = &mut sources[message.position] else {
            continue;
        };
        if let Err(error) = source.decoder.decode(message.data, &mut values) {
            undecodable.add(format!("{}: {error}", message.channel.topic));
            continue;
        }
        let new = source.place_fields(&mut known);
        if !new.is_empty() {
            posting.batch.fields.push((source.topic, new));
        }
        let owned = Owned {
            channel: source.topic,
            sequence: message.sequence,
            time_ns: message.log_time,
            numbers: source.row(&values),
            texts: Vec::new(),
        };
        let bytes = reader.progress();
        if posting.push(owned, bytes).is_break() {
            break;
        }
    }
    let mut losses = undecodable.losses(&reader);
    let left_out = |source: &ChannelNumbers| source.decoder.left_out() > 0;
    if sources.iter().flatten().any(left_out) {
        losses.push("numbers of messages with more than 4096 fields".to_owned());
    }
    if known.left_out {
        losses.push(format!("fields beyond the first {MOST_FIELDS}"));
    }
    Ended { end: None, losses }
}

/// The fields of each topic that have come up so far.
struct KnownFields {
    /// For each topic, where its fields stand in the topic's rows.
    places: Vec<BTreeMap<String, usize>>,
    count: usize,
    /// Whether there were too many.
    left_out: bool,
}

impl KnownFields {
    fn new(topics: usize) -> Self {
        Self {
            places: vec![BTreeMap::new(); topics],
            count: 0,
            left_out: false,
        }
    }

    /// Where a field stands in the rows of its topic, and whether it is new; none if there are too many fields.
    fn place(&mut self, topic: usize, field: &str) -> Option<(usize, bool)> {
        let places = &mut self.places[topic];
        if let Some(place) = places.get(field) {
            return Some((*place, false));
        }
        if self.count == MOST_FIELDS {
            self.left_out = true;
            return None;
        }
        self.count += 1;
        let place = places.len();
        places.insert(field.to_owned(), place);
        Some((place, true))
    }
}

/// The numbers of a channel of a file.
struct ChannelNumbers {
    /// Its topic's position.
    topic: usize,
    decoder: NumberDecoder,
    /// Where its fields stand in the topic's rows.
    places: Vec<Option<usize>>,
    /// How long its rows must be.
    width: usize,
}

impl ChannelNumbers {
    fn new(channel: &FileChannel, topic: usize, undecodable: &mut Undecodable) -> Option<Self> {
        match NumberDecoder::new(channel) {
            Ok(decoder) => Some(Self {
                topic,
                decoder,
                places: Vec::new(),
                width: 0,
            }),
            Err(error) => {
                undecodable.add(format!("{}: {error}", channel.topic));
                None
            }
        }
    }

    /// Finds the places of fields that have come up, and gives those that are new to the topic.
    fn place_fields(&mut self, known: &mut KnownFields) -> Vec<String> {
        let mut new = Vec::new();
        for field in &self.decoder.fields()[self.places.len()..] {
            let place = known.place(self.topic, field);
            if let Some((_, true)) = place {
                new.push(field.clone());
            }
            let place = place.map(|(place, _)| place);
            self.width = self.width.max(place.map_or(0, |place| place + 1));
            self.places.push(place);
        }
        new
    }

    /// The values of a message as a row of its topic.
    fn row(&self, values: &[f64]) -> Vec<f64> {
        let mut row = vec![f64::NAN; self.width];
        for (place, value) in self.places.iter().zip(values) {
            if let Some(place) = place {
                row[*place] = *value;
            }
        }
        row
    }
}
