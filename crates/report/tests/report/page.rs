//! The page: sound HTML, and nothing in the data is taken for code.

use sextant_report::Report;

use super::{HOSTILE, document, folder, recorded};

/// Elements that have no end.
const VOID: [&str; 2] = ["meta", "!DOCTYPE"];

/// The open elements at the end of a page, and the first wrong end. Text within script and style is skipped.
fn nesting(html: &str) -> Result<Vec<String>, String> {
    let mut open: Vec<String> = Vec::new();
    let mut rest = html;
    while let Some(start) = rest.find('<') {
        let tag = &rest[start + 1..];
        let end = tag.find('>').ok_or("a tag without an end")?;
        let (tag, after) = (&tag[..end], &tag[end + 1..]);
        rest = after;
        if let Some(name) = tag.strip_prefix('/') {
            let last = open.pop();
            if last.as_deref() != Some(name) {
                return Err(format!("{last:?} ends with {name}"));
            }
            continue;
        }
        let name = tag.split([' ', '\n']).next().unwrap_or_default();
        if VOID.contains(&name) {
            continue;
        }
        open.push(name.to_owned());
        if ["script", "style"].contains(&name) {
            rest = &after[after.find(&format!("</{name}>")).ok_or("a script without an end")?..];
        }
    }
    Ok(open)
}

#[test]
fn each_element_ends_where_it_should() {
    let folder = folder();
    let html = Report::of_recording(&recorded(&folder)).expect("a sound recording").to_html();
    assert_eq!(nesting(&html), Ok(Vec::new()));
    assert!(nesting("<p><b></p>").is_err());
}

#[test]
fn names_with_ends_of_scripts_and_control_characters_come_back_as_they_are() {
    let folder = folder();
    let html = Report::of_recording(&recorded(&folder)).expect("a sound recording").to_html();
    let document = document(&html);
    assert_eq!(document["world"]["names"], serde_json::json!(HOSTILE));
    assert_eq!(document["scenario"], "name = \"</script>\"\n");
    assert!(!html.contains("alert(1)") && !html.contains('\u{0}') && !html.contains('\u{1b}'));
    assert!(html.contains("<title>&lt;/title&gt;&lt;b&gt; · Sextant report</title>"));
}

#[test]
fn the_page_loads_nothing() {
    let folder = folder();
    let html = Report::of_recording(&recorded(&folder)).expect("a sound recording").to_html();
    assert!(html.contains("default-src 'none'"));
    for loading in ["src=\"http", "href=\"http", "url(http", "@import", "<link", "<img", "<iframe"] {
        assert!(!html.contains(loading), "{loading}");
    }
    for licence in ["three", "uplot", "MIT"] {
        assert!(html.contains(licence), "{licence}");
    }
}
