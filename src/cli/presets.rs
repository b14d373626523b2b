//! `toprise presets`.

use super::{Done, format, output};
use crate::run::scenario::{PRESETS, Preset};
use anyhow::Error;

/// Lists the presets, or prints one as TOML.
pub(super) fn presets(name: Option<&str>) -> Result<Done, Error> {
    let text = match name {
        Some(name) => Preset::find(name)?.scenario()?.to_toml(),
        None => {
            let row =
                |preset: &Preset| vec![preset.name.to_owned(), preset.description().to_owned()];
            let rows: Vec<_> = PRESETS.iter().map(row).collect();
            format::table(&rows, &[])
        }
    };
    output::print(&text)?;
    Ok(Done::Well)
}
