//! Messages as JSON: `{"timestamp":{"sec":…,"nsec":…},"theta":…,…}`.

use super::decoding::{DecodeError, Object, Paths, Row, SchemaError, Storage};
use super::template::{Slot, Template};
use crate::run::time::{NANOSECONDS, seconds_and_nanoseconds};
use crate::telemetry::message::Message;
use crate::telemetry::table::channel::{ChannelInfo, Content};
use serde::de::{self, DeserializeSeed, IgnoredAny, MapAccess, Visitor};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fmt;
use std::io::Write as _;

/// The first member of every message.
const TIMESTAMP: &str = "timestamp";
/// The number of parts of a timestamp: seconds and nanoseconds.
const STAMP_PARTS: usize = 2;

/// Appends the message to `out` as JSON, with bit-exact numbers.
pub(in crate::telemetry) fn encode(template: &Template, message: &Message<'_>, out: &mut Vec<u8>) {
    let (sec, nsec) = seconds_and_nanoseconds(message.time_ns);
    // Writing to a Vec cannot fail, and every number is finite.
    let _ = write!(out, "{{\"timestamp\":{{\"sec\":{sec},\"nsec\":{nsec}}}");
    let mut numbers = message.numbers.iter();
    let mut texts = message.texts.iter();
    for Slot { before, is_text } in &template.slots {
        out.extend_from_slice(before);
        let _ = if *is_text {
            serde_json::to_writer(&mut *out, texts.next().map_or("", String::as_str))
        } else {
            // The shortest text that parses to the same double.
            serde_json::to_writer(&mut *out, numbers.next().unwrap_or(&0.0))
        };
    }
    out.extend_from_slice(&template.end);
}

