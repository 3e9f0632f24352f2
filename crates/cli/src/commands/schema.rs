//! `sextant schema`: the JSON schema of scenario files, for editors and programs.

use std::io::{self, Write};

use schemars::generate::SchemaSettings;
use serde_json::{Value, json};

use crate::diagnostic::Failure;
use sextant::scenario::ScenarioConfig;

pub(crate) fn execute() -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    serde_json::to_writer_pretty(&mut stdout, &schema()).map_err(io::Error::from)?;
    writeln!(stdout)?;
    Ok(())
}

/// The JSON schema (draft 2020-12) of scenario files.
fn schema() -> schemars::Schema {
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
    schema
}
