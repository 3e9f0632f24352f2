//! Words of a shell: command lines that a script has, or that are printed to be copied.

use std::borrow::Cow;
use std::path::Path;

use sextant_kernel::text::is_harmful;

/// Whether a character means itself in each shell, wherever it stands in a word.
fn is_plain(c: char) -> bool {
    c.is_ascii_alphanumeric() || "/._-+:,@%".contains(c)
}

/// Whether a text has characters that end a line, or that a terminal does not show as they are.
#[must_use]
pub fn has_controls(text: &str) -> bool {
    text.contains(|c: char| is_harmful(c) || c.is_control())
}

/// A text as one word of a shell, with quotes only where it needs them: `it's` becomes `'it'\''s'`. Characters that end a
/// line or are not shown are written as `$'\n'`, which bash, ksh and zsh read.
#[must_use]
pub fn word(text: &str) -> Cow<'_, str> {
    if has_controls(text) {
        return Cow::Owned(escaped(text));
    }
    // `a=b` alone is a command of some shells.
    let is_plain = |c: char| is_plain(c) || c == '=';
    if !text.is_empty() && !text.starts_with('=') && text.chars().all(is_plain) {
        Cow::Borrowed(text)
    } else {
        Cow::Owned(format!("'{}'", text.replace('\'', "'\\''")))
    }
}

/// The path of a file as one word of a command line, which is no flag: `./-x` for `-x`.
#[must_use]
pub fn path(path: &Path) -> String {
    let shown = path.to_string_lossy();
    if shown.starts_with('-') { word(&format!("./{shown}")).into_owned() } else { word(&shown).into_owned() }
}

/// A text within `$'..'`.
fn escaped(text: &str) -> String {
    let mut escaped = String::from("$'");
    for c in text.chars() {
        match c {
            '\'' | '\\' => escaped.extend(['\\', c]),
            c if is_harmful(c) || c.is_control() => {
                let mut octets = [0; 4];
                c.encode_utf8(&mut octets).bytes().for_each(|octet| escaped += &format!("\\x{octet:02x}"));
            }
            c => escaped.push(c),
        }
    }
    escaped + "'"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_where_a_shell_would_read_more_than_a_word() {
        for (text, written) in [
            ("/a/b-1.sh", "/a/b-1.sh"),
            ("a.b=0.5", "a.b=0.5"),
            ("=ls", "'=ls'"),
            ("it's $HOME", "'it'\\''s $HOME'"),
            ("`id`", "'`id`'"),
            ("~me", "'~me'"),
            ("", "''"),
            ("a\nb", "$'a\\x0ab'"),
            ("it's\u{2028}\\", "$'it\\'s\\xe2\\x80\\xa8\\\\'"),
        ] {
            assert_eq!(word(text), written);
        }
        assert_eq!(path(Path::new("-x.toml")), "./-x.toml");
        assert_eq!(path(Path::new("--out=a b")), "'./--out=a b'");
    }

    #[cfg(unix)]
    #[test]
    fn a_shell_reads_each_word_as_it_was() {
        use std::process::Command;

        for shell in ["sh", "bash"] {
            for text in [
                "plain",
                "a b",
                "$(id)",
                "`id`; id",
                "it's",
                "\"x\"",
                "a\\b",
                "*",
                "!x",
                "#x",
                "~",
                "-n",
                "ä",
                "a\nb\u{85}",
            ] {
                // The `sh` of some systems does not know `$'..'`.
                if shell == "sh" && has_controls(text) {
                    continue;
                }
                let line = format!("printf '%s' {}", word(text));
                match Command::new(shell).args(["-c", &line]).output() {
                    Ok(output) => assert_eq!(String::from_utf8_lossy(&output.stdout), text, "{line}"),
                    Err(error) => assert_eq!((shell, error.kind()), ("bash", std::io::ErrorKind::NotFound)),
                }
            }
        }
    }
}
