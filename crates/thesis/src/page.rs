//! A page of text, tables and figures, written as Markdown or as HTML.

/// A page.
#[derive(Clone, Debug)]
pub(crate) struct Page {
    /// The name of its file, without extension.
    pub(crate) name: String,
    /// The parts, in their order. The first is the title.
    pub(crate) parts: Vec<PagePart>,
}

/// A part of a page.
#[derive(Clone, Debug)]
pub(crate) enum PagePart {
    /// A heading of this depth; 1 is the title.
    Heading(u8, String),
    /// A paragraph.
    Text(Vec<Span>),
    /// A list.
    List(Vec<Vec<Span>>),
    /// A table: header and rows.
    Table(Vec<String>, Vec<Vec<Span>>),
    /// Parts below a summary that opens and closes them; closed at first.
    Folded(String, Vec<PagePart>),
    /// A figure: the file beside the page, and its title.
    Figure {
        /// The name of the file.
        file: String,
        /// What it shows.
        title: String,
        /// The picture itself.
        svg: String,
    },
    /// A picture in a file below the page, and its title.
    Picture(String, String),
}

/// A piece of text.
#[derive(Clone, Debug)]
pub(crate) enum Span {
    /// As it is.
    Plain(String),
    /// What is typed.
    Code(String),
    /// A link to another page by its name.
    Page(String, String),
    /// A link to a file beside the page.
    File(String, String),
}

impl From<String> for Span {
    fn from(text: String) -> Self {
        Self::Plain(text)
    }
}

impl From<&str> for Span {
    fn from(text: &str) -> Self {
        Self::Plain(text.to_owned())
    }
}

impl Page {
    /// The page as Markdown with tables (GitHub's).
    pub(crate) fn markdown(&self) -> String {
        let text: String = self.parts.iter().map(PagePart::markdown).collect();
        format!("{}\n", text.trim_end())
    }

    /// The page as one HTML file: its style and its pictures are in it.
    pub(crate) fn html(&self) -> String {
        let title = self.parts.iter().find_map(|part| match part {
            PagePart::Heading(1, title) => Some(title.as_str()),
            _ => None,
        });
        let title = escaped(title.unwrap_or(&self.name));
        let body: String = self.parts.iter().map(PagePart::html).collect();
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n\
             <style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n{body}</main>\n</body>\n</html>\n"
        )
    }
}

impl PagePart {
    fn markdown(&self) -> String {
        match self {
            Self::Heading(depth, title) => {
                format!("{} {}\n\n", "#".repeat(usize::from(*depth)), plain_markdown(title))
            }
            Self::Text(spans) => format!("{}\n\n", markdown(spans)),
            Self::List(items) => {
                let items: String = items.iter().map(|item| format!("- {}\n", markdown(item))).collect();
                format!("{items}\n")
            }
            Self::Table(header, rows) => {
                let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
                let mut text = line(header.iter().map(|cell| plain_markdown(cell)).collect());
                text += &line(vec!["---".to_owned(); header.len()]);
                for row in rows {
                    text += &line(row.iter().map(|cell| markdown(std::slice::from_ref(cell))).collect());
                }
                format!("{text}\n")
            }
            // Empty lines around the parts: only then do readers of Markdown see tables in HTML.
            Self::Folded(summary, parts) => {
                let parts: String = parts.iter().map(Self::markdown).collect();
                format!("<details>\n<summary>{}</summary>\n\n{parts}</details>\n\n", escaped(summary))
            }
            Self::Figure { file, title, .. } | Self::Picture(file, title) => {
                format!("![{}]({file})\n\n", plain_markdown(title))
            }
        }
    }

