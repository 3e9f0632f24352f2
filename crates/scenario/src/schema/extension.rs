//! Files that extend others: they may lack what a whole scenario needs.

use std::collections::BTreeMap;

use serde_json::{Map, Value, json};

use super::walk::{each_schema, reference};

/// The definition of what a whole scenario needs. Those of its parts have this name before theirs.
const WHOLE: &str = "Whole";

/// Moves what a whole scenario needs out of `schema`, into a condition for files that extend no other.
pub(super) fn allow(mut schema: Value) -> Value {
    let needs = needs(&schema);
    each_schema(&mut schema, &mut |part| {
        // The key of a choice says which choice it is.
        let is_choice = part.get("properties").and_then(Value::as_object).is_some_and(|keys| keys.len() == 1)
            && part.get("$schema").is_none()
            && part.get("title").is_none();
        if !is_choice {
            part.remove("required");
        }
    });
    if let Some(Value::Object(definitions)) = schema.get_mut("$defs") {
        definitions.extend(needs);
    }
    schema["if"] = json!({ "required": ["extends"] });
    schema["else"] = json!({ "$ref": format!("#/$defs/{WHOLE}") });
    schema
}

/// What the definitions of `schema` need, by the names of the new definitions.
fn needs(schema: &Value) -> BTreeMap<String, Value> {
    let mut parts: BTreeMap<&str, &Value> = BTreeMap::new();
    parts.insert("", schema);
    if let Some(definitions) = schema["$defs"].as_object() {
        parts.extend(definitions.iter().map(|(name, part)| (name.as_str(), part)));
    }
    // A definition needs something if it does so itself, or refers to one that does.
    let mut needing: Vec<&str> = Vec::new();
    loop {
        let is_new = |(name, part): &(&&str, &&Value)| !needing.contains(*name) && need(part, &needing).is_some();
        let more: Vec<&str> = parts.iter().filter(is_new).map(|(name, _)| *name).collect();
        if more.is_empty() {
            break;
        }
        needing.extend(more);
    }
    let whole = |name: &&str| Some((format!("{WHOLE}{name}"), need(parts.get(name)?, &needing)?));
    needing.iter().filter_map(whole).collect()
}

/// What `part` needs, if it needs anything; `needing` are the definitions that do.
fn need(part: &Value, needing: &[&str]) -> Option<Value> {
    let mut needs = Map::new();
    if let Some(name) = reference(part).filter(|name| needing.contains(name)) {
        needs.insert("$ref".to_owned(), format!("#/$defs/{WHOLE}{name}").into());
    }
    let is_choice = part.get("oneOf").is_some();
    if let Some(required) = part.get("required") {
        needs.insert("required".to_owned(), required.clone());
    }
    let mut properties = Map::new();
    let choices = part["oneOf"].as_array().into_iter().flatten();
    let keyed = choices.chain(std::iter::once(part).filter(|_| !is_choice));
    for (key, value) in keyed.filter_map(|part| part["properties"].as_object()).flatten() {
        if let Some(need) = need(value, needing) {
            properties.insert(key.clone(), need);
        }
    }
    if !properties.is_empty() {
        needs.insert("properties".to_owned(), properties.into());
    }
    for key in ["items", "additionalProperties"] {
        if let Some(need) = part.get(key).and_then(|part| need(part, needing)) {
            needs.insert(key.to_owned(), need);
        }
    }
    for key in ["allOf", "anyOf"] {
        let parts = part[key].as_array().into_iter().flatten();
        let needed: Vec<_> = parts.filter_map(|part| need(part, needing)).collect();
        if !needed.is_empty() {
            needs.insert("allOf".to_owned(), needed.into());
        }
    }
    (!needs.is_empty()).then(|| needs.into())
}
