//! Sweeps: the outcomes of many runs.

use crate::errors::{self, SweepError};
use crate::guard::{Interrupt, compute, compute_watched};
use crate::scenario::Base;
use crate::stream::ArrowTable;
use crate::table::Table;
use arrow_array::{ArrayRef, RecordBatch, new_null_array};
use arrow_schema::{ArrowError, DataType, Field, FieldRef, Schema};
use arrow_select::concat::concat_batches;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::ThreadPoolBuilder;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use toprise::run::scenario::{Value, Values};
use toprise::sweep::{self as sweeps, Design, Options, Shard, Spec, Sweep, Watch};

/// Name of the row number column; numbers in an input table are kept.
const RUN: &str = "run";
/// The column of a sweep's table with the name of a row's base.
const SCENARIO: &str = "scenario";

/// Name of a table of outcomes.
const OUTCOMES: (&str, &str) = ("outcomes", "the outcome of each run, or why there is none");

/// The outcomes of runs that a table defines; see `toprise.outcomes`.
#[pyfunction]
#[pyo3(signature = (table, base, *, keep, threads, max_steps))]
pub fn outcomes(
    py: Python<'_>,
    table: ArrowTable,
    base: Base<'_>,
    keep: Vec<String>,
    threads: usize,
    max_steps: Option<u64>,
) -> PyResult<Table> {
    let values = base.values(None)?;
    let input = concat_batches(&table.schema, &table.batches).map_err(refused)?;
    check_one_base(&input)?;
    check_kept(&keep, &input)?;
    let (mut kept_columns, mut key_columns) = (Vec::new(), Vec::new());
    for (column, field) in input.schema_ref().fields().iter().enumerate() {
        let name = field.name();
        if name == SCENARIO {
            continue;
        }
        // A kept key is in the result anyway, next to the outcomes.
        if name == RUN || (keep.contains(name) && sweeps::find_key(name).is_err()) {
            kept_columns.push(column);
        } else {
            key_columns.push(column);
        }
    }
    let kept = input.project(&kept_columns).map_err(refused)?;
    let keys = input.project(&key_columns).map_err(refused)?;
    let rows = keys.num_rows();
    let sweep = if rows == 0 {
        sweep_over(&one_empty_row(&keys)?, &values, max_steps)?
    } else {
        sweep_over(&keys, &values, max_steps)?
    };
    check_names(&kept, &sweep)?;
    let computed = compute(py, move |interrupt| {
        let threads = sweeps::threads(threads, rows as u64);
        ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|error| error.to_string())?
            .install(|| compute_rows(&sweep, rows as u64, &interrupt))
            .ok_or_else(|| "interrupted".to_owned())
    })?
    .map_err(SweepError::new_err)?;
    Ok(named(with_outcomes(&kept, &computed).map_err(refused)?))
}

/// Rejects tables with rows of several bases; `outcomes` has a single base.
fn check_one_base(input: &RecordBatch) -> PyResult<()> {
    let Some(column) = input.column_by_name(SCENARIO) else {
        return Ok(());
    };
    let cells = sweeps::cells(column.as_ref())
        .map_err(|reason| PyValueError::new_err(format!("{SCENARIO}: {reason}")))?;
    let mut names = cells.into_iter().flatten().map(|cell| match cell {
        Value::Text(name) => name,
        number @ Value::Number(_) => number.to_string(),
    });
    let Some(first) = names.next() else {
        return Ok(());
    };
    match names.find(|name| *name != first) {
        Some(other) => Err(PyValueError::new_err(format!(
            "the column scenario names several bases, {first} and {other}: choose the rows of one, and give that as base"
        ))),
        None => Ok(()),
    }
}

/// Rejects `keep` columns missing from the table.
fn check_kept(keep: &[String], input: &RecordBatch) -> PyResult<()> {
    let names: Vec<&str> = input
        .schema_ref()
        .fields()
        .iter()
        .map(|field| field.name().as_str())
        .collect();
    for wanted in keep {
        if !names.iter().any(|name| is_same_column(name, wanted)) {
            return Err(PyValueError::new_err(format!(
                "keep: the table has no column {wanted}; it has {}",
                names.join(", ")
            )));
        }
    }
    Ok(())
}

