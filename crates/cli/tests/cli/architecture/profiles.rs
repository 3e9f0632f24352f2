//! What tests are built with.

use std::hint::black_box;

#[test]
fn an_overflow_of_integers_stops_a_test() {
    let sum = std::panic::catch_unwind(|| black_box(u8::MAX) + black_box(1));
    assert!(sum.is_err(), "the profile of tests needs `overflow-checks = true`, but the sum was {sum:?}");
}

#[test]
fn no_crate_is_tested_without_checks_of_overflow() {
    let manifest = std::fs::read_to_string(super::root().join("Cargo.toml")).expect("the manifest");
    let manifest: toml::Table = manifest.parse().expect("TOML");
    let profiles = manifest["profile"].as_table().expect("a table");
    assert_eq!(profiles["dev"]["overflow-checks"].as_bool(), Some(true));
    let checks = |name: &str| -> Vec<String> {
        let Some(profile) = profiles.get(name).and_then(|profile| profile.as_table()) else { return Vec::new() };
        let packages = profile.get("package").and_then(|packages| packages.as_table()).into_iter().flatten();
        let tables = packages.map(|(package, table)| (package.as_str(), table)).chain([(name, &profiles[name])]);
        let off =
            tables.filter(|(_, table)| table.get("overflow-checks").and_then(toml::Value::as_bool) == Some(false));
        off.map(|(place, _)| place.to_owned()).collect()
    };
    for profile in ["dev", "test"] {
        assert_eq!(checks(profile), Vec::<String>::new(), "profile {profile}: these have no checks of overflow");
    }
}
