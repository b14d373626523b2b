//! Protobuf messages, field by field.
//!
//! Messages are read as they stand, without building them: memory doesn't grow with what they say.

use super::tree::{Filling, Node, Place, Segment, Tree, Zero};
use super::value::Value;
use crate::telemetry::wire::{Wire, eight, four, take, varint};
use prost::Message as _;
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{DescriptorProto, FieldDescriptorProto, FileDescriptorSet};
use std::borrow::Cow;
use std::collections::HashMap;

/// A schema is not longer than this.
const LARGEST_SCHEMA: usize = 1 << 22;
/// The full names of all types of a schema may take so many bytes together: a package's name, which stands
/// there once, is part of each.
const LARGEST_NAMES: usize = 1 << 24;
/// Fields of the descriptors that are looked at before there is a message, at most. Types within types unfold
/// with the power of their depth.
const FORESEEN: usize = 1024;
/// Messages may be nested as deep as Google's parsers let them.
const DEEPEST: usize = 100;

/// The message types of a schema.
#[derive(Debug)]
pub(super) struct Types {
    list: Vec<MessageType>,
    /// That of the messages.
    root: usize,
}

#[derive(Debug)]
struct MessageType {
    fields: Vec<Field>,
    positions: HashMap<u32, usize>,
    /// How many of the fields are implicit.
    implicit: usize,
    is_map_entry: bool,
}

#[derive(Debug)]
struct Field {
    number: u32,
    name: Segment<'static>,
    kind: Kind,
    is_repeated: bool,
    /// What it is where it isn't there, if messages can't tell whether it was set.
    implicit: Option<Zero>,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    Scalar(Type),
    Message(usize),
}

impl Types {
    /// Reads a schema in which the messages' type has a `name`, or says why it can't be used.
    pub(super) fn new(name: &str, schema: &[u8]) -> Result<Self, String> {
        if schema.len() > LARGEST_SCHEMA {
            return Err(format!("it is longer than {LARGEST_SCHEMA} bytes"));
        }
        let set = FileDescriptorSet::decode(schema).map_err(|error| error.to_string())?;
        let mut found = Found::default();
        for file in &set.file {
            let is_proto3 = file.syntax() == "proto3";
            found.add(&file.message_type, file.package(), is_proto3)?;
        }
        let root = found.position(name)?;
        let types = found.messages.iter();
        let list = types.map(|(message, is_proto3)| found.message_type(message, *is_proto3));
        Ok(Self {
            list: list.collect::<Result<_, _>>()?,
            root,
        })
    }

    /// Makes the fields that the descriptors foretell.
    pub(super) fn foresee(&self, root: &mut Node, tree: &mut Tree) {
        let mut values = Vec::new();
        let mut foreseeing = Foreseeing {
            types: self,
            filling: Filling::new(tree, &mut values),
            within: Vec::new(),
            left: FORESEEN,
        };
        foreseeing.message(self.root, root, None);
    }

    /// Reads a message, or says what is wrong with it.
    pub(super) fn fill(
        &self,
        data: &[u8],
        root: &mut Node,
        filling: Filling<'_>,
    ) -> Result<(), String> {
        let mut reading = Reading {
            types: self,
            filling,
            depth: 0,
        };
        reading.message(data, self.root, root, None)
    }
}

/// The message types that have been found in a schema, and whether they are of proto3.
#[derive(Default)]
struct Found<'a> {
    messages: Vec<(&'a DescriptorProto, bool)>,
    positions: HashMap<String, usize>,
    /// What the names take.
    bytes: usize,
}

impl<'a> Found<'a> {
    fn add(
        &mut self,
        messages: &'a [DescriptorProto],
        scope: &str,
        is_proto3: bool,
    ) -> Result<(), String> {
        for message in messages {
            let name = match scope {
                "" => message.name().to_owned(),
                scope => format!("{scope}.{}", message.name()),
            };
            self.bytes += name.len();
            if self.bytes > LARGEST_NAMES {
                return Err(format!("its names are longer than {LARGEST_NAMES} bytes"));
            }
            self.add(&message.nested_type, &name, is_proto3)?;
            self.positions.insert(name, self.messages.len());
            self.messages.push((message, is_proto3));
        }
        Ok(())
    }

    fn position(&self, name: &str) -> Result<usize, String> {
        let name = name.strip_prefix('.').unwrap_or(name);
        let position = self.positions.get(name).copied();
        position.ok_or_else(|| format!("it has no message {name}"))
    }

