//! What the log says of one node, and how likely a place is under a law.

use std::sync::OnceLock;

use sextant_channel::{Position, Reception, ReceptionLog};
use sextant_kernel::NodeId;

use super::blur::Blur;
use super::gain_map::{ANY, Directions, GainCell, GainMap, Names, Tops};
use super::law::PatternLaw;
use super::report_law::{Report, ReportTables};
use super::report_views::{ReportFit, ReportView};
use super::sight::{Pose, Sight, Turn};
use super::way_gains::{SeenPlace, WayGains};
use super::ways::KnownWays;
use crate::log_facts::search_box::SearchBox;
use crate::numerics::decades::Decades;
use crate::numerics::normal::{Normal, density, logistic_scale};

/// A gain by which any link is strong enough (dB).
const STRONG_DB: f64 = 200.0;

/// What a node said of the sectors that it heard.
#[derive(Clone, Debug)]
pub(super) enum SectorsHeard {
    Nothing,
    /// It named the best one, by the order of identities, and the log may have its strength (dB).
    Named(usize, Option<f64>),
    /// It reported the SNRs of several.
    Reported(Report),
}

/// What a node said of sectors, seen from one of the places that stand for its posterior.
#[derive(Clone, Copy, Debug)]
pub(super) struct Naming<'a> {
    pub(super) place: Position,
    /// The number of the stop.
    pub(super) stop: usize,
    pub(super) robot: Pose,
    pub(super) heard: &'a SectorsHeard,
    /// Probability of the place.
    pub(super) whole_weight: f64,
    /// Probability of the place, and that the straight way is open.
    pub(super) weight: f64,
    /// Strength of the straight way without gain (dB).
    pub(super) level_db: f64,
}

/// A report of n sectors counts as `TOLD n/(n + UNTOLD)` at most: what the pattern has wrong in a direction, and what a reflection
/// adds, is wrong in several sectors at once.
const TOLD: f64 = 3.0;
const UNTOLD: f64 = 2.0;
/// Outside the stops, the probability of a place falls over this share of their diagonal.
const FALL: f64 = 0.1;
/// How often the strength of a named sector is any, over so many decibels.
const ODD: f64 = 0.05;
const ODD_WIDTH_DB: f64 = 60.0;
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

/// As how much of a report each of its sectors counts.
fn told(report: &Report) -> f64 {
    (TOLD / (report.present.len() as f64 + UNTOLD)).min(1.0)
}

/// The log-probability that a sector is named, of sectors with these gains and this noise (dB).
fn ln_name(gains_dbi: &[f64], sector: usize, noise_db: f64) -> f64 {
    let scale_db = logistic_scale(noise_db);
    let sum: f64 = gains_dbi.iter().map(|gain| libm::exp(((gain - gains_dbi[sector]) / scale_db).min(40.0))).sum();
    libm::log((1.0 - ANY) / sum + ANY / gains_dbi.len() as f64)
}

/// The gains of all sectors by known ways.
struct SectorPowers<'a> {
    /// Of all ways together, with the ripple (dBi).
    dbi: &'a [f64],
    /// The share that was reflected.
    reflected: &'a [f64],
}

impl SectorPowers<'_> {
    fn top_dbi(&self) -> f64 {
        self.dbi.iter().copied().fold(f64::NEG_INFINITY, f64::max)
    }
}

/// A stop that is evidence on a node.
#[derive(Clone, Debug)]
pub(super) struct ListeningStop {
    /// Its number.
    pub(super) stop: usize,
    pub(super) pose: Pose,
    pub(super) received: i32,
    pub(super) missed: i32,
    pub(super) heard: SectorsHeard,
}

/// The stops that are evidence on a node.
#[derive(Clone, Debug)]
pub(super) struct PatternEvidence {
    pub(super) listeners: Vec<ListeningStop>,
    /// Before anything is heard.
    surveyed: SurveyedArea,
}

/// The box of all stops. Nodes are seldom far outside it: a robot drives where it expects them.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurveyedArea {
    low: [f64; 3],
    high: [f64; 3],
    /// Outside, the probability falls by a factor of e over this distance (m).
    fall_m: f64,
}

