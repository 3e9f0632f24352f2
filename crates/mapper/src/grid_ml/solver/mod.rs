//! The grid solver: which vertices a node may be at, and how likely each is.
//!
//! The likelihood of a node at vertex g is `Π S(d)^received (1 − S(d))^missed` over all stops. Only stops within R
//! of g carry information; the others multiply every vertex by the same constant. The work is kept small in three
//! steps. First comes the bounding box of the places within R of every reception. For each lattice row in it follows
//! the span that lies within R of the receptions on the rim (those whose ball does not hold the whole box). Last, for
//! the vertices that survive, comes the product over the receptions and the stops in range that heard nothing. If
//! only the highest is wanted, bounds in single precision spare all but a few vertices: under a trapezoid one bound
//! for many vertices, from the curvature at one of them, otherwise one bound for each. Nothing is stored per vertex of
//! the lattice, so that memory does not grow with it.
//!
//! If no vertex survives, outliers are admitted: a good place found near the median of the receptions bounds
//! how many receptions the best vertex can contradict, and the same box and rows, relaxed by that number,
//! hold every vertex that can be as good. A coarse-to-fine branch and bound was slower wherever it was tried.

mod admission;
mod balls;
mod conditions;
mod coverage;
mod curve;
mod cuts;
mod evidence;
mod lanes;
mod margin;
mod narrow;
mod operations;
mod places;
mod product;
mod reached;
mod receiver;
mod rows;
mod score;
mod screen;
mod sector_conditions;
mod single;
mod sink;
mod soft;
mod wedges;

use sextant_channel::{CellIndex, Position, Receptions, SectorTable, Stop};
use sextant_kernel::Watch;

use crate::lattice::Lattice;
use crate::log_facts::sectors::SectorSettings;
use crate::profile::ReceptionProfile;
use admission::Admission;
pub(crate) use curve::ReceptionCurve;
use evidence::PacketEvidence;
use rows::Rows;
use score::Scorer;
pub(crate) use score::Survivors;
pub(crate) use sink::{Contenders, Moments, Peak, Sink};
use soft::SoftSectors;
pub(crate) use wedges::{Edges, Wedges};

/// A survey that is prepared for the search of its nodes.
#[derive(Debug)]
pub(crate) struct Solver<'a> {
    lattice: &'a Lattice,
    /// Where the stops are: less memory than the stops themselves.
    places: Vec<Position>,
    cells: CellIndex,
    /// The profile of the settings.
    curve: ReceptionCurve,
    /// The profile with a floor and a ceiling, for nodes whose receptions no vertex explains.
    clamped: ReceptionCurve,
    /// Sectors, if they are evidence.
    wedges: Option<Wedges>,
    /// How likely each sector is, if it is not just possible or impossible.
    soft: Option<SoftSectors>,
    watch: &'a dyn Watch,
}

/// Memory that a thread reuses for each node.
#[derive(Debug)]
pub(crate) struct SolverScratch {
    evidence: PacketEvidence,
    rows: Rows,
    survivors: Survivors,
}

impl SolverScratch {
    /// Searches look at no vertex outside of the box with these corners, if there is one, from now on.
    pub(crate) fn keep_within(&mut self, corners: Option<[[f64; 3]; 2]>) {
        self.rows.keep_within(corners);
    }
}

/// The result of a search.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct GridSearch {
    /// Whether no vertex explains all receptions.
    pub(crate) infeasible: bool,
    /// Vertices whose likelihood was computed.
    pub(crate) evaluated: u64,
}

impl<'a> Solver<'a> {
    /// The solver for a log with these stops. `sigma_db` is the error of the strengths by which nodes name sectors, if the
    /// settings ask for their probabilities (dB).
    pub(crate) fn new(
        lattice: &'a Lattice,
        stops: &[Stop],
        profile: &ReceptionProfile,
        sectors: Option<(&SectorTable, &SectorSettings)>,
        sigma_db: Option<f64>,
        watch: &'a dyn Watch,
    ) -> Self {
        let curve = ReceptionCurve::new(profile);
        let places: Vec<Position> = stops.iter().map(|stop| stop.position).collect();
        let cells = CellIndex::new(&places, 0.25 * profile.range_m());
        let is_flat = is_flat(lattice, &places);
        let range_m = profile.range_m();
        let soft = sectors.zip(sigma_db).and_then(|((table, settings), sigma_db)| {
            let side_lobe_db = settings.soft?.side_lobe_db;
            Some(SoftSectors::new(table, sigma_db, side_lobe_db, lattice, range_m))
        });
        let wedges =
            sectors.map(|(table, settings)| Wedges::new(table, settings, soft.as_ref(), lattice, range_m, is_flat));
        Self { lattice, places, cells, clamped: curve.clamped(), curve, wedges, soft, watch }
    }

