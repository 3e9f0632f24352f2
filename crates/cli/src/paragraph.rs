//! Text in lines of a width that fits a terminal.

use std::io::{self, Write};

/// Width of a line.
const WIDTH: usize = 100;
/// Width of the names of a list.
const NAMES: usize = 24;

/// A paragraph: what its first line and its other lines begin with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Paragraph<'a> {
    pub(crate) indent: &'a str,
    pub(crate) next: &'a str,
}

impl Paragraph<'_> {
    /// Writes `text`, broken between words. A word that is longer than a line stands alone.
    pub(crate) fn write(self, out: &mut impl Write, text: &str) -> io::Result<()> {
        let Self { indent, next } = self;
        let options = textwrap::Options::new(WIDTH).initial_indent(indent).subsequent_indent(next).break_words(false);
        textwrap::wrap(text, options).iter().try_for_each(|line| writeln!(out, "{}", line.trim_end()))
    }
}

/// Writes an entry of a list: its name, and a text beside it, or below if the name is long.
pub(crate) fn item(out: &mut impl Write, name: &str, text: &str) -> io::Result<()> {
    let next = " ".repeat(NAMES + 3);
    if text.is_empty() {
        return writeln!(out, "  {name}");
    }
    if name.chars().count() > NAMES {
        writeln!(out, "  {name}")?;
        return Paragraph { indent: &next, next: &next }.write(out, text);
    }
    Paragraph { indent: &format!("  {name:<NAMES$} "), next: &next }.write(out, text)
}
