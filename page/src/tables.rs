//! The program's tables, from which the page makes its controls.

use crate::run::COLUMNS;
use serde_json::{Value as Json, json};
use toprise::run::scenario::{KEYS, Key, Kind, PRESETS, Presence, Preset, Scenario, Value};

/// All tables: the keys of scenarios, the presets with their values, and the names of the columns.
pub fn tables() -> Json {
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "keys": KEYS.iter().map(key).collect::<Vec<_>>(),
        "presets": PRESETS.iter().map(preset).collect::<Vec<_>>(),
        "columns": COLUMNS.iter().map(|(name, _)| name).collect::<Vec<_>>(),
    })
}

fn key(key: &Key) -> Json {
    let words = match key.kind {
        Kind::Choice(words) => Some(words),
        Kind::Text | Kind::Name | Kind::Any | Kind::Between(..) | Kind::Nanoseconds => None,
    };
    let (needs, of) = match key.presence {
        Presence::RequiredWith(other, words) | Presence::OptionalWith(other, words) => {
            (Some(other), words.to_vec())
        }
        Presence::RequiredWithKey(other) => (Some(other), Vec::new()),
        Presence::Required | Presence::Optional => (None, Vec::new()),
    };
    json!({
        "path": key.path,
        "unit": key.unit,
        "meaning": key.meaning,
        "symbol": key.symbol,
        "range": key.kind.to_string(),
        "words": words,
        "typical": key.typical,
        "logarithmic": key.is_logarithmic(),
        // Another key that it needs, with one of these words if there are any.
        "needs": needs,
        "of": of,
        "required": matches!(key.presence, Presence::Required | Presence::RequiredWith(..) | Presence::RequiredWithKey(_)),
    })
}

fn preset(preset: &Preset) -> Json {
    let scenario = preset.scenario().ok();
    let entries = scenario.iter().flat_map(Scenario::entries);
    let values = entries.map(|(key, value)| {
        (
            key.path.to_owned(),
            Json::from(Value::to_set_notation(value)),
        )
    });
    json!({
        "name": preset.name,
        "description": preset.description,
        "values": values.collect::<serde_json::Map<_, _>>(),
    })
}
