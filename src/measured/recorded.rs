//! Measured values from MCAP files: recordings of toprise, and JSON messages of other software.

use super::error::DataError;
use super::signal::{FileSignals, SigmaSpec, Signal, SignalRow, SignalSpec, SpecFlaw};
use super::table::{MAX_ROWS, MAX_SHOWN, read_twice, too_long};
use super::unit::{Dimension, split_header};
use crate::archive::recording::{Condition, ContentCheck, FileChannel, Recording, Selection};
use crate::run::time::seconds;
use crate::telemetry::fields::{NumberField, state};
use crate::telemetry::{Numbers as _, Topic, Topics};
use crate::words::{Piece, counted, sentence};
use serde_json::Value as Json;
use std::path::Path;
use thiserror::Error;

/// The signals of an MCAP file.
pub(super) struct RecordedSignals {
    pub found: FileSignals,
    /// Whether the file is a recording of toprise.
    pub is_ours: bool,
    /// Parts that could not be read, in sentences, each once.
    pub losses: Vec<String>,
}

/// Where the values of a signal are.
#[derive(PartialEq)]
enum SignalPlace {
    /// A field of toprise's channels, in SI units.
    Field(NumberField),
    /// A member of JSON messages: topic, and names from the outside in. The last one may have a unit as in a header.
    Json(String, Vec<String>),
}

impl SignalPlace {
    /// The unit that is given for the values; may be empty.
    fn unit(&self) -> &str {
        match self {
            Self::Field(field) => field.unit(),
            Self::Json(_, names) => names.last().map_or("", |name| split_header(name).1),
        }
    }

    /// Whether the values are those of another place, also if only one of them has a unit.
    fn has_values_of(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Json(topic, names), Self::Json(other_topic, other_names)) => {
                topic == other_topic && without_unit(names) == without_unit(other_names)
            }
            (place, other) => place == other,
        }
    }
}

/// The names of a member from the outside in, without unit.
fn without_unit(names: &[String]) -> Option<(&str, &[String])> {
    let (last, outer) = names.split_last()?;
    Some((split_header(last).0, outer))
}

/// Reads signals whose sources are `TOPIC.PATH`.
pub(super) fn read(
    path: &Path,
    file: usize,
    specs: &[SignalSpec],
) -> Result<RecordedSignals, DataError> {
    let recording =
        Recording::open(path).map_err(|reason| DataError::because(reason).in_file(path))?;
    if specs.is_empty() {
        let example = format!("{}:1mrad", state::THETA);
        let remedy = sentence!(
            "choose the fields to fit, e.g. {}",
            Piece::argument_with("signal", example)
        );
        return Err(DataError::new("no fields to fit are chosen")
            .in_file(path)
            .with_remedy(remedy));
    }
    let mut places = Vec::new();
    for spec in specs {
        let unsplit = spec.unsplit();
        // Members are not known before messages are read: a colon belongs to a topic only if there is no other one.
        let found = [Some(spec), unsplit.as_ref()]
            .into_iter()
            .flatten()
            .find_map(|spec| Some((spec.clone(), find_place(&recording, spec)?)));
        let Some((spec, place)) = found else {
            continue;
        };
        // Messages have no columns: the text after the colon can only be meant as a number.
        if let SigmaSpec::Column(sigma) = &spec.sigma {
            return Err(SpecFlaw::Sigma(sigma.clone()).in_signal(&spec.source));
        }
        if places.iter().any(|(_, known)| place.has_values_of(known)) {
            return Err(read_twice(&spec.source).in_file(path));
        }
        places.push((spec, place));
    }
    let mut signals = Vec::new();
    let mut losses = Vec::new();
    for (spec, place) in places {
        let PlaceRows { rows, lack } = rows(&recording, path, &place, &mut losses)?;
        let factor = match &place {
            SignalPlace::Field(_) => 1.0,
            SignalPlace::Json(..) => Dimension::from_si(spec.field.unit())
                .factor(place.unit(), &spec.source)
                .map_err(|error| error.in_file(path))?,
        };
        let (mut found, mut missing) = (Vec::new(), 0);
        for (time, value) in rows {
            match value {
                Some(value) => found.push(SignalRow {
                    time,
                    value: value * factor,
                    sigma: None,
                    line: 0,
                }),
                None => missing += 1,
            }
        }
        if found.is_empty() {
            return Err(no_values(path, &spec.source, &place, lack));
        }
        let is_unit_known = match &place {
            SignalPlace::Field(_) => true,
            SignalPlace::Json(..) => !place.unit().is_empty(),
        };
        signals.push(Signal {
            is_unit_known,
            ..Signal::new(&spec, file, found, missing, None)?
        });
    }
    if recording.is_ours() {
        for fault in content_faults(&recording) {
            add_once(&mut losses, fault);
        }
    }
    Ok(RecordedSignals {
        found: FileSignals {
            signals,
            known: topics(&recording),
        },
        is_ours: recording.is_ours(),
        losses,
    })
}

