//! Which vertices lie within R of the receptions: a box, then spans of rows.

use std::ops::Range;

use sextant_channel::Position;

use super::LatticeRow;
use super::balls::{Balls, RowInBalls};
use super::conditions::{Plane, Residual};
use super::reached::Reached;
use super::receiver::ReceivingStop;
use super::wedges::Wedges;
use crate::lattice::Lattice;

/// A factor on R² that is larger than the rounding error of squared distances, so that no vertex in range is dropped.
const ROUNDING: f64 = 1.0 + 1e-14;

/// The part of the lattice to look at, and the receptions that cut it.
#[derive(Debug, Default)]
pub(crate) struct Rows {
    /// Index ranges along x, y, z.
    span: [Range<usize>; 3],
    /// Receptions whose ball does not hold the whole box.
    rim: Vec<ReceivingStop>,
    /// Half-spaces that sectors leave, and their other conditions.
    planes: Vec<Plane>,
    residuals: Vec<Residual>,
    /// Packets of the receptions on the rim.
    rim_packets: u64,
    /// The rim's receptions in reach of a layer of the box.
    layer: Vec<ReceivingStop>,
    /// The balls round the receptions on the rim.
    balls: Balls,
    /// Coordinates along an axis, to be sorted.
    sorted: Vec<(f64, u32)>,
    /// Corners of a box outside of which no vertex is looked at, if there is one.
    within: Option<[[f64; 3]; 2]>,
}

impl Rows {
    /// Looks at no vertex outside of the box with these corners, if there is one, from now on.
    pub(crate) fn keep_within(&mut self, corners: Option<[[f64; 3]; 2]>) {
        self.within = corners;
    }

    /// The part of an axis from `low` to `high` that may be looked at.
    fn allowed(&self, axis: usize, low: f64, high: f64) -> (f64, f64) {
        self.within.map_or((low, high), |[first, last]| (low.max(first[axis]), high.min(last[axis])))
    }

    /// Sets the box to the bounding box of the places within `range_m` and in the sector of every reception.
    /// Returns whether it may hold such a vertex.
    pub(crate) fn intersection(
        &mut self,
        lattice: &Lattice,
        range_m: f64,
        receivers: &[ReceivingStop],
        wedges: Option<&Wedges>,
    ) -> bool {
        let (first, last) = bounds(receivers);
        let (mut low, mut high) = (last.map(|value| value - range_m), first.map(|value| value + range_m));
        self.planes.clear();
        self.residuals.clear();
        if let Some(wedges) = wedges {
            wedges.demand(receivers, &mut self.planes, &mut self.residuals);
            // No vertex lies outside the lattice, so the box need not either.
            for axis in 0..3 {
                low[axis] = low[axis].max(lattice.coordinate(axis, 0));
                high[axis] = high[axis].min(lattice.coordinate(axis, lattice.counts()[axis] - 1));
            }
            self.planes.iter().for_each(|plane| plane.tighten(&mut low, &mut high));
        }
        self.span = [0, 1, 2].map(|axis| {
            let (low, high) = self.allowed(axis, low[axis], high[axis]);
            lattice.span(axis, low, high).0
        });
        if let Some(wedges) = wedges
            && !self.span.iter().any(Range::is_empty)
        {
            let (low, high) = self.corners(lattice);
            if !wedges.cut_residuals(&mut self.residuals, low, high) {
                return false;
            }
        }
        if !self.find_rim(lattice, range_m, receivers, false) {
            return false;
        }
        let (low, high) = self.corners(lattice);
        self.balls.set(&self.rim, range_m, [low, high]);
        true
    }

    /// The first and the last vertex of the box.
    fn corners(&self, lattice: &Lattice) -> ([f64; 3], [f64; 3]) {
        let low = [0, 1, 2].map(|axis| lattice.coordinate(axis, self.span[axis].start));
        (low, [0, 1, 2].map(|axis| lattice.coordinate(axis, self.span[axis].end - 1)))
    }

    /// Sets the box to hold every place within `range_m` of all receptions but `cap` packets' worth.
    /// Returns whether it holds a vertex.
    pub(crate) fn relaxed(&mut self, lattice: &Lattice, range_m: f64, receivers: &[ReceivingStop], cap: u64) -> bool {
        for axis in 0..3 {
            self.sorted.clear();
            self.sorted.extend(receivers.iter().map(|r| (<[f64; 3]>::from(r.place)[axis], r.packets)));
            self.sorted.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
            // Of the receptions up to the one at which `cap` is exceeded, at least one is in range.
            let high = beyond(self.sorted.iter(), cap) + range_m;
            let low = beyond(self.sorted.iter().rev(), cap) - range_m;
            let (low, high) = self.allowed(axis, low, high);
            self.span[axis] = lattice.span(axis, low, high).0;
        }
        self.find_rim(lattice, range_m, receivers, true)
    }

