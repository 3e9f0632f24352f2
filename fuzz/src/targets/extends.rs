//! Scenario files that extend each other.

use sextant::Scenario;

use crate::named_texts::split;
use crate::properties::errors_are_clear;
use crate::scratch::Files;

/// Most files of an input.
const MOST_FILES: usize = 4;

/// Files `a.toml`, `b.toml`, .. in the order of the input. The first one is read, with settings that override it: those of
/// the text called `set`, one a line. What is refused has clear errors, and what is accepted reads again from its merged
/// text as the same scenario.
pub(crate) fn check(octets: &[u8]) {
    let Ok(input) = std::str::from_utf8(octets) else { return };
    let texts = split(input, "a", MOST_FILES);
    let files = Files::new();
    let mut set = Vec::new();
    for text in &texts {
        match text.name {
            "set" => set = text.text.lines().map(str::to_owned).collect(),
            "a" | "b" | "c" | "d" => files.write(&format!("{}.toml", text.name), text.text.as_bytes()),
            _ => {}
        }
    }
    match Scenario::load_with(files.folder().join("a.toml"), &set, None) {
        Ok(scenario) => {
            assert!(scenario.sources().count() <= texts.len() + scenario.named_files().len());
            if scenario.named_files().is_empty() {
                let again = Scenario::parse(scenario.text()).expect("the merged text is a scenario");
                assert_eq!(again.config(), scenario.config(), "the merged text is another scenario");
            }
        }
        Err(errors) => errors_are_clear(&errors),
    }
}
