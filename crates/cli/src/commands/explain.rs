//! `sextant explain`: what a key of a scenario means, or a number of a summary.

use std::io::{self, Write};

use clap::Args;
use serde::Serialize;

use super::options::Printing;
use crate::diagnostic::Failure;
use crate::paragraph::{Paragraph, item};
use sextant::scenario::{ExplainError, Explanation, KeyReference, explain, key_reference};
use sextant::summary::Measure;
use sextant::summary::measures::{Subjects, all};

/// Arguments of `sextant explain`.
#[derive(Clone, Debug, Args)]
pub(crate) struct Arguments {
    /// The path of a key, `channel.path_loss.log_distance.exponent`, or its end, `exponent`; or the path of a number of a
    /// summary, `maps.NAME.position_error_m.mean`. All tables if absent
    #[arg(value_name = "KEY")]
    pub(crate) key: Option<String>,
    /// How results are printed.
    #[command(flatten)]
    pub(crate) printing: Printing,
}

/// What is printed as JSON.
#[derive(Serialize)]
struct Answer<'a> {
    /// The keys found.
    keys: &'a [KeyReference],
    /// The keys below, if one was found.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    below: &'a [KeyReference],
    /// The paths of the same key in other tables, if one was found.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    also_at: &'a [String],
    /// The paths of the numbers found.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    measures: &'a [String],
}

impl<'a> Answer<'a> {
    fn of(keys: &'a [KeyReference]) -> Self {
        Self { keys, below: &[], also_at: &[], measures: &[] }
    }
}

pub(crate) fn execute(arguments: &Arguments) -> Result<(), Failure> {
    let printing = arguments.printing;
    let Some(key) = &arguments.key else {
        let tables: Vec<_> = key_reference().into_iter().filter(|key| !key.path.contains('.')).collect();
        return Ok(printing.print(&Answer::of(&tables), |out| {
            writeln!(out, "The tables and keys of a scenario. `sextant explain KEY` explains one.\n")?;
            tables.iter().try_for_each(|key| item(out, &key.path, &summary(key)))
        })?);
    };
    match explain(key) {
        Ok(Explanation::Key { key, below, also }) => {
            let answer = Answer { below: &below, also_at: &also, ..Answer::of(std::slice::from_ref(&key)) };
            Ok(printing.print(&answer, |out| write_key(out, &key, &below, &also))?)
        }
        Ok(Explanation::Several(keys)) => Ok(printing.print(&Answer::of(&keys), |out| {
            writeln!(out, "{} keys end in `{key}`. `sextant explain` with a whole path explains one.\n", keys.len())?;
            keys.iter().try_for_each(|key| item(out, &key.path, &summary(key)))
        })?),
        Err(error) => {
            let measures = measures(key);
            if measures.is_empty() {
                return Err(refusal(&error));
            }
            let paths: Vec<String> = measures.iter().map(Measure::path).collect();
            let answer = Answer { measures: &paths, ..Answer::of(&[]) };
            Ok(printing.print(&answer, |out| write_measures(out, &measures))?)
        }
    }
}

/// The first sentence about a key, with its unit and its default.
fn summary(key: &KeyReference) -> String {
    let mut text = key.summary().to_owned();
    let unit = key.unit.as_ref().map(|unit| format!("unit {unit}"));
    let default = match (&key.default, key.is_required) {
        (_, true) => Some("required".to_owned()),
        (Some(default), false) if default.len() <= 30 => Some(format!("default {default}")),
        (_, false) => None,
    };
    let notes: Vec<String> = unit.into_iter().chain(default).collect();
    if !notes.is_empty() {
        text += &format!(" ({})", notes.join(", "));
    }
    text
}

fn write_key(out: &mut impl Write, key: &KeyReference, below: &[KeyReference], also: &[String]) -> io::Result<()> {
    writeln!(out, "{}\n", key.path)?;
    Paragraph { indent: "  ", next: "  " }.write(out, &key.description)?;
    writeln!(out)?;
    let mut line = |name: &str, text: &str| {
        Paragraph { indent: &format!("  {name:<10}"), next: "            " }.write(out, text)
    };
    line("type", &key.kind)?;
    if let Some(unit) = &key.unit {
        line("unit", unit)?;
    }
    if let Some(range) = &key.range {
        line("allowed", range)?;
    }
    match (&key.default, key.is_required) {
        (_, true) => line("default", "none: the key is required")?,
        (Some(default), false) => line("default", default)?,
        (None, false) if key.kind == "table" || !key.choices.is_empty() => {}
        (None, false) => line("default", "none: the key may be absent")?,
    }
    for place in also {
        line("also", place)?;
    }
    for (i, text) in key.example().iter().enumerate() {
        line(if i == 0 { "example" } else { "" }, text)?;
    }
    if !key.choices.is_empty() {
        let has_settings = key.choices.iter().any(|choice| choice.has_settings);
        let form = if has_settings { "a name in quotes, or a table with settings" } else { "a name in quotes" };
        writeln!(out, "\nchoices ({form})")?;
        for choice in &key.choices {
            let name = if choice.has_settings { choice.name.clone() } else { format!("\"{}\"", choice.name) };
            item(out, &name, choice.summary())?;
        }
    }
    if !below.is_empty() {
        writeln!(out, "\nkeys")?;
        below.iter().try_for_each(|key| item(out, key.name(), &summary(key)))?;
    }
    let head = key.path.split(['.', '[']).next().unwrap_or_default();
    writeln!(out, "\nMore: `sextant explain {head}` has the whole table, `sextant schema` all keys for editors.")
}

/// The numbers of a summary with this path, or with this part of a path.
fn measures(path: &str) -> Vec<Measure> {
    if let Ok(measure) = path.parse() {
        return vec![measure];
    }
    let path = path.trim();
    if path.len() < 3 {
        return Vec::new();
    }
    all(&Subjects::every("NAME")).into_iter().filter(|measure| measure.path().contains(path)).collect()
}

fn write_measures(out: &mut impl Write, measures: &[Measure]) -> io::Result<()> {
    writeln!(out, "Not a key of a scenario, but of its results: numbers of the summary, and columns of sweeps.\n")?;
    for measure in measures {
        item(
            out,
            &measure.path(),
            &format!("{}; {} (column {})", measure.meaning(), measure.unit().in_words(), measure.column()),
        )?;
    }
    writeln!(
        out,
        "\n`NAME` is the name of a map, of an application or of one of several networks. Where a number does not apply, the summary lacks it."
    )
}

fn refusal(error: &ExplainError) -> Failure {
    let help = match error {
        ExplainError::Malformed { .. } => "for example channel.path_loss, maps.0.algorithm, exponent".to_owned(),
        ExplainError::Unknown { near, .. } if near.is_empty() => {
            "`sextant explain` without a key lists all tables".to_owned()
        }
        ExplainError::Unknown { near, .. } => {
            format!("similar keys: {}", near.iter().map(|key| format!("`{key}`")).collect::<Vec<_>>().join(", "))
        }
    };
    Failure::bad_input_with_help(error.to_string(), help)
}
