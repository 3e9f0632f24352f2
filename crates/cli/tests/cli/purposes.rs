//! The purposes of random numbers: no two of them share a number.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The purposes declared in a source file, with their numbers.
fn declared(source: &str) -> Vec<(String, String)> {
    let declaration = |line: &str| {
        let (name, value) = line.split_once("const ")?.1.split_once(": Purpose = Purpose::new(")?;
        Some((name.to_owned(), value.split_once(')')?.0.to_owned()))
    };
    source.lines().filter_map(declaration).collect()
}

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

#[test]
fn no_two_purposes_share_a_number() {
    let mut files = Vec::new();
    for krate in std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("..")).expect("the crates") {
        sources(&krate.expect("a crate").path().join("src"), &mut files);
    }
    let mut by_number: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for file in files {
        for (name, number) in declared(&std::fs::read_to_string(&file).expect("a source")) {
            by_number.entry(number).or_default().push(format!("{name} of {}", file.display()));
        }
    }
    assert!(by_number.len() >= 10, "{by_number:?}");
    for (number, names) in by_number {
        assert_eq!(names.len(), 1, "{number}: {names:?}");
    }
}

#[test]
fn declarations_are_found_with_their_numbers() {
    let source =
        "/// One.\npub(crate) const ONE: Purpose = Purpose::new(1);\nlet draw = seed.bits(Purpose::new(2), [0; 3]);";
    assert_eq!(declared(source), [("ONE".to_owned(), "1".to_owned())]);
}
