//! The parts of a schema.

use serde_json::{Map, Value};

/// Changes `schema` and all schemas in it, the inner ones first.
pub(super) fn each_schema(schema: &mut Value, change: &mut impl FnMut(&mut Map<String, Value>)) {
    let Value::Object(part) = schema else { return };
    for (key, value) in part.iter_mut() {
        match (key.as_str(), value) {
            ("properties" | "$defs", Value::Object(parts)) => {
                parts.values_mut().for_each(|part| each_schema(part, change));
            }
            ("oneOf" | "anyOf" | "allOf", Value::Array(parts)) => {
                parts.iter_mut().for_each(|part| each_schema(part, change));
            }
            ("items" | "additionalProperties", part) => each_schema(part, change),
            _ => {}
        }
    }
    change(part);
}

/// The name of the definition that `part` refers to.
pub(super) fn reference(part: &Value) -> Option<&str> {
    part["$ref"].as_str()?.strip_prefix("#/$defs/")
}
