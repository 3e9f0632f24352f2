//! The JSON schema of scenarios as a page: one section a table, named by its path.

use std::collections::{BTreeMap, VecDeque};

use serde_json::{Map, Value};

const PREFACE: &str = "# Reference of keys\n\n\
    Here is every key of a scenario file with its type, its unit, its default and its meaning. Each section is one table. \
    It is named by its path in the file: `robots[]` is one table of the list `[[robots]]`, and NAME is a name of your own.\n\n\
    A key without a default is either required, or its text says what holds if it is absent. \
    The page is made from `sextant schema`.\n";

/// A table of the file: a schema, and the paths at which it stands, the first one that was found first.
struct Table<'a> {
    schema: &'a Value,
    paths: Vec<String>,
}

/// All tables of a schema.
struct Tables<'a> {
    definitions: &'a Map<String, Value>,
    tables: Vec<Table<'a>>,
    /// Where a definition stands in `tables`.
    known: BTreeMap<&'a str, usize>,
    waiting: VecDeque<usize>,
}

/// The page of a schema.
pub(super) fn page(schema: &Value) -> String {
    let definitions = schema["$defs"].as_object().expect("definitions");
    let mut tables = Tables { definitions, tables: Vec::new(), known: BTreeMap::new(), waiting: VecDeque::new() };
    tables.enter(schema, String::new());
    // Headings come last, because a table may be found at more paths while others are written.
    let mut bodies = Vec::new();
    while let Some(index) = tables.waiting.pop_front() {
        let (schema, path) = (tables.tables[index].schema, tables.tables[index].paths[0].clone());
        bodies.push((index, tables.body(schema, &path)));
    }
    let sections = bodies.iter().map(|(index, body)| heading(&tables.tables[*index]) + body);
    PREFACE.to_owned() + &sections.collect::<String>()
}

/// The heading of a table: its anchor, its path, its text and its other paths.
fn heading(table: &Table<'_>) -> String {
    let path = &table.paths[0];
    let title = if path.is_empty() { "The file".to_owned() } else { format!("`{path}`") };
    let anchor = if path.is_empty() { "file" } else { path };
    let text = table.schema["description"].as_str().map_or_else(String::new, |text| format!("{}\n\n", escaped(text)));
    let also = match table.paths.get(1..) {
        None | Some([]) => String::new(),
        Some(paths) => format!("Also: `{}`\n\n", paths.join("`, `")),
    };
    format!("\n<a id=\"{anchor}\"></a>\n\n## {title}\n\n{text}{also}")
}

impl<'a> Tables<'a> {
    /// Takes a table at a path; its anchor.
    fn enter(&mut self, schema: &'a Value, path: String) -> String {
        self.tables.push(Table { schema, paths: vec![path.clone()] });
        self.waiting.push_back(self.tables.len() - 1);
        path
    }

    /// Takes the table of a definition at a path; its anchor.
    fn enter_definition(&mut self, name: &'a str, path: String) -> String {
        if let Some(&index) = self.known.get(name) {
            let paths = &mut self.tables[index].paths;
            if !paths.contains(&path) {
                paths.push(path);
            }
            return paths[0].clone();
        }
        self.known.insert(name, self.tables.len());
        self.enter(&self.definitions[name], path)
    }

    /// The choices and the keys of a table.
    fn body(&mut self, schema: &'a Value, path: &str) -> String {
        let mut text = String::new();
        if let Some(choices) = choices(schema) {
            text.push_str("One of these:\n\n| choice | type | meaning |\n| --- | --- | --- |\n");
            for choice in choices {
                text.push_str(&self.choice(choice, path));
            }
        }
        let Some(keys) = schema["properties"].as_object().filter(|keys| !keys.is_empty()) else {
            return if text.is_empty() { "It has no keys.\n".to_owned() } else { text };
        };
        let required: Vec<&str> =
            schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
        text.push_str("| key | type | default | meaning |\n| --- | --- | --- | --- |\n");
        for (key, value) in keys {
            let place = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
            let kind = self.kind(value, &place);
            let default = match &value["default"] {
                Value::Null if required.contains(&key.as_str()) => "required".to_owned(),
                Value::Null => String::new(),
                Value::Object(_) => "its defaults".to_owned(),
                default => format!("`{default}`"),
            };
            text.push_str(&format!("| `{key}` | {kind}{} | {default} | {} |\n", unit(key), self.meaning(value)));
        }
        text
    }

    /// The row of a choice: a word, or a table with one key.
    fn choice(&mut self, choice: &'a Value, path: &str) -> String {
        let text = cell(&choice["description"]);
        if let Some(word) = choice["const"].as_str() {
            return format!("| `\"{word}\"` | word | {text} |\n");
        }
        if let Some(words) = choice["enum"].as_array() {
            return words.iter().map(|word| format!("| `{word}` | word | |\n")).collect();
        }
        let Some((key, value)) = choice["properties"].as_object().and_then(|keys| keys.iter().next()) else {
            return format!("| | {} | {text} |\n", self.kind(choice, path));
        };
        let kind = self.kind(value, &format!("{path}.{key}"));
        let texts = [text, self.meaning(value)];
        format!("| `{key}` | {kind}{} | {} |\n", unit(key), texts.join(" ").trim())
    }

    /// What a key means, and the words that it may be.
    fn meaning(&self, value: &Value) -> String {
        let words = self.words(value).unwrap_or_default();
        let words = words.iter().map(|(word, meaning)| {
            let colon = if meaning.is_empty() { "" } else { ": " };
            format!("<br>`\"{word}\"`{colon}{meaning}")
        });
        cell(&value["description"]) + &words.collect::<String>()
    }

