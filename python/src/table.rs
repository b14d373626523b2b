//! Tables: the messages of a topic as columns.

use crate::view;
use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::{
    Array as _, ArrayRef, Float64Array, Int64Array, RecordBatch, RecordBatchIterator, StringArray,
};
use arrow_schema::ffi::FFI_ArrowSchema;
use arrow_schema::{ArrowError, DataType, Field, Schema, SchemaRef};
use pyo3::exceptions::{PyKeyError, PyTypeError, PyValueError};
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

/// Number of rows at either end that are shown.
const SHOWN: usize = 4;

/// Width of a printed table, columns of the terminal.
const WIDTH: usize = 100;

/// Number of significant digits of a printed number.
const DIGITS: usize = 6;

/// Rows and columns, in SI units and radians: the messages of a topic, one a row, or the outcomes of many runs.
///
/// Implements the Arrow PyCapsule interface: `polars.DataFrame(table)`, `pyarrow.table(table)`,
/// `pandas.DataFrame.from_arrow(table)` and DuckDB's `FROM table` read it without a copy.
/// `table["theta"]` is one column for NumPy, and `numpy.asarray(table)` all columns of a table without texts.
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

    /// The rows that are shown, if not all are: some at either end. `None` stands for those between.
    fn shown_rows(&self) -> Vec<Option<usize>> {
        let rows = self.rows.num_rows();
        if rows <= 2 * SHOWN {
            return (0..rows).map(Some).collect();
        }
        (0..SHOWN)
            .map(Some)
            .chain([None])
            .chain((rows - SHOWN..rows).map(Some))
            .collect()
    }

    /// A column as printed: name, unit, and the values of the shown rows.
    fn printed_column(&self, index: usize) -> Vec<String> {
        let field = self.rows.schema_ref().field(index);
        let mut lines = vec![field.name().clone(), Self::about(field, UNIT).to_owned()];
        for row in self.shown_rows() {
            lines.push(match row {
                Some(row) => short_cell(self.rows.column(index), row),
                None => "…".to_owned(),
            });
        }
        lines
    }

    /// Values of the first and last rows, in as many columns as fit, and the names of the other columns.
    fn printed_values(&self) -> String {
        let mut lines = vec![String::new(); 2 + self.shown_rows().len()];
        let mut shown = 0;
        for index in 0..self.rows.num_columns() {
            let column = self.printed_column(index);
            let width = column.iter().map(|cell| cell.chars().count()).max();
            let width = width.unwrap_or_default() + 2;
            if index > 0 && lines[0].chars().count() + width > WIDTH {
                break;
            }
            for (line, cell) in lines.iter_mut().zip(column) {
                *line += &format!("{cell:>width$}");
            }
            shown += 1;
        }
        let mut text = String::new();
        for line in lines {
            text += line.trim_end();
            text.push('\n');
        }
        let rest = self.column_names().split_off(shown);
        if !rest.is_empty() {
            text += &format!("and {} more columns: {}\n", rest.len(), rest.join(", "));
        }
        text
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

    /// The names of the columns, as pandas and Polars call them.
    #[getter]
    fn columns(&self) -> Vec<String> {
        self.column_names()
    }

    /// The description of each column.
    #[getter]
    fn meanings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let meanings = PyDict::new(py);
        for field in self.rows.schema_ref().fields() {
            meanings.set_item(field.name(), Self::about(field, MEANING))?;
        }
        Ok(meanings)
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

    /// A column, as `numpy` returns it.
    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        self.numpy(py, name)
    }

    /// Whether there is a column of this name.
    fn __contains__(&self, name: &str) -> bool {
        self.index(name).is_ok()
    }

    /// The names of the columns, as for a pandas data frame.
    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(self
            .column_names()
            .into_pyobject(py)?
            .try_iter()?
            .into_any())
    }

    /// All columns as one array of shape (rows, columns), float64: a copy, for NumPy.
    ///
    /// Raises `TypeError` if a column has texts, and `ValueError` if no copy is allowed.
    #[pyo3(signature = (dtype=None, copy=None))]
    fn __array__<'py>(
        &self,
        py: Python<'py>,
        dtype: Option<Bound<'py, PyAny>>,
        copy: Option<bool>,
    ) -> PyResult<Bound<'py, PyAny>> {
        if copy == Some(false) {
            return Err(PyValueError::new_err(
                "the columns of a table are not contiguous: an array of all of them is a copy",
            ));
        }
        let mut columns = Vec::new();
        for (field, column) in self
            .rows
            .schema_ref()
            .fields()
            .iter()
            .zip(self.rows.columns())
        {
            if field.data_type().is_string() {
                return Err(PyTypeError::new_err(format!(
                    "{}: the column {} has texts; choose columns of numbers, as in table[\"time\"]",
                    self.name,
                    field.name()
                )));
            }
            columns.push(view::numpy(py, column)?);
        }
        let numpy = py.import("numpy")?;
        let array = numpy.call_method1("column_stack", (columns,))?;
        array.call_method1("astype", (dtype.unwrap_or(numpy.getattr("float64")?),))
    }

    /// The table as a `pandas.DataFrame`. Missing numbers are NaN.
    fn to_pandas<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let columns = PyDict::new(py);
        for name in self.column_names() {
            columns.set_item(&name, self.numpy(py, &name)?)?;
        }
        py.import("pandas")?.call_method1("DataFrame", (columns,))
    }

    /// The table as a `polars.DataFrame`, without a copy.
    fn to_polars<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("polars")?.call_method1("DataFrame", (slf,))
    }

    /// The number of rows.
    fn __len__(&self) -> usize {
        self.rows.num_rows()
    }

    /// The schema, for the Arrow PyCapsule interface.
    fn __arrow_c_schema__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyCapsule>> {
        let schema = FFI_ArrowSchema::try_from(self.rows.schema_ref().as_ref());
        PyCapsule::new_with_value(py, schema.map_err(arrow_error)?, c"arrow_schema")
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
        let text = format!(
            "Table {}: {}\n{rows} rows × {columns} columns; table.meanings describes them\n\n{}",
            self.name,
            self.meaning,
            self.printed_values()
        );
        text.trim_end().to_owned()
    }

    fn _repr_html_(&self) -> String {
        let mut html = format!(
            "<table><caption>{}: {} ({} rows)</caption><thead><tr>",
            escaped(&self.name),
            escaped(&self.meaning),
            self.rows.num_rows()
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
        for row in self.shown_rows() {
            html += "<tr>";
            for column in self.rows.columns() {
                let cell = row.map_or_else(|| "…".to_owned(), |row| Self::cell(column, row));
                html += &format!("<td>{}</td>", escaped(&cell));
            }
            html += "</tr>";
        }
        html + "</tbody></table>"
    }
}

