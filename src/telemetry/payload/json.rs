//! JSON messages, field by field.

use super::literals::Literals;
use super::tree::{Filling, Node, Place, Segment};
use super::value::Value as Found;
use serde::de::{self, DeserializeSeed, MapAccess, SeqAccess, Visitor};
use std::borrow::Cow;
use std::fmt;

/// Reads a message, or says what is wrong with it.
pub(super) fn fill(
    data: &[u8],
    literals: &mut Literals,
    root: &mut Node,
    mut filling: Filling<'_>,
) -> Result<(), String> {
    let mut deserializer = serde_json::Deserializer::from_slice(data);
    filling.meet(root);
    let value = Value {
        node: root,
        place: None,
        filling: &mut filling,
        literals,
    };
    let filled = value.deserialize(&mut deserializer);
    let ended = filled.and_then(|()| deserializer.end());
    ended.map_err(|error| error.to_string())
}

/// A value that is read into the field at a node, or into those within it.
struct Value<'a, 'f> {
    node: &'a mut Node,
    place: Option<&'a Place<'a>>,
    filling: &'a mut Filling<'f>,
    /// What the message's nulls stand for.
    literals: &'a mut Literals,
}

impl Value<'_, '_> {
    fn put<E: de::Error>(self, value: Found) -> Result<(), E> {
        let put = self.filling.put(self.node, self.place, value);
        put.map_err(E::custom)
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
            literals,
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
                literals,
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

    fn visit_bool<E: de::Error>(self, value: bool) -> Result<(), E> {
        self.put(Found::Bool(value))
    }

    fn visit_i64<E: de::Error>(self, value: i64) -> Result<(), E> {
        self.put(Found::Integer(value))
    }

    fn visit_u64<E: de::Error>(self, value: u64) -> Result<(), E> {
        self.put(Found::integer(value.into()))
    }

    fn visit_f64<E: de::Error>(self, value: f64) -> Result<(), E> {
        self.put(Found::Real(value))
    }

    fn visit_str<E: de::Error>(self, text: &str) -> Result<(), E> {
        self.put(Found::Text(text.into()))
    }

    fn visit_unit<E: de::Error>(self) -> Result<(), E> {
        let value = match self.literals.next() {
            Some(number) => Found::Real(number),
            None => Found::Null,
        };
        self.put(value)
    }

    fn visit_seq<A: SeqAccess<'de>>(mut self, mut elements: A) -> Result<(), A::Error> {
        let mut next = 0;
        for position in 0.. {
            let segment = Segment::Index(position);
            let read = |value: Value<'_, '_>| elements.next_element_seed(value);
            if self.member(&segment, &mut next, read)?.is_none() {
                if position == 0 {
                    return self.put(Found::Empty);
                }
                break;
            }
        }
        Ok(())
    }

    fn visit_map<A: MapAccess<'de>>(mut self, mut members: A) -> Result<(), A::Error> {
        let mut next = 0;
        let mut is_empty = true;
        while let Some(name) = members.next_key_seed(Name)? {
            is_empty = false;
            let segment = Segment::Name(name);
            self.member(&segment, &mut next, |value| members.next_value_seed(value))?;
        }
        if is_empty {
            return self.put(Found::EmptyObject);
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

    fn visit_str<E: de::Error>(self, name: &str) -> Result<Self::Value, E> {
        Ok(Cow::Owned(name.to_owned()))
    }
}
