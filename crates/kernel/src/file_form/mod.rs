//! What a file is that no reader here reads, by its first octets: compressed files, captures of other programs, pages, pictures.
//! Readers ask here when a file is not what they read, so that all of them say the same of it.

mod known;
mod markup;

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::text::{printable, shortened_to};

/// So many octets at the start of a file tell what it is.
const HEAD: u64 = 8192;

/// A form of file that is not read here, and what helps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FileForm {
    /// What the file is: `compressed with gzip`.
    what: &'static str,
    /// What helps, in which `FILE` stands for the file.
    helps: &'static str,
}

impl FileForm {
    /// What a file is that begins with the octets `head`; `None` if it is nothing that is known here.
    #[must_use]
    pub fn of(head: &[u8]) -> Option<Self> {
        known::of(head).or_else(|| markup::of(&text(head)?))
    }

    /// What the file `path` is; `None` if it is nothing that is known here, or cannot be read.
    #[must_use]
    pub fn of_file(path: &Path) -> Option<Self> {
        Self::of(&head(path)?)
    }

    /// What the file `path` of this form is, and what helps: ``compressed with gzip; unpack it: `gunzip -k a.gz` ``.
    #[must_use]
    pub fn told(self, path: &Path) -> String {
        format!("{}; {}", self.what, self.helps.replace("FILE", &path.display().to_string()))
    }
}

/// What is seen of the file `path`, for an error that it is not what was asked for: its form and what helps, or how it begins.
#[must_use]
pub fn seen(path: &Path) -> String {
    let Some(head) = head(path) else { return "a file that cannot be read".to_owned() };
    match FileForm::of(&head) {
        Some(form) => form.told(path),
        None => beginning(&head),
    }
}

/// The name of the first tag of an XML document without its prefix, after declarations and comments; `None` if the text
/// begins with no tag. Of a page this is `html`, also where it begins with its document type.
#[must_use]
pub fn root_of_xml(text: &str) -> Option<String> {
    markup::root(text)
}

/// How a file begins: ``a text that begins with `hello` ``, or `binary data that begin with the octets 1f 8b`.
fn beginning(head: &[u8]) -> String {
    /// So much of the first line is shown (characters), or of the first octets.
    const SHOWN: usize = 60;
    const OCTETS: usize = 8;
    match text(head) {
        Some(text) => {
            let line = text.lines().map(str::trim).find(|line| !line.is_empty()).unwrap_or_default();
            format!("a text that begins with `{}`", printable(&shortened_to(SHOWN, line)))
        }
        None => {
            let octets: Vec<String> = head.iter().take(OCTETS).map(|octet| format!("{octet:02x}")).collect();
            format!("binary data that begin with the octets {}", octets.join(" "))
        }
    }
}

/// The first octets of the file `path`; `None` if it cannot be read.
fn head(path: &Path) -> Option<Vec<u8>> {
    let mut head = Vec::new();
    File::open(path).and_then(|file| file.take(HEAD).read_to_end(&mut head)).ok()?;
    Some(head)
}

/// The octets as text, without a byte order mark; `None` if they are none: a text has no control characters, and may be in
/// another encoding than UTF-8. A character that the end cuts is no harm.
fn text(head: &[u8]) -> Option<String> {
    let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
    let is_control = |octet: &u8| *octet < 0x20 && !matches!(octet, b'\t' | b'\n' | b'\r' | 0x0C) || *octet == 0x7F;
    (!head.iter().any(is_control)).then(|| String::from_utf8_lossy(head).into_owned())
}

#[cfg(test)]
mod tests;
