//! The group codes of a DXF file: pairs of lines, a number that says what follows, and a value.

/// How a binary DXF begins.
const BINARY: &[u8] = b"AutoCAD Binary DXF";

/// A group: what it is, its value, and the line of the value, from 1.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Pair<'a> {
    pub(super) code: i32,
    pub(super) value: &'a str,
    pub(super) line: usize,
}

impl Pair<'_> {
    /// The value as a finite number.
    pub(super) fn number(&self) -> Result<f64, String> {
        let number = self.value.parse().ok().filter(|number: &f64| number.is_finite());
        number.ok_or_else(|| format!("line {}: found `{}`, allowed: a finite number", self.line, self.value))
    }

    /// The value as a whole number.
    pub(super) fn whole(&self) -> Result<i64, String> {
        let whole = self.value.parse().ok();
        whole.ok_or_else(|| format!("line {}: found `{}`, allowed: a whole number", self.line, self.value))
    }
}

/// The groups of the text of a drawing.
pub(super) fn pairs(text: &str) -> Result<Vec<Pair<'_>>, String> {
    let mut lines = (1..).zip(text.lines());
    let mut pairs = Vec::new();
    while let Some((number, code)) = lines.next() {
        // Some programs end with an empty line.
        if code.trim().is_empty() && lines.clone().all(|(_, rest)| rest.trim().is_empty()) {
            break;
        }
        let code = code.trim().parse();
        let code =
            code.map_err(|_| format!("line {number} is no group code: it is no DXF, or it is damaged there"))?;
        let (line, value) = lines.next().ok_or_else(|| format!("it ends after the group code in line {number}"))?;
        pairs.push(Pair { code, value: value.trim(), line });
    }
    Ok(pairs)
}

/// The text of a drawing.
pub(super) fn text(octets: &[u8]) -> Result<String, String> {
    if octets.starts_with(BINARY) {
        return Err("it is a binary DXF; allowed: a DXF in text, as each program for drawings saves it".to_owned());
    }
    // Names in old code pages keep what is ASCII in them.
    Ok(String::from_utf8_lossy(octets.strip_prefix(b"\xef\xbb\xbf").unwrap_or(octets)).into_owned())
}
