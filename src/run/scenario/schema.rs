//! The JSON Schema of scenario files, for completion and validation in editors.

use super::key::{Key, Kind};
use super::keys::KEYS;
use serde_json::{Map, Value, json};

/// The name of the schema in `schemas/`.
pub const SCHEMA_FILE: &str = "scenario.json";

/// The JSON Schema of a scenario file. It checks keys individually; dependencies between keys are checked by
/// [`Scenario::new`](super::Scenario::new).
pub fn schema() -> String {
    // Top-level keys are in a section without a name.
    let mut sections: Vec<(&str, Map<String, Value>)> = Vec::new();
    for key in KEYS {
        let (section, name) = key.path.split_once('.').unwrap_or(("", key.path));
        if sections.last().is_none_or(|(last, _)| *last != section) {
            sections.push((section, Map::new()));
        }
        if let Some((_, properties)) = sections.last_mut() {
            properties.insert(name.to_owned(), of_key(key));
        }
    }
    let mut properties = Map::new();
    for (section, keys) in sections {
        match section {
            "" => properties.extend(keys),
            section => {
                properties.insert(section.to_owned(), object(&keys));
            }
        }
    }
    let mut schema = object(&properties);
    schema["$schema"] = json!("https://json-schema.org/draft/2020-12/schema");
    schema["title"] = json!("toprise scenario");
    format!("{schema:#}\n")
}

fn object(properties: &Map<String, Value>) -> Value {
    json!({ "type": "object", "properties": properties, "additionalProperties": false })
}

fn of_key(key: &Key) -> Value {
    let pattern = "^[A-Za-z0-9_-][A-Za-z0-9._-]{0,99}$";
    let mut schema = match key.kind {
        Kind::Text => json!({ "type": "string" }),
        Kind::Name => json!({ "type": "string", "pattern": pattern }),
        Kind::Choice(words) => json!({ "enum": words }),
        Kind::Any => json!({ "type": "number" }),
        Kind::Between(low, high) => json!({ "type": "number", "minimum": low, "maximum": high }),
        Kind::Nanoseconds => json!({ "type": "number", "minimum": 1e-9, "maximum": 3600 }),
    };
    schema["description"] = json!(format!("{}{}", key.meaning, key.in_unit()));
    schema
}
