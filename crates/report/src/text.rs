//! Texts of others in the frame of the page: no code, and no letter that reverses those around it.

use sextant_kernel::text::{is_harmful, shortened};

/// Whether a letter is seen as an escape. Marks of direction stay, because honest names in Arabic and Hebrew have them and
/// the element around a name keeps their effect inside ([`bdi`]).
fn is_escaped(letter: char) -> bool {
    is_harmful(letter) && !matches!(letter, '\u{61c}' | '\u{200e}' | '\u{200f}')
}

/// Whether a letter is read from right to left, or is a mark of direction (Unicode Standard Annex 9).
fn has_direction(letter: char) -> bool {
    matches!(letter,
        '\u{590}'..='\u{8ff}' | '\u{200e}' | '\u{200f}' | '\u{fb1d}'..='\u{fdff}' | '\u{fe70}'..='\u{fefe}'
        | '\u{10800}'..='\u{10fff}' | '\u{1e800}'..='\u{1efff}')
}

/// A name as text of an element: not too long, and what HTML does not allow or what would change how the text around it is
/// shown is written as `\u{202e}`.
pub(super) fn escaped(name: &str) -> String {
    let name = shortened(name);
    let mut safe = String::with_capacity(name.len());
    for letter in name.chars() {
        match letter {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            letter if is_escaped(letter) => safe.extend(letter.escape_unicode()),
            letter => safe.push(letter),
        }
    }
    safe
}

/// A name in an element of its own direction, which the text around it does not get.
pub(super) fn bdi(name: &str) -> String {
    format!("<bdi>{}</bdi>", escaped(name))
}

/// The same where no element may be, as in the title of the page: isolated by characters, if it has a direction.
pub(super) fn isolated(name: &str) -> String {
    let safe = escaped(name);
    if name.contains(has_direction) { format!("\u{2068}{safe}\u{2069}") } else { safe }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_reverses_or_moves_other_text_is_seen() {
        // Control characters, and the characters that Unicode calls bidirectional controls but for the marks.
        let harmful = ('\0'..='\u{1f}').chain('\u{7f}'..='\u{9f}').chain('\u{202a}'..='\u{202e}');
        let harmful = harmful.chain('\u{2066}'..='\u{2069}').chain(['\u{2028}', '\u{2029}']);
        for letter in harmful.filter(|letter| !matches!(letter, '\n' | '\t')) {
            let written = format!("a\\u{{{:x}}}b", u32::from(letter));
            assert_eq!(escaped(&format!("a{letter}b")), written);
        }
    }

    #[test]
    fn honest_names_are_shown_as_they_are() {
        for name in ["\u{200f}שלום\u{200e}", "\u{61c}مرحبا", "nœud 節点 👩‍🔬", "a\u{301}", "\u{10ffff}\u{e000}\u{d7ff}"]
        {
            assert_eq!(escaped(name), name);
        }
        assert_eq!(isolated("שלום"), "\u{2068}שלום\u{2069}");
        assert_eq!(isolated("node"), "node");
        assert_eq!(bdi("<b>"), "<bdi>&lt;b&gt;</bdi>");
    }

    #[test]
    fn a_very_long_name_is_shortened() {
        assert_eq!(escaped(&"&".repeat(9000)), format!("{}.. (9000 octets)", "&amp;".repeat(200)));
    }
}
