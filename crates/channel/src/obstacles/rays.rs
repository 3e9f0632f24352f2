//! The ways of signals between two places: straight, by reflections (method of images), and round edges.

use std::f64::consts::{FRAC_PI_4, PI, TAU};

use crate::geometry::position::Position;
use crate::geometry::shape::{Edge, LEVEL_M};
use crate::obstacles::crossing::Crossing;
use crate::obstacles::edge::{Detour, Side, detour, knife_edge_loss_db, passed};
use crate::obstacles::field::ObstacleField;
use crate::obstacles::mirror::{DEFAULT_CARRIER_GHZ, Field, Mirror, MirrorSurface, direction};
use crate::obstacles::obstacle::Obstacle;
use crate::power::Db;
use crate::propagation::complex::Complex;
use crate::propagation::law::ChannelLaw;
use crate::propagation::path_loss::LIGHT_M_PER_S;
use crate::propagation::reflection::{Polarisation, Ray, ReflectionLaw};

/// Rays that lose more by their reflections count as none (dB).
const MOST_LOSS_DB: f64 = 300.0;

/// What bends the ways of signals.
#[derive(Clone, Debug)]
pub(crate) struct Scatterers {
    law: ReflectionLaw,
    mirrors: Vec<Mirror>,
    /// The vertical edges of each obstacle that is solid; empty if edges do not count.
    edges: Vec<Vec<Edge>>,
    carrier_ghz: f64,
}

/// What signals cross on their ways.
#[derive(Clone, Copy)]
pub(crate) struct Surroundings<'a> {
    pub(crate) law: &'a ChannelLaw,
    pub(crate) obstacles: &'a ObstacleField,
}

impl Surroundings<'_> {
    /// Loss by the obstacles between two places; zero if obstacles do not absorb.
    fn obstacle_loss(&self, from: Position, to: Position) -> Db {
        if self.law.obstacles_attenuate() { self.obstacles.loss(from, to) } else { Db(0.0) }
    }

    /// Whether no solid obstacle is between two places.
    fn is_open(&self, from: Position, to: Position) -> bool {
        self.obstacles.blocking(from, to).is_none()
    }
}

impl Scatterers {
    /// The faces and edges among `obstacles` that count in a channel.
    pub(crate) fn new(law: &ReflectionLaw, obstacles: &ObstacleField, carrier_ghz: Option<f64>) -> Self {
        let carrier_ghz = carrier_ghz.unwrap_or(DEFAULT_CARRIER_GHZ);
        let mirrors = if law.order > 0 { law.mirrors(obstacles, carrier_ghz) } else { Vec::new() };
        let of =
            |obstacle: &Obstacle| if obstacle.is_solid() { obstacle.shape().vertical_edges() } else { Vec::new() };
        let edges: Vec<_> = if law.edges { obstacles.obstacles().iter().map(of).collect() } else { Vec::new() };
        let edges = if edges.iter().all(Vec::is_empty) { Vec::new() } else { edges };
        Self { law: *law, mirrors, edges, carrier_ghz }
    }

    /// Whether there is nothing that bends a way.
    pub(crate) fn is_empty(&self) -> bool {
        self.mirrors.is_empty() && self.edges.is_empty()
    }

    /// Number of ways by reflections that are tried for a link.
    pub(crate) fn tries(&self) -> usize {
        let mirrors = self.mirrors.len();
        if self.law.order > 1 { mirrors * mirrors } else { mirrors }
    }

    /// Replaces `rays` with the ways from `a` to `b`: the direct one, then the others, the strongest first. The caller
    /// orders the two ends, so that both directions have the same bits.
    pub(crate) fn trace(&self, a: Position, b: Position, around: Surroundings<'_>, rays: &mut Vec<Ray>) {
        rays.clear();
        let distance_m = a.distance_m(b);
        let loss = around.law.path_loss().loss(distance_m) + around.obstacle_loss(a, b);
        rays.push(straight(loss, a, b, Some(self.carrier_ghz)));
        rays.extend(self.mirrors.iter().filter_map(|mirror| self.bounced_once(mirror, a, b, around)));
        if self.law.order > 1 {
            for first in &self.mirrors {
                let Some(image) = first.image(a) else { continue };
                let others = self.mirrors.iter().filter(|second| !std::ptr::eq(first, *second));
                rays.extend(others.filter_map(|second| self.bounced_twice([first, second], image, [a, b], around)));
            }
        }
        if !self.edges.is_empty() {
            let mut crossings = Vec::new();
            around.obstacles.crossings(a, b, &mut crossings);
            for Crossing { obstacle, .. } in crossings {
                let sides = [Side::Left, Side::Right].into_iter();
                rays.extend(sides.filter_map(|side| self.bent(obstacle, side, [a, b], around)));
            }
        }
        rays[1..].sort_by(|one, other| one.loss.0.total_cmp(&other.loss.0));
        rays.dedup_by(|one, other| is_same_way(one, other));
        rays.truncate(1 + self.law.most());
    }

