//! All obstacles of a world, and queries about them.

use sextant_kernel::SettingError;

use crate::geometry::bounds::Bounds;
use crate::geometry::position::Position;
use crate::geometry::shape::{LEVEL_M, Sweep};
use crate::geometry::span::Span;
use crate::geometry::tree::Tree;
use crate::obstacles::crossing::Crossing;
use crate::obstacles::obstacle::Obstacle;
use crate::obstacles::together;
use crate::power::Db;
use crate::propagation::material::DB_PER_NEPER;
use crate::propagation::path_budget::ObstacleLoss;

/// Obstacles near a line that touch others.
#[derive(Debug, Default)]
struct Together {
    numbers: Vec<usize>,
    /// Whether the line is in one of them nowhere.
    has_missed: bool,
}

/// All obstacles of a world. Where obstacles overlap, each absorbs as if it were alone: losses add. But walls count once where
/// they overlap, and a line between obstacles that touch is not free.
///
/// The time of a query about a line grows with the number of obstacles near the line, not with the number of all.
/// Every result for a line is the same, bit for bit, if its two ends are exchanged.
#[derive(Clone, Debug, Default)]
pub struct ObstacleField {
    obstacles: Vec<Obstacle>,
    tree: Tree,
    bounds: Option<Bounds>,
    /// Which obstacles may touch others.
    touches: Vec<bool>,
}

/// Smallest radius of a ball for [`ObstacleField::clearance_m`] (m).
const LEAST_RADIUS_M: f64 = 1e-6;

/// Two places in an order that does not depend on which comes first.
#[inline]
fn ordered(from: Position, to: Position) -> (Position, Position) {
    let key = |p: Position| [p.x_m, p.y_m, p.z_m];
    if key(from) <= key(to) { (from, to) } else { (to, from) }
}

impl ObstacleField {
    /// A field of `obstacles`.
    #[must_use]
    pub fn new(obstacles: Vec<Obstacle>) -> Self {
        let boxes = || obstacles.iter().map(|obstacle| obstacle.shape().bounds());
        let tree = Tree::new(boxes());
        let touches = boxes().map(|bounds| tree.meeting(bounds.grown(LEVEL_M)).nth(1).is_some()).collect();
        Self { tree, bounds: boxes().reduce(Bounds::union), obstacles, touches }
    }

    /// The same obstacles for links at a carrier (GHz): materials absorb there what their models say. Beyond the
    /// carriers of a model, the nearest one counts: see [`check_carrier`](Self::check_carrier). Without a carrier,
    /// materials absorb as at 2.45 GHz.
    #[must_use]
    pub fn at_carrier(&self, carrier_ghz: Option<f64>) -> Self {
        let obstacles = self.obstacles.iter().map(|obstacle| obstacle.at_carrier(carrier_ghz)).collect();
        Self { obstacles, tree: self.tree.clone(), bounds: self.bounds, touches: self.touches.clone() }
    }

    /// Checks that the absorption of each material is known at the carrier (GHz). `key` is where an obstacle is written.
    ///
    /// # Errors
    /// The key `material` below that of an obstacle if the model of its material does not hold there.
    pub fn check_carrier(&self, carrier_ghz: f64, key: impl Fn(usize) -> String) -> Result<(), SettingError> {
        for (i, obstacle) in self.obstacles.iter().enumerate() {
            if let Some(material) = obstacle.material() {
                material.check_carrier(carrier_ghz).map_err(|error| error.within(key(i)))?;
            }
        }
        Ok(())
    }

    /// The obstacles, in the order given.
    #[must_use]
    #[inline]
    pub fn obstacles(&self) -> &[Obstacle] {
        &self.obstacles
    }

    /// Number of obstacles.
    #[must_use]
    pub fn len(&self) -> usize {
        self.obstacles.len()
    }

