//! The maps of the chapter, and their scenarios.

use super::super::claim::{Check, Claim};
use super::super::environment::Environment;
use super::super::published::Published;
use super::super::runs::Term;
use sextant::summary::{MapSummary, Measure, Number};

/// A kind of map, with its scenario in each environment.
pub(super) struct Subject {
    pub(super) name: &'static str,
    map: &'static str,
    warehouse: &'static str,
    greenhouse: &'static str,
}

impl Subject {
    pub(super) fn scenario(&self, environment: Environment) -> &'static str {
        match environment {
            Environment::Warehouse => self.warehouse,
            Environment::Greenhouse => self.greenhouse,
        }
    }

    /// A number of the map, in a scenario without a sweep.
    pub(super) fn term(&self, environment: Environment, number: &'static Number<MapSummary>) -> Term {
        Term::new(self.scenario(environment), Measure::OfMap(self.map, number))
    }

    /// A number of the map in the cell of a sweep where the setting `key` is `value`.
    pub(super) fn at(
        &self,
        environment: Environment,
        (key, value): (&'static str, &str),
        number: &'static Number<MapSummary>,
    ) -> Term {
        Term { settings: vec![(key, value.to_owned())], ..self.term(environment, number) }
    }
}

/// The setting of the share of initial anchors (thesis: N_A / N).
pub(super) const SHARE: &str = "anchors.share";

/// First places, over the share of initial anchors.
pub(super) const FIRST: Subject = Subject {
    name: "first places",
    map: "dmmtm-ss",
    warehouse: "dmtm/scattering-warehouse.toml",
    greenhouse: "dmtm/scattering-greenhouse.toml",
};

/// DMmTM-SS over the share of initial anchors.
pub(super) const SS: Subject = Subject {
    name: "DMmTM-SS",
    map: "dmmtm-ss",
    warehouse: "dmtm/anchors-ss-warehouse.toml",
    greenhouse: "dmtm/anchors-ss-greenhouse.toml",
};

/// The same with our estimates of directions and places.
pub(super) const IMPROVED: Subject = Subject {
    name: "ours",
    map: "dmmtm-ss",
    warehouse: "dmtm/anchors-improved-warehouse.toml",
    greenhouse: "dmtm/anchors-improved-greenhouse.toml",
};

/// DMmTM-HS over the time of the mobile anchor.
pub(super) const HS_BY_TIME: Subject = Subject {
    name: "DMmTM-HS",
    map: "dmmtm-hs",
    warehouse: "dmtm/heard-warehouse.toml",
    greenhouse: "dmtm/heard-greenhouse.toml",
};

/// DMmTM-HS over the share of initial anchors.
pub(super) const HS: Subject = Subject {
    name: "DMmTM-HS",
    map: "dmmtm-hs",
    warehouse: "dmtm/anchors-hs-warehouse.toml",
    greenhouse: "dmtm/anchors-hs-greenhouse.toml",
};

/// DMmTM-SS with 35 % anchors.
pub(super) const SS_35: Subject = Subject {
    name: "DMmTM-SS",
    map: "dmmtm-ss",
    warehouse: "dmtm/comparison-warehouse.toml",
    greenhouse: "dmtm/comparison-greenhouse.toml",
};

/// DR-MDS with the same anchors.
pub(super) const DR_MDS: Subject = Subject { name: "DR-MDS", map: "dr-mds", ..SS_35 };

/// NTLDV-HOP with the same anchors.
pub(super) const NTLDV_HOP: Subject = Subject { name: "NTLDV-HOP", map: "ntldv-hop", ..SS_35 };

/// DMmTM-HS with 15 % anchors, with about 0.6 of the nodes in reach of the mobile anchor.
pub(super) const HS_15: Subject = Subject {
    name: "DMmTM-HS",
    map: "dmmtm-hs",
    warehouse: "dmtm/hs-warehouse.toml",
    greenhouse: "dmtm/hs-greenhouse.toml",
};

/// MmTM with the path through space.
pub(super) const MMTM: Subject = Subject {
    name: "MmTM",
    map: "mmtm",
    warehouse: "dmtm/mmtm-warehouse.toml",
    greenhouse: "dmtm/mmtm-greenhouse.toml",
};

/// A conclusion of the thesis about an environment.
pub(super) fn claim(
    environment: Environment,
    text: &str,
    (value, section): (&str, &'static str),
    check: Check,
) -> Claim {
    let text = format!("{}: {text}", environment.name());
    Claim { text, published: Some(Published::new(value, section)), check }
}
