//! Errors of mapping.

use sextant_kernel::Interrupted;

/// A length as people write it: a very long or short one with an exponent.
fn plain(length_m: f64) -> String {
    if (1e-6..1e9).contains(&length_m) { length_m.to_string() } else { format!("{length_m:e}") }
}

/// Reasons why a map or a likelihood surface cannot be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MapError {
    /// The part of the lattice that one node may need does not fit into the memory allowed.
    #[error(
        "a grid of {vertices:.3e} vertices {} m apart needs {} MB for one node; allowed: {} MB; \
         a grid_step_m of {} fits{}",
        plain(*step_m), .bytes.div_ceil(1_000_000), .allowed_bytes / 1_000_000, plain(*suggested_step_m),
        .memory_key.map_or(String::new(), |key| format!(", or allow more with {key}"))
    )]
    GridTooLarge {
        /// Vertices of the whole lattice (beyond 2⁵³ rounded).
        vertices: f64,
        /// Memory that the window of one node needs at most (octets).
        bytes: u64,
        /// Memory allowed (octets).
        allowed_bytes: u64,
        /// The step asked for (m).
        step_m: f64,
        /// A step that fits (m).
        suggested_step_m: f64,
        /// The setting that allows more memory, if there is one.
        memory_key: Option<&'static str>,
    },
    /// The log has no stops, so there is no lattice.
    #[error("the log has no stops; a grid needs at least one place where the robot listened")]
    NoStops,
    /// The algorithm needs knowledge that it was not given.
    #[error("`{algorithm}` needs {what}; {remedy}")]
    Missing {
        /// The algorithm.
        algorithm: &'static str,
        /// What it needs.
        what: &'static str,
        /// Where it could come from.
        remedy: &'static str,
    },
    /// A tag was heard by too few receivers.
    #[error(
        "`track` needs readings of at least {needed} receivers at known places, but there are those of {found}; {}",
        if *needed == 2 {
            "receivers without a known place do not count"
        } else {
            "receivers without a known place do not count; with odometry of the robot that carries the tag, 2 are enough"
        }
    )]
    TooFewReceivers {
        /// Receivers at known places that have a reading.
        found: usize,
        /// Receivers needed.
        needed: usize,
    },
    /// The places that nodes can have are known, but the algorithm has no use for them.
    #[error("`{algorithm}` cannot use what is known of the places of nodes; algorithms that can: {known}")]
    UnusedPrior {
        /// The algorithm.
        algorithm: &'static str,
        /// The algorithms that use it.
        known: String,
    },
    /// The algorithm needs all of the log at once, so it cannot map tile by tile.
    #[error(
        "`{algorithm}` cannot map tile by tile, because it needs all nodes at once; algorithms that can: {known}"
    )]
    NotByParts {
        /// The algorithm.
        algorithm: &'static str,
        /// The algorithms that can.
        known: String,
    },
    /// Too few nodes know their place.
    #[error(
        "`{algorithm}` needs at least {needed} anchors, but there are {found}; `anchors` says which nodes they are"
    )]
    TooFewAnchors {
        /// The algorithm.
        algorithm: &'static str,
        /// Anchors found.
        found: usize,
        /// Anchors needed.
        needed: usize,
    },
    /// More memory is needed than allowed. Nothing was allocated.
    #[error(
        "`{algorithm}` needs {} MB for {what}; allowed: {} MB",
        .bytes.div_ceil(1_000_000), .allowed_bytes / 1_000_000
    )]
    TooMuchMemory {
        /// The algorithm.
        algorithm: &'static str,
        /// What the memory is for, with the numbers that make it so large.
        what: String,
        /// Memory needed (octets).
        bytes: u64,
        /// Memory allowed (octets).
        allowed_bytes: u64,
    },
    /// There is no log of a network.
    #[error("the map needs the log of network `{network}`; there are: {known}")]
    NoLog {
        /// The network.
        network: String,
        /// The networks that have a log.
        known: String,
    },
    /// A joint map needs one log for each of its networks.
    #[error("a joint map of {networks} networks was given {logs} logs; allowed: one for each network")]
    Networks {
        /// Networks of the map.
        networks: usize,
        /// Logs given.
        logs: usize,
    },
    /// The networks of a joint map have other nodes.
    #[error("node `{name}` of the log of network `{network}` is not in the log of the first network")]
    OtherNodes {
        /// The network.
        network: String,
        /// The node.
        name: String,
    },
    /// The algorithm works only in the plane.
    #[error("`{0}` is defined in the plane, but the anchors have different heights")]
    PlanarOnly(&'static str),
    /// The log is of one robot, so that there is nothing to stitch.
    #[error(
        "the log is of one robot, {robot}; `stitch` joins the logs of two or more: give the stops a column `robot`, or leave \
         out `stitch`"
    )]
    OneRobot {
        /// Its name.
        robot: String,
    },
    /// The settings name a robot that is not in the log.
    #[error("`stitch.known` has `{name}`, which is no robot of the log; its robots: {known}")]
    NoRobot {
        /// The name.
        name: String,
        /// The robots of the log.
        known: String,
    },
    /// Stitched maps cannot use antenna sectors.
    #[error(
        "the log has antenna sectors, whose directions are those of the world; a map whose robots have frames of their own \
         cannot use them: leave out `stitch`"
    )]
    StitchedSectors,
    /// A node that the log does not have.
    #[error("node {node} is not in the log, which has {nodes} nodes (0 to {})", .nodes.saturating_sub(1))]
    UnknownNode {
        /// The node asked for.
        node: u32,
        /// Number of nodes.
        nodes: usize,
    },
    /// The log and the settings do not agree.
    #[error("{0}")]
    Log(#[from] sextant_channel::LogError),
    /// The work was ended from outside.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
    /// The node has no likelihood, because it was never heard, or was heard only where no grid vertex is in range.
    #[error("node `{name}` cannot be placed: it was never heard within range of the grid")]
    NotHeard {
        /// Name of the node.
        name: String,
    },
}
