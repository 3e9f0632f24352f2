//! The JSON schema of scenario files.

mod choices;
mod extension;
#[cfg(test)]
#[cfg(feature = "schema")]
mod made;
mod walk;

use std::sync::LazyLock;

use serde_json::Value;

/// The schema, as a test of the feature `schema` makes it from the types of the settings.
const SCHEMA: &str = include_str!("schema/schema.json");

/// The schema, read once.
static PARSED: LazyLock<Value> = LazyLock::new(|| serde_json::from_str(SCHEMA).expect("a test writes it as JSON"));

/// The JSON schema (draft 2020-12) of whole scenarios: for programs, and for the reference of all keys. `default` is the
/// value that an absent key has, and `x-unit` the unit of a number.
#[must_use]
pub fn schema() -> Value {
    parsed().clone()
}

/// The same, borrowed.
pub(crate) fn parsed() -> &'static Value {
    &PARSED
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
