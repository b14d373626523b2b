//! Measured values from MCAP files: recordings of toprise, and JSON messages of other software.

use super::error::DataError;
use super::layout::Layout;
use super::member::{Lack, MemberPath, Stamp, member_names, parse};
use super::reading::{ColumnReading, FileReading, LOG_TIME, SkippedRows, TIME};
use super::rows::{Epoch, Row, Rows};
use super::spec::{SigmaSpec, SignalSpec, SpecFlaw};
use super::table::{FileSignals, read_twice};
use super::text::{MAX_ROWS, too_long};
use super::unit::{Dimension, Unit};
use crate::archive::recording::{Condition, ContentCheck, FileChannel, Recording, Selection};
use crate::run::time::seconds;
use crate::telemetry::fields::{NumberField, state};
use crate::telemetry::{Numbers as _, Topic, Topics};
use crate::words::{Piece, counted, sentence};
use std::path::Path;

/// The signals of an MCAP file.
pub(super) struct RecordedSignals {
    pub found: FileSignals,
    /// Whether the file is a recording of toprise.
    pub is_ours: bool,
    /// Parts that could not be read, in sentences, each once.
    pub losses: Vec<String>,
}

/// Where the values of a signal are.
enum SignalPlace {
    /// A field of toprise's channels, in SI units.
    Field(NumberField),
    /// A member of JSON messages.
    Member { topic: String, path: MemberPath },
}

impl SignalPlace {
    fn topic(&self) -> &str {
        match self {
            Self::Field(field) => field.topic().name(),
            Self::Member { topic, .. } => topic,
        }
    }

    /// Whether the values are those of another place.
    fn is_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Field(field), Self::Field(other)) => field == other,
            (
                Self::Member { path, .. },
                Self::Member {
                    path: other_path, ..
                },
            ) => self.topic() == other.topic() && path.is_same(other_path),
            (Self::Field(_) | Self::Member { .. }, _) => false,
        }
    }
}

/// Reads signals whose sources are `TOPIC.PATH`.
pub(super) fn read(
    path: &Path,
    file: usize,
    specs: &[SignalSpec],
    layout: &Layout,
    epoch: &mut Epoch,
) -> Result<RecordedSignals, DataError> {
    let recording =
        Recording::open(path).map_err(|reason| DataError::because(reason).in_file(path))?;
    let source = MessageSource {
        recording: &recording,
        path,
        layout,
    };
    let (mut signals, mut losses) = (Vec::new(), Vec::new());
    let mut reading = FileReading {
        file: path.display().to_string(),
        ..FileReading::default()
    };
    let mut left_out: Vec<SkippedRows> = Vec::new();
    for (spec, place) in source.places(specs)? {
        let unit = match &place {
            SignalPlace::Field(_) => None,
            SignalPlace::Member { path: member, .. } => member
                .unit(Dimension::from_si(spec.field.unit()))
                .map_err(|error| error.in_file(path).in_column(&spec.source))?,
        };
        let read = source.rows(&place, unit, epoch, &mut losses)?;
        let Some(signal) = read.rows.signal(&spec, file, 1, None)? else {
            return Err(source.no_values(&spec.source, &place, read.lack));
        };
        reading.columns.push(ColumnReading {
            column: spec.source.clone(),
            measures: spec.field.to_string(),
            unit: unit.map_or(spec.field.unit(), Unit::name).to_owned(),
            is_unit_assumed: matches!(place, SignalPlace::Member { .. })
                && unit.is_none()
                && !spec.field.unit().is_empty(),
            missing: signal.missing,
        });
        reading.rows = reading.rows.max(read.messages);
        for name in read.others {
            if !reading.unused.contains(&name) {
                reading.unused.push(name);
            }
        }
        left_out.extend(read.rows.left_out());
        signals.push(signal);
    }
    for spec in specs {
        reading.unused.retain(|name| *name != spec.source);
    }
    // Signals of one topic leave out the same messages.
    left_out.sort_by_key(|left_out| std::cmp::Reverse(left_out.rows));
    left_out.dedup_by_key(|left_out| left_out.reason);
    reading.left_out = left_out;
    reading.columns.insert(0, source.clock_reading()?);
    if recording.is_ours() {
        for fault in content_faults(&recording) {
            add_once(&mut losses, fault);
        }
    }
    Ok(RecordedSignals {
        found: FileSignals {
            signals,
            reading,
            known: topics(&recording),
        },
        is_ours: recording.is_ours(),
        losses,
    })
}

