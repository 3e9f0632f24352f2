//! Forms of texts: pages, maps and other documents in XML, JSON, settings.

use super::FileForm;

/// What a text is, as far as its beginning tells; `None` for what may be a table, a path or a list of lines.
pub(super) fn of(text: &str) -> Option<FileForm> {
    let text = text.trim_start();
    let form = |what, helps| Some(FileForm { what, helps });
    if let Some(root) = root(text) {
        return match root.to_ascii_lowercase().as_str() {
            "gpx" => None,
            "html" | "head" | "body" | "div" | "p" | "table" | "br" => form(
                "a web page, as a browser saves it in place of a file",
                "fetch the file itself: its address ends in the name of the file, often behind a button `raw` or `download`",
            ),
            "kml" => form(
                "a track of Google Earth (KML)",
                "make GPX of it: `gpsbabel -i kml -f FILE -o gpx -F NEW.gpx`; it needs times (gx:Track)",
            ),
            "trainingcenterdatabase" => form(
                "a track of a sports watch (TCX)",
                "make GPX of it: `gpsbabel -i gtrnctr -f FILE -o gpx -F NEW.gpx`",
            ),
            "svg" => form("a picture (SVG)", "give the file with the numbers of which it was drawn"),
            "osm" => form("a map of OpenStreetMap", "give the path of the robot as GPX or CSV"),
            "pdml" | "psml" => form("a capture as XML of Wireshark", "save the capture itself, as pcap or pcapng"),
            _ => form("a document in XML of an unknown kind", "of XML, GPX is read; write the rest as CSV"),
        };
    }
    if text.starts_with('{') || text.starts_with("[{") || text.starts_with("[\n") || text.starts_with("[\r\n") {
        let has = |word: &str| text.contains(word);
        return if has("\"FeatureCollection\"") || has("\"Feature\"") || has("\"coordinates\"") {
            form(
                "GeoJSON, which has places without times",
                "write a path as CSV (t_s,lat,lon) or GPX, the places of nodes as CSV (node,lat,lon)",
            )
        } else if has("\"_source\"") && has("\"layers\"") {
            form("a capture as JSON of Wireshark", "save the capture itself, as pcap or pcapng")
        } else {
            form("JSON", "write it as CSV, in Python: `pandas.read_json(\"FILE\").to_csv(\"NEW.csv\", index=False)`")
        };
    }
    None
}

/// The name of the first tag of an XML document without its prefix, after declarations and comments; `None` if the text has
/// none. Of a page this is `html`, also where it begins with its document type.
pub(super) fn root(text: &str) -> Option<String> {
    let mut rest = text.trim_start_matches('\u{feff}').trim_start();
    loop {
        let markup = rest.strip_prefix('<')?;
        let end = match markup {
            _ if markup.starts_with("!--") => "-->",
            _ if markup.starts_with('?') => "?>",
            _ if markup.get(..8).is_some_and(|word| word.eq_ignore_ascii_case("!doctype")) => {
                let named = markup[8..]
                    .split(|c: char| c.is_whitespace() || c == '>' || c == '[')
                    .find(|word| !word.is_empty());
                return named.map(local);
            }
            _ => {
                let name = markup.split(|c: char| c.is_whitespace() || matches!(c, '>' | '/')).next()?;
                let is_name = name.chars().next().is_some_and(|c| c.is_alphabetic() || c == '_');
                return is_name.then(|| local(name));
            }
        };
        rest = markup.split_once(end)?.1.trim_start();
    }
}

/// A name without its prefix: `gpx` of `ns:gpx`.
fn local(name: &str) -> String {
    name.rsplit(':').next().unwrap_or(name).to_owned()
}
