//! The anchors of one node, prepared for the search.

use sextant_channel::{Position, Stop, Wedge};
use sextant_kernel::{RobotId, SimTime};

use super::search_set::BLOCK;
use super::{HeardAnchor, OwnPlace};
use crate::grid_ml::solver::{Edges, ReceptionCurve, Wedges};
use crate::lattice::Lattice;
use crate::log_facts::heights::{Heights, SoughtHeights};
use crate::log_facts::{SectorTolerance, SilenceRule};
use crate::numerics::normal::Normal;

/// Anchors further than this many ranges from the others are left out: their places are wrong.
const FAR: f64 = 100.0;

/// The evidence on the place of one node.
#[derive(Debug)]
pub(super) struct AnchorEvidence<'a> {
    pub(super) lattice: Lattice,
    pub(super) heights: Heights,
    pub(super) curve: &'a ReceptionCurve,
    pub(super) clamped: &'a ReceptionCurve,
    pub(super) normal: &'a Normal,
    /// The sectors of all anchors.
    pub(super) wedges: Wedges,
    /// The same with edges that hold all places within half the diagonal of a block.
    pub(super) wide: Wedges,
    pub(super) heard: Vec<KnownAnchor>,
    pub(super) silent: Vec<KnownAnchor>,
    /// Anchors that are left out as their places are far from all others: so many conditions are broken anywhere.
    pub(super) astray: usize,
}

/// One anchor.
#[derive(Clone, Copy, Debug)]
pub(super) struct KnownAnchor {
    pub(super) place: Position,
    pub(super) packets: i32,
    pub(super) sector: Option<Sector>,
    pub(super) covariance: Option<[[f64; 3]; 3]>,
    /// Largest standard deviation of the place along an axis (m).
    pub(super) sigma_m: f64,
}

/// A sector of an anchor.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sector {
    /// Its index among the wedges.
    pub(super) index: usize,
    pub(super) wedge: Wedge,
    pub(super) azimuth_sigma_rad: f64,
}

impl<'a> AnchorEvidence<'a> {
    /// `None` if no anchor was heard.
    pub(super) fn new(settings: &'a OwnPlace, heard: &[HeardAnchor], silent: &[HeardAnchor]) -> Option<Self> {
        let range_m = settings.curve.range_m;
        let mut sectors = Vec::new();
        let mut known = |anchors: &[HeardAnchor]| -> Vec<KnownAnchor> {
            let usable = anchors.iter().filter(|anchor| anchor.packets > 0 && anchor.place.is_within_reason());
            usable.map(|anchor| KnownAnchor::new(anchor, settings.tolerance, &mut sectors)).collect()
        };
        let (mut heard, mut silent) = (known(heard), known(silent));
        let all = heard.len();
        let middle = most_surrounded(&heard, 2.0 * range_m)?;
        heard.retain(|anchor| anchor.place.distance_m(middle) <= FAR * range_m);
        let stops: Vec<Stop> = heard
            .iter()
            .map(|anchor| Stop { robot: RobotId(0), time: SimTime::ZERO, position: anchor.place, heading_rad: None })
            .collect();
        let lattice = Lattice::covering(&stops, range_m, settings.grid_step_m, settings.z_range_m, u64::MAX).ok()?;
        // Beyond the range of every heard anchor no vertex is looked at.
        silent.retain(|anchor| heard.iter().any(|other| other.place.distance_m(anchor.place) <= 2.0 * range_m));
        let edges = Edges::of(settings.tolerance, &lattice, range_m);
        let of =
            |edges| Wedges::of_sectors(sectors.iter().copied().enumerate(), edges, SilenceRule::Everywhere, false);
        let wide = of(edges.widened(half_diagonal_m(&lattice)));
        let wedges = of(edges);
        Some(Self {
            heights: SoughtHeights::of(&stops, settings.z_range_m, range_m)?.heights(),
            lattice,
            curve: &settings.curve,
            clamped: &settings.clamped,
            normal: &settings.normal,
            wedges,
            wide,
            astray: all - heard.len(),
            heard,
            silent,
        })
    }

    /// Number of conditions that a place breaks.
    pub(super) fn violations(&self, place: Position) -> usize {
        self.astray + self.heard.iter().map(|anchor| self.broken(anchor, place)).sum::<usize>()
    }

    /// Number of conditions that every vertex of the block round `middle` breaks, at least.
    pub(super) fn surely_broken(&self, middle: Position) -> usize {
        let apart_m = half_diagonal_m(&self.lattice);
        let reach = (self.curve.range_m + apart_m).powi(2);
        let broken = |anchor: &KnownAnchor| {
            let apart = middle - anchor.place;
            let is_outside = anchor.sector.is_some_and(|sector| !self.wide.admits(sector.index, apart.into()));
            usize::from(apart.dot(apart) > reach) + usize::from(is_outside)
        };
        self.heard.iter().map(broken).sum()
    }

