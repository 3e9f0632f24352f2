//! The HTML file: the frame of the page, the code, the data and the licences.

use std::fmt::Write as _;
use std::io::Write as _;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::write::GzEncoder;
use flate2::{Compression, GzBuilder};

use sextant_recording::admission::REPORT_TITLE;

use super::document::{DocumentKind, Report};
use super::policy::{live_policy, policy};
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
        let json = self.to_json();
        let mut packed: GzEncoder<Vec<u8>> =
            GzBuilder::new().mtime(0).operating_system(UNKNOWN_SYSTEM).write(Vec::new(), Compression::new(7));
        packed.write_all(json.as_bytes()).expect("memory takes everything");
        let packed = packed.finish().expect("memory takes everything");
        let data =
            format!("<script type=\"application/octet-stream\" id=\"data\">{}</script>\n", STANDARD.encode(packed));
        page(&PageFrame {
            title: &self.title,
            kind: self.kind.words(),
            origin: &self.origin_line(),
            root: "",
            head: "",
            policy,
            data: &data,
        })
    }

    /// The document alone (JSON), as the code of the page reads it.
    ///
    /// # Panics
    /// Never: all keys of a report are texts.
    #[must_use]
    pub fn to_json(&self) -> String {
        serde_json::to_string(self).expect("the keys of a report are texts")
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

/// The page of a run of `scenario` that is still simulated. It has no data: it asks the server that it is from for `state`
/// and `document` ([`Report::to_json`]), and tells it to `pause`, `resume`, `step` and `speed/N`, all beside its own address.
#[must_use]
pub fn live_page(scenario: &str) -> String {
    let frame = PageFrame {
        title: scenario,
        kind: "Run that goes on",
        origin: "",
        root: " data-live",
        // No picture for the tab: the browser would ask for one.
        head: "<link rel=\"icon\" href=\"data:,\">\n",
        policy: live_policy,
        data: "",
    };
    page(&frame)
}

/// What differs from page to page.
struct PageFrame<'a> {
    title: &'a str,
    kind: &'a str,
    /// Where the data are from (HTML).
    origin: &'a str,
    /// Attributes of the root element.
    root: &'a str,
    /// More elements of the head (HTML).
    head: &'a str,
    /// What the page may do, by its code and its style.
    policy: fn(&str, &str) -> String,
    /// The element with the data (HTML).
    data: &'a str,
}

fn page(frame: &PageFrame<'_>) -> String {
    let PageFrame { title, kind, origin, root, head, policy, data } = frame;
    let (script, style) = (format!("\n{SCRIPT}"), format!("\n{STYLE}"));
    let mut html = String::with_capacity(SCRIPT.len() + STYLE.len() + data.len() + LICENCES.len() + 2000);
    let _ = write!(
        html,
        "<!DOCTYPE html>\n<html lang=\"en\"{root}>\n<head>\n<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n\
         {head}\
         <title>{} · {REPORT_TITLE}\n<style>{style}</style>\n</head>\n<body>\n\
         <header class=\"top\">\n<div class=\"titles\">\n<p class=\"kind\">{kind}</p>\n<h1>{}</h1>\n{origin}</div>\n</header>\n\
         <main id=\"main\">\n<p class=\"wait\" role=\"status\">Reading the data ..</p>\n\
         <noscript><p>This report draws with JavaScript, which is off in this browser.</p></noscript>\n</main>\n\
         {data}<script type=\"text/plain\" id=\"licences\">{}</script>\n\
         <script>{script}</script>\n</body>\n</html>\n",
        policy(&script, &style),
        isolated(title),
        bdi(title),
        without_ends(LICENCES),
    );
    html
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
