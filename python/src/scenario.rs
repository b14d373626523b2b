//! Scenarios in Python.

use crate::errors;
use crate::table::escaped;
use pyo3::exceptions::{PyKeyError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyMapping, PyString};
use std::path::PathBuf;
use toprise::archive::input::Input;
use toprise::run::scenario::{Scenario as Checked, ScenarioError, Value, Values};
use toprise::sweep::{find_key, values_of_row};

/// A validated definition of a run: keys and values, in SI units and radians.
///
/// `Scenario("paper", {"friction.k": 0.02})` is the scenario of a preset, of a scenario file (TOML), of a recording (MCAP)
/// or another one, with some keys set; `None` removes a key. It behaves like a read-only mapping: `scenario["friction.k"]`,
/// `dict(scenario)`. Two scenarios are equal if all their keys and values are.
#[pyclass(frozen, mapping, module = "toprise")]
pub struct Scenario(pub Checked);

/// Argument that identifies a scenario.
pub enum Base<'py> {
    /// A scenario.
    Scenario(Bound<'py, Scenario>),
    /// A preset or a file.
    Word(PathBuf),
}

impl<'py> FromPyObject<'_, 'py> for Base<'py> {
    type Error = PyErr;

    fn extract(input: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(scenario) = input.cast::<Scenario>() {
            return Ok(Self::Scenario(scenario.to_owned()));
        }
        input.extract().map(Self::Word).map_err(|_| {
            let kind = input.get_type();
            PyTypeError::new_err(format!(
                "a scenario is a preset, a file or a Scenario, not {kind}"
            ))
        })
    }
}

impl Base<'_> {
    /// The scenario with some keys set.
    pub fn scenario(self, overrides: Option<&Bound<'_, PyMapping>>) -> PyResult<Checked> {
        match (self, overrides) {
            (Self::Scenario(scenario), None) => Ok(scenario.get().0.clone()),
            (base, overrides) => Checked::new(base.values(overrides)?).map_err(errors::scenario),
        }
    }

    /// The scenario of a row of a sweep's table, with some keys set.
    pub fn row(self, row: u64, overrides: Option<&Bound<'_, PyMapping>>) -> PyResult<Checked> {
        let Self::Word(table) = self else {
            let text = "row: a scenario has none; name the file of a sweep's table";
            return Err(PyTypeError::new_err(text));
        };
        let values = values_of_row(&table, row).map_err(errors::sweep)?;
        Checked::new(with(values, overrides)?).map_err(errors::scenario)
    }

    /// The keys and values after overrides; not validated together.
    pub fn values(self, overrides: Option<&Bound<'_, PyMapping>>) -> PyResult<Values> {
        let values = match self {
            Self::Scenario(scenario) => {
                let text = scenario.get().0.to_toml();
                Values::from_toml(&text).map_err(errors::scenario)?
            }
            Self::Word(word) => Input::open(&word)
                .and_then(|input| input.values())
                .map_err(errors::input)?,
        };
        with(values, overrides)
    }
}