/// A value as text, numbers with few digits.
fn short_cell(column: &ArrayRef, row: usize) -> String {
    let text = Table::cell(column, row);
    let Some(numbers) = column.as_any().downcast_ref::<Float64Array>() else {
        return text;
    };
    if numbers.is_null(row) {
        return "null".to_owned();
    }
    // Rounding in decimal, as people do.
    let rounded: Result<f64, _> = format!("{:.*e}", DIGITS - 1, numbers.value(row)).parse();
    rounded.map_or(text, |number| format!("{number:?}"))
}

/// A table of the columns of a dictionary: numbers or texts, `None` for missing ones.
#[pyfunction]
pub fn table(columns: Vec<(String, Vec<Option<Cell>>)>) -> PyResult<Table> {
    let mut fields = Vec::new();
    let mut arrays: Vec<ArrayRef> = Vec::new();
    for (name, cells) in columns {
        let (kind, array) = column_of(&name, cells)?;
        fields.push(Field::new(name, kind, true));
        arrays.push(array);
    }
    let rows = RecordBatch::try_new(Arc::new(Schema::new(fields)), arrays).map_err(arrow_error)?;
    Ok(Table::new("table", "columns of a dictionary", rows))
}

/// A value of a column of a dictionary.
#[derive(FromPyObject)]
pub enum Cell {
    /// A number.
    Number(f64),
    /// A text.
    Text(String),
}

/// The type and values of a column; all are numbers or all are texts.
fn column_of(name: &str, cells: Vec<Option<Cell>>) -> PyResult<(DataType, ArrayRef)> {
    let mut numbers = Vec::new();
    let mut texts = Vec::new();
    for cell in &cells {
        match cell {
            Some(Cell::Number(number)) => numbers.push(Some(*number)),
            Some(Cell::Text(text)) => texts.push(Some(text.as_str())),
            None => {
                numbers.push(None);
                texts.push(None);
            }
        }
    }
    if numbers.len() == cells.len() {
        Ok((DataType::Float64, Arc::new(Float64Array::from(numbers))))
    } else if texts.len() == cells.len() {
        Ok((DataType::Utf8, Arc::new(StringArray::from(texts))))
    } else {
        Err(PyTypeError::new_err(format!(
            "{name}: a column has either numbers or texts"
        )))
    }
}

fn arrow_error(error: ArrowError) -> PyErr {
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
        let time = Float64Array::from_iter_values(self.time_ns.iter().map(|ns| *ns as f64 / 1e9));
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
                fields.push(leaf_field(leaf, DataType::Utf8));
                columns.push(Arc::new(StringArray::from(texts)));
            }
        }
        for (leaf, numbers) in info.numbers.iter().zip(self.numbers) {
            if !lacking.contains(&leaf.path) {
                fields.push(leaf_field(leaf, DataType::Float64));
                columns.push(Arc::new(Float64Array::from(numbers)));
            }
        }
        let about = [("topic", info.topic), (MEANING, info.meaning)]
            .map(|(key, value)| (key.to_owned(), value.to_owned()));
        let schema: SchemaRef = Arc::new(Schema::new_with_metadata(fields, HashMap::from(about)));
        let rows = RecordBatch::try_new(schema, columns).map_err(arrow_error)?;
        Ok(Table::new(info.topic, info.meaning, rows))
    }
}

fn field(name: &str, kind: DataType, unit: &str, meaning: &str) -> Field {
    let about =
        [(UNIT, unit), (MEANING, meaning)].map(|(key, value)| (key.to_owned(), value.to_owned()));
    Field::new(name, kind, false).with_metadata(HashMap::from(about))
}

fn leaf_field(leaf: &Leaf, kind: DataType) -> Field {
    let mut field = field(&leaf.path.replace('.', "_"), kind, leaf.unit, leaf.meaning);
    let mut about = field.metadata().clone();
    about.insert(PATH.to_owned(), leaf.path.clone());
    if !leaf.frame.is_empty() {
        about.insert("frame".to_owned(), leaf.frame.to_owned());
    }
    field.set_metadata(about);
    field
}
