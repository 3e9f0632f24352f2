//! The JSON schema of scenario files.

mod choices;
mod extension;
mod notes;
mod walk;

use schemars::generate::SchemaSettings;
use serde_json::{Value, json};

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

#[cfg(test)]
mod tests;
