//! The keys that can be set in a scenario, for the page's controls.

use serde_json::{Value as Json, json};
use std::collections::BTreeMap;
use toprise::run::scenario::{Allowed, ApplicableKey, KEYS, Kind, Scenario, Value, Values};

/// Keys that don't change the run.
const HIDDEN: [&str; 3] = ["format", "name", "description"];

/// The keys that apply with the values of the others, and what they may be.
pub fn keys(values: &Values) -> Json {
    let scenario = Scenario::new(values.clone()).ok();
    let mut keys = Vec::new();
    for applicable in values.applicable_keys() {
        if HIDDEN.contains(&applicable.key.path) {
            continue;
        }
        let mut key = describe(&applicable);
        if applicable.key.kind == Kind::Formula {
            key["curve"] = json!(scenario.as_ref().map(curve));
        }
        keys.push(key);
    }
    Json::Array(keys)
}

/// Points of the coefficient of friction over the slip speeds that the energy allows: `[v, μ]`.
fn curve(scenario: &Scenario) -> Vec<[f64; 2]> {
    const INTERVALS: u32 = 100;
    let largest = scenario.model.largest_slip_speed(&scenario.start());
    let mut points = Vec::new();
    for point in 1..=INTERVALS {
        let speed = largest * f64::from(point) / f64::from(INTERVALS);
        let per_speed = scenario.model.friction.law.resistance(speed, 0.0, 1.0);
        points.push([speed, per_speed * speed]);
    }
    points
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
        "label": key.label,
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
        .filter(|key| !HIDDEN.contains(&key.path))
        .filter(|key| preset.get(key.path) != values.get(key.path))
        .map(|key| {
            let value = values.get(key.path).map(Value::to_set_notation);
            (key.path, value.unwrap_or_default())
        })
        .collect()
}