    /// The way from `a` to `b` by one face, if there is one.
    fn bounced_once(&self, mirror: &Mirror, a: Position, b: Position, around: Surroundings<'_>) -> Option<Ray> {
        let place = mirror.bounce(a, b)?;
        let length_m = a.distance_m(place) + place.distance_m(b);
        if length_m > around.law.max_range_m() || !around.is_open(a, place) || !around.is_open(place, b) {
            return None;
        }
        let (bounce_loss, turn_rad) = self.reflect(&[(mirror, direction(a, place))], direction(place, b))?;
        let obstacles = around.obstacle_loss(a, place) + around.obstacle_loss(place, b);
        let loss = around.law.path_loss().loss(length_m) + bounce_loss + obstacles;
        let (departure, arrival) = (direction(a, place), direction(b, place));
        let phase_rad = wrapped(self.phase_rad(length_m) + turn_rad);
        let turns = [place; 2];
        Some(Ray { loss, departure, arrival, length_m, phase_rad, bounces: 1, is_diffracted: false, turns })
    }

    /// The way from `a` to `b` by two faces, if there is one; `image` is that of `a` in the first one.
    fn bounced_twice(
        &self,
        [first, second]: [&Mirror; 2],
        image: Position,
        [a, b]: [Position; 2],
        around: Surroundings<'_>,
    ) -> Option<Ray> {
        let last = second.bounce(image, b)?;
        let place = first.bounce(a, last)?;
        let lengths_m = [a.distance_m(place), place.distance_m(last), last.distance_m(b)];
        let length_m: f64 = lengths_m.iter().sum();
        let legs = [(a, place), (place, last), (last, b)];
        let is_way = lengths_m.iter().all(|&leg_m| leg_m > 0.0) && length_m <= around.law.max_range_m();
        if !is_way || !legs.iter().all(|&(from, to)| around.is_open(from, to)) {
            return None;
        }
        let bounces = [(first, direction(a, place)), (second, direction(place, last))];
        let (bounce_loss, turn_rad) = self.reflect(&bounces, direction(last, b))?;
        let crossed = legs.iter().fold(Db(0.0), |sum, &(from, to)| sum + around.obstacle_loss(from, to));
        let loss = around.law.path_loss().loss(length_m) + bounce_loss + crossed;
        let (departure, arrival) = (direction(a, place), direction(b, last));
        let phase_rad = wrapped(self.phase_rad(length_m) + turn_rad);
        let turns = [place, last];
        Some(Ray { loss, departure, arrival, length_m, phase_rad, bounces: 2, is_diffracted: false, turns })
    }

    /// The way on one side round an obstacle and all that it goes on in, if there is one: the loss of a knife edge beside that of
    /// the straight line. What goes through on the straight line does not bend, so that a link never has more power than in the open.
    fn bent(&self, obstacle: usize, side: Side, [a, b]: [Position; 2], around: Surroundings<'_>) -> Option<Ray> {
        let Detour { first, last, nu } = self.free_detour(obstacle, side, [a, b], around.obstacles)?;
        let through = around.obstacle_loss(a, b);
        let legs = [(a, first), (first, last), (last, b)];
        if through.0 <= 0.0 || !legs.iter().all(|&(from, to)| around.is_open(from, to)) {
            return None;
        }
        let length_m = legs.iter().map(|&(from, to)| from.distance_m(to)).sum();
        let crossed = legs.iter().fold(Db(0.0), |sum, &(from, to)| sum + around.obstacle_loss(from, to));
        let loss = around.law.path_loss().loss(a.distance_m(b)) + Db(knife_edge_loss_db(nu)) + crossed
            - Db::from_factor(1.0 - (-through).to_factor());
        let (departure, arrival) = (direction(a, first), direction(b, last));
        // Deep in the shadow the field of an edge lags by an eighth of a turn.
        let phase_rad = wrapped(self.phase_rad(length_m) - FRAC_PI_4);
        let turns = [first, last];
        Some(Ray { loss, departure, arrival, length_m, phase_rad, bounces: 0, is_diffracted: true, turns })
    }