    /// Collects the receptions that may not hold for the whole box, among them those in a sector if `by_sector`.
    fn find_rim(&mut self, lattice: &Lattice, range_m: f64, receivers: &[ReceivingStop], by_sector: bool) -> bool {
        self.rim.clear();
        self.rim_packets = 0;
        if self.span.iter().any(Range::is_empty) {
            return false;
        }
        let (low, high) = self.corners(lattice);
        let inside = range_m * range_m * (1.0 - 1e-9);
        for receiver in receivers {
            let place: [f64; 3] = receiver.place.into();
            let mut farthest = 0.0;
            for axis in 0..3 {
                let along = (place[axis] - low[axis]).max(high[axis] - place[axis]);
                farthest += along * along;
            }
            if farthest >= inside || by_sector && receiver.sector.is_some() {
                self.rim.push(*receiver);
                self.rim_packets += u64::from(receiver.packets);
            }
        }
        true
    }

    /// Calls `visit` with the spans of each row of the box that lie nearer than `range_m` to every reception and in its
    /// sector, rows in the order of their indices.
    pub(crate) fn each_span(
        &self,
        lattice: &Lattice,
        range_m: f64,
        wedges: Option<&Wedges>,
        mut visit: impl FnMut(LatticeRow, Range<usize>),
    ) {
        let has_slow_planes = self.planes.iter().any(|plane| plane.is_along_rows() && plane.normal[0].abs() > 0.0);
        let [along, ys, zs] = self.span.clone();
        for k in zs {
            let z = lattice.coordinate(2, k);
            let mut ys = ys.clone();
            if self.span[2].len() > 1 {
                let Some((first, last)) = self.balls.layer(z) else { continue };
                let (rows, _) = lattice.span(1, first, last);
                ys = ys.start.max(rows.start)..ys.end.min(rows.end);
            }
            for j in ys {
                let y = lattice.coordinate(1, j);
                let span = match self.balls.row(y, z) {
                    RowInBalls::Nothing => continue,
                    RowInBalls::Interval { mut low, mut high, error_m } if !has_slow_planes => {
                        self.planes.iter().for_each(|plane| plane.cut(y, z, &mut low, &mut high));
                        if low > high + 2.0 * error_m {
                            continue;
                        }
                        let (span, in_doubt) = lattice.span_within(0, low, high, error_m);
                        if in_doubt { self.exact_span(lattice, range_m, [j, k]) } else { span }
                    }
                    RowInBalls::Interval { .. } | RowInBalls::Grazed => self.exact_span(lattice, range_m, [j, k]),
                };
                let span = span.start.max(along.start)..span.end.min(along.end);
                match wedges.filter(|_| !self.residuals.is_empty()) {
                    None if span.is_empty() => {}
                    None => visit([j, k], span),
                    Some(wedges) => span
                        .filter(|&i| wedges.satisfies(&self.residuals, lattice.position([i, j, k]).into()))
                        .for_each(|i| visit([j, k], i..i + 1)),
                }
            }
        }
    }

    /// The vertices of a row that lie nearer than `range_m` to every reception and in all half-spaces.
    #[cold]
    fn exact_span(&self, lattice: &Lattice, range_m: f64, [j, k]: LatticeRow) -> Range<usize> {
        let reach = range_m * range_m * ROUNDING;
        let (y, z) = (lattice.coordinate(1, j), lattice.coordinate(2, k));
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        for ReceivingStop { place, .. } in &self.rim {
            let (dy, dz) = (y - place.y_m, z - place.z_m);
            let square = reach - dy * dy - dz * dz;
            if square < 0.0 {
                return 0..0;
            }
            let half = square.sqrt();
            low = low.max(place.x_m - half);
            high = high.min(place.x_m + half);
        }
        self.planes.iter().for_each(|plane| plane.cut(y, z, &mut low, &mut high));
        if low > high {
            return 0..0;
        }
        let [along, _, _] = &self.span;
        let (span, _) = lattice.span(0, low, high);
        let mut span = span.start.max(along.start)..span.end.min(along.end);
        self.shrink(lattice, range_m, [j, k], &mut span);
        span
    }