impl SurveyedArea {
    /// That of a log whose nodes are heard over `reach_m`.
    pub(super) fn of(log: &ReceptionLog, reach_m: f64) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for stop in log.stops() {
            for (axis, value) in <[f64; 3]>::from(stop.position).into_iter().enumerate() {
                low[axis] = low[axis].min(value);
                high[axis] = high[axis].max(value);
            }
        }
        let diagonal_m = (0..3).map(|axis| (high[axis] - low[axis]).powi(2)).sum::<f64>().sqrt();
        Self { low, high, fall_m: FALL * diagonal_m.max(reach_m) }
    }

    /// The logarithm of the probability of a place, relative to one inside.
    fn ln_prior(&self, place: Position) -> f64 {
        let place: [f64; 3] = place.into();
        let off = |axis: usize| (self.low[axis] - place[axis]).max(place[axis] - self.high[axis]).max(0.0);
        -(0..3).map(|axis| off(axis).powi(2)).sum::<f64>().sqrt() / self.fall_m
    }
}

impl PatternEvidence {
    /// That on `node`, for places in a box: the stops that heard it, and those within `reach_m` of the box. `columns` are
    /// the sectors of the antenna.
    pub(super) fn of(
        log: &ReceptionLog,
        node: NodeId,
        within: &SearchBox,
        reach_m: f64,
        columns: &SectorColumns,
        surveyed: SurveyedArea,
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
                    stop: index as usize,
                    pose: Pose::of(stop),
                    received: count(received),
                    missed: count(sent - received),
                    heard,
                });
            }
        }
        Self { listeners, surveyed }
    }
}

/// The sectors of an antenna in a log.
#[derive(Clone, Debug)]
pub(super) struct SectorColumns {
    /// The place of each sector among the gains, by its identity.
    pub(super) places: Vec<Option<usize>>,
    /// Number of sectors.
    pub(super) count: usize,
    /// The least strength that any node reported (dB): weaker sectors are absent.
    pub(super) least_db: f64,
}

/// What the node of a reception said of sectors.
fn heard(log: &ReceptionLog, node: NodeId, entry: Option<&Reception>, columns: &SectorColumns) -> SectorsHeard {
    let Some(entry) = entry else { return SectorsHeard::Nothing };
    let column = |id: u8| columns.places[usize::from(id)];
    let reported = log.sector_snrs(node, entry.stop).iter();
    let present: Vec<(usize, f64)> =
        reported.filter_map(|report| Some((column(report.sector)?, f64::from(report.snr_db)))).collect();
    if !present.is_empty() {
        let is_absent = |sector: &usize| present.iter().all(|(other, _)| other != sector);
        let absent = (0..columns.count).filter(is_absent).collect();
        return SectorsHeard::Reported(Report::new(present, absent, columns.least_db));
    }
    let named = |sector| SectorsHeard::Named(sector, entry.snr_db);
    entry.sector.and_then(column).map_or(SectorsHeard::Nothing, named)
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

/// What likelihoods of a law with a blur read, each made when it is first read. What makes one must not wait for other threads:
/// these may wait for it.
#[derive(Debug, Default)]
pub(super) struct LawTables {
    tops: OnceLock<Tops>,
    names: OnceLock<Names>,
    reports: OnceLock<ReportTables>,
}

/// A law, ready to be asked for likelihoods.
pub(super) struct PatternLikelihood<'a> {
    pub(super) law: &'a PatternLaw,
    pub(super) map: &'a GainMap,
    of_law: &'a LawTables,
    /// How much rougher it is than the law says.
    blur: Blur,
    /// Variance of the strength of a link that a distance does not tell (dB²).
    variance: f64,
    tables: &'a PatternTables,
    turn: Turn,
    /// The ways among known obstacles, if they count.
    ways: Option<&'a KnownWays>,
}

/// What a stop says of a node at a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Prospect {
    /// Distance (decades of a metre).
    pub(super) decades: f64,
    /// The greatest gain of all sectors (dBi), or more than any link needs if its strength is known.
    pub(super) gain_db: f64,
    /// Strength of the straight way without gain, if the node told it (dB), and the probability that this way is open.
    pub(super) level_db: Option<f64>,
    pub(super) open: f64,
}

impl<'a> PatternLikelihood<'a> {
    /// The likelihood with a blur. `of_law` are the tables of the same.
    pub(super) fn new(
        law: &'a PatternLaw,
        map: &'a GainMap,
        of_law: &'a LawTables,
        blur: Blur,
        tables: &'a PatternTables,
    ) -> Self {
        let turn = Turn::by(law.yaw_rad);
        let variance = law.sigma_db * law.sigma_db + blur.extra_db() * blur.extra_db();
        Self { law, map, of_law, blur, variance, tables, turn, ways: None }
    }

    /// The same among known obstacles, if there are any.
    pub(super) fn among(self, ways: Option<&'a KnownWays>) -> Self {
        Self { ways, ..self }
    }

    /// Whether it is not blurred.
    pub(super) fn is_sharp(&self) -> bool {
        self.blur == Blur::NONE
    }

