//! Input tables with the values of each run.

mod column;
mod csv;

use self::column::Column;
use super::cells::{cells as column_cells, values_of};
use super::error::{CellError, SweepError, TableError};
use super::reader::{self, Opened};
use super::spec::axis::find_key;
use crate::archive::input::read_file;
use crate::run::scenario::{Key, Value};
use arrow_array::{RecordBatch, new_empty_array};
use arrow_schema::{DataType, Schema};
use serde_json::Value as Json;
use sha2::{Digest as _, Sha256};
use std::path::{Path, PathBuf};

/// Maximum number of rows (held in memory).
const MAX_ROWS: u64 = 10_000_000;

/// A table with a column for each key that varies. Empty cells keep the value of the base.
#[derive(Clone, Debug)]
pub struct Table {
    columns: Vec<Column>,
    rows: u64,
    /// The file that it was read from.
    file: Option<PathBuf>,
}

impl Table {
    /// Reads a `.parquet` or a `.csv` file.
    ///
    /// # Errors
    /// [`SweepError::Table`] for other file types, or a column that is not a key.
    pub fn read(path: &Path) -> Result<Self, SweepError> {
        let extension = path.extension().unwrap_or_default();
        let mut table = if extension == "parquet" {
            reader::read(path, from_parquet)?
        } else if extension == "csv" {
            let text = read_file(path).map_err(|reason| SweepError::io("read", path, reason))?;
            from_csv(&text).map_err(|reason| SweepError::table(path, reason))?
        } else {
            return Err(SweepError::table(path, TableError::Extension));
        };
        table.file = Some(path.to_owned());
        Ok(table)
    }

    /// Reads the columns of Arrow batches, which all have this schema. A pandas index is ignored unless it has the
    /// name of a key.
    ///
    /// # Errors
    /// A column that is not a key, or has values that are neither numbers nor words.
    pub fn from_batches(schema: &Schema, batches: &[RecordBatch]) -> Result<Self, TableError> {
        let rows = batches.iter().map(|batch| batch.num_rows() as u64).sum();
        let mut table = Self::empty(schema, rows)?;
        for batch in batches {
            table.add(batch)?;
        }
        Ok(table)
    }

    /// An empty table for a schema and number of rows, validated before any cell is read.
    fn empty(schema: &Schema, rows: u64) -> Result<Self, TableError> {
        check_rows(rows)?;
        let indices = pandas_indices(schema);
        let mut columns = Vec::new();
        for field in schema.fields() {
            let name = field.name();
            let key = match find_key(name) {
                Ok(key) => key,
                Err(_) if indices.contains(name) || is_nameless_index(name) => continue,
                Err(error) => return Err(error.into()),
            };
            check_type(key, field.data_type())
                .map_err(|reason| TableError::column(name, reason))?;
            columns.push(Column {
                name: name.clone(),
                key,
                cells: Vec::new(),
            });
        }
        Ok(Self {
            columns,
            rows: 0,
            file: None,
        })
    }

    /// Adds the rows of a batch.
    fn add(&mut self, batch: &RecordBatch) -> Result<(), TableError> {
        self.rows += batch.num_rows() as u64;
        check_rows(self.rows.max(1))?;
        for Column { name, cells, .. } in &mut self.columns {
            if let Some(column) = batch.column_by_name(name) {
                cells.extend(
                    column_cells(column).map_err(|reason| TableError::column(name, reason))?,
                );
            }
        }
        Ok(())
    }

    /// The file that it was read from.
    pub(super) fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// The keys that vary.
    pub fn keys(&self) -> Vec<&'static Key> {
        self.columns.iter().map(|column| column.key).collect()
    }

    /// Whether each row has a value for this key, so that none is left to the base.
    pub(super) fn always_has(&self, key: &str) -> bool {
        self.columns
            .iter()
            .any(|column| column.key.path == key && column.cells.iter().all(Option::is_some))
    }

    /// The number of rows.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// The cells of a row.
    pub(super) fn row(&self, row: u64) -> Vec<Option<Value>> {
        self.columns
            .iter()
            .map(|column| column.cells[row as usize].clone())
            .collect()
    }

    /// SHA-256 of keys and cells, independent of the file type.
    pub(super) fn digest(&self) -> String {
        let mut hash = Sha256::new();
        hash.update(self.rows.to_le_bytes());
        for Column { key, cells, .. } in &self.columns {
            hash.update(format!("{}\n", key.path));
            for cell in cells {
                match cell {
                    Some(value) => hash.update(format!("{value}\n")),
                    None => hash.update("\n"),
                }
            }
        }
        format!("{:x}", hash.finalize())
    }
}

/// Checks the number of rows.
fn check_rows(rows: u64) -> Result<(), TableError> {
    match rows {
        0 => Err(TableError::Empty),
        1..=MAX_ROWS => Ok(()),
        _ => Err(TableError::TooManyRows(MAX_ROWS)),
    }
}

/// Checks that a column type suits its key.
fn check_type(key: &Key, kind: &DataType) -> Result<(), CellError> {
    column_cells(&new_empty_array(kind))?;
    let values = values_of(kind);
    match (values.is_string(), key.kind.is_text()) {
        _ if *values == DataType::Null => Ok(()),
        (true, false) => Err(CellError::Words(key.kind)),
        (false, true) => Err(CellError::Numbers(key.kind)),
        (true, true) | (false, false) => Ok(()),
    }
}

fn from_csv(text: &str) -> Result<Table, TableError> {
    let (columns, rows) = csv::read(text)?;
    check_rows(rows)?;
    Ok(Table {
        columns,
        rows,
        file: None,
    })
}

fn from_parquet(opened: Opened) -> Result<Table, TableError> {
    let rows = opened
        .metadata()
        .row_groups()
        .iter()
        // The numbers are those that a damaged file claims.
        .map(|group| u64::try_from(group.num_rows()).unwrap_or(u64::MAX))
        .fold(0, u64::saturating_add);
    let schema = opened.schema().clone();
    let mut table = Table::empty(&schema, rows)?;
    // Columns that aren't keys are not decoded.
    let mut wanted = Vec::new();
    for (index, field) in schema.fields().iter().enumerate() {
        if table
            .columns
            .iter()
            .any(|column| column.name == *field.name())
        {
            wanted.push(index);
        }
    }
    for batch in reader::batches(opened, wanted)? {
        table.add(&batch?)?;
    }
    Ok(table)
}

/// The columns in which pandas has stored its row index.
fn pandas_indices(schema: &Schema) -> Vec<String> {
    let Some(text) = schema.metadata().get("pandas") else {
        return Vec::new();
    };
    let metadata: Json = serde_json::from_str(text).unwrap_or_default();
    let names = metadata["index_columns"].as_array().into_iter().flatten();
    // A RangeIndex is not a column; it is described by an object.
    names
        .filter_map(|name| name.as_str().map(str::to_owned))
        .collect()
}

/// Whether this is the name of an unnamed pandas index: `__index_level_0__`.
fn is_nameless_index(name: &str) -> bool {
    name.strip_prefix("__index_level_")
        .and_then(|rest| rest.strip_suffix("__"))
        .is_some_and(|level| level.parse::<u32>().is_ok())
}
