//! What is wrong with a reception log.

/// Why a reception log is invalid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LogError {
    /// A reception names a node that the log does not have.
    #[error("a reception names node {node}, but the log has {nodes} nodes (0 to {})", .nodes.saturating_sub(1))]
    UnknownNode {
        /// The node named.
        node: u32,
        /// Number of nodes.
        nodes: usize,
    },
    /// A reception names a stop that the log does not have.
    #[error("a reception of node `{node}` names stop {stop}, but the log has {stops} stops (0 to {})", .stops.saturating_sub(1))]
    UnknownStop {
        /// Name of the node.
        node: String,
        /// The stop named.
        stop: u32,
        /// Number of stops.
        stops: usize,
    },
    /// More packets received than sent.
    #[error("node `{node}` at stop {stop}: {received} packets received of {sent} sent; allowed: 0 to {sent}")]
    MoreThanSent {
        /// Name of the node.
        node: String,
        /// Index of the stop.
        stop: u32,
        /// Packets received.
        received: u32,
        /// Packets sent.
        sent: u32,
    },
    /// Two receptions of one node at one stop.
    #[error("node `{node}` at stop {stop} appears twice; give one reception per node and stop")]
    Twice {
        /// Name of the node.
        node: String,
        /// Index of the stop.
        stop: u32,
    },
    /// A stop or a contact of a robot that the log does not have.
    #[error("a stop or contact is of robot {robot}, but the log has {robots} robots (0 to {})", .robots.saturating_sub(1))]
    UnknownRobot {
        /// The robot named.
        robot: u32,
        /// Number of robots.
        robots: usize,
    },
    /// A reception in a sector that the listener does not have.
    #[error("node `{node}` at stop {stop} was heard in sector {sector}; the listener's sectors are {known}")]
    UnknownSector {
        /// Name of the node.
        node: String,
        /// Index of the stop.
        stop: u32,
        /// The sector named.
        sector: u8,
        /// The sectors of the listener.
        known: String,
    },
    /// A stop with invalid coordinates.
    #[error("stop {stop} is at ({x_m}, {y_m}, {z_m}); coordinates are metres, at most 10⁹ from zero")]
    NotFinite {
        /// Index of the stop.
        stop: usize,
        /// East (m).
        x_m: f64,
        /// North (m).
        y_m: f64,
        /// Up (m).
        z_m: f64,
    },
    /// A heading that is not a number.
    #[error("the heading at stop {stop} is {heading_rad} rad; allowed: finite numbers")]
    HeadingNotFinite {
        /// Index of the stop.
        stop: usize,
        /// The value found (rad).
        heading_rad: f64,
    },
    /// Signal-to-noise ratios of a node that was not heard there.
    #[error(
        "node `{node}` at stop {stop} has SNRs of sectors, but no packet of it was received there; \
         allowed: SNRs of nodes that were heard"
    )]
    NotHeard {
        /// Name of the node.
        node: String,
        /// Index of the stop.
        stop: u32,
    },
    /// Two signal-to-noise ratios of one sector.
    #[error("node `{node}` at stop {stop} has two SNRs of sector {sector}; give one per node, stop and sector")]
    SectorTwice {
        /// Name of the node.
        node: String,
        /// Index of the stop.
        stop: u32,
        /// The sector.
        sector: u8,
    },
    /// A signal-to-noise ratio that is not a number.
    #[error("node `{node}` at stop {stop}, sector {sector}: SNR {snr_db} dB; allowed: finite numbers")]
    SnrNotFinite {
        /// Name of the node.
        node: String,
        /// Index of the stop.
        stop: u32,
        /// The sector.
        sector: u8,
        /// The value found (dB).
        snr_db: f64,
    },
    /// A range, or the place where it was measured, that is not a number.
    #[error(
        "a range to node `{node}` is {range_m} m, or its place is not finite; allowed: finite numbers, at most 10⁷ m"
    )]
    RangeNotFinite {
        /// Name of the node.
        node: String,
        /// The value found (m).
        range_m: f64,
    },
}
