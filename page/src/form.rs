//! The keys that can be set in a scenario, for the page's controls.

use serde_json::{Value as Json, json};
use std::collections::BTreeMap;
use toprise::run::scenario::{Allowed, ApplicableKey, KEYS, Value, Values};

/// Keys that don't change the run.
const HIDDEN: [&str; 3] = ["format", "name", "description"];

/// The keys that apply with the values of the others, and what they may be.
pub fn keys(values: &Values) -> Json {
    values
        .applicable_keys()
        .iter()
        .filter(|applicable| !HIDDEN.contains(&applicable.key.path))
        .map(describe)
        .collect()
}

fn describe(applicable: &ApplicableKey) -> Json {
    let key = applicable.key;
    let (words, range) = match &applicable.allowed {
        Allowed::Text => (None, None),
        Allowed::Words(words) => (Some(words), None),
        Allowed::Range(range) => (None, Some(range)),
    };
    json!({
        "path": key.path,
        "unit": key.unit,
        "meaning": key.meaning,
        "symbol": key.symbol,
        "words": words,
        "range": range,
        "typical": key.typical,
        "default": key.default,
        "is_logarithmic": key.is_logarithmic(),
        "is_required": applicable.is_required,
    })
}

/// The values that are set, in `--set` notation.
pub fn texts(values: &Values) -> BTreeMap<&'static str, String> {
    KEYS.iter()
        .filter_map(|key| Some((key.path, values.get(key.path)?.to_set_notation())))
        .collect()
}

/// The keys whose values differ, in `--set` notation; empty if the key is removed.
pub fn differences(preset: &Values, values: &Values) -> BTreeMap<&'static str, String> {
    KEYS.iter()
        .filter(|key| preset.get(key.path) != values.get(key.path))
        .map(|key| {
            let value = values.get(key.path).map(Value::to_set_notation);
            (key.path, value.unwrap_or_default())
        })
        .collect()
}
