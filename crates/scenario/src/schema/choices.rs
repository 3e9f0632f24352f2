//! Choices as tables with one key.

use serde_json::{Value, json};

use super::walk::each_schema;

/// Adds the empty table of each choice without settings.
pub(super) fn add_tables(schema: &mut Value) {
    each_schema(schema, &mut |part| {
        if let Some(Value::Array(choices)) = part.get_mut("oneOf") {
            let is_table = |name: &str| choices.iter().any(|choice| choice["properties"].get(name).is_some());
            let named = choices.iter().filter_map(|choice| Some((choice["const"].as_str()?, &choice["description"])));
            let tables: Vec<_> = named
                .filter(|(name, _)| !is_table(name))
                .map(|(name, description)| table(name, description))
                .collect();
            choices.extend(tables);
        }
    });
    // Only a type is a choice: names that a key lists, as those of materials, have no tables.
    let types = schema["$defs"].as_object_mut().into_iter().flat_map(|types| types.values_mut());
    for part in types.filter_map(Value::as_object_mut) {
        if let Some(names) = part.get("enum").and_then(Value::as_array).cloned() {
            let tables = names.iter().filter_map(Value::as_str).map(|name| table(name, &Value::Null));
            let choices: Vec<_> = std::iter::once(json!({ "type": "string", "enum": names })).chain(tables).collect();
            part.remove("enum");
            part.remove("type");
            part.insert("oneOf".to_owned(), choices.into());
        }
    }
}

/// A choice as a table without settings.
fn table(name: &str, description: &Value) -> Value {
    let empty = json!({ "type": "object", "additionalProperties": false });
    let mut form = json!({
        "type": "object",
        "properties": { name: empty },
        "required": [name],
        "additionalProperties": false,
    });
    copy_description(description, &mut form);
    form
}

/// The same description, if there is one.
pub(super) fn copy_description(description: &Value, form: &mut Value) {
    if description.is_string() {
        form["description"] = description.clone();
    }
}
