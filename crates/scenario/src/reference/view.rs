//! One part of a JSON schema as a person sees it: references followed, alternatives gathered.

use serde_json::Value;

use super::words::{TRUTH, plural, range};

/// The most references and alternatives to follow from one part; more would be a circle.
const DEEPEST: usize = 16;

/// What a part of a schema allows.
#[derive(Clone, Debug, Default)]
pub(super) struct View<'a> {
    /// What it means, as the part itself says.
    pub(super) description: &'a str,
    /// The name of the definition that it refers to, if it does.
    pub(super) definition: Option<&'a str>,
    /// The keys of the table that it may be.
    pub(super) keys: Vec<ViewedKey<'a>>,
    /// What may be chosen.
    pub(super) choices: Vec<ViewedChoice<'a>>,
    /// The entries of the list that it may be.
    pub(super) entries: Option<&'a Value>,
    /// What stands under each name, if the names are the user's own.
    pub(super) by_name: Option<&'a Value>,
    kinds: Vec<String>,
    least: Option<(f64, bool)>,
    most: Option<(f64, bool)>,
}

/// A key of a table.
#[derive(Clone, Copy, Debug)]
pub(super) struct ViewedKey<'a> {
    pub(super) name: &'a str,
    pub(super) part: &'a Value,
    pub(super) is_required: bool,
}

/// One of several choices.
#[derive(Clone, Copy, Debug)]
pub(super) struct ViewedChoice<'a> {
    pub(super) name: &'a str,
    pub(super) description: &'a str,
    /// Its settings, if it is written as a table.
    pub(super) settings: Option<&'a Value>,
}

impl<'a> View<'a> {
    /// The view of `part` of the schema `root`.
    pub(super) fn of(root: &'a Value, part: &'a Value) -> Self {
        let mut view = Self { description: text(part, "description"), ..Self::default() };
        view.gather(root, part, DEEPEST);
        view
    }

    /// What it is, in words.
    pub(super) fn kind(&self) -> String {
        match self.kinds.as_slice() {
            [] => "any value".to_owned(),
            kinds => kinds.join(" or "),
        }
    }

    /// The numbers allowed.
    pub(super) fn range(&self) -> Option<String> {
        range(self.least, self.most)
    }

    /// Whether keys stand below it.
    pub(super) fn is_table(&self) -> bool {
        !self.keys.is_empty() || self.choices.iter().any(|choice| choice.settings.is_some())
    }

    fn gather(&mut self, root: &'a Value, part: &'a Value, depth: usize) {
        let Some(deeper) = depth.checked_sub(1) else { return };
        if let Some(name) = part["$ref"].as_str().and_then(|reference| reference.strip_prefix("#/$defs/")) {
            self.definition = self.definition.or(Some(name));
            if self.description.is_empty() {
                self.description = text(&root["$defs"][name], "description");
            }
            self.gather(root, &root["$defs"][name], deeper);
        }
        self.bound(part);
        if let Some(keys) = part["properties"].as_object() {
            self.is("table");
            let required = required(part);
            let key = |(name, part): (&'a String, &'a Value)| {
                let is_required = required.contains(&name.as_str());
                ViewedKey { name, part, is_required }
            };
            self.keys.extend(keys.iter().map(key));
            return;
        }
        for alternatives in ["oneOf", "anyOf", "allOf"] {
            for alternative in part[alternatives].as_array().into_iter().flatten() {
                self.alternative(root, alternative, deeper);
            }
        }
        for name in part["enum"].as_array().into_iter().flatten().filter_map(Value::as_str) {
            self.choose(ViewedChoice { name, description: "", settings: None });
        }
        if let Some(name) = part["const"].as_str() {
            self.choose(ViewedChoice { name, description: text(part, "description"), settings: None });
        } else if part.get("enum").is_none() {
            for kind in types(part) {
                self.of_type(root, part, kind, deeper);
            }
        }
    }

