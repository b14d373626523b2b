//! The program's tables that the page needs once.

use crate::form;
use crate::run::COLUMNS;
use serde_json::{Value as Json, json};
use toprise::run::scenario::{PRESETS, Preset};

/// The presets with their values, and the names of the columns.
pub fn tables() -> Json {
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "presets": PRESETS.iter().map(preset).collect::<Vec<_>>(),
        "columns": COLUMNS.iter().map(|(name, _)| name).collect::<Vec<_>>(),
    })
}

fn preset(preset: &Preset) -> Json {
    json!({
        "name": preset.name,
        "title": preset.title,
        "description": preset.description,
        "values": preset.values().map(|values| form::texts(&values)).unwrap_or_default(),
    })
}
