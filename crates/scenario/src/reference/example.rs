//! How a key is written in a scenario.

use std::sync::LazyLock;

use super::{KeyReference, path};
use crate::template::Template;

/// The scenarios of the templates, which examples are taken from.
static SCENARIOS: LazyLock<Vec<toml::Table>> = LazyLock::new(|| {
    let texts = Template::all().iter().filter_map(Template::scenario);
    texts.filter_map(|scenario| scenario.text.parse().ok()).collect()
});

impl KeyReference {
    /// How it is written: the headers of its table, and a line with a value. The value is that of a template, or the
    /// default, or one of the right kind.
    #[must_use]
    pub fn example(&self) -> Vec<String> {
        let written = SCENARIOS.iter().find_map(|scenario| value(scenario, &self.path));
        let (table, key) = self.path.rsplit_once('.').unwrap_or(("", &self.path));
        let mut lines = lists(&self.path);
        if key.ends_with("[]") {
            return lines;
        }
        let of_settings = self.choices.iter().filter(|choice| choice.has_settings);
        let chosen = written.as_ref().and_then(toml::Value::as_table);
        let choice = of_settings.clone().find(|choice| chosen.is_some_and(|table| table.contains_key(&choice.name)));
        let is_open = written.is_none() && self.default.is_none();
        if let Some(choice) = choice.or(of_settings.clone().next().filter(|_| is_open)) {
            let is_table = chosen.is_none_or(|table| table.get(&choice.name).is_some_and(toml::Value::is_table));
            if is_table {
                lines.push(format!("[{}.{}]", without_brackets(&self.path), choice.name));
                return lines;
            }
        }
        if self.kind == "list of tables" {
            lines.push(format!("[[{}]]", without_brackets(&self.path)));
            return lines;
        }
        if self.kind == "table" && self.choices.is_empty() {
            lines.push(format!("[{}]", without_brackets(&self.path)));
            return lines;
        }
        if !table.is_empty() && !table.ends_with("[]") {
            lines.push(format!("[{}]", without_brackets(table)));
        }
        let value =
            written.map(|value| value.to_string()).or(self.default.clone()).unwrap_or_else(|| self.any_value());
        lines.push(format!("{key} = {value}"));
        lines
    }

    /// A value of the right kind.
    fn any_value(&self) -> String {
        if let Some(choice) = self.choices.first() {
            return if choice.has_settings {
                format!("{{ {} = {{}} }}", choice.name)
            } else {
                format!("{:?}", choice.name)
            };
        }
        match self.kind.as_str() {
            "whole number" => "1",
            "text" => "\"..\"",
            "true or false" => "true",
            "list of texts" => "[\"..\"]",
            "list of 2 numbers" => "[0.0, 1.0]",
            "list of 2 or 3 numbers" => "[0.0, 0.0]",
            "list of 3 numbers" => "[1.0, 1.0, 1.0]",
            "list of 3 whole numbers" => "[0, 1, 2]",
            kind if kind.starts_with("list of lists of 2") => "[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]",
            kind if kind.starts_with("list of lists of 3") => "[[0, 1, 2]]",
            kind if kind.starts_with("list") => "[]",
            kind if kind.starts_with("table") => "{}",
            _ => "1.0",
        }
        .to_owned()
    }
}

/// The headers of the lists of tables on the way to `path`.
fn lists(path: &str) -> Vec<String> {
    let ends = path.match_indices("[]").map(|(at, _)| at);
    ends.map(|at| format!("[[{}]]", without_brackets(&path[..at]))).collect()
}

fn without_brackets(path: &str) -> String {
    path.replace("[]", "")
}

/// The value at `path`, in the first entries of lists that have it.
fn value(table: &toml::Table, path: &str) -> Option<toml::Value> {
    let mut parts = path::parts(path);
    let mut values: Vec<&toml::Value> = table.get(parts.next()?).into_iter().collect();
    for part in parts {
        let entries = values.into_iter().flat_map(|value| match value {
            toml::Value::Array(list) => list.iter().collect(),
            other => vec![other],
        });
        values = entries.filter_map(|entry| entry.as_table()?.get(part)).collect();
    }
    values.first().map(|&value| value.clone())
}
