//! The JSON schema of scenario files.

mod choices;
mod extension;
mod notes;

use schemars::generate::SchemaSettings;
use serde_json::{Map, Value, json};

use super::config::ScenarioConfig;

/// The JSON schema (draft 2020-12) of whole scenarios: for programs, and for the reference of all keys. `default` is the
/// value that an absent key has, and `x-unit` the unit of a number.
#[must_use]
pub fn schema() -> Value {
    let mut schema =
        SchemaSettings::draft2020_12().into_generator().into_root_schema_for::<ScenarioConfig>().to_value();
    schema["title"] = "Sextant scenario".into();
    schema["properties"]["extends"] = json!({
        "description": "Path of another scenario file, relative to this one. The settings of this file override those of the other file, table by table.",
        "type": "string",
    });
    choices::add_names(&mut schema);
    notes::add(&mut schema);
    schema
}

/// The JSON schema of scenario files, for editors: a file that extends another one may lack keys that a whole scenario
/// needs.
#[must_use]
pub fn schema_of_files() -> Value {
    let mut schema = schema();
    choices::add_tables(&mut schema);
    extension::allow(schema)
}

/// Changes `schema` and all schemas in it, the inner ones first.
fn each_schema(schema: &mut Value, change: &mut impl FnMut(&mut Map<String, Value>)) {
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
fn reference(part: &Value) -> Option<&str> {
    part["$ref"].as_str()?.strip_prefix("#/$defs/")
}

#[cfg(test)]
mod tests;