    /// The way on one side round an obstacle. Where an edge touches another obstacle, it is no free edge: the way leads round both.
    fn free_detour(&self, obstacle: usize, side: Side, ends: [Position; 2], all: &ObstacleField) -> Option<Detour> {
        let (mut parts, mut edges) = (vec![obstacle], self.edges[obstacle].clone());
        // A line through a joint is on both sides of it.
        let mut places: Vec<Position> = edges.iter().filter_map(|edge| passed(edge, ends)).collect();
        loop {
            let found = if places.is_empty() { Some(detour(&edges, ends, side, self.carrier_ghz)?) } else { None };
            places.extend(found.iter().flat_map(|found| [found.first, found.last]));
            let known = parts.len();
            for part in places.drain(..).flat_map(|place| all.touching(place)) {
                // Round what has no edge, such as a cylinder, there is no way.
                if self.edges[part].is_empty() {
                    return None;
                }
                if !parts.contains(&part) {
                    parts.push(part);
                    edges.extend(&self.edges[part]);
                }
            }
            if found.is_some() && parts.len() == known {
                return found;
            }
        }
    }

    /// Loss by reflections in the directions of the legs before them and the last leg, and by how much they turn the phase
    /// (rad); `None` if nothing is left.
    fn reflect(&self, bounces: &[(&Mirror, Position)], last: Position) -> Option<(Db, f64)> {
        let (mut fixed, mut turns) = (Db(0.0), 0.0);
        let first = bounces.first()?.1;
        let (mut field, mut is_slab) = (Field::along(self.antenna(first)), false);
        for &(mirror, incoming) in bounces {
            match mirror.surface {
                MirrorSurface::Fixed(loss) => {
                    fixed = fixed + loss;
                    turns += PI;
                    field = field.mirrored(mirror.normal());
                }
                MirrorSurface::Slab(slab) => {
                    is_slab = true;
                    field = field.reflected(incoming, mirror.normal(), &slab, self.carrier_ghz);
                }
            }
        }
        if !is_slab {
            return Some((fixed, turns));
        }
        let amplitude: Complex = field.dot(self.antenna(last));
        let loss = fixed.0 - 20.0 * libm::log10(amplitude.abs());
        (loss < MOST_LOSS_DB).then_some((Db(loss), turns + amplitude.arg()))
    }

    /// The unit vector of the field of an antenna for waves that travel in a direction.
    fn antenna(&self, along: Position) -> Position {
        let up = Position::new(0.0, 0.0, 1.0);
        let level = direction(Position::ORIGIN, up.cross(along));
        // Straight up or down any direction is as good.
        let level = if level.length_m() > 0.0 { level } else { Position::new(0.0, 1.0, 0.0) };
        match self.law.polarisation {
            Polarisation::Horizontal => level,
            Polarisation::Vertical => along.cross(level),
        }
    }

    /// Phase after a way (rad).
    fn phase_rad(&self, length_m: f64) -> f64 {
        phase_rad(length_m, self.carrier_ghz)
    }
}

/// Whether two rays are the same way: by an edge of two pieces of a wall, or by their common face.
fn is_same_way(one: &Ray, other: &Ray) -> bool {
    let is_same_place = |i: usize| one.turns[i].distance_m(other.turns[i]) < LEVEL_M;
    one.bounces == other.bounces && one.is_diffracted == other.is_diffracted && is_same_place(0) && is_same_place(1)
}

/// The straight way at a carrier.
pub(crate) fn straight(loss: Db, a: Position, b: Position, carrier_ghz: Option<f64>) -> Ray {
    let (departure, arrival, length_m) = (direction(a, b), direction(b, a), a.distance_m(b));
    let phase_rad = phase_rad(length_m, carrier_ghz.unwrap_or(DEFAULT_CARRIER_GHZ));
    Ray { loss, departure, arrival, length_m, phase_rad, bounces: 0, is_diffracted: false, turns: [a, b] }
}

/// Phase after a way at a carrier (rad).
fn phase_rad(length_m: f64, carrier_ghz: f64) -> f64 {
    wrapped(-TAU * (length_m * carrier_ghz * 1e9 / LIGHT_M_PER_S).fract())
}

/// The same angle from -π to π.
fn wrapped(angle_rad: f64) -> f64 {
    angle_rad - TAU * (angle_rad / TAU).round()
}
