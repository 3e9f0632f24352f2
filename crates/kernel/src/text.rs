//! Words of messages: counts with nouns, lists of names, and texts of others: short, printable, harmless in spreadsheets.

use std::borrow::Cow;
use std::fmt::Write as _;

/// `1 node`, `2 nodes`.
pub fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// "is" of one, "are" of several.
#[must_use]
pub const fn are(count: usize) -> &'static str {
    if count == 1 { "is" } else { "are" }
}

/// "counts" of one, "count" of several.
#[must_use]
pub const fn counts(count: usize) -> &'static str {
    if count == 1 { "counts" } else { "count" }
}

/// Of a list of names, at most this many are printed.
const MOST_NAMES: usize = 10;

/// `a, b, c`, or the first of many names and the number of the others: `a, b, .. and 3 more`.
pub fn listed<T: AsRef<str>>(names: &[T]) -> String {
    listed_to(MOST_NAMES, names)
}

/// Of a list that a user chooses from, at most this many are printed.
const MOST_CHOICES: usize = 100;

/// The names that a user chooses from: `a, b, c`, the first of very many, or `none`.
pub fn choices<T: AsRef<str>>(names: &[T]) -> String {
    if names.is_empty() { "none".to_owned() } else { listed_to(MOST_CHOICES, names) }
}

/// The first names of a list, and the number of the others.
fn listed_to<T: AsRef<str>>(most: usize, names: &[T]) -> String {
    let shown: Vec<&str> = names.iter().take(most).map(AsRef::as_ref).collect();
    let more = names.len() - shown.len();
    shown.join(", ") + &if more > 0 { format!(" and {more} more") } else { String::new() }
}

/// Of a text that others wrote, a message shows at most so many characters.
const MOST_SHOWN: usize = 200;

/// A text that others wrote, for a message: of a long one, its start and its length.
#[must_use]
pub fn shortened(text: &str) -> Cow<'_, str> {
    shortened_to(MOST_SHOWN, text)
}

/// The same with at most so many characters.
pub(crate) fn shortened_to(most: usize, text: &str) -> Cow<'_, str> {
    match text.char_indices().nth(most) {
        None => Cow::Borrowed(text),
        Some((end, _)) => Cow::Owned(format!("{}.. ({} octets)", &text[..end], text.len())),
    }
}

/// Whether a character changes how the text around it is shown: control characters except line feeds and tabs, which could
/// move a cursor or change colours; characters that reverse the order of letters (Unicode Standard Annex 9), so that a
/// name reads as another one; and those that end a line or a paragraph.
#[must_use]
pub fn is_harmful(c: char) -> bool {
    let is_directing =
        matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    let is_ending = matches!(c, '\u{2028}' | '\u{2029}');
    is_directing || is_ending || c.is_control() && !matches!(c, '\n' | '\t')
}

/// The longest text of a message (characters).
const LONGEST_MESSAGE: usize = 8000;

/// The text of a message as it is shown: [`printable`], and not too long. It may have names from files of others.
#[must_use]
pub fn message(text: &str) -> String {
    printable(&shortened_to(LONGEST_MESSAGE, text)).into_owned()
}

/// A text for people, on a terminal or in a picture: characters that are [harmful](is_harmful) are written as `\u{1b}`.
#[must_use]
pub fn printable(text: &str) -> Cow<'_, str> {
    if !text.contains(is_harmful) {
        return Cow::Borrowed(text);
    }
    let mut plain = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        if is_harmful(c) { plain.extend(c.escape_unicode()) } else { plain.push(c) }
    }
    Cow::Owned(plain)
}

/// What marks a text in a table that a spreadsheet would take for a formula.
const MARK: char = '\'';

/// Whether a spreadsheet would compute the text, or a text after marks, instead of showing it. Numbers are numbers.
fn is_formula(text: &str) -> bool {
    let text = text.trim_start_matches(MARK);
    text.len() > 1 && text.starts_with(['=', '+', '-', '@', '\t', '\r']) && text.parse::<f64>().is_err()
}

/// A text as a cell of a CSV file: one that a spreadsheet would take for a formula gets an apostrophe in front, also if it
/// has apostrophes already. [`of_cell`] takes it off.
#[must_use]
pub fn cell(text: &str) -> Cow<'_, str> {
    if is_formula(text) { Cow::Owned(format!("{MARK}{text}")) } else { Cow::Borrowed(text) }
}

/// The text of a [`cell`].
#[must_use]
pub fn of_cell(cell: &str) -> &str {
    cell.strip_prefix(MARK).filter(|text| is_formula(text)).unwrap_or(cell)
}

/// Octets as hexadecimal digits.
#[must_use]
pub fn hexadecimal(octets: &[u8]) -> String {
    octets.iter().fold(String::with_capacity(2 * octets.len()), |mut text, octet| {
        // Writing to a text cannot fail.
        let _ = write!(text, "{octet:02x}");
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_texts_of_others_are_shortened() {
        assert_eq!(shortened("short"), "short");
        assert!(message(&"\u{1b}".repeat(9000)).ends_with("\\u{1b}.. (9000 octets)"));
        assert_eq!(message("a\nb"), "a\nb");
        let long = "ä".repeat(500_000);
        assert_eq!(shortened(&long), format!("{}.. (1000000 octets)", "ä".repeat(200)));
    }

    #[test]
    fn control_characters_do_not_reach_a_terminal() {
        assert_eq!(printable("a\tb\n"), "a\tb\n");
        assert_eq!(printable("\u{1b}[2Jname\r\u{7f}\u{9b}"), r"\u{1b}[2Jname\u{d}\u{7f}\u{9b}");
    }

    #[test]
    fn a_name_does_not_read_as_another_one() {
        assert_eq!(printable("\u{202e}edon\u{202c}"), r"\u{202e}edon\u{202c}");
        assert_eq!(printable("a\u{2067}b\u{2028}c"), r"a\u{2067}b\u{2028}c");
        assert_eq!(printable("nœud עברית 節点"), "nœud עברית 節点");
    }

    #[test]
    fn formulas_are_marked_and_read_back_equal() {
        for (text, written) in [
            ("=1+1", "'=1+1"),
            ("+door", "'+door"),
            ("-x", "'-x"),
            ("@a", "'@a"),
            ("'=1+1", "''=1+1"),
            ("-60", "-60"),
            ("+1e3", "+1e3"),
            ("-inf", "-inf"),
            ("-", "-"),
            ("'quoted'", "'quoted'"),
            ("'-60", "'-60"),
            ("", ""),
        ] {
            assert_eq!((&*cell(text), of_cell(written)), (written, text));
        }
    }

    #[test]
    fn of_many_names_the_first_are_listed() {
        let names: Vec<String> = (0..13).map(|i| format!("n{i}")).collect();
        assert_eq!(listed(&names), "n0, n1, n2, n3, n4, n5, n6, n7, n8, n9 and 3 more");
        assert!(choices(&vec!["a"; 103]).ends_with("a, a and 3 more"));
        assert_eq!((choices(&names[..2]), choices(&names[..0])), ("n0, n1".to_owned(), "none".to_owned()));
        assert_eq!((listed(&names[..2]), listed(&names[..0])), ("n0, n1".to_owned(), String::new()));
    }

    #[test]
    fn a_count_of_one_is_singular() {
        assert_eq!([counted(0, "node"), counted(1, "node"), counted(2, "node")], ["0 nodes", "1 node", "2 nodes"]);
    }
}
