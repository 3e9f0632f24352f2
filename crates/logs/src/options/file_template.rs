//! The names of files that say where the robot stood: `{x}_{y}.csv`.

use std::fmt;
use std::str::FromStr;

/// How the names of files are made: words, fields in braces, and `*` for any text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileTemplate {
    text: String,
    parts: Vec<TemplatePart>,
}

/// A part of a template.
#[derive(Clone, Debug, PartialEq, Eq)]
enum TemplatePart {
    Word(String),
    AnyText,
    Field { key: &'static str, width: Option<usize> },
}

/// What a field can be, and the column that it is.
const FIELDS: [(&str, &str); 7] =
    [("x", "x_m"), ("y", "y_m"), ("z", "z_m"), ("lat", "lat"), ("lon", "lon"), ("stop", "stop"), ("robot", "robot")];

/// What the fields of a name are: the column and the text of each.
pub(crate) type NameCells = Vec<(&'static str, String)>;

impl FileTemplate {
    /// Whether names of files have this field, by its column.
    pub(crate) fn has(&self, column: &str) -> bool {
        self.parts.iter().any(|part| matches!(part, TemplatePart::Field { key, .. } if *key == column))
    }

    /// Whether names say where the robot stood.
    pub(crate) fn has_places(&self) -> bool {
        self.has("x_m") || self.has("lat")
    }

    /// What the fields of the name of a file are; `None` if it is not made so.
    ///
    /// # Errors
    /// If the name can be read in several ways: what they are.
    pub(crate) fn read(&self, name: &str) -> Result<Option<NameCells>, String> {
        let mut ways = Vec::new();
        ways_of(&self.parts, name, &mut Vec::new(), &mut ways);
        let Some(first) = ways.pop() else { return Ok(None) };
        if ways.iter().all(|way| *way == first) {
            return Ok(Some(first));
        }
        ways.push(first);
        ways.sort();
        ways.dedup();
        let told = |way: &NameCells| {
            way.iter().map(|(column, text)| format!("{column} {text}")).collect::<Vec<_>>().join(", ")
        };
        Err(ways.iter().take(MOST_SHOWN).map(told).collect::<Vec<_>>().join("; "))
    }
}

/// So many ways to read a name are shown, and looked for.
const MOST_SHOWN: usize = 3;
const MOST_WAYS: usize = 100;

/// Adds to `ways` each way in which `text` is made of these parts, after what is already `found`.
fn ways_of(parts: &[TemplatePart], text: &str, found: &mut NameCells, ways: &mut Vec<NameCells>) {
    if ways.len() >= MOST_WAYS {
        return;
    }
    let Some((part, rest)) = parts.split_first() else {
        if text.is_empty() {
            ways.push(found.clone());
        }
        return;
    };
    let ends = || text.char_indices().map(|(at, _)| at).chain([text.len()]);
    match part {
        TemplatePart::Word(word) => {
            if let Some(after) = text.strip_prefix(word.as_str()) {
                ways_of(rest, after, found, ways);
            }
        }
        TemplatePart::AnyText => ends().for_each(|end| ways_of(rest, &text[end..], found, ways)),
        TemplatePart::Field { key, width } => {
            for end in ends().skip(1) {
                let (value, after) = text.split_at(end);
                let fits = width.is_none_or(|width| value.chars().count() == width);
                let is_name = matches!(*key, "stop" | "robot");
                if fits && (is_name || is_plain_number(value)) {
                    found.push((key, value.to_owned()));
                    ways_of(rest, after, found, ways);
                    found.pop();
                }
            }
        }
    }
}

/// Whether a text is a number as names of files have it: digits, perhaps with a sign and a decimal point.
fn is_plain_number(text: &str) -> bool {
    let digits = text.strip_prefix(['-', '+']).unwrap_or(text);
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, "0"));
    [whole, fraction].iter().all(|digits| !digits.is_empty() && digits.bytes().all(|octet| octet.is_ascii_digit()))
}

