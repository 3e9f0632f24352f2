//! Choices in both of their forms: a name, and a table with one key.

use serde_json::{Map, Value, json};

use super::walk::{each_schema, reference};

/// Adds the name of each choice whose settings all have a default. Removes `null`, which TOML does not have.
pub(super) fn add_names(schema: &mut Value) {
    each_schema(schema, &mut without_null);
    let whole = schema.clone();
    each_schema(schema, &mut |part| {
        if let Some(Value::Array(choices)) = part.get_mut("oneOf") {
            let names: Vec<_> = choices.iter().filter_map(|choice| name_alone(choice, &whole)).collect();
            choices.extend(names);
        }
    });
}

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
        } else if let Some(names) = part.get("enum").and_then(Value::as_array).cloned() {
            let tables = names.iter().filter_map(Value::as_str).map(|name| table(name, &Value::Null));
            let choices: Vec<_> = std::iter::once(json!({ "type": "string", "enum": names })).chain(tables).collect();
            part.remove("enum");
            part.remove("type");
            part.insert("oneOf".to_owned(), choices.into());
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

fn copy_description(description: &Value, form: &mut Value) {
    if description.is_string() {
        form["description"] = description.clone();
    }
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
