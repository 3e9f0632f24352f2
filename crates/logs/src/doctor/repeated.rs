//! Packets that are written several times.

use super::finding::Finding;

/// So large a share of packets that have the time of another one is odd (%).
const ODD_PERCENT: u64 = 10;

/// What is odd of so many packets, of which so many have the time of another one of their node.
pub(crate) fn finding([packets, repeated]: [u64; 2]) -> Option<Finding> {
    (repeated > 0 && 100 * repeated >= ODD_PERCENT * packets).then(|| Finding {
        check: "repeated-packets",
        odd: format!("{repeated} of {packets} packets have the time of another packet of their node and robot"),
        cost: "each row counts as a packet, so a copy counts as evidence that is not there".to_owned(),
        remedy:
            "write each packet once: its rows may come from several antennas, or from a file that was appended twice"
                .to_owned(),
    })
}
