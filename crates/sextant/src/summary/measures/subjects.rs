//! What a run has numbers of.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// What a run has numbers of.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Subjects {
    /// Names of its networks, if it has several.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub networks: Vec<String>,
    /// Names of its maps.
    pub maps: Vec<String>,
    /// Names of those that nodes compute.
    pub by_nodes: Vec<String>,
    /// Names of its applications.
    pub applications: Vec<String>,
    /// Names of those that search targets.
    pub searches: Vec<String>,
    /// Names of those whose robots keep a link.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub keep_links: Vec<String>,
    /// What else it has; in a file, each is a key that is true.
    #[serde(flatten, serialize_with = "write_flags", deserialize_with = "read_flags")]
    pub features: BTreeSet<Feature>,
}

/// What a run may have besides maps and applications.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Feature {
    /// Packets go over several hops.
    #[serde(rename = "has_routing")]
    Routing,
    /// They go down from a sink too.
    #[serde(rename = "has_way_down")]
    WayDown,
    /// Their tree is built by RPL.
    #[serde(rename = "has_rpl")]
    Rpl,
    /// They go in fragments.
    #[serde(rename = "has_fragments")]
    Fragments,
    /// The first network has slots.
    #[serde(rename = "has_slots")]
    Slots,
    /// Its stations agree on cells.
    #[serde(rename = "has_negotiated_cells")]
    NegotiatedCells,
    /// Nodes have batteries.
    #[serde(rename = "has_batteries")]
    Batteries,
    /// Stations of the first network sleep between checks of the channel.
    #[serde(rename = "has_sleep")]
    Sleep,
    /// It has no networks with names, or one.
    #[serde(rename = "has_single_network")]
    SingleNetwork,
}

impl Feature {
    /// All of them, in the order of their columns.
    pub const ALL: [Self; 9] = [
        Self::Slots,
        Self::NegotiatedCells,
        Self::Sleep,
        Self::Routing,
        Self::WayDown,
        Self::Fragments,
        Self::Rpl,
        Self::Batteries,
        Self::SingleNetwork,
    ];
}

fn write_flags<S: Serializer>(features: &BTreeSet<Feature>, to: S) -> Result<S::Ok, S::Error> {
    to.collect_map(features.iter().map(|feature| (feature, true)))
}

fn read_flags<'de, D: Deserializer<'de>>(from: D) -> Result<BTreeSet<Feature>, D::Error> {
    let flags = BTreeMap::<Feature, bool>::deserialize(from)?;
    Ok(flags.into_iter().filter_map(|(feature, is_there)| is_there.then_some(feature)).collect())
}

impl Subjects {
    /// A run that has everything, each of it by this name.
    #[must_use]
    pub fn every(name: &str) -> Self {
        let names = || vec![name.to_owned()];
        Self {
            networks: names(),
            maps: names(),
            by_nodes: names(),
            applications: names(),
            searches: names(),
            keep_links: names(),
            features: Feature::ALL.into(),
        }
    }

    /// Adds the names of others that are new, in their order.
    pub fn extend(&mut self, others: &Self) {
        let Self { networks, maps, by_nodes, applications, searches, keep_links, features } = self;
        features.extend(&others.features);
        for (list, names) in [
            (networks, &others.networks),
            (maps, &others.maps),
            (by_nodes, &others.by_nodes),
            (applications, &others.applications),
            (searches, &others.searches),
            (keep_links, &others.keep_links),
        ] {
            for name in names {
                if !list.contains(name) {
                    list.push(name.clone());
                }
            }
        }
    }

    /// Whether it has all of these others.
    #[must_use]
    pub fn has(&self, others: &Self) -> bool {
        let mut all = self.clone();
        all.extend(others);
        all == *self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_run_has_is_a_key_that_is_true_and_nothing_otherwise() {
        let lists = r#""maps":["a"],"by_nodes":["a"],"applications":["a"],"searches":["a"]"#;
        let flags = [
            "routing",
            "way_down",
            "rpl",
            "fragments",
            "slots",
            "negotiated_cells",
            "batteries",
            "sleep",
            "single_network",
        ];
        let flags = flags.map(|flag| format!(r#""has_{flag}":true"#)).join(",");
        let every = Subjects::every("a");
        let few =
            Subjects { networks: Vec::new(), keep_links: Vec::new(), features: BTreeSet::new(), ..every.clone() };
        for (subjects, text) in [
            (&every, format!(r#"{{"networks":["a"],{lists},"keep_links":["a"],{flags}}}"#)),
            (&few, format!("{{{lists}}}")),
        ] {
            assert_eq!(serde_json::to_string(subjects).unwrap(), text);
            assert_eq!(&serde_json::from_str::<Subjects>(&text).unwrap(), subjects);
        }
        assert!(every.has(&few) && !few.has(&every));
    }
}
