//! A page of the guide as a script: files that it shows, commands that it gives, and what they print.
//!
//! Comments before a block, which readers do not see, say what the block is:
//!
//! | comment | means |
//! | --- | --- |
//! | `<!-- file: NAME -->` | the block is the file NAME of the working folder |
//! | `<!-- append: NAME -->` | the block is added to the end of this file |
//! | `<!-- prints -->` | the block is what the last command prints; a line `...` stands for any lines |
//! | `<!-- fails -->` | the last command of the block ends with exit code 1 or 2, and prints its message |
//! | `<!-- heavy -->` | the block runs only if all blocks are asked for |
//! | `<!-- feature: NAME -->` | the block runs only if the program was built with this feature |
//! | `<!-- python: MODULE -->` | the block runs only if Python has this module; otherwise the test says that it is left out |
//! | `<!-- not run: REASON -->` | the block is only shown |
//! | `<!-- run: COMMAND -->` | a command that readers do not see |
//! | `<!-- copy: FROM TO -->` | a file or folder of the tree, copied to the working folder |

use std::io::Write;
use std::ops::Range;
use std::process::Command;

/// What a page does, in order.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Step {
    /// Writes a file.
    File { name: String, text: String, append: bool },
    /// Copies a file or folder of the tree.
    Copy { from: String, to: String },
    /// Runs commands, one after the other.
    Commands { commands: Vec<String>, fails: bool, heavy: bool },
    /// Compares what the last command printed with the lines of the page at `place`.
    Prints { expected: String, place: Range<usize> },
}

/// A step, and the number of its line.
pub(crate) type Numbered = (usize, Step);

/// The beginnings of commands that are run.
const PROGRAMS: [&str; 2] = ["sextant ", "cargo "];

/// The languages of blocks that may hide commands.
const PLAIN: [&str; 4] = ["", "bash", "console", "text"];

/// Reads a page.
///
/// # Errors
/// A block that gives commands and is neither run nor said to be only shown, or a comment that is not known.
pub(crate) fn steps(text: &str) -> Result<Vec<Numbered>, String> {
    let mut steps = Vec::new();
    let mut marks: Vec<&str> = Vec::new();
    let mut lines = text.lines().enumerate();
    while let Some((number, line)) = lines.next() {
        let trimmed = line.trim();
        let at = |message: &str| format!("line {}: {message}", number + 1);
        if let Some(comment) = trimmed.strip_prefix("<!--") {
            let comment = comment.strip_suffix("-->").ok_or_else(|| at("a comment of one line"))?.trim();
            match comment.split_once(": ") {
                Some(("run", command)) => steps.push((number + 1, commands(vec![command.to_owned()], &[]))),
                Some(("copy", names)) => {
                    let (from, to) = names.split_once(' ').ok_or_else(|| at("copy: FROM TO"))?;
                    steps.push((number + 1, Step::Copy { from: from.to_owned(), to: to.to_owned() }));
                }
                _ => marks.push(comment),
            }
        } else if let Some(language) = trimmed.strip_prefix("```") {
            let indent = line.len() - line.trim_start().len();
            let block: Vec<(usize, &str)> =
                lines.by_ref().take_while(|(_, line)| !line.trim_start().starts_with("```")).collect();
            let place = number + 1..number + 1 + block.len();
            let block: Vec<&str> = block.iter().map(|(_, line)| line.get(indent..).unwrap_or("")).collect();
            if let Some(step) = step(language, &block, &marks, place).map_err(|message| at(&message))? {
                steps.push((number + 1, step));
            }
            marks.clear();
        } else if let Some(mark) = marks.first().filter(|_| !trimmed.is_empty()) {
            return Err(at(&format!("the comment `{mark}` is not followed by a block")));
        }
    }
    Ok(steps)
}

/// What a block does; nothing if it is only shown.
fn step(language: &str, block: &[&str], marks: &[&str], place: Range<usize>) -> Result<Option<Step>, String> {
    let gives_commands = block.iter().any(|line| PROGRAMS.iter().any(|program| line.starts_with(program)));
    let text = || block.iter().map(|line| format!("{line}\n")).collect::<String>();
    for mark in marks {
        match mark.split_once(": ").unwrap_or((mark, "")) {
            ("file", name) => return Ok(Some(Step::File { name: name.to_owned(), text: text(), append: false })),
            ("append", name) => return Ok(Some(Step::File { name: name.to_owned(), text: text(), append: true })),
            ("prints", _) => return Ok(Some(Step::Prints { expected: text(), place })),
            ("not run", reason) if !reason.is_empty() => return Ok(None),
            ("feature", name) if !has_feature(name)? => return Ok(None),
            ("python", module) if !has_module(module) => {
                std::io::stderr().write_all(format!("left out: Python has no module {module}\n").as_bytes()).ok();
                return Ok(None);
            }
            ("feature" | "python", _) => {}
            ("fails" | "heavy", "") => {}
            _ => return Err(format!("the comment `{mark}` is not known")),
        }
    }
    if language == "sh" {
        return Ok(Some(commands(joined(block), marks)));
    }
    if gives_commands && PLAIN.contains(&language) {
        return Err("a block with commands is marked ```sh, or `<!-- not run: REASON -->` is before it".to_owned());
    }
    Ok(None)
}

/// Whether the program was built with a feature.
fn has_feature(name: &str) -> Result<bool, String> {
    match name {
        "foxglove" => Ok(cfg!(feature = "foxglove")),
        "parquet" => Ok(cfg!(feature = "parquet")),
        "sqlite-bags" => Ok(cfg!(feature = "sqlite-bags")),
        _ => Err(format!("there is no feature `{name}`")),
    }
}

/// Whether the Python of the tests has a module.
fn has_module(module: &str) -> bool {
    let import = Command::new("python3").args(["-c", &format!("import {module}")]).output();
    import.is_ok_and(|output| output.status.success())
}

fn commands(commands: Vec<String>, marks: &[&str]) -> Step {
    Step::Commands { commands, fails: marks.contains(&"fails"), heavy: marks.contains(&"heavy") }
}

/// The commands of a block: a line that ends in a backslash goes on in the next one.
fn joined(block: &[&str]) -> Vec<String> {
    let text = block.join("\n").replace("\\\n", " ");
    text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#')).map(str::to_owned).collect()
}

#[test]
fn a_page_is_read_as_a_script() {
    let page = "Save as `a.toml`:\n<!-- file: a.toml -->\n```toml\nname = \"a\"\n```\n<!-- run: sextant schema -->\n\
                ```sh\nsextant check \\\n    a.toml  # it is valid\n```\n\n<!-- prints -->\n```text\nok\n```\n\
                <!-- not run: it needs a robot -->\n```sh\nsextant map walk\n```\n";
    let steps = steps(page).expect("a page");
    let file = Step::File { name: "a.toml".into(), text: "name = \"a\"\n".into(), append: false };
    let run = |command: &str| Step::Commands { commands: vec![command.into()], fails: false, heavy: false };
    let check = run("sextant check      a.toml  # it is valid");
    let prints = Step::Prints { expected: "ok\n".into(), place: 13..14 };
    assert_eq!(steps, [(3, file), (6, run("sextant schema")), (7, check), (13, prints)]);
}

#[test]
fn commands_that_are_not_run_need_a_reason() {
    for page in [
        "```\nsextant run a.toml\n```",
        "<!-- not run: -->\n```sh\nsextant run a.toml\n```",
        "<!-- prinst -->\n```text\nok\n```",
        "<!-- prints -->\nNo block.",
    ] {
        assert!(steps(page).is_err(), "{page}");
    }
}
