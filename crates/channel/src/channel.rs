//! The link budget: everything that changes the power between two antennas.

use sextant_kernel::{Seed, StationId};

use crate::geometry::position::Position;
use crate::obstacles::field::ObstacleField;
use crate::obstacles::rays::{Scatterers, Surroundings, straight};
use crate::power::{Db, Dbm, Milliwatts};
use crate::propagation::law::ChannelLaw;
use crate::propagation::path_budget::PathBudget;
use crate::propagation::reflection::Ray;
use crate::propagation::shadowing::Shadowing;

/// A radio channel in a world of obstacles: `P_rx = P_tx - L(d) - L_obstacles + X` (thesis eq. 3.15).
/// Reciprocal: every result is the same, bit for bit, if the two ends are exchanged.
#[derive(Clone, Debug)]
pub struct Channel {
    law: ChannelLaw,
    shadowing: Shadowing,
    obstacles: ObstacleField,
    /// What bends the ways of signals, if anything may.
    scatterers: Option<Scatterers>,
}

impl Channel {
    /// The channel with this `law` among `obstacles`, which absorb as at the carrier of the signals; its shadowing is drawn
    /// from `seed`.
    #[must_use]
    pub fn new(law: ChannelLaw, obstacles: ObstacleField, seed: Seed) -> Self {
        let obstacles = match law.signal_ghz() {
            Some(carrier_ghz) => obstacles.at_carrier(Some(carrier_ghz)),
            None => obstacles,
        };
        let scatterers = law.reflections().map(|law_of| Scatterers::new(law_of, &obstacles, law.signal_ghz()));
        let scatterers = scatterers.filter(|scatterers| !scatterers.is_empty());
        Self { law, shadowing: Shadowing::new(*law.shadowing(), seed), obstacles, scatterers }
    }

    /// The law of the channel without obstacles.
    #[must_use]
    #[inline]
    pub fn law(&self) -> &ChannelLaw {
        &self.law
    }

    /// The obstacles, whether they absorb or not.
    #[must_use]
    #[inline]
    pub fn obstacles(&self) -> &ObstacleField {
        &self.obstacles
    }

    /// Loss by the obstacles between two places; zero if obstacles do not absorb.
    #[must_use]
    #[inline]
    pub fn obstacle_loss(&self, from: Position, to: Position) -> Db {
        if self.law.obstacles_attenuate() { self.obstacles.loss(from, to) } else { Db(0.0) }
    }

    /// Whether signals are reflected or bend round edges, so that there may be several ways.
    #[must_use]
    #[inline]
    pub fn reflects(&self) -> bool {
        self.scatterers.is_some()
    }

    /// Number of ways by reflections that are tried for a link: what [`rays`](Self::rays) costs.
    #[must_use]
    pub fn tries(&self) -> usize {
        self.scatterers.as_ref().map_or(0, Scatterers::tries)
    }

    /// Replaces `rays` with the ways of a signal from `from` to `to`: the direct one, then reflections and ways round edges,
    /// the strongest first. None beyond the hard radius. A reflection is left out if a solid obstacle is in its way. The time
    /// grows with the number of all faces; with two reflections a ray, with its square.
    pub fn rays(&self, from: Position, to: Position, rays: &mut Vec<Ray>) {
        rays.clear();
        let distance_m = from.distance_m(to);
        if distance_m > self.law.max_range_m() {
            return;
        }
        // The ways are worked out in one order of the two ends, so that both directions have the same bits.
        let key = |p: Position| [p.x_m, p.y_m, p.z_m];
        let is_forward = key(from) <= key(to);
        let (a, b) = if is_forward { (from, to) } else { (to, from) };
        match &self.scatterers {
            Some(scatterers) => {
                scatterers.trace(a, b, Surroundings { law: &self.law, obstacles: &self.obstacles }, rays);
            }
            None => {
                let loss = self.law.path_loss().loss(distance_m) + self.obstacle_loss(a, b);
                rays.push(straight(loss, a, b, self.law.signal_ghz()));
            }
        }
        if !is_forward {
            rays.iter_mut().for_each(|ray| *ray = ray.reversed());
        }
    }

    /// Mean received power (mean of the decibels) at the transmit power `tx`; `None` beyond the hard radius. With
    /// reflections, the sum of the powers of all rays.
    #[must_use]
    #[inline]
    pub fn mean_power(&self, tx: Dbm, from: Position, to: Position) -> Option<Dbm> {
        let distance_m = from.distance_m(to);
        if distance_m > self.law.max_range_m() {
            return None;
        }
        if self.reflects() {
            let mut rays = Vec::new();
            self.rays(from, to, &mut rays);
            return Some(rays.iter().map(|ray| (tx - ray.loss).to_milliwatts()).sum::<Milliwatts>().to_dbm());
        }
        Some(tx - self.law.path_loss().loss(distance_m) - self.obstacle_loss(from, to))
    }

    /// What the loss from `from` to `to` consists of; `None` beyond the hard radius.
    #[must_use]
    pub fn budget(&self, from: Position, to: Position) -> Option<PathBudget> {
        let distance_m = from.distance_m(to);
        if distance_m > self.law.max_range_m() {
            return None;
        }
        let obstacles = if self.law.obstacles_attenuate() { self.obstacles.losses(from, to) } else { Vec::new() };
        let mut rays = Vec::new();
        self.rays(from, to, &mut rays);
        // The first one is the straight line.
        let mut rays = rays.into_iter();
        let direct = rays.next()?;
        Some(PathBudget {
            distance_m,
            distance: self.law.path_loss().items(distance_m),
            obstacles,
            obstacle_loss: self.obstacle_loss(from, to),
            direct,
            reflections: self.reflects().then(|| rays.collect()),
        })
    }

    /// Gain by shadowing between station `a` at `pa` and station `b` at `pb` for packet number `packet`.
    #[must_use]
    pub fn shadowing(&self, a: StationId, pa: Position, b: StationId, pb: Position, packet: u64) -> Db {
        self.shadowing.gain(a, pa, b, pb, packet)
    }

    /// Power at which station `b` receives packet number `packet` if `a` sends it with `tx`;
    /// `None` beyond the hard radius.
    #[must_use]
    pub fn received_power(
        &self,
        tx: Dbm,
        a: StationId,
        pa: Position,
        b: StationId,
        pb: Position,
        packet: u64,
    ) -> Option<Dbm> {
        self.mean_power(tx, pa, pb).map(|mean| mean + self.shadowing(a, pa, b, pb, packet))
    }
}
