//! Messages of ROS 2, field by field: CDR version 1 with definitions in `ros2msg`.
//!
//! Whatever a message says, nothing is set aside for it before its bytes are there: each field takes at least one.

use super::tree::{Filling, Node, Place, Segment};
use super::value::Value;
use std::borrow::Cow;
use std::collections::HashMap;

/// A definition is not longer than this.
const LARGEST_SCHEMA: usize = 1 << 20;
/// Messages may be nested so deep.
const DEEPEST: usize = 100;
/// Messages that definitions use without giving them.
const BUILT_IN: &str = "===\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n\
                        ===\nMSG: builtin_interfaces/Duration\nint32 sec\nuint32 nanosec\n";

/// The message types of a definition; the first is that of the messages.
#[derive(Debug)]
pub(super) struct Types(Vec<Vec<Field>>);

#[derive(Debug)]
struct Field {
    name: Segment<'static>,
    kind: Kind,
    count: Count,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Bool,
    /// With so many bytes.
    Unsigned(usize),
    Signed(usize),
    Real(usize),
    Text,
    /// The type at this position.
    Message(usize),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Count {
    One,
    Fixed(usize),
    /// As many as the message says.
    Any,
}

impl Types {
    /// Reads a definition of the message type with a `name`, or says why it can't be used.
    pub(super) fn new(name: &str, definition: &[u8]) -> Result<Self, String> {
        if definition.len() > LARGEST_SCHEMA {
            return Err(format!("it is longer than {LARGEST_SCHEMA} bytes"));
        }
        let text = std::str::from_utf8(definition).map_err(|error| error.to_string())?;
        let text = format!("MSG: {name}\n{text}\n{BUILT_IN}");
        // For each type its name and the lines that are neither empty nor comments.
        let mut sections: Vec<(String, Vec<&str>)> = Vec::new();
        for line in text.lines() {
            let line = line.split('#').next().unwrap_or_default().trim();
            match line.strip_prefix("MSG:") {
                Some(name) => sections.push((plain(name.trim()), Vec::new())),
                None if line.is_empty() || line.starts_with("===") => {}
                None => {
                    if let Some((_, lines)) = sections.last_mut() {
                        lines.push(line);
                    }
                }
            }
        }
        let mut positions = HashMap::new();
        for (at, (name, _)) in sections.iter().enumerate() {
            positions.entry(name.as_str()).or_insert(at);
        }
        let types = sections.iter().map(|(name, lines)| {
            let package = name.split_once('/').map_or("", |(package, _)| package);
            let fields = lines.iter().map(|line| field(line, package, &positions));
            fields.filter_map(Result::transpose).collect()
        });
        let types = Self(types.collect::<Result<_, _>>()?);
        types.check(0, &mut vec![false; types.0.len()], 0)?;
        Ok(types)
    }

    /// Refuses types that contain themselves.
    fn check(&self, of: usize, is_checked: &mut [bool], depth: usize) -> Result<(), String> {
        if depth == DEEPEST {
            return Err(format!("messages are nested more than {DEEPEST} deep"));
        }
        for field in &self.0[of] {
            if let Kind::Message(inner) = field.kind
                && !is_checked[inner]
            {
                self.check(inner, is_checked, depth + 1)?;
            }
        }
        is_checked[of] = true;
        Ok(())
    }

