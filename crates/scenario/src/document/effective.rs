//! The merged settings of a scenario as one TOML text.

use std::fmt::Write;
use std::path::Path;

use super::key_path::{KeyPath, PathStep};
use super::{Entry, Value};
use crate::source::{SETTING, Source};

/// The settings in `root` as a text, with one line `path.to.key = value` per setting.
pub(crate) fn text(root: &Entry, sources: &[Source]) -> String {
    let mut text = "# Merged settings of".to_owned();
    for (i, source) in sources.iter().enumerate() {
        // File names without folders, so that the text does not depend on the folder.
        let name = Path::new(&source.name).file_name().unwrap_or_default().to_string_lossy();
        let sep = if i > 0 { "," } else { "" };
        // Writing to a string never fails.
        let _ = match source.name.as_str() {
            SETTING => write!(text, "{sep} --set {:?}", source.text),
            _ => write!(text, "{sep} {name}"),
        };
    }
    text.push('\n');
    settings(root, &KeyPath::default(), &mut text);
    text
}

fn settings(entry: &Entry, path: &KeyPath, text: &mut String) {
    match &entry.value {
        Value::Table(table) if !table.is_empty() || path.0.is_empty() => {
            for (key, entry) in table {
                settings(entry, &path.child(PathStep::Key(key.clone())), text);
            }
        }
        value => {
            let _ = writeln!(text, "{path} = {}", inline(value));
        }
    }
}

/// A value as TOML on one line.
pub(crate) fn inline(value: &Value) -> String {
    match value {
        Value::Boolean(boolean) => boolean.to_string(),
        Value::Integer(integer) => integer.to_string(),
        Value::Float(float) if float.is_nan() => "nan".to_owned(),
        Value::Float(float) => format!("{float:?}"),
        Value::String(text) => toml::Value::String(text.clone()).to_string(),
        Value::Datetime(text) => text.clone(),
        // It takes the place of a value only while errors are collected.
        Value::Placeholder(_) => String::new(),
        Value::Array(items) => {
            format!("[{}]", items.iter().map(|item| inline(&item.value)).collect::<Vec<_>>().join(", "))
        }
        Value::Table(table) => {
            let settings = table.iter().map(|(key, entry)| {
                format!("{} = {}", KeyPath(vec![PathStep::Key(key.clone())]), inline(&entry.value))
            });
            format!("{{ {} }}", settings.collect::<Vec<_>>().join(", "))
        }
    }
}
