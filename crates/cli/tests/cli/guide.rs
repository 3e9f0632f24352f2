//! The guide: every command in it is run, what it shows is what the program prints, and its reference is complete.
//!
//! `SEXTANT_GUIDE=all` runs also what takes long; `SEXTANT_GUIDE=update` rewrites shown output and the pages of reference.

#[cfg(unix)]
mod machine;
mod page;
mod reference;
mod used_keys;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use super::architecture::{guides, root};

/// What the environment asks for: nothing, `all` or `update`.
fn wish() -> String {
    std::env::var("SEXTANT_GUIDE").unwrap_or_default()
}

/// The pages whose commands are run: the README and `docs/`.
fn pages() -> Vec<PathBuf> {
    let docs = root().join("docs");
    guides().into_iter().filter(|page| page.starts_with(&docs) || *page == root().join("README.md")).collect()
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Holds a generated page to `text`, or rewrites it.
fn hold(path: &str, text: &str) {
    let path = root().join(path);
    if wish() == "update" {
        fs::write(&path, text).expect("a page is written");
    }
    let first = read(&path).lines().zip(text.lines()).position(|(page, program)| page != program);
    assert!(
        read(&path) == text,
        "{} is old, from line {}: run the tests `guide` with SEXTANT_GUIDE=update",
        path.display(),
        first.map_or_else(|| "of its end".to_owned(), |line| (line + 1).to_string())
    );
}

#[cfg(unix)]
#[test]
fn every_command_of_the_guide_runs_and_prints_what_is_shown() {
    use machine::{Extent, Machine};

    let extent = if wish() == "all" { Extent::All } else { Extent::Light };
    let mut wrong = Vec::new();
    for path in pages() {
        let text = read(&path);
        let steps = page::steps(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let mistakes = Machine::new(root(), extent).run(steps);
        let right: Vec<_> = mistakes.iter().filter_map(|mistake| mistake.right.clone()).collect();
        if wish() == "update" && !right.is_empty() {
            let mut lines: Vec<&str> = text.lines().collect();
            for (place, printed) in right.iter().rev() {
                lines.splice(place.clone(), printed.trim_matches('\n').lines().map(str::trim_end));
            }
            fs::write(&path, lines.join("\n") + "\n").expect("a page is written");
        }
        wrong.extend(
            mistakes.into_iter().map(|mistake| format!("{}:{}: {}", path.display(), mistake.line, mistake.message)),
        );
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn the_reference_of_commands_is_that_of_the_program() {
    hold("docs/reference/commands.md", &reference::commands());
}

#[test]
fn the_reference_of_keys_is_that_of_the_program() {
    hold("docs/reference/keys.md", &reference::keys());
}

#[test]
fn the_reference_of_columns_is_that_of_the_program() {
    hold("docs/reference/columns.md", &reference::columns());
}

#[test]
fn commands_and_options_in_sentences_exist() {
    let known = reference::options_by_command();
    let mut wrong = Vec::new();
    for path in pages() {
        let text = read(&path);
        let sentences: String = text.split("```").step_by(2).collect();
        for code in sentences.split('`').skip(1).step_by(2).filter(|code| code.starts_with("sextant ")) {
            let mut words = code.split_whitespace().skip(1);
            let command = words.next().unwrap_or_default();
            let is_name = command.starts_with(|c: char| c.is_ascii_lowercase());
            let options = known.get(command);
            let unknown = words.filter(|word| word.starts_with("--")).find(|word| {
                let name = word.trim_end_matches([',', ']', '.']).split('=').next().unwrap_or_default();
                options.is_some_and(|options| !options.contains(name))
            });
            if (is_name && options.is_none()) || unknown.is_some() {
                wrong.push(format!("{}: `{code}`", path.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "the program has no such command or option: {wrong:#?}");
}

#[test]
fn every_page_is_in_the_contents_of_the_guide() {
    let docs = root().join("docs");
    let contents = read(&docs.join("SUMMARY.md"));
    let listed: BTreeSet<PathBuf> =
        contents.split("](").skip(1).filter_map(|rest| rest.split(')').next()).map(|link| docs.join(link)).collect();
    let pages: BTreeSet<PathBuf> =
        guides().into_iter().filter(|page| page.starts_with(&docs) && !page.ends_with("SUMMARY.md")).collect();
    let (absent, unlisted): (Vec<_>, Vec<_>) =
        (listed.difference(&pages).collect(), pages.difference(&listed).collect());
    assert!(absent.is_empty() && unlisted.is_empty(), "no page: {absent:#?}; not in SUMMARY.md: {unlisted:#?}");
}
