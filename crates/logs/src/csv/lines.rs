//! A text file with lines of a plausible length.

use std::io::{self, Read};

/// The longest line of a text (octets): a table with a column a node has the longest ones.
const LONGEST: usize = 1 << 26;

/// Reads a text, and fails in a line that is too long to be one: in `/dev/zero`, or in a file of another format.
pub(crate) struct LinesOf<R> {
    input: R,
    /// Octets since the last line began.
    length: usize,
}

impl<R> LinesOf<R> {
    pub(crate) fn new(input: R) -> Self {
        Self { input, length: 0 }
    }
}

impl<R: Read> Read for LinesOf<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.input.read(buffer)?;
        self.length = match buffer[..read].iter().rposition(|octet| *octet == b'\n') {
            Some(end) => read - end - 1,
            None => self.length + read,
        };
        if self.length > LONGEST {
            let why = format!("a line is longer than {} MB, so it is no table", LONGEST >> 20);
            return Err(io::Error::new(io::ErrorKind::FileTooLarge, why));
        }
        Ok(read)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_without_lines_ends_with_an_error() {
        let error = io::copy(&mut LinesOf::new(io::repeat(0)), &mut io::sink()).unwrap_err();
        assert!(error.to_string().contains("longer than 64 MB"), "{error}");
        let lines = io::repeat(b'\n').take(1 << 27);
        assert_eq!(io::copy(&mut LinesOf::new(lines), &mut io::sink()).unwrap(), 1 << 27);
    }
}
