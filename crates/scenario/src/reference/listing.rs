//! All keys of a scenario, in order.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use serde_json::Value;

use super::view::{View, ViewedChoice, ViewedKey};
use super::{Choice, KeyReference, path, words};
use crate::schema::parsed;
use crate::unit;

/// All keys of a scenario: those of a table after the table, and the tables of a choice after the choice. Keys that stand
/// in several places are listed in the first one; the others name it in [`same_as`](KeyReference::same_as).
#[must_use]
pub fn key_reference() -> Vec<KeyReference> {
    all_keys().to_vec()
}

/// The same, listed once and borrowed.
pub(super) fn all_keys() -> &'static [KeyReference] {
    static KEYS: LazyLock<Vec<KeyReference>> = LazyLock::new(|| {
        let root = parsed();
        let mut listing = Listing { root, keys: Vec::new(), listed: BTreeMap::new() };
        listing.below("", &View::of(root, root));
        listing.keys
    });
    &KEYS
}

/// The keys listed so far.
struct Listing<'a> {
    root: &'a Value,
    keys: Vec<KeyReference>,
    /// Where the keys of each definition are listed.
    listed: BTreeMap<&'a str, String>,
}

impl<'a> Listing<'a> {
    /// Lists what stands below the table, the list or the choice at `path`.
    fn below(&mut self, path: &str, view: &View<'a>) {
        for key in &view.keys {
            let path = path::below(path, key.name);
            let viewed = View::of(self.root, key.part);
            self.add(of_key(&path, key, &viewed), &viewed);
        }
        for choice in &view.choices {
            let Some(settings) = choice.settings else { continue };
            let path = path::below(path, choice.name);
            let viewed = View::of(self.root, settings);
            self.add(of_choice(&path, choice, &viewed), &viewed);
        }
        if let Some(entries) = view.entries {
            self.inside(&path::entries(path), entries);
        }
        if let Some(part) = view.by_name {
            self.inside(&path::below(path, "NAME"), part);
        }
    }

    /// Adds a key, and what stands below it unless that is listed already.
    fn add(&mut self, key: KeyReference, view: &View<'a>) {
        let path = key.path.clone();
        self.keys.push(key);
        self.inside_view(&path, view);
    }

    fn inside(&mut self, path: &str, part: &'a Value) {
        let view = View::of(self.root, part);
        self.inside_view(path, &view);
    }

    fn inside_view(&mut self, path: &str, view: &View<'a>) {
        if let Some(definition) = view.definition.filter(|_| view.is_table()) {
            if let Some(first) = self.listed.get(definition) {
                if let Some(last) = self.keys.last_mut() {
                    last.same_as = Some(first.clone());
                }
                return;
            }
            self.listed.insert(definition, path.to_owned());
        }
        self.below(path, view);
    }
}

/// The key of a table.
pub(super) fn of_key(path: &str, key: &ViewedKey<'_>, view: &View<'_>) -> KeyReference {
    let default = words::toml(&key.part["default"]);
    let unit = unit::of(key.name).map(str::to_owned);
    KeyReference { default, unit, is_required: key.is_required, ..of_view(path, view) }
}

/// The table of one of several choices.
pub(super) fn of_choice(path: &str, choice: &ViewedChoice<'_>, view: &View<'_>) -> KeyReference {
    let unit = unit::of(choice.name).filter(|_| !view.is_table()).map(str::to_owned);
    let reference = of_view(path, view);
    let description = match words::paragraph(choice.description) {
        text if text.is_empty() => reference.description,
        text => text,
    };
    KeyReference { unit, description, ..reference }
}

/// What the schema says about the part at `path` itself.
pub(super) fn of_view(path: &str, view: &View<'_>) -> KeyReference {
    let choice = |choice: &ViewedChoice<'_>| Choice {
        name: choice.name.to_owned(),
        description: words::paragraph(choice.description),
        has_settings: choice.settings.is_some(),
    };
    KeyReference {
        path: path.to_owned(),
        kind: view.kind(),
        unit: None,
        range: view.range(),
        default: None,
        is_required: false,
        choices: view.choices.iter().map(choice).collect(),
        description: words::paragraph(view.description),
        same_as: None,
    }
}
