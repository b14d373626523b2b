//! Compares the messages of a file, in order of time, with those of a new run.

use super::difference::Difference;
use super::fingerprint::ChannelFingerprint;
use super::rerun::{Expected, Rerun};
use super::scope::Scope;
use crate::archive::format::Entries;
use crate::archive::recording::{Losses, Recording, Selection, Undecoded};
use crate::run::time::seconds;
use crate::telemetry::Topic;
use crate::telemetry::encoding::{DecodeError, Decoder, Row};
use crate::words::{counted, plural};
use std::collections::{BTreeMap, VecDeque};

/// The result of comparing messages.
#[derive(Default)]
pub(super) struct Compared {
    pub(super) equal: u64,
    /// Missing messages; none after a difference, as the rest is not compared.
    pub(super) missing: u64,
    /// Parts of the file that can't be read.
    pub(super) losses: Losses,
    pub(super) difference: Option<Difference>,
    /// The first message that is out of order among the messages of its channel and time.
    pub(super) out_of_order: Option<Difference>,
}

/// Comparison of a file with a new run.
pub(super) struct RerunComparison<'r> {
    recording: &'r Recording,
    rerun: Rerun<'r>,
    /// Whether encoded bytes are compared, or only values.
    scope: Scope,
    /// Whether the messages were logged at other times than those in them.
    is_relogged: bool,
    /// For each channel of the file, the index of the run's channel, if it has one.
    places: Vec<Option<usize>>,
    /// The decoder of each file channel that is in the table.
    decoders: Vec<Option<Decoder>>,
    /// The recorded and the simulated messages of each channel for viewers, by the run's channel, if the messages were
    /// logged at other times: which time they are of is not known then, so they are compared as a whole.
    views: BTreeMap<usize, [ChannelFingerprint; 2]>,
    /// Simulated messages not yet found in the file.
    ahead: VecDeque<Expected>,
    /// The time up to which everything has been simulated, ns.
    reached_ns: Option<u64>,
    /// Whether the run has been simulated to its end.
    is_over: bool,
    compared: Compared,
}

impl<'r> RerunComparison<'r> {
    pub(super) fn new(recording: &'r Recording, rerun: Rerun<'r>, scope: Scope) -> Self {
        let declared = &rerun.header.channels;
        let (mut places, mut decoders) = (Vec::new(), Vec::new());
        for channel in recording.channels() {
            places.push(declared.iter().position(|d| d.topic == channel.topic));
            decoders.push(channel.decoder().and_then(Result::ok));
        }
        Self {
            decoders,
            is_relogged: recording.relogged().is_some(),
            recording,
            rerun,
            scope,
            places,
            views: BTreeMap::new(),
            ahead: VecDeque::new(),
            reached_ns: None,
            is_over: false,
            compared: Compared::default(),
        }
    }

    /// Compares until the first difference. Also returns the end record of the run.
    pub(super) fn run(mut self, progress: &dyn Fn(u64)) -> (Compared, Entries) {
        let mut reader = self
            .recording
            .reader(Selection::default())
            .all_in_order_of_time();
        while let Some(recorded) = reader.next_undecoded() {
            self.take(&recorded);
            if self.compared.difference.is_some() {
                break;
            }
            progress(reader.progress());
        }
        // Also after a difference: what was lost until then may explain it.
        self.compared.losses = reader.all_losses();
        if self.compared.difference.is_some() {
            self.compared.missing = 0;
        } else if !self.recording.is_interrupted() {
            self.finish_run();
            if self.compared.losses.is_empty() {
                self.compared.difference = self.difference_of_views();
            }
        }
        (self.compared, self.rerun.end())
    }

