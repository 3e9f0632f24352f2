//! When radios are on by plan, in a recording.

use sextant_kernel::SimTime;
use sextant_mac::tsch::{Cell, CellOptions, CellPeer};
use sextant_recording::messages::{CellMessage, CheckMessage};
use sextant_recording::{FileRecorder, RecordingError};
use sextant_sim::{CellSpan, NetworkRecord, Rhythm};

/// What a cell may be for, and the word of a schedule for it.
const OPTIONS: [(CellOptions, &str); 4] = [
    (CellOptions::TRANSMIT, "transmit"),
    (CellOptions::RECEIVE, "receive"),
    (CellOptions::SHARED, "shared"),
    (CellOptions::TIMEKEEPING, "timekeeping"),
];

/// Records the cells and the checks of all stations, network by network.
pub(super) fn record(
    recorder: &mut FileRecorder,
    end: SimTime,
    names: &[String],
    networks: &[NetworkRecord],
) -> Result<(), RecordingError> {
    for (network, record) in names.iter().zip(networks) {
        for (station, rhythm) in (0..).zip(&record.rhythms) {
            match rhythm {
                None => {}
                Some(Rhythm::Cells { slot, cells }) => {
                    let slot_ns = (SimTime::ZERO + *slot).as_nanos();
                    for CellSpan { cell, from, to } in cells {
                        let timing = CellMessage {
                            station,
                            network: network.clone(),
                            from_ns: from.as_nanos(),
                            to_ns: to.map(SimTime::as_nanos),
                            slot_ns,
                            ..message(cell)
                        };
                        recorder.cell(end, &timing)?;
                    }
                }
                Some(Rhythm::Checks { first, interval, length }) => {
                    let nanos = |span| (SimTime::ZERO + span).as_nanos();
                    recorder.check(
                        end,
                        &CheckMessage {
                            station,
                            network: network.clone(),
                            first_ns: first.as_nanos(),
                            interval_ns: nanos(*interval),
                            length_ns: nanos(*length),
                        },
                    )?;
                }
            }
        }
    }
    Ok(())
}

/// What a cell says of itself.
fn message(cell: &Cell) -> CellMessage {
    let words: Vec<&str> =
        OPTIONS.iter().filter(|(option, _)| cell.options.has(*option)).map(|&(_, word)| word).collect();
    CellMessage {
        handle: cell.slotframe.handle.into(),
        slotframe: cell.slotframe.length.into(),
        timeslot: cell.timeslot.into(),
        channel_offset: cell.channel_offset.into(),
        options: words.join(" "),
        peer: match cell.peer {
            CellPeer::Station(peer) => Some(peer.0),
            CellPeer::All | CellPeer::Beacons => None,
        },
        beacons: cell.peer == CellPeer::Beacons,
        ..CellMessage::default()
    }
}