/// The template of a channel's messages.
pub(in crate::telemetry) fn template(channel: &ChannelInfo) -> Template {
    let mut slots = Vec::new();
    let mut before = String::new();
    for (name, content) in channel.members() {
        before.push_str(&format!(",\"{name}\":"));
        match content {
            Content::Text(_) => slots.push(Slot::text(std::mem::take(&mut before).into_bytes())),
            Content::Number(_) => {
                slots.push(Slot::number(std::mem::take(&mut before).into_bytes()));
            }
            Content::Object(members) => {
                for (position, (name, _)) in members.iter().enumerate() {
                    let opening = if position == 0 { '{' } else { ',' };
                    before.push_str(&format!("{opening}\"{name}\":"));
                    slots.push(Slot::number(std::mem::take(&mut before).into_bytes()));
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
    /// Number of unknown members of a message.
    unknown: usize,
}

impl JsonDecoder {
    /// A decoder for the table's `channel`, as described by the JSON Schema of a file; and the paths of the leaves in
    /// the file.
    pub(super) fn new(
        channel: &ChannelInfo,
        schema: &[u8],
    ) -> Result<(Self, Vec<String>), SchemaError> {
        let schema: Value =
            serde_json::from_slice(schema).map_err(|error| SchemaError::Json(error.to_string()))?;
        let mut paths = Paths::default();
        unfold(&schema, "", &mut paths)?;
        let present = paths.leaves;
        let stamps = [("sec", Storage::Seconds), ("nsec", Storage::Nanoseconds)];
        let stamp = stamps.map(|(name, target)| (name.to_owned(), target));
        let mut members = vec![(TIMESTAMP.to_owned(), Storage::Object(Object(stamp.into())))];
        for (name, content) in channel.members() {
            let target = match content {
                Content::Text(index) => Storage::Text(index),
                Content::Number(index) => Storage::Number(index),
                Content::Object(inner) => {
                    let numbers = inner
                        .iter()
                        .map(|(name, at)| ((*name).to_owned(), Storage::Number(*at)));
                    Storage::Object(Object(numbers.collect()))
                }
            };
            members.push((name.to_owned(), target));
        }
        let matched = present
            .iter()
            .filter(|path| channel.leaves().any(|leaf| leaf.path == **path))
            .count();
        let message = Object(members);
        let decoder = Self {
            unknown: unknown_members(&message, &present),
            message,
            expected: matched + STAMP_PARTS,
        };
        Ok((decoder, present))
    }

    pub(super) fn decode(&self, data: &[u8], row: &mut Row) -> Result<(), DecodeError> {
        let FieldCounts { found, unknown } = self
            .fill(data, row)
            .map_err(|error| DecodeError::Json(error.to_string()))?;
        // A file of another version lacks some fields of the table and has others, but each of its messages must have
        // exactly the fields of its schema.
        if found == self.expected && unknown == self.unknown {
            return Ok(());
        }
        // Its schema may have fields that this version doesn't know.
        Err(DecodeError::Fields {
            found: found + unknown.min(self.unknown),
            expected: self.expected + self.unknown,
            unknown: unknown.saturating_sub(self.unknown),
        })
    }

    /// Fills a row from a message.
    fn fill(&self, data: &[u8], row: &mut Row) -> Result<FieldCounts, serde_json::Error> {
        let mut tally = FieldCounts::default();
        let mut deserializer = serde_json::Deserializer::from_slice(data);
        RowBuilder {
            object: &self.message,
            row,
            tally: &mut tally,
        }
        .deserialize(&mut deserializer)?;
        // Rejects text after the object.
        deserializer.end()?;
        Ok(tally)
    }
}

/// Finds the paths of all numbers and texts in a JSON Schema, except the timestamp.
fn unfold(schema: &Value, prefix: &str, paths: &mut Paths) -> Result<(), SchemaError> {
    let properties = schema.get("properties").and_then(Value::as_object);
    for (name, inner) in properties.into_iter().flatten() {
        if prefix.is_empty() && name == TIMESTAMP {
            continue;
        }
        let path = format!("{prefix}{name}");
        paths.count(&path)?;
        // Types are not compared here: a member of another type fails when a message is read.
        if inner.get("properties").is_some() {
            unfold(inner, &format!("{path}."), paths)?;
        } else {
            paths.leaves.push(path);
        }
    }
    Ok(())
}

/// Number of unknown members of a message with leaves at these paths. An unknown object counts once.
fn unknown_members(message: &Object<String>, paths: &[String]) -> usize {
    let members = paths
        .iter()
        .filter_map(|path| unknown_member(message, path));
    members.collect::<BTreeSet<_>>().len()
}

/// The path of the outermost unknown member that contains a leaf, if any.
fn unknown_member<'a>(message: &Object<String>, path: &'a str) -> Option<&'a str> {
    let (mut object, mut start) = (message, 0);
    loop {
        let length = path[start..].find('.').unwrap_or(path.len() - start);
        let end = start + length;
        let name = &path[start..end];
        let known = object.0.iter().find(|(known, _)| known == name);
        match known {
            Some((_, Storage::Object(inner))) if end < path.len() => {
                (object, start) = (inner, end + 1);
            }
            Some((_, Storage::Number(_) | Storage::Text(_))) if end == path.len() => return None,
            _ => return Some(&path[..end]),
        }
    }
}

/// Progress of decoding.
#[derive(Default)]
struct FieldCounts {
    found: usize,
    unknown: usize,
}

/// Fills a row from a JSON object.
struct RowBuilder<'a> {
    object: &'a Object<String>,
    row: &'a mut Row,
    tally: &'a mut FieldCounts,
}

impl<'de> DeserializeSeed<'de> for RowBuilder<'_> {
    type Value = ();

    fn deserialize<D: de::Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for RowBuilder<'_> {
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
                Storage::Number(at) => {
                    // The row was filled with NaN, which JSON can't express: another number has been read already.
                    let number = map.next_value()?;
                    if !std::mem::replace(&mut self.row.numbers[*at], number).is_nan() {
                        return Err(de::Error::custom("a member is repeated"));
                    }
                }
                // A repeated text is not noticed here, but then there are more members than expected.
                Storage::Text(at) => self.row.texts[*at] = map.next_value()?,
                Storage::Seconds => {
                    let seconds: u32 = map.next_value()?;
                    let part = Some(u64::from(seconds) * NANOSECONDS);
                    self.row.add_time(part).map_err(de::Error::custom)?;
                }
                Storage::Nanoseconds => {
                    let nanoseconds: u32 = map.next_value()?;
                    let part = Some(u64::from(nanoseconds));
                    self.row.add_time(part).map_err(de::Error::custom)?;
                }
                Storage::Object(object) => {
                    map.next_value_seed(RowBuilder {
                        object,
                        row: &mut *self.row,
                        tally: &mut *self.tally,
                    })?;
                    continue;
                }
                Storage::Skipped => {
                    map.next_value::<IgnoredAny>()?;
                    continue;
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
    /// The position, if the members are in order.
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
