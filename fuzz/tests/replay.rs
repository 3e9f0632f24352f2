//! Every seed, and every input that once broke a property, is replayed.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use sextant_fuzz::TARGETS;

/// Most octets of all inputs together.
const MOST_OCTETS: u64 = 2_000_000;

/// The files in a folder of inputs, sorted.
fn inputs(kind: &str, target: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(kind).join(target);
    let entries = std::fs::read_dir(folder).into_iter().flatten();
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry of the folder").path()).collect();
    files.sort();
    files
}

#[test]
fn every_seed_and_every_input_that_once_failed_holds_all_properties() {
    for target in &TARGETS {
        let seeds = inputs("corpus", target.name);
        assert!(!seeds.is_empty(), "`{}` has no seeds", target.name);
        for file in seeds.into_iter().chain(inputs("crashes", target.name)) {
            // The name of the file is shown if the target panics.
            eprintln!("{}: {}", target.name, file.display());
            target.run(&std::fs::read(&file).expect("a file"));
        }
    }
}

#[test]
fn each_folder_of_inputs_is_that_of_a_target_and_all_are_small() {
    let known: BTreeSet<&str> = TARGETS.iter().map(|target| target.name).collect();
    assert_eq!(known.len(), TARGETS.len(), "two targets have one name");
    let mut octets = 0;
    for kind in ["corpus", "crashes"] {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(kind);
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let name = entry.expect("an entry of the folder").file_name().into_string().expect("a plain name");
            assert!(name == "README.md" || known.contains(name.as_str()), "{kind}/{name} is of no target");
            octets += inputs(kind, &name).iter().map(|file| file.metadata().expect("a file").len()).sum::<u64>();
        }
    }
    assert!(octets <= MOST_OCTETS, "the inputs have {octets} octets; allowed: {MOST_OCTETS}");
}
