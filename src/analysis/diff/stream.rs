//! The messages of a run as they come: out of a file, or out of a simulation.
//!
//! Each run is read by a thread of its own, which hands over batches.

use super::Subject;
use crate::analysis::subject::{Ended, Undecodable};
use crate::archive::memory::Owned;
use crate::archive::recording::{FileChannel, NumberDecoder, Recording, Selection};
use crate::telemetry::channels;
use crate::telemetry::{Topic, Topics};
use std::ops::ControlFlow;
use std::sync::mpsc::SyncSender;

/// Messages in a batch.
const BATCH: usize = 1024;

/// Messages of one run.
#[derive(Debug, Default)]
pub(super) struct Batch {
    /// The messages; their channels are positions in the list of topics.
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

/// What to read of a run.
#[derive(Clone, Copy, Debug)]
pub(super) enum Wanted<'a> {
    /// These topics of the table, as the table has them.
    Table(&'a [String]),
    /// The numbers of these topics, whatever they are.
    Numbers(&'a [String]),
}

/// Reads a run to its end. It ends early when nobody takes its batches any more.
pub(super) fn read(subject: Subject<'_>, wanted: Wanted<'_>, out: &SyncSender<Parcel>) {
    let mut posting = Posting {
        out,
        batch: Batch::default(),
        is_open: true,
    };
    let ended = match (subject, wanted) {
        (subject, Wanted::Table(topics)) => subject
            .read(&of_table(topics), &mut |message, bytes| {
                posting.push(Owned::from(message), bytes)
            }),
        (Subject::Recording(recording), Wanted::Numbers(topics)) => {
            read_numbers(recording, topics, &mut posting)
        }
        (Subject::Scenario(_), Wanted::Numbers(topics)) => {
            posting.announce(topics);
            subject.read(&of_table(topics), &mut |message, bytes| {
                // The channels of other files are numbered as they come.
                let topic = channels()[message.channel].topic;
                let position = topics.iter().position(|t| t == topic);
                let owned = Owned {
                    channel: position.unwrap_or_default(),
                    ..Owned::from(message)
                };
                posting.push(owned, bytes)
            })
        }
    };
    posting.send();
    let _ = out.send(Parcel::End(ended));
}

/// The topics of the table among these.
fn of_table(topics: &[String]) -> Topics {
    Topics::Only(
        topics
            .iter()
            .filter_map(|topic| Topic::find(topic))
            .collect(),
    )
}

/// Collects messages into batches.
struct Posting<'a> {
    out: &'a SyncSender<Parcel>,
    batch: Batch,
    is_open: bool,
}

impl Posting<'_> {
    /// Tells the fields of topics of the table, to those who don't know the table.
    fn announce(&mut self, topics: &[String]) {
        for (at, topic) in topics.iter().enumerate() {
            let info = channels().iter().find(|info| info.topic == topic);
            let numbers = info.map_or(&[][..], |info| &info.numbers);
            let names = numbers.iter().map(|leaf| leaf.path.clone()).collect();
            self.batch.fields.push((at, names));
        }
    }

    /// Takes a message, and tells whether anybody wants another.
    fn push(&mut self, message: Owned, bytes: u64) -> ControlFlow<()> {
        self.batch.messages.push(message);
        self.batch.bytes += bytes;
        if self.batch.messages.len() >= BATCH {
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
        self.is_open = self.out.send(Parcel::Batch(batch)).is_ok();
    }
}

/// A channel of a file that is not ours.
struct Source {
    /// Its topic's position.
    topic: usize,
    decoder: NumberDecoder,
    /// Where its fields stand among the topic's.
    places: Vec<usize>,
}

fn read_numbers(recording: &Recording, topics: &[String], posting: &mut Posting<'_>) -> Ended {
    let mut undecodable = Undecodable::default();
    let mut sources: Vec<_> = recording
        .channels()
        .iter()
        .map(|channel| source(channel, topics, &mut undecodable))
        .collect();
    let mut fields: Vec<Vec<String>> = vec![Vec::new(); topics.len()];
    let mut values = Vec::new();
    let selection = Selection {
        topics: Topics::Only(topics.to_vec()),
        ..Selection::default()
    };
    let mut reader = recording.reader(selection).in_order_of_time();
    while let Some(message) = reader.next_undecoded() {
        let Some(source) = &mut sources[message.position] else {
            continue;
        };
        if let Err(error) = source.decoder.decode(message.data, &mut values) {
            undecodable.add(format!("{}: {error}", message.channel.topic));
            continue;
        }
        let known = &mut fields[source.topic];
        let before = known.len();
        source.place(known);
        if known.len() > before {
            posting
                .batch
                .fields
                .push((source.topic, known[before..].to_vec()));
        }
        let mut numbers = vec![f64::NAN; known.len()];
        for (place, value) in source.places.iter().zip(&values) {
            numbers[*place] = *value;
        }
        let owned = Owned {
            channel: source.topic,
            sequence: message.sequence,
            time_ns: message.log_time,
            numbers,
            texts: Vec::new(),
        };
        let bytes = reader.progress();
        if posting.push(owned, bytes).is_break() {
            break;
        }
    }
    let left_out = sources
        .iter()
        .flatten()
        .map(|source| source.decoder.left_out());
    let left_out: u64 = left_out.sum();
    let mut losses = undecodable.losses(&reader);
    if left_out > 0 {
        losses.push("numbers of messages with more than 4096 fields".to_owned());
    }
    Ended { end: None, losses }
}

fn source(
    channel: &FileChannel,
    topics: &[String],
    undecodable: &mut Undecodable,
) -> Option<Source> {
    let topic = topics.iter().position(|topic| *topic == channel.topic)?;
    match NumberDecoder::new(channel) {
        Ok(decoder) => Some(Source {
            topic,
            decoder,
            places: Vec::new(),
        }),
        Err(error) => {
            undecodable.add(format!("{}: {error}", channel.topic));
            None
        }
    }
}

impl Source {
    /// Finds the places of fields that have come up, among those of the topic.
    fn place(&mut self, known: &mut Vec<String>) {
        for field in &self.decoder.fields()[self.places.len()..] {
            let place = known.iter().position(|name| name == field);
            self.places.push(place.unwrap_or_else(|| {
                known.push(field.clone());
                known.len() - 1
            }));
        }
    }
}

/// The names of the table's topics, in its order: what the channels of messages stand for.
pub(super) fn table_topics() -> Vec<String> {
    channels()
        .iter()
        .map(|channel| channel.topic.to_owned())
        .collect()
}