    /// Takes vertices that are not nearer than `range_m` to every reception or not in a half-space off the ends of a span.
    fn shrink(&self, lattice: &Lattice, range_m: f64, [j, k]: LatticeRow, span: &mut Range<usize>) {
        let is_within = |i| {
            let vertex = lattice.position([i, j, k]);
            self.planes.iter().all(|plane| plane.holds(vertex.into()))
                && self.rim.iter().all(|receiver| {
                    let apart = vertex - receiver.place;
                    apart.dot(apart) < range_m * range_m
                })
        };
        while span.start < span.end && !is_within(span.start) {
            span.start += 1;
        }
        while span.start < span.end && !is_within(span.end - 1) {
            span.end -= 1;
        }
    }

    /// Calls `visit` with each vertex of the box that lies within `range_m` and in the sector of all receptions but
    /// `cap` packets' worth, in the order of their indices. Vertices that miss this by rounding may be among them.
    pub(crate) fn each_covered(
        &mut self,
        lattice: &Lattice,
        range_m: f64,
        wedges: Option<&Wedges>,
        cap: u64,
        mut visit: impl FnMut(LatticeRow, usize),
    ) {
        let reach = range_m * range_m * ROUNDING;
        let least = self.rim_packets.saturating_sub(cap);
        let [along, ys, zs] = self.span.clone();
        let mut reached = Reached::default();
        let (mut layers, mut rows) = (Vec::new(), Vec::new());
        for receiver in &self.rim {
            let (z, half) = (receiver.place.z_m, reach.sqrt());
            reached.add(lattice.span(2, z - half, z + half).0, receiver.packets);
        }
        reached.take_runs(&zs, least, |run| layers.push(run));
        for k in layers.into_iter().flatten() {
            let z = lattice.coordinate(2, k);
            self.layer.clear();
            self.layer.extend(self.rim.iter().filter(|r| (z - r.place.z_m).powi(2) <= reach));
            for receiver in &self.layer {
                let (y, half) = (receiver.place.y_m, (reach - (z - receiver.place.z_m).powi(2)).sqrt());
                reached.add(lattice.span(1, y - half, y + half).0, receiver.packets);
            }
            rows.clear();
            reached.take_runs(&ys, least, |run| rows.push(run));
            for j in rows.iter().cloned().flatten() {
                let y = lattice.coordinate(1, j);
                for &ReceivingStop { place, packets, sector } in &self.layer {
                    let (dy, dz) = (y - place.y_m, z - place.z_m);
                    let square = reach - dy * dy - dz * dz;
                    if square >= 0.0 {
                        let half = square.sqrt();
                        let (mut low, mut high) = (place.x_m - half, place.x_m + half);
                        if let (Some(wedges), Some(sector)) = (wedges, sector) {
                            let (first, last) = wedges.interval(sector, place.into(), y, z);
                            (low, high) = (low.max(first), high.min(last));
                        }
                        reached.add(lattice.span(0, low, high).0, packets);
                    }
                }
                reached.take_runs(&along, least, |run| run.for_each(|i| visit([j, k], i)));
            }
        }
    }

    /// The middle of the bounding box of the receptions.
    pub(crate) fn centre(&self, receivers: &[ReceivingStop]) -> Position {
        let (low, high) = bounds(receivers);
        (Position::from(low) + Position::from(high)) * 0.5
    }

    /// The median of the receptions along each axis.
    pub(crate) fn median(&mut self, receivers: &[ReceivingStop]) -> Position {
        [0, 1, 2]
            .map(|axis| {
                self.sorted.clear();
                self.sorted.extend(receivers.iter().map(|r| (<[f64; 3]>::from(r.place)[axis], r.packets)));
                let middle = self.sorted.len() / 2;
                self.sorted.select_nth_unstable_by(middle, |a, b| a.0.total_cmp(&b.0)).1.0
            })
            .into()
    }
}

/// The corners of the bounding box of the receptions.
fn bounds(receivers: &[ReceivingStop]) -> ([f64; 3], [f64; 3]) {
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    for receiver in receivers {
        let place: [f64; 3] = receiver.place.into();
        for axis in 0..3 {
            low[axis] = if place[axis] < low[axis] { place[axis] } else { low[axis] };
            high[axis] = if place[axis] > high[axis] { place[axis] } else { high[axis] };
        }
    }
    (low, high)
}

/// The first coordinate at which the packets seen so far exceed `cap`; the last one if they never do.
fn beyond<'a>(sorted: impl Iterator<Item = &'a (f64, u32)>, cap: u64) -> f64 {
    let mut seen = 0;
    let mut coordinate = f64::NAN;
    for &(value, packets) in sorted {
        coordinate = value;
        seen += u64::from(packets);
        if seen > cap {
            break;
        }
    }
    coordinate
}
