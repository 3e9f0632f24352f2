//! The powers of a link for all sectors of both ends, and what bodies take of it.

use sextant_channel::{Db, Dbm, Position, Ray};

use super::{Budget, End};
use crate::air::listener::Listener;
use crate::air::receiver_id::ReceiverId;
use crate::air::screens::Screens;
use crate::air::signal::{Aim, Signal};
use crate::service::ideal::{SectorCounts, SectorPowers};

impl Budget {
    /// Loss of a signal at a listener by bodies in its ways. Antennas with sectors weigh the ways by their gains, which
    /// [`Budget::gains`] does with reflections; then it is zero.
    pub(super) fn hidden(&mut self, signal: &Signal, listener: &Listener<Position>) -> Db {
        let is_weighed = self.channel.reflects() && self.has_antennas();
        let Self { channel, ways, changes: Some(changes), .. } = self else { return Db(0.0) };
        let screens = changes.screens();
        if is_weighed || screens.is_none() {
            return Db(0.0);
        }
        let rays = ways.between(channel, end(signal), End { station: listener.station, place: listener.place });
        let (mut open, mut left) = (0.0, 0.0);
        for ray in rays {
            let share = (Db(0.0) - ray.loss).to_factor();
            open += share;
            left += share * left_over(screens, ray, signal, listener);
        }
        if open > 0.0 { Db(-10.0 * libm::log10(left / open)) } else { Db(0.0) }
    }

    /// The powers of a signal at a listener with each sector of the two; `None` beyond the radius of communication.
    pub(in crate::air) fn sector_powers(
        &mut self,
        signal: &Signal,
        listener: &Listener<Position>,
        counts: SectorCounts,
    ) -> Option<SectorPowers> {
        let mean = self.mean(signal, listener.place)?;
        let level = self.with_shadowing(mean, signal, listener);
        let level = match &mut self.changes {
            Some(changes) => level + changes.gain(signal, listener),
            None => level,
        };
        let to = End { station: listener.station, place: listener.place };
        let screens = self.changes.as_ref().and_then(|changes| changes.screens());
        let rays = self.ways.between(&self.channel, end(signal), to).to_vec();
        let all: f64 = rays.iter().map(|ray| (Db(0.0) - ray.loss).to_factor()).sum();
        let shares: Vec<f64> = (rays.iter())
            .map(|ray| {
                (Db(0.0) - ray.loss).to_factor() / all.max(f64::MIN_POSITIVE)
                    * left_over(screens, ray, signal, listener)
            })
            .collect();
        let own = self.towards(signal.sender, counts.own, rays.iter().map(|ray| ray.departure));
        let peer = self.towards(listener.receiver, counts.peer, rays.iter().map(|ray| ray.arrival));
        let power = |a: &[f64], b: &[f64]| {
            let sum: f64 = shares.iter().zip(a).zip(b).map(|((share, a), b)| share * a * b).sum();
            if sum > 0.0 { level + Db(10.0 * libm::log10(sum)) } else { Dbm::SILENCE }
        };
        let pairs = own.sectors.iter().flat_map(|a| peer.sectors.iter().map(move |b| (a, b)));
        Some(SectorPowers::new(
            own.sectors.iter().map(|gains| power(gains, &peer.listening)).collect(),
            peer.sectors.iter().map(|gains| power(&own.listening, gains)).collect(),
            pairs.map(|(a, b)| power(a, b)).collect(),
        ))
    }

    /// The gains of one end in these directions.
    fn towards(
        &self,
        radio: ReceiverId,
        sectors: u8,
        directions: impl Iterator<Item = Position> + Clone,
    ) -> EndGains {
        let of_sector = |sector: u8| {
            let gain = |direction| self.mounts.transmit_gain(radio, Aim::Sector(sector), direction).to_factor();
            directions.clone().map(gain).collect()
        };
        let listening = directions.clone().map(|direction| self.mounts.receive_gain(radio, direction).to_factor());
        EndGains { sectors: (0..sectors).map(of_sector).collect(), listening: listening.collect() }
    }
}

/// The gains of one end of a link, as factors: by way.
struct EndGains {
    /// Of each sector.
    sectors: Vec<Vec<f64>>,
    /// As it listens in all directions.
    listening: Vec<f64>,
}

/// The share of the power of a way that bodies leave.
pub(super) fn left_over(screens: Option<&Screens>, ray: &Ray, signal: &Signal, listener: &Listener<Position>) -> f64 {
    let loss = screens.map(|screens| screens.loss(ray, [signal.position, listener.place], signal.start));
    loss.map_or(1.0, |loss| (Db(0.0) - loss).to_factor())
}

/// The end that sends.
fn end(signal: &Signal) -> End {
    End { station: signal.source, place: signal.position }
}
