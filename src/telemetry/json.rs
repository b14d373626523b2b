//! Messages as JSON: `{"timestamp":{"sec":…,"nsec":…},"theta":…,…}`.

use super::channel::{ChannelInfo, Content};
use super::decoding::{DecodeError, Object, Paths, Row, Target};
use super::message::Message;
use super::template::Template;
use serde::de::{self, DeserializeSeed, IgnoredAny, MapAccess, Visitor};
use serde_json::Value;
use std::fmt;
use std::io::Write as _;

/// The first member of every message.
const TIMESTAMP: &str = "timestamp";
/// The number of parts of a timestamp: seconds and nanoseconds.
const STAMP_PARTS: usize = 2;

/// Appends the message to `out` as JSON, with bit-exact numbers.
pub(super) fn encode(template: &Template, message: &Message<'_>, out: &mut Vec<u8>) {
    let (sec, nsec) = seconds_and_nanoseconds(message.time_ns);
    // Writing to a Vec cannot fail, and every number is finite.
    let _ = write!(out, "{{\"timestamp\":{{\"sec\":{sec},\"nsec\":{nsec}}}");
    let mut numbers = message.numbers.iter();
    let mut texts = message.texts.iter();
    for (before, is_text) in &template.slots {
        out.extend_from_slice(before);
        let _ = if *is_text {
            serde_json::to_writer(&mut *out, texts.next().map_or("", String::as_str))
        } else {
            serde_json::to_writer(&mut *out, numbers.next().unwrap_or(&0.0))
        };
    }
    out.extend_from_slice(&template.end);
}

/// A time split into seconds and nanoseconds, as in timestamps.
pub fn seconds_and_nanoseconds(time_ns: u64) -> (u64, u64) {
    (time_ns / NANOSECONDS, time_ns % NANOSECONDS)
}

const NANOSECONDS: u64 = 1_000_000_000;

/// The template of a channel's messages.
pub(super) fn template(channel: &ChannelInfo) -> Template {
    let mut slots = Vec::new();
    let mut before = String::new();
    for (name, content) in channel.members() {
        before.push_str(&format!(",\"{name}\":"));
        match content {
            Content::Text(_) => slots.push((std::mem::take(&mut before).into_bytes(), true)),
            Content::Number(_) => slots.push((std::mem::take(&mut before).into_bytes(), false)),
            Content::Object(members) => {
                for (position, (name, _)) in members.iter().enumerate() {
                    let opening = if position == 0 { '{' } else { ',' };
                    before.push_str(&format!("{opening}\"{name}\":"));
                    slots.push((std::mem::take(&mut before).into_bytes(), false));
                }
                before.push('}');
            }
        }
    }
    before.push('}');
    let end = before.into_bytes();
    Template { slots, end }
}

/// Reads the JSON messages of one channel.
#[derive(Clone, Debug)]
pub(super) struct JsonDecoder {
    message: Object<String>,
    /// Leaves and parts of the timestamp that a message must have.
    expected: usize,
}

impl JsonDecoder {
    /// A decoder for the table's `channel`, as described by the JSON Schema of a file; and the paths of the leaves in
    /// the file.
    pub(super) fn new(
        channel: &ChannelInfo,
        schema: &[u8],
    ) -> Result<(Self, Vec<String>), DecodeError> {
        let schema: Value = serde_json::from_slice(schema).map_err(DecodeError::of_schema)?;
        let mut paths = Paths::default();
        let mut message = object(channel, &schema, "", &mut paths)?;
        let stamps = [("sec", Target::Seconds), ("nsec", Target::Nanoseconds)];
        let stamp = stamps.map(|(name, target)| (name.to_owned(), target));
        let stamp = Target::Object(Object(stamp.into()));
        message.0.insert(0, (TIMESTAMP.to_owned(), stamp));
        let expected = paths.leaves.len() + STAMP_PARTS;
        Ok((Self { message, expected }, paths.leaves))
    }