    /// The words of a schema that allows words alone, with their meanings.
    fn words(&self, value: &Value) -> Option<Vec<(String, String)>> {
        let value = present(value);
        if let Some(name) = reference(value) {
            return self.words(&self.definitions[name]);
        }
        if let Some(words) = value["enum"].as_array() {
            return words.iter().map(|word| Some((word.as_str()?.to_owned(), String::new()))).collect();
        }
        let word = |word: &Value| Some((word["const"].as_str()?.to_owned(), cell(&word["description"])));
        choices(value)?.iter().map(word).collect()
    }

    /// The type of a value, with a link if it is a table.
    fn kind(&mut self, value: &'a Value, path: &str) -> String {
        let value = present(value);
        if self.words(value).is_some() {
            return "word".to_owned();
        }
        let is_table = |value: &Value| value["properties"].is_object() || choices(value).is_some();
        if let Some(name) = reference(value) {
            let definition = &self.definitions[name];
            return match name {
                "Position" => "place".to_owned(),
                _ if is_table(definition) => format!("[table](#{})", self.enter_definition(name, path.to_owned())),
                _ => self.kind(definition, path),
            };
        }
        if is_table(value) {
            return format!("[table](#{})", self.enter(value, path.to_owned()));
        }
        if value["additionalProperties"].is_object() {
            return format!("{} by name", self.kind(&value["additionalProperties"], &format!("{path}.NAME")));
        }
        let kinds = match &value["type"] {
            Value::Array(kinds) => kinds.iter().filter_map(Value::as_str).filter(|kind| *kind != "null").collect(),
            kind => kind.as_str().into_iter().collect::<Vec<_>>(),
        };
        let mut names = Vec::new();
        for kind in kinds {
            names.push(match kind {
                "array" => format!("list of {}", self.items(value, path)),
                "integer" => "whole number".to_owned(),
                "boolean" => "`true` or `false`".to_owned(),
                "string" => "text".to_owned(),
                "object" => "table".to_owned(),
                kind => kind.to_owned(),
            });
        }
        if names.is_empty() { "any value".to_owned() } else { names.join(" or ") }
    }

    /// The items of a list, and how many there are if the schema says so.
    fn items(&mut self, value: &'a Value, path: &str) -> String {
        let number = match (value["minItems"].as_u64(), value["maxItems"].as_u64()) {
            (Some(least), Some(most)) if least == most => format!("{least} "),
            _ => String::new(),
        };
        let item = self.kind(&value["items"], &format!("{path}[]"));
        let plural = match item.split_once(']') {
            Some((kind, link)) => format!("{kind}s]{link}"),
            None => format!("{item}s"),
        };
        format!("{number}{plural}")
    }
}

/// The schema without the choice of absence.
fn present(value: &Value) -> &Value {
    match value["anyOf"].as_array().map(Vec::as_slice) {
        Some([one, null] | [null, one]) if null["type"] == "null" => one,
        _ => value,
    }
}

/// The choices of a schema. Those of the file say which keys are required, and name none.
fn choices(value: &Value) -> Option<&Vec<Value>> {
    let one_of = value["oneOf"].as_array();
    one_of.or_else(|| value["anyOf"].as_array().filter(|_| !value["properties"].is_object()))
}

/// The definition to which a schema refers.
fn reference(value: &Value) -> Option<&str> {
    value["$ref"].as_str()?.strip_prefix("#/$defs/")
}

/// The unit in which the name of a key ends, in brackets.
fn unit(key: &str) -> String {
    const UNITS: [(&str, &str); 29] = [
        ("_m_per_s", "m/s"),
        ("_m_per_s2", "m/s²"),
        ("_deg_per_s", "°/s"),
        ("_deg_per_m", "°/m"),
        ("_rad_per_s", "rad/s"),
        ("_per_s", "1/s"),
        ("_per_m", "1/m"),
        ("_db_per_km", "dB/km"),
        ("_db_per_m", "dB/m"),
        ("_m2", "m²"),
        ("_m", "m"),
        ("_s", "s"),
        ("_ms", "ms"),
        ("_us", "µs"),
        ("_ns", "ns"),
        ("_dbm", "dBm"),
        ("_dbi", "dBi"),
        ("_db", "dB"),
        ("_deg", "°"),
        ("_rad", "rad"),
        ("_hz", "Hz"),
        ("_khz", "kHz"),
        ("_mhz", "MHz"),
        ("_ghz", "GHz"),
        ("_octets", "octets"),
        ("_ppm", "ppm"),
        ("_w", "W"),
        ("_mw", "mW"),
        ("_j", "J"),
    ];
    let found = UNITS.iter().filter(|(end, _)| key.ends_with(end)).max_by_key(|(end, _)| end.len());
    found.map_or_else(String::new, |(_, unit)| format!(", {unit}"))
}

/// A text as a cell of a table.
fn cell(text: &Value) -> String {
    let text = text.as_str().unwrap_or_default();
    escaped(&text.split_whitespace().collect::<Vec<_>>().join(" ")).replace('|', "\\|")
}

/// A text in which nothing but code marks is markup.
fn escaped(text: &str) -> String {
    let part = |(i, part): (usize, &str)| {
        if i % 2 == 1 {
            return format!("`{part}`");
        }
        part.replace('<', "&lt;").replace('*', "\\*").replace('_', "\\_").replace('[', "\\[")
    };
    text.split('`').enumerate().map(part).collect()
}
