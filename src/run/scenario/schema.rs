//! The JSON Schema of scenario files, for completion and validation in editors.

use super::key::{Key, Kind};
use super::keys::KEYS;
use serde_json::{Value, json};

/// The name of the schema in `schemas/`.
pub const SCHEMA_FILE: &str = "scenario.json";

/// The JSON Schema of a scenario file. It checks keys individually; dependencies between keys are checked by
/// [`Scenario::new`](super::Scenario::new).
pub fn schema() -> String {
    let mut schema = object();
    for key in KEYS {
        let mut place = &mut schema["properties"];
        let mut name = key.path;
        if let Some((section, inner)) = key.path.split_once('.') {
            if place.get(section).is_none() {
                place[section] = object();
            }
            (place, name) = (&mut place[section]["properties"], inner);
        }
        place[name] = key_schema(key);
    }
    schema["$schema"] = json!("https://json-schema.org/draft/2020-12/schema");
    schema["title"] = json!("toprise scenario");
    format!("{schema:#}\n")
}

fn object() -> Value {
    json!({ "type": "object", "properties": {}, "additionalProperties": false })
}

fn key_schema(key: &Key) -> Value {
    // The names that `is_name` in `parse.rs` accepts.
    let pattern = "^[A-Za-z0-9_-][A-Za-z0-9._-]{0,99}$";
    let mut schema = match key.kind {
        Kind::Text | Kind::Formula => json!({ "type": "string" }),
        Kind::Name => json!({ "type": "string", "pattern": pattern }),
        Kind::Choice(words) => json!({ "enum": words }),
        Kind::Any => json!({ "type": "number" }),
        Kind::Between(low, high) => json!({ "type": "number", "minimum": low, "maximum": high }),
        Kind::Nanoseconds => json!({ "type": "number", "minimum": 1e-9, "maximum": 3600 }),
    };
    schema["description"] = json!(format!("{}{}", key.meaning, key.in_unit()));
    schema
}