    fn message_type(
        &self,
        message: &DescriptorProto,
        is_proto3: bool,
    ) -> Result<MessageType, String> {
        let mut fields = Vec::new();
        for field in &message.field {
            fields.push(self.field(field, is_proto3)?);
        }
        let numbered = fields.iter().enumerate();
        Ok(MessageType {
            positions: numbered.map(|(at, field)| (field.number, at)).collect(),
            implicit: fields.iter().filter(|f| f.implicit.is_some()).count(),
            is_map_entry: message.options.as_ref().is_some_and(|o| o.map_entry()),
            fields,
        })
    }

    fn field(&self, field: &FieldDescriptorProto, is_proto3: bool) -> Result<Field, String> {
        let is_repeated = field.label() == Label::Repeated;
        let kind = match field.r#type() {
            Type::Message | Type::Group => Kind::Message(self.position(field.type_name())?),
            scalar => Kind::Scalar(scalar),
        };
        let can_be_unset = !is_proto3 || field.proto3_optional() || field.oneof_index.is_some();
        Ok(Field {
            number: u32::try_from(field.number()).map_err(|error| error.to_string())?,
            name: Segment::Name(Cow::Owned(field.name().to_owned())),
            implicit: match kind {
                Kind::Scalar(scalar) if !is_repeated && !can_be_unset => Some(implicit(scalar)),
                _ => None,
            },
            kind,
            is_repeated,
        })
    }
}

impl MessageType {
    /// The field with a number; fields mostly come in order, so at `next`.
    #[inline]
    fn find(&self, number: u32, next: &mut usize) -> Option<&Field> {
        let position = match self.fields.get(*next) {
            Some(field) if field.number == number => *next,
            _ => *self.positions.get(&number)?,
        };
        *next = position + 1;
        self.fields.get(position)
    }
}

/// Finds fields without a message.
struct Foreseeing<'a> {
    types: &'a Types,
    filling: Filling<'a>,
    /// The types in which it is.
    within: Vec<usize>,
    /// How many fields may still be looked at.
    left: usize,
}

impl Foreseeing<'_> {
    fn message(&mut self, type_index: usize, node: &mut Node, place: Option<&Place<'_>>) {
        self.within.push(type_index);
        let mut next = 0;
        for field in &self.types.list[type_index].fields {
            if self.left == 0 {
                break;
            }
            self.left -= 1;
            if field.is_repeated {
                continue;
            }
            let place = Place {
                parent: place,
                segment: &field.name,
            };
            node.member(&field.name, &mut next, |node| match field.kind {
                Kind::Scalar(_) => {
                    node.implicit = field.implicit;
                    self.filling.reserve(node, Some(&place));
                }
                Kind::Message(inner) if !self.within.contains(&inner) => {
                    self.message(inner, node, Some(&place));
                }
                Kind::Message(_) => {}
            });
        }
        self.within.pop();
    }
}

/// Reads a message.
struct Reading<'a> {
    types: &'a Types,
    filling: Filling<'a>,
    depth: usize,
}