fn no_values(path: &Path, source: &str, place: &SignalPlace, lack: Option<Lack>) -> DataError {
    let (what, reason) = match (place, lack) {
        (SignalPlace::Json(..), Some(lack)) => ("member", format!(": {lack}")),
        (SignalPlace::Json(..), None) => ("member", String::new()),
        (SignalPlace::Field(_), _) => ("field", String::new()),
    };
    DataError::new(format!("{what} {source} has no values{reason}")).in_file(path)
}

/// Why a member of a JSON message is no number.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
enum Lack {
    /// There is no such member, or it has members itself.
    #[error("the messages have: {}", known.join(", "))]
    Absent {
        /// Paths of the members where it should be.
        known: Vec<String>,
    },
    #[error("they are texts, e.g. {0:?}, not numbers")]
    Text(String),
    #[error("they are null")]
    Null,
    #[error("the messages are no JSON")]
    NoJson,
    #[error("they are true or false, not numbers")]
    Boolean,
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
fn find_place(recording: &Recording, spec: &SignalSpec) -> Option<SignalPlace> {
    let source = &spec.source;
    for channel in recording.channels() {
        let Some(rest) = source.strip_prefix(&channel.topic) else {
            continue;
        };
        let Some(path) = rest.strip_prefix('.') else {
            continue;
        };
        match table(recording, channel) {
            Some(topic) => {
                if let Some(field) = topic.numbers().find(|field| field.path() == path) {
                    return Some(SignalPlace::Field(field));
                }
            }
            None if channel.encoding == "json" => {
                let names = path.split('.').map(str::to_owned).collect();
                return Some(SignalPlace::Json(channel.topic.clone(), names));
            }
            None => {}
        }
    }
    // A field of toprise may be named by its path alone.
    let field = spec.field;
    let mut channels = recording.channels().iter();
    let is_recorded = channels.any(|channel| table(recording, channel) == Some(field.topic()));
    (*source == field.path() && is_recorded).then_some(SignalPlace::Field(field))
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

/// The messages of a place.
struct PlaceRows {
    /// Times (s) and values; no value where it is missing or not a number.
    rows: Vec<(f64, Option<f64>)>,
    /// Why the first JSON message without a value has none.
    lack: Option<Lack>,
}

/// Reads the messages of a place.
fn rows(
    recording: &Recording,
    path: &Path,
    place: &SignalPlace,
    losses: &mut Vec<String>,
) -> Result<PlaceRows, DataError> {
    let topic = match place {
        SignalPlace::Field(field) => field.topic().name().to_owned(),
        SignalPlace::Json(topic, _) => topic.clone(),
    };
    let mut reader = recording.reader(Selection {
        topics: Topics::Only(vec![topic.clone()]),
        ..Selection::default()
    });
    let mut rows: Vec<(f64, Option<f64>)> = Vec::new();
    let (mut lack, mut undecodable) = (None, 0_u64);
    // Times since the epoch have no fraction of a microsecond as doubles: they count from the file's first message.
    let mut whole = recording.reader(Selection::default());
    let start = whole.next_undecoded().map_or(0, |first| first.log_time);
    loop {
        let row = match place {
            SignalPlace::Field(field) => match reader.next() {
                None => break,
                Some(Err(error)) => {
                    add_once(losses, error.to_string());
                    continue;
                }
                Some(Ok(message)) => {
                    let numbers = message.numbers(field.topic());
                    let value = numbers.map(|numbers| numbers[field.index()]);
                    (seconds(message.time_ns), value.filter(|v| v.is_finite()))
                }
            },
            SignalPlace::Json(_, names) => match reader.next_undecoded() {
                None => break,
                Some(message) => {
                    let Ok(json) = serde_json::from_slice(message.data) else {
                        undecodable += 1;
                        continue;
                    };
                    let time = i128::from(message.log_time) - i128::from(start);
                    let value = match member(json, names) {
                        Ok(number) => Some(number),
                        Err(error) => {
                            lack.get_or_insert(error);
                            None
                        }
                    };
                    (time as f64 / 1e9, value)
                }
            },
        };
        if rows.len() == MAX_ROWS {
            return Err(too_long().in_file(path));
        }
        rows.push(row);
    }
    if undecodable > 0 {
        if rows.is_empty() {
            lack = Some(Lack::NoJson);
        }
        let messages = counted(undecodable, "message");
        add_once(losses, format!("{messages} of {topic}, no JSON"));
    }
    for loss in reader.all_losses().sentences() {
        add_once(losses, loss);
    }
    if recording.condition() == Condition::Interrupted {
        add_once(losses, "the end of the file, which is cut".to_owned());
    }
    Ok(PlaceRows { rows, lack })
}

/// Signals of one file share its losses.
fn add_once(losses: &mut Vec<String>, loss: String) {
    if !losses.contains(&loss) {
        losses.push(loss);
    }
}

/// The number at a path in a JSON message. A name that no member has may be that of one with a unit added.
fn member(mut value: Json, names: &[String]) -> Result<f64, Lack> {
    for (depth, name) in names.iter().enumerate() {
        let bare = split_header(name).0;
        let found = match &mut value {
            Json::Object(members) => {
                let key = if members.contains_key(name) {
                    name
                } else {
                    bare
                };
                members.get_mut(key).map(Json::take)
            }
            Json::Array(items) => bare
                .parse::<usize>()
                .ok()
                .and_then(|index| items.get_mut(index))
                .map(Json::take),
            Json::Null | Json::Bool(_) | Json::Number(_) | Json::String(_) => None,
        };
        value = found.ok_or_else(|| Lack::Absent {
            known: member_names(&value, &names[..depth]),
        })?;
    }
    match value {
        Json::Number(number) => number.as_f64().ok_or(Lack::Null),
        Json::Null => Err(Lack::Null),
        Json::String(text) => Err(Lack::Text(text.chars().take(MAX_SHOWN).collect())),
        Json::Bool(_) => Err(Lack::Boolean),
        Json::Object(_) | Json::Array(_) => Err(Lack::Absent {
            known: member_names(&value, names),
        }),
    }
}

/// Names of the members of a value, below the members `outer`.
fn member_names(value: &Json, outer: &[String]) -> Vec<String> {
    /// Maximum number of names: messages may have thousands of members.
    const MAX_NAMES: usize = 20;
    let inner: Vec<String> = match value {
        Json::Object(members) => members.keys().take(MAX_NAMES).cloned().collect(),
        Json::Array(items) => (0..items.len().min(MAX_NAMES))
            .map(|index| index.to_string())
            .collect(),
        Json::Null | Json::Bool(_) | Json::Number(_) | Json::String(_) => Vec::new(),
    };
    inner
        .into_iter()
        .map(|name| [outer, &[name]].concat().join("."))
        .collect()
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
        data::read(&files, &[SignalSpec::parse(signal)?], None)
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
}