    /// How a place is seen by a robot.
    #[inline]
    pub(super) fn sight(&self, place: Position, robot: &Pose) -> Sight {
        Sight::of(place, robot, self.turn, self.map.directions())
    }

    /// The greatest gain of all sectors (dBi).
    #[inline]
    pub(super) fn top_dbi(&self, cell: GainCell) -> f64 {
        self.of_law.tops.get_or_init(|| self.map.tops(self.law, self.blur.radius())).dbi(cell)
    }

    /// What a stop says of a node at `place`.
    pub(super) fn prospect(&self, listener: &ListeningStop, place: Position) -> Prospect {
        let sight = self.sight(place, &listener.pose);
        let decades = self.tables.decades.of_root(sight.square);
        if let Some(ways) = self.ways {
            return self.along(ways, listener, place, |gains| self.prospect_of(listener, decades, gains));
        }
        let (level_db, open) = match &listener.heard {
            SectorsHeard::Nothing => (None, 1.0),
            SectorsHeard::Named(sector, snr_db) => {
                (snr_db.map(|snr_db| self.level_of_name(*sector, snr_db, sight.cell)), 1.0)
            }
            SectorsHeard::Reported(report) => {
                let fit = self.report(report, sight.cell, decades);
                (Some(fit.level_db), self.law.reports.mixed(fit.ln_open, report.ln_blocked)[1])
            }
        };
        let gain_db = if level_db.is_some() { STRONG_DB } else { self.top_dbi(sight.cell) };
        Prospect { decades, gain_db, level_db, open }
    }

    /// The same where the sectors have these gains.
    fn prospect_of(&self, listener: &ListeningStop, decades: f64, gains: &SectorPowers<'_>) -> Prospect {
        let (level_db, open) = match &listener.heard {
            SectorsHeard::Nothing => (None, 1.0),
            SectorsHeard::Named(sector, snr_db) => (snr_db.map(|snr_db| snr_db - gains.dbi[*sector]), 1.0),
            SectorsHeard::Reported(report) => {
                let fit = self.report_of(report, decades, gains);
                (Some(fit.level_db), self.law.reports.mixed(fit.ln_open, report.ln_blocked)[1])
            }
        };
        let gain_db = if level_db.is_some() { STRONG_DB } else { gains.top_dbi() };
        Prospect { decades, gain_db, level_db, open }
    }

