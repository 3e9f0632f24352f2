//! Ways by image sources.
//!
//! Which faces a stop and a place see each other in changes slowly from place to place, and is worked out once for all places near
//! a vertex of a lattice. Where the images of these faces are, and in which direction a signal leaves the stop, is exact for each
//! place, as is what the obstacles absorb on the straight way.

use std::sync::OnceLock;

use sextant_channel::{Channel, Position, Ray};
use sextant_kernel::Seed;

use super::{KnownObstacles, Way};
use crate::numerics::whole;

/// Vertices of the lattice, for all stops together, and their least distance (m).
const MOST: f64 = 200_000.0;
const LEAST_STEP_M: f64 = 0.1;
/// Ways that lose more beside the straight one are not seen (dB).
const UNSEEN_DB: f64 = 45.0;
/// Turns between directions that differ by less are none.
const SAME: f64 = 1e-9;

/// The ways from the stops of a log to all places.
#[derive(Debug)]
pub(in crate::pattern) struct KnownWays {
    channel: Channel,
    stops: Vec<Position>,
    low: [f64; 3],
    counts: [usize; 3],
    step_m: f64,
    /// By stop, then by vertex: the images of the stop that are seen from there.
    images: Vec<OnceLock<Box<[Image]>>>,
}

/// An image of a stop in one face or two.
#[derive(Clone, Copy, Debug)]
struct Image {
    place: Position,
    /// Normals of the faces, the one that is nearer to the stop first; zero for none.
    normals: [Position; 2],
    /// What the faces, and obstacles on the way, take (dB).
    loss_db: f64,
}

impl Image {
    /// That by which a ray comes to `place`, if it is reflected; `by_distance_db` of its loss is that of its length.
    fn of(ray: &Ray, place: Position, by_distance_db: f64) -> Option<Self> {
        let onward = ray.arrival * -1.0;
        let between = unit(ray.turns[1] - ray.turns[0]);
        let turned = match ray.bounces {
            1 => [unit(onward - ray.departure), Position::ORIGIN],
            2 => [unit(between - ray.departure), unit(onward - between)],
            _ => return None,
        };
        let image = place + ray.arrival * ray.length_m;
        Some(Self { place: image, normals: turned, loss_db: ray.loss.0 - by_distance_db })
    }

    /// The way from the stop to `place`.
    fn way(&self, place: Position) -> Way {
        let apart = place - self.place;
        let length_m = apart.length_m();
        let [first, last] = self.normals;
        let direction = mirrored(mirrored(apart * (1.0 / length_m), last), first);
        Way { direction, length_m, loss_db: self.loss_db }
    }
}

fn unit(along: Position) -> Position {
    let length = along.length_m();
    if length > SAME { along * (1.0 / length) } else { Position::ORIGIN }
}

fn mirrored(direction: Position, normal: Position) -> Position {
    direction - normal * (2.0 * direction.dot(normal))
}

impl KnownWays {
    /// Those from `stops` among obstacles, to places within `reach_m` and in these heights (m).
    pub(in crate::pattern) fn new(
        known: &KnownObstacles<'_>,
        stops: Vec<Position>,
        reach_m: f64,
        heights: [f64; 2],
    ) -> Self {
        let &KnownObstacles { law, field: obstacles } = known;
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for stop in &stops {
            for (axis, value) in <[f64; 3]>::from(*stop).into_iter().enumerate() {
                low[axis] = low[axis].min(value - reach_m);
                high[axis] = high[axis].max(value + reach_m);
            }
        }
        // Beyond all obstacles nothing is reflected, but off their outsides.
        if let Some(bounds) = obstacles.bounds() {
            let (least, most): ([f64; 3], [f64; 3]) = (bounds.min.into(), bounds.max.into());
            for axis in 0..2 {
                (low[axis], high[axis]) = (low[axis].max(least[axis]), high[axis].min(most[axis]));
            }
        }
        [low[2], high[2]] = heights;
        let sides = [0, 1, 2].map(|axis| (high[axis] - low[axis]).max(0.0));
        let axes: Vec<f64> = sides.into_iter().filter(|&side| side > 0.0).collect();
        let of_stop = MOST / stops.len().max(1) as f64;
        let volume: f64 = axes.iter().product();
        let step_m = libm::pow(volume / of_stop, 1.0 / axes.len().max(1) as f64).max(LEAST_STEP_M);
        let counts = sides.map(|side| whole((side / step_m).round()) + 1);
        let vertices = counts.iter().product::<usize>() * stops.len();
        let images = std::iter::repeat_with(OnceLock::new).take(vertices).collect();
        Self { channel: Channel::new(law, obstacles.clone(), Seed(0)), stops, low, counts, step_m, images }
    }

