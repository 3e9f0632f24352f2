//! The JSON schema of scenario files.

use schemars::generate::SchemaSettings;
use serde_json::{Value, json};

use super::config::ScenarioConfig;

/// The JSON schema (draft 2020-12) of scenario files: for editors, for programs, and for the reference of all keys.
#[must_use]
pub fn schema() -> Value {
    let mut schema = SchemaSettings::draft2020_12().into_generator().into_root_schema_for::<ScenarioConfig>();
    schema.insert("title".to_owned(), "Sextant scenario".into());
    // `extends` is read first, and the file that it names may contain the required keys.
    let extends = json!({
        "description": "Path of another scenario file, relative to this one. The settings of this file override those of the other file, table by table.",
        "type": "string",
    });
    if let Some(properties) = schema.get_mut("properties").and_then(Value::as_object_mut) {
        properties.insert("extends".to_owned(), extends);
    }
    if let Some(required) = schema.remove("required") {
        schema.insert("anyOf".to_owned(), json!([{ "required": required }, { "required": ["extends"] }]));
    }
    schema.to_value()
}
