//! The outcomes of packets.

use sextant_kernel::StationId;
use sextant_mac::EnergySpent;

use super::delays::Delays;
use super::outcome::{Deafness, FrameOutcome};
use super::packet_trace::PacketFate;
use super::report::FrameId;
use super::rhythm::Rhythm;
use super::sleep::SleepUse;
use super::slots::SlotUse;

/// The outcomes of the packets of a station, or of several. Each packet offered is counted once: `offered` is the sum
/// of `lost_channel_access`, `lost_queue`, `died`, `pending`, `received`, `lost_collision`, `lost_signal`, `out_of_range` and
/// `not_listened`; those of a station that were not simulated are in none of these. A packet to one station is received by that station; a packet to all is received if any station
/// received it whose application hears, and the best outcome counts. With several transmissions of one packet, the
/// best outcome counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Packets {
    /// Given to a MAC by an application.
    pub offered: u64,
    /// Sent at least once: each transmission of a packet after its first one is a retry, `transmissions - sent` in all.
    pub sent: u64,
    /// Received.
    pub received: u64,
    /// Somebody listened, but another signal destroyed the packet.
    pub lost_collision: u64,
    /// Never sent: the channel was busy too often.
    pub lost_channel_access: u64,
    /// Never sent: the transmit queue was full.
    pub lost_queue: u64,
    /// Somebody listened in range, but the signal was too weak.
    pub lost_signal: u64,
    /// All that listened were beyond the radius of communication.
    pub out_of_range: u64,
    /// No receiver listened: the sum of the next three.
    pub not_listened: u64,
    /// No receiver listened, because it sent something itself. Not part of the sum.
    pub not_listened_transmitting: u64,
    /// No receiver listened, because it was asleep or idle. Not part of the sum.
    pub not_listened_asleep: u64,
    /// No receiver listened, because none was in use. Not part of the sum.
    pub not_listened_off: u64,
    /// Still in a MAC or in its queue when its station died.
    pub died: u64,
    /// Still in a MAC or in its queue at the end.
    pub pending: u64,
    /// Given up because of a busy channel, retransmissions included: those in `lost_channel_access`, and those that
    /// were on air before. Not part of the sum.
    pub channel_access_failures: u64,
    /// Transmissions of all packets, each time a frame or, with sector sweeps, a frame from each sector. Strobes, copies and
    /// wake-up frames that wake a receiver are none. Not part of the sum.
    pub transmissions: u64,
    /// Clear channel assessments of all packets, one for each backoff. Not part of the sum.
    pub assessments: u64,
    /// Sent as often as allowed and never acknowledged, whether received or not. Not part of the sum.
    pub unacknowledged: u64,
    /// Octets of payload that were received. Not part of the sum.
    pub octets_received: u64,
    /// Reports of all sectors that this station asked for in sector sweeps. Not part of the sum, and no packets.
    pub reports_asked: u64,
    /// Those of them that this station received; the others were lost. Not part of the sum, and no packets.
    pub reports_received: u64,
    /// Due while nobody who listens was near, and therefore not simulated. Those of a station are offered, and count as
    /// nothing else.
    pub not_simulated: u64,
}

impl Packets {
    /// Counts a packet with its fate, after so many transmissions.
    pub(crate) fn count(&mut self, fate: PacketFate, transmissions: u64) {
        self.sent += u64::from(transmissions > 0);
        self.transmissions += transmissions;
        *match fate {
            PacketFate::Sent(FrameOutcome::Received) => &mut self.received,
            PacketFate::Sent(FrameOutcome::Collided) => &mut self.lost_collision,
            PacketFate::Sent(FrameOutcome::Weak) => &mut self.lost_signal,
            PacketFate::Sent(FrameOutcome::OutOfRange) => &mut self.out_of_range,
            PacketFate::Sent(FrameOutcome::NotListened(deafness)) => {
                *match deafness {
                    Deafness::Transmitting => &mut self.not_listened_transmitting,
                    Deafness::Asleep => &mut self.not_listened_asleep,
                    Deafness::Off => &mut self.not_listened_off,
                } += 1;
                &mut self.not_listened
            }
            PacketFate::LostChannelAccess => &mut self.lost_channel_access,
            PacketFate::LostQueue => &mut self.lost_queue,
            PacketFate::Died => &mut self.died,
            PacketFate::Pending => &mut self.pending,
        } += 1;
    }

