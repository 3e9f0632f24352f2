//! Tables whose cells are separated by blanks, any number of them.

use std::io::{self, BufRead, Read};

/// What separates cells instead: no text has it.
pub(crate) const SEPARATOR: u8 = 0x1F;

/// Reads a text with one [`SEPARATOR`] between two words of a line. Each octet stays where it is, so that places in the file are
/// those of the text: of several blanks, the last one becomes the separator.
pub(crate) struct Blanks<R> {
    input: R,
    line: Vec<u8>,
    /// How much of the line was read.
    at: usize,
}

impl<R> Blanks<R> {
    pub(crate) const fn new(input: R) -> Self {
        Self { input, line: Vec::new(), at: 0 }
    }
}

impl<R: BufRead> Read for Blanks<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.at == self.line.len() {
            self.line.clear();
            self.at = 0;
            self.input.read_until(b'\n', &mut self.line)?;
            separate(&mut self.line);
        }
        let read = (&self.line[self.at..]).read(buffer)?;
        self.at += read;
        Ok(read)
    }
}

const fn is_blank(octet: u8) -> bool {
    matches!(octet, b' ' | b'\t')
}

/// Puts separators between the words of a line. What is in quotes is one word.
fn separate(line: &mut [u8]) {
    let is_word = |octet: &u8| !is_blank(*octet) && !matches!(*octet, b'\r' | b'\n');
    let (Some(first), Some(last)) = (line.iter().position(is_word), line.iter().rposition(is_word)) else { return };
    let mut is_quoted = false;
    for at in first..last {
        is_quoted ^= line[at] == b'"';
        if !is_quoted && is_blank(line[at]) && !is_blank(line[at + 1]) {
            line[at] = SEPARATOR;
        }
    }
}

/// Whether a line has several words.
pub(crate) fn has_words(line: &str) -> bool {
    line.split([' ', '\t']).filter(|word| !word.is_empty()).count() > 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_separated_once_and_stay_where_they_are() {
        let text = "  x_m   y_m \"big lamp\"  \r\n\n1\t 2 -50\n3 4";
        let mut found = String::new();
        Blanks::new(text.as_bytes()).read_to_string(&mut found).unwrap();
        assert_eq!(found, "  x_m  \u{1f}y_m\u{1f}\"big lamp\"  \r\n\n1\t\u{1f}2\u{1f}-50\n3\u{1f}4");
        assert!(has_words(" a  b ") && !has_words(" a ") && !has_words(""));
    }
}
