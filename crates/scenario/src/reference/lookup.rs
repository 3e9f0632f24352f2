//! Finds a key by its path, or by the end of its path.

use serde_json::Value;

use super::listing::{all_keys, of_choice, of_key, of_view};
use super::view::View;
use super::{KeyReference, path, words};
use crate::document::key_path::{KeyPath, PathStep};
use crate::schema::parsed;

/// What [`explain`] found.
#[derive(Clone, Debug, PartialEq)]
pub enum Explanation {
    /// One key.
    Key {
        /// The key.
        key: Box<KeyReference>,
        /// The keys of its table, if it is one, or of the entries of its list.
        below: Vec<KeyReference>,
        /// The paths of the same key in other tables.
        also: Vec<String>,
    },
    /// Several keys whose paths end so; at least two.
    Several(Vec<KeyReference>),
}

/// Why a key cannot be explained.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ExplainError {
    /// It is not the path of a key.
    #[error("`{key}` is not the path of a key: {message}; allowed: names with dots between them")]
    Malformed {
        /// The path.
        key: String,
        /// What is wrong.
        message: &'static str,
    },
    /// There is no such key.
    #[error("there is no key `{key}` in a scenario")]
    Unknown {
        /// The path.
        key: String,
        /// The paths of keys with similar names, the most similar one first.
        near: Vec<String>,
    },
}

/// Explains the key of this path: `channel.path_loss.log_distance.exponent`, `maps.0.algorithm.ml_tm` (the index may be
/// left out). If a scenario has no such key, the keys whose paths end so are found: `exponent`.
///
/// # Errors
/// If no key of a scenario has that name.
pub fn explain(key: &str) -> Result<Explanation, ExplainError> {
    let (root, all) = (parsed(), all_keys());
    let steps = steps(key)?;
    if let Some(found) = walk(root, &steps) {
        return Ok(found.explanation(all));
    }
    let names: Vec<&str> = steps.iter().filter_map(name).collect();
    let mut found: Vec<KeyReference> =
        all.iter().filter(|known| path::ends_in(&known.path, &names)).cloned().collect();
    if found.is_empty() {
        found = all.iter().filter(|known| chooses(known, &names)).cloned().collect();
    }
    match found.as_slice() {
        [] => Err(ExplainError::Unknown { key: key.to_owned(), near: near(all, &names) }),
        [only] => {
            let steps: Vec<PathStep> = path::parts(&only.path).map(|part| PathStep::Key(part.to_owned())).collect();
            walk(root, &steps)
                .map(|found| found.explanation(all))
                .ok_or_else(|| ExplainError::Unknown { key: key.to_owned(), near: vec![only.path.clone()] })
        }
        _ => Ok(Explanation::Several(found)),
    }
}

/// The steps of a path. `[]` means nothing, and `-` in a name is `_`.
fn steps(key: &str) -> Result<Vec<PathStep>, ExplainError> {
    let path = KeyPath::parse(&key.trim().replace("[]", ""))
        .map_err(|error| ExplainError::Malformed { key: key.to_owned(), message: error.message })?;
    Ok(path.0)
}

fn name(step: &PathStep) -> Option<&str> {
    match step {
        PathStep::Key(name) if step.index().is_none() => Some(name),
        PathStep::Key(_) | PathStep::Index(_) => None,
    }
}

/// Whether the path of `known`, with one of its choices, ends in `names`.
fn chooses(known: &KeyReference, names: &[&str]) -> bool {
    let Some((last, before)) = names.split_last() else { return false };
    path::ends_in(&known.path, before) && known.choices.iter().any(|choice| choice.name == *last)
}

/// A key on the way from the root to it.
struct Found<'a> {
    root: &'a Value,
    key: KeyReference,
    view: View<'a>,
}

/// The key at `steps`. Indices are left out, and a name that is the user's own may be any.
fn walk<'a>(root: &'a Value, steps: &[PathStep]) -> Option<Found<'a>> {
    let view = View::of(root, root);
    let mut found = Found { root, key: of_view("", &view), view };
    for step in steps {
        found = found.step(step)?;
    }
    Some(found).filter(|found| !found.key.path.is_empty())
}

