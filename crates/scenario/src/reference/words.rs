//! Parts of a schema in words.

use serde_json::Value;

/// A description in one paragraph: the lines of a doc comment are joined.
pub(super) fn paragraph(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The first sentence of `text`, with its full stop.
pub(super) fn first_sentence(text: &str) -> &str {
    // A full stop ends a sentence if a capital letter or a quoted name follows. After `e.g.` and `..` none does.
    let ends = |at: usize| {
        let rest = &text[at + 1..];
        let next = rest.trim_start().chars().next();
        rest.starts_with(' ') && !text[..at].ends_with('.') && next.is_none_or(|c| c.is_uppercase() || c == '`')
    };
    let end = text.match_indices('.').map(|(at, _)| at).find(|&at| ends(at));
    end.map_or(text, |at| &text[..=at])
}

/// A value of JSON in TOML; `None` for null.
pub(super) fn toml(value: &Value) -> Option<String> {
    let written = without_nulls(value)?;
    Some(toml::Value::try_from(written).ok()?.to_string())
}

/// The value without the keys of tables that have none: TOML has no null.
fn without_nulls(value: &Value) -> Option<Value> {
    match value {
        Value::Null => None,
        Value::Object(table) => {
            let entries = table.iter().filter_map(|(key, value)| Some((key.clone(), without_nulls(value)?)));
            Some(Value::Object(entries.collect()))
        }
        Value::Array(list) => Some(Value::Array(list.iter().filter_map(without_nulls).collect())),
        other => Some(other.clone()),
    }
}

/// The numbers from `least` to `most`, each with whether it is itself excluded.
pub(super) fn range(least: Option<(f64, bool)>, most: Option<(f64, bool)>) -> Option<String> {
    Some(match (least, most) {
        (None, None) => return None,
        (Some((least, false)), None) => format!("{least} or above"),
        (Some((least, true)), None) => format!("above {least}"),
        (None, Some((most, false))) => format!("at most {most}"),
        (None, Some((most, true))) => format!("below {most}"),
        (Some((least, false)), Some((most, false))) => format!("{least} to {most}"),
        (Some((least, least_out)), Some((most, most_out))) => format!(
            "{} {least}, {} {most}",
            if least_out { "above" } else { "at least" },
            if most_out { "below" } else { "at most" }
        ),
    })
}

/// A kind of value in the plural: `number` becomes `numbers`.
pub(super) fn plural(kind: &str) -> String {
    match kind.split_once(' ') {
        Some(("list", rest)) => format!("lists {rest}"),
        _ if kind == TRUTH => "values true or false".to_owned(),
        _ => format!("{kind}s"),
    }
}

/// The kind of a boolean.
pub(super) const TRUTH: &str = "true or false";
