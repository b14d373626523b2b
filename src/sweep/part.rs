//! A part of a sweep's table: rows as columns, columns as Parquet.

use super::checksum;
use super::counts::Counts;
use super::effort::{BLOCK_ROWS, estimate_steps, part_rows};
use super::row::{RowResult, Run, Watch, row};
use super::spec::Spec;
use super::spec::axis::column_name;
use crate::run::outcome::{COLUMNS, Column, Outcome, Read, outcome};
use crate::run::scenario::{Key, Scenario, ScenarioError, Value};
use arrow_array::{ArrayRef, Float64Array, Int64Array, RecordBatch, StringArray};
use arrow_schema::{DataType, Field, Schema, SchemaRef};
use parquet::arrow::ArrowWriter;
use parquet::basic::{Compression, ZstdLevel};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties, WriterVersion};
use rayon::iter::{IndexedParallelIterator as _, IntoParallelIterator as _, ParallelIterator as _};
use serde_json::json;
use std::collections::HashMap;
use std::io::Cursor;
use std::ops::Range;
use std::sync::Arc;

/// Number of rows, evenly spaced, whose work is estimated: an axis that makes runs longer shows in some of them.
const PROBES: u64 = 64;

/// The entry of a file's metadata with the number of rows for each outcome.
pub(super) const COUNTS_ENTRY: &str = "toprise.counts";

/// A sweep that can be computed row by row.
pub struct Sweep {
    spec: Spec,
    schema: SchemaRef,
    part_rows: u64,
    run: Run,
}

impl Sweep {
    /// The sweep that a spec defines.
    pub fn new(spec: Spec) -> Self {
        let schema = Arc::new(Schema::new(fields(&spec)));
        Self {
            part_rows: part_rows(steps_per_row(&spec)),
            spec,
            schema,
            run: |scenario, carry_on| outcome(scenario, carry_on),
        }
    }

    /// Replaces the function that runs a scenario (for tests).
    pub fn with_run(self, run: Run) -> Self {
        Self { run, ..self }
    }

    /// The spec.
    pub fn spec(&self) -> &Spec {
        &self.spec
    }

    /// The columns of the table, with units and meanings as metadata.
    pub fn schema(&self) -> SchemaRef {
        self.schema.clone()
    }

    /// Replaces the number of rows of a part by a divisor of 1000 (for tests).
    pub fn with_part_rows(self, part_rows: u64) -> Self {
        Self { part_rows, ..self }
    }

    /// The number of rows of a part, which takes about 10 s on one core; the last part may be shorter.
    pub fn part_rows(&self) -> u64 {
        self.part_rows
    }

    /// The number of parts.
    pub fn parts(&self) -> u64 {
        self.spec.rows().div_ceil(self.part_rows)
    }

    /// The rows of a part.
    pub fn rows_of(&self, part: u64) -> Range<u64> {
        let start = part.saturating_mul(self.part_rows).min(self.spec.rows());
        start..(start + self.part_rows).min(self.spec.rows())
    }

    /// The parts of each row group of the table.
    pub(super) fn blocks(&self) -> impl Iterator<Item = Range<u64>> + use<> {
        let (parts, size) = (self.parts(), BLOCK_ROWS / self.part_rows);
        (0..parts.div_ceil(size)).map(move |block| block * size..((block + 1) * size).min(parts))
    }

    /// Some rows of the table, computed with all threads of the current pool, and their counts. `None` if cancelled by
    /// `watch`.
    ///
    /// # Panics
    /// Never; the columns match the schema.
    pub fn batch(&self, rows: Range<u64>, watch: &Watch<'_>) -> Option<(RecordBatch, Counts)> {
        // Rows are distributed individually for load balancing.
        let computed = (0..rows.clone().count())
            .into_par_iter()
            .with_max_len(1)
            .map(|index| self.row(rows.start + index as u64, watch))
            .collect::<Option<Vec<RowResult>>>()?;
        let mut counts = Counts::default();
        for (run, RowResult { result, .. }) in rows.clone().zip(&computed) {
            match result {
                Ok(outcome) => counts.count_stop(outcome.end.stop),
                Err(failure) => counts.count_error(run, failure),
            }
        }
        let mut columns = self.design_columns(rows);
        for column in COLUMNS {
            let outcomes = computed.iter().map(|row| row.result.as_ref().ok());
            columns.push(outcome_column(column, outcomes));
        }
        let digests: StringArray = computed.iter().map(|row| row.digest.as_ref()).collect();
        let errors: StringArray = computed
            .iter()
            .map(|row| row.result.as_ref().err().map(ToString::to_string))
            .collect();
        columns.push(Arc::new(digests));
        columns.push(Arc::new(errors));
        Some((self.batch_of(columns), counts))
    }

