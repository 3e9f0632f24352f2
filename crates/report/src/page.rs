//! The HTML file: the frame of the page, the code, the data and the licences.

use std::fmt::Write as _;
use std::io::Write as _;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::write::GzEncoder;
use flate2::{Compression, GzBuilder};

use sextant_recording::admission::REPORT_TITLE;

use super::document::{DocumentKind, Report};
use super::policy::policy;
use super::text::{bdi, isolated};

/// What `web/build.sh` makes.
const SCRIPT: &str = include_str!("../assets/report.js");
const STYLE: &str = include_str!("../assets/report.css");
const LICENCES: &str = include_str!("../assets/licences.txt");

/// The operating system in the header of the compressed data: unknown, so that it is the same on each.
const UNKNOWN_SYSTEM: u8 = 255;

impl Report {
    /// The whole file. The same report gives the same text. The data are packed JSON with all names as they are; the code of
    /// the page makes visible what would change how the text around a name is shown.
    ///
    /// # Panics
    /// Never: all keys of a report are texts, and memory is written without errors.
    #[must_use]
    pub fn to_html(&self) -> String {
        let json = serde_json::to_string(self).expect("the keys of a report are texts");
        let mut packed: GzEncoder<Vec<u8>> =
            GzBuilder::new().mtime(0).operating_system(UNKNOWN_SYSTEM).write(Vec::new(), Compression::new(7));
        packed.write_all(json.as_bytes()).expect("memory takes everything");
        let packed = packed.finish().expect("memory takes everything");
        let (script, style) = (format!("\n{SCRIPT}"), format!("\n{STYLE}"));
        let mut html = String::with_capacity(SCRIPT.len() + STYLE.len() + 2 * packed.len());
        let _ = write!(
            html,
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta name=\"color-scheme\" content=\"light dark\">\n\
             <title>{} · {REPORT_TITLE}\n<style>{style}</style>\n</head>\n<body>\n\
             <header class=\"top\">\n<div class=\"titles\">\n<p class=\"kind\">{}</p>\n<h1>{}</h1>\n{}</div>\n</header>\n\
             <main id=\"main\">\n<p class=\"wait\" role=\"status\">Reading the data ..</p>\n\
             <noscript><p>This report draws with JavaScript, which is off in this browser.</p></noscript>\n</main>\n\
             <script type=\"application/octet-stream\" id=\"data\">{}</script>\n\
             <script type=\"text/plain\" id=\"licences\">{}</script>\n\
             <script>{script}</script>\n</body>\n</html>\n",
            policy(&script, &style),
            isolated(&self.title),
            self.kind.words(),
            bdi(&self.title),
            self.origin_line(),
            STANDARD.encode(packed),
            without_ends(LICENCES),
        );
        html
    }

    /// Scenario, seed and versions, as a paragraph.
    fn origin_line(&self) -> String {
        let origin = &self.origin;
        let mut parts = vec![format!("from <code>{}</code>", bdi(&origin.file))];
        if let Some(seed) = &origin.seed {
            parts.push(format!("seed {}", bdi(seed)));
        }
        let version = origin.version.as_ref().unwrap_or(&origin.reported_by);
        parts.push(format!("sextant {}", bdi(version)));
        format!("<p class=\"origin\">{}</p>\n", parts.join(" · "))
    }
}

impl DocumentKind {
    /// What the report is of, in words.
    fn words(self) -> &'static str {
        match self {
            Self::Run => "Report of a run",
            Self::Log => "Map of a log",
            Self::Sweep => "Report of a sweep",
            Self::Reproduction => "Report of a reproduction",
        }
    }
}

/// A text in which no element ends.
fn without_ends(text: &str) -> String {
    text.replace("</", "< /").replace("<!--", "< !--")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_code_does_not_end_its_element() {
        for text in [SCRIPT, STYLE] {
            assert!(!text.contains("</script") && !text.contains("</style") && !text.contains("<!--"));
        }
        assert!(!STYLE.contains("http") && !STYLE.contains("@import"));
        // Browsers would change these before they compute the hash.
        assert!(![SCRIPT, STYLE].iter().any(|text| text.contains(['\r', '\0'])));
    }

    #[test]
    fn a_title_is_text_and_not_code() {
        let report = Report::new(DocumentKind::Run, "</title><script>alert('x')</script>\u{7}", "a&b<c>.mcap");
        let html = report.to_html();
        assert!(html.contains("&lt;/title&gt;&lt;script&gt;alert(&#39;x&#39;)&lt;/script&gt;\\u{7}</bdi>"));
        assert!(html.contains("a&amp;b&lt;c&gt;.mcap"));
        assert_eq!(html.matches("<script").count(), 3 + SCRIPT.matches("<script").count());
    }
}