/// The messages of a file, and what is declared of them.
struct MessageSource<'a> {
    recording: &'a Recording,
    path: &'a Path,
    layout: &'a Layout,
}

/// The messages of a place.
struct PlaceRows {
    rows: Rows<'static>,
    messages: u64,
    /// Why the first JSON message without a value has none.
    lack: Option<Lack>,
    /// Members of JSON messages, with their topic.
    others: Vec<String>,
}

impl MessageSource<'_> {
    /// The places of the signals that the file has.
    fn places(&self, specs: &[SignalSpec]) -> Result<Vec<(SignalSpec, SignalPlace)>, DataError> {
        let path = self.path;
        if specs.is_empty() {
            let example = format!("{}:1mrad", state::THETA);
            return Err(DataError::new("no fields to fit are chosen")
                .in_file(path)
                .with_remedy(sentence!(
                    "choose the fields to fit, e.g. {}",
                    Piece::argument_with("signal", example)
                )));
        }
        let mut places: Vec<(SignalSpec, SignalPlace)> = Vec::new();
        for spec in specs {
            let find = |source: &str| find_place(self.recording, spec.field, source);
            // Members are not known before messages are read, so a colon belongs to a topic only if there is no other one.
            let found = match find(&spec.source) {
                Some(place) => Some((spec.clone(), place)),
                None => spec
                    .resolved(|source| find(source).is_some())
                    .and_then(|spec| Some((spec.clone(), find(&spec.source)?))),
            };
            let Some((spec, place)) = found else {
                continue;
            };
            // Messages have no columns: the text after the colon can only be meant as a number.
            if let SigmaSpec::Column(sigma) = &spec.sigma {
                return Err(SpecFlaw::Sigma(sigma.clone()).in_signal(&spec.source));
            }
            if places.iter().any(|(_, known)| place.is_same(known)) {
                return Err(read_twice(&spec.source).in_file(path));
            }
            places.push((spec, place));
        }
        Ok(places)
    }

    /// The member with the times, and its unit.
    fn clock(&self) -> Result<Option<(MemberPath, Option<&'static Unit>)>, DataError> {
        let Some(name) = &self.layout.time else {
            return Ok(None);
        };
        if self.recording.is_ours() {
            let problem = sentence!(
                "a recording of toprise has the times of the run: leave {} out",
                Piece::argument("time")
            );
            return Err(DataError::new(problem).in_file(self.path));
        }
        let member = MemberPath::parse(name);
        let unit = member
            .unit(Dimension::Time)
            .map_err(|error| error.in_file(self.path).in_column(name))?;
        Ok(Some((member, unit)))
    }

    fn clock_reading(&self) -> Result<ColumnReading, DataError> {
        let clock = self.clock()?;
        Ok(ColumnReading {
            column: match &self.layout.time {
                Some(name) => name.clone(),
                None if self.recording.is_ours() => TIME.to_owned(),
                None => LOG_TIME.to_owned(),
            },
            measures: TIME.to_owned(),
            unit: match &clock {
                Some((_, Some(unit))) => unit.name().to_owned(),
                Some((_, None)) | None => "s".to_owned(),
            },
            is_unit_assumed: matches!(clock, Some((_, None))),
            missing: 0,
        })
    }

    /// Reads the messages of a place.
    fn rows(
        &self,
        place: &SignalPlace,
        unit: Option<&'static Unit>,
        epoch: &mut Epoch,
        losses: &mut Vec<String>,
    ) -> Result<PlaceRows, DataError> {
        let topic = place.topic();
        let clock = self.clock()?;
        let mut reader = self.recording.reader(Selection {
            topics: Topics::Only(vec![topic.to_owned()]),
            ..Selection::default()
        });
        let mut read = PlaceRows {
            rows: Rows::new(None),
            messages: 0,
            lack: None,
            others: Vec::new(),
        };
        if clock.is_none() && !self.recording.is_ours() {
            // Log times count from the first message of the file, whatever its topic.
            let mut whole = self.recording.reader(Selection::default());
            let start = whole.next_undecoded().map_or(0, |first| first.log_time);
            epoch.seconds(start.into());
        }
        let mut undecodable = 0;
        loop {
            let cells = match place {
                SignalPlace::Field(field) => match reader.next() {
                    None => break,
                    Some(Err(error)) => {
                        add_once(losses, error.to_string());
                        continue;
                    }
                    Some(Ok(message)) => {
                        let numbers = message.numbers(field.topic());
                        let value = numbers.map(|numbers| numbers[field.index()]);
                        let time = if self.recording.is_ours() {
                            seconds(message.time_ns)
                        } else {
                            epoch.seconds(message.time_ns.into())
                        };
                        [Some(time), value.filter(|value| value.is_finite())]
                    }
                },
                SignalPlace::Member { path: member, .. } => match reader.next_undecoded() {
                    None => break,
                    Some(message) => {
                        let Some(json) = parse(message.data) else {
                            undecodable += 1;
                            continue;
                        };
                        if read.messages == 0 {
                            read.others = member_names(&json, &[]);
                        }
                        let time = match &clock {
                            None => Ok(Stamp::Nanoseconds(message.log_time.into())),
                            Some((member, unit)) => member.time(&json, *unit),
                        };
                        let value = member.number(&json);
                        for lack in [time.as_ref().err(), value.as_ref().err()] {
                            read.lack = read.lack.take().or_else(|| lack.cloned());
                        }
                        let time = time.ok().map(|time| match time {
                            Stamp::Nanoseconds(time) => epoch.seconds(time),
                            Stamp::Seconds(time) => time,
                        });
                        let factor = unit.map_or(1.0, |unit| unit.factor);
                        [time, value.ok().map(|value| value * factor)]
                    }
                },
            };
            read.messages += 1;
            if read.messages > MAX_ROWS as u64 {
                return Err(too_long().in_file(self.path));
            }
            read.rows.push(Row {
                line: 0,
                cells: cells.to_vec(),
            });
        }
        if undecodable > 0 {
            if read.messages == 0 {
                read.lack = Some(Lack::NoJson);
            }
            let messages = counted(undecodable, "message");
            add_once(losses, format!("{messages} of {topic}, no JSON"));
        }
        for loss in reader.all_losses().sentences() {
            add_once(losses, loss);
        }
        if self.recording.condition() == Condition::Interrupted {
            add_once(losses, "the end of the file, which is cut".to_owned());
        }
        for name in &mut read.others {
            *name = format!("{topic}.{name}");
        }
        read.rows.complete();
        Ok(read)
    }

    fn no_values(&self, source: &str, place: &SignalPlace, lack: Option<Lack>) -> DataError {
        let (what, reason) = match (place, lack) {
            (SignalPlace::Member { .. }, Some(lack)) => ("member", format!(": {lack}")),
            (SignalPlace::Member { .. }, None) => ("member", String::new()),
            (SignalPlace::Field(_), _) => ("field", String::new()),
        };
        DataError::new(format!("{what} {source} has no values{reason}")).in_file(self.path)
    }
}

