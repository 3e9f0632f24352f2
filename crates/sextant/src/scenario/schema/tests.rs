use serde_json::Value;

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
fn a_key_is_required_or_has_a_default_or_says_what_its_absence_means() {
    let mut silent = Vec::new();
    each_key(&schema(), &mut |key, table, part| {
        let is_required = table["required"].as_array().is_some_and(|keys| keys.iter().any(|needed| needed == key));
        let is_told = ["absent", "default", "none"]
            .iter()
            .any(|word| part["description"].as_str().is_some_and(|text| text.to_lowercase().contains(word)));
        if !is_required && part.get("default").is_none() && !is_told {
            silent.push(format!("{}.{key}", table["title"]));
        }
    });
    assert_eq!(silent, [""; 0]);
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
}