impl Reading<'_> {
    fn message(
        &mut self,
        mut data: &[u8],
        type_index: usize,
        node: &mut Node,
        place: Option<&Place<'_>>,
    ) -> Result<(), String> {
        if self.depth == DEEPEST {
            return Err(format!("messages are nested more than {DEEPEST} deep"));
        }
        self.depth += 1;
        let types = self.types;
        let of_type = &types.list[type_index];
        // What comes again is another part of the same message.
        if self.filling.meet(node) {
            self.zero(of_type, node, place);
            if data.is_empty() && of_type.implicit == 0 && place.is_some() {
                self.filling.put(node, place, Value::Empty)?;
            }
        }
        let (mut next_field, mut next_member) = (0, 0);
        while !data.is_empty() {
            let before = data;
            let (number, wire) = take(&mut data)?;
            if matches!(wire, Wire::End) {
                return Err(format!("a group {number} ends that has not begun"));
            }
            let Some(field) = of_type.find(number, &mut next_field) else {
                let length = before.len() - data.len();
                self.filling.keep_unknown(&before[..length]);
                continue;
            };
            let place = Place {
                parent: place,
                segment: &field.name,
            };
            node.member(&field.name, &mut next_member, |node| {
                self.field(field, wire, node, &place)
            })?;
        }
        self.depth -= 1;
        Ok(())
    }

    /// Sets the implicit fields of a message to zero.
    fn zero(&mut self, of_type: &MessageType, node: &mut Node, place: Option<&Place<'_>>) {
        if !node.is_unfolded {
            node.is_unfolded = true;
            self.unfold(of_type, node, place);
        }
        let zeroed = self.filling.zero_members(node);
        self.filling.miss(of_type.implicit.saturating_sub(zeroed));
    }

    fn unfold(&mut self, of_type: &MessageType, node: &mut Node, place: Option<&Place<'_>>) {
        let mut next = 0;
        for field in of_type.fields.iter().filter(|f| f.implicit.is_some()) {
            if self.filling.is_full() {
                return;
            }
            let place = Place {
                parent: place,
                segment: &field.name,
            };
            node.member(&field.name, &mut next, |node| {
                node.implicit = field.implicit;
                self.filling.reserve(node, Some(&place));
            });
        }
    }

    fn field(
        &mut self,
        field: &Field,
        wire: Wire<'_>,
        node: &mut Node,
        place: &Place<'_>,
    ) -> Result<(), String> {
        if !field.is_repeated {
            node.implicit = field.implicit;
            if matches!(field.kind, Kind::Scalar(_)) && !self.filling.meet(node) {
                // The last one counts, but the message says more.
                self.filling.repeat();
            }
            return self.value(field.kind, wire, node, place);
        }
        self.filling.meet(node);
        self.filling.keep(node, place);
        let types = self.types;
        match (field.kind, wire) {
            (Kind::Message(entry), Wire::Bytes(data)) if types.list[entry].is_map_entry => {
                self.entry(data, &types.list[entry], node, place)
            }
            (Kind::Scalar(scalar), Wire::Bytes(mut packed)) if is_packable(scalar) => {
                while !packed.is_empty() {
                    let wire = take_packed(scalar, &mut packed)?;
                    self.element(field.kind, wire, node, place)?;
                }
                Ok(())
            }
            (kind, wire) => self.element(kind, wire, node, place),
        }
    }

    /// Reads the next element of a list.
    fn element(
        &mut self,
        kind: Kind,
        wire: Wire<'_>,
        list: &mut Node,
        place: &Place<'_>,
    ) -> Result<(), String> {
        let segment = Segment::Index(list.elements as i128);
        let place = Place {
            parent: Some(place),
            segment: &segment,
        };
        let mut next = list.elements;
        list.elements += 1;
        list.member(&segment, &mut next, |node| {
            self.value(kind, wire, node, &place)
        })
    }

    /// Reads an entry of a map.
    fn entry(
        &mut self,
        mut data: &[u8],
        of_type: &MessageType,
        map: &mut Node,
        place: &Place<'_>,
    ) -> Result<(), String> {
        let (mut key, mut value) = (None, None);
        let mut repeats = false;
        while !data.is_empty() {
            let before = data;
            match take(&mut data)? {
                (KEY, wire) => repeats |= key.replace(wire).is_some(),
                (VALUE, wire) => repeats |= value.replace(wire).is_some(),
                _ => {
                    let length = before.len() - data.len();
                    self.filling.keep_unknown(&before[..length]);
                }
            }
        }
        if repeats {
            self.filling.repeat();
        }
        let Some(field) = of_type.find(VALUE, &mut 0) else {
            return Ok(());
        };
        let segment = of_type.key(key)?;
        let place = Place {
            parent: Some(place),
            segment: &segment,
        };
        let mut next = map.elements;
        map.elements += 1;
        map.member(&segment, &mut next, |node| {
            // The last of several entries with one key counts.
            self.filling.forget(node);
            self.value(field.kind, value.unwrap_or(field.kind.zero()), node, &place)
        })
    }

    fn value(
        &mut self,
        kind: Kind,
        wire: Wire<'_>,
        node: &mut Node,
        place: &Place<'_>,
    ) -> Result<(), String> {
        match (kind, wire) {
            (Kind::Message(inner), Wire::Bytes(data) | Wire::Group(data)) => {
                return self.message(data, inner, node, Some(place));
            }
            (Kind::Scalar(scalar), wire) => {
                if let Some(value) = value(scalar, wire) {
                    return self.filling.put(node, Some(place), value);
                }
            }
            _ => {}
        }
        Err(format!("{place} is not written as its type demands"))
    }
}

/// The fields of a map's entries.
const KEY: u32 = 1;
const VALUE: u32 = 2;