    /// Some rows of the design: their numbers, bases and changed keys, without outcomes.
    ///
    /// # Panics
    /// Never: the columns are made for the schema.
    pub fn design(&self, rows: Range<u64>) -> RecordBatch {
        self.batch_of(self.design_columns(rows))
    }

    /// The first columns of the table.
    fn batch_of(&self, columns: Vec<ArrayRef>) -> RecordBatch {
        let fields = self.schema.fields()[..columns.len()].to_vec();
        let batch = RecordBatch::try_new(Arc::new(Schema::new(fields)), columns);
        batch.expect("the columns are made for the schema")
    }

    /// The scenario of a row.
    ///
    /// # Errors
    /// [`ScenarioError`] if the changed keys are invalid.
    pub fn scenario(&self, row: u64) -> Result<Scenario, ScenarioError> {
        scenario(&self.spec, row)
    }

    fn row(&self, index: u64, watch: &Watch<'_>) -> Option<RowResult> {
        let scenario = self.scenario(index);
        let row = row(scenario, self.spec.max_steps, self.run, watch)?;
        (watch.row_done)(row.result.as_ref().ok().map(|outcome| outcome.end.stop));
        Some(row)
    }

    fn design_columns(&self, rows: Range<u64>) -> Vec<ArrayRef> {
        let mut columns: Vec<ArrayRef> = vec![
            // Signed, because Spark has no unsigned integers.
            Arc::new(Int64Array::from_iter_values(
                rows.clone().map(|row| row as i64),
            )),
            Arc::new(StringArray::from_iter_values(
                rows.clone().map(|row| &self.spec.base(row).name),
            )),
        ];
        let mut values: Vec<_> = rows.map(|row| self.spec.values(row)).collect();
        for (index, key) in self.spec.keys().iter().enumerate() {
            let cells = values.iter_mut().map(|row| row[index].take());
            columns.push(key_column(key, cells));
        }
        columns
    }
}

/// The scenario of a row.
fn scenario(spec: &Spec, row: u64) -> Result<Scenario, ScenarioError> {
    let mut values = spec.base(row).values.clone();
    for (key, value) in spec.keys().iter().zip(spec.values(row)) {
        if let Some(value) = value {
            values.set_value(key.path, value)?;
        }
    }
    Scenario::new(values)
}

/// The estimated number of steps of the longest runs.
fn steps_per_row(spec: &Spec) -> f64 {
    let distance = spec.rows().div_ceil(PROBES);
    let max_steps = spec.max_steps.map_or(f64::INFINITY, |max| max as f64);
    (0..PROBES)
        .map(|probe| probe * distance)
        .take_while(|row| *row < spec.rows())
        .filter_map(|row| scenario(spec, row).ok())
        .map(|scenario| estimate_steps(&scenario).min(max_steps))
        .fold(0.0, f64::max)
}

/// The values of a key.
fn key_column(key: &Key, cells: impl Iterator<Item = Option<Value>>) -> ArrayRef {
    if key.kind.is_text() {
        let texts = cells.map(|cell| match cell {
            Some(Value::Text(text)) => Some(text),
            Some(Value::Number(_)) | None => None,
        });
        Arc::new(texts.collect::<StringArray>())
    } else {
        let numbers = cells.map(|cell| match cell {
            Some(Value::Number(number)) => Some(number),
            Some(Value::Text(_)) | None => None,
        });
        Arc::new(numbers.collect::<Float64Array>())
    }
}

