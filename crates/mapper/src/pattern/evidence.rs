//! What the log says of one node, and how likely a place is under a law.

use sextant_channel::{Position, Reception, ReceptionLog, Stop};
use sextant_kernel::NodeId;

use super::gain_map::{GainCell, GainMap, Names};
use super::law::PatternLaw;
use crate::log_facts::search_box::SearchBox;
use crate::numerics::decades::Decades;
use crate::numerics::normal::Normal;

/// Nodes are at least so far from a stop (m): the law has no meaning on the antenna itself.
const NEAREST_M: f64 = 0.1;

/// What a node said of the sectors that it heard.
#[derive(Clone, Debug)]
pub(super) enum SectorsHeard {
    Nothing,
    /// It named the best one, by the order of identities.
    Named(usize),
    /// It reported the SNRs of several (dB).
    Reported(Vec<(usize, f64)>),
}

/// A report of fewer sectors tells no more than the best one does.
const LEAST_REPORTED: usize = 3;
/// A report counts as so many sectors at most: what the pattern has wrong in a direction is wrong in several sectors at
/// once. In a blurred direction all are.
const TOLD: f64 = 6.0;
const TOLD_BLURRED: f64 = 4.0;
/// A residual of a report counts as one of so many standard deviations at most.
const OUTLIER: f64 = 4.0;

/// The log-likelihood of a report where the sectors have these `gains` with their ripple, but for a constant. The level of
/// all SNRs is not known: residuals are from their mean. Strengths have the standard deviation `noise_db`.
pub(crate) fn of_report(report: &[(usize, f64)], gain: impl Fn(usize) -> f64, noise_db: f64) -> f64 {
    let count = report.len() as f64;
    let mean = report.iter().map(|&(sector, snr_db)| snr_db - gain(sector)).sum::<f64>() / count;
    let square = |&(sector, snr_db): &(usize, f64)| {
        let off = (snr_db - gain(sector) - mean) / noise_db;
        (off * off).min(OUTLIER * OUTLIER)
    };
    -0.5 * report.iter().map(square).sum::<f64>() - (count - 1.0) * libm::log(noise_db)
}

/// A stop that is evidence on a node.
#[derive(Clone, Debug)]
pub(super) struct ListeningStop {
    pub(super) pose: Pose,
    pub(super) received: i32,
    pub(super) missed: i32,
    pub(super) heard: SectorsHeard,
}

/// The stops that are evidence on a node.
#[derive(Clone, Debug)]
pub(super) struct PatternEvidence {
    pub(super) listeners: Vec<ListeningStop>,
}

impl PatternEvidence {
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
                let heard =
                    if received > 0 { heard(log, node, entry.as_ref(), columns) } else { SectorsHeard::Nothing };
                listeners.push(ListeningStop {
                    pose: Pose::of(stop),
                    received: count(received),
                    missed: count(sent - received),
                    heard,
                });
            }
        }
        Self { listeners }
    }
}

/// What the node of a reception said of sectors.
fn heard(log: &ReceptionLog, node: NodeId, entry: Option<&Reception>, columns: &[Option<usize>]) -> SectorsHeard {
    let Some(entry) = entry else { return SectorsHeard::Nothing };
    let column = |id: u8| columns[usize::from(id)];
    let reported = log.sector_snrs(node, entry.stop).iter();
    let reported: Vec<(usize, f64)> =
        reported.filter_map(|report| Some((column(report.sector)?, f64::from(report.snr_db)))).collect();
    if reported.len() >= LEAST_REPORTED {
        return SectorsHeard::Reported(reported);
    }
    entry.sector.and_then(column).map_or(SectorsHeard::Nothing, SectorsHeard::Named)
}

/// Functions in tables.
#[derive(Clone, Debug)]
pub(super) struct PatternTables {
    pub(super) normal: Normal,
    pub(super) decades: Decades,
}

impl PatternTables {
    pub(super) fn new() -> Self {
        Self { normal: Normal::new(), decades: Decades::new() }
    }
}

/// A law, ready to be asked for likelihoods.
pub(super) struct PatternLikelihood<'a> {
    pub(super) law: &'a PatternLaw,
    pub(super) map: &'a GainMap,
    pub(super) names: &'a Names,
    /// How much rougher it is than the law says (dB).
    blur_db: f64,
    tables: &'a PatternTables,
    turn: Turn,
}