fn with(mut values: Values, overrides: Option<&Bound<'_, PyMapping>>) -> PyResult<Values> {
    if let Some(overrides) = overrides {
        let mut seen = Vec::new();
        for item in overrides.items()?.iter() {
            let (name, value): (String, Bound<'_, PyAny>) = item.extract()?;
            let key = find_key(&name).map_err(errors::scenario)?;
            if seen.contains(&key.path) {
                return Err(errors::scenario(ScenarioError::set_twice(key)));
            }
            set(&mut values, key.path, &value)?;
            seen.push(key.path);
        }
    }
    Ok(values)
}

/// The path of a key that is written `friction.k` or `friction_k`; an unknown name is returned as it is.
fn path(name: &str) -> &str {
    find_key(name).map_or(name, |key| key.path)
}

fn set(values: &mut Values, key: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
    let set = if value.is_none() {
        values.set(key, "")
    } else if let Ok(text) = value.cast::<PyString>() {
        values.set(key, text.to_cow()?.as_ref())
    } else if let Ok(truth) = value.cast::<PyBool>() {
        values.set_value(key, truth.is_true())
    } else if let Ok(number) = value.extract::<f64>() {
        values.set_value(key, number)
    } else {
        let kind = value.get_type().name()?;
        let text = format!("{key}: must be a number, a text or None, not {kind}");
        return Err(PyTypeError::new_err(text));
    };
    set.map_err(errors::scenario)
}

#[pymethods]
impl Scenario {
    #[new]
    #[pyo3(signature = (base, overrides=None))]
    fn new(base: Base<'_>, overrides: Option<&Bound<'_, PyMapping>>) -> PyResult<Self> {
        base.scenario(overrides).map(Self)
    }

    /// Reads and checks the text of a scenario file.
    #[staticmethod]
    fn from_toml(text: &str) -> PyResult<Self> {
        Checked::from_toml(text).map(Self).map_err(errors::scenario)
    }

    /// The scenario as the text of a scenario file: all keys that are set, in a fixed order.
    fn to_toml(&self) -> String {
        self.0.to_toml()
    }

    /// The name, used for file names of recordings.
    #[getter]
    fn name(&self) -> &str {
        self.0.name()
    }

    /// SHA-256 of all keys and values except name and description. Equal for scenarios that define the same run.
    #[getter]
    fn digest(&self) -> String {
        self.0.digest()
    }

    /// The keys that are set, in the order of a scenario file.
    fn keys(&self) -> Vec<&'static str> {
        self.0.entries().map(|(key, _)| key.path).collect()
    }

    /// The unit of a key's value; empty for pure numbers and texts.
    #[staticmethod]
    fn unit(key: &str) -> PyResult<&'static str> {
        let found = find_key(key).map_err(|error| PyKeyError::new_err(error.to_string()))?;
        Ok(found.unit)
    }

    fn __getitem__<'py>(&self, py: Python<'py>, key: &str) -> PyResult<Bound<'py, PyAny>> {
        let key = path(key);
        let found = self.0.entries().find(|(known, _)| known.path == key);
        match found {
            Some((_, Value::Number(number))) => Ok(number.into_pyobject(py)?.into_any()),
            Some((_, Value::Text(text))) => Ok(text.into_pyobject(py)?.into_any()),
            None => {
                let set = self.keys().join(", ");
                let text = format!("the scenario doesn't set {key}; it sets {set}");
                Err(PyKeyError::new_err(text))
            }
        }
    }

    fn __contains__(&self, key: &str) -> bool {
        let key = path(key);
        self.0.entries().any(|(known, _)| known.path == key)
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(self.keys().into_pyobject(py)?.try_iter()?.into_any())
    }

    fn __len__(&self) -> usize {
        self.0.entries().count()
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.0 == other.0
    }

    fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        PyString::new(py, &self.0.to_toml()).hash()
    }

    fn __repr__(&self) -> String {
        let digest = self.0.digest();
        let name = self.0.name().escape_debug();
        let mut text = format!("<toprise.Scenario {name} {}…", &digest[..12]);
        for (key, value) in self.0.entries() {
            if key.path.starts_with("friction.") || key.path.starts_with("initial.") {
                text += format!("\n  {:20} {value} {}", key.path, key.unit).trim_end();
            }
        }
        text + ">"
    }

    /// A table of the keys, their values and units.
    fn _repr_html_(&self) -> String {
        let mut page = "<table><tbody>".to_owned();
        for (key, value) in self.0.entries() {
            let value = escaped(&value.to_string());
            page += &format!(
                "<tr><th>{}</th><td>{value}</td><td>{}</td></tr>",
                key.path,
                escaped(key.unit)
            );
        }
        page + "</tbody></table>"
    }

    fn __str__(&self) -> String {
        self.0.to_toml()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        let from_toml = slf.get_type().getattr("from_toml")?;
        Ok((from_toml, (slf.get().0.to_toml(),)))
    }
}
