//! Figures of sweeps: their columns and runs.

use crate::cli::arguments::{ArgumentError, Override, parse_override};
use crate::cli::extension::{FeatureArguments, MapTable};
use crate::figures::{CONTEXT_COLUMNS, Map};
use crate::sweep::Columns;
use anyhow::{Error, bail};
use clap::Args;
use std::path::{Path, PathBuf};

/// Arguments for a figure of a sweep.
#[derive(Args, Clone, Debug, PartialEq)]
pub(in crate::cli) struct MapArguments {
    /// Draw the outcomes of a sweep: a map over --x and --y, or curves over --x
    #[arg(long, value_name = "TABLE", conflicts_with_all = ["runs", "only"], requires = "x")]
    sweep: Option<PathBuf>,

    /// Column on the x axis, e.g. friction_k
    #[arg(long, value_name = "COLUMN", requires = "sweep")]
    x: Option<String>,

    /// Column on the y axis
    #[arg(long, value_name = "COLUMN", requires = "sweep")]
    y: Option<String>,

    /// Column shown as colours or curves
    #[arg(
        long,
        value_name = "COLUMN",
        default_value = "rise_time",
        requires = "sweep"
    )]
    show: String,

    /// Draw only rows with this value in a column, e.g. scenario=paper
    #[arg(long = "where", value_name = "COLUMN=VALUE", value_parser = parse_where, requires = "sweep")]
    chosen: Vec<Override>,
}

/// Reads the value of `--where`.
fn parse_where(text: &str) -> Result<Override, ArgumentError> {
    parse_override(text).map_err(|_| ArgumentError("COLUMN=VALUE, as in scenario=paper"))
}

/// A figure of a sweep.
struct MapPlan {
    table: PathBuf,
    x: String,
    arguments: MapArguments,
}

impl FeatureArguments<(), Box<dyn MapTable>> for MapArguments {
    fn plan(&self, (): ()) -> Result<Option<Box<dyn MapTable>>, Error> {
        // Clap requires --x with --sweep.
        let (Some(table), Some(x)) = (&self.sweep, &self.x) else {
            return Ok(None);
        };
        if self.y.as_ref().is_some_and(|y| column(y) == column(x)) {
            bail!("--x and --y are both {x}: choose two columns");
        }
        Ok(Some(Box::new(MapPlan {
            table: table.clone(),
            x: x.clone(),
            arguments: self.clone(),
        })))
    }
}

/// The column of a key.
fn column(name: &str) -> String {
    // As columns of sweeps are named; keys are accepted, too.
    name.replace('.', "_")
}

impl MapTable for MapPlan {
    fn path(&self) -> &Path {
        &self.table
    }

    fn read(&self) -> Result<Map, Error> {
        let MapArguments {
            y, show, chosen, ..
        } = &self.arguments;
        let mut names = CONTEXT_COLUMNS.to_vec();
        names.extend([self.x.as_str(), show]);
        names.extend(y.as_deref());
        names.extend(chosen.iter().map(|(name, _)| name.as_str()));
        let columns = Columns::read(&self.table, &names)?;
        let chosen = self.chosen(&columns)?;
        let mut map = Map::from_columns(&columns, &self.x, y.as_deref(), show)?;
        map.runs = chosen
            .into_iter()
            .map(|row| map.runs[row].clone())
            .collect();
        Ok(map)
    }
}

impl MapPlan {
    /// The rows selected by --where.
    fn chosen(&self, columns: &Columns) -> Result<Vec<usize>, Error> {
        let mut rows: Vec<usize> = (0..columns.texts("scenario")?.len()).collect();
        for (name, value) in &self.arguments.chosen {
            let cells = columns.texts(name)?;
            let (met, left): (Vec<_>, Vec<_>) = rows
                .into_iter()
                .partition(|row| is_value(cells[*row].as_deref(), value));
            // The condition that leaves no rows is to blame, not those after it.
            if met.is_empty() && !left.is_empty() {
                let existing = left.into_iter().filter_map(|row| cells[row].clone());
                bail!(
                    "{}: no run has {name} = {value}; {}",
                    self.table.display(),
                    existing_values(existing.collect())
                );
            }
            rows = met;
        }
        Ok(rows)
    }
}

/// Whether a cell equals the --where value (numbers are compared numerically).
fn is_value(cell: Option<&str>, value: &str) -> bool {
    cell.is_some_and(|cell| {
        // `--where friction_k=1e-2` means the cell 0.01.
        let numbers = cell.parse::<f64>().ok().zip(value.parse::<f64>().ok());
        cell == value || numbers.is_some_and(|(one, other)| one == other)
    })
}

/// Existing values, for the error when --where matches no row.
fn existing_values(mut cells: Vec<String>) -> String {
    /// Maximum number of values listed.
    const SHOWN: usize = 4;
    cells.sort_unstable();
    cells.dedup();
    let rest = if cells.len() > SHOWN { ", …" } else { "" };
    cells.truncate(SHOWN);
    match cells.len() {
        0 => "none has a value".to_owned(),
        _ => format!("values: {}{rest}", cells.join(", ")),
    }
}
