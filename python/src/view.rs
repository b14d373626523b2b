//! Columns as NumPy arrays, without a copy.

use arrow_array::{Array as _, ArrayRef, Float64Array, Int64Array, StringArray};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

/// A column for NumPy's array interface. The NumPy array keeps it alive.
#[pyclass(frozen, module = "toprise")]
struct View {
    _column: ArrayRef,
    address: usize,
    length: usize,
    kind: &'static str,
}

#[pymethods]
impl View {
    #[getter]
    fn __array_interface__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        const IS_READ_ONLY: bool = true;
        let order = if cfg!(target_endian = "little") {
            '<'
        } else {
            '>'
        };
        let interface = PyDict::new(py);
        interface.set_item("version", 3)?;
        interface.set_item("shape", (self.length,))?;
        interface.set_item("typestr", format!("{order}{}", self.kind))?;
        interface.set_item("data", (self.address, IS_READ_ONLY))?;
        Ok(interface)
    }
}

/// A column as a NumPy array: a read-only view for numbers, a copy for texts and for columns with missing values.
pub fn numpy<'py>(py: Python<'py>, column: &ArrayRef) -> PyResult<Bound<'py, PyAny>> {
    let numpy = py.import("numpy")?;
    let any = column.as_any();
    let is_whole = column.null_count() == 0;
    let (address, kind) = if let Some(texts) = any.downcast_ref::<StringArray>() {
        let kind = if is_whole { "str" } else { "object" };
        let texts = PyList::new(py, texts.iter().collect::<Vec<_>>())?;
        return numpy.call_method1("array", (texts, kind));
    } else if !is_whole {
        let numbers = PyList::new(py, with_nan(column))?;
        return numpy.call_method1("array", (numbers, "float64"));
    } else if let Some(column) = any.downcast_ref::<Float64Array>() {
        (column.values().as_ptr() as usize, "f8")
    } else if let Some(column) = any.downcast_ref::<Int64Array>() {
        (column.values().as_ptr() as usize, "i8")
    } else {
        let text = format!("a column of type {} has no view", column.data_type());
        return Err(PyTypeError::new_err(text));
    };
    let view = View {
        _column: column.clone(),
        address,
        length: column.len(),
        kind,
    };
    numpy.call_method1("asarray", (view,))
}

/// The numbers of a column, with NaN for those that are missing.
fn with_nan(column: &ArrayRef) -> Vec<f64> {
    let any = column.as_any();
    if let Some(column) = any.downcast_ref::<Float64Array>() {
        return column.iter().map(|n| n.unwrap_or(f64::NAN)).collect();
    }
    any.downcast_ref::<Int64Array>()
        .into_iter()
        .flatten()
        .map(|cell| cell.map_or(f64::NAN, |integer| integer as f64))
        .collect()
}
