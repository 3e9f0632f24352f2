//! What a page may do: run its own code and style, which are named by their hashes, and nothing else.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest as _, Sha256};

/// The content security policy (W3C, level 3) of a page with this code and this style, each as it stands between the tags
/// of its element. Nothing may be loaded from anywhere, and no other code runs: none in attributes, none that a name brings.
pub(super) fn policy(script: &str, style: &str) -> String {
    format!(
        "default-src 'none'; script-src {}; style-src {}; img-src data: blob:; form-action 'none'; base-uri 'none'",
        source(script),
        source(style)
    )
}

/// The same of a page that may ask where it is from.
pub(super) fn live_policy(script: &str, style: &str) -> String {
    format!("{}; connect-src 'self'", policy(script, style))
}

/// The source of exactly this text.
fn source(text: &str) -> String {
    format!("'sha256-{}'", STANDARD.encode(Sha256::digest(text.as_bytes())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_source_is_the_hash_of_the_text() {
        // The example of the specification (Content Security Policy Level 3, "Usage of hashes").
        let example = "alert('Hello, world.');";
        assert_eq!(source(example), "'sha256-qznLcsROx4GACP2dm0UCKCzCG+HiZ1guq6ZZDob/Tng='");
    }
}
