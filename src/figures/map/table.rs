//! Maps of the tables of sweeps.

use super::runs::{Map, MapAxis, MapRun};
use crate::run::outcome::COLUMNS;
use crate::sweep::{Columns, SweepError, find_key};

/// Columns that say why a run stopped, whether it looped, and from which scenario it started. Tables of other software
/// may lack them.
pub const CONTEXT_COLUMNS: [&str; 3] = ["scenario", "stop_reason", "loops"];

impl Map {
    /// The map of the columns `show` over `x` and, unless curves are wanted, `y`.
    ///
    /// # Errors
    /// [`SweepError::Table`] if a column has other values than numbers.
    pub fn from_columns(
        columns: &Columns,
        x: &str,
        y: Option<&str>,
        show: &str,
    ) -> Result<Self, SweepError> {
        let xs = columns.numbers(x)?;
        let ys = match y {
            Some(y) => columns.numbers(y)?,
            None => vec![f64::NAN; xs.len()],
        };
        let colors = columns.numbers(show)?;
        let [scenario, stop_reason, loops] = CONTEXT_COLUMNS;
        let scenarios = columns.texts(scenario)?;
        let stops = columns.texts(stop_reason)?;
        let loops = columns.numbers(loops)?;
        let mut runs = Vec::new();
        for (row, x) in xs.into_iter().enumerate() {
            runs.push(MapRun {
                x,
                y: ys[row],
                color: colors[row],
                stop: stops.get(row).cloned().flatten(),
                loops: match loops.get(row) {
                    // An empty cell is NaN: the run has no outcome, or the table lacks the column.
                    Some(loops) if !loops.is_nan() => Some(*loops > 0.0),
                    Some(_) | None => None,
                },
                scenario: scenarios.get(row).cloned().flatten().unwrap_or_default(),
            });
        }
        Ok(Self {
            x: axis(columns, x),
            y: y.map(|y| axis(columns, y)),
            color: axis(columns, show),
            runs,
        })
    }
}

/// The quantity of a column. Other software drops the units of columns; those of keys and outcomes are known.
fn axis(columns: &Columns, name: &str) -> MapAxis {
    let unit = match columns.unit(name) {
        "" => known_unit(name),
        unit => unit,
    };
    MapAxis {
        name: name.replace('.', "_"),
        unit: unit.to_owned(),
    }
}

/// The unit of a key or of an outcome; empty for other names.
fn known_unit(name: &str) -> &'static str {
    if let Ok(key) = find_key(name) {
        return key.unit;
    }
    COLUMNS
        .iter()
        .find(|column| column.name == name)
        .map_or("", |column| column.unit)
}
