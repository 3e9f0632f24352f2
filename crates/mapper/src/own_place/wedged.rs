//! The search under conditions that hold or do not: nearer than the range, and in the sector.

use std::ops::Range;

use sextant_channel::Position;

use super::OwnEstimate;
use super::evidence::{AnchorEvidence, LogProduct};
use super::octets;
use super::search_set::SearchSet;
use crate::grid_ml::findings::Findings;
use crate::grid_ml::solver::{Moments, Peak};
use crate::posterior::{EstimateKind, TieRule};

/// Vertices at every so many indices give a first bound of the fewest broken conditions.
const STRIDE: usize = 4;

/// The estimate; `None` if no vertex is within the range of an anchor.
pub(super) fn estimate(evidence: &AnchorEvidence<'_>, kind: EstimateKind) -> Option<OwnEstimate> {
    let mut search = WedgedSearch { evidence, kind, findings: Findings::new(kind, &evidence.lattice), vertices: 0 };
    let broken = if search.feasible() { 0 } else { search.relaxed() };
    let violations = broken + evidence.astray;
    let estimate = search.findings.estimate(&evidence.lattice, TieRule::Mean, violations > 0)?;
    let of_result = match kind {
        EstimateKind::Argmax => octets::of_peak(estimate.ties),
        EstimateKind::PosteriorMean => octets::of_moments() + octets::of_peak(0),
    };
    let peak_octets = octets::of_evidence(evidence) + of_result;
    Some(OwnEstimate { estimate, violations, vertices: search.vertices, peak_octets })
}

struct WedgedSearch<'e> {
    evidence: &'e AnchorEvidence<'e>,
    kind: EstimateKind,
    findings: Findings,
    vertices: u64,
}

impl WedgedSearch<'_> {
    /// Takes the vertices that break no condition, as far as their likelihood is above zero; returns whether there are any.
    fn feasible(&mut self) -> bool {
        let AnchorEvidence { lattice, curve, heard, .. } = self.evidence;
        let balls = heard.iter().map(|anchor| (anchor.place, curve.range_m));
        let Some(set) = SearchSet::intersection(lattice, balls) else {
            return false;
        };
        let Some([_, rows, layers]) = set.cells().cloned() else {
            return false;
        };
        for k in layers {
            for j in rows.clone() {
                let (y, z) = (lattice.coordinate(1, j), lattice.coordinate(2, k));
                for i in self.span(y, z) {
                    let place = Position::new(lattice.coordinate(0, i), y, z);
                    if let Some(value) = self.unbroken(place) {
                        self.findings.take(lattice.index([i, j, k]), place, value);
                    }
                }
            }
        }
        self.findings.peak.highest() > f64::NEG_INFINITY
    }

    /// The vertices of a row that may break no condition.
    fn span(&self, y: f64, z: f64) -> Range<usize> {
        let AnchorEvidence { lattice, curve, heard, wedges, .. } = self.evidence;
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        for anchor in heard {
            let (dy, dz) = (y - anchor.place.y_m, z - anchor.place.z_m);
            let square = curve.range_squared - dy * dy - dz * dz;
            if square <= 0.0 {
                return 0..0;
            }
            let half = square.sqrt();
            (low, high) = (low.max(anchor.place.x_m - half), high.min(anchor.place.x_m + half));
            if let Some(sector) = anchor.sector {
                let (first, last) = wedges.interval(sector.index, anchor.place.into(), y, z);
                (low, high) = (low.max(first), high.min(last));
            }
            if low > high {
                return 0..0;
            }
        }
        lattice.span(0, low, high).0
    }

    /// The log-likelihood below which a vertex makes no difference.
    fn least(&self) -> f64 {
        let margin = match self.kind {
            EstimateKind::Argmax => Peak::TOLERANCE,
            EstimateKind::PosteriorMean => Moments::NEGLIGIBLE,
        };
        self.findings.peak.highest() - margin
    }

    /// The log-likelihood of a place that breaks no condition; `None` if it breaks one or makes no difference.
    fn unbroken(&mut self, place: Position) -> Option<f64> {
        self.vertices += 1;
        let AnchorEvidence { curve, heard, .. } = self.evidence;
        let mut product = LogProduct::default();
        for anchor in heard {
            let apart = place - anchor.place;
            let square = apart.dot(apart);
            if square >= curve.range_squared {
                return None;
            }
            product.multiply(curve.at(square), anchor.packets);
        }
        // Neither sectors nor silence can raise it.
        if product.ln() < self.least() || !heard.iter().all(|anchor| self.evidence.is_in_sector(anchor, place)) {
            return None;
        }
        let value = product.times(self.evidence.missed(curve, place)).ln();
        (value > f64::NEG_INFINITY && value >= self.least()).then_some(value)
    }

    /// Takes the vertices that break the fewest conditions; returns how many these are.
    fn relaxed(&mut self) -> usize {
        let AnchorEvidence { lattice, curve, heard, .. } = self.evidence;
        let set = SearchSet::union(lattice, heard.iter().map(|anchor| (anchor.place, curve.range_m)));
        let mut fewest = usize::MAX;
        set.each(STRIDE, |vertex| {
            if let Some((broken, _)) = self.broken(lattice.position(vertex), fewest) {
                fewest = fewest.min(broken);
            }
        });
        for (number, block) in set.blocks() {
            let corners = [block.each_ref().map(|range| range.start), block.each_ref().map(|range| range.end - 1)];
            let [first, last] = corners.map(|corner| lattice.position(corner));
            if self.evidence.surely_broken((first + last) * 0.5) <= fewest {
                set.each_of(number, &block, 1, |vertex| fewest = self.take_relaxed(vertex, fewest));
            }
        }
        fewest
    }

    /// Takes a vertex if it breaks no more than `fewest` conditions; returns the fewest so far.
    fn take_relaxed(&mut self, vertex: [usize; 3], fewest: usize) -> usize {
        let lattice = &self.evidence.lattice;
        let place = lattice.position(vertex);
        let Some((broken, product)) = self.broken(place, fewest) else {
            return fewest;
        };
        if broken < fewest {
            self.findings = Findings::new(self.kind, lattice);
        }
        if product.ln() >= self.least() {
            let value = product.times(self.evidence.missed(self.evidence.clamped, place)).ln();
            if value >= self.least() {
                self.findings.take(lattice.index(vertex), place, value);
            }
        }
        broken
    }

    /// The number of conditions that a place breaks, and the product over those that hold; `None` if they are more than
    /// `most`, or the place is beyond the range of all anchors.
    fn broken(&mut self, place: Position, most: usize) -> Option<(usize, LogProduct)> {
        self.vertices += 1;
        let AnchorEvidence { clamped, heard, .. } = self.evidence;
        let (mut broken, mut product) = (0, LogProduct::default());
        let mut is_in_range = false;
        for anchor in heard {
            let apart = place - anchor.place;
            let square = apart.dot(apart);
            if square < clamped.range_squared {
                product.multiply(clamped.at(square), anchor.packets);
                is_in_range = true;
            } else {
                broken += 1;
            }
            broken += usize::from(!self.evidence.is_in_sector(anchor, place));
            if broken > most {
                return None;
            }
        }
        is_in_range.then_some((broken, product))
    }
}
