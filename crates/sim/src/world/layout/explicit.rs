//! Nodes at listed places.

use std::collections::BTreeMap;
use std::iter::repeat;

use serde::{Deserialize, Serialize};
use sextant_channel::{ObstacleField, Position, Storeys};
use sextant_kernel::SettingError;
use sextant_kernel::text::counted;

use super::placed::{PlacedNode, twin};

/// Nodes at listed places, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ExplicitConfig {
    /// The places, each `[x, y]` or `[x, y, z]` (m).
    pub positions_m: Vec<Position>,
    /// Their names, in the same order; `n0`, `n1` and so on if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub names: Option<Vec<String>>,
    /// Names of the nodes in each storey: their heights are above its floor. Those of all others are above zero.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = {})))]
    pub storeys: BTreeMap<String, Vec<String>>,
}

impl ExplicitConfig {
    /// The same nodes with heights from zero.
    pub(super) fn above_zero(&self, storeys: &Storeys) -> Result<Self, SettingError> {
        let mut made = Self { storeys: BTreeMap::new(), ..self.clone() };
        if self.storeys.is_empty() {
            return Ok(made);
        }
        let mut storey_of: BTreeMap<String, Option<&str>> = self.all_names().into_iter().zip(repeat(None)).collect();
        for (storey, nodes) in &self.storeys {
            let floor_m = storeys.floor_m("storeys", Some(storey))?;
            for (i, node) in nodes.iter().enumerate() {
                let refused =
                    |found, allowed: &str| SettingError::new(format!("storeys.{storey}[{i}]"), found, allowed);
                match storey_of.get_mut(node) {
                    Some(of) => {
                        if let Some(other) = of.replace(storey) {
                            let found = format!("`{node}`, which is in `{other}`");
                            return Err(refused(found, "a node that no storey has yet"));
                        }
                    }
                    None => return Err(refused(format!("`{node}`"), "the name of a node")),
                }
            }
            let is_in = |name: &String| nodes.contains(name);
            let places = self.all_names().into_iter().zip(&mut made.positions_m);
            places.filter(|(name, _)| is_in(name)).for_each(|(_, place)| place.z_m += floor_m);
        }
        Ok(made)
    }

    /// Names of all nodes, as far as they are given, in the order listed.
    fn all_names(&self) -> Vec<String> {
        let usual = || (0..self.positions_m.len()).map(|i| format!("n{i}")).collect();
        self.names.clone().unwrap_or_else(usual)
    }

    /// The nodes, in the order listed.
    pub(super) fn place(&self, obstacles: &ObstacleField) -> Result<Vec<PlacedNode>, SettingError> {
        if self.positions_m.is_empty() {
            return Err(SettingError::new("positions_m", "an empty list", "at least one place"));
        }
        let mut faults =
            (self.positions_m.iter().enumerate()).filter_map(|(i, &position)| Some((i, obstacles.fault(position)?)));
        if let Some((i, (found, allowed))) = faults.next() {
            // An obstacle in the wrong place is one mistake, however many nodes it covers.
            return Err(match faults.count() {
                0 => SettingError::new(format!("positions_m[{i}]"), found, allowed),
                others => {
                    let found =
                        format!("a list whose entry {i} is {found}, and {} as wrong", counted(others, "other"));
                    SettingError::new("positions_m", found, allowed)
                }
            });
        }
        let names = match &self.names {
            Some(names) => self.checked(names)?.to_vec(),
            None => self.all_names(),
        };
        let named = names.into_iter().zip(&self.positions_m);
        Ok(named.map(|(name, &position)| PlacedNode { name, position }).collect())
    }

    fn checked<'a>(&self, names: &'a [String]) -> Result<&'a [String], SettingError> {
        let wanted = self.positions_m.len();
        if names.len() != wanted {
            let found = format!("a list of {} names", names.len());
            return Err(SettingError::new("names", found, format!("{wanted} names, one for each place")));
        }
        if let Some(i) = names.iter().position(|name| name.trim().is_empty()) {
            return Err(SettingError::new(
                format!("names[{i}]"),
                "empty",
                "a name with at least one letter or digit",
            ));
        }
        if let Some((before, i)) = twin(names.iter().map(String::as_str)) {
            let found = format!("`{}`, as names[{before}]", names[i]);
            return Err(SettingError::new(format!("names[{i}]"), found, "a name that no other node has"));
        }
        Ok(names)
    }
}
