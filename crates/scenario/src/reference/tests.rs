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

/// The first numbers "from A to B" of a text.
fn told_range(text: &str) -> Option<(f64, f64)> {
    let words: Vec<&str> = text.split_whitespace().map(|word| word.trim_matches([',', '.', ';', ':'])).collect();
    words
        .windows(3)
        .find(|words| words[1] == "to")
        .and_then(|words| Some((words[0].parse().ok()?, words[2].parse().ok()?)))
}

#[test]
fn the_range_of_a_whole_number_is_that_of_the_key_and_not_of_its_type() {
    let range = |path: &str| key(path).range.expect("a range");
    assert_eq!(range("traffic.poisson.mpdu_octets"), "11 to 127");
    assert_eq!(range("mac.csma_unslotted.max_be"), "3 to 8");
    assert_eq!(range("routing.tree.rpl.dao_tries"), "0 to 100");
    for key in key_reference().iter().filter(|key| key.kind == "whole number") {
        let Some(range) = &key.range else { continue };
        if let Some((least, most)) = told_range(&key.description).filter(|_| key.name() != "channel") {
            assert_eq!(*range, format!("{least} to {most}"), "{}: {}", key.path, key.description);
        }
        let is_of_type = range == "0 to 255" || range == "0 to 65535";
        let is_told = key.description.contains(range.as_str()) || key.name() == "channel_offset";
        assert!(!is_of_type || is_told, "{}: {range}: {}", key.path, key.description);
    }
}

#[test]
fn a_number_beyond_its_type_is_refused_with_the_numbers_of_its_key() {
    let text = "name = \"a\"\nduration_s = 1.0\nradio = { tx_power_dbm = 0.0, sensitivity_dbm = -90.0 }\nworld.nodes.explicit.positions_m = [[0.0, 0.0]]\n\
                channel.path_loss.log_distance.exponent = 3.0\nmac.csma_unslotted = {}\ntraffic.periodic = {}\n\
                sinks = [{ name = \"sink\", position_m = [1.0, 0.0] }]";
    let scenario = crate::Scenario::parse(text).expect("a scenario");
    for (key, allowed) in [
        ("traffic.periodic.mpdu_octets", "a whole number, 11 to 127"),
        ("mac.csma_unslotted.max_retries", "a whole number, 0 to 7"),
        ("mac.csma_unslotted.queue_frames", "a whole number, 0 to 10000"),
        ("radio.channel", "a whole number, 0 to 26"),
    ] {
        for value in ["-1", "300000"] {
            let errors = scenario.with(key, value).err().expect("a mistake").to_string();
            let expected = format!("`{key}` is the integer {value}; allowed: {allowed}");
            assert!(errors.contains(&expected), "{errors}");
        }
    }
    // The least number alone is that of the key.
    let errors = scenario.with("recording.map_snapshots", "5000000000").err().expect("a mistake").to_string();
    assert!(errors.contains("a whole number, 0 to 100"), "{errors}");
}
