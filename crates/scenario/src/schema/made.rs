//! The schema as the types of settings make it. It stands in the tree, so that the program is built without what makes it.

mod names;
mod notes;

use std::path::Path;

use schemars::generate::SchemaSettings;
use serde_json::{Value, json};

use crate::config::ScenarioConfig;

fn made() -> Value {
    let mut schema =
        SchemaSettings::draft2020_12().into_generator().into_root_schema_for::<ScenarioConfig>().to_value();
    schema["title"] = "Sextant scenario".into();
    schema["properties"]["extends"] = json!({
        "description": "Path of another scenario file, relative to this one. The settings of this file override those of the other file, table by table.",
        "type": "string",
    });
    names::add(&mut schema);
    notes::add(&mut schema);
    schema
}

#[test]
fn the_schema_in_the_tree_is_that_of_the_types() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/schema/schema.json");
    let made = serde_json::to_string_pretty(&made()).expect("JSON") + "\n";
    if std::env::var("SEXTANT_SCHEMA").is_ok_and(|wish| wish == "update") {
        std::fs::write(&path, &made).expect("the sources can be written");
    }
    let kept = std::fs::read_to_string(&path).expect("the schema is there");
    let differing = kept.lines().zip(made.lines()).position(|(kept, made)| kept != made);
    assert!(
        kept == made,
        "{} differs from line {}; SEXTANT_SCHEMA=update writes it",
        path.display(),
        differing.map_or(kept.lines().count().min(made.lines().count()), |line| line) + 1,
    );
}
