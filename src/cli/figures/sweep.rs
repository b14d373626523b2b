//! Figures of sweeps: their columns and runs.

use crate::cli::arguments::{Override, parse_override};
use crate::figures::{Map, MapAxis, MapRun};
use crate::sweep::Columns;
use anyhow::{Error, bail};
use clap::Args;
use std::path::{Path, PathBuf};

/// Arguments for a figure of a sweep.
#[derive(Args, Debug, PartialEq)]
pub(super) struct SweepFigure {
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
fn parse_where(text: &str) -> Result<Override, String> {
    parse_override(text).map_err(|_| "must be COLUMN=VALUE, as in scenario=paper".to_owned())
}

impl SweepFigure {
    /// The table of the sweep; `None` if a figure of runs is wanted.
    pub(super) fn table(&self) -> Option<&PathBuf> {
        self.sweep.as_ref()
    }

    /// Reads what the figure shows.
    pub(super) fn read(&self, table: &Path) -> Result<Map, Error> {
        let (x, y) = (self.x.as_deref().unwrap_or_default(), self.y.as_deref());
        let column = |name: &str| name.replace('.', "_");
        if y.is_some_and(|y| column(y) == column(x)) {
            bail!("--x and --y are both {x}: choose two columns");
        }
        let mut names = vec!["scenario", "stop_reason", "loops", x, &self.show];
        names.extend(y);
        names.extend(self.chosen.iter().map(|(name, _)| name.as_str()));
        let columns = Columns::read(table, &names)?;
        let chosen = self.chosen(&columns, table)?;
        let (scenarios, stops) = (columns.texts("scenario")?, columns.texts("stop_reason")?);
        let (loops, colors) = (columns.numbers("loops")?, columns.numbers(&self.show)?);
        let xs = columns.numbers(x)?;
        let ys = y.map(|y| columns.numbers(y)).transpose()?;
        let run = |row: usize| MapRun {
            x: xs[row],
            y: ys.as_ref().map_or(f64::NAN, |ys| ys[row]),
            color: colors[row],
            stop: stops[row].clone(),
            loops: (!loops[row].is_nan()).then_some(loops[row] > 0.0),
            scenario: scenarios[row].clone().unwrap_or_default(),
        };
        let axis = |name: &str| MapAxis {
            name: name.to_owned(),
            unit: columns.unit(name).to_owned(),
        };
        Ok(Map {
            x: axis(x),
            y: y.map(axis),
            color: axis(&self.show),
            runs: chosen.into_iter().map(run).collect(),
        })
    }

    /// The rows selected by --where.
    fn chosen(&self, columns: &Columns, table: &Path) -> Result<Vec<usize>, Error> {
        let mut rows: Vec<usize> = (0..columns.texts("scenario")?.len()).collect();
        for (name, value) in &self.chosen {
            let cells = columns.texts(name)?;
            let is_met = |row: &usize| is_value(cells[*row].as_deref(), value);
            let (met, left): (Vec<_>, Vec<_>) = rows.into_iter().partition(is_met);
            if met.is_empty() && !left.is_empty() {
                let left = left.into_iter().filter_map(|row| cells[row].clone());
                bail!(
                    "{}: no run has {name} = {value}; {}",
                    table.display(),
                    existing_values(left.collect(), value)
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
        let numbers = cell.parse::<f64>().ok().zip(value.parse::<f64>().ok());
        cell == value || numbers.is_some_and(|(one, other)| one == other)
    })
}

/// Existing values, for the error when --where matches no row.
fn existing_values(mut cells: Vec<String>, value: &str) -> String {
    /// Maximum number of values listed.
    const SHOWN: usize = 4;
    cells.sort_unstable();
    cells.dedup();
    let number = |text: &str| text.parse().unwrap_or(f64::INFINITY);
    let distance = |cell: &String| (number(cell) - number(value)).abs();
    let is_near = cells.len() > SHOWN && cells.iter().all(|cell| distance(cell).is_finite());
    if is_near {
        cells.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
    }
    let rest = if cells.len() > SHOWN { ", …" } else { "" };
    cells.truncate(SHOWN);
    match (cells.len(), is_near) {
        (0, _) => "none has a value".to_owned(),
        (_, true) => format!("nearest values: {}", cells.join(", ")),
        (_, false) => format!("values: {}{rest}", cells.join(", ")),
    }
}