    /// One of several alternatives: a choice with settings is a table with one key, which is required.
    fn alternative(&mut self, root: &'a Value, part: &'a Value, depth: usize) {
        let only = part["properties"].as_object().filter(|keys| keys.len() == 1 && required(part).len() == 1);
        match only.and_then(|keys| keys.iter().next()) {
            Some((name, settings)) => {
                let description = text(part, "description");
                // An empty table says no more than the name.
                let settings = Some(settings).filter(|settings| !is_empty_table(settings));
                self.choose(ViewedChoice { name, description, settings });
            }
            None => self.gather(root, part, depth),
        }
    }

    fn choose(&mut self, choice: ViewedChoice<'a>) {
        self.is("choice");
        // A choice that may be written as a text and as a table is one choice.
        match self.choices.iter_mut().find(|known| known.name == choice.name) {
            Some(known) => {
                known.settings = known.settings.or(choice.settings);
                if known.description.is_empty() {
                    known.description = choice.description;
                }
            }
            None => self.choices.push(choice),
        }
    }

    fn of_type(&mut self, root: &'a Value, part: &'a Value, kind: &str, depth: usize) {
        match kind {
            "number" => self.is("number"),
            "integer" => self.is("whole number"),
            "boolean" => self.is(TRUTH),
            "string" => self.is("text"),
            "array" => {
                self.entries = Some(&part["items"]);
                let mut entry = View::default();
                entry.gather(root, &part["items"], depth);
                let what = plural(&entry.kind());
                let count = |key: &str| part[key].as_u64();
                self.is(&match (count("minItems"), count("maxItems")) {
                    (Some(least), Some(most)) if least == most => format!("list of {least} {what}"),
                    (Some(least), Some(most)) if least + 1 == most => format!("list of {least} or {most} {what}"),
                    (Some(least), Some(most)) => format!("list of {least} to {most} {what}"),
                    (Some(least), None) if least > 0 => format!("list of at least {least} {what}"),
                    _ => format!("list of {what}"),
                });
            }
            "object" => {
                self.is("table");
                self.by_name = Some(&part["additionalProperties"]).filter(|names| names.is_object());
            }
            _ => {}
        }
    }

    fn is(&mut self, kind: &str) {
        if !self.kinds.iter().any(|known| known == kind) {
            self.kinds.push(kind.to_owned());
        }
    }

    fn bound(&mut self, part: &Value) {
        let bound = |plain: &str, open: &str| match (part[plain].as_f64(), part[open].as_f64()) {
            (_, Some(value)) => Some((value, true)),
            (Some(value), None) => Some((value, false)),
            (None, None) => None,
        };
        self.least = self.least.or(bound("minimum", "exclusiveMinimum"));
        self.most = self.most.or(bound("maximum", "exclusiveMaximum"));
    }
}

/// The text under `key`; empty if there is none.
fn text<'a>(part: &'a Value, key: &str) -> &'a str {
    part[key].as_str().unwrap_or_default()
}

/// The keys that a table needs. A scenario needs its own, or one that it extends.
fn required(part: &Value) -> Vec<&str> {
    let first = &part["anyOf"][0]["required"];
    let keys = part["required"].as_array().or_else(|| first.as_array());
    keys.into_iter().flatten().filter_map(Value::as_str).collect()
}

/// Whether a part is a table without keys.
fn is_empty_table(part: &Value) -> bool {
    part["type"] == "object"
        && part["additionalProperties"] == Value::Bool(false)
        && part["properties"].as_object().is_none_or(serde_json::Map::is_empty)
}

/// The types of a part, without null.
fn types(part: &Value) -> impl Iterator<Item = &str> {
    let (one, several) = (part["type"].as_str(), part["type"].as_array());
    one.into_iter().chain(several.into_iter().flatten().filter_map(Value::as_str)).filter(|kind| *kind != "null")
}
