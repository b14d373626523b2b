//! Tables of other libraries, through the Arrow PyCapsule interface.

use arrow_array::ffi::{FFI_ArrowArray, from_ffi_and_data_type};
use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::{ArrayRef, BooleanArray, RecordBatch, RecordBatchOptions, StructArray};
use arrow_schema::ffi::FFI_ArrowSchema;
use arrow_schema::{ArrowError, DataType, Schema, SchemaRef};
use arrow_select::nullif::nullif;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyCapsule;
use std::ffi::{CStr, c_int};
use std::sync::Arc;

/// A table of Arrow: its schema and its rows.
pub struct ArrowTable {
    pub schema: SchemaRef,
    pub batches: Vec<RecordBatch>,
}

impl<'py> FromPyObject<'_, 'py> for ArrowTable {
    type Error = PyErr;

    /// Accepts objects with `__arrow_c_stream__` (tables) or `__arrow_c_array__` (single batches).
    fn extract(input: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if input.hasattr("__arrow_c_stream__")? {
            let capsule = input.call_method0("__arrow_c_stream__")?;
            return read_stream(capsule.cast::<PyCapsule>()?);
        }
        if input.hasattr("__arrow_c_array__")? {
            let capsules = input.call_method0("__arrow_c_array__")?;
            let (schema, array): (Bound<'_, PyCapsule>, Bound<'_, PyCapsule>) =
                capsules.extract()?;
            return read_batch(&schema, &array);
        }
        Err(PyTypeError::new_err(format!(
            "a table is one of pyarrow, Polars, pandas, DuckDB or another library with Arrow's PyCapsule interface, not {}",
            input.get_type()
        )))
    }
}

#[allow(unsafe_code)]
fn read_stream(capsule: &Bound<'_, PyCapsule>) -> PyResult<ArrowTable> {
    let pointer = capsule.pointer_checked(Some(c"arrow_array_stream"))?;
    // SAFETY: a capsule of this name points to a stream, by the PyCapsule interface. It is moved out, and what is left behind is
    // marked as released, so that the capsule does not release it again.
    let mut stream = unsafe { FFI_ArrowArrayStream::from_raw(pointer.cast().as_ptr()) };
    let (Some(get_schema), Some(get_next)) = (stream.get_schema, stream.get_next) else {
        return Err(PyValueError::new_err(
            "the table's stream has been read already",
        ));
    };
    let mut schema = FFI_ArrowSchema::empty();
    // SAFETY: both functions are called as the C stream interface asks: with the stream that they belong to, which is not
    // released yet, and a place for what they give.
    let code = unsafe { get_schema(&raw mut stream, &raw mut schema) };
    check(code, &mut stream)?;
    let schema = nullable(&Schema::try_from(&schema).map_err(unreadable)?);
    let mut batches = Vec::new();
    loop {
        let mut array = FFI_ArrowArray::empty();
        // SAFETY: as above.
        let code = unsafe { get_next(&raw mut stream, &raw mut array) };
        check(code, &mut stream)?;
        if array.is_released() {
            return Ok(ArrowTable { schema, batches });
        }
        batches.push(batch(array, &schema)?);
    }
}

/// The error of a stream, if a call returned one.
#[allow(unsafe_code)]
fn check(code: c_int, stream: &mut FFI_ArrowArrayStream) -> PyResult<()> {
    if code == 0 {
        return Ok(());
    }
    if let Some(raised) = Python::attach(PyErr::take) {
        return Err(raised);
    }
    let message = stream.get_last_error.and_then(|message| {
        // SAFETY: the stream is its own; the text, if there is one, ends with a zero and lives until the next call.
        unsafe {
            let text = message(stream);
            (!text.is_null()).then(|| CStr::from_ptr(text).to_string_lossy().into_owned())
        }
    });
    let text = message.unwrap_or_else(|| format!("the table's stream failed with code {code}"));
    Err(PyValueError::new_err(text))
}

#[allow(unsafe_code)]
fn read_batch(schema: &Bound<'_, PyCapsule>, array: &Bound<'_, PyCapsule>) -> PyResult<ArrowTable> {
    let schema_pointer = schema.pointer_checked(Some(c"arrow_schema"))?;
    let array_pointer = array.pointer_checked(Some(c"arrow_array"))?;
    // SAFETY: capsules of these names point to a schema and an array, by the PyCapsule interface; both are moved out, and what
    // is left behind is marked as released.
    let (schema, array) = unsafe {
        (
            FFI_ArrowSchema::from_raw(schema_pointer.cast().as_ptr()),
            FFI_ArrowArray::from_raw(array_pointer.cast().as_ptr()),
        )
    };
    let schema = nullable(&Schema::try_from(&schema).map_err(unreadable)?);
    let batches = vec![batch(array, &schema)?];
    Ok(ArrowTable { schema, batches })
}

/// A batch of rows, wherever its numbers begin in memory.
#[allow(unsafe_code)]
fn batch(array: FFI_ArrowArray, schema: &SchemaRef) -> PyResult<RecordBatch> {
    let kind = DataType::Struct(schema.fields().clone());
    // SAFETY: the array and the schema have the same origin.
    let mut data = unsafe { from_ffi_and_data_type(array, kind) }.map_err(unreadable)?;
    // What has been through pickle, as in Dask, need not be aligned.
    data.align_buffers();
    let rows = data.len();
    let (_, columns, nulls) = StructArray::from(data).into_parts();
    let columns = match nulls {
        Some(nulls) => without(&columns, &BooleanArray::new(!nulls.inner(), None))?,
        None => columns,
    };
    let options = RecordBatchOptions::new().with_row_count(Some(rows));
    RecordBatch::try_new_with_options(schema.clone(), columns, &options).map_err(unreadable)
}

/// The columns of a struct array, with nulls where the struct is null.
fn without(columns: &[ArrayRef], is_null: &BooleanArray) -> PyResult<Vec<ArrayRef>> {
    columns
        .iter()
        .map(|column| nullif(column, is_null))
        .collect::<Result<_, _>>()
        .map_err(unreadable)
}

/// A schema in which any cell may be empty: rows may be null where their fields can't.
fn nullable(schema: &Schema) -> SchemaRef {
    let fields = schema.fields().iter();
    let fields: Vec<_> = fields
        .map(|field| field.as_ref().clone().with_nullable(true))
        .collect();
    Arc::new(Schema::new_with_metadata(fields, schema.metadata().clone()))
}

fn unreadable(error: ArrowError) -> PyErr {
    PyValueError::new_err(format!("the table can't be read: {error}"))
}
