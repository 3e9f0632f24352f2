//! The set-ups of the chapter, their scenarios, and the maps of these.

use super::super::environment::Environment;
use sextant::summary::{MapSummary, Measure, Number};

impl Environment {
    /// The scenario with the maps of other algorithms.
    pub(super) fn comparison(self) -> &'static str {
        match self {
            Self::Warehouse => "mmtm/comparison-warehouse.toml",
            Self::Greenhouse => "mmtm/comparison-greenhouse.toml",
        }
    }
}

/// The path of the robot and its antennas (section 4.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Setup {
    /// A path on the floor or above the plants, with antennas at two elevations.
    Vaa,
    /// The same path, with a beam that is steered through three elevations.
    Vbs,
    /// A path through space.
    Space,
}

impl Setup {
    /// In the order of the thesis.
    pub(super) const ALL: [Self; 3] = [Self::Vaa, Self::Vbs, Self::Space];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Vaa => "VAA",
            Self::Vbs => "VBS",
            Self::Space => "3D",
        }
    }

    /// The scenario in an environment; the robot has 16 sectors.
    pub(super) fn scenario(self, environment: Environment) -> &'static str {
        match (environment, self) {
            (Environment::Warehouse, Self::Vaa) => "mmtm/warehouse-vaa.toml",
            (Environment::Warehouse, Self::Vbs) => "mmtm/warehouse-vbs.toml",
            (Environment::Warehouse, Self::Space) => "mmtm/warehouse-3d.toml",
            (Environment::Greenhouse, Self::Vaa) => "mmtm/greenhouse-vaa.toml",
            (Environment::Greenhouse, Self::Vbs) => "mmtm/greenhouse-vbs.toml",
            (Environment::Greenhouse, Self::Space) => "mmtm/greenhouse-3d.toml",
        }
    }

    /// The sweep of that scenario over the number of sectors of the robot.
    pub(super) fn sweep(self, environment: Environment) -> &'static str {
        match (environment, self) {
            (Environment::Warehouse, Self::Vaa) => "mmtm/sectors-warehouse-vaa.toml",
            (Environment::Warehouse, Self::Vbs) => "mmtm/sectors-warehouse-vbs.toml",
            (Environment::Warehouse, Self::Space) => "mmtm/sectors-warehouse-3d.toml",
            (Environment::Greenhouse, Self::Vaa) => "mmtm/sectors-greenhouse-vaa.toml",
            (Environment::Greenhouse, Self::Vbs) => "mmtm/sectors-greenhouse-vbs.toml",
            (Environment::Greenhouse, Self::Space) => "mmtm/sectors-greenhouse-3d.toml",
        }
    }
}

/// An estimator of positions.
pub(super) struct Estimator {
    pub(super) name: &'static str,
    map: &'static str,
}

impl Estimator {
    pub(super) const fn measure(&self, number: &'static Number<MapSummary>) -> Measure<'static> {
        Measure::OfMap(self.map, number)
    }

    /// Whether it is MmTM as in the thesis.
    pub(super) fn is_of_thesis(&self) -> bool {
        self.map == MMTM.map
    }
}

/// That of the thesis: trapezoid, most likely vertex.
pub(super) const MMTM: Estimator = Estimator { name: "MmTM", map: "mmtm" };

/// MmTM and two of ours: the posterior mean under the same trapezoid, and under a profile that is fitted to the log.
pub(super) const ESTIMATORS: [&Estimator; 3] = [
    &MMTM,
    &Estimator { name: "our posterior mean", map: "posterior-mean" },
    &Estimator { name: "our fitted profile", map: "fitted" },
];

pub(super) const DR_MDS: Estimator = Estimator { name: "DR-MDS", map: "dr-mds" };
pub(super) const NTLDV_HOP: Estimator = Estimator { name: "NTLDV-HOP", map: "ntldv-hop" };
