//! JSON Schemas of the messages, generated from the table.

use crate::telemetry::table::channel::{ChannelInfo, Content, Leaf};
use serde_json::{Map, Value, json};

/// The JSON Schema of a channel's messages, as stored in recordings and in `schemas/`.
///
/// Uses no `$ref`, `oneOf`, `null` or arrays, and has `properties` in every object.
pub fn json_schema(channel: &ChannelInfo) -> String {
    // Lichtblick's parser refuses anything else; Foxglove and PlotJuggler read it, too.
    let mut properties = Map::new();
    properties.insert("timestamp".to_owned(), timestamp());
    for (name, content) in channel.members() {
        let schema = match content {
            Content::Text(index) => {
                let leaf = &channel.texts[index];
                leaf_schema("string", leaf, leaf.meaning)
            }
            Content::Number(index) => {
                let leaf = &channel.numbers[index];
                leaf_schema("number", leaf, leaf.meaning)
            }
            Content::Object(leaves) => group_schema(channel, name, &leaves),
        };
        properties.insert(name.to_owned(), schema);
    }
    let schema = object(
        Some(channel.schema),
        &format!("{}: {}", channel.topic, channel.meaning),
        properties,
    );
    format!("{schema:#}\n")
}

/// The name of a channel's schema file in `schemas/`.
pub fn file_name(channel: &ChannelInfo) -> String {
    format!("{}.json", channel.schema)
}

fn group_schema(channel: &ChannelInfo, parent: &str, leaves: &[(&str, usize)]) -> Value {
    let mut description = format!("terms of {parent}");
    let mut properties = Map::new();
    for (name, index) in leaves {
        let leaf = &channel.numbers[*index];
        // A vector has one description; members of other objects have their own.
        let meaning = if leaf.is_component {
            description = with_unit_and_frame(leaf.meaning, leaf);
            format!("{name} component")
        } else {
            leaf.meaning.to_owned()
        };
        properties.insert((*name).to_owned(), leaf_schema("number", leaf, &meaning));
    }
    object(None, &description, properties)
}

fn leaf_schema(kind: &str, leaf: &Leaf, meaning: &str) -> Value {
    json!({ "type": kind, "description": with_unit(meaning, leaf) })
}

/// A description with its unit and frame.
pub(super) fn with_unit_and_frame(meaning: &str, leaf: &Leaf) -> String {
    let meaning = with_unit(meaning, leaf);
    if leaf.frame.is_empty() {
        meaning
    } else {
        format!("{meaning}, frame {}", leaf.frame)
    }
}

fn with_unit(meaning: &str, leaf: &Leaf) -> String {
    if leaf.unit.is_empty() {
        meaning.to_owned()
    } else {
        format!("{meaning} [{}]", leaf.unit)
    }
}

fn timestamp() -> Value {
    let mut properties = Map::new();
    properties.insert("sec".to_owned(), integer("whole seconds"));
    properties.insert("nsec".to_owned(), integer("nanoseconds beyond"));
    object(None, "simulation time since the start", properties)
}

fn integer(description: &str) -> Value {
    json!({ "type": "integer", "description": description })
}

fn object(title: Option<&str>, description: &str, properties: Map<String, Value>) -> Value {
    let mut schema = json!({});
    if let Some(title) = title {
        schema["$schema"] = json!("https://json-schema.org/draft/2020-12/schema");
        schema["title"] = json!(title);
    }
    schema["description"] = json!(description);
    schema["type"] = json!("object");
    let required = properties.keys().cloned().collect();
    schema["properties"] = Value::Object(properties);
    schema["required"] = required;
    schema
}
