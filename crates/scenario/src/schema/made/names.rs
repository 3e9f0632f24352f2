//! Choices as names.

use serde_json::{Map, Value, json};

use crate::schema::choices::copy_description;
use crate::schema::walk::{each_schema, reference};

/// Adds the name of each choice whose settings all have a default. Removes `null`, which TOML does not have.
pub(super) fn add(schema: &mut Value) {
    each_schema(schema, &mut without_null);
    let whole = schema.clone();
    each_schema(schema, &mut |part| {
        if let Some(Value::Array(choices)) = part.get_mut("oneOf") {
            let names: Vec<_> = choices.iter().filter_map(|choice| name_alone(choice, &whole)).collect();
            choices.extend(names);
        }
    });
}

/// The name of a choice, if it is a table that needs no settings.
fn name_alone(choice: &Value, whole: &Value) -> Option<Value> {
    let (name, settings) = choice["properties"].as_object()?.iter().next()?;
    let mut settings = settings;
    while let Some(name) = reference(settings) {
        settings = &whole["$defs"][name];
    }
    let is_table = settings["type"] == "object" && settings.get("additionalProperties") == Some(&Value::Bool(false));
    let needs_none = settings["required"].as_array().is_none_or(Vec::is_empty);
    let mut form = json!({ "type": "string", "const": name });
    copy_description(&choice["description"], &mut form);
    (is_table && needs_none).then_some(form)
}

fn without_null(part: &mut Map<String, Value>) {
    if let Some(Value::Array(types)) = part.get_mut("type") {
        types.retain(|kind| kind != "null");
        if let [only] = types.as_slice() {
            let only = only.clone();
            part.insert("type".to_owned(), only);
        }
    }
    if let Some(Value::Array(parts)) = part.get_mut("anyOf") {
        parts.retain(|part| part["type"] != "null");
        if let [Value::Object(only)] = parts.as_slice() {
            let only = only.clone();
            part.remove("anyOf");
            for (key, value) in only {
                part.entry(key).or_insert(value);
            }
        }
    }
    if part.get("default") == Some(&Value::Null) {
        part.remove("default");
    }
    if let Some(default) = part.get_mut("default") {
        remove_nulls(default);
    }
}

/// Removes the keys that have no value.
fn remove_nulls(value: &mut Value) {
    if let Value::Object(table) = value {
        table.retain(|_, value| !value.is_null());
        table.values_mut().for_each(remove_nulls);
    }
}