    /// Whether there is no obstacle.
    #[must_use]
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.obstacles.is_empty()
    }

    /// Calls `act` with the number of each obstacle that the straight line between two places, which are in order, crosses, and the
    /// length inside it. The result is those that touch others at the line.
    #[inline]
    fn each_crossed(&self, [from, to]: [Position; 2], mut act: impl FnMut(usize, f64)) -> Together {
        let mut together = Together::default();
        self.tree.each_along(Span::new(from, to), LEVEL_M, |number| {
            let shape = self.obstacles[number].shape();
            let length_m = shape.length_inside_m(from, to);
            if length_m > 0.0 {
                act(number, length_m);
            }
            if self.touches[number] && (length_m > 0.0 || shape.is_near(from, to)) {
                together.numbers.push(number);
                together.has_missed |= length_m <= 0.0;
            }
        });
        together
    }

    /// What a line meets of obstacles that touch, if it is not what it meets of each alone.
    fn met_together(&self, together: &Together, [from, to]: [Position; 2]) -> Option<Vec<Crossing>> {
        let Together { numbers, has_missed } = together;
        let are_walls = || numbers.iter().filter(|&&number| self.obstacles[number].wall().is_some()).nth(1).is_some();
        let may_differ = numbers.len() > 1 && (*has_missed || are_walls());
        if may_differ { together::met(&self.obstacles, numbers, from, to) } else { None }
    }

    /// Replaces `crossings` with those of the straight line from `from` to `to`, by obstacle. A line in the floor of an
    /// obstacle crosses it; one that only touches it, or runs along another face, does not ([`Shape`](crate::Shape)).
    pub fn crossings(&self, from: Position, to: Position, crossings: &mut Vec<Crossing>) {
        crossings.clear();
        let line = ordered(from, to).into();
        let together = self.each_crossed(line, |obstacle, length_m| {
            let passages = self.obstacles[obstacle].shape().passages(line[0], line[1]);
            crossings.push(Crossing { obstacle, length_m, passages });
        });
        if let Some(met) = self.met_together(&together, line) {
            crossings.retain(|crossing| !together.numbers.contains(&crossing.obstacle));
            crossings.extend(met);
        }
        crossings.sort_unstable_by_key(|crossing| crossing.obstacle);
    }

    /// Loss by absorption along the straight line from `from` to `to`: the sum of `10 α d log10(e)` over the
    /// obstacles, d the length inside (Lambert-Bouguer law; thesis eq. 3.16), and the fixed losses of all passages through them. A
    /// line that begins or ends inside an obstacle passes it.
    #[must_use]
    #[inline]
    pub fn loss(&self, from: Position, to: Position) -> Db {
        if self.obstacles.is_empty() {
            return Db(0.0);
        }
        let (mut nepers, mut fixed) = (0.0, Db(0.0));
        let line = ordered(from, to).into();
        let together = self.each_crossed(line, |number, length_m| {
            let obstacle = &self.obstacles[number];
            nepers += obstacle.absorption_per_m() * length_m;
            if obstacle.loss().0 > 0.0 {
                fixed = fixed + obstacle.loss_of(obstacle.shape().passages(line[0], line[1]));
            }
        });
        if self.met_together(&together, line).is_some() {
            return self.losses(from, to).iter().fold(Db(0.0), |sum, one| sum + one.loss());
        }
        Db(DB_PER_NEPER * nepers) + fixed
    }

    /// The loss by each obstacle along the straight line from `from` to `to`, by obstacle. Their sum is [`loss`](Self::loss), but
    /// for rounding.
    #[must_use]
    pub fn losses(&self, from: Position, to: Position) -> Vec<ObstacleLoss> {
        let mut crossings = Vec::new();
        self.crossings(from, to, &mut crossings);
        let loss = |&Crossing { obstacle, length_m, passages }: &Crossing| {
            let crossed = &self.obstacles[obstacle];
            let absorption = Db(DB_PER_NEPER * (crossed.absorption_per_m() * length_m));
            ObstacleLoss { obstacle, length_m, absorption, fixed: crossed.loss_of(passages) }
        };
        crossings.iter().map(loss).collect()
    }

    /// The first solid obstacle that contains `p`, its floor included.
    #[must_use]
    pub fn containing(&self, p: Position) -> Option<usize> {
        let contains = |obstacle: &Obstacle| obstacle.is_solid() && obstacle.shape().contains(p);
        self.tree.holding(p, LEVEL_M).filter(|&obstacle| contains(&self.obstacles[obstacle])).min()
    }

    /// The solid obstacles that go on at a place of an edge: those within a millimetre of it, not only from below.
    pub(crate) fn touching(&self, edge: Position) -> impl Iterator<Item = usize> + '_ {
        let above = edge + Position::new(0.0, 0.0, 2.0 * LEVEL_M);
        let touches = move |obstacle: &Obstacle| obstacle.is_solid() && obstacle.shape().distance_m(above) <= LEVEL_M;
        self.tree.holding(above, LEVEL_M).filter(move |&obstacle| touches(&self.obstacles[obstacle]))
    }

    /// The first solid obstacle that the straight line from `from` to `to` crosses.
    #[must_use]
    pub fn blocking(&self, from: Position, to: Position) -> Option<usize> {
        let line = ordered(from, to).into();
        let mut first: Option<usize> = None;
        let mut together = self.each_crossed(line, |number, _| {
            if self.obstacles[number].is_solid() {
                first = Some(first.map_or(number, |first| first.min(number)));
            }
        });
        first.or_else(|| {
            together.numbers.retain(|&number| self.obstacles[number].is_solid());
            Some(self.met_together(&together, line)?.first()?.obstacle)
        })
    }

    /// The solid obstacles whose boxes are within `margin_m` of a line.
    pub(crate) fn along(&self, span: Span, margin_m: f64) -> impl Iterator<Item = usize> + '_ {
        self.tree.along(span, margin_m).filter(|&obstacle| self.obstacles[obstacle].is_solid())
    }

    /// What is wrong with a place where something should stand, if anything: the value found, and the values allowed.
    #[must_use]
    pub fn fault(&self, position: Position) -> Option<(String, &'static str)> {
        let [x, y, z] = position.into();
        if !position.is_finite() {
            return Some((format!("[{x}, {y}, {z}]"), "finite coordinates in metres"));
        }
        let inside = self.containing(position)?;
        let obstacle = match self.obstacles().get(inside).and_then(|obstacle| obstacle.name()) {
            Some(name) => format!("obstacle `{name}`"),
            None => format!("obstacle {inside}"),
        };
        Some((format!("[{x}, {y}, {z}], inside {obstacle}"), "a place outside all obstacles"))
    }

    /// How far a ball of `radius_m` with its centre at `from` can travel straight in `direction` (of any length above
    /// 0) before it touches a solid obstacle (m), at most `range_m`: the range sensor of a robot.
    ///
    /// Each cast by the geometry library is checked against exact distances and, if it is wrong, replaced by
    /// bisection, so that no obstacle is missed. A ball that touches an obstacle at the start may slide along it or
    /// leave it, but not go deeper. The result is 0 if the centre of the ball is inside an obstacle or the direction
    /// is zero. Radii below 1 µm count as 1 µm.
    #[must_use]
    pub fn clearance_m(&self, from: Position, direction: Position, range_m: f64, radius_m: f64) -> f64 {
        let length = direction.length_m();
        let (true, Some(bounds)) = (range_m > 0.0 && length > 0.0 && length.is_finite(), self.bounds) else {
            let free = range_m > 0.0 && length > 0.0 && length.is_finite();
            return if free { range_m } else { 0.0 };
        };
        let radius_m = radius_m.max(LEAST_RADIUS_M);
        // Nothing can be touched beyond all obstacles, so the search is finite even if the range is not.
        let end_m = from.distance_m(bounds.center()) + bounds.min.distance_m(bounds.max) + radius_m;
        let direction = direction * (1.0 / length);
        let sweep = Sweep { from, direction, range_m: range_m.min(end_m), radius_m };
        let span = Span::new(from, sweep.at(sweep.range_m));
        self.along(span, radius_m + LEVEL_M)
            .filter_map(|obstacle| self.obstacles[obstacle].shape().touch_m(&sweep))
            .fold(range_m, f64::min)
    }

    /// Distance from `p` to the nearest solid obstacle (m): 0 inside an obstacle, infinite without obstacles.
    #[must_use]
    pub fn distance_m(&self, p: Position) -> f64 {
        self.tree.nearest_m(p, |obstacle| {
            let obstacle = &self.obstacles[obstacle];
            if obstacle.is_solid() { obstacle.shape().distance_m(p) } else { f64::INFINITY }
        })
    }

    /// The smallest box around all obstacles; `None` without obstacles.
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds> {
        self.bounds
    }
}
