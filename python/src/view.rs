//! Columns as NumPy arrays, without a copy.

use arrow_array::{Array as _, ArrayRef, Float64Array, Int64Array, StringArray};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

/// A column for NumPy's array interface. The array that NumPy makes of it keeps it alive.
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

/// A column as a NumPy array: numbers as a read-only view, texts as a copy.
pub fn numpy<'py>(py: Python<'py>, column: &ArrayRef) -> PyResult<Bound<'py, PyAny>> {
    let numpy = py.import("numpy")?;
    let any = column.as_any();
    let (address, kind) = if let Some(column) = any.downcast_ref::<Float64Array>() {
        (column.values().as_ptr() as usize, "f8")
    } else if let Some(column) = any.downcast_ref::<Int64Array>() {
        (column.values().as_ptr() as usize, "i8")
    } else {
        let texts = any.downcast_ref::<StringArray>();
        let texts = PyList::new(py, texts.into_iter().flatten().collect::<Vec<_>>())?;
        return numpy.call_method1("array", (texts, "str"));
    };
    let view = View {
        _column: column.clone(),
        address,
        length: column.len(),
        kind,
    };
    numpy.call_method1("asarray", (view,))
}
