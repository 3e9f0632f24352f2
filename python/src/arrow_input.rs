//! Arrays of Arrow that other libraries hand over in capsules.

use arrow_array::ArrayRef;
use arrow_array::ffi::FFI_ArrowSchema;
use arrow_schema::DataType;
use pyo3::exceptions::PyImportError;
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyTuple};
use pyo3_arrow::{PyArray, PyChunkedArray};

use crate::depth::Depth;
use crate::error::{LogError, panic_words};
use crate::work::caught_as;

/// An array in parts, as another library has it: nothing in it is checked yet but how deep its type is nested.
pub(crate) struct Chunks {
    pub(crate) kind: DataType,
    pub(crate) parts: Vec<ArrayRef>,
}

/// The array of `data`; `None` if it has none to hand over.
pub(crate) fn chunks_of(data: &Bound<'_, PyAny>) -> PyResult<Option<Chunks>> {
    let form = ["__arrow_c_array__", "__arrow_c_stream__"];
    for form in form {
        if !data.hasattr(form)? {
            continue;
        }
        return match data.call_method0(form) {
            Ok(given) => {
                let read = || if form == "__arrow_c_array__" { of_array(&given) } else { of_stream(&given) };
                // What imports the data gives up where they are not what their type says.
                caught_as(read, |why| {
                    LogError::new_err(format!("the data of Arrow are broken: {}", panic_words(why)))
                })
                .map(Some)
            }
            // A data frame of pandas hands over a stream only if pyarrow is installed.
            Err(error) if error.is_instance_of::<PyImportError>(data.py()) => Ok(None),
            Err(error) => Err(error),
        };
    }
    Ok(None)
}

/// The array of a capsule with a schema and one with an array.
fn of_array(given: &Bound<'_, PyAny>) -> PyResult<Chunks> {
    let given = given.cast::<PyTuple>()?;
    let (schema, array) =
        (given.get_item(0)?.cast_into::<PyCapsule>()?, given.get_item(1)?.cast_into::<PyCapsule>()?);
    shallow(capsules::schema(&schema)?)?;
    let (array, field) = PyArray::from_arrow_pycapsule(&schema, &array)?.into_inner();
    Ok(Chunks { kind: field.data_type().clone(), parts: vec![array] })
}

/// The array of a capsule with a stream of arrays.
fn of_stream(given: &Bound<'_, PyAny>) -> PyResult<Chunks> {
    let stream = given.cast::<PyCapsule>()?;
    shallow(&capsules::schema_of_stream(stream)?)?;
    let chunks = PyChunkedArray::from_arrow_pycapsule(stream)?;
    Ok(Chunks { kind: chunks.field().data_type().clone(), parts: chunks.chunks().to_vec() })
}

/// Refuses a type that is nested too deep: what imports it calls itself for each level.
fn shallow(schema: &FFI_ArrowSchema) -> PyResult<()> {
    let mut open = vec![(schema, Depth::default())];
    while let Some((schema, depth)) = open.pop() {
        for inner in schema.children().chain(schema.dictionary()) {
            open.push((inner, depth.inner("the type of a column")?));
        }
    }
    Ok(())
}

/// What is in capsules of the Arrow C data interface. The libraries that import from them read the whole type at once, however
/// deep it is, so this looks before they do.
#[expect(unsafe_code, reason = "capsules hold pointers, and the names of capsules say to what")]
mod capsules {
    use std::ffi::CStr;

    use arrow_array::ffi::FFI_ArrowSchema;
    use arrow_array::ffi_stream::FFI_ArrowArrayStream;
    use pyo3::exceptions::{PyTypeError, PyValueError};
    use pyo3::prelude::*;
    use pyo3::types::PyCapsule;

    const SCHEMA: &CStr = c"arrow_schema";
    const STREAM: &CStr = c"arrow_array_stream";

    /// The schema in a capsule.
    pub(super) fn schema<'a>(capsule: &'a Bound<'_, PyCapsule>) -> PyResult<&'a FFI_ArrowSchema> {
        let pointer = capsule.pointer_checked(Some(SCHEMA))?.cast::<FFI_ArrowSchema>();
        // SAFETY: a capsule with this name holds a schema that lives as long as the capsule (Arrow PyCapsule interface).
        let schema = unsafe { pointer.as_ref() };
        if schema.release.is_some() { Ok(schema) } else { Err(PyValueError::new_err("the schema was taken already")) }
    }

    /// The schema of the stream in a capsule. The stream stays whole.
    pub(super) fn schema_of_stream(capsule: &Bound<'_, PyCapsule>) -> PyResult<FFI_ArrowSchema> {
        let mut pointer = capsule.pointer_checked(Some(STREAM))?.cast::<FFI_ArrowArrayStream>();
        // SAFETY: a capsule with this name holds a stream that lives as long as the capsule, and nothing else uses it while
        // the interpreter is ours.
        let stream = unsafe { pointer.as_mut() };
        if stream.release.is_none() {
            return Err(PyValueError::new_err("the stream was taken already"));
        }
        let get_schema = stream.get_schema.ok_or_else(|| PyTypeError::new_err("the stream has no schema"))?;
        let mut schema = FFI_ArrowSchema::empty();
        // SAFETY: the function is that of the stream, and the schema is one that may be written.
        match unsafe { get_schema(stream, &raw mut schema) } {
            0 => Ok(schema),
            code => Err(PyValueError::new_err(format!("the stream does not give its schema: error {code}"))),
        }
    }
}