impl MessageType {
    /// The key of a map's entry.
    fn key<'a>(&self, wire: Option<Wire<'a>>) -> Result<Segment<'a>, String> {
        let unreadable = "the key of a map is neither a text nor an integer";
        let Some(Kind::Scalar(scalar)) = self.find(KEY, &mut 0).map(|field| field.kind) else {
            return Err(unreadable.to_owned());
        };
        let wire = wire.unwrap_or(Kind::Scalar(scalar).zero());
        if let (Type::String, Wire::Bytes(text)) = (scalar, wire) {
            let text = std::str::from_utf8(text).map_err(|error| error.to_string())?;
            return Ok(Segment::Name(Cow::Borrowed(text)));
        }
        let key = integer(scalar, wire).ok_or(unreadable)?;
        Ok(match (scalar, key) {
            (Type::Bool, 0) => Segment::Name(Cow::Borrowed("false")),
            (Type::Bool, _) => Segment::Name(Cow::Borrowed("true")),
            _ => Segment::Index(key),
        })
    }
}

impl Kind {
    /// What stands for zero, or for an empty message.
    fn zero(self) -> Wire<'static> {
        match self {
            Self::Message(_) | Self::Scalar(Type::String | Type::Bytes) => Wire::Bytes(&[]),
            Self::Scalar(Type::Double | Type::Fixed64 | Type::Sfixed64) => Wire::Eight(0),
            Self::Scalar(Type::Float | Type::Fixed32 | Type::Sfixed32) => Wire::Four(0),
            Self::Scalar(_) => Wire::Varint(0),
        }
    }
}

/// What stands for a field of proto3 that isn't there.
fn implicit(scalar: Type) -> Zero {
    match scalar {
        Type::Double | Type::Float => Zero::Real,
        Type::Bool => Zero::Bool,
        Type::String => Zero::Text,
        Type::Bytes => Zero::Bytes,
        _ => Zero::Integer,
    }
}

/// Whether lists of a type may be written as one field.
fn is_packable(scalar: Type) -> bool {
    !matches!(scalar, Type::String | Type::Bytes)
}

/// The value that is written so; nothing if its type is written otherwise.
#[inline]
fn value(scalar: Type, wire: Wire<'_>) -> Option<Value> {
    Some(match (scalar, wire) {
        (Type::Double, Wire::Eight(bits)) => Value::Real(f64::from_bits(bits)),
        (Type::Float, Wire::Four(bits)) => Value::Real(f32::from_bits(bits).into()),
        (Type::Bool, Wire::Varint(bits)) => Value::Bool(bits != 0),
        (Type::Bytes, Wire::Bytes(bytes)) => Value::Bytes(bytes.into()),
        (Type::String, Wire::Bytes(bytes)) => match std::str::from_utf8(bytes) {
            Ok(text) => Value::Text(text.into()),
            // Proto2 doesn't demand that texts are UTF-8.
            Err(_) => Value::Bytes(bytes.into()),
        },
        _ => Value::integer(integer(scalar, wire)?),
    })
}

fn integer(scalar: Type, wire: Wire<'_>) -> Option<i128> {
    Some(match (scalar, wire) {
        // Writers extend the sign of 32 bits to 64; readers cut off what is too much.
        (Type::Int32 | Type::Enum, Wire::Varint(bits)) => (bits as i32).into(),
        (Type::Uint32, Wire::Varint(bits)) => (bits as u32).into(),
        (Type::Int64, Wire::Varint(bits)) | (Type::Sfixed64, Wire::Eight(bits)) => {
            (bits as i64).into()
        }
        (Type::Uint64, Wire::Varint(bits)) | (Type::Fixed64, Wire::Eight(bits)) => bits.into(),
        (Type::Sint32, Wire::Varint(bits)) => zigzag(u64::from(bits as u32)),
        (Type::Sint64, Wire::Varint(bits)) => zigzag(bits),
        (Type::Bool, Wire::Varint(bits)) => i128::from(bits != 0),
        (Type::Fixed32, Wire::Four(bits)) => bits.into(),
        (Type::Sfixed32, Wire::Four(bits)) => (bits as i32).into(),
        _ => return None,
    })
}

/// 0, -1, 1, -2, … are written as 0, 1, 2, 3, …
fn zigzag(bits: u64) -> i128 {
    let magnitude = i128::from(bits >> 1);
    if bits & 1 == 0 {
        magnitude
    } else {
        -magnitude - 1
    }
}

/// Takes an element off the front of a packed list.
#[inline]
fn take_packed(scalar: Type, data: &mut &[u8]) -> Result<Wire<'static>, String> {
    Ok(match Kind::Scalar(scalar).zero() {
        Wire::Eight(_) => eight(data)?,
        Wire::Four(_) => four(data)?,
        _ => varint(data)?,
    })
}
