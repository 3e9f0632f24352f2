//! How nodes computed a map themselves, and what it took.

use serde::Serialize;

use sextant_kernel::text::counted;

/// How nodes computed a map themselves, and what it took.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct DistributedSummary {
    /// The last iteration in which a node changed its place or became an anchor.
    pub iterations: u32,
    /// Whether all was settled at the end: no placed node had bad coordinates, and if nodes were left without a place, the
    /// last iteration that was allowed changed nothing.
    pub converged: bool,
    /// Placed nodes with bad coordinates: too many of their neighbours lie beyond the radius of communication. Nodes that
    /// died do not count.
    pub bad: usize,
    /// Names of the nodes without a place.
    pub unplaced: Vec<String>,
    /// The anchors.
    pub anchors: AnchorCounts,
    /// Azimuths of the antennas of the anchors that worked them out, compared with the truth (degrees). Absent if there
    /// are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub orientation_error_deg: Option<OrientationErrorSummary>,
    /// The messages of the nodes.
    pub messages: MessagesSummary,
    /// Mean number of frames that a node received; with sectors, one for each sector of the sender that it heard.
    pub frames_received_mean: f64,
    /// The mobile anchors, if there are any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mobile: Option<MobileAnchorsSummary>,
    /// Mean number of grid vertices whose likelihood a node computed, over the nodes that computed a place.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub vertices_mean: Option<f64>,
    /// Largest of these numbers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub vertices_max: Option<u64>,
    /// Memory of a node for its largest grid and its tables of neighbours (octets).
    pub memory_octets: MeanAndMax,
    /// Nodes that computed a place, in bins of the error of neighbour scattering: upper edge of the bin, number of nodes, and
    /// mean and 90th percentile of their position errors (m). A bin has its upper edge, the first one 0 too.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub scattering: Vec<(f64, usize, f64, f64)>,
    /// The same over the true neighbours within `metrics.scattering_neighbourhood_m`, of which the share counts that the
    /// map has farther away than that. The edges are 0.05, 0.1, 0.2, 0.4 and 1.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub near_scattering: Vec<(f64, usize, f64, f64)>,
    /// Energy of the simulated radio of a node (J).
    pub radio_energy_j: MeanAndMax,
}

impl DistributedSummary {
    /// Why it did not converge, in words; `interrupted` tells whether the user ended it.
    #[must_use]
    pub fn unsettled(&self, interrupted: bool) -> String {
        if interrupted {
            return format!("interrupted after {}", counted(self.iterations as usize, "iteration"));
        }
        let (bad, unplaced) = (counted(self.bad, "node"), counted(self.unplaced.len(), "node"));
        let advice = if self.unplaced.is_empty() {
            "more iterations or more anchors may settle them"
        } else {
            "more anchors near them, or more iterations, may give them one"
        };
        format!("did not converge: {bad} with bad coordinates and {unplaced} without a place at the end; {advice}")
    }
}

/// Numbers of anchors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct AnchorCounts {
    /// Nodes that knew their place.
    pub initial: usize,
    /// Of these, those that gave up their place, because the bearings to others contradict it.
    pub gave_up: usize,
    /// Nodes that became anchors.
    pub new: usize,
    /// Anchors, initial or new, that did not work out the directions of their sectors, because no anchor reported that it
    /// had heard them, or the map was complete before. Absent without sectors.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub without_directions: Option<usize>,
}

/// Errors of azimuths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct OrientationErrorSummary {
    /// Mean (degrees).
    pub mean: f64,
    /// 90th percentile (degrees).
    pub p90: f64,
}

/// The messages that nodes sent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct MessagesSummary {
    /// PLACE: an anchor asks other anchors in which of its sectors they hear it.
    pub place: u64,
    /// REPORT: the answers of anchors.
    pub report: u64,
    /// BEACON: an anchor tells its place and the directions of its sectors.
    pub beacon: u64,
    /// COORDINATES: a node tells where it believes to be.
    pub coordinates: u64,
    /// Octets of all of them, repeats and headers of frames not counted.
    pub octets: u64,
    /// Mean number of messages of a node, of all kinds, repeats not counted.
    pub mean_per_node: f64,
    /// Frames with messages that were sent, each repeat counted.
    pub sent: u64,
    /// Messages that were never sent because the queue of the link was full.
    pub lost_queue: u64,
}

/// The mobile anchors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct MobileAnchorsSummary {
    /// Share of the nodes that heard a mobile anchor, 0 to 1 (thesis: N_R / N).
    pub heard_share: f64,
    /// Stops of all mobile anchors.
    pub stops: usize,
    /// Mean number of stops at which a node heard a mobile anchor.
    pub stops_heard_mean: f64,
    /// Length of the paths of all mobile anchors (m).
    pub path_length_m: f64,
}

/// Mean and maximum over the nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct MeanAndMax {
    /// Mean.
    pub mean: f64,
    /// Maximum.
    pub max: f64,
}

impl MeanAndMax {
    /// Of these values; 0 without values.
    pub fn of(values: impl Iterator<Item = f64>) -> Self {
        let (mut count, mut sum, mut max) = (0.0, 0.0, 0.0);
        for value in values {
            count += 1.0;
            sum += value;
            max = f64::max(max, value);
        }
        Self { mean: if count > 0.0 { sum / count } else { 0.0 }, max }
    }
}