    fn html(&self) -> String {
        match self {
            Self::Heading(depth, text) => format!("<h{depth}>{}</h{depth}>\n", escaped(text)),
            Self::Text(spans) => format!("<p>{}</p>\n", html(spans)),
            Self::List(items) => {
                let items: String = items.iter().map(|item| format!("<li>{}</li>\n", html(item))).collect();
                format!("<ul>\n{items}</ul>\n")
            }
            Self::Table(header, rows) => {
                let cells = |tag: &str, cells: Vec<String>| {
                    let cells: String = cells.iter().map(|cell| format!("<{tag}>{cell}</{tag}>")).collect();
                    format!("<tr>{cells}</tr>\n")
                };
                let head = cells("th", header.iter().map(|cell| escaped(cell)).collect());
                let row =
                    |row: &Vec<Span>| cells("td", row.iter().map(|cell| html(std::slice::from_ref(cell))).collect());
                let rows: String = rows.iter().map(row).collect();
                format!(
                    "<div class=\"wide\"><table>\n<thead>\n{head}</thead>\n<tbody>\n{rows}</tbody>\n</table></div>\n"
                )
            }
            Self::Folded(summary, parts) => {
                let parts: String = parts.iter().map(Self::html).collect();
                format!("<details>\n<summary>{}</summary>\n{parts}</details>\n", escaped(summary))
            }
            Self::Figure { title, svg, .. } => {
                let picture = svg.find("<svg").map_or("", |start| &svg[start..]);
                let title = escaped(title);
                format!("<figure>\n{picture}\n<figcaption>{title}</figcaption>\n</figure>\n")
            }
            Self::Picture(file, title) => {
                let title = escaped(title);
                format!(
                    "<figure>\n<img src=\"{file}\" alt=\"{title}\" loading=\"lazy\">\n\
                     <figcaption>{title}</figcaption>\n</figure>\n"
                )
            }
        }
    }
}

const STYLE: &str = "\
:root { color-scheme: light dark; }
body { font: 16px/1.5 system-ui, sans-serif; margin: 0; }
main { max-width: 72rem; margin: 0 auto; padding: 1rem; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; margin: 1rem 0; }
th, td { border-bottom: 1px solid #8886; padding: 0.25rem 0.75rem; text-align: left; vertical-align: top; }
summary { cursor: pointer; margin: 0.5rem 0; }
figure { margin: 1.5rem 0; }
figure svg, figure img { background: #fff; height: auto; max-width: 100%; }
figcaption { opacity: 0.8; }
";

fn markdown(spans: &[Span]) -> String {
    let span = |span: &Span| match span {
        Span::Plain(text) => plain_markdown(text),
        Span::Code(text) => format!("`{text}`"),
        Span::Page(text, page) => format!("[{}]({page}.md)", plain_markdown(text)),
        Span::File(text, file) => format!("[{}]({file})", plain_markdown(text)),
    };
    spans.iter().map(span).collect()
}

/// The text without a meaning in Markdown, also in the cell of a table.
fn plain_markdown(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '<' => plain += "&lt;",
            '|' | '*' | '`' | '[' | ']' | '\\' => plain.extend(['\\', letter]),
            other => plain.push(other),
        }
    }
    plain
}

fn html(spans: &[Span]) -> String {
    let span = |span: &Span| match span {
        Span::Plain(text) => escaped(text),
        Span::Code(text) => format!("<code>{}</code>", escaped(text)),
        Span::Page(text, page) => format!("<a href=\"{page}.html\">{}</a>", escaped(text)),
        Span::File(text, file) => format!("<a href=\"{file}\">{}</a>", escaped(text)),
    };
    spans.iter().map(span).collect()
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_is_the_same_in_both_forms() {
        let page = Page {
            name: "p".into(),
            parts: vec![
                PagePart::Heading(1, "A < B".into()),
                PagePart::Text(vec![
                    "See ".into(),
                    Span::Page("two".into(), "second".into()),
                    Span::Code("x|y".into()),
                ]),
                PagePart::Table(vec!["a".into()], vec![vec!["1 | 2".into()]]),
                PagePart::List(vec![vec![Span::File("all".into(), "a.csv".into())]]),
                PagePart::Folded("more & more".into(), vec![PagePart::Text(vec!["here".into()])]),
                PagePart::Figure { file: "f.svg".into(), title: "F".into(), svg: "<?xml?>\n<svg>s</svg>".into() },
                PagePart::Picture("figures/s/map.svg".into(), "M".into()),
            ],
        };
        insta::assert_snapshot!(page.markdown(), @r"
        # A &lt; B

        See [two](second.md)`x|y`

        | a |
        | --- |
        | 1 \| 2 |

        - [all](a.csv)

        <details>
        <summary>more &amp; more</summary>

        here

        </details>

        ![F](f.svg)

        ![M](figures/s/map.svg)
        ");
        let html = page.html();
        for part in [
            "<title>A &lt; B</title>",
            "<p>See <a href=\"second.html\">two</a><code>x|y</code></p>",
            "<td>1 | 2</td>",
            "<details>\n<summary>more &amp; more</summary>\n<p>here</p>\n</details>",
            "<li><a href=\"a.csv\">all</a></li>",
            "<figure>\n<svg>s</svg>\n<figcaption>F</figcaption>",
            "<img src=\"figures/s/map.svg\" alt=\"M\"",
        ] {
            assert!(html.contains(part), "{part} in {html}");
        }
    }
}