/// What shows that a recording of toprise was altered, in sentences: only all messages together show it.
fn content_faults(recording: &Recording) -> Vec<String> {
    let mut check = ContentCheck::new(recording, &Topics::All);
    let mut reader = recording.reader(Selection::default()).in_order_of_time();
    while let Some(message) = reader.next() {
        check.take(&message);
    }
    check
        .finish(recording.end())
        .sentences(!reader.all_losses().is_empty())
}

/// The place that a source names, if the file has it.
fn find_place(recording: &Recording, field: NumberField, source: &str) -> Option<SignalPlace> {
    for channel in recording.channels() {
        let Some(path) = source
            .strip_prefix(&channel.topic)
            .and_then(|rest| rest.strip_prefix('.'))
        else {
            continue;
        };
        match table(recording, channel) {
            Some(topic) => {
                if let Some(field) = topic.numbers().find(|field| field.path() == path) {
                    return Some(SignalPlace::Field(field));
                }
            }
            None if channel.encoding == "json" => {
                return Some(SignalPlace::Member {
                    topic: channel.topic.clone(),
                    path: MemberPath::parse(path),
                });
            }
            None => {}
        }
    }
    // A field of toprise may be named by its path alone.
    let mut channels = recording.channels().iter();
    let is_recorded = channels.any(|channel| table(recording, channel) == Some(field.topic()));
    (source == field.path() && is_recorded).then_some(SignalPlace::Field(field))
}

