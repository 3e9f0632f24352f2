//! Notes for people: units and titles.

use serde_json::{Map, Value};

use crate::schema::walk::each_schema;
use crate::unit;

/// Adds the unit of each key that has one, and the title of each definition.
pub(super) fn add(schema: &mut Value) {
    each_schema(schema, &mut |part| {
        if let Some(Value::Object(properties)) = part.get_mut("properties") {
            for (key, value) in properties {
                if let (Some(unit), Value::Object(part)) = (unit::of(key), value) {
                    part.insert("x-unit".to_owned(), unit.into());
                }
            }
        }
        if let Some(Value::String(text)) = part.get_mut("description") {
            *text = text.replace('\n', " ");
        }
    });
    if let Some(Value::Object(definitions)) = schema.get_mut("$defs") {
        for (name, definition) in definitions {
            if let Value::Object(definition) = definition {
                title(name, definition);
            }
        }
    }
}

/// `LogDistanceConfig` is titled "Log distance".
fn title(name: &str, definition: &mut Map<String, Value>) {
    let mut title = String::new();
    let name = name.trim_end_matches(|c: char| c.is_ascii_digit());
    for (i, letter) in name.strip_suffix("Config").unwrap_or(name).chars().enumerate() {
        if letter.is_uppercase() && i > 0 {
            title.push(' ');
            title.extend(letter.to_lowercase());
        } else {
            title.push(letter);
        }
    }
    definition.insert("title".to_owned(), title.into());
}
