//! A summary, read by path.

use std::collections::BTreeMap;

use serde_json::Value;

use super::derived::{self, Derived};
use super::measure::{Measure, Of};
use crate::summary::Summary;

/// The numbers of a summary, of its maps and of its applications.
#[derive(Clone, Debug)]
pub struct Numbers(BTreeMap<Of, (Value, Derived)>);

impl Numbers {
    /// Those of `summary`. Of several maps or applications of one name, the first counts.
    ///
    /// # Panics
    /// Never for a summary that this program makes: it can be written as JSON.
    #[must_use]
    pub fn of(summary: &Summary) -> Self {
        let mut tree = serde_json::to_value(summary).expect("a summary is JSON");
        let maps = summary
            .maps
            .iter()
            .map(|map| (Of::Map(map.name.as_ref().unwrap_or(&map.algorithm).clone()), derived::of_map(map)));
        let applications = summary
            .applications
            .iter()
            .map(|application| (Of::Mission(application.name.clone()), derived::of_mission(application)));
        let mut numbers = BTreeMap::new();
        let networks = list(&mut tree, "other_networks").into_iter().chain(tree.get("mac").cloned());
        for network in networks.collect::<Vec<_>>() {
            if let Some(name) = network.get("network").and_then(Value::as_str) {
                numbers.insert(Of::Network(name.to_owned()), (network.clone(), Derived::new()));
            }
        }
        let parts = list(&mut tree, "maps").into_iter().zip(maps);
        for (part, (of, derived)) in parts.chain(list(&mut tree, "applications").into_iter().zip(applications)) {
            numbers.entry(of).or_insert((part, derived));
        }
        numbers.insert(Of::Run, (tree, Derived::new()));
        Self(numbers)
    }

    /// The value of a measure; `None` if it does not apply.
    #[must_use]
    pub fn get(&self, measure: &Measure) -> Option<f64> {
        let (tree, derived) = self.0.get(measure.of())?;
        let path = measure.path_within();
        let value = derived.get(path).copied().or_else(|| number(found(tree, path)?));
        value.filter(|value| value.is_finite())
    }
}

/// Takes the list `key` out of an object.
fn list(object: &mut Value, key: &str) -> Vec<Value> {
    match object.get_mut(key).map(Value::take) {
        Some(Value::Array(parts)) => parts,
        _ => Vec::new(),
    }
}

/// What a path leads to; a step is a key, or the index of an entry of a list.
fn found<'a>(value: &'a Value, path: &str) -> Option<&'a Value> {
    path.split('.').try_fold(value, |value, step| match value {
        Value::Array(entries) => entries.get(step.parse::<usize>().ok()?),
        _ => value.get(step),
    })
}

/// A number; 1 for yes and 0 for no; of a list, how many entries it has.
fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Number(number) => number.as_f64(),
        Value::Bool(is) => Some(f64::from(u8::from(*is))),
        Value::Array(entries) => Some(entries.len() as f64),
        _ => None,
    }
}