/// How far an antenna is turned.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turn {
    cos: f64,
    sin: f64,
}

impl Turn {
    /// Counterclockwise by an angle (rad).
    pub(super) fn by(yaw_rad: f64) -> Self {
        Self { cos: libm::cos(yaw_rad), sin: libm::sin(yaw_rad) }
    }

    /// This turn after another one.
    fn after(self, first: Self) -> Self {
        Self { cos: self.cos * first.cos - self.sin * first.sin, sin: self.sin * first.cos + self.cos * first.sin }
    }
}

/// Where a robot listened, and how it was turned there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pose {
    pub(super) place: Position,
    turn: Turn,
}

impl Pose {
    /// That at a stop. Without a heading the robot is not turned.
    pub(super) fn of(stop: &Stop) -> Self {
        Self { place: stop.position, turn: stop.heading_rad.map_or(Turn { cos: 1.0, sin: 0.0 }, Turn::by) }
    }
}

/// How a place is seen from a stop.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sight {
    pub(super) cell: GainCell,
    /// Square of the distance (m²).
    pub(super) square: f64,
}

impl Sight {
    /// How `place` is seen by a robot whose antenna is turned on it by `mount`.
    #[inline]
    pub(super) fn of(place: Position, robot: &Pose, mount: Turn) -> Self {
        let Turn { cos, sin } = mount.after(robot.turn);
        let apart = place - robot.place;
        let square = apart.dot(apart);
        let direction = if square > 1e-18 {
            [cos * apart.x_m + sin * apart.y_m, cos * apart.y_m - sin * apart.x_m, apart.z_m]
        } else {
            [1.0, 0.0, 0.0]
        };
        Self { cell: GainCell::of(direction), square: square.max(NEAREST_M * NEAREST_M) }
    }
}

impl<'a> PatternLikelihood<'a> {
    /// The likelihood with strengths that have an error of `blur_db` more. `names` are those of the same.
    pub(super) fn new(
        law: &'a PatternLaw,
        map: &'a GainMap,
        names: &'a Names,
        blur_db: f64,
        tables: &'a PatternTables,
    ) -> Self {
        let turn = Turn::by(law.yaw_rad);
        Self { law, map, names, blur_db, tables, turn }
    }

    /// Whether it is not blurred.
    pub(super) fn is_sharp(&self) -> bool {
        self.blur_db <= 0.0
    }

    /// The log-likelihood of a report, which tells no more than some of its sectors.
    fn of_report(&self, report: &[(usize, f64)], cell: GainCell) -> f64 {
        let gain = |sector| self.map.gain_dbi(cell, sector) + self.law.ripple_db[sector];
        let told = of_report(report, gain, libm::hypot(self.law.noise_db, self.blur_db));
        let most = if self.is_sharp() { TOLD } else { TOLD_BLURRED };
        told * (most / report.len() as f64).min(1.0)
    }

    /// How a place is seen by a robot.
    #[inline]
    pub(super) fn sight(&self, place: Position, robot: &Pose) -> Sight {
        Sight::of(place, robot, self.turn)
    }

    /// The log-likelihood of a place.
    pub(super) fn at(&self, evidence: &PatternEvidence, place: Position) -> f64 {
        let (mut sum, mut product) = (0.0, 1.0_f64);
        for listener in &evidence.listeners {
            let sight = self.sight(place, &listener.pose);
            let decades = self.tables.decades.of_root(sight.square);
            let s = self.law.heard(&self.tables.normal, self.names.top_dbi(sight.cell), decades);
            product *= match (listener.received, listener.missed) {
                (1, 0) => s,
                (0, 1) => 1.0 - s,
                (received, missed) => s.powi(received) * (1.0 - s).powi(missed),
            };
            if product < 1e-200 {
                sum += libm::log(product.max(f64::MIN_POSITIVE));
                product = 1.0;
            }
            sum += match &listener.heard {
                SectorsHeard::Nothing => 0.0,
                SectorsHeard::Named(sector) => self.names.ln_probability(sight.cell, *sector),
                SectorsHeard::Reported(report) => self.of_report(report, sight.cell),
            };
        }
        sum + libm::log(product)
    }
}
