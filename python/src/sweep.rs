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
use toprise::run::simulation::StopReason;
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
    let given = concat_batches(&table.schema, &table.batches).map_err(refused)?;
    refuse_two_bases(&given)?;
    refuse_missing(&keep, &given)?;
    let name = |column: &usize| given.schema_ref().field(*column).name();
    // A kept key is in the result anyway, next to the outcomes.
    let is_kept =
        |name: &String| name == RUN || (keep.contains(name) && sweeps::find_key(name).is_err());
    let (kept, keys): (Vec<usize>, Vec<usize>) = (0..given.num_columns())
        .filter(|column| name(column) != SCENARIO)
        .partition(|column| is_kept(name(column)));
    let kept = given.project(&kept).map_err(refused)?;
    let keys = given.project(&keys).map_err(refused)?;
    let rows = keys.num_rows();
    let sweep = if rows == 0 {
        sweep_over(&one_empty_row(&keys)?, &values, max_steps)?
    } else {
        sweep_over(&keys, &values, max_steps)?
    };
    refuse_twofold(&kept, &sweep)?;
    let computed = compute(py, move |interrupt| {
        let threads = sweeps::threads(threads, rows as u64);
        let pool = ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.map_err(|error| error.to_string())?;
        let computed = pool.install(|| rows_of(&sweep, rows as u64, &interrupt));
        computed.ok_or_else(|| "interrupted".to_owned())
    })?;
    let computed = computed.map_err(SweepError::new_err)?;
    Ok(named(beside(&kept, &computed).map_err(refused)?))
}

/// Rejects tables with rows of several bases; `outcomes` has a single base.
fn refuse_two_bases(given: &RecordBatch) -> PyResult<()> {
    let Some(names) = given.column_by_name(SCENARIO) else {
        return Ok(());
    };
    let names = sweeps::cells(names.as_ref());
    let names = names.map_err(|reason| PyValueError::new_err(format!("{SCENARIO}: {reason}")))?;
    let mut names = names.into_iter().flatten().map(|name| match name {
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
fn refuse_missing(keep: &[String], given: &RecordBatch) -> PyResult<()> {
    let fields = given.schema_ref().fields().iter();
    let names: Vec<&str> = fields.map(|field| field.name().as_str()).collect();
    let is_there = |name: &String| {
        let path = |name: &str| sweeps::find_key(name).ok().map(|key| key.path);
        let is_it =
            |own: &&str| *own == name || path(name).is_some_and(|key| path(own) == Some(key));
        names.iter().any(is_it)
    };
    match keep.iter().find(|name| !is_there(name)) {
        Some(missing) => Err(PyValueError::new_err(format!(
            "keep: the table has no column {missing}; it has {}",
            names.join(", ")
        ))),
        None => Ok(()),
    }
}

/// Rejects `keep` columns whose names clash with outcome columns.
fn refuse_twofold(kept: &RecordBatch, sweep: &Sweep) -> PyResult<()> {
    let own = sweep.schema();
    let is_twofold =
        |field: &&FieldRef| field.name() != RUN && own.column_with_name(field.name()).is_some();
    match kept.schema_ref().fields().iter().find(is_twofold) {
        Some(field) => Err(PyValueError::new_err(format!(
            "keep: outcomes have a column {0} too: rename or drop the table's own {0}",
            field.name()
        ))),
        None => Ok(()),
    }
}

/// The first rows of a sweep; none if it was interrupted.
fn rows_of(sweep: &Sweep, rows: u64, interrupt: &Interrupt) -> Option<RecordBatch> {
    let watch = Watch {
        carry_on: &|| !interrupt.is_asked(),
        row_done: &|_| {},
    };
    sweep.batch(0..rows, &watch).map(|(batch, _)| batch)
}

/// Columns that are kept of a table, and those of a sweep except the number of the row.
fn beside(kept: &RecordBatch, computed: &RecordBatch) -> Result<RecordBatch, ArrowError> {
    let is_wanted = |field: &FieldRef| field.name() != RUN;
    let own = computed
        .schema_ref()
        .fields()
        .iter()
        .zip(computed.columns());
    let own = own.filter(|(field, _)| is_wanted(field));
    let kept = kept.schema_ref().fields().iter().zip(kept.columns());
    let (fields, columns): (Vec<FieldRef>, Vec<ArrayRef>) = kept
        .chain(own)
        .map(|(field, column)| (field.clone(), column.clone()))
        .unzip();
    RecordBatch::try_new(Arc::new(Schema::new(fields)), columns)
}

/// The columns of outcomes of runs in which these keys vary, as a table without rows; see `toprise.Outcomes.schema`.
#[pyfunction]
pub fn outcome_columns(keys: Vec<String>) -> PyResult<Table> {
    let kind = |name: &String| {
        let key = sweeps::find_key(name).map_err(errors::scenario)?;
        let kind = if key.kind.is_text() {
            DataType::Utf8
        } else {
            DataType::Float64
        };
        Ok(Field::new(name, kind, true))
    };
    let fields = keys.iter().map(kind).collect::<PyResult<Vec<_>>>()?;
    let none = RecordBatch::new_empty(Arc::new(Schema::new(fields)));
    let sweep = sweep_over(&one_empty_row(&none)?, &Values::default(), None)?;
    let columns = RecordBatch::new_empty(sweep.schema());
    let nothing = RecordBatch::new_empty(Arc::new(Schema::empty()));
    Ok(named(beside(&nothing, &columns).map_err(refused)?))
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
    let values = values.clone();
    let table = sweeps::Table::from_batches(keys.schema_ref(), std::slice::from_ref(keys));
    let table = table.map_err(errors::table)?;
    let bases = vec![sweeps::Base::new(name, values)];
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
    let tell = |_: Python<'_>| match &progress {
        Some(progress) => progress
            .call1((done.load(Ordering::Relaxed), left))
            .map(|_| ()),
        None => Ok(()),
    };
    let finished = compute_watched(py, tell, move |interrupt| {
        let count = |_: Option<StopReason>| {
            counted.fetch_add(1, Ordering::Relaxed);
        };
        let watch = Watch {
            carry_on: &|| !interrupt.is_asked(),
            row_done: &count,
        };
        sweeps::run(&sweep, &out, &options, &watch)
    })?;
    tell(py)?;
    let finished = finished.map_err(errors::sweep)?;
    let answer = json!({
        "runs": runs,
        "computed": finished.computed,
        // A shard does not count the runs of the other shards.
        "kept": shard.is_none().then(|| runs.saturating_sub(left)),
        "is_merged": finished.is_merged,
        "stops": finished.counts.stops,
        "errors": finished.counts.errors,
        "first_error": finished.counts.first_error,
    });
    Ok(answer.to_string())
}

fn refused(error: ArrowError) -> PyErr {
    PyValueError::new_err(error.to_string())
}
