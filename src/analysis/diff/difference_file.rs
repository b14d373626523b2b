//! The differences of two runs as an MCAP file: each channel of the table with B − A in its fields.

use super::observer::Observer;
use super::report::Report;
use crate::analysis::subject::Subject;
use crate::archive::format::{Entries, SCENARIO_ATTACHMENT, scenario_attachment};
use crate::archive::publish::{Draft, Existing};
use crate::archive::sink::SinkError;
use crate::archive::writer::{Archived, Ending, McapSink, Opening, RawChannel, RawMessage};
use crate::telemetry::encoding::{Encoder, Encoding};
use crate::telemetry::fields::EVENTS;
use crate::telemetry::side::Side;
use crate::telemetry::{Message, Topic, Version};
use std::path::Path;

/// Name of the metadata records at the start and at the end of a file of differences.
pub const DIFF_RECORD: &str = "toprise.diff";
/// The library field of such files, which are no recordings.
const LIBRARY: &str = concat!("toprise-diff/", env!("CARGO_PKG_VERSION"));

/// Writes the differences of two runs into an MCAP file.
///
/// For each channel of the table that both have, but for events, there is `/diff` + topic; for the events of A
/// and B there are `/a/events` and `/b/events`. Messages are of the same types as in recordings. The file ends
/// with the report: as sentences, and whole as JSON.
#[derive(Debug)]
pub struct DifferenceFile {
    sink: McapSink,
    encoder: Encoder,
    /// The channel of the file for the differences of each channel of the table.
    differences: Vec<Option<usize>>,
    /// The channels of the file for the events of A and of B.
    events: [usize; 2],
    buffer: Vec<u8>,
}

impl DifferenceFile {
    /// Begins the file.
    ///
    /// # Errors
    /// [`SinkError`] if it can't be made.
    pub fn create(
        path: &Path,
        existing: Existing,
        encoding: Encoding,
        [a, b]: [Subject<'_>; 2],
    ) -> Result<Self, SinkError> {
        let mut raw = Vec::new();
        let mut add = |prefix: &str, topic: Topic, meaning: &str| {
            raw.push(raw_channel(prefix, topic, encoding, meaning));
            raw.len() - 1
        };
        let is_common = |topic| a.has_topic(topic) && b.has_topic(topic) && topic != EVENTS;
        let differences = Topic::all()
            .map(|topic| is_common(topic).then(|| add("/diff", topic, "B − A")))
            .collect();
        let events = [("/a", "events of A"), ("/b", "events of B")]
            .map(|(prefix, meaning)| add(prefix, EVENTS, meaning));
        let opening = Opening {
            library: LIBRARY,
            metadata: vec![(DIFF_RECORD.to_owned(), names(a, b))],
            attachments: [(a, "a"), (b, "b")]
                .iter()
                .filter_map(|(subject, letter)| {
                    let mut attachment = scenario_attachment(subject.scenario()?.to_toml());
                    attachment.name = format!("{letter}.{SCENARIO_ATTACHMENT}");
                    Some(attachment)
                })
                .collect(),
            version: Version::default(),
            encoding,
            wanted: vec![false; Topic::all().len()],
            raw,
        };
        Ok(Self {
            sink: McapSink::open(Draft::new(path, existing)?, &opening)?,
            encoder: Encoder::new(encoding),
            differences,
            events,
            buffer: Vec::new(),
        })
    }

    fn write(&mut self, channel: usize, message: &Message<'_>) -> Result<(), SinkError> {
        self.buffer.clear();
        self.encoder.encode(message, &mut self.buffer);
        self.sink.write_raw(&RawMessage {
            channel,
            sequence: message.sequence,
            log_time: message.time_ns,
            publish_time: message.time_ns,
            data: &self.buffer,
        })
    }

    /// Ends the file with the report and gives it its name.
    ///
    /// # Errors
    /// [`SinkError`] if anything could not be written.
    pub fn finish(self, report: &Report) -> Result<Archived, SinkError> {
        let mut entries = Entries::new();
        entries.insert("summary".to_owned(), report.summary.join(" "));
        // Reports have nothing that JSON lacks.
        let json = serde_json::to_string(report).unwrap_or_default();
        entries.insert("report".to_owned(), json);
        self.sink.finish_with(Ending {
            metadata: vec![(DIFF_RECORD.to_owned(), entries)],
            ..Ending::default()
        })
    }
}

impl Observer for DifferenceFile {
    fn message(&mut self, side: Side, message: &Message<'_>) -> Result<(), SinkError> {
        if message.topic() != EVENTS {
            return Ok(());
        }
        self.write(self.events[side.index()], message)
    }

    fn difference(&mut self, message: &Message<'_>) -> Result<(), SinkError> {
        match self.differences[message.channel] {
            Some(channel) => self.write(channel, message),
            None => Ok(()),
        }
    }
}

fn raw_channel(prefix: &str, topic: Topic, encoding: Encoding, meaning: &str) -> RawChannel {
    let info = topic.info();
    RawChannel {
        topic: format!("{prefix}{topic}"),
        encoding: encoding.name().to_owned(),
        schema: Some((
            info.schema.to_owned(),
            encoding.schema_encoding().to_owned(),
            encoding.schema(info),
        )),
        metadata: Entries::from([("meaning".to_owned(), meaning.to_owned())]),
    }
}

/// The entries of the record at the start of the file.
fn names(a: Subject<'_>, b: Subject<'_>) -> Entries {
    let entry = |key: &str, value: String| (key.to_owned(), value);
    let digest = |subject: Subject<'_>| subject.scenario().map(|scenario| scenario.digest());
    Entries::from([
        entry("a", a.name()),
        entry("b", b.name()),
        entry("a_scenario_digest", digest(a).unwrap_or_default()),
        entry("b_scenario_digest", digest(b).unwrap_or_default()),
        entry("epoch", "simulation start".to_owned()),
    ])
}