    pub(super) fn decode(&self, data: &[u8], row: &mut Row) -> Result<(), DecodeError> {
        let malformed =
            |reason: serde_json::Error| DecodeError(format!("not a json message: {reason}"));
        let mut tally = Tally::default();
        let mut deserializer = serde_json::Deserializer::from_slice(data);
        let seed = Filling {
            object: &self.message,
            row,
            tally: &mut tally,
        };
        seed.deserialize(&mut deserializer).map_err(malformed)?;
        deserializer.end().map_err(malformed)?;
        let (Tally { found, unknown }, expected) = (tally, self.expected);
        if found == expected && unknown == 0 {
            return Ok(());
        }
        Err(DecodeError(format!(
            "it has {found} of the {expected} fields of its schema, and {unknown} unknown fields"
        )))
    }
}

/// The members of an object with this JSON Schema at a path, except the timestamp.
fn object(
    channel: &ChannelInfo,
    schema: &Value,
    prefix: &str,
    paths: &mut Paths,
) -> Result<Object<String>, DecodeError> {
    let mut members = Vec::new();
    let properties = schema.get("properties").and_then(Value::as_object);
    for (name, inner) in properties.into_iter().flatten() {
        if prefix.is_empty() && name == TIMESTAMP {
            continue;
        }
        let path = format!("{prefix}{name}");
        paths.count(&path)?;
        let target = if inner.get("properties").is_some() {
            Target::Object(object(channel, inner, &format!("{path}."), paths)?)
        } else {
            let target = Target::of(channel, &path);
            paths.leaves.push(path);
            target
        };
        members.push((name.clone(), target));
    }
    Ok(Object(members))
}

/// Progress of decoding.
#[derive(Default)]
struct Tally {
    found: usize,
    unknown: usize,
}

/// Fills a row from a JSON object.
struct Filling<'a> {
    object: &'a Object<String>,
    row: &'a mut Row,
    tally: &'a mut Tally,
}

impl<'de> DeserializeSeed<'de> for Filling<'_> {
    type Value = ();

    fn deserialize<D: de::Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for Filling<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let object = self.object;
        let mut next = 0;
        while let Some(position) = map.next_key_seed(Name { object, next })? {
            let Some(position) = position else {
                self.tally.unknown += 1;
                map.next_value::<IgnoredAny>()?;
                continue;
            };
            next = position + 1;
            match &object.0[position].1 {
                Target::Number(at) => self.row.numbers[*at] = map.next_value()?,
                Target::Text(at) => self.row.texts[*at] = map.next_value()?,
                Target::Seconds => {
                    let seconds: u32 = map.next_value()?;
                    let part = Some(u64::from(seconds) * NANOSECONDS);
                    self.row.add_time(part).map_err(de::Error::custom)?;
                }
                Target::Nanoseconds => {
                    let nanoseconds: u32 = map.next_value()?;
                    let part = Some(u64::from(nanoseconds));
                    self.row.add_time(part).map_err(de::Error::custom)?;
                }
                Target::Object(object) => {
                    map.next_value_seed(Filling {
                        object,
                        row: &mut *self.row,
                        tally: &mut *self.tally,
                    })?;
                    continue;
                }
                Target::Skipped => {
                    map.next_value::<IgnoredAny>()?;
                }
            }
            self.tally.found += 1;
        }
        Ok(())
    }
}

/// Reads a member name as its position; `None` for unknown names.
#[derive(Clone, Copy)]
struct Name<'a> {
    object: &'a Object<String>,
    /// Its position, if the members are in order.
    next: usize,
}

impl<'de> DeserializeSeed<'de> for Name<'_> {
    type Value = Option<usize>;

    fn deserialize<D: de::Deserializer<'de>>(
        self,
        deserializer: D,
    ) -> Result<Self::Value, D::Error> {
        deserializer.deserialize_identifier(self)
    }
}

impl Visitor<'_> for Name<'_> {
    type Value = Option<usize>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a member's name")
    }

    fn visit_str<E: de::Error>(self, name: &str) -> Result<Self::Value, E> {
        Ok(self.object.position(self.next, |known| known == name))
    }
}
