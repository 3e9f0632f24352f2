//! Values of Python as settings of a scenario and back.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyMapping, PySequence, PyString};
use serde::Serialize;
use serde_json::Value;

use crate::depth::Depth;
use crate::entries::{each_entry, unchanged};

/// The longest text (octets): that of the largest scenario in a file. A list without an end, or one that is many times in itself,
/// has a longer one.
const LONGEST: usize = 1 << 26;

/// What settings are called in errors.
const SETTING: &str = "a setting";

/// A text of TOML that grows.
#[derive(Default)]
struct Toml(String);

impl Toml {
    fn push(&mut self, text: &str) -> PyResult<()> {
        if self.0.len() + text.len() > LONGEST {
            let words = format!("the settings are longer than {} MiB of text, or a list has no end", LONGEST >> 20);
            return Err(PyValueError::new_err(words));
        }
        self.0.push_str(text);
        Ok(())
    }

    fn value(&mut self, value: &Bound<'_, PyAny>, depth: Depth) -> PyResult<()> {
        if value.is_instance_of::<PyBool>() {
            return self.push(&value.is_truthy()?.to_string());
        }
        if let Ok(text) = value.cast::<PyString>() {
            return self.push(&quoted(text.to_str()?));
        }
        if value.is_instance_of::<PyInt>() {
            // Not `str`, which an enumeration has of its own.
            let digits = value.py().get_type::<PyInt>().call_method1("__repr__", (value,))?;
            return self.push(digits.cast::<PyString>()?.to_str()?);
        }
        if value.is_instance_of::<PyFloat>() {
            return self.push(&float(value.extract()?));
        }
        let depth = depth.inner(SETTING)?;
        if let Ok(mapping) = value.cast::<PyMapping>() {
            return self.table(mapping, depth);
        }
        if let Ok(sequence) = value.cast::<PySequence>() {
            return self.array(sequence, depth);
        }
        // Numbers and arrays of NumPy, and paths.
        for form in ["tolist", "__fspath__"] {
            if value.hasattr(form)? {
                return self.value(&value.call_method0(form)?, depth);
            }
        }
        let kind = value.get_type().name()?;
        Err(PyTypeError::new_err(format!(
            "a setting is a {kind}; allowed: bool, int, float, str, a path, and lists and dicts of these"
        )))
    }

    fn table(&mut self, mapping: &Bound<'_, PyMapping>, depth: Depth) -> PyResult<()> {
        let mut before = "{ ";
        each_entry(mapping, SETTING, |key, value| {
            self.push(before)?;
            before = ", ";
            self.push(&quoted(&key))?;
            self.push(" = ")?;
            self.value(&value, depth)
        })?;
        self.push(if before == ", " { " }" } else { "{ }" })
    }

    fn array(&mut self, sequence: &Bound<'_, PySequence>, depth: Depth) -> PyResult<()> {
        let count = sequence.len()?;
        let mut before = "[";
        for item in sequence.try_iter()? {
            self.push(before)?;
            before = ", ";
            self.value(&item?, depth)?;
            unchanged(count, sequence.len()?, "list")?;
        }
        self.push(if before == "[" { "[]" } else { "]" })
    }
}

/// A value as TOML writes it.
pub(crate) fn toml(value: &Bound<'_, PyAny>) -> PyResult<String> {
    let mut text = Toml::default();
    text.value(value, Depth::default())?;
    Ok(text.0)
}

/// A text in quotes, as JSON and TOML write it.
fn quoted(text: &str) -> String {
    Value::from(text).to_string().replace('\u{7f}', "\\u007F")
}

fn float(number: f64) -> String {
    match number {
        number if number.is_nan() => "nan".to_owned(),
        number if number.is_infinite() => if number > 0.0 { "inf" } else { "-inf" }.to_owned(),
        // With a point, so that it is not a whole number.
        number => format!("{number:?}"),
    }
}

/// A mapping as the text of a TOML document.
pub(crate) fn document(mapping: &Bound<'_, PyMapping>) -> PyResult<String> {
    let mut text = Toml::default();
    each_entry(mapping, SETTING, |key, value| {
        if value.is_none() {
            return Err(PyValueError::new_err(format!("the setting `{key}` is None; leave it out")));
        }
        text.push(&quoted(&key))?;
        text.push(" = ")?;
        text.value(&value, Depth::default())?;
        text.push("\n")
    })?;
    Ok(text.0)
}

/// A setting of a scenario, as `key=value` with the value as TOML writes it.
pub(crate) fn setting(key: &str, value: &Bound<'_, PyAny>) -> PyResult<String> {
    Ok(format!("{key}={}", toml(value)?))
}

/// A value of the library, as its JSON has it.
pub(crate) fn of_serialized<'py>(py: Python<'py>, value: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
    let value = serde_json::to_value(value).map_err(|why| PyValueError::new_err(why.to_string()))?;
    of_json(py, &value)
}

/// A value of JSON.
fn of_json<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        Value::Null => py.None().into_bound(py),
        Value::Bool(value) => PyBool::new(py, *value).to_owned().into_any(),
        Value::Number(number) => match (number.as_u64(), number.as_i64()) {
            (Some(number), _) => number.into_pyobject(py)?.into_any(),
            (None, Some(number)) => number.into_pyobject(py)?.into_any(),
            (None, None) => number.as_f64().into_pyobject(py)?.into_any(),
        },
        Value::String(text) => PyString::new(py, text).into_any(),
        Value::Array(items) => {
            let items: Vec<Bound<'py, PyAny>> =
                items.iter().map(|item| of_json(py, item)).collect::<PyResult<_>>()?;
            PyList::new(py, items)?.into_any()
        }
        Value::Object(entries) => {
            let dict = PyDict::new(py);
            for (key, value) in entries {
                dict.set_item(key, of_json(py, value)?)?;
            }
            dict.into_any()
        }
    })
}