    /// The straight way from a stop to a place.
    pub(in crate::pattern) fn straight(&self, stop: usize, place: Position) -> Way {
        let from = self.stops[stop];
        let apart = place - from;
        let length_m = apart.length_m();
        let direction = if length_m > SAME { apart * (1.0 / length_m) } else { Position::new(1.0, 0.0, 0.0) };
        Way { direction, length_m, loss_db: self.channel.obstacle_loss(from, place).0 }
    }

    /// Acts on each reflected way from a stop to a place.
    pub(in crate::pattern) fn each_reflected(&self, stop: usize, place: Position, act: impl FnMut(Way)) {
        let Some(vertex) = self.vertex(place) else { return };
        let vertices: usize = self.counts.iter().product();
        let images = self.images[stop * vertices + vertex].get_or_init(|| self.images_seen(stop, vertex));
        images.iter().map(|image| image.way(place)).for_each(act);
    }

    /// The vertex that is nearest to a place; none outside.
    fn vertex(&self, place: Position) -> Option<usize> {
        let mut vertex = 0;
        let place: [f64; 3] = place.into();
        for axis in [2, 1, 0] {
            let at = ((place[axis] - self.low[axis]) / self.step_m).round();
            if at < 0.0 || at >= self.counts[axis] as f64 {
                return None;
            }
            vertex = vertex * self.counts[axis] + whole(at);
        }
        Some(vertex)
    }

    fn images_seen(&self, stop: usize, vertex: usize) -> Box<[Image]> {
        let at = |axis: usize, index: usize| self.low[axis] + self.step_m * index as f64;
        let [x, y, _] = self.counts;
        let place = Position::new(at(0, vertex % x), at(1, vertex / x % y), at(2, vertex / (x * y)));
        let mut rays = Vec::new();
        self.channel.rays(self.stops[stop], place, &mut rays);
        let Some(straight) = rays.first() else { return Box::default() };
        let by_distance = |ray: &Ray| self.channel.law().path_loss().loss(ray.length_m).0;
        let open_db = by_distance(straight);
        let is_seen = |ray: &&Ray| ray.loss.0 - open_db < UNSEEN_DB;
        let seen = rays.iter().skip(1).filter(is_seen);
        seen.filter_map(|ray| Image::of(ray, place, by_distance(ray))).collect()
    }
}

#[cfg(test)]
mod tests {
    use sextant_channel::{
        BoxConfig, ChannelConfig, ChannelLaw, CloseInConfig, Obstacle, ObstacleConfig, ObstacleField, PathLossConfig,
        ReflectionsConfig, ShapeConfig,
    };

    use super::*;

    /// Walls of a room from 0 to 8 m and from 0 to 6 m.
    fn room() -> ObstacleField {
        let wall = |x: f64, y: f64, sides: [f64; 3]| {
            let shape = BoxConfig::new(Position::new(x, y, 0.0), sides);
            let wall = ObstacleConfig::of(ShapeConfig::Box(shape), "concrete");
            Obstacle::try_from(wall).expect("a wall")
        };
        ObstacleField::new(vec![
            wall(4.0, -0.1, [8.4, 0.2, 3.0]),
            wall(4.0, 6.1, [8.4, 0.2, 3.0]),
            wall(-0.1, 3.0, [0.2, 6.0, 3.0]),
            wall(8.1, 3.0, [0.2, 6.0, 3.0]),
        ])
    }