    /// What `act` makes of the gains of all sectors, with their ripple, by the known ways from a stop to `place`.
    #[inline]
    fn along<T>(
        &self,
        ways: &KnownWays,
        listener: &ListeningStop,
        place: Position,
        act: impl FnOnce(&SectorPowers<'_>) -> T,
    ) -> T {
        let (mut gains, mut reflected) = ([0.0; 256], [0.0; 256]);
        let sectors = self.map.sectors();
        let (gains, reflected) = (&mut gains[..sectors], &mut reflected[..sectors]);
        let of_ways = WayGains { map: self.map, ways, mount: self.turn, exponent: self.law.exponent };
        of_ways.towards(SeenPlace { stop: listener.stop, robot: &listener.pose, place }, gains, reflected);
        gains.iter_mut().zip(&self.law.ripple_db).for_each(|(gain, ripple)| *gain += ripple);
        act(&SectorPowers { dbi: gains, reflected })
    }

    fn report_of(&self, report: &Report, decades: f64, gains: &SectorPowers<'_>) -> ReportFit {
        let view = self.reports().view_reflected(report, gains.dbi, gains.reflected, self.variance);
        view.fit(self.expected_db(decades), self.variance)
    }

    /// The log-likelihood of what a stop says of a node at `place`, among known obstacles.
    fn at_stop(&self, ways: &KnownWays, listener: &ListeningStop, place: Position) -> f64 {
        let decades = self.tables.decades.of_root(self.sight(place, &listener.pose).square);
        self.along(ways, listener, place, |gains| {
            let mut sum = 0.0;
            match &listener.heard {
                SectorsHeard::Reported(report) => {
                    let ReportFit { ln_open, .. } = self.report_of(report, decades, gains);
                    return self.law.reports.mixed(ln_open, report.ln_blocked)[0] * told(report);
                }
                SectorsHeard::Named(sector, snr_db) => {
                    let noise_db = libm::hypot(self.law.noise_db, self.blur.extra_db());
                    sum += ln_name(gains.dbi, *sector, noise_db);
                    if let Some(snr_db) = snr_db {
                        return sum + self.ln_strength_of(snr_db - gains.dbi[*sector], decades);
                    }
                }
                SectorsHeard::Nothing => {}
            }
            let s = self.law.heard(&self.tables.normal, gains.top_dbi(), decades);
            sum + f64::from(listener.received) * libm::log(s) + f64::from(listener.missed) * libm::log(1.0 - s)
        })
    }

    fn names(&self) -> &Names {
        self.of_law.names.get_or_init(|| self.map.names(self.law, self.blur.radius()))
    }

    fn reports(&self) -> &ReportTables {
        self.of_law.reports.get_or_init(|| {
            let tables = ReportTables::new(&self.law.reports, libm::hypot(self.law.noise_db, self.blur.extra_db()));
            if self.ways.is_some() { tables.with_reflections() } else { tables }
        })
    }

    /// Strength of the straight way that is expected over so many decades of a metre (dB).
    #[inline]
    fn expected_db(&self, decades: f64) -> f64 {
        self.law.level_db - 10.0 * self.law.exponent * decades
    }

    /// How a report fits a direction over so many decades of a metre.
    #[inline]
    pub(super) fn report(&self, report: &Report, cell: GainCell, decades: f64) -> ReportFit {
        let view = match self.map.directions() {
            Directions::Horizon => report.views.at(self.blur, cell.along(), |corner| {
                let gains = self.map.gains_at(corner);
                self.view(report, |sector| f64::from(gains[sector]))
            }),
            Directions::Sphere => self.view(report, |sector| self.map.gain_dbi(cell, sector)),
        };
        view.fit(self.expected_db(decades), self.variance)
    }

    /// What a report says of a direction in which the pattern has these gains (dBi).
    fn view(&self, report: &Report, gain_dbi: impl Fn(usize) -> f64) -> ReportView {
        let mut gains = [0.0; 256];
        let gains = &mut gains[..self.map.sectors()];
        for (sector, (gain, ripple)) in gains.iter_mut().zip(&self.law.ripple_db).enumerate() {
            *gain = gain_dbi(sector) + ripple;
        }
        self.reports().view(report, gains, self.variance)
    }

    /// The strength of the straight way without gain, if a named sector had this one (dB).
    pub(super) fn level_of_name(&self, sector: usize, snr_db: f64, cell: GainCell) -> f64 {
        snr_db - self.map.gain_dbi(cell, sector) - self.law.ripple_db[sector]
    }

    /// The log-likelihood of the strength of a named sector.
    fn ln_strength(&self, sector: usize, snr_db: f64, cell: GainCell, decades: f64) -> f64 {
        self.ln_strength_of(self.level_of_name(sector, snr_db, cell), decades)
    }

    /// The same of the strength without gain that it tells (dB).
    fn ln_strength_of(&self, level_db: f64, decades: f64) -> f64 {
        let sigma_db = (self.variance + self.law.noise_db * self.law.noise_db).sqrt();
        let off = (level_db - self.expected_db(decades)) / sigma_db;
        libm::log((1.0 - ODD) * density(off) / sigma_db + ODD / ODD_WIDTH_DB)
    }

    /// The log-likelihood of a place.
    pub(super) fn at(&self, evidence: &PatternEvidence, place: Position) -> f64 {
        let (mut sum, mut product) = (evidence.surveyed.ln_prior(place), 1.0_f64);
        for listener in &evidence.listeners {
            if let Some(ways) = self.ways {
                sum += self.at_stop(ways, listener, place);
                continue;
            }
            let sight = self.sight(place, &listener.pose);
            let decades = self.tables.decades.of_root(sight.square);
            // A strength tells more of the link than the packets that it brought.
            match &listener.heard {
                SectorsHeard::Reported(report) => {
                    let ReportFit { ln_open, .. } = self.report(report, sight.cell, decades);
                    sum += self.law.reports.mixed(ln_open, report.ln_blocked)[0] * told(report);
                    continue;
                }
                SectorsHeard::Named(sector, snr_db) => {
                    sum += self.names().ln_probability(sight.cell, *sector);
                    if let &Some(snr_db) = snr_db {
                        sum += self.ln_strength(*sector, snr_db, sight.cell, decades);
                        continue;
                    }
                }
                SectorsHeard::Nothing => {}
            }
            let s = self.law.heard(&self.tables.normal, self.top_dbi(sight.cell), decades);
            product *= match (listener.received, listener.missed) {
                (1, 0) => s,
                (0, 1) => 1.0 - s,
                (received, missed) => s.powi(received) * (1.0 - s).powi(missed),
            };
            if product < 1e-200 {
                sum += libm::log(product.max(f64::MIN_POSITIVE));
                product = 1.0;
            }
        }
        sum + libm::log(product)
    }
}