/// Whether two names are those of one column: equal, or `friction.k` and `friction_k`.
fn is_same_column(name: &str, other: &str) -> bool {
    match (sweeps::find_key(name), sweeps::find_key(other)) {
        (Ok(key), Ok(other_key)) => key.path == other_key.path,
        (Ok(_) | Err(_), Ok(_) | Err(_)) => name == other,
    }
}

/// Rejects `keep` columns whose names clash with outcome columns.
fn check_names(kept: &RecordBatch, sweep: &Sweep) -> PyResult<()> {
    let outcomes = sweep.schema();
    for field in kept.schema_ref().fields() {
        let name = field.name();
        if name != RUN && outcomes.column_with_name(name).is_some() {
            return Err(PyValueError::new_err(format!(
                "keep: outcomes have a column {name} too: rename or drop the table's own {name}"
            )));
        }
    }
    Ok(())
}

/// The first rows of a sweep; none if it was interrupted.
fn compute_rows(sweep: &Sweep, rows: u64, interrupt: &Interrupt) -> Option<RecordBatch> {
    let watch = Watch {
        carry_on: &|| !interrupt.is_requested(),
        row_done: &|_| {},
    };
    sweep.batch(0..rows, &watch).map(|(batch, _)| batch)
}

/// Columns that are kept of a table, followed by those of a sweep except the number of the row.
fn with_outcomes(kept: &RecordBatch, computed: &RecordBatch) -> Result<RecordBatch, ArrowError> {
    let mut fields: Vec<FieldRef> = kept.schema_ref().fields().to_vec();
    let mut columns: Vec<ArrayRef> = kept.columns().to_vec();
    for (field, column) in computed
        .schema_ref()
        .fields()
        .iter()
        .zip(computed.columns())
    {
        // A table that has numbers of its own keeps them.
        if field.name() != RUN {
            fields.push(field.clone());
            columns.push(column.clone());
        }
    }
    RecordBatch::try_new(Arc::new(Schema::new(fields)), columns)
}

/// The columns of outcomes of runs in which these keys vary, as a table without rows; see `toprise.Outcomes.schema`.
#[pyfunction]
pub fn outcome_columns(keys: Vec<String>) -> PyResult<Table> {
    let mut fields = Vec::new();
    for name in keys {
        let key = sweeps::find_key(&name).map_err(errors::scenario)?;
        let kind = if key.kind.is_text() {
            DataType::Utf8
        } else {
            DataType::Float64
        };
        fields.push(Field::new(name, kind, true));
    }
    let none = RecordBatch::new_empty(Arc::new(Schema::new(fields)));
    let sweep = sweep_over(&one_empty_row(&none)?, &Values::default(), None)?;
    let columns = RecordBatch::new_empty(sweep.schema());
    let nothing = RecordBatch::new_empty(Arc::new(Schema::empty()));
    Ok(named(with_outcomes(&nothing, &columns).map_err(refused)?))
}

/// Adds an empty row if the table has none, since a design needs at least one row.
fn one_empty_row(keys: &RecordBatch) -> PyResult<RecordBatch> {
    let fields = keys.schema_ref().fields().iter();
    let (fields, columns): (Vec<Field>, Vec<ArrayRef>) = fields
        .map(|field| {
            let column = new_null_array(field.data_type(), 1);
            (field.as_ref().clone().with_nullable(true), column)
        })
        .unzip();
    let options = arrow_array::RecordBatchOptions::new().with_row_count(Some(1));
    let schema = Schema::new_with_metadata(fields, keys.schema_ref().metadata().clone());
    RecordBatch::try_new_with_options(Arc::new(schema), columns, &options).map_err(refused)
}

/// The sweep over the rows of a table.
fn sweep_over(keys: &RecordBatch, values: &Values, max_steps: Option<u64>) -> PyResult<Sweep> {
    let name = match values.get("name") {
        Some(Value::Text(name)) => name.clone(),
        _ => String::new(),
    };
    let table = sweeps::Table::from_batches(keys.schema_ref(), std::slice::from_ref(keys))
        .map_err(errors::table)?;
    let bases = vec![sweeps::Base::new(name, values.clone())];
    let spec = Spec::new(bases, Design::Table(table), max_steps).map_err(errors::sweep)?;
    Ok(Sweep::new(spec))
}

