//! A receiver that listens in windows, as phones do.

use sextant_kernel::Seed;

use super::independent_shadowing::usual_dbm;
use super::survey::{LOSSES, Listening, survey};
use super::{LawError, ReceptionLogAt, Site};

/// The name of the law.
pub(super) const NAME: &str = "scan-windows";

/// Packets sent at a stop, and of the packets of a period those that fall into the window.
const PACKETS: u32 = 30;
const PERIOD: u32 = 10;
const WINDOW: u32 = 3;

/// Thirty packets a stop, of which the receiver is awake for three of ten in a row. Where the window begins differs from
/// stop to stop; a node's own clock shifts its packets.
pub(super) fn log(seed: Seed) -> Result<ReceptionLogAt, LawError> {
    let site = Site::hall(seed, 16);
    let first = |of: u64, number: usize| seed.bits(LOSSES, [of, number as u64, 0]) % u64::from(PERIOD);
    let is_lost = |node: usize, stop: usize, packet: u32| {
        let at = (u64::from(packet) + first(0, node) + first(1, stop)) % u64::from(PERIOD);
        // One in ten of those in the window is missed as well.
        let place = [2 + node as u64, stop as u64, u64::from(packet)];
        at >= u64::from(WINDOW) || seed.uniform(LOSSES, place) < 0.1
    };
    let strength = |node, stop| usual_dbm(&site, node, stop);
    let log = survey(&site, Listening { packets: PACKETS, ..Listening::default() }, &strength, &is_lost)?;
    Ok((log, site.nodes))
}
