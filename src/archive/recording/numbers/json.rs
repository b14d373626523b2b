//! Numbers in JSON messages.

use super::tree::{Filling, Node, Place, Segment};
use serde::de::{self, DeserializeSeed, MapAccess, SeqAccess, Visitor};
use std::borrow::Cow;
use std::fmt;

/// Reads a message, or says what is wrong with it.
pub(super) fn fill(data: &[u8], root: &mut Node, mut filling: Filling<'_>) -> Result<(), String> {
    let mut deserializer = serde_json::Deserializer::from_slice(data);
    filling.meet(root);
    let value = Value {
        node: root,
        place: None,
        filling: &mut filling,
    };
    let filled = value.deserialize(&mut deserializer);
    let ended = filled.and_then(|()| deserializer.end());
    ended.map_err(|error| error.to_string())
}

/// Stands for infinity in a message that was rewritten.
const INFINITY: f64 = f64::MAX;

/// What JSON doesn't have but Python and others write, and what is put in its place.
const LITERALS: [(&[u8], &[u8]); 3] = [
    (b"NaN", b"null"),
    (b"-Infinity", b"-1.7976931348623157e308"),
    (b"Infinity", b"1.7976931348623157e308"),
];

/// Puts the infinities back into the values of a message that was rewritten.
pub(super) fn restore(values: &mut [f64]) {
    for value in values {
        if value.abs() == INFINITY {
            *value = f64::INFINITY.copysign(*value);
        }
    }
}

/// The message with other things in place of NaN and infinities; none if there are none in it.
pub(super) fn without_literals(data: &[u8]) -> Option<Vec<u8>> {
    let mut replaced = Vec::with_capacity(data.len());
    let mut rest = data;
    let (mut in_text, mut is_escaped, mut is_found) = (false, false, false);
    while let Some((byte, behind)) = rest.split_first() {
        let mut literals = LITERALS.iter();
        let literal = literals.find(|(literal, _)| !in_text && rest.starts_with(literal));
        if let Some((literal, instead)) = literal {
            replaced.extend_from_slice(instead);
            rest = &rest[literal.len()..];
            is_found = true;
            continue;
        }
        in_text ^= *byte == b'"' && !is_escaped;
        is_escaped = in_text && *byte == b'\\' && !is_escaped;
        replaced.push(*byte);
        rest = behind;
    }
    is_found.then_some(replaced)
}

/// A value that is read into the field at a node, or into those within it.
struct Value<'a, 'f> {
    node: &'a mut Node,
    place: Option<&'a Place<'a>>,
    filling: &'a mut Filling<'f>,
}

impl Value<'_, '_> {
    fn put(self, number: f64) {
        self.filling.put(self.node, self.place, number);
    }

    /// Reads a member with `read`.
    #[inline]
    fn member<T>(
        &mut self,
        segment: &Segment<'_>,
        next: &mut usize,
        read: impl FnOnce(Value<'_, '_>) -> T,
    ) -> T {
        let Self {
            node,
            place,
            filling,
        } = self;
        node.member(segment, next, |node| {
            // The last of several members with one name counts.
            filling.forget(node);
            filling.meet(node);
            read(Value {
                node,
                place: Some(&Place {
                    parent: *place,
                    segment,
                }),
                filling,
            })
        })
    }
}

impl<'de> DeserializeSeed<'de> for Value<'_, '_> {
    type Value = ();

    fn deserialize<D: de::Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Value<'_, '_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a value")
    }

    fn visit_bool<E>(self, value: bool) -> Result<(), E> {
        self.put(f64::from(u8::from(value)));
        Ok(())
    }

    fn visit_i64<E>(self, value: i64) -> Result<(), E> {
        self.put(value as f64);
        Ok(())
    }

    fn visit_u64<E>(self, value: u64) -> Result<(), E> {
        self.put(value as f64);
        Ok(())
    }

    fn visit_f64<E>(self, value: f64) -> Result<(), E> {
        self.put(value);
        Ok(())
    }

    fn visit_str<E>(self, _text: &str) -> Result<(), E> {
        Ok(())
    }

    fn visit_unit<E>(self) -> Result<(), E> {
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(mut self, mut elements: A) -> Result<(), A::Error> {
        let mut next = 0;
        for position in 0.. {
            let segment = Segment::Index(position);
            let read = |value: Value<'_, '_>| elements.next_element_seed(value);
            if self.member(&segment, &mut next, read)?.is_none() {
                break;
            }
        }
        Ok(())
    }

    fn visit_map<A: MapAccess<'de>>(mut self, mut members: A) -> Result<(), A::Error> {
        let mut next = 0;
        while let Some(name) = members.next_key_seed(Name)? {
            let segment = Segment::Name(name);
            self.member(&segment, &mut next, |value| members.next_value_seed(value))?;
        }
        Ok(())
    }
}

/// Reads the name of a member; it is copied only if there are escapes in it.
struct Name;

impl<'de> DeserializeSeed<'de> for Name {
    type Value = Cow<'de, str>;

    fn deserialize<D: de::Deserializer<'de>>(
        self,
        deserializer: D,
    ) -> Result<Self::Value, D::Error> {
        deserializer.deserialize_identifier(self)
    }
}

impl<'de> Visitor<'de> for Name {
    type Value = Cow<'de, str>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a member's name")
    }

    fn visit_borrowed_str<E>(self, name: &'de str) -> Result<Self::Value, E> {
        Ok(Cow::Borrowed(name))
    }

    fn visit_str<E>(self, name: &str) -> Result<Self::Value, E> {
        Ok(Cow::Owned(name.to_owned()))
    }
}
