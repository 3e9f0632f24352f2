use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::*;

/// Calls `see` with each key of a table in `schema`, the table and its part.
fn each_key(schema: &Value, see: &mut impl FnMut(&str, &Value, &Value)) {
    for (key, part) in schema["properties"].as_object().into_iter().flatten() {
        see(key, schema, part);
        each_key(part, see);
    }
    for parts in ["oneOf", "anyOf", "allOf"] {
        schema[parts].as_array().into_iter().flatten().for_each(|part| each_key(part, see));
    }
    for part in ["items", "additionalProperties"] {
        if let Some(part) = schema.get(part) {
            each_key(part, see);
        }
    }
    schema["$defs"].as_object().into_iter().flatten().for_each(|(_, part)| each_key(part, see));
}

#[test]
fn a_key_that_may_be_absent_shows_the_value_that_it_then_has() {
    let mut defaults = BTreeMap::new();
    each_key(&schema(), &mut |key, table, part| {
        if let Some(default) = part.get("default") {
            let title = table["title"].as_str().unwrap_or_default();
            defaults.insert(format!("{title}.{key}"), default.clone());
        }
    });
    // As the comments of these keys say.
    for (key, expected) in
        [("Periodic.interval_s", json!(1.0)), ("Periodic.jitter", json!(0.1)), ("Periodic.mpdu_octets", json!(20))]
    {
        assert_eq!(defaults.get(key), Some(&expected), "{key} in {defaults:?}");
    }
    assert!(defaults.len() > 150, "{}", defaults.len());
}

#[test]
fn a_number_has_the_unit_that_its_key_ends_in() {
    let mut units = 0;
    each_key(&schema(), &mut |key, _, part| {
        units += usize::from(part.get("x-unit").is_some());
        for (ending, unit) in [("_dbm", "dBm"), ("_m_per_s", "m/s"), ("_ghz", "GHz"), ("interval_s", "s")] {
            if key.ends_with(ending) {
                assert_eq!(part["x-unit"], unit, "{key}");
            }
        }
    });
    assert!(units > 150, "{units}");
}

#[test]
fn nothing_is_null_and_all_definitions_have_titles() {
    let schema = schema();
    let text = schema.to_string();
    assert!(!text.contains("\"null\"") && !text.contains(":null"));
    for (name, part) in schema["$defs"].as_object().expect("an object") {
        assert!(part["title"].is_string(), "{name}");
    }
}

#[test]
fn a_choice_is_a_name_or_a_table() {
    let schema = schema_of_files();
    let forms = |name: &str| schema["$defs"][name]["oneOf"].as_array().expect("a choice").clone();
    assert!(forms("MacConfig").iter().any(|form| form["const"] == "csma_unslotted"));
    assert!(forms("Environment").iter().any(|form| form["properties"]["suburban"].is_object()));
    // A trapezoid has no default for its range.
    assert!(forms("ProfileConfig").iter().all(|form| form["const"] != "trapezoid"));
    let material = &schema["$defs"]["ObstacleConfig"]["properties"]["material"];
    assert!(material["oneOf"].is_null() && material["enum"].is_array(), "a name among many: {material}");
}
