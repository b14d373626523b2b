//! Measured values from MCAP files: recordings of toprise, and JSON messages of other software.

use super::data_error::{DataError, SignalError};
use super::signal::{FileSignals, Row, SigmaSpec, Signal, SignalSpec};
use super::table::MAX_ROWS;
use super::unit::{Dimension, split_header};
use crate::archive::recording::{Condition, FileChannel, Recording, Selection};
use crate::run::time::seconds;
use crate::telemetry::fields::NumberField;
use crate::telemetry::{Numbers as _, Topics};
use serde_json::Value as Json;
use std::path::Path;

/// The signals of an MCAP file.
pub(super) struct Read {
    pub found: FileSignals,
    /// Whether the file is a recording of toprise.
    pub is_ours: bool,
    /// Parts that could not be read, in sentences, each once.
    pub losses: Vec<String>,
}

/// Where the values of a signal are.
#[derive(PartialEq)]
enum Place {
    /// A field of toprise's channels, in SI units.
    Field(NumberField),
    /// A member of JSON messages: topic, and names from the outside in. The last one may have a unit as in a header.
    Json(String, Vec<String>),
}

impl Place {
    /// The unit that is given for the values; may be empty.
    fn unit(&self) -> &str {
        match self {
            Self::Field(field) => field.unit(),
            Self::Json(_, names) => names.last().map_or("", |name| split_header(name).1),
        }
    }

    fn what(&self) -> &'static str {
        match self {
            Self::Field(_) => "field",
            Self::Json(..) => "member",
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
pub(super) fn read(path: &Path, file: usize, specs: &[SignalSpec]) -> Result<Read, DataError> {
    let recording = Recording::open(path).map_err(|reason| DataError::Recording {
        path: path.to_owned(),
        reason,
    })?;
    if specs.is_empty() {
        return Err(DataError::ChooseSignals {
            path: path.to_owned(),
        });
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
            return Err(DataError::Signal {
                text: spec.source.clone(),
                reason: SignalError::Sigma(sigma.clone()),
            });
        }
        if places.iter().any(|(_, known)| place.has_values_of(known)) {
            return Err(DataError::Duplicate {
                path: path.to_owned(),
                source_name: spec.source.clone(),
            });
        }
        places.push((spec, place));
    }
    let mut signals = Vec::new();
    let mut losses = Vec::new();
    for (spec, place) in places {
        let rows = rows(&recording, path, &place, &mut losses)?;
        let factor = match &place {
            Place::Field(_) => 1.0,
            Place::Json(..) => Dimension::from_si(spec.field.unit())
                .factor(place.unit(), &spec.source)
                .map_err(|error| error.in_file(path))?,
        };
        let (mut found, mut missing) = (Vec::new(), 0);
        for (time, value) in rows {
            match value {
                Some(value) => found.push(Row {
                    time,
                    value: value * factor,
                    sigma: None,
                    line: 0,
                }),
                None => missing += 1,
            }
        }
        if found.is_empty() {
            return Err(DataError::NoValues {
                path: path.to_owned(),
                what: place.what(),
                name: spec.source.clone(),
            });
        }
        let is_unit_known = match &place {
            Place::Field(_) => true,
            Place::Json(..) => !place.unit().is_empty(),
        };
        signals.push(Signal {
            is_unit_known,
            ..Signal::new(&spec, file, found, missing, None)?
        });
    }
    Ok(Read {
        found: FileSignals {
            signals,
            known: topics(&recording),
        },
        is_ours: recording.is_ours(),
        losses,
    })
}

/// The place that a source names, if the file has it.
fn find_place(recording: &Recording, spec: &SignalSpec) -> Option<Place> {
    let source = &spec.source;
    for channel in recording.channels() {
        let Some(rest) = source.strip_prefix(&channel.topic) else {
            continue;
        };
        let Some(path) = rest.strip_prefix('.') else {
            continue;
        };
        match channel.table {
            Some(topic) => {
                if let Some(field) = topic.numbers().find(|field| field.path() == path) {
                    return Some(Place::Field(field));
                }
            }
            None if channel.encoding == "json" => {
                let names = path.split('.').map(str::to_owned).collect();
                return Some(Place::Json(channel.topic.clone(), names));
            }
            None => {}
        }
    }
    // A field of toprise may be named by its path alone.
    let field = spec.field;
    let is_named = *source == field.path() && recording.has(field.topic());
    is_named.then_some(Place::Field(field))
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

/// Times (s) and values of a place; no value where it is missing or not a number.
fn rows(
    recording: &Recording,
    path: &Path,
    place: &Place,
    losses: &mut Vec<String>,
) -> Result<Vec<(f64, Option<f64>)>, DataError> {
    let topic = match place {
        Place::Field(field) => field.topic().name().to_owned(),
        Place::Json(topic, _) => topic.clone(),
    };
    let mut reader = recording.reader(Selection {
        topics: Topics::Only(vec![topic]),
        ..Selection::default()
    });
    let mut rows: Vec<(f64, Option<f64>)> = Vec::new();
    // Times since the epoch have no fraction of a microsecond as doubles: they count from the file's first message.
    let mut whole = recording.reader(Selection::default());
    let start = whole.next_undecoded().map_or(0, |first| first.log_time);
    loop {
        let row = match place {
            Place::Field(field) => match reader.next() {
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
            Place::Json(_, names) => match reader.next_undecoded() {
                None => break,
                Some(message) => {
                    let time = i128::from(message.log_time) - i128::from(start);
                    (time as f64 / 1e9, member(message.data, names))
                }
            },
        };
        if rows.len() == MAX_ROWS {
            return Err(DataError::TooLong {
                path: path.to_owned(),
                limit: MAX_ROWS,
            });
        }
        rows.push(row);
    }
    for loss in reader.all_losses().sentences() {
        add_once(losses, loss);
    }
    if recording.condition() == Condition::Interrupted {
        add_once(losses, "the end of the file, which is cut".to_owned());
    }
    Ok(rows)
}

/// Signals of one file share its losses.
fn add_once(losses: &mut Vec<String>, loss: String) {
    if !losses.contains(&loss) {
        losses.push(loss);
    }
}

/// The number at a path in a JSON message. A name that no member has may be that of one with a unit added.
fn member(data: &[u8], names: &[String]) -> Option<f64> {
    let mut value: Json = serde_json::from_slice(data).ok()?;
    for name in names {
        value = match &mut value {
            Json::Object(members) => {
                let key = if members.contains_key(name) {
                    name
                } else {
                    split_header(name).0
                };
                members.get_mut(key)?.take()
            }
            Json::Array(items) => {
                let index = split_header(name).0.parse::<usize>().ok()?;
                items.get_mut(index)?.take()
            }
            Json::Null | Json::Bool(_) | Json::Number(_) | Json::String(_) => return None,
        };
    }
    value.as_f64().filter(|number| number.is_finite())
}
