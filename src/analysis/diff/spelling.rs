//! Values of JSON texts, which may be spelled in several ways.

use super::json_number::{JsonNumber, number_texts};
use serde::de::{self, DeserializeSeed, Deserializer, MapAccess, SeqAccess, Visitor};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fmt;
use std::vec;

/// A JSON value. The order of members, white space and the spelling of numbers are lost.
///
/// `serde_json::Value` would accept an object that names a member twice, and compare `1` with `1.0` as different.
#[derive(Debug, PartialEq)]
enum Json {
    Null,
    Bool(bool),
    Number(JsonNumber),
    Text(String),
    List(Vec<Json>),
    Object(BTreeMap<String, Json>),
}

/// Reads a [`Json`]. `serde_json` rounds most numbers to an `f64`: their texts are taken in turn, as they stand in the JSON.
#[derive(Clone, Copy)]
struct JsonSeed<'t> {
    numbers: &'t RefCell<vec::IntoIter<&'t str>>,
}

impl JsonSeed<'_> {
    /// The next number, of which `serde_json` read this value.
    fn number<E: de::Error>(self, value: Option<f64>) -> Result<Json, E> {
        let text = self.numbers.borrow_mut().next();
        text.map(|text| Json::Number(JsonNumber::new(text, value)))
            .ok_or_else(|| E::custom("a number without its text"))
    }
}

impl<'de> DeserializeSeed<'de> for JsonSeed<'_> {
    type Value = Json;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Json, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for JsonSeed<'_> {
    type Value = Json;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_unit<E>(self) -> Result<Json, E> {
        Ok(Json::Null)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Json, E> {
        Ok(Json::Bool(value))
    }

    fn visit_i64<E: de::Error>(self, _: i64) -> Result<Json, E> {
        self.number(None)
    }

    fn visit_u64<E: de::Error>(self, _: u64) -> Result<Json, E> {
        self.number(None)
    }

    fn visit_f64<E: de::Error>(self, value: f64) -> Result<Json, E> {
        self.number(Some(value))
    }

    fn visit_str<E>(self, value: &str) -> Result<Json, E> {
        Ok(Json::Text(value.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Json, A::Error> {
        let mut list = Vec::new();
        while let Some(item) = items.next_element_seed(self)? {
            list.push(item);
        }
        Ok(Json::List(list))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut members: A) -> Result<Json, A::Error> {
        let mut object = BTreeMap::new();
        while let Some(name) = members.next_key::<String>()? {
            if object
                .insert(name, members.next_value_seed(self)?)
                .is_some()
            {
                return Err(de::Error::custom("a member is repeated"));
            }
        }
        Ok(Json::Object(object))
    }
}

/// Reads a JSON text; `None` if it is none.
fn parse(json: &[u8]) -> Option<Json> {
    let numbers = RefCell::new(number_texts(json).into_iter());
    let mut deserializer = serde_json::Deserializer::from_slice(json);
    let seed = JsonSeed { numbers: &numbers };
    let value = seed.deserialize(&mut deserializer).ok()?;
    deserializer.end().ok()?;
    Some(value)
}

/// Maximum number of levels in each other that are read: `serde_json` reads no more, and a stack is limited, too.
pub(super) const MAX_DEPTH: usize = 127;

/// How the values of two JSON texts compare.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Spelling {
    /// All values are equal.
    SameValues,
    /// Values differ, or a text is not JSON.
    Different,
    /// A text has more than [`MAX_DEPTH`] levels.
    TooDeep,
}

/// Compares two JSON texts by their values.
pub(super) fn compare_json(a: &[u8], b: &[u8]) -> Spelling {
    if depth(a).max(depth(b)) > MAX_DEPTH {
        return Spelling::TooDeep;
    }
    match (parse(a), parse(b)) {
        (Some(a), Some(b)) if a == b => Spelling::SameValues,
        _ => Spelling::Different,
    }
}

/// Largest number of lists and objects in each other.
fn depth(json: &[u8]) -> usize {
    let (mut depth, mut deepest) = (0_usize, 0);
    let (mut is_text, mut is_escaped) = (false, false);
    for byte in json {
        match byte {
            _ if is_escaped => is_escaped = false,
            b'\\' if is_text => is_escaped = true,
            b'"' => is_text = !is_text,
            _ if is_text => {}
            b'[' | b'{' => {
                depth += 1;
                deepest = deepest.max(depth);
            }
            b']' | b'}' => depth = depth.saturating_sub(1),
            _ => {}
        }
    }
    deepest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn compares_json_by_value() {
        for (a, b, expected) in [
            (
                r#"{"a":1,"b":[2.5]}"#,
                r#"{ "b": [25e-1], "a": 1.0 }"#,
                true,
            ),
            (r#""é""#, r#""\u00e9""#, true),
            ("1e2", "100", true),
            ("0.1", "0.10000000000000001", true),
            ("0.1", "0.10000000000000002", false),
            ("-0.0", "0.0", false),
            ("9007199254740993", "9007199254740992", false),
            ("9007199254740993", "9007199254740992.0", false),
            (
                "[18446744073709551616, 0.5]",
                "[18446744073709551617, 0.5]",
                false,
            ),
            ("1.0000000000000000001", "1", false),
            (r#"{"1": "2", "a": [3.0]}"#, r#"{"a": [3], "1": "2"}"#, true),
            ("[1,2]", "[2,1]", false),
            ("null", "0", false),
            (r#"{"a":1}"#, r#"{"a":1,"b":null}"#, false),
            (r#"{"a":1,"a":2}"#, r#"{"a":2}"#, false),
            ("{", "{", false),
            ("1", "1 2", false),
        ] {
            let expected = if expected {
                Spelling::SameValues
            } else {
                Spelling::Different
            };
            let found = compare_json(a.as_bytes(), b.as_bytes());
            assert_eq!(found, expected, "{a} {b}");
        }
    }

    #[test]
    fn compares_values_up_to_the_maximum_depth() {
        let nested = |depth: usize, space: &str| {
            format!("{}{space}{}", "[".repeat(depth), "]".repeat(depth))
        };
        for (depth, expected) in [
            (MAX_DEPTH, Spelling::SameValues),
            (MAX_DEPTH + 1, Spelling::TooDeep),
            (100_000, Spelling::TooDeep),
        ] {
            let [a, b] = ["", " "].map(|space| nested(depth, space));
            assert_eq!(
                compare_json(a.as_bytes(), b.as_bytes()),
                expected,
                "{depth}"
            );
        }
        // Brackets in a text are no levels.
        let text = format!(r#"{{"a\"b": "{}"}}"#, "[".repeat(200));
        let respelled = text.replace(": ", ":");
        let found = compare_json(text.as_bytes(), respelled.as_bytes());
        assert_eq!(found, Spelling::SameValues);
    }
}