    /// Compares a recorded message with that of the run.
    fn take(&mut self, recorded: &Undecoded<'_>) {
        let Some(channel) = self.places[recorded.position] else {
            // Fields and views of another version are compared as far as both have them; supplements don't follow from
            // the scenario.
            if self.scope == Scope::Bytes && !recorded.channel.is_supplement() {
                self.compared.difference = Some(mismatch(recorded, ""));
            }
            return;
        };
        if !self.compares_views() && recorded.channel.is_view() {
            let [of_file, _] = self.views.entry(channel).or_default();
            of_file.add_data(recorded.data);
            return;
        }
        let found = self
            .find(channel, recorded)
            .and_then(|place| Some((place, self.ahead.remove(place)?)));
        let Some((place, expected)) = found else {
            self.compared.difference = Some(mismatch(recorded, ""));
            return;
        };
        // Reading in order of time keeps the order of the file only within a topic.
        let mut earlier = self.ahead.iter().take(place);
        if earlier.any(|m| (m.channel, m.time_ns) == (channel, expected.time_ns)) {
            self.compared
                .out_of_order
                .get_or_insert_with(|| mismatch(recorded, "order of simultaneous messages"));
        }
        self.compared.difference = self.compare(recorded, &expected);
        self.compared.equal += u64::from(self.compared.difference.is_none());
    }

    fn compare(&self, recorded: &Undecoded<'_>, expected: &Expected) -> Option<Difference> {
        let times = [
            ("log time (ns)", recorded.log_time),
            ("publish time (ns)", recorded.publish_time),
        ];
        for (name, time) in times {
            if time != expected.time_ns && !self.is_relogged {
                let values = [time, expected.time_ns].map(|ns| Some(ns.to_string()));
                return Some(at(recorded, name, values));
            }
        }
        if recorded.data == expected.data {
            return None;
        }
        let decoder = self.decoders[recorded.position].as_ref();
        let (field, values) = match decoder.map(|decoder| first_field(decoder, recorded, expected))
        {
            Some(Ok(Some(found))) => found,
            Some(Ok(None)) if self.scope == Scope::Values => return None,
            Some(Err(error)) => (String::new(), [error.to_string(), "a message".to_owned()]),
            Some(Ok(None)) | None => (
                "encoded message".to_owned(),
                [recorded.data, &expected.data].map(describe_bytes),
            ),
        };
        Some(at(recorded, &field, values.map(Some)))
    }

    /// Finds the expected message for a recorded one, simulating only as far as necessary.
    fn find(&mut self, channel: usize, recorded: &Undecoded<'_>) -> Option<usize> {
        loop {
            self.skip_until(recorded.time_ns);
            let found = self.position(channel, recorded);
            let is_past = self
                .reached_ns
                .is_some_and(|reached| reached > recorded.time_ns);
            if found.is_some() || is_past || self.is_over {
                return found;
            }
            self.advance();
        }
    }

    /// The place of a recorded message among those that were simulated. Software that logs messages anew also numbers them
    /// anew: then their times tell, and of simultaneous ones their data.
    fn position(&self, channel: usize, recorded: &Undecoded<'_>) -> Option<usize> {
        let mut expected = self.ahead.iter();
        if !self.is_relogged {
            return expected.position(|e| e.channel == channel && e.sequence == recorded.sequence);
        }
        let mut simultaneous = expected
            .enumerate()
            .filter(|(_, e)| (e.channel, e.time_ns) == (channel, recorded.time_ns));
        let first = simultaneous.next()?;
        let mut all = std::iter::once(first).chain(simultaneous);
        let same = all.find(|(_, e)| e.data == recorded.data);
        Some(same.unwrap_or(first).0)
    }

    /// Simulates one more record.
    fn advance(&mut self) {
        let (ahead, views) = (&mut self.ahead, &mut self.views);
        let (header, is_relogged) = (self.rerun.header, self.is_relogged);
        let time = self.rerun.next(|expected| {
            let topic = header.channels[expected.channel].topic;
            if is_relogged && Topic::find(topic).is_none() {
                let [_, of_run] = views.entry(expected.channel).or_default();
                of_run.add_data(&expected.data);
            } else {
                ahead.push_back(expected);
            }
        });
        self.is_over = time.is_none();
        self.reached_ns = time.or(self.reached_ns);
    }

