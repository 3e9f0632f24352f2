//! Runs the steps of a page in a folder of their own.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use super::page::{Numbered, Step};

/// What is run.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Extent {
    /// All but heavy blocks.
    Light,
    /// All blocks.
    All,
}

/// A folder in which a page is run. It has the scenarios of the tree.
pub(crate) struct Machine {
    folder: tempfile::TempDir,
    root: PathBuf,
    extent: Extent,
    printed: Option<String>,
}

/// A mistake of a page: its line, what is wrong, and the lines that would be right, if the page shows others.
#[derive(Debug)]
pub(crate) struct Mistake {
    pub(crate) line: usize,
    pub(crate) message: String,
    pub(crate) right: Option<(std::ops::Range<usize>, String)>,
}

impl Machine {
    /// An empty folder beside the scenarios of the tree at `root`.
    pub(crate) fn new(root: PathBuf, extent: Extent) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        std::os::unix::fs::symlink(root.join("scenarios"), folder.path().join("scenarios")).expect("a link");
        Self { folder, root, extent, printed: None }
    }

    /// Runs the steps in order. After a command that did not do what the page says, the others are run all the same.
    pub(crate) fn run(mut self, steps: Vec<Numbered>) -> Vec<Mistake> {
        let mut mistakes = Vec::new();
        for (line, step) in steps {
            let result = match step {
                Step::File { name, text, append } => self.write(&name, &text, append).map_err(|e| (e, None)),
                Step::Copy { from, to } => self.copy(&from, &to).map_err(|e| (e, None)),
                Step::Commands { commands, fails, heavy } => {
                    self.printed = None;
                    if heavy && self.extent == Extent::Light {
                        continue;
                    }
                    self.commands(&commands, fails).map_err(|e| (e, None))
                }
                Step::Prints { expected, place } => match &self.printed {
                    None => continue,
                    Some(printed) if agree(&expected, printed) => Ok(()),
                    Some(printed) => {
                        let right = corrected(&expected, printed).map(|right| (place, right));
                        Err((format!("the page shows\n{expected}but the program prints\n{printed}"), right))
                    }
                },
            };
            if let Err((message, right)) = result {
                mistakes.push(Mistake { line, message, right });
            }
        }
        mistakes
    }

    fn write(&self, name: &str, text: &str, append: bool) -> Result<(), String> {
        let path = self.folder.path().join(name);
        let before =
            if append { fs::read_to_string(&path).map_err(|e| format!("{name}: {e}"))? } else { String::new() };
        let folder = path.parent().ok_or("a file in a folder")?;
        fs::create_dir_all(folder).and_then(|()| fs::write(&path, before + text)).map_err(|e| format!("{name}: {e}"))
    }

    fn copy(&self, from: &str, to: &str) -> Result<(), String> {
        let (from, to) = (self.root.join(from), self.folder.path().join(to));
        let status = Command::new("cp").arg("-r").args([&from, &to]).status().map_err(|e| e.to_string())?;
        if status.success() { Ok(()) } else { Err(format!("{} cannot be copied", from.display())) }
    }

    fn commands(&mut self, commands: &[String], fails: bool) -> Result<(), String> {
        for (i, command) in commands.iter().enumerate() {
            let must_fail = fails && i + 1 == commands.len();
            let output = self.shell(command).map_err(|e| e.to_string())?;
            let (text, errors) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
            let has_failed = matches!(output.status.code(), Some(1 | 2));
            if output.status.success() == must_fail || has_failed != must_fail {
                return Err(format!("`{command}` ended with {}:\n{text}{errors}", output.status));
            }
            self.printed = Some(if must_fail { errors.into_owned() } else { text.into_owned() });
        }
        Ok(())
    }

    /// Runs a command as a shell does. `cargo run --release --` is the program.
    fn shell(&self, command: &str) -> std::io::Result<Output> {
        let command = command.replace("cargo run --release --", "sextant");
        let program = Path::new(env!("CARGO_BIN_EXE_sextant")).parent().expect("a program is in a folder");
        let path = std::env::var("PATH").unwrap_or_default();
        Command::new("sh")
            .args(["-c", &command])
            .current_dir(self.folder.path())
            .env("PATH", format!("{}:{path}", program.display()))
            .env("NO_COLOR", "1")
            .env("COLUMNS", "100")
            .output()
    }
}

/// A line of a page that stands for any lines.
const ANY: &str = "...";

/// Whether the lines of a page are what was printed. Times that the machine took may differ.
fn agree(expected: &str, printed: &str) -> bool {
    let lines = |text: &str| -> Vec<String> { text.lines().map(|line| timeless(line.trim_end())).collect() };
    let (expected, printed) = (lines(expected.trim()), lines(printed.trim()));
    let mut rest = &printed[..];
    for (i, part) in expected.split(|line| line == ANY).enumerate() {
        let at = if part.is_empty() { Some(0) } else { rest.windows(part.len()).position(|lines| lines == part) };
        match at {
            Some(at) if i > 0 || at == 0 => rest = &rest[at + part.len()..],
            _ => return false,
        }
    }
    rest.is_empty() || expected.last().is_some_and(|line| line == ANY)
}

/// The lines that a page should show. Where it leaves out lines, each line that it shows is replaced by the first one with
/// the same first word; nothing if there is none.
fn corrected(expected: &str, printed: &str) -> Option<String> {
    if !expected.lines().any(|line| line == ANY) {
        return Some(printed.to_owned());
    }
    let label = |line: &str| line.split_whitespace().next().map(str::to_owned);
    let correct = |line: &str| {
        let is_shown = line == ANY || printed.lines().any(|other| other.trim_end() == line);
        let found = if is_shown { Some(line) } else { printed.lines().find(|other| label(other) == label(line)) };
        found.map(|line| format!("{line}\n"))
    };
    expected.lines().map(correct).collect()
}

/// A line about the time of a computation, without its numbers.
fn timeless(line: &str) -> String {
    if line.starts_with("time ") {
        line.replace(|c: char| c.is_ascii_digit() || c == '.', "")
    } else {
        line.to_owned()
    }
}

#[test]
fn a_page_that_leaves_out_lines_gets_the_new_ones_with_the_same_words() {
    let printed = "a\nmap 2\nc\n";
    assert_eq!(corrected("...\nmap 1\n...\n", printed), Some("...\nmap 2\n...\n".to_owned()));
    assert_eq!(corrected("...\nname 1\n...\n", printed), None);
    assert_eq!(corrected("b\n", printed), Some(printed.to_owned()));
}

#[test]
fn shown_lines_are_compared_with_what_is_printed() {
    let printed = "a\nb 1\nc\n\ntime 0.12 s\n";
    for (expected, is_right) in [
        ("a\nb 1\nc\n\ntime 3.45 s\n", true),
        ("a\n...\ntime 3.45 s\n", true),
        ("...\nc\n...\n", true),
        ("a\n...\n", true),
        ("a\nb 2\nc\n\ntime 3.45 s\n", false),
        ("b 1\n...\n", false),
        ("a\nb 1\n", false),
        ("...\nd\n...\n", false),
    ] {
        assert_eq!(agree(expected, printed), is_right, "{expected}");
    }
}
