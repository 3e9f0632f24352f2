//! A reception as octets, in the temporary file.

use sextant_channel::Reception;
use sextant_kernel::NodeId;

/// What follows the node and the stop.
const HAS_COUNTS: u8 = 1;
const HAS_SECTOR: u8 = 2;
const HAS_STRENGTH: u8 = 4;
const HAS_RATIO: u8 = 8;

/// Octets of the smallest reception: flags, node and stop.
pub(super) const SMALLEST: u64 = 9;

/// Appends `reception` to `octets`: flags, node, stop, and what differs from one packet received of one.
pub(super) fn write(reception: &Reception, octets: &mut Vec<u8>) {
    let &Reception { node, stop, received, sent, sector, rssi_dbm, snr_db } = reception;
    let flag = |is_there: bool, flag: u8| if is_there { flag } else { 0 };
    let has_counts = (received, sent) != (1, 1);
    octets.push(
        flag(has_counts, HAS_COUNTS)
            | flag(sector.is_some(), HAS_SECTOR)
            | flag(rssi_dbm.is_some(), HAS_STRENGTH)
            | flag(snr_db.is_some(), HAS_RATIO),
    );
    octets.extend(node.0.to_le_bytes());
    octets.extend(stop.to_le_bytes());
    if has_counts {
        octets.extend(received.to_le_bytes());
        octets.extend(sent.to_le_bytes());
    }
    octets.extend(sector);
    octets.extend(rssi_dbm.map(f64::to_le_bytes).into_iter().flatten());
    octets.extend(snr_db.map(f64::to_le_bytes).into_iter().flatten());
}

/// Takes the first reception from `octets`; `None` if there are too few of them.
pub(super) fn read(octets: &mut &[u8]) -> Option<Reception> {
    let [flags] = take(octets)?;
    let node = NodeId(u32::from_le_bytes(take(octets)?));
    let stop = u32::from_le_bytes(take(octets)?);
    let (mut received, mut sent) = (1, 1);
    if flags & HAS_COUNTS != 0 {
        (received, sent) = (u32::from_le_bytes(take(octets)?), u32::from_le_bytes(take(octets)?));
    }
    let sector = if flags & HAS_SECTOR == 0 { None } else { Some(take::<1>(octets)?[0]) };
    let rssi_dbm = if flags & HAS_STRENGTH == 0 { None } else { Some(f64::from_le_bytes(take(octets)?)) };
    let snr_db = if flags & HAS_RATIO == 0 { None } else { Some(f64::from_le_bytes(take(octets)?)) };
    Some(Reception { node, stop, received, sent, sector, rssi_dbm, snr_db })
}

fn take<const N: usize>(octets: &mut &[u8]) -> Option<[u8; N]> {
    let (first, rest) = octets.split_first_chunk()?;
    *octets = rest;
    Some(*first)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn receptions_return_from_octets_as_they_were() {
        let plain = Reception::heard(NodeId(7), 9, 1, 1);
        let all = [
            plain,
            Reception { received: 0, sent: 0, ..plain },
            Reception { sector: Some(3), ..plain },
            Reception { rssi_dbm: Some(-81.25), ..plain },
            Reception {
                received: 3,
                sent: u32::MAX,
                sector: Some(255),
                rssi_dbm: Some(0.0),
                snr_db: Some(2.5),
                ..plain
            },
        ];
        let mut octets = Vec::new();
        all.iter().for_each(|reception| write(reception, &mut octets));
        let mut rest = octets.as_slice();
        let found: Vec<Reception> = std::iter::from_fn(|| read(&mut rest)).collect();
        assert_eq!(found, all);
        let mut cut = &octets[..octets.len() - 1];
        assert_eq!(std::iter::from_fn(|| read(&mut cut)).count(), all.len() - 1);
        assert_eq!(octets[..9].len() as u64, SMALLEST);
    }
}
