//! The pages of reference, as the program gives them.

mod columns;
mod keys;

use std::collections::{BTreeMap, BTreeSet};

use crate::program::{Said, sextant};

/// What the program prints.
fn printed(words: &[&str]) -> String {
    sextant().args(words).output().expect("the program starts").printed()
}

/// The reference of commands.
pub(crate) fn commands() -> String {
    printed(&["man", "--format", "markdown"])
}

/// The reference of keys.
pub(crate) fn keys() -> String {
    keys::page(&sextant::scenario::key_reference())
}

/// The reference of the columns of tables of sweeps.
pub(crate) fn columns() -> String {
    columns::page(&sextant_study::sweep::described_columns(None))
}

/// The long options of each command.
pub(crate) fn options_by_command() -> BTreeMap<String, BTreeSet<String>> {
    let page = commands();
    let sections = page.split("\n## sextant ").skip(1).map(|section| {
        let (name, rest) = section.split_once('\n').expect("a heading is a line");
        let options = rest.lines().filter_map(|line| line.strip_prefix("| `")?.split('`').next());
        let long = options.filter_map(|option| option.split([' ', ',']).find(|word| word.starts_with("--")));
        (name.to_owned(), long.chain(["--help"]).map(str::to_owned).collect())
    });
    sections.collect()
}
