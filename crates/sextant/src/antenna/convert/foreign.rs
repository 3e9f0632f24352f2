//! Files of antenna programs that are no tables, by their first lines.

use std::path::Path;

use sextant_kernel::{FileForm, seen as seen_of};

/// What a file is that is neither a MATLAB file nor a table, and what helps; `None` if it may be a table.
pub(super) fn seen(path: &Path, octets: &[u8]) -> Option<String> {
    /// So many octets at the start tell what a text is.
    const HEAD: usize = 1 << 16;
    let head = &octets[..octets.len().min(HEAD)];
    if let Some(form) = FileForm::of(head) {
        return Some(form.told(path));
    }
    let Ok(text) = std::str::from_utf8(octets) else { return Some(seen_of(path)) };
    if text.contains('\0') {
        return Some(seen_of(path));
    }
    let lines = || text.lines().map(str::trim).filter(|line| !line.is_empty());
    let numbers = |line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        words.iter().all(|word| word.parse::<f64>().is_ok()).then_some(words.len())
    };
    if text.contains("- RADIATION PATTERNS -") {
        return Some(
            "an output of NEC; write the columns THETA, PHI and TOTAL of its radiation pattern as a table with the header \
             theta_deg,phi_deg,gain_dbi"
                .to_owned(),
        );
    }
    // HFSS: two lines of a start, an end and a number, then the frequencies.
    let mut first = lines();
    if let (Some(theta), Some(phi), Some(third)) = (first.next(), first.next(), first.next())
        && numbers(theta) == Some(3)
        && numbers(phi) == Some(3)
        && third.to_lowercase().starts_with("freq")
    {
        return Some(
            "a far field of HFSS (.ffd), which has field strengths; export a report of dB(GainTotal) over Phi and Theta as CSV"
                .to_owned(),
        );
    }
    None
}
