//! The trace of a packet in a recording.

use std::collections::BTreeMap;
use std::time::Duration;

use sextant_kernel::{SimTime, StationId};
use sextant_mac::routing::fragment::Fragment;
use sextant_mac::routing::rpl::{Content, HOP_LIMIT, RplFrame};
use sextant_mac::routing::{Data, Packet};
use sextant_recording::messages::{AssessmentMessage, HopMessage, PacketMessage, TransmissionMessage};
use sextant_recording::{FileRecorder, RecordingError};
use sextant_sim::{AssessmentTrace, Deafness, Destination, PacketFate, PacketTrace, TransmissionTrace};

/// Records packet number `id`, of the network called `network`; time 0 of its simulation is `offset` in the recording. It counts if
/// one of the `nodes` first stations offered it: the summary is about nodes.
pub(super) fn record(
    recorder: &mut FileRecorder,
    (id, nodes): (u64, usize),
    network: &str,
    trace: &PacketTrace,
    offset: Duration,
) -> Result<(), RecordingError> {
    let nanos = |time: SimTime| (time + offset).as_nanos();
    let count = |number: usize| u32::try_from(number).unwrap_or(u32::MAX);
    let deafness = match trace.fate {
        PacketFate::Sent(outcome) => name_of(outcome.deafness()),
        PacketFate::LostChannelAccess | PacketFate::LostQueue | PacketFate::Died | PacketFate::Pending => {
            String::new()
        }
    };
    let packet = PacketMessage {
        packet: id,
        network: network.to_owned(),
        source: trace.source.0,
        kind: trace.kind.name().to_owned(),
        number: trace.number,
        sequence: trace.sequence.map(u32::from),
        destination: match trace.to {
            Destination::All => None,
            Destination::Station(station) => Some(station.0),
        },
        octets: trace.octets.into(),
        offered_ns: nanos(trace.offered),
        counted: trace.counts && trace.source.index() < nodes,
        begun_ns: trace.begun.map(nanos),
        assessments: count(trace.assessments.len()),
        transmissions: trace.attempts(),
        end: trace.end.name().to_owned(),
        ended_ns: nanos(trace.ended),
        fate: trace.fate.name().to_owned(),
        deafness,
        delivered_ns: trace.delivered.map(nanos),
        tx_energy_j: trace.tx_energy_j,
    };
    let assessment = |&AssessmentTrace { backoff, start, busy }: &AssessmentTrace| AssessmentMessage {
        packet: id,
        backoff_ns: nanos(backoff),
        start_ns: nanos(start),
        busy,
    };
    let transmission = |sent: &TransmissionTrace| TransmissionMessage {
        packet: id,
        attempt: sent.attempt,
        start_ns: nanos(sent.start),
        airtime_ns: (SimTime::ZERO + sent.airtime).as_nanos(),
        outcome: sent.outcome.name().to_owned(),
        deafness: name_of(sent.outcome.deafness()),
        receiver: sent.receiver.map(|station| station.0),
        power_dbm: sent.power.map(|power| power.0),
        sinr_db: sent.sinr.map(|sinr| sinr.0),
        collided_with: sent.collided_with.map(|station| station.0),
        acknowledged_ns: sent.acknowledged.map(nanos),
    };
    let assessments: Vec<_> = trace.assessments.iter().map(assessment).collect();
    let transmissions: Vec<_> = trace.transmissions.iter().map(transmission).collect();
    recorder.packet(&packet, &assessments, &transmissions)
}

/// When each packet over several hops was offered at its origin, by that and its number (time in the recording).
pub(super) type Origins = BTreeMap<(StationId, u16), SimTime>;

/// Records the hop that packet number `id` is, if it goes over several hops.
pub(super) fn record_hop(
    recorder: &mut FileRecorder,
    id: u64,
    trace: &PacketTrace,
    origins: &Origins,
    offset: Duration,
) -> Result<(), RecordingError> {
    // The first fragment has the header of its packet.
    let payload = match Fragment::read(&trace.payload) {
        Some(fragment) if fragment.offset == 0 => fragment.part,
        Some(_) => return Ok(()),
        None => &trace.payload,
    };
    let Some(Hop { origin, number, hops, target }) = Hop::read(payload, trace.to) else { return Ok(()) };
    let Some(offered) = origins.get(&(origin, number)) else { return Ok(()) };
    let hop = HopMessage {
        packet: id,
        origin: origin.0,
        number: number.into(),
        hops: hops.into(),
        target: target.map(|station| station.0),
        origin_offered_ns: offered.as_nanos(),
    };
    recorder.hop((trace.ended + offset).as_nanos(), &hop)
}

/// What the header of a packet over several hops says.
struct Hop {
    origin: StationId,
    number: u16,
    /// Hops before this one.
    hops: u8,
    target: Option<StationId>,
}

impl Hop {
    fn read(payload: &[u8], to: Destination) -> Option<Self> {
        match Packet::read(payload) {
            Some(Packet::Data(Data { origin, number, hops, target, .. })) => {
                return Some(Self { origin, number, hops, target });
            }
            Some(Packet::Down(down)) => {
                let next = match to {
                    Destination::Station(next) => Some(next),
                    Destination::All => None,
                };
                let target = down.route.last().copied().or(next);
                return Some(Self { origin: down.origin, number: down.number, hops: down.hops, target });
            }
            Some(Packet::Beacon(_)) => return None,
            None => {}
        }
        match RplFrame::read(payload)? {
            RplFrame::Datagram(datagram) => match datagram.content {
                Content::Data(number) => {
                    let hops = HOP_LIMIT.saturating_sub(datagram.hop_limit);
                    let (origin, target) = (datagram.source, Some(datagram.target()));
                    Some(Self { origin, number, hops, target })
                }
                Content::Message(_) => None,
            },
            RplFrame::Local(_) => None,
        }
    }
}

fn name_of(deafness: Option<Deafness>) -> String {
    deafness.map_or_else(String::new, |deafness| deafness.name().to_owned())
}
