//! What a simulation draws random numbers for. Never renumber: each number belongs to one purpose of the whole
//! program.

use sextant_kernel::Purpose;

/// Places of nodes.
pub(crate) const LAYOUT: Purpose = Purpose::new(1);
/// Phase and jitter of the nodes' traffic.
pub(crate) const TRAFFIC: Purpose = Purpose::new(2);
/// Backoff of CSMA-CA.
pub(crate) const BACKOFF: Purpose = Purpose::new(3);
/// Loss by bit errors.
pub(crate) const RECEPTION: Purpose = Purpose::new(5);
/// First sequence number of a node.
pub(crate) const SEQUENCE: Purpose = Purpose::new(6);
/// Choice of anchors.
pub(crate) const ANCHORS: Purpose = Purpose::new(9);
/// Phases, backoffs and losses of neighbour discovery.
pub(crate) const DISCOVERY: Purpose = Purpose::new(10);
/// Draws of applications.
pub(crate) const APPLICATION: Purpose = Purpose::new(12);
/// Channels of the bands after the first one.
pub(crate) const BAND: Purpose = Purpose::new(11);
/// Ways of targets.
pub(crate) const TARGETS: Purpose = Purpose::new(13);
/// Offsets, noise and phases of sensors.
pub(crate) const SENSING: Purpose = Purpose::new(14);
/// Traffic in the networks after the first one.
pub(crate) const NETWORK: Purpose = Purpose::new(15);
/// Headings of the antennas of nodes.
pub(crate) const HEADING: Purpose = Purpose::new(17);
/// Answers to a steered antenna that has moved on.
pub(crate) const MISALIGNMENT: Purpose = Purpose::new(18);
/// Losses of frames that were received otherwise.
pub(crate) const MESSAGE_LOSS: Purpose = Purpose::new(19);
/// Tilts of the antennas of nodes.
pub(crate) const TILT: Purpose = Purpose::new(21);
/// Nodes that die, and when.
pub(crate) const DEATHS: Purpose = Purpose::new(22);
/// Anchors that lie, and in which direction.
pub(crate) const LYING: Purpose = Purpose::new(24);
/// Rates of the clocks of nodes.
pub(crate) const CLOCK: Purpose = Purpose::new(26);
/// Phases of interferers.
pub(crate) const INTERFERENCE: Purpose = Purpose::new(27);
/// Rounds and bands of a simulation: what tells frames apart that are sent at the same time in different ones.
pub(crate) const ROUND: Purpose = Purpose::new(28);
/// Noise of the odometry of robots.
pub(crate) const ODOMETRY: Purpose = Purpose::new(16);
