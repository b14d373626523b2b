//! Tables: the messages of a topic as columns.

use crate::view;
use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::{
    Array as _, ArrayRef, Float64Array, Int64Array, RecordBatch, RecordBatchIterator, StringArray,
};
use arrow_schema::ffi::FFI_ArrowSchema;
use arrow_schema::{ArrowError, DataType, Field, Schema, SchemaRef};
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyDict};
use std::collections::HashMap;
use std::sync::Arc;
use toprise::telemetry::{Leaf, Message, Topic};

/// The column with the exact time of a message, ns.
const TIME_NS: &str = "time_ns";
/// The column with the number of a message.
const SEQUENCE: &str = "sequence";
/// The column with the time in seconds; events and impacts have a field of this name.
const TIME: &str = "time";
/// Key of the metadata of a field: its name in a recording's messages, where objects are separated by dots.
const PATH: &str = "path";
/// Key of the metadata of a field.
const UNIT: &str = "unit";
/// Key of the metadata of a field and of a schema.
const MEANING: &str = "meaning";

/// Number of rows at either end that `_repr_html_` shows.
const SHOWN: usize = 4;

/// Rows and columns, in SI units and radians: the messages of a topic, one a row, or the outcomes of many runs.
///
/// Implements the Arrow PyCapsule interface: `polars.DataFrame(table)`, `pyarrow.table(table)`,
/// `pandas.DataFrame.from_arrow(table)` and DuckDB's `FROM table` read it without a copy.
/// `table.numpy("theta")` is one column for NumPy.
///
/// Columns of every topic's table are `time_ns` (exact simulation time, ns), `sequence` (number of the sample, event or nutation)
/// and `time` (s). The others are the fields of the topic, with `_` in place of dots: `omega_body_x`. Unit, frame and
/// description are in the Arrow field metadata.
#[pyclass(frozen, module = "toprise")]
pub struct Table {
    name: String,
    meaning: String,
    rows: RecordBatch,
}

impl Table {
    /// A table of these rows.
    pub fn new(name: &str, meaning: &str, rows: RecordBatch) -> Self {
        Self {
            name: name.to_owned(),
            meaning: meaning.to_owned(),
            rows,
        }
    }

    fn index(&self, name: &str) -> PyResult<usize> {
        let schema = self.rows.schema_ref();
        let mut fields = schema.fields().iter();
        let plain = name.replace('.', "_");
        let found = fields.position(|field| field.name() == name || *field.name() == plain);
        found.ok_or_else(|| {
            let names = self.column_names().join(", ");
            let text = format!("{} has no column {name}; columns: {names}", self.name);
            PyKeyError::new_err(text)
        })
    }

    fn about<'a>(field: &'a Field, key: &str) -> &'a str {
        field.metadata().get(key).map_or("", String::as_str)
    }

    /// A value as text.
    fn cell(column: &ArrayRef, row: usize) -> String {
        let any = column.as_any();
        if column.is_null(row) {
            String::new()
        } else if let Some(column) = any.downcast_ref::<Float64Array>() {
            format!("{:?}", column.value(row))
        } else if let Some(column) = any.downcast_ref::<Int64Array>() {
            column.value(row).to_string()
        } else if let Some(column) = any.downcast_ref::<StringArray>() {
            // A text out of a file must not steer a terminal.
            column.value(row).escape_debug().to_string()
        } else {
            String::new()
        }
    }
}

#[pymethods]
impl Table {
    /// The topic, such as `/top/state`, or another name of the table.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// Description of the table.
    #[getter]
    fn meaning(&self) -> &str {
        &self.meaning
    }

    /// The names of the columns.
    #[getter]
    fn column_names(&self) -> Vec<String> {
        let schema = self.rows.schema_ref();
        let fields = schema.fields().iter();
        fields.map(|field| field.name().clone()).collect()
    }

    /// The unit of each column; empty for pure numbers and texts.
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let units = PyDict::new(py);
        for field in self.rows.schema_ref().fields() {
            units.set_item(field.name(), Self::about(field, UNIT))?;
        }
        Ok(units)
    }

    /// A column as a NumPy array of shape (rows,).
    ///
    /// Numbers are a read-only view of the table's memory (float64; int64 for `time_ns`, `sequence` and counts), texts a copy.
    /// Columns with missing values are copied, too: missing numbers become NaN, missing texts None. Names with dots also work:
    /// `omega_body.x`.
    fn numpy<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        view::numpy(py, self.rows.column(self.index(name)?))
    }

    /// The number of rows.
    fn __len__(&self) -> usize {
        self.rows.num_rows()
    }

    /// The schema, for the Arrow PyCapsule interface.
    fn __arrow_c_schema__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyCapsule>> {
        let schema = FFI_ArrowSchema::try_from(self.rows.schema_ref().as_ref());
        PyCapsule::new_with_value(py, schema.map_err(refused)?, c"arrow_schema")
    }

    /// All rows as one batch, for the Arrow PyCapsule interface. `requested_schema` is ignored.
    #[pyo3(signature = (requested_schema=None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        let _ = requested_schema;
        let batches = std::iter::once(Ok(self.rows.clone()));
        let reader = RecordBatchIterator::new(batches, self.rows.schema());
        let stream = FFI_ArrowArrayStream::new(Box::new(reader));
        PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
    }

    fn __repr__(&self) -> String {
        let (rows, columns) = (self.rows.num_rows(), self.rows.num_columns());
        let mut text = format!(
            "Table {}: {}\n{rows} rows × {columns} columns",
            self.name, self.meaning
        );
        let names = self.column_names();
        let widest = names.iter().map(String::len).max().unwrap_or_default();
        for (field, name) in self.rows.schema_ref().fields().iter().zip(names) {
            let (unit, meaning) = (Self::about(field, UNIT), Self::about(field, MEANING));
            let line = format!("\n  {name:widest$}  {unit:8}  {meaning}");
            text.push_str(line.trim_end());
        }
        text
    }

    fn _repr_html_(&self) -> String {
        let rows = self.rows.num_rows();
        let mut html = format!(
            "<table><caption>{}: {} ({rows} rows)</caption><thead><tr>",
            escaped(&self.name),
            escaped(&self.meaning)
        );
        for field in self.rows.schema_ref().fields() {
            let (unit, meaning) = (Self::about(field, UNIT), Self::about(field, MEANING));
            html += &format!(
                "<th title=\"{}\">{}<br><small>{}</small></th>",
                escaped(meaning),
                escaped(field.name()),
                escaped(unit)
            );
        }
        html += "</tr></thead><tbody>";
        for row in 0..rows {
            if row == SHOWN && rows > 2 * SHOWN {
                html += &format!("<tr>{}</tr>", "<td>…</td>".repeat(self.rows.num_columns()));
            }
            if row < SHOWN || row + SHOWN >= rows {
                html += "<tr>";
                for column in self.rows.columns() {
                    html += &format!("<td>{}</td>", escaped(&Self::cell(column, row)));
                }
                html += "</tr>";
            }
        }
        html + "</tbody></table>"
    }
}