    /// The same, where the packets of which nothing became yet are pending.
    #[must_use]
    pub(crate) fn with_pending(self) -> Self {
        let Self { received, lost_collision, lost_channel_access, lost_queue, lost_signal, .. } = self;
        let Self { offered, out_of_range, not_listened, died, .. } = self;
        let lost = lost_collision + lost_channel_access + lost_queue + lost_signal + out_of_range + not_listened;
        let lost = lost + died;
        Self { pending: offered - received - lost, ..self }
    }

    /// The same, with an estimate of what became of the packets that were not simulated: what became of those that were
    /// simulated and that nobody heard. Nobody was near, so none of them was received, or lost to another signal. If somebody
    /// listened far away, the outcome is `too_far`.
    #[must_use]
    pub(crate) fn with_estimates(self, too_far: TooFar) -> Self {
        let Self { not_simulated: missing, .. } = self;
        let simulated = self.offered - missing;
        if missing == 0 {
            return self;
        }
        let mut all = self;
        let without_access = part(missing, self.lost_channel_access, simulated);
        let without_place = part(missing, self.lost_queue, simulated).min(missing - without_access);
        all.lost_channel_access += without_access;
        all.lost_queue += without_place;
        all.channel_access_failures += part(missing, self.channel_access_failures, simulated);
        all.assessments += if simulated > 0 { part(missing, self.assessments, simulated) } else { missing };
        let sent = missing - without_access - without_place;
        all.sent += sent;
        all.transmissions += sent;
        let not_listened = if self.sent > 0 { part(sent, self.not_listened, self.sent) } else { sent };
        let transmitting = part(sent, self.not_listened_transmitting, self.sent).min(not_listened);
        let asleep = part(sent, self.not_listened_asleep, self.sent).min(not_listened - transmitting);
        all.not_listened += not_listened;
        all.not_listened_transmitting += transmitting;
        all.not_listened_asleep += asleep;
        all.not_listened_off += not_listened - transmitting - asleep;
        *match too_far {
            TooFar::OutOfRange => &mut all.out_of_range,
            TooFar::Weak => &mut all.lost_signal,
        } += sent - not_listened;
        all
    }
}

/// What becomes of a packet if only stations listen that are too far away.
#[derive(Clone, Copy, Debug)]
pub(crate) enum TooFar {
    /// They are beyond the radius of communication.
    OutOfRange,
    /// The channel has no such radius: the signal is too weak.
    Weak,
}

impl TooFar {
    /// On a channel with this radius of communication (m).
    pub(crate) fn beyond(max_range_m: f64) -> Self {
        if max_range_m.is_finite() { Self::OutOfRange } else { Self::Weak }
    }
}

/// The share `count` of `whole`, of `number`, rounded.
fn part(number: u64, count: u64, whole: u64) -> u64 {
    let [number, count, whole] = [number, count, whole.max(1)].map(u128::from);
    u64::try_from((number * count + whole / 2) / whole).unwrap_or(u64::MAX)
}

crate::sum_fields!(Packets {
    offered,
    sent,
    received,
    lost_collision,
    lost_channel_access,
    lost_queue,
    lost_signal,
    out_of_range,
    not_listened,
    not_listened_transmitting,
    not_listened_asleep,
    not_listened_off,
    died,
    pending,
    channel_access_failures,
    transmissions,
    assessments,
    unacknowledged,
    octets_received,
    reports_asked,
    reports_received,
    not_simulated,
});

/// A packet that was in the link of a station when that died, or at the end: its application was told nothing of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LeftPacket {
    /// The station.
    pub station: StationId,
    /// The packet.
    pub frame: FrameId,
    /// How often it was sent.
    pub transmissions: u32,
}

/// What a network leaves behind, by station: nodes come first, then robots, then sinks.
#[derive(Clone, Debug, Default)]
pub struct NetworkRecord {
    /// What became of the packets of each station.
    pub packets: Vec<Packets>,
    /// Energy that the radio of each station used.
    pub energy: Vec<EnergySpent>,
    /// Number of frames that were delivered to each station, each once, from whichever sectors it was heard.
    pub deliveries: Vec<u64>,
    /// Time from offer to first reception of the packets of each station that were received. Empty if there are no sinks.
    pub delays: Vec<Delays>,
    /// How each station used its slots. Empty if the network has none.
    pub slots: Vec<SlotUse>,
    /// How each station slept. Empty if stations do not sleep between checks of the channel.
    pub sleep: Vec<SleepUse>,
    /// When the radio of each station was on by plan; `None` for those without one. Empty if the network has neither slots nor
    /// checks.
    pub rhythms: Vec<Option<Rhythm>>,
    /// The packets that were sent and stayed in links. Empty with sector sweeps.
    pub left: Vec<LeftPacket>,
}
