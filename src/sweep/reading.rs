//! Reading sweep tables.

use super::cells::{Cells, cells};
use super::error::{CellError, SweepError, TableError};
use super::reader::{self, Opened};
use super::spec::axis::find_key;
use super::store::{SPEC_ENTRY, entry};
use crate::run::scenario::{Scenario, Value, Values};
use arrow_array::{Array, RecordBatch, RecordBatchReader as _};
use arrow_schema::{Schema, SchemaRef};
use serde::Deserialize as _;
use serde_json::Value as Json;
use std::path::{Path, PathBuf};

/// The column with the digests of scenarios.
const DIGEST_COLUMN: &str = "scenario_digest";

/// Some columns of a table of outcomes.
#[derive(Clone, Debug)]
pub struct Columns {
    path: PathBuf,
    schema: SchemaRef,
    batches: Vec<RecordBatch>,
}

impl Columns {
    /// Reads columns by name or key.
    ///
    /// # Errors
    /// [`SweepError::Table`] if it is not a Parquet file, or a column is missing.
    pub fn read(path: &Path, names: &[&str]) -> Result<Self, SweepError> {
        reader::read(path, |opened| {
            let mut wanted = Vec::new();
            for name in names {
                wanted.push(find_column(opened.schema(), name)?);
            }
            let reader = reader::batches(opened, wanted)?;
            Ok(Self {
                path: path.to_owned(),
                schema: reader.schema(),
                batches: reader.collect::<Result<_, _>>()?,
            })
        })
    }

    /// The columns of a table in memory; `name` stands for it in errors.
    ///
    /// # Errors
    /// [`SweepError::Table`] if a column is missing.
    pub fn from_batches(
        name: &str,
        names: &[&str],
        schema: SchemaRef,
        batches: Vec<RecordBatch>,
    ) -> Result<Self, SweepError> {
        let path = PathBuf::from(name);
        for name in names {
            find_column(&schema, name).map_err(|reason| SweepError::table(&path, reason))?;
        }
        Ok(Self {
            path,
            schema,
            batches,
        })
    }

    /// The unit of a column; empty if it has none.
    pub fn unit(&self, name: &str) -> &str {
        position(&self.schema, name)
            .and_then(|index| self.schema.field(index).metadata().get("unit"))
            .map_or("", String::as_str)
    }

    /// The numbers of a column; NaN where a cell is empty.
    ///
    /// # Errors
    /// [`SweepError::Table`] if they are not numbers.
    pub fn numbers(&self, name: &str) -> Result<Vec<f64>, SweepError> {
        let mut numbers = Vec::new();
        for cell in self.cells(name)? {
            numbers.push(match cell {
                Some(Value::Number(number)) => number,
                Some(Value::Text(text)) => {
                    return Err(self.invalid(name, CellError::NotANumber(text)));
                }
                None => f64::NAN,
            });
        }
        Ok(numbers)
    }

    /// The cells of a column as strings; `None` for nulls.
    ///
    /// # Errors
    /// [`SweepError::Table`] if they are neither numbers nor words.
    pub fn texts(&self, name: &str) -> Result<Vec<Option<String>>, SweepError> {
        let mut texts = Vec::new();
        for cell in self.cells(name)? {
            texts.push(match cell {
                Some(Value::Number(number)) if !number.is_nan() => Some(number.to_string()),
                Some(Value::Text(text)) => Some(text),
                Some(Value::Number(_)) | None => None,
            });
        }
        Ok(texts)
    }

    fn cells(&self, name: &str) -> Result<Cells, SweepError> {
        let mut all = Vec::new();
        if let Some(index) = position(&self.schema, name) {
            for batch in &self.batches {
                all.extend(cells(batch.column(index)).map_err(|error| self.invalid(name, error))?);
            }
        }
        Ok(all)
    }

    fn invalid(&self, column: &str, error: CellError) -> SweepError {
        SweepError::table(&self.path, TableError::column(column, error))
    }
}

/// The index of a column, given its name or a key's path.
fn position(schema: &Schema, name: &str) -> Option<usize> {
    schema
        .fields()
        .iter()
        .position(|field| normalized(field.name()) == normalized(name))
}

/// The index of a column, which must exist.
fn find_column(schema: &Schema, name: &str) -> Result<usize, TableError> {
    position(schema, name).ok_or_else(|| {
        let fields = schema.fields().iter();
        let columns: Vec<_> = fields.map(|field| field.name().as_str()).collect();
        TableError::no_column(name, &columns)
    })
}

/// The scenario values of a row of a sweep table: those of its base with the row's changes.
///
/// # Errors
/// [`SweepError::Table`] if it is not the table of a sweep, has no such row, or gives another scenario than the one that was
/// run; [`SweepError::Scenario`] if this version doesn't have a key of it.
pub fn values_of_row(table: &Path, row: u64) -> Result<Values, SweepError> {
    reader::read(table, |opened| read_row(row, opened))
}

fn read_row(row: u64, opened: Opened) -> Result<Values, TableError> {
    let spec: Json = entry(opened.metadata(), SPEC_ENTRY)
        .and_then(|text| serde_json::from_str(text).ok())
        .ok_or(TableError::NotASweep)?;
    let bases = spec["bases"].as_array().ok_or(TableError::NotASweep)?;
    let rows = opened.metadata().file_metadata().num_rows() as u64;
    if row >= rows {
        return Err(TableError::NoRow { row, rows });
    }
    let mut reader = opened.with_offset(row as usize).with_limit(1).build()?;
    let batch = reader.next().ok_or(TableError::MissingRow(row))??;
    // The bases are the outermost axis, and each has the same rows.
    let rows_per_base = (rows / bases.len().max(1) as u64).max(1);
    let base = bases
        .get((row / rows_per_base) as usize)
        .and_then(|base| base["scenario"].as_object());
    let mut values = Values::default();
    for (key, value) in base.into_iter().flatten() {
        values.set_value(key, Value::deserialize(value)?)?;
    }
    for (field, column) in batch.schema_ref().fields().iter().zip(batch.columns()) {
        // Columns that are no keys are outcomes.
        if let Ok(key) = find_key(field.name())
            && let Some(value) = first_cell(field.name(), column)?
        {
            values.set_value(key.path, value)?;
        }
    }
    let recorded = match batch.column_by_name(DIGEST_COLUMN) {
        Some(column) => first_cell(DIGEST_COLUMN, column)?,
        None => None,
    };
    let digest = Scenario::new(values.clone()).map(|scenario| Value::Text(scenario.digest()));
    if recorded != digest.ok() {
        return Err(TableError::ModifiedRow(row));
    }
    Ok(values)
}

/// The first cell of a column.
fn first_cell(name: &str, column: &dyn Array) -> Result<Option<Value>, TableError> {
    let cells = cells(column).map_err(|reason| TableError::column(name, reason))?;
    Ok(cells.into_iter().next().flatten())
}

/// A name in which keys and their columns are equal.
fn normalized(name: &str) -> String {
    name.replace('.', "_")
}