fn refused(error: ArrowError) -> PyErr {
    PyValueError::new_err(error.to_string())
}

pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

/// Column builders of a topic.
pub struct Columns {
    topic: Topic,
    time_ns: Vec<i64>,
    sequence: Vec<i64>,
    numbers: Vec<Vec<f64>>,
    texts: Vec<Vec<String>>,
}

impl Columns {
    /// No rows yet.
    pub fn new(topic: Topic) -> Self {
        let info = topic.info();
        Self {
            topic,
            time_ns: Vec::new(),
            sequence: Vec::new(),
            numbers: vec![Vec::new(); info.numbers.len()],
            texts: vec![Vec::new(); info.texts.len()],
        }
    }

    /// The topic.
    pub fn topic(&self) -> Topic {
        self.topic
    }

    /// Adds a message of the topic.
    pub fn push(&mut self, message: &Message<'_>) {
        // A recording whose times don't fit is damaged: a run of 292 years has not been made.
        self.time_ns
            .push(i64::try_from(message.time_ns).unwrap_or(i64::MAX));
        self.sequence.push(i64::from(message.sequence));
        for (column, number) in self.numbers.iter_mut().zip(message.numbers) {
            column.push(*number);
        }
        for (column, text) in self.texts.iter_mut().zip(message.texts) {
            column.push(text.clone());
        }
    }

    /// The table, without the fields that a file lacks.
    ///
    /// # Errors
    /// If the columns are not of one length.
    pub fn into_table(self, lacking: &[String]) -> PyResult<Table> {
        let info = self.topic.info();
        let mut fields = vec![
            field(TIME_NS, DataType::Int64, "ns", "simulation time, exact"),
            field(SEQUENCE, DataType::Int64, "", "number of the message"),
        ];
        let seconds = |ns: &i64| *ns as f64 / 1e9;
        let time: Float64Array = self.time_ns.iter().map(seconds).collect::<Vec<_>>().into();
        let mut columns: Vec<ArrayRef> = vec![
            Arc::new(Int64Array::from(self.time_ns)),
            Arc::new(Int64Array::from(self.sequence)),
        ];
        if info.number_index(TIME).is_none() {
            fields.push(field(TIME, DataType::Float64, "s", "simulation time"));
            columns.push(Arc::new(time));
        }
        for (leaf, texts) in info.texts.iter().zip(self.texts) {
            if !lacking.contains(&leaf.path) {
                fields.push(of_leaf(leaf, DataType::Utf8));
                columns.push(Arc::new(StringArray::from(texts)));
            }
        }
        for (leaf, numbers) in info.numbers.iter().zip(self.numbers) {
            if !lacking.contains(&leaf.path) {
                fields.push(of_leaf(leaf, DataType::Float64));
                columns.push(Arc::new(Float64Array::from(numbers)));
            }
        }
        let about = [("topic", info.topic), (MEANING, info.meaning)];
        let about = about.map(|(key, value)| (key.to_owned(), value.to_owned()));
        let schema: SchemaRef = Arc::new(Schema::new_with_metadata(fields, HashMap::from(about)));
        let rows = RecordBatch::try_new(schema, columns).map_err(refused)?;
        Ok(Table::new(info.topic, info.meaning, rows))
    }
}

fn field(name: &str, kind: DataType, unit: &str, meaning: &str) -> Field {
    let about = [(UNIT, unit), (MEANING, meaning)];
    let about = about.map(|(key, value)| (key.to_owned(), value.to_owned()));
    Field::new(name, kind, false).with_metadata(HashMap::from(about))
}

fn of_leaf(leaf: &Leaf, kind: DataType) -> Field {
    let mut field = field(&leaf.path.replace('.', "_"), kind, leaf.unit, leaf.meaning);
    let mut about = field.metadata().clone();
    about.insert(PATH.to_owned(), leaf.path.clone());
    if !leaf.frame.is_empty() {
        about.insert("frame".to_owned(), leaf.frame.to_owned());
    }
    field.set_metadata(about);
    field
}
