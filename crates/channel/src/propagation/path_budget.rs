//! The loss between two places, item by item.

use crate::power::{Db, Dbm, Milliwatts};
use crate::propagation::path_loss::DistanceLoss;
use crate::propagation::reflection::Ray;

/// What the loss between two places consists of: [`Channel::budget`](crate::Channel::budget).
#[derive(Clone, Debug, PartialEq)]
pub struct PathBudget {
    /// Distance (m).
    pub distance_m: f64,
    /// Loss with distance along the straight line.
    pub distance: DistanceLoss,
    /// Each obstacle that the straight line crosses, by its index. Empty if obstacles do not absorb.
    pub obstacles: Vec<ObstacleLoss>,
    /// Loss by all these obstacles together.
    pub obstacle_loss: Db,
    /// The straight line as a ray.
    pub direct: Ray,
    /// The reflections and ways round edges, the strongest first; `None` if the channel has none at all.
    pub reflections: Option<Vec<Ray>>,
}

/// The loss by one obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObstacleLoss {
    /// Index of the obstacle in its field.
    pub obstacle: usize,
    /// Length of the line inside it (m), above 0; 0 for a piece of a wall that is inside stronger ones.
    pub length_m: f64,
    /// Loss by absorption over this length.
    pub absorption: Db,
    /// Loss that does not depend on the length, for all passages.
    pub fixed: Db,
}

impl ObstacleLoss {
    /// The whole loss.
    #[must_use]
    pub fn loss(&self) -> Db {
        self.absorption + self.fixed
    }
}

impl PathBudget {
    /// Power by the straight line alone, at the transmit power `tx`.
    #[must_use]
    pub fn direct_power(&self, tx: Dbm) -> Dbm {
        tx - self.distance.total() - self.obstacle_loss
    }

    /// All rays: the straight line, then the others, the strongest first.
    #[must_use]
    pub fn rays(&self) -> Vec<Ray> {
        std::iter::once(self.direct).chain(self.reflections.iter().flatten().copied()).collect()
    }

    /// Mean received power at the transmit power `tx`, without antennas and shadowing: the one of
    /// [`Channel::mean_power`](crate::Channel::mean_power), bit for bit.
    #[must_use]
    pub fn mean_power(&self, tx: Dbm) -> Dbm {
        let Some(reflections) = &self.reflections else { return self.direct_power(tx) };
        let direct = self.distance.total() + self.obstacle_loss;
        let losses = std::iter::once(direct).chain(reflections.iter().map(|ray| ray.loss));
        losses.map(|loss| (tx - loss).to_milliwatts()).sum::<Milliwatts>().to_dbm()
    }
}
