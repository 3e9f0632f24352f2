//! Tests of the reference of all keys.

use std::collections::BTreeSet;

use super::*;

fn key(path: &str) -> KeyReference {
    match explain(path) {
        Ok(Explanation::Key { key, .. }) => *key,
        other => panic!("{path}: {other:?}"),
    }
}

#[test]
fn a_key_has_its_kind_its_unit_and_its_default() {
    let distance = key("channel.path_loss.log_distance.reference_distance_m");
    assert_eq!((distance.kind.as_str(), distance.unit.as_deref()), ("number", Some("m")));
    assert_eq!((distance.default.as_deref(), distance.is_required), (Some("1.0"), false));
    assert!(distance.summary().contains("reference_loss_db"), "{}", distance.summary());
    let start = key("robots.0.start_m");
    assert_eq!((start.kind.as_str(), start.is_required), ("list of 2 or 3 numbers", true));
    assert_eq!((key("seed").kind, key("seed").range), ("whole number".to_owned(), Some("0 or above".to_owned())));
    assert_eq!(key("maps").kind, "list of tables");
}

#[test]
fn a_choice_has_its_names_with_what_they_mean() {
    let law = key("channel.path_loss");
    assert_eq!(law.kind, "choice");
    let names: Vec<&str> = law.choices.iter().map(|choice| choice.name.as_str()).collect();
    assert_eq!(names, ["log_distance", "close_in"]);
    assert!(law.choices.iter().all(|choice| choice.has_settings && !choice.description.is_empty()));
    let suburban = key("channel.environment.suburban");
    assert_eq!(suburban.kind, "choice, written as \"suburban\"");
}

#[test]
fn indices_may_be_written_in_each_form_or_left_out() {
    let written =
        ["maps.0.algorithm.ml_tm", "maps[3].algorithm.ml_tm", "maps[].algorithm.ml_tm", "maps.algorithm.ml-tm"];
    for path in written {
        assert_eq!(key(path).path, "maps[].algorithm.ml_tm", "{path}");
    }
    assert_eq!(key("networks.backhaul.channel.max_range_m").path, "networks.NAME.channel.max_range_m");
}

#[test]
fn the_end_of_a_path_finds_all_keys_that_end_so() {
    let Ok(Explanation::Several(found)) = explain("exponent") else { panic!("there are several exponents") };
    assert!(found.len() >= 2);
    assert!(found.iter().all(|key| key.path.ends_with(".exponent")));
    assert_eq!(key("automated_s").path, "robots[].controller.automated_s");
    assert_eq!(key("controller.hilbert").path, "robots[].controller.hilbert");
}

#[test]
fn an_unknown_key_names_similar_ones() {
    let near = |path: &str| match explain(path) {
        Err(ExplainError::Unknown { near, .. }) => near,
        other => panic!("{path}: {other:?}"),
    };
    assert_eq!(near("channel.path_loss.log_distance.exponnent")[0], "channel.path_loss.log_distance.exponent");
    assert!(near("grid_stepm").iter().any(|path| path == "maps[].algorithm.ml_tm.grid_step_m"));
    assert_eq!(near("qqqqqq"), [""; 0]);
    for malformed in ["", ".", "a..b", "a[", "a[x]", "[0]", "\"a", "maps["] {
        assert!(matches!(explain(malformed), Err(ExplainError::Malformed { .. })), "{malformed}");
    }
}

#[test]
fn the_same_key_of_another_table_is_named() {
    let Ok(Explanation::Key { also, .. }) = explain("channel.max_range_m") else { panic!("it is a key") };
    assert_eq!(also, ["networks.NAME.channel.max_range_m"]);
    let Ok(Explanation::Key { also, .. }) = explain("networks.a.channel.max_range_m") else { panic!("it is a key") };
    assert_eq!(also, ["channel.max_range_m"]);
}

#[test]
fn each_listed_key_is_explained_by_its_own_path_and_has_a_description() {
    let all = key_reference();
    let paths: BTreeSet<&str> = all.iter().map(|key| key.path.as_str()).collect();
    assert_eq!(paths.len(), all.len());
    for listed in &all {
        let explained = key(&listed.path);
        assert_eq!(KeyReference { same_as: None, ..listed.clone() }, explained);
        assert!(!listed.description.is_empty(), "{}", listed.path);
    }
}

#[test]
fn a_key_that_is_listed_elsewhere_names_a_listed_place() {
    let all = key_reference();
    let is_listed =
        |path: &str| all.iter().any(|key| key.path == path.trim_end_matches("[]") || path.ends_with(".NAME"));
    for key in &all {
        if let Some(first) = &key.same_as {
            assert!(is_listed(first), "{}: {first}", key.path);
            let below = format!("{}.", key.path);
            assert!(all.iter().all(|other| !other.path.starts_with(&below)), "{}", key.path);
        }
    }
}

#[test]
fn the_example_of_each_key_is_written_in_toml() {
    for key in key_reference() {
        let lines = key.example();
        assert!(!lines.is_empty() && lines.len() <= 5, "{}: {lines:?}", key.path);
        let parsed = lines.join("\n").parse::<toml::Table>();
        assert!(parsed.is_ok(), "{}: {lines:?}: {parsed:?}", key.path);
    }
    let lines = |path: &str| key(path).example();
    assert_eq!(
        lines("channel.path_loss.log_distance.exponent"),
        ["[channel.path_loss.log_distance]", "exponent = 3.0"]
    );
    assert_eq!(
        lines("maps.algorithm.ml_tm.grid_step_m"),
        ["[[maps]]", "[maps.algorithm.ml_tm]", "grid_step_m = 0.25"]
    );
    assert_eq!(lines("mac"), ["[mac.csma_unslotted]"]);
    assert_eq!(lines("robots"), ["[[robots]]"]);
    assert_eq!(lines("seed"), ["seed = 1"]);
}