    /// Counts expected messages before `time_ns` as missing.
    fn skip_until(&mut self, time_ns: u64) {
        while let Some(passed) = self.ahead.pop_front_if(|m| m.time_ns < time_ns) {
            self.compared.missing += u64::from(self.is_expected(&passed));
        }
    }

    /// The first channel for viewers whose messages are not those of the run. Those of another version may differ.
    fn difference_of_views(&self) -> Option<Difference> {
        if self.scope == Scope::Values || !self.is_relogged {
            return None;
        }
        let differs =
            |(_, [of_file, of_run]): &(&usize, &[ChannelFingerprint; 2])| of_file != of_run;
        let (channel, both) = self.views.iter().find(differs)?;
        let topic = self.rerun.header.channels[*channel].topic;
        let texts = both.map(|of| Some(counted(of.messages, "message")));
        Some(Difference::new(topic, "messages as a whole", texts))
    }

    /// Whether messages for viewers are compared one by one: those of another version differ, and which time they are of
    /// is not known if they were logged at other times.
    fn compares_views(&self) -> bool {
        self.scope == Scope::Bytes && !self.is_relogged
    }

    /// Whether an expected message should be in the file.
    fn is_expected(&self, expected: &Expected) -> bool {
        let topic = self.rerun.header.channels[expected.channel].topic;
        // Recordings of another telemetry may lack topics of today's.
        self.compares_views()
            || Topic::find(topic).is_some_and(|topic| {
                self.recording.has_this_telemetry() || self.recording.has(topic)
            })
    }

    /// Simulates to the end and counts missing messages.
    fn finish_run(&mut self) {
        loop {
            let is_over = self.is_over;
            self.skip_until(u64::MAX);
            if is_over {
                return;
            }
            self.advance();
        }
    }
}

/// An unexpected message.
fn mismatch(recorded: &Undecoded<'_>, field: &str) -> Difference {
    let message = format!("message {}", recorded.sequence);
    at(recorded, field, [Some(message), None])
}

/// A difference in a message.
fn at(recorded: &Undecoded<'_>, field: &str, values: [Option<String>; 2]) -> Difference {
    Difference {
        time: Some(seconds(recorded.time_ns).to_string()),
        ..Difference::new(&recorded.channel.topic, field, values)
    }
}

/// The first field that differs, with the values in the file and of the run; fields missing in the file's schema are
/// ignored.
fn first_field(
    decoder: &Decoder,
    recorded: &Undecoded<'_>,
    expected: &Expected,
) -> Result<Option<(String, [String; 2])>, DecodeError> {
    let mut row = Row::default();
    decoder.decode(recorded.data, &mut row)?;
    let (Some(info), Some((numbers, texts))) = (recorded.channel.info(), &expected.values) else {
        return Ok(None);
    };
    let missing = &decoder.differences().missing;
    for (leaf, (a, b)) in info.numbers.iter().zip(row.numbers.iter().zip(numbers)) {
        // By bits, since −0 and 0 are other bytes, and NaN stands for a missing field.
        if a.to_bits() != b.to_bits() && !missing.contains(&leaf.path) {
            return Ok(Some((leaf.path.clone(), [a, b].map(|x| format!("{x:?}")))));
        }
    }
    for (leaf, (a, b)) in info.texts.iter().zip(row.texts.iter().zip(texts)) {
        if a != b && !missing.contains(&leaf.path) {
            return Ok(Some((leaf.path.clone(), [a, b].map(|x| format!("{x:?}")))));
        }
    }
    let times = [row.time_ns, expected.time_ns];
    let differs = times[0] != times[1];
    Ok(differs.then(|| {
        (
            "timestamp (s)".to_owned(),
            times.map(|time| seconds(time).to_string()),
        )
    }))
}

/// Length and checksum of an encoded message.
fn describe_bytes(data: &[u8]) -> String {
    let bytes = plural(data.len() as u64, "byte");
    format!(
        "{} {bytes}, crc32 {:08x}",
        data.len(),
        crc32fast::hash(data)
    )
}