impl<'a> Found<'a> {
    fn step(self, step: &PathStep) -> Option<Self> {
        if let (Some(_), Some(_)) = (self.view.entries, step.index()) {
            return Some(self);
        }
        let PathStep::Key(name) = step else { return None };
        let inside = self.inside();
        let path = inside.key.path.clone();
        if let Some(key) = inside.view.keys.iter().find(|key| same(key.name, name)) {
            let view = View::of(self.root, key.part);
            return Some(Found { root: self.root, key: of_key(&path::below(&path, key.name), key, &view), view });
        }
        if let Some(choice) = inside.view.choices.iter().find(|choice| same(choice.name, name)) {
            let path = path::below(&path, choice.name);
            let view = choice.settings.map(|settings| View::of(self.root, settings)).unwrap_or_default();
            let mut key = of_choice(&path, choice, &view);
            if choice.settings.is_none() {
                key.kind = format!("choice, written as \"{}\"", choice.name);
            }
            return Some(Found { root: self.root, key, view });
        }
        let part = inside.view.by_name?;
        let view = View::of(self.root, part);
        Some(Found { root: self.root, key: of_view(&path::below(&path, "NAME"), &view), view })
    }

    /// The entries of the list, if it is one.
    fn inside(&self) -> Found<'a> {
        match self.view.entries {
            Some(entries) => {
                let view = View::of(self.root, entries);
                Found { root: self.root, key: of_view(&path::entries(&self.key.path), &view), view }
            }
            None => Found { root: self.root, key: self.key.clone(), view: self.view.clone() },
        }
    }

    fn explanation(self, all: &[KeyReference]) -> Explanation {
        let inside = self.inside();
        let below = |key: &super::view::ViewedKey<'_>| {
            of_key(&path::below(&inside.key.path, key.name), key, &View::of(self.root, key.part))
        };
        let below = inside.view.keys.iter().map(below).collect();
        let also = also(all, &self.key.path);
        Explanation::Key { key: Box::new(self.key), below, also }
    }
}

/// Whether `typed` is the name `known`: `-` counts as `_`.
fn same(known: &str, typed: &str) -> bool {
    known == typed || known == typed.replace('-', "_")
}

/// The other places of the key at `path`: those of each table above it that stands in several places.
fn also(all: &[KeyReference], path: &str) -> Vec<String> {
    let mut places = Vec::new();
    for key in all {
        let Some(first) = &key.same_as else { continue };
        let here = if first.ends_with("[]") && key.kind.starts_with("list") {
            path::entries(&key.path)
        } else {
            key.path.clone()
        };
        // Below a list of tables, the keys stand in its entries.
        for (from, to) in [(first.as_str(), here.as_str()), (here.as_str(), first.as_str())] {
            if let Some(rest) = path.strip_prefix(from).filter(|rest| rest.starts_with('.')) {
                places.push(format!("{to}{rest}"));
            }
        }
    }
    places.sort();
    places.dedup();
    places
}

/// The paths of keys with names similar to the last of `names`, the most similar one first.
fn near(all: &[KeyReference], names: &[&str]) -> Vec<String> {
    let Some(last) = names.last() else { return Vec::new() };
    let whole = names.join(".");
    let likeness = |key: &KeyReference| {
        let name = strsim::jaro_winkler(last, key.name());
        let contained = if last.len() > 2 && key.name().contains(last) { 0.95 } else { 0.0 };
        // Of equal names, the one whose path is more like what was typed.
        (name.max(contained), strsim::jaro_winkler(&whole, &key.path))
    };
    let mut scored: Vec<_> =
        all.iter().map(|key| (likeness(key), &key.path)).filter(|((name, _), _)| *name > 0.82).collect();
    scored.sort_by(|((a, path_a), _), ((b, path_b), _)| b.total_cmp(a).then(path_b.total_cmp(path_a)));
    scored.into_iter().take(MOST_NEAR).map(|(_, path)| words::paragraph(path)).collect()
}

/// The most similar keys that are named.
const MOST_NEAR: usize = 6;
