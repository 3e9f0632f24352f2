//! Numbers that no scenario can mean, whatever their key: such lengths and speeds overflow what is computed from them.

use sextant_kernel::SettingError;

use super::errors::Errors;
use crate::document::key_path::{KeyPath, PathStep};
use crate::document::{Document, Entry, Value};

/// What a number may be: its size, or 0.
struct Plausible {
    least: f64,
    most: f64,
    unit: &'static str,
}

/// The smallest and the largest plausible number, by the end of the key.
const BY_UNIT: [(&str, Plausible); 2] = [
    ("_m_per_s", Plausible { least: 1e-9, most: 1e9, unit: " m/s" }),
    ("_m", Plausible { least: 1e-9, most: 1e9, unit: " m" }),
];

/// Of any other key.
const OTHER: Plausible = Plausible { least: 1e-30, most: 1e30, unit: "" };

/// Refuses numbers that cannot be meant. Those that are not finite are refused where they are used.
pub(crate) fn check_numbers(document: &Document, errors: &mut Errors) {
    check(&document.root, &mut KeyPath::default(), "", errors);
}

/// Checks what is in `entry`, which is at `path`; `key` is the last key above it.
fn check(entry: &Entry, path: &mut KeyPath, key: &str, errors: &mut Errors) {
    let Plausible { least, most, unit } =
        BY_UNIT.iter().find(|(end, _)| key.ends_with(end)).map_or(&OTHER, |(_, plausible)| plausible);
    if let Some(number) = first(entry, &|size| !(*least..=*most).contains(&size)) {
        let allowed = format!("0, or a size of {least:e} to {most:e}{unit}");
        errors.refuse(&SettingError::new(path.to_string(), format!("{number:e}"), allowed));
        return;
    }
    match &entry.value {
        Value::Table(table) => {
            for (key, entry) in table {
                path.0.push(PathStep::Key(key.clone()));
                check(entry, path, key, errors);
                path.0.pop();
            }
        }
        Value::Array(items) => {
            for (i, item) in items.iter().enumerate().filter(|(_, item)| matches!(item.value, Value::Table(_))) {
                path.0.push(PathStep::Index(i));
                check(item, path, key, errors);
                path.0.pop();
            }
        }
        _ => {}
    }
}

/// The number, or the first one of an array of numbers or places, whose size is `odd`.
fn first(entry: &Entry, odd: &dyn Fn(f64) -> bool) -> Option<f64> {
    let is_odd = |number: &f64| number.abs() > 0.0 && number.is_finite() && odd(number.abs());
    match &entry.value {
        Value::Float(number) => Some(*number).filter(is_odd),
        Value::Integer(number) => Some(*number as f64).filter(is_odd),
        Value::Array(items) => items.iter().find_map(|item| first(item, odd)),
        _ => None,
    }
}