    /// Reads a message, or says what is wrong with it.
    pub(super) fn fill(
        &self,
        data: &[u8],
        root: &mut Node,
        mut filling: Filling<'_>,
    ) -> Result<(), String> {
        let (header, body) = data.split_first_chunk::<4>().ok_or(CUT)?;
        let is_big_endian = match header {
            [0, 0, ..] => true,
            [0, 1, ..] => false,
            _ => return Err("it is not CDR version 1".to_owned()),
        };
        filling.meet(root);
        let mut reading = Reading {
            types: self,
            filling: &mut filling,
            body,
            at: 0,
            is_big_endian,
        };
        reading.message(0, root, None)?;
        let rest = &body[reading.at..];
        // Writers may fill the last four bytes up.
        if rest.len() > 3 || rest.iter().any(|byte| *byte != 0) {
            filling.keep_unknown(rest);
        }
        Ok(())
    }
}

/// The name of a type without what all have: `std_msgs/msg/Header` is `std_msgs/Header`.
fn plain(name: &str) -> String {
    name.replacen("/msg/", "/", 1)
}

/// The field that a line of a definition declares; nothing if it is a constant.
fn field(
    line: &str,
    package: &str,
    positions: &HashMap<&str, usize>,
) -> Result<Option<Field>, String> {
    let mut words = line.split_whitespace();
    let (Some(kind), Some(name)) = (words.next(), words.next()) else {
        return Err(format!("{line:?} declares no field"));
    };
    if name.contains('=') || words.next().is_some_and(|word| word.starts_with('=')) {
        return Ok(None);
    }
    let (kind, count) = match kind
        .strip_suffix(']')
        .and_then(|kind| kind.rsplit_once('['))
    {
        None => (kind, Count::One),
        Some((kind, length)) if length.is_empty() || length.starts_with("<=") => (kind, Count::Any),
        Some((kind, length)) => {
            let length = length
                .parse()
                .map_err(|_| format!("{line:?} has no length"))?;
            (kind, Count::Fixed(length))
        }
    };
    let kind = match kind.split("<=").next().unwrap_or_default() {
        "bool" => Kind::Bool,
        "byte" | "char" | "uint8" => Kind::Unsigned(1),
        "uint16" => Kind::Unsigned(2),
        "uint32" => Kind::Unsigned(4),
        "uint64" => Kind::Unsigned(8),
        "int8" => Kind::Signed(1),
        "int16" => Kind::Signed(2),
        "int32" => Kind::Signed(4),
        "int64" => Kind::Signed(8),
        "float32" => Kind::Real(4),
        "float64" => Kind::Real(8),
        "string" => Kind::Text,
        // Whose characters have two or four bytes, as the writer likes.
        "wstring" => return Err("wstring can't be read".to_owned()),
        name => {
            let name = plain(name);
            let near = format!("{package}/{name}");
            let found = positions
                .get(name.as_str())
                .or_else(|| positions.get(near.as_str()));
            let found = found.or_else(|| {
                positions
                    .get("std_msgs/Header")
                    .filter(|_| name == "Header")
            });
            Kind::Message(*found.ok_or_else(|| format!("it has no message {name}"))?)
        }
    };
    Ok(Some(Field {
        name: Segment::Name(Cow::Owned(name.to_owned())),
        kind,
        count,
    }))
}

/// Reads a message.
struct Reading<'a, 'f> {
    types: &'a Types,
    filling: &'a mut Filling<'f>,
    /// What stands behind the header.
    body: &'a [u8],
    /// How much of it has been read.
    at: usize,
    is_big_endian: bool,
}

const CUT: &str = "it ends within a field";

impl<'a> Reading<'a, '_> {
    fn message(
        &mut self,
        of_type: usize,
        node: &mut Node,
        place: Option<&Place<'_>>,
    ) -> Result<(), String> {
        let types = self.types;
        let fields = &types.0[of_type];
        if fields.is_empty() {
            // A message with nothing in it is written as a byte.
            self.take(1)?;
            self.filling.put(node, place, Value::Empty)?;
        }
        let mut next = 0;
        for field in fields {
            let place = Place {
                parent: place,
                segment: &field.name,
            };
            node.member(&field.name, &mut next, |node| {
                self.field(field, node, &place)
            })?;
        }
        Ok(())
    }

    fn field(&mut self, field: &Field, node: &mut Node, place: &Place<'_>) -> Result<(), String> {
        let count = match field.count {
            Count::One => return self.value(field.kind, node, place),
            Count::Fixed(count) => count,
            Count::Any => self.length()?,
        };
        if field.kind == Kind::Unsigned(1) {
            let bytes = self.take(count)?;
            let bytes = Value::Bytes(bytes.into());
            return self.filling.put(node, Some(place), bytes);
        }
        if count == 0 {
            self.filling.put(node, Some(place), Value::Empty)?;
        }
        let mut next = 0;
        for position in 0..count {
            let segment = Segment::Index(position as i128);
            let place = Place {
                parent: Some(place),
                segment: &segment,
            };
            node.member(&segment, &mut next, |node| {
                self.value(field.kind, node, &place)
            })?;
        }
        Ok(())
    }

    fn value(&mut self, kind: Kind, node: &mut Node, place: &Place<'_>) -> Result<(), String> {
        let value = match kind {
            Kind::Message(inner) => return self.message(inner, node, Some(place)),
            Kind::Bool => Value::Bool(self.bits(1)? != 0),
            Kind::Unsigned(size) => Value::integer(self.bits(size)?.into()),
            Kind::Signed(size) => {
                let unused = 64 - 8 * size as u32;
                Value::Integer((self.bits(size)? << unused) as i64 >> unused)
            }
            Kind::Real(4) => Value::Real(f32::from_bits(self.bits(4)? as u32).into()),
            Kind::Real(_) => Value::Real(f64::from_bits(self.bits(8)?)),
            Kind::Text => {
                let length = self.length()?;
                let bytes = self.take(length)?;
                let bytes = bytes.strip_suffix(&[0]).unwrap_or(bytes);
                match std::str::from_utf8(bytes) {
                    Ok(text) => Value::Text(text.into()),
                    Err(_) => Value::Bytes(bytes.into()),
                }
            }
        };
        self.filling.put(node, Some(place), value)
    }

    fn length(&mut self) -> Result<usize, String> {
        usize::try_from(self.bits(4)?).map_err(|error| error.to_string())
    }

    /// A number of so many bytes, which is aligned to its size.
    fn bits(&mut self, size: usize) -> Result<u64, String> {
        self.at = self.at.next_multiple_of(size);
        let is_big_endian = self.is_big_endian;
        let bytes = self.take(size)?.iter();
        let append = |bits: u64, byte: &u8| bits << 8 | u64::from(*byte);
        Ok(if is_big_endian {
            bytes.fold(0, append)
        } else {
            bytes.rev().fold(0, append)
        })
    }

    fn take(&mut self, count: usize) -> Result<&'a [u8], String> {
        let end = self.at.checked_add(count).ok_or(CUT)?;
        let bytes = self.body.get(self.at..end).ok_or(CUT)?;
        self.at = end;
        Ok(bytes)
    }
}
