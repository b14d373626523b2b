//! Reading sweep tables.

use super::axis::find_key;
use super::cells::{Cells, cells};
use super::error::SweepError;
use super::reader::{self, Opened};
use super::store::{SPEC_ENTRY, entry};
use crate::run::scenario::{Scenario, Value, Values};
use arrow_array::{Array, RecordBatch, RecordBatchReader as _};
use arrow_schema::SchemaRef;
use serde::Deserialize as _;
use serde_json::Value as Json;
use std::path::{Path, PathBuf};

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
    /// [`SweepError::File`] if it is not a Parquet file, or a column is missing.
    pub fn read(path: &Path, names: &[&str]) -> Result<Self, SweepError> {
        let wrong = SweepError::table(path);
        reader::read(path, |opened| {
            let fields = opened.schema().fields().iter();
            let all: Vec<&str> = fields.map(|field| field.name().as_str()).collect();
            let is = |name: &str, other: &str| plain(name) == plain(other);
            let is_there = |name: &&&str| all.iter().any(|other| is(name, other));
            if let Some(name) = names.iter().find(|name| !is_there(name)) {
                let all = all.join(", ");
                let reason = format!("no column {name}; columns: {all}");
                return Err(wrong(reason));
            }
            let is_wanted = |at: &usize| names.iter().any(|name| is(name, all[*at]));
            let wanted: Vec<_> = (0..all.len()).filter(is_wanted).collect();
            let reader = reader::batches(opened, wanted).map_err(SweepError::table(path))?;
            let schema = reader.schema();
            let batches = reader.collect::<Result<_, _>>();
            Ok(Self {
                path: path.to_owned(),
                schema,
                batches: batches.map_err(SweepError::table(path))?,
            })
        })
    }

    /// The columns of a table in memory; `name` stands for it in errors.
    ///
    /// # Errors
    /// [`SweepError::File`] if a column is missing.
    pub fn from_batches(
        name: &str,
        names: &[&str],
        schema: SchemaRef,
        batches: Vec<RecordBatch>,
    ) -> Result<Self, SweepError> {
        let columns = Self {
            path: name.into(),
            schema,
            batches,
        };
        match names.iter().find(|name| columns.position(name).is_none()) {
            None => Ok(columns),
            Some(missing) => {
                let fields = columns.schema.fields().iter();
                let all: Vec<&str> = fields.map(|field| field.name().as_str()).collect();
                let reason = format!("no column {missing}; columns: {}", all.join(", "));
                Err(SweepError::table(&columns.path)(reason))
            }
        }
    }

    /// The unit of a column; empty if it has none.
    pub fn unit(&self, name: &str) -> &str {
        let field = self.position(name).map(|at| self.schema.field(at));
        let unit = field.and_then(|field| field.metadata().get("unit"));
        unit.map_or("", String::as_str)
    }

    /// The numbers of a column; NaN where there is none.
    ///
    /// # Errors
    /// [`SweepError::File`] if they are not numbers.
    pub fn numbers(&self, name: &str) -> Result<Vec<f64>, SweepError> {
        let number = |cell: Option<Value>| match cell {
            Some(Value::Number(number)) => Ok(number),
            Some(Value::Text(text)) => Err(self.wrong(name, &format!("{text:?} is not a number"))),
            None => Ok(f64::NAN),
        };
        self.cells(name)?.into_iter().map(number).collect()
    }

    /// The cells of a column as strings; `None` for nulls.
    ///
    /// # Errors
    /// [`SweepError::File`] if they are neither numbers nor words.
    pub fn texts(&self, name: &str) -> Result<Vec<Option<String>>, SweepError> {
        let text = |value: Value| match value {
            Value::Number(number) => (!number.is_nan()).then(|| number.to_string()),
            Value::Text(text) => Some(text),
        };
        let cells = self.cells(name)?.into_iter();
        Ok(cells.map(|cell| cell.and_then(text)).collect())
    }

    fn cells(&self, name: &str) -> Result<Cells, SweepError> {
        let Some(at) = self.position(name) else {
            return Ok(Vec::new());
        };
        let read = self.batches.iter().map(|batch| cells(batch.column(at)));
        let read: Result<Vec<Cells>, _> = read.collect();
        let read = read.map_err(|reason| self.wrong(name, &reason))?;
        Ok(read.concat())
    }

    fn position(&self, name: &str) -> Option<usize> {
        let mut fields = self.schema.fields().iter();
        fields.position(|field| plain(field.name()) == plain(name))
    }

    fn wrong(&self, column: &str, reason: &str) -> SweepError {
        SweepError::table(&self.path)(format!("{column}: {reason}"))
    }
}

/// The scenario values of a row of a sweep table: those of its base with the row's changes.
///
/// # Errors
/// [`SweepError::File`] if it is not the table of a sweep, has no such row, or gives another scenario than the one that was
/// run; [`SweepError::Scenario`] if this version doesn't have a key of it.
pub fn values_of_row(table: &Path, row: u64) -> Result<Values, SweepError> {
    reader::read(table, |opened| read_row(table, row, opened))
}

fn read_row(table: &Path, row: u64, opened: Opened) -> Result<Values, SweepError> {
    let wrong = |reason: String| SweepError::table(table)(reason);
    let spec = entry(opened.metadata(), SPEC_ENTRY);
    let spec: Option<Json> = spec.and_then(|text| serde_json::from_str(text).ok());
    let bases = spec.as_ref().and_then(|spec| spec["bases"].as_array());
    let bases = bases.ok_or_else(|| wrong("it is not the table of a sweep".to_owned()))?;
    let rows = opened.metadata().file_metadata().num_rows() as u64;
    if row >= rows {
        let reason = format!("no row {row}: the table has {rows} rows, numbered from 0");
        return Err(wrong(reason));
    }
    let reader = opened.with_offset(row as usize).with_limit(1).build();
    let batch = reader.map_err(SweepError::table(table))?.next().transpose();
    let batch = batch.map_err(SweepError::table(table))?;
    let batch = batch.ok_or_else(|| wrong(format!("row {row} is missing")))?;
    let rows_per_base = (rows / bases.len().max(1) as u64).max(1);
    let base = bases.get((row / rows_per_base) as usize);
    let base = base.and_then(|base| base["scenario"].as_object());
    let mut values = Values::default();
    for (key, value) in base.into_iter().flatten() {
        let value = Value::deserialize(value).map_err(SweepError::table(table))?;
        values.set_value(key, value)?;
    }
    let cell = |column: &dyn Array| {
        let read = cells(column).map_err(wrong)?;
        Ok::<_, SweepError>(read.into_iter().next().flatten())
    };
    for (field, column) in batch.schema_ref().fields().iter().zip(batch.columns()) {
        if let Ok(key) = find_key(field.name())
            && let Some(value) = cell(column)?
        {
            values.set_value(key.path, value)?;
        }
    }
    let recorded = batch.column_by_name("scenario_digest");
    let recorded = recorded.map(|column| cell(column));
    let digest = Scenario::new(values.clone()).map(|scenario| Value::Text(scenario.digest()));
    if recorded.transpose()?.flatten() != digest.ok() {
        return Err(wrong(format!(
            "the scenario of row {row} does not match its digest: the table was modified or written by another version"
        )));
    }
    Ok(values)
}

/// The name of a column, given that name or a key's path.
fn plain(name: &str) -> String {
    name.replace('.', "_")
}