/// The values of a column of the outcome.
fn outcome_column<'a>(
    column: &Column,
    outcomes: impl Iterator<Item = Option<&'a Outcome>>,
) -> ArrayRef {
    match column.read {
        Read::Text(read) => Arc::new(outcomes.map(|o| read(o?)).collect::<StringArray>()),
        Read::Integer(read) => Arc::new(outcomes.map(|o| read(o?)).collect::<Int64Array>()),
        Read::Number(read) => Arc::new(outcomes.map(|o| read(o?)).collect::<Float64Array>()),
    }
}

/// The columns: number and base of a run, its changed keys, its outcome, its digest or error.
fn fields(spec: &Spec) -> Vec<Field> {
    let mut fields = vec![
        field("run", DataType::Int64, "", "number of the row").with_nullable(false),
        text_field("scenario", "name of the scenario that the run starts from")
            .with_nullable(false),
    ];
    fields.extend(spec.keys().iter().map(|key| {
        let kind = if key.kind.is_text() {
            DataType::Utf8
        } else {
            DataType::Float64
        };
        field(&column_name(key), kind, key.unit, key.meaning)
    }));
    for column in COLUMNS {
        let kind = match column.read {
            Read::Text(_) => DataType::Utf8,
            Read::Integer(_) => DataType::Int64,
            Read::Number(_) => DataType::Float64,
        };
        fields.push(field(column.name, kind, column.unit, &column.description()));
    }
    fields.push(text_field(
        "scenario_digest",
        "SHA-256 of the scenario; null if there is none",
    ));
    fields.push(text_field(
        "error",
        "error message of a run that failed; null if it has an outcome",
    ));
    fields
}

fn text_field(name: &str, meaning: &str) -> Field {
    field(name, DataType::Utf8, "", meaning)
}

fn field(name: &str, kind: DataType, unit: &str, meaning: &str) -> Field {
    let mut metadata = HashMap::from([("meaning".to_owned(), meaning.to_owned())]);
    if !unit.is_empty() {
        metadata.insert("unit".to_owned(), unit.to_owned());
    }
    Field::new(name, kind, true).with_metadata(metadata)
}

/// Writer settings, independent of machine and time.
pub(super) fn properties(entries: Vec<KeyValue>) -> WriterProperties {
    // The digits of floating-point numbers are nearly random: higher levels take longer and gain little.
    let level = ZstdLevel::try_new(1).unwrap_or_default();
    WriterProperties::builder()
        .set_writer_version(WriterVersion::PARQUET_1_0)
        // Without the version of the `parquet` crate, which would change the bytes with each update.
        .set_created_by("toprise".to_owned())
        .set_compression(Compression::ZSTD(level))
        .set_statistics_enabled(EnabledStatistics::Chunk)
        // Row groups of parts are copied into the table as bytes; an index of pages would have to be made anew.
        .set_offset_index_disabled(true)
        .set_key_value_metadata(Some(entries))
        .build()
}

/// The bytes of a part with an identifying metadata entry.
///
/// # Errors
/// [`ParquetError`] if the writer fails.
pub(super) fn part_bytes(
    batch: &RecordBatch,
    counts: &Counts,
    name: KeyValue,
) -> Result<Vec<u8>, ParquetError> {
    let entries = vec![counts_entry(counts), name];
    let mut bytes = row_group(batch.schema(), std::slice::from_ref(batch), entries)?;
    checksum::add(Cursor::new(&mut bytes))?;
    Ok(bytes)
}

/// A Parquet file whose only row group has these rows.
///
/// # Errors
/// [`ParquetError`] if the writer fails.
pub(super) fn row_group(
    schema: SchemaRef,
    batches: &[RecordBatch],
    entries: Vec<KeyValue>,
) -> Result<Vec<u8>, ParquetError> {
    let mut writer = ArrowWriter::try_new(Vec::new(), schema, Some(properties(entries)))?;
    for batch in batches {
        writer.write(batch)?;
    }
    writer.into_inner()
}

/// The entry of a file's metadata with its counts.
pub(super) fn counts_entry(counts: &Counts) -> KeyValue {
    KeyValue::new(COUNTS_ENTRY.to_owned(), json!(counts).to_string())
}
