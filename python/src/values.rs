//! Values of Python as settings of a scenario and back.

use std::fmt::Write as _;

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyMapping, PySequence, PyString};
use serde::Serialize;
use serde_json::Value;

/// A value as TOML writes it.
pub(crate) fn toml(value: &Bound<'_, PyAny>) -> PyResult<String> {
    if value.is_instance_of::<PyBool>() {
        return Ok(value.is_truthy()?.to_string());
    }
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(quoted(text.to_str()?));
    }
    if value.is_instance_of::<PyInt>() {
        return Ok(value.str()?.to_str()?.to_owned());
    }
    if value.is_instance_of::<PyFloat>() {
        return Ok(float(value.extract()?));
    }
    if let Ok(mapping) = value.cast::<PyMapping>() {
        let mut text = "{ ".to_owned();
        for (i, item) in mapping.items()?.iter().enumerate() {
            let (key, value): (String, Bound<'_, PyAny>) = item.extract()?;
            let comma = if i > 0 { ", " } else { "" };
            // Writing to a text cannot fail.
            let _ = write!(text, "{comma}{} = {}", quoted(&key), toml(&value)?);
        }
        return Ok(text + " }");
    }
    if let Ok(sequence) = value.cast::<PySequence>() {
        let items: Vec<String> = sequence.try_iter()?.map(|item| toml(&item?)).collect::<PyResult<_>>()?;
        return Ok(format!("[{}]", items.join(", ")));
    }
    // Numbers and arrays of NumPy, and paths.
    if let Ok(item) = value.call_method0("tolist") {
        return toml(&item);
    }
    if let Ok(path) = value.call_method0("__fspath__") {
        return toml(&path);
    }
    let kind = value.get_type().name()?;
    Err(PyTypeError::new_err(format!(
        "a setting is a {kind}; allowed: bool, int, float, str, a path, and lists and dicts of these"
    )))
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
    let mut text = String::new();
    for item in mapping.items()?.iter() {
        let (key, value): (String, Bound<'_, PyAny>) = item.extract()?;
        if value.is_none() {
            return Err(PyValueError::new_err(format!("the setting `{key}` is None; leave it out")));
        }
        // Writing to a text cannot fail.
        let _ = writeln!(text, "{} = {}", quoted(&key), toml(&value)?);
    }
    Ok(text)
}

/// A setting of a scenario, as `key=value` with the value as TOML writes it.
pub(crate) fn setting(key: String, value: &Bound<'_, PyAny>) -> PyResult<String> {
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
