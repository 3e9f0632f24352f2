//! The maps that the chapter compares.

use sextant::summary::{MapSummary, Measure, Number};

/// A method of mapping a network.
pub(super) struct Method {
    pub(super) name: &'static str,
    map: &'static str,
    /// The equation of the energy of its messages.
    pub(super) equation: &'static str,
}

impl Method {
    pub(super) const fn measure(&self, number: &'static Number<MapSummary>) -> Measure<'static> {
        Measure::OfMap(self.map, number)
    }
}

pub(super) const ML_TM: Method = Method { name: "ML-TM", map: "ml-tm", equation: "eq. 3.17" };
pub(super) const TPM: Method = Method { name: "SVD hop map", map: "tpm", equation: "eq. 3.19" };
pub(super) const RSSI: Method =
    Method { name: "RSSI triangle centroid", map: "rssi-triangle-centroid", equation: "eq. 3.18" };

/// In the order of table 3.6, by increasing published error.
pub(super) const METHODS: [&Method; 3] = [&ML_TM, &TPM, &RSSI];
