//! A robot listens at the stops of a site.

use sextant_channel::{LogError, Reception, ReceptionLog, Stop};
use sextant_kernel::{NodeId, Purpose, SimTime};

use super::site::Site;

/// What draws are for.
pub(super) const NODES: Purpose = Purpose::new(101);
pub(super) const POWER: Purpose = Purpose::new(102);
pub(super) const SHADOWING: Purpose = Purpose::new(103);
pub(super) const FADING: Purpose = Purpose::new(104);
pub(super) const LOSSES: Purpose = Purpose::new(105);
const QUADRATURE: Purpose = Purpose::new(107);
pub(super) const SURROUNDINGS: Purpose = Purpose::new(106);

/// Packets need this strength (dBm).
pub(super) const SENSITIVITY_DBM: f64 = -90.0;
/// Shadowing of a link, where a law has nothing else (dB).
pub(super) const SHADOWING_DB: f64 = 5.0;
/// Packets that a node sends while the robot listens at a stop.
pub(super) const PACKETS: u32 = 10;
/// Seconds from stop to stop.
const STOP_S: u64 = 10;

/// How a robot listens.
#[derive(Clone, Copy, Debug)]
pub(super) struct Listening {
    /// Packets that each node sends at a stop.
    pub(super) packets: u32,
    /// How the strengths of packets differ from that of their link.
    pub(super) fading: Fading,
}

/// How the strengths of the packets of a link differ.
#[derive(Clone, Copy, Debug)]
pub(super) enum Fading {
    /// By a normal number with this standard deviation (dB).
    Normal(f64),
    /// As the envelope of a wave of constant strength and many weak ones (Rice 1945), whose powers have this ratio. The mean
    /// power is that of the link.
    Rician(f64),
}

impl Fading {
    /// What a packet has above its link (dB).
    fn above_db(self, site: &Site, place: [u64; 3]) -> f64 {
        match self {
            Self::Normal(deviation_db) => deviation_db * site.seed.normal(FADING, place),
            Self::Rician(ratio) => {
                let scattered = (0.5 / (1.0 + ratio)).sqrt();
                let straight = (ratio / (1.0 + ratio)).sqrt();
                let real = straight + scattered * site.seed.normal(FADING, place);
                let imaginary = scattered * site.seed.normal(QUADRATURE, place);
                10.0 * libm::log10(real * real + imaginary * imaginary)
            }
        }
    }
}

impl Default for Listening {
    fn default() -> Self {
        Self { packets: PACKETS, fading: Fading::Normal(3.0) }
    }
}

/// The log of a robot at `site`. `strength_dbm` is the strength of a link of node and stop, without fading (dBm), and
/// `is_lost` says of a packet (its number), whether it is lost whatever its strength. Strengths are rounded to a decibel
/// packet by packet.
pub(super) fn survey(
    site: &Site,
    listening: Listening,
    strength_dbm: &dyn Fn(usize, usize) -> f64,
    is_lost: &dyn Fn(usize, usize, u32) -> bool,
) -> Result<ReceptionLog, LogError> {
    let mut receptions = Vec::new();
    for node in 0..site.nodes.len() {
        for stop in 0..site.stops.len() {
            let mean_dbm = strength_dbm(node, stop);
            let packets = (0..listening.packets).filter_map(|packet| {
                let place = [node as u64, stop as u64, u64::from(packet)];
                let rssi_dbm = mean_dbm + listening.fading.above_db(site, place);
                (rssi_dbm >= SENSITIVITY_DBM && !is_lost(node, stop, packet)).then(|| rssi_dbm.round())
            });
            let (received, sum) = packets.fold((0, 0.0), |(count, sum), rssi_dbm| (count + 1, sum + rssi_dbm));
            receptions.push(Reception {
                rssi_dbm: (received > 0).then(|| sum / f64::from(received)),
                ..Reception::heard(
                    NodeId::from_index(node),
                    u32::try_from(stop).unwrap_or(u32::MAX),
                    received,
                    listening.packets,
                )
            });
        }
    }
    let names = (0..site.nodes.len()).map(|node| format!("n{node}")).collect();
    let stops = (0..).zip(&site.stops).map(|(number, &position)| Stop {
        time: SimTime::from_nanos(STOP_S * 1_000_000_000 * number),
        ..Stop::at(position)
    });
    ReceptionLog::new(names, stops.collect(), receptions, Vec::new())
}

/// No packet is lost.
pub(super) fn none_lost(_: usize, _: usize, _: u32) -> bool {
    false
}