/// The topic of toprise that a channel has. Other software may use the same names for JSON messages of its own.
fn table(recording: &Recording, channel: &FileChannel) -> Option<Topic> {
    let topic = channel.table?;
    let schema = channel.schema.as_ref();
    let is_typed = schema.is_some_and(|schema| schema.name == topic.info().schema);
    (recording.is_ours() || is_typed || channel.encoding != "json").then_some(topic)
}

/// Names of the topics that signals can be in.
fn topics(recording: &Recording) -> Vec<String> {
    let channels = recording.channels().iter();
    let readable = channels.filter(|c| c.table.is_some() || c.encoding == "json");
    let mut known: Vec<String> = readable
        .map(|channel: &FileChannel| channel.topic.clone())
        .collect();
    known.sort();
    known.dedup();
    known
}

/// Signals of one file share its losses.
fn add_once(losses: &mut Vec<String>, loss: String) {
    if !losses.contains(&loss) {
        losses.push(loss);
    }
}

#[cfg(test)]
mod tests {
    use super::super::data::{self, Data};
    use super::*;
    use crate::telemetry::fields::state;
    use std::collections::BTreeMap;
    use std::path::PathBuf;

    /// Reads a signal from a file with JSON messages of other software, one each 0.1 s.
    fn read_json(topic: &str, messages: &[&str], signal: &str) -> Result<Data, DataError> {
        read_laid_out(topic, messages, signal, &Layout::default())
    }

    fn read_laid_out(
        topic: &str,
        messages: &[&str],
        signal: &str,
        layout: &Layout,
    ) -> Result<Data, DataError> {
        let file = tempfile::Builder::new().suffix(".mcap").tempfile().unwrap();
        let mut writer = mcap::Writer::new(file.reopen().unwrap()).unwrap();
        let channel = writer
            .add_channel(0, topic, "json", &BTreeMap::new())
            .unwrap();
        for (at, message) in messages.iter().enumerate() {
            let header = mcap::records::MessageHeader {
                channel_id: channel,
                sequence: 0,
                log_time: 100_000_000 * at as u64,
                publish_time: 0,
            };
            writer
                .write_to_known_channel(&header, message.as_bytes())
                .unwrap();
        }
        writer.finish().unwrap();
        drop(writer);
        let files: Vec<PathBuf> = vec![file.path().to_owned()];
        data::read(&files, &[SignalSpec::parse(signal)?], layout)
    }