    fn broken(&self, anchor: &KnownAnchor, place: Position) -> usize {
        let is_beyond = anchor.place.distance_m(place) >= self.curve.range_m;
        usize::from(is_beyond) + usize::from(!self.is_in_sector(anchor, place))
    }

    /// Whether a place is in the sector in which an anchor was heard, if it has one.
    pub(super) fn is_in_sector(&self, anchor: &KnownAnchor, place: Position) -> bool {
        anchor.sector.is_none_or(|sector| self.wedges.admits(sector.index, (place - anchor.place).into()))
    }

    /// Probability that the packets of the silent anchors are missed at a place.
    pub(super) fn missed(&self, curve: &ReceptionCurve, place: Position) -> LogProduct {
        let mut product = LogProduct::default();
        for anchor in self.silent.iter().filter(|anchor| self.is_in_sector(anchor, place)) {
            let apart = place - anchor.place;
            product.multiply(1.0 - curve.at(apart.dot(apart)), anchor.packets);
        }
        product
    }
}

impl KnownAnchor {
    fn new(anchor: &HeardAnchor, tolerance: SectorTolerance, sectors: &mut Vec<Wedge>) -> Self {
        let sector = anchor.sector.filter(|_| tolerance != SectorTolerance::Unlimited).map(|sector| {
            sectors.push(sector.wedge);
            // An orientation that is no number is unknown.
            let sigma = sector.azimuth_sigma_rad;
            let azimuth_sigma_rad = if sigma.is_nan() { f64::INFINITY } else { sigma.abs() };
            Sector { index: sectors.len() - 1, wedge: sector.wedge, azimuth_sigma_rad }
        });
        let covariance = anchor.covariance.filter(|c| c.iter().flatten().all(|value| value.is_finite()));
        let variance = |c: [[f64; 3]; 3]| (0..3).map(|axis| c[axis][axis]).fold(0.0, f64::max);
        Self {
            place: anchor.place,
            packets: i32::try_from(anchor.packets).unwrap_or(i32::MAX),
            sector,
            covariance,
            sigma_m: covariance.map_or(0.0, |c| variance(c).sqrt()),
        }
    }
}

/// Half the diagonal of a block of vertices, with some room for rounding (m).
fn half_diagonal_m(lattice: &Lattice) -> f64 {
    0.5 * (BLOCK - 1) as f64 * lattice.step_m() * 3.0_f64.sqrt() + 1e-6
}

/// A product of many probabilities as a logarithm.
#[derive(Clone, Copy, Debug)]
pub(super) struct LogProduct {
    sum: f64,
    product: f64,
}

impl Default for LogProduct {
    fn default() -> Self {
        Self { sum: 0.0, product: 1.0 }
    }
}

impl LogProduct {
    /// Multiplies by `probability` to the power of `packets`.
    #[inline]
    pub(super) fn multiply(&mut self, probability: f64, packets: i32) {
        if packets == 1 {
            self.product *= probability;
        } else if packets > 16 {
            self.sum += f64::from(packets) * libm::log(probability);
        } else {
            self.product *= probability.powi(packets);
        }
        if self.product < 1e-150 && self.product > 0.0 {
            self.sum += libm::log(self.product);
            self.product = 1.0;
        }
    }

    /// The product of both.
    pub(super) fn times(self, other: Self) -> Self {
        Self { sum: self.sum + other.sum, product: self.product * other.product }
    }

    /// Whether it is certainly below `exp(ln_least)`, without a logarithm.
    #[inline]
    pub(super) fn is_below(&self, ln_least: f64, least: f64) -> bool {
        self.sum <= 0.0 && (self.product < least || self.sum < ln_least)
    }

    /// Its natural logarithm.
    #[inline]
    pub(super) fn ln(&self) -> f64 {
        self.sum + libm::log(self.product)
    }
}

/// The place of the anchor that has the most others within `near_m`, the first of several.
fn most_surrounded(anchors: &[KnownAnchor], near_m: f64) -> Option<Position> {
    let within = |a: &KnownAnchor| anchors.iter().filter(|b| a.place.distance_m(b.place) <= near_m).count();
    let mut best: Option<(usize, Position)> = None;
    for anchor in anchors {
        let count = within(anchor);
        if best.is_none_or(|(most, _)| count > most) {
            best = Some((count, anchor.place));
        }
    }
    best.map(|(_, place)| place)
}
