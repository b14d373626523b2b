//! Reading columns of a table again.

use super::cells::{Cells, cells};
use super::error::SweepError;
use crate::archive::given::open_file;
use crate::run::scenario::Value;
use arrow_array::RecordBatch;
use arrow_schema::Schema;
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use std::path::{Path, PathBuf};

/// Some columns of a table of outcomes.
#[derive(Clone, Debug)]
pub struct Columns {
    path: PathBuf,
    schema: Schema,
    batches: Vec<RecordBatch>,
}

impl Columns {
    /// Reads the columns of these names, which may be those of keys too.
    ///
    /// # Errors
    /// [`SweepError::Table`] if it is no Parquet file, or a column is missing.
    pub fn read(path: &Path, names: &[&str]) -> Result<Self, SweepError> {
        let (mut columns, batches) = Self::open(path, names)?;
        for batch in batches {
            columns.batches.push(batch?);
        }
        Ok(columns)
    }

    /// Reads the columns of these names some rows at a time, so that memory does not grow with the table.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub(super) fn pieces(
        path: &Path,
        names: &[&str],
    ) -> Result<impl Iterator<Item = Result<Self, SweepError>>, SweepError> {
        let (empty, batches) = Self::open(path, names)?;
        Ok(batches.map(move |batch| {
            let batches = vec![batch?];
            Ok(Self {
                batches,
                ..empty.clone()
            })
        }))
    }

    /// The columns without a row, and what reads their rows.
    fn open(
        path: &Path,
        names: &[&str],
    ) -> Result<(Self, impl Iterator<Item = Result<RecordBatch, SweepError>>), SweepError> {
        let path = path.to_owned();
        let of_path = path.clone();
        let wrong = move |reason: String| SweepError::Table {
            path: of_path.clone(),
            reason,
        };
        let file = open_file(&path).map_err(SweepError::io("read", &path))?;
        let builder = ParquetRecordBatchReaderBuilder::try_new(file)
            .map_err(|error| wrong(error.to_string()))?;
        let schema = builder.schema().as_ref().clone();
        let all: Vec<&str> = schema
            .fields()
            .iter()
            .map(|field| field.name().as_str())
            .collect();
        for name in names {
            if !all.iter().any(|column| plain(column) == plain(name)) {
                return Err(wrong(format!(
                    "there is no column {name}; there are {}",
                    all.join(", ")
                )));
            }
        }
        let wanted: Vec<usize> = (0..all.len())
            .filter(|i| names.iter().any(|name| plain(name) == plain(all[*i])))
            .collect();
        let mask = ProjectionMask::roots(builder.parquet_schema(), wanted);
        let reader = builder
            .with_projection(mask)
            .build()
            .map_err(|error| wrong(error.to_string()))?;
        let batches = reader.map(move |batch| batch.map_err(|error| wrong(error.to_string())));
        let columns = Self {
            path,
            schema,
            batches: Vec::new(),
        };
        Ok((columns, batches))
    }

    /// The unit of a column; empty if it has none.
    #[must_use]
    pub fn unit(&self, name: &str) -> &str {
        let mut fields = self.schema.fields().iter();
        let field = fields.find(|field| plain(field.name()) == plain(name));
        let unit = field.and_then(|field| field.metadata().get("unit"));
        unit.map_or("", String::as_str)
    }

    /// The numbers of a column; NaN where there is none.
    ///
    /// # Errors
    /// [`SweepError::Table`] if they are no numbers.
    pub fn numbers(&self, name: &str) -> Result<Vec<f64>, SweepError> {
        let number = |cell: Option<Value>| match cell {
            Some(Value::Number(number)) => Ok(number),
            Some(Value::Text(text)) => Err(self.wrong(name, &format!("{text:?} is no number"))),
            None => Ok(f64::NAN),
        };
        self.cells(name)?.into_iter().map(number).collect()
    }

    /// The cells of a column as texts; none where there is nothing.
    ///
    /// # Errors
    /// [`SweepError::Table`] if they are neither numbers nor words.
    pub fn texts(&self, name: &str) -> Result<Vec<Option<String>>, SweepError> {
        let text = |value: Value| match value {
            Value::Number(number) => (!number.is_nan()).then(|| number.to_string()),
            Value::Text(text) => Some(text),
        };
        let cells = self.cells(name)?.into_iter();
        Ok(cells.map(|cell| cell.and_then(text)).collect())
    }

    fn cells(&self, name: &str) -> Result<Cells, SweepError> {
        let mut all = Vec::new();
        for batch in &self.batches {
            let schema = batch.schema_ref();
            let mut fields = schema.fields().iter();
            let index = fields.position(|field| plain(field.name()) == plain(name));
            if let Some(index) = index {
                let read = cells(batch.column(index).as_ref());
                all.extend(read.map_err(|reason| self.wrong(name, &reason))?);
            }
        }
        Ok(all)
    }

    fn wrong(&self, column: &str, reason: &str) -> SweepError {
        SweepError::Table {
            path: self.path.clone(),
            reason: format!("{column}: {reason}"),
        }
    }
}

/// The name of a column, for a key's path too.
pub(super) fn plain(name: &str) -> String {
    name.replace('.', "_")
}