    pub(crate) fn lattice(&self) -> &'a Lattice {
        self.lattice
    }

    pub(crate) fn scratch(&self) -> SolverScratch {
        SolverScratch {
            evidence: PacketEvidence::new(self.places.len()),
            rows: Rows::default(),
            survivors: Survivors::default(),
        }
    }

    /// Gives `sink` the log-likelihood of every vertex of the search set, but for those certain to lie more than
    /// `margin` below the highest. It gets nothing if the node was not heard or no vertex is in range. What it gets
    /// means nothing if the work was ended meanwhile.
    pub(crate) fn search(
        &self,
        scratch: &mut SolverScratch,
        receptions: Receptions<'_>,
        margin: f64,
        sink: &mut impl Sink,
    ) -> GridSearch {
        let SolverScratch { evidence, rows, survivors } = scratch;
        let mut search = GridSearch::default();
        let wedges = self.wedges.as_ref();
        evidence.read(receptions, &self.places, wedges);
        if evidence.heard_packets() > 0 {
            let mut scorer = self.scorer(&self.curve, Admission::WithinAll, evidence, survivors);
            if rows.intersection(self.lattice, self.curve.range_m, scorer.evidence.receptions(), wedges) {
                rows.each_span(self.lattice, self.curve.range_m, wedges, |row, span| scorer.push(row, span, sink));
            }
            scorer.flush(sink);
            search.evaluated = scorer.evaluated;
            if !scorer.any_admitted {
                search.infeasible = true;
                search.evaluated += self.admit_outliers(evidence, rows, survivors, margin, sink);
            }
        }
        evidence.clear(receptions);
        search
    }

    /// The same as if no vertex explained all receptions.
    pub(crate) fn search_outliers(
        &self,
        scratch: &mut SolverScratch,
        receptions: Receptions<'_>,
        margin: f64,
        sink: &mut impl Sink,
    ) -> GridSearch {
        let SolverScratch { evidence, rows, survivors } = scratch;
        let mut search = GridSearch { infeasible: true, evaluated: 0 };
        evidence.read(receptions, &self.places, self.wedges.as_ref());
        if evidence.heard_packets() > 0 {
            search.evaluated = self.admit_outliers(evidence, rows, survivors, margin, sink);
        }
        evidence.clear(receptions);
        search
    }

    /// The search for a node whose receptions no vertex explains.
    fn admit_outliers(
        &self,
        evidence: &PacketEvidence,
        rows: &mut Rows,
        survivors: &mut Survivors,
        margin: f64,
        sink: &mut impl Sink,
    ) -> u64 {
        let mut scorer = self.scorer(&self.clamped, Admission::WithinAny, evidence, survivors);
        let mut known = Peak::default();
        let centre = rows.centre(scorer.evidence.receptions());
        for seed in [centre, rows.median(scorer.evidence.receptions())] {
            for (row, span) in neighbourhood(self.lattice, seed) {
                scorer.push(row, span, &mut known);
            }
        }
        scorer.flush(&mut known);
        let cap = self.clamped.most_outliers(scorer.evidence, known.highest() - margin - Peak::TOLERANCE);
        if rows.relaxed(self.lattice, self.clamped.range_m, scorer.evidence.receptions(), cap) {
            rows.each_covered(self.lattice, self.clamped.range_m, self.wedges.as_ref(), cap, |row, vertex| {
                scorer.push(row, vertex..vertex + 1, sink);
            });
        }
        scorer.flush(sink);
        scorer.evaluated
    }

    fn scorer<'s>(
        &'s self,
        curve: &'s ReceptionCurve,
        admission: Admission,
        evidence: &'s PacketEvidence,
        survivors: &'s mut Survivors,
    ) -> Scorer<'s> {
        Scorer {
            lattice: self.lattice,
            cells: &self.cells,
            curve,
            admission,
            wedges: self.wedges.as_ref(),
            soft: self.soft.as_ref(),
            evidence,
            survivors,
            watch: self.watch,
            is_stopped: false,
            any_admitted: false,
            evaluated: 0,
        }
    }
}

/// Whether all vertices and places have the same height.
fn is_flat(lattice: &Lattice, places: &[Position]) -> bool {
    let height_m = lattice.origin().z_m;
    lattice.counts()[2] == 1 && places.iter().all(|place| (place.z_m - height_m).abs() <= 1e-9)
}

/// A lattice row: its indices along y and z.
pub(crate) type LatticeRow = [usize; 2];

/// The vertices round the one nearest to `place`, by rows.
fn neighbourhood(lattice: &Lattice, place: Position) -> Vec<(LatticeRow, std::ops::Range<usize>)> {
    let place: [f64; 3] = place.into();
    let reach = 1.5 * lattice.step_m();
    let [x, y, z] = [0, 1, 2].map(|axis| {
        let top = lattice.coordinate(axis, lattice.counts()[axis] - 1);
        let value = place[axis].clamp(lattice.coordinate(axis, 0), top);
        lattice.span(axis, value - reach, value + reach).0
    });
    z.flat_map(|k| y.clone().map(move |j| [j, k])).map(|row| (row, x.clone())).collect()
}
