//! JSON Schemas, generated from the table.

use super::{ChannelInfo, Leaf};
use serde_json::{Map, Value, json};

/// The JSON Schema of a channel's messages, as the text that stands in recordings and in `schemas/`.
///
/// It keeps to what the strictest viewer reads: no references, alternatives, nulls or arrays, and
/// `properties` on every object.
#[must_use]
pub fn json_schema(channel: &ChannelInfo) -> String {
    let mut properties = Map::new();
    properties.insert("timestamp".to_owned(), timestamp());
    for text in &channel.texts {
        properties.insert(text.path.clone(), leaf_schema("string", text, text.meaning));
    }
    for number in &channel.numbers {
        match number.path.split_once('.') {
            None => {
                let schema = leaf_schema("number", number, number.meaning);
                properties.insert(number.path.clone(), schema);
            }
            Some((parent, name)) => add_component(&mut properties, parent, name, number),
        }
    }
    let schema = object(
        Some(channel.schema),
        &format!("{}: {}", channel.topic, channel.meaning),
        properties,
    );
    format!("{schema:#}\n")
}

/// The name of a channel's file in `schemas/`.
#[must_use]
pub fn file_name(channel: &ChannelInfo) -> String {
    format!("{}.json", channel.schema)
}

fn add_component(properties: &mut Map<String, Value>, parent: &str, name: &str, leaf: &Leaf) {
    // A vector has one meaning; the members of other objects have their own.
    let is_vector = !leaf.frame.is_empty() || name.len() == 1;
    let (of_parent, of_member) = if is_vector {
        (described(leaf.meaning, leaf), format!("{name} component"))
    } else {
        (format!("terms of {parent}"), leaf.meaning.to_owned())
    };
    let parent = properties
        .entry(parent)
        .or_insert_with(|| object(None, &of_parent, Map::new()));
    parent["properties"][name] = leaf_schema("number", leaf, &of_member);
    if let Some(required) = parent["required"].as_array_mut() {
        required.push(json!(name));
    }
}

fn leaf_schema(kind: &str, leaf: &Leaf, meaning: &str) -> Value {
    json!({ "type": kind, "description": with_unit(meaning, leaf) })
}

fn described(meaning: &str, leaf: &Leaf) -> String {
    let meaning = with_unit(meaning, leaf);
    if leaf.frame.is_empty() {
        meaning
    } else {
        format!("{meaning}, frame {}", leaf.frame)
    }
}

/// A meaning with its unit in brackets.
pub(super) fn with_unit(meaning: &str, leaf: &Leaf) -> String {
    if leaf.unit.is_empty() {
        meaning.to_owned()
    } else {
        format!("{meaning} [{}]", leaf.unit)
    }
}

fn timestamp() -> Value {
    let part = |unit: &str| json!({ "type": "integer", "description": unit });
    let mut properties = Map::new();
    properties.insert("sec".to_owned(), part("whole seconds"));
    properties.insert("nsec".to_owned(), part("nanoseconds beyond"));
    object(None, "simulation time since the start", properties)
}

fn object(title: Option<&str>, description: &str, properties: Map<String, Value>) -> Value {
    let required: Vec<_> = properties.keys().cloned().collect();
    let mut schema = Map::new();
    if let Some(title) = title {
        schema.insert(
            "$schema".to_owned(),
            json!("https://json-schema.org/draft/2020-12/schema"),
        );
        schema.insert("title".to_owned(), json!(title));
    }
    schema.insert("description".to_owned(), json!(description));
    schema.insert("type".to_owned(), json!("object"));
    schema.insert("properties".to_owned(), Value::Object(properties));
    schema.insert("required".to_owned(), json!(required));
    Value::Object(schema)
}