    #[test]
    fn says_why_members_have_no_numbers() {
        let camera = "/camera/pose";
        for (name, topic, message, signal, expected) in [
            (
                "another name",
                camera,
                r#"{"az":1,"tilt":2}"#,
                "theta=/camera/pose.roll",
                "member /camera/pose.roll has no values: the messages have: az, tilt",
            ),
            (
                "an outer member",
                camera,
                r#"{"az":{"deg":1}}"#,
                "theta=/camera/pose.az",
                "the messages have: az.deg",
            ),
            (
                "an element",
                camera,
                r#"{"v":[1,2]}"#,
                "theta=/camera/pose.v.7",
                "the messages have: v.0, v.1",
            ),
            (
                "text",
                camera,
                r#"{"tilt":"0.5"}"#,
                "theta=/camera/pose.tilt",
                r#"has no values: they are texts, e.g. "0.5", not numbers"#,
            ),
            (
                "null",
                camera,
                r#"{"tilt":null}"#,
                "theta=/camera/pose.tilt",
                "has no values: they are null",
            ),
            (
                "no JSON",
                camera,
                "{bad",
                "theta=/camera/pose.tilt",
                "member /camera/pose.tilt has no values: the messages are no JSON",
            ),
            (
                "no topic",
                "/cam",
                r#"{"tilt":1}"#,
                "theta=/camm.tilt",
                "no column or topic /camm.tilt; there is: /cam (did you mean /cam?)",
            ),
            (
                "a topic without member",
                "/cam",
                r#"{"tilt":1}"#,
                "theta=/cam",
                "/cam is a topic: name a value in its messages, /cam.NAME",
            ),
        ] {
            let error = read_json(topic, &[message; 3], signal).unwrap_err();
            let message = error.to_string();
            assert!(message.contains(expected), "{name}: {message}");
        }
    }

    #[test]
    fn reads_json_of_other_software_on_topics_of_toprise() {
        for signal in ["/top/state.theta:1mrad", "theta=/top/state.theta:1mrad"] {
            let data = read_json("/top/state", &[r#"{"theta":0.5}"#; 3], signal).unwrap();
            let [found] = &data.signals[..] else {
                panic!("{signal}: not one signal");
            };
            assert_eq!(found.field, state::THETA, "{signal}");
            assert_eq!(found.values, [0.5; 3], "{signal}");
        }
    }

    #[test]
    fn lists_messages_that_are_no_json_as_losses() {
        let messages = [
            r#"{"tilt":0.5}"#,
            "{bad",
            r#"{"tilt":null}"#,
            r#"{"tilt":0.4}"#,
        ];
        let data = read_json("/cam", &messages, "theta=/cam.tilt").unwrap();
        assert_eq!(data.signals[0].values, [0.5, 0.4]);
        assert_eq!(data.signals[0].missing, 1);
        let [loss] = &data.losses[..] else {
            panic!("not one loss: {:?}", data.losses);
        };
        assert!(loss.ends_with("1 message of /cam, no JSON"), "{loss}");
    }

    #[test]
    fn finds_topics_with_colons() {
        let data = read_json("/cam:1", &[r#"{"tilt":0.5}"#; 3], "theta=/cam:1.tilt").unwrap();
        assert_eq!(data.signals[0].values, [0.5; 3]);
    }

    #[test]
    fn takes_times_from_members() {
        let messages = [
            r#"{"timestamp":{"sec":1700000000,"nsec":0},"tilt":0.5,"az":1}"#,
            r#"{"timestamp":{"sec":1700000000,"nsec":90000000},"tilt":0.4,"az":1}"#,
            r#"{"timestamp":null,"tilt":0.3,"az":1}"#,
            r#"{"timestamp":{"sec":1700000000,"nsec":90000000},"tilt":0.4,"az":1}"#,
        ];
        let layout = Layout::with_time("timestamp");
        let data = read_laid_out("/cam", &messages, "theta=/cam.tilt", &layout).unwrap();
        assert_eq!(data.signals[0].times, [0.0, 0.09]);
        let [reading] = &data.files[..] else {
            panic!("{:?}", data.files);
        };
        let sentence = reading.sentence().to_string();
        assert!(
            sentence.ends_with(
                "timestamp is the time (no unit: s) and /cam.tilt is /top/state.theta (no unit: rad); 4 rows. \
                 Not used: /cam.timestamp, /cam.az. Without a time: 1 row. \
                 Equal to another row, and counted once: 1 row."
            ),
            "{sentence}"
        );
    }
}
