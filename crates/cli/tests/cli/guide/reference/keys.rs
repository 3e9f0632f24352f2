//! The keys of a scenario as a page: one section a table, named by its path.

use std::collections::BTreeSet;

use sextant::scenario::KeyReference;

const PREFACE: &str = "# Reference of keys\n\n\
    Here is every key of a scenario file with its type, its unit, its default and its meaning. Each section is one table. \
    It is named by its path in the file: `robots[]` is one table of the list `[[robots]]`, and `NAME` is a name of your own.\n\n\
    A key without a default is either required, or its text says what holds if it is absent. \
    `sextant explain KEY` prints one of them.\n";

/// The page of all keys, in their order.
pub(super) fn page(keys: &[KeyReference]) -> String {
    let tables: BTreeSet<&str> = keys.iter().map(|key| table(&key.path)).collect();
    let mut sections: Vec<(&str, String)> = Vec::new();
    for key in keys {
        let table = table(&key.path);
        let row = row(key, &tables);
        match sections.iter_mut().find(|(name, _)| *name == table) {
            Some((_, rows)) => rows.push_str(&row),
            None => sections.push((table, row)),
        }
    }
    let sections = sections.iter().map(|(table, rows)| heading(table, keys) + rows);
    PREFACE.to_owned() + &sections.collect::<String>()
}

/// The path of the table in which a key stands; empty for the file itself.
fn table(path: &str) -> &str {
    path.rsplit_once('.').map_or("", |(table, _)| table)
}

/// The heading of a table: its anchor, its path, what it means, and the head of its rows.
fn heading(table: &str, keys: &[KeyReference]) -> String {
    let head = "| key | type | default | meaning |\n| --- | --- | --- | --- |\n";
    if table.is_empty() {
        return format!("\n<a id=\"file\"></a>\n\n## The file\n\n{head}");
    }
    let key = table.trim_end_matches("[]").trim_end_matches(".NAME");
    let key = keys.iter().find(|other| other.path == key);
    let text = key.map_or_else(String::new, |key| escaped(&key.description));
    format!("\n<a id=\"{table}\"></a>\n\n## `{table}`\n\n{text}\n\n{head}")
}

/// The row of a key.
fn row(key: &KeyReference, tables: &BTreeSet<&str>) -> String {
    let section = |path: &str| {
        let names = ["", "[]", ".NAME", "[].NAME"].map(|end| format!("{path}{end}"));
        names.into_iter().find(|name| tables.contains(name.as_str()))
    };
    let section = section(key.same_as.as_deref().unwrap_or(&key.path));
    let kind = section.map_or_else(|| key.kind.clone(), |section| format!("[{}](#{section})", key.kind));
    let kind = [Some(kind), key.unit.clone(), key.range.clone()].into_iter().flatten().collect::<Vec<_>>().join(", ");
    let default = match &key.default {
        // The keys of the table have them one by one.
        Some(default) if default.starts_with('{') => "its defaults".to_owned(),
        Some(default) => format!("`{}`", default.replace('|', "\\|")),
        None if key.is_required => "required".to_owned(),
        None => String::new(),
    };
    let words = key.choices.iter().filter(|choice| !choice.has_settings).map(|choice| {
        let colon = if choice.description.is_empty() { "" } else { ": " };
        format!("<br>`\"{}\"`{colon}{}", choice.name, escaped(&choice.description))
    });
    let meaning = escaped(&key.description) + &words.collect::<String>();
    format!("| `{}` | {kind} | {default} | {} |\n", key.name(), meaning.replace('|', "\\|"))
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
