//! Keys that a scenario may have and does not: the schema knows them.

use serde_json::Value as Json;
use toml::{Table, Value};

use super::{Luck, Step, extremes};

/// A key that a table of a scenario may have, and what its value is.
#[derive(Clone, Debug)]
pub(crate) struct Addition {
    pub(crate) path: Vec<Step>,
    node: Json,
}

/// All keys that may be added to a scenario.
pub(crate) fn additions(schema: &Json, scenario: &Value) -> Vec<Addition> {
    let mut all = Vec::new();
    collect(schema, schema, scenario, &[], &mut all);
    all
}

/// The part of the schema that `node` refers to.
fn resolved<'s>(schema: &'s Json, mut node: &'s Json) -> &'s Json {
    while let Some(reference) = node["$ref"].as_str() {
        node = schema.pointer(reference.trim_start_matches('#')).expect("a part of the schema");
    }
    node
}

/// The alternatives of `node`, or `node` alone.
fn alternatives<'s>(schema: &'s Json, node: &'s Json) -> Vec<&'s Json> {
    let node = resolved(schema, node);
    let of = |key: &str| node[key].as_array().map(|nodes| nodes.iter().map(|node| resolved(schema, node)).collect());
    of("oneOf").or_else(|| of("anyOf")).unwrap_or_else(|| vec![node])
}

fn collect(schema: &Json, node: &Json, value: &Value, path: &[Step], all: &mut Vec<Addition>) {
    let deeper = |step: Step| [path, &[step]].concat();
    for node in alternatives(schema, node) {
        match (value, node["properties"].as_object()) {
            (Value::Table(table), Some(keys)) if required(node).all(|key| table.contains_key(key)) => {
                for (key, node) in keys {
                    let path = deeper(Step::Key(key.clone()));
                    match table.get(key) {
                        Some(value) => collect(schema, node, value, &path, all),
                        None => all.push(Addition { path, node: node.clone() }),
                    }
                }
            }
            (Value::Array(items), _) => {
                for (i, item) in items.iter().take(3).enumerate() {
                    collect(schema, &node["items"], item, &deeper(Step::Index(i)), all);
                }
            }
            _ => {}
        }
    }
}

fn required(node: &Json) -> impl Iterator<Item = &str> {
    node["required"].as_array().into_iter().flatten().filter_map(Json::as_str)
}

impl Addition {
    /// A value of the right type, which may be out of range.
    pub(crate) fn value(&self, schema: &Json, luck: &mut Luck) -> Value {
        value(schema, &self.node, luck)
    }
}

fn value(schema: &Json, node: &Json, luck: &mut Luck) -> Value {
    let node = luck.of(&alternatives(schema, node));
    if let Some(text) = node["const"].as_str() {
        return text.into();
    }
    if let Some(choices) = node["enum"].as_array() {
        return luck.of(choices).as_str().unwrap_or("x").into();
    }
    let kind = node["type"].as_str().or_else(|| node["type"][0].as_str());
    match kind {
        Some("boolean") => Value::Boolean(luck.below(2) == 0),
        Some("integer") => luck.of(&[0, 1, 2, 3, 10, -1, 65_536, 1 << 32, i64::MAX]).into(),
        Some("number") => {
            let usual = [0.5, 1.0, 2.0, 10.0, 1e-3, 1e-9, 1e-30, 1e12, 1e30].map(Value::Float);
            luck.of(&[&usual[..], &extremes()].concat())
        }
        Some("array") => {
            let items = (0..luck.below(3)).map(|_| value(schema, &node["items"], luck)).collect();
            Value::Array(items)
        }
        Some("object") => {
            let keys = node["properties"].as_object().into_iter().flatten();
            let mut table = Table::new();
            for (key, inner) in keys {
                if required(node).any(|name| name == key) || luck.below(4) == 0 {
                    table.insert(key.clone(), value(schema, inner, luck));
                }
            }
            Value::Table(table)
        }
        _ => "x".into(),
    }
}