    fn ways(order: u8) -> KnownWays {
        let config = ChannelConfig {
            environment: None,
            path_loss: Some(PathLossConfig::CloseIn(CloseInConfig {
                carrier_ghz: Some(60.48),
                exponent: Some(2.0),
                ..CloseInConfig::default()
            })),
            reflections: Some(ReflectionsConfig { loss_db: Some(7.0), order, most: 12, ..Default::default() }),
            ..ChannelConfig::default()
        };
        let law = ChannelLaw::try_from(config).expect("a law");
        KnownWays::new(&KnownObstacles { law, field: &room() }, vec![Position::new(1.5, 1.5, 0.0)], 20.0, [0.0, 0.0])
    }

    fn found(ways: &KnownWays, place: Position) -> Vec<Way> {
        let mut found = vec![ways.straight(0, place)];
        ways.each_reflected(0, place, |way| found.push(way));
        found
    }

    /// Images by hand: mirrored once in each of four walls, and twice in each pair.
    #[test]
    fn ways_in_a_room_are_those_of_the_images_by_hand() {
        let (stop, place) = ([1.5, 1.5], Position::new(5.237, 3.811, 0.0));
        let (mut once, mut twice) = (Vec::new(), Vec::new());
        for (x, of_x) in [(1.5, 0), (-1.5, 1), (16.0 - 1.5, 1), (16.0 + 1.5, 2), (-16.0 + 1.5, 2)] {
            for (y, of_y) in [(1.5, 0), (-1.5, 1), (12.0 - 1.5, 1), (12.0 + 1.5, 2), (-12.0 + 1.5, 2)] {
                let apart = [place.x_m - x, place.y_m - y];
                // A signal that is mirrored an odd number of times along an axis leaves the other way.
                let sign = |bounces: u32| if bounces % 2 == 1 { -1.0 } else { 1.0 };
                let length_m = libm::hypot(apart[0], apart[1]);
                let of = [sign(of_x) * apart[0] / length_m, sign(of_y) * apart[1] / length_m, length_m];
                match of_x + of_y {
                    1 => once.push(of),
                    2 => twice.push(of),
                    _ => {}
                }
            }
        }
        assert_eq!((once.len(), twice.len()), (4, 8), "{stop:?}");
        for (order, wanted) in [(1, once.clone()), (2, [once, twice].concat())] {
            let ways = ways(order);
            let found = found(&ways, place);
            assert_eq!(found.len(), 1 + wanted.len(), "{found:?}");
            assert!(found[0].loss_db.abs() < 1e-9 && (found[0].length_m - 4.394).abs() < 1e-3, "{:?}", found[0]);
            for way in &found[1..] {
                let Position { x_m, y_m, .. } = way.direction;
                let off = |of: &[f64; 3]| (of[0] - x_m).abs() + (of[1] - y_m).abs() + (of[2] - way.length_m).abs();
                let nearest = wanted.iter().map(off).fold(f64::INFINITY, f64::min);
                assert!(nearest < 1e-6, "{way:?} is {nearest} from an image");
                let losses = way.loss_db / 7.0;
                assert!((losses - losses.round()).abs() < 1e-6 && losses > 0.5, "{way:?}");
            }
        }
    }

    #[test]
    fn a_straight_way_through_a_wall_loses_what_the_wall_takes() {
        let ways = ways(1);
        let outside = ways.straight(0, Position::new(1.5, -1.0, 0.0));
        assert!(outside.loss_db > 20.0, "{outside:?}");
        let mut reflected = 0;
        ways.each_reflected(0, Position::new(1.5, -3.0, 0.0), |_| reflected += 1);
        assert_eq!(reflected, 0);
    }
}