impl FromStr for FileTemplate {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let allowed = "allowed: names of files with {x}, {y}, {z} (m), {lat}, {lon} (degrees), {stop}, {robot}, each once, \
                       as {x}_{y}.csv or with a number of characters as {x:2}{y:2}.csv; * is any text";
        let refused = |found: &str| Err(format!("found {found}; {allowed}"));
        let mut parts = Vec::new();
        let mut rest = text;
        while let Some(at) = rest.find(['{', '*']) {
            let (word, field) = rest.split_at(at);
            if word.contains('}') {
                return refused("a brace that is not opened");
            }
            if !word.is_empty() {
                parts.push(TemplatePart::Word(word.to_owned()));
            }
            if let Some(after) = field.strip_prefix('*') {
                parts.push(TemplatePart::AnyText);
                rest = after;
                continue;
            }
            let Some((inner, after)) = field[1..].split_once('}') else {
                return refused("a brace that is not closed");
            };
            let (name, width) = inner.split_once(':').map_or((inner, None), |(name, width)| (name, Some(width)));
            let Some((_, key)) = FIELDS.iter().find(|(known, _)| *known == name.trim()) else {
                return refused(&format!("`{{{inner}}}`"));
            };
            let width = match width.map(|width| width.trim().parse().ok().filter(|width| (1..=64).contains(width))) {
                Some(None) => {
                    return refused(&format!("`{{{inner}}}`, whose number of characters is none from 1 to 64"));
                }
                Some(width) => width,
                None => None,
            };
            if parts.iter().any(|part| matches!(part, TemplatePart::Field { key: other, .. } if other == key)) {
                return refused(&format!("`{{{inner}}}` twice"));
            }
            parts.push(TemplatePart::Field { key, width });
            rest = after;
        }
        if rest.contains('}') {
            return refused("a brace that is not opened");
        }
        if !rest.is_empty() {
            parts.push(TemplatePart::Word(rest.to_owned()));
        }
        let template = Self { text: text.to_owned(), parts };
        let has = |column| template.has(column);
        if has("x_m") != has("y_m") || has("lat") != has("lon") {
            return refused("one coordinate without the other");
        }
        if has("x_m") && has("lat") {
            return refused("places in metres and by latitude and longitude");
        }
        if !template.has_places() && !has("stop") {
            return refused("neither places nor stops");
        }
        if text.contains(['/', '\\']) {
            return refused("a folder in the names of files");
        }
        Ok(template)
    }
}

impl fmt::Display for FileTemplate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(template: &str, name: &str) -> Result<Option<String>, String> {
        let cells = template.parse::<FileTemplate>().unwrap().read(name)?;
        Ok(cells.map(|cells| cells.iter().map(|(column, text)| format!("{column}={text} ")).collect()))
    }

    #[test]
    fn a_name_says_where_the_robot_stood() {
        for (template, name, expected) in [
            ("{x}_{y}.csv", "1.5_-2.csv", Some("x_m=1.5 y_m=-2 ")),
            ("{x}-{y}.csv", "1--2.csv", Some("x_m=1 y_m=-2 ")),
            ("{x}{y}_raw.csv", "34_raw.csv", Some("x_m=3 y_m=4 ")),
            ("{x:2}{y:2}_raw.csv", "0312_raw.csv", Some("x_m=03 y_m=12 ")),
            ("{x}{y}_raw.csv", "1-2_raw.csv", Some("x_m=1 y_m=-2 ")),
            ("({x}, {y}, {z}).txt", "(1, 2, 0.5).txt", Some("x_m=1 y_m=2 z_m=0.5 ")),
            ("{robot}_at_{lat},{lon}.csv", "rover_at_48.58,7.75.csv", Some("robot=rover lat=48.58 lon=7.75 ")),
            ("stop {stop} *.csv", "stop 12 of monday.csv", None),
            ("*_{x}_{y}.csv", "ble_scan_1_2.csv", Some("x_m=1 y_m=2 ")),
            ("{stop}.csv", "kitchen.csv", Some("stop=kitchen ")),
            ("{x}_{y}.csv", "notes.csv", None),
            ("{x}_{y}.csv", "1_2.csv.bak", None),
            ("{x}_{y}.csv", "1e3_2.csv", None),
        ] {
            let found = read(template, name);
            match (expected, found) {
                (None, Ok(None) | Err(_)) => {}
                (expected, found) => {
                    assert_eq!(found.as_ref().map(Option::as_deref), Ok(expected), "{template} {name}")
                }
            }
        }
    }

    #[test]
    fn a_name_that_can_be_read_in_several_ways_is_refused_with_them() {
        assert_eq!(read("{x}{y}_raw.csv", "123_raw.csv"), Err("x_m 1, y_m 23; x_m 12, y_m 3".to_owned()));
        assert!(read("{x}{y}.csv", "0102.csv").unwrap_err().starts_with("x_m 0, y_m 102; x_m 01, y_m 02"));
        assert_eq!(read("{x:1}{y}_raw.csv", "123_raw.csv"), Ok(Some("x_m=1 y_m=23 ".to_owned())));
        // Any text that differs alone is no other place.
        assert_eq!(read("*{x}_{y}*.csv", "a1_2.csv"), Ok(Some("x_m=1 y_m=2 ".to_owned())));
    }

    #[test]
    fn a_template_that_says_no_place_is_refused() {
        for (text, problem) in [
            ("", "found neither places nor stops"),
            ("{robot}.csv", "found neither places nor stops"),
            ("{x}.csv", "found one coordinate without the other"),
            ("{x}_{y}_{lat}_{lon}.csv", "found places in metres and by latitude"),
            ("{x}_{y", "found a brace that is not closed"),
            ("x}_{y}", "found a brace that is not opened"),
            ("{x}_{q}.csv", "found `{q}`"),
            ("{x:0}{y}.csv", "found `{x:0}`, whose number"),
            ("{x}{x}{y}.csv", "found `{x}` twice"),
            ("{x}/{y}.csv", "found a folder"),
        ] {
            let found = text.parse::<FileTemplate>().unwrap_err();
            assert!(found.starts_with(problem), "{text}: {found}");
        }
    }
}
