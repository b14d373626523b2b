//! A table that says what each run changes: a design made elsewhere.

use super::axis::find_key;
use super::error::SweepError;
use crate::run::scenario::{Key, Value, hex};
use arrow_array::cast::AsArray as _;
use arrow_array::types::*;
use arrow_array::{Array, RecordBatch};
use arrow_schema::DataType;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use sha2::{Digest as _, Sha256};
use std::fs::File;
use std::path::Path;

/// A table with a column for each key that varies. Where a cell is empty, the base's own value holds.
#[derive(Clone, Debug)]
pub struct Table {
    columns: Vec<Column>,
    rows: u64,
}

#[derive(Clone, Debug)]
struct Column {
    key: &'static Key,
    cells: Vec<Option<Value>>,
}

impl Table {
    /// Reads a `.parquet` or a `.csv` file.
    ///
    /// # Errors
    /// [`SweepError::Table`] for what is neither, or has a column that is no key.
    pub fn read(path: &Path) -> Result<Self, SweepError> {
        let has = |kind| path.extension().is_some_and(|extension| extension == kind);
        let file = File::open(path).map_err(SweepError::io("read", path))?;
        let read = if has("parquet") {
            from_parquet(file)
        } else if has("csv") {
            from_csv(file)
        } else {
            Err("must be a .parquet or a .csv file".to_owned())
        };
        read.map_err(|reason| SweepError::Table {
            path: path.to_owned(),
            reason,
        })
    }

    /// Takes the columns of Arrow's tables.
    ///
    /// # Errors
    /// A column that is no key, or has values that are no numbers or words.
    pub fn from_batches(batches: &[RecordBatch]) -> Result<Self, String> {
        let Some(first) = batches.first() else {
            return Err("there are no rows".to_owned());
        };
        let mut columns = Vec::new();
        for (index, field) in first.schema().fields().iter().enumerate() {
            let key = find_key(field.name()).map_err(|error| error.to_string())?;
            let mut cells = Vec::new();
            for batch in batches {
                let array = batch.column(index);
                for row in 0..array.len() {
                    let value = cell(key, array.as_ref(), row);
                    cells.push(value.map_err(|reason| format!("{}: {reason}", field.name()))?);
                }
            }
            columns.push(Column { key, cells });
        }
        let rows = batches.iter().map(|batch| batch.num_rows() as u64).sum();
        Ok(Self { columns, rows })
    }

    /// The keys that vary.
    #[must_use]
    pub fn keys(&self) -> Vec<&'static Key> {
        self.columns.iter().map(|column| column.key).collect()
    }

    /// The number of rows.
    #[must_use]
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// The cells of a row.
    pub(super) fn row(&self, row: u64) -> Vec<Option<Value>> {
        let cells = |column: &Column| column.cells[row as usize].clone();
        self.columns.iter().map(cells).collect()
    }

    /// SHA-256 of keys and cells, whatever kind of file they come from.
    pub(super) fn digest(&self) -> String {
        let mut hash = Sha256::new();
        hash.update(self.rows.to_le_bytes());
        for Column { key, cells } in &self.columns {
            hash.update(format!("{}\n", key.path));
            for cell in cells {
                match cell {
                    Some(value) => hash.update(format!("{value}\n")),
                    None => hash.update("\n"),
                }
            }
        }
        hex(&hash.finalize())
    }
}

fn from_parquet(file: File) -> Result<Table, String> {
    let told = |error: &dyn std::error::Error| error.to_string();
    let builder = ParquetRecordBatchReaderBuilder::try_new(file).map_err(|error| told(&error))?;
    let reader = builder.build().map_err(|error| told(&error))?;
    let batches: Result<Vec<_>, _> = reader.collect();
    Table::from_batches(&batches.map_err(|error| told(&error))?)
}

fn from_csv(file: File) -> Result<Table, String> {
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_reader(file);
    let header = reader.headers().map_err(|error| error.to_string())?;
    let keys = header.iter().map(find_key);
    let mut columns = Vec::new();
    for key in keys {
        columns.push(Column {
            key: key.map_err(|error| error.to_string())?,
            cells: Vec::new(),
        });
    }
    let mut rows = 0;
    for record in reader.records() {
        let record = record.map_err(|error| error.to_string())?;
        rows += 1;
        for (Column { key, cells }, text) in columns.iter_mut().zip(&record) {
            let value = if text.is_empty() {
                None
            } else if key.kind.is_text() {
                Some(Value::Text(text.to_owned()))
            } else {
                let number = text.parse().map(Value::Number);
                let told = |_| format!("row {rows}: {} = {text:?} is no number", key.path);
                Some(number.map_err(told)?)
            };
            cells.push(value);
        }
    }
    if rows == 0 {
        return Err("there are no rows".to_owned());
    }
    Ok(Table { columns, rows })
}

/// The text in a row of a column of any of Arrow's kinds of texts; none if it has none.
#[must_use]
pub fn word(array: &dyn Array, row: usize) -> Option<String> {
    if let Some(dictionary) = array.as_any_dictionary_opt() {
        let place = dictionary
            .is_valid(row)
            .then(|| dictionary.normalized_keys()[row])?;
        return word(dictionary.values().as_ref(), place);
    }
    let word = match array.data_type() {
        _ if array.is_null(row) => return None,
        DataType::Utf8 => array.as_string::<i32>().value(row),
        DataType::LargeUtf8 => array.as_string::<i64>().value(row),
        DataType::Utf8View => array.as_string_view().value(row),
        _ => return None,
    };
    Some(word.to_owned())
}

/// A cell of a column for this key.
fn cell(key: &Key, array: &dyn Array, row: usize) -> Result<Option<Value>, String> {
    if let DataType::Dictionary(..) = array.data_type() {
        let dictionary = array.as_any_dictionary();
        if dictionary.is_null(row) {
            return Ok(None);
        }
        let place = dictionary.normalized_keys()[row];
        return cell(key, dictionary.values().as_ref(), place);
    }
    if array.is_null(row) {
        return Ok(None);
    }
    let value = match array.data_type() {
        DataType::Null => return Ok(None),
        DataType::Utf8 | DataType::LargeUtf8 | DataType::Utf8View => {
            Value::Text(word(array, row).unwrap_or_default())
        }
        DataType::Float64 => Value::Number(array.as_primitive::<Float64Type>().value(row)),
        DataType::Float32 => {
            Value::Number(f64::from(array.as_primitive::<Float32Type>().value(row)))
        }
        DataType::Int64 => Value::Number(array.as_primitive::<Int64Type>().value(row) as f64),
        DataType::Int32 => Value::Number(f64::from(array.as_primitive::<Int32Type>().value(row))),
        DataType::Int16 => Value::Number(f64::from(array.as_primitive::<Int16Type>().value(row))),
        DataType::Int8 => Value::Number(f64::from(array.as_primitive::<Int8Type>().value(row))),
        DataType::UInt64 => Value::Number(array.as_primitive::<UInt64Type>().value(row) as f64),
        DataType::UInt32 => Value::Number(f64::from(array.as_primitive::<UInt32Type>().value(row))),
        DataType::UInt16 => Value::Number(f64::from(array.as_primitive::<UInt16Type>().value(row))),
        DataType::UInt8 => Value::Number(f64::from(array.as_primitive::<UInt8Type>().value(row))),
        other => {
            return Err(format!(
                "values of type {other} are neither numbers nor words"
            ));
        }
    };
    let fits = matches!(value, Value::Text(_)) == key.kind.is_text();
    if fits {
        Ok(Some(value))
    } else {
        Err(format!("{value}: must be {}", key.kind))
    }
}
