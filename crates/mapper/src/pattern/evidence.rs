//! What the log says of one node, and how likely a place is under a law.

use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::NodeId;

use super::gain_map::{Cell, Names};
use super::law::PatternLaw;
use crate::log_facts::search_box::SearchBox;
use crate::numerics::normal::Normal;

/// Nodes are at least so far from a stop (m): the law has no meaning on the antenna itself.
const NEAREST_M: f64 = 0.1;

/// A stop that is evidence on a node.
#[derive(Clone, Copy, Debug)]
pub(super) struct Listener {
    pub(super) place: Position,
    pub(super) received: i32,
    pub(super) missed: i32,
    /// The sector that the node named, by the order of identities.
    pub(super) sector: Option<usize>,
}

/// The stops that are evidence on a node.
#[derive(Clone, Debug)]
pub(super) struct Evidence {
    pub(super) listeners: Vec<Listener>,
}

impl Evidence {
    /// That on `node`, for places in a box: the stops that heard it, and those within `reach_m` of the box. `columns` are
    /// the sectors by identity.
    pub(super) fn of(
        log: &ReceptionLog,
        node: NodeId,
        within: &SearchBox,
        reach_m: f64,
        columns: &[Option<usize>],
    ) -> Self {
        let mut entries = log.of(node).iter().peekable();
        let count = |packets: u32| i32::try_from(packets).unwrap_or(i32::MAX);
        let mut listeners = Vec::new();
        for (index, stop) in (0_u32..).zip(log.stops()) {
            let entry = entries.next_if(|entry| entry.stop == index);
            let (received, sent) = entry.map_or((0, 1), |entry| (entry.received, entry.sent));
            let near = within.nearest(stop.position).distance_m(stop.position) <= reach_m;
            if sent > 0 && (received > 0 || near) {
                let sector = entry.and_then(|entry| entry.sector).and_then(|id| columns[usize::from(id)]);
                listeners.push(Listener {
                    place: stop.position,
                    received: count(received),
                    missed: count(sent - received),
                    sector: sector.filter(|_| received > 0),
                });
            }
        }
        Self { listeners }
    }
}

/// A law, ready to be asked for likelihoods.
pub(super) struct Likelihood<'a> {
    pub(super) law: &'a PatternLaw,
    pub(super) names: &'a Names,
    pub(super) normal: &'a Normal,
    /// Cosine and sine of the yaw.
    turn: [f64; 2],
}

/// How a place is seen from a stop.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sight {
    pub(super) cell: Cell,
    pub(super) distance_m: f64,
}

impl Sight {
    /// How `place` is seen from `stop` by an antenna that is turned by the angle with this cosine and sine.
    #[inline]
    pub(super) fn of(place: Position, stop: Position, [cos, sin]: [f64; 2]) -> Self {
        let apart = place - stop;
        let distance_m = apart.dot(apart).sqrt();
        let direction = if distance_m > 1e-9 {
            [cos * apart.x_m + sin * apart.y_m, cos * apart.y_m - sin * apart.x_m, apart.z_m]
        } else {
            [1.0, 0.0, 0.0]
        };
        Self { cell: Cell::of(direction), distance_m: distance_m.max(NEAREST_M) }
    }
}

impl<'a> Likelihood<'a> {
    pub(super) fn new(law: &'a PatternLaw, names: &'a Names, normal: &'a Normal) -> Self {
        Self { law, names, normal, turn: [libm::cos(law.yaw_rad), libm::sin(law.yaw_rad)] }
    }

    /// How a place is seen from a stop.
    #[inline]
    pub(super) fn sight(&self, place: Position, stop: Position) -> Sight {
        Sight::of(place, stop, self.turn)
    }

    /// The log-likelihood of a place.
    pub(super) fn at(&self, evidence: &Evidence, place: Position) -> f64 {
        let (mut sum, mut product) = (0.0, 1.0_f64);
        for listener in &evidence.listeners {
            let sight = self.sight(place, listener.place);
            let s = self.law.heard(self.normal, self.names.top_dbi(sight.cell), sight.distance_m);
            product *= match (listener.received, listener.missed) {
                (1, 0) => s,
                (0, 1) => 1.0 - s,
                (received, missed) => s.powi(received) * (1.0 - s).powi(missed),
            };
            if product < 1e-200 {
                sum += libm::log(product.max(f64::MIN_POSITIVE));
                product = 1.0;
            }
            if let Some(sector) = listener.sector {
                sum += self.names.ln_probability(sight.cell, sector);
            }
        }
        sum + libm::log(product)
    }
}
