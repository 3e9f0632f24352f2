//! The guides: every file and every heading that they name exists, and their sentences are short.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Maximum number of words in a sentence.
const WORDS: usize = 30;

/// Folders at the top of the tree: a text in code marks that begins with one is a path.
const FOLDERS: [&str; 9] =
    [".ci/", "benches/", "crates/", "docs/", "examples/", "fuzz/", "release/", "scenarios/", "tests/"];

/// The guides: `*.md` at the top of the tree, of each crate, and in `docs/` and its folders.
pub(in super::super) fn guides() -> Vec<PathBuf> {
    let root = super::root();
    let mut files: Vec<PathBuf> = entries(&root);
    files.extend(entries(&root.join("crates")).iter().flat_map(|folder| entries(folder)));
    let mut folders = vec![root.join("docs")];
    while let Some(folder) = folders.pop() {
        let (inner, pages): (Vec<PathBuf>, Vec<PathBuf>) =
            entries(&folder).into_iter().partition(|path| path.is_dir());
        folders.extend(inner);
        files.extend(pages);
    }
    files.retain(|path| path.extension().is_some_and(|extension| extension == "md"));
    files.sort();
    files
}

fn entries(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    entries.map(|entry| entry.expect("an entry of a folder").path()).collect()
}

/// The text without blocks of code.
fn without_blocks(text: &str) -> String {
    text.split("```").step_by(2).collect()
}

/// The paths that a guide names: targets of links, and paths in code marks from the top of the tree.
fn paths(guide: &Path, text: &str) -> Vec<PathBuf> {
    let text = without_blocks(text);
    let folder = guide.parent().expect("a guide is in a folder");
    let links = text.split("](").skip(1).filter_map(|rest| rest.split([')', '#']).next());
    let links = links.filter(|link| !link.is_empty() && !link.contains("://")).map(|link| folder.join(link));
    let named =
        text.split('`').skip(1).step_by(2).filter(|code| FOLDERS.iter().any(|folder| code.starts_with(folder)));
    let is_one = |code: &&str| !code.contains([' ', '*', '<', '{']) && !code.contains("NAME");
    links.chain(named.filter(is_one).map(|code| super::root().join(code))).collect()
}

/// What a link to a part of a page may name: its headings, as web sites and books write them, and its own marks.
fn anchors(text: &str) -> BTreeSet<String> {
    let text = without_blocks(text);
    let mut anchors = BTreeSet::new();
    for title in text.lines().filter(|line| line.starts_with('#')) {
        let title = title.trim_start_matches('#').trim().to_lowercase().replace(' ', "-");
        let anchor: String = title.chars().filter(|c| c.is_alphanumeric() || matches!(c, '-' | '_')).collect();
        let again = (1..).map(|n| format!("{anchor}-{n}")).find(|name| !anchors.contains(name));
        let name = if anchors.contains(&anchor) { again } else { Some(anchor) };
        anchors.extend(name);
    }
    anchors.extend(text.split("<a id=\"").skip(1).filter_map(|rest| rest.split('"').next()).map(str::to_owned));
    anchors
}

/// The links to parts of pages: the page and the part.
fn parts(guide: &Path, text: &str) -> Vec<(PathBuf, String)> {
    let text = without_blocks(text);
    let links = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    let links = links.filter(|link| !link.contains("://")).filter_map(|link| link.split_once('#'));
    let page = |file: &str| if file.is_empty() { guide.to_owned() } else { guide.with_file_name(file) };
    links.map(|(file, part)| (page(file), part.to_owned())).collect()
}

/// The sentences of more words than allowed.
fn long_sentences(text: &str) -> Vec<String> {
    let mut paragraphs = vec![String::new()];
    for line in without_blocks(text).lines().map(str::trim) {
        let is_item =
            line.starts_with("- ") || line.split_once(". ").is_some_and(|(number, _)| number.parse::<u32>().is_ok());
        if line.is_empty() || line.starts_with(['#', '|']) || is_item {
            paragraphs.push(String::new());
        }
        if line.starts_with('|') {
            paragraphs.extend(line.split('|').map(str::to_owned));
            paragraphs.push(String::new());
        } else if !line.starts_with('#') {
            let last = paragraphs.last_mut().expect("a paragraph");
            *last = format!("{last} {line}");
        }
    }
    let mut long = Vec::new();
    for paragraph in &paragraphs {
        // A text in code marks is one word, and the target of a link none.
        let parts: String =
            paragraph.split('`').enumerate().map(|(i, part)| if i % 2 == 0 { part } else { "code" }).collect();
        let links: String = (parts.split("](").enumerate())
            .map(|(i, part)| if i == 0 { part } else { part.split_once(')').map_or(part, |(_, rest)| rest) })
            .collect();
        for sentence in links.split_inclusive(". ").flat_map(|part| part.split_inclusive("? ")) {
            let words = sentence.split_whitespace().filter(|word| word.contains(char::is_alphanumeric)).count();
            if words > WORDS {
                long.push(format!("{words} words: {}", sentence.trim()));
            }
        }
    }
    long
}

#[test]
fn every_path_in_a_guide_exists() {
    for guide in guides() {
        let text = std::fs::read_to_string(&guide).expect("a guide");
        let missing: Vec<_> = paths(&guide, &text).into_iter().filter(|path| !path.exists()).collect();
        assert!(missing.is_empty(), "{} names what does not exist: {missing:#?}", guide.display());
    }
}

#[test]
fn every_part_of_a_page_in_a_link_exists() {
    for guide in guides() {
        let parts = parts(&guide, &std::fs::read_to_string(&guide).expect("a guide"));
        let is_missing = |(page, part): &(PathBuf, String)| {
            !anchors(&std::fs::read_to_string(page).unwrap_or_default()).contains(part)
        };
        let missing: Vec<_> = parts.into_iter().filter(is_missing).collect();
        assert!(missing.is_empty(), "{} names parts that do not exist: {missing:#?}", guide.display());
    }
}

#[test]
fn sentences_of_guides_are_short() {
    let is_written = |guide: &&PathBuf| {
        !guide.ends_with("CHANGELOG.md") && !guide.parent().is_some_and(|f| f.ends_with("docs/reference"))
    };
    for guide in guides().iter().filter(is_written) {
        let long = long_sentences(&std::fs::read_to_string(guide).expect("a guide"));
        assert!(long.is_empty(), "{}: {long:#?}", guide.display());
    }
}

#[test]
fn a_missing_path_and_a_long_sentence_are_found() {
    let guide = super::root().join("docs/guide.md");
    let text =
        "See [one](one.md#part), [two](https://example.org) and `crates/none/src/lib.rs`.\n```\n[no](code.md)\n```\n";
    let missing = [super::root().join("docs").join("one.md"), super::root().join("crates/none/src/lib.rs")];
    assert_eq!(paths(&guide, text), missing);
    assert_eq!(parts(&guide, text), [(guide.with_file_name("one.md"), "part".to_owned())]);
    let page = "# The `a.b_c` of it\n## Two\n## Two\n<a id=\"x.y\"></a>\n```\n# Code\n```\n";
    assert_eq!(anchors(page), ["the-ab_c-of-it", "two", "two-1", "x.y"].map(str::to_owned).into());
    let words = "word ".repeat(WORDS);
    assert_eq!(long_sentences(&format!("{words}. Then {words}\nand more.")).len(), 1);
    assert_eq!(long_sentences(&format!("- {words}\n- {words}\n\n| {words}|{words}|\n")), Vec::<String>::new());
}