fn named(rows: RecordBatch) -> Table {
    let (name, meaning) = OUTCOMES;
    Table::new(name, meaning, rows)
}

/// Reads the spec of a sweep; relative file names are resolved in `folder`.
fn read_spec(text: &str, folder: &Path) -> PyResult<Sweep> {
    let spec = Spec::from_toml(text, folder, &[]).map_err(errors::sweep)?;
    Ok(Sweep::new(spec))
}

/// Rows of a design; see `toprise.design`.
#[pyfunction]
#[pyo3(signature = (text, folder, start, stop))]
pub fn design(text: &str, folder: PathBuf, start: u64, stop: Option<u64>) -> PyResult<Table> {
    let sweep = read_spec(text, &folder)?;
    let rows = sweep.spec().rows();
    let stop = stop.unwrap_or(rows);
    if start > stop || stop > rows {
        return Err(PyValueError::new_err(format!(
            "rows {start} to {stop}: the sweep has {rows}"
        )));
    }
    let meaning = "the runs of a sweep";
    Ok(Table::new("design", meaning, sweep.design(start..stop)))
}

/// The number of rows of a sweep, and of a part.
#[pyfunction]
pub fn rows(text: &str, folder: PathBuf) -> PyResult<(u64, u64)> {
    let sweep = read_spec(text, &folder)?;
    Ok((sweep.spec().rows(), sweep.part_rows()))
}

/// Computes a sweep; see `toprise.sweep`. `progress` is called periodically with the number of finished runs and the total
/// number of runs to compute in this call.
#[pyfunction]
#[pyo3(signature = (text, folder, out, *, threads, shard, fail_fast, progress))]
#[allow(clippy::too_many_arguments)]
pub fn sweep(
    py: Python<'_>,
    text: &str,
    folder: PathBuf,
    out: PathBuf,
    threads: usize,
    shard: Option<(u64, u64)>,
    fail_fast: bool,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<String> {
    let sweep = read_spec(text, &folder)?;
    let shard = shard.map(|(index, count)| Shard { index, count });
    if let Some(Shard { index, count }) = shard.filter(|shard| shard.index >= shard.count) {
        let text = format!("shard ({index}, {count}): the first must be less than the second");
        return Err(PyValueError::new_err(text));
    }
    let options = Options {
        threads,
        shard,
        fail_fast,
    };
    let runs = sweep.spec().rows();
    let left = sweeps::remaining_rows(&sweep, &out, shard).map_err(errors::sweep)?;
    let done = Arc::new(AtomicU64::new(0));
    let counted = done.clone();
    let callback = progress.as_ref();
    let finished = compute_watched(
        py,
        |_| report_progress(callback, &done, left),
        move |interrupt| {
            let watch = Watch {
                carry_on: &|| !interrupt.is_requested(),
                row_done: &|_| {
                    counted.fetch_add(1, Ordering::Relaxed);
                },
            };
            sweeps::run(&sweep, &out, &options, &watch)
        },
    )?;
    // The last runs may have finished after the last periodic call.
    report_progress(callback, &done, left)?;
    let finished = finished.map_err(errors::sweep)?;
    let report = json!({
        "runs": runs,
        "computed": finished.computed,
        // A shard does not count the runs of the other shards.
        "kept": shard.is_none().then(|| runs.saturating_sub(left)),
        "is_merged": finished.is_merged,
        "stops": finished.counts.stops,
        "errors": finished.counts.errors,
        "first_error": finished.counts.first_error,
    });
    Ok(report.to_string())
}

/// Calls a callback with the number of finished runs and the total number.
fn report_progress(
    callback: Option<&Bound<'_, PyAny>>,
    done: &AtomicU64,
    total: u64,
) -> PyResult<()> {
    if let Some(callback) = callback {
        callback.call1((done.load(Ordering::Relaxed), total))?;
    }
    Ok(())
}

fn refused(error: ArrowError) -> PyErr {
    PyValueError::new_err(error.to_string())
}
