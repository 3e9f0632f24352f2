//! The formula of the thesis, written down as it stands and evaluated at every vertex.

use sextant_channel::{Position, Reception, ReceptionLog, SectorConfig, SectorTable};
use sextant_kernel::NodeId;
use sextant_mapper::{Lattice, SectorTolerance, SilenceRule, TableProfile, TrapezoidConfig};

const LITERAL_FLOOR: f64 = 1e-6;

/// The thesis' algorithm: the product of Z over all stops, at every vertex of the lattice.
pub(super) struct Oracle<'a> {
    pub(super) profile: &'a TrapezoidConfig,
    /// Used instead of the trapezoid, if there is one.
    pub(super) table: Option<&'a TableProfile>,
    pub(super) log: &'a ReceptionLog,
    pub(super) lattice: &'a Lattice,
    pub(super) tolerance: SectorTolerance,
    pub(super) silence: SilenceRule,
}

impl Oracle<'_> {
    fn s(&self, d: f64, floor: f64, ceiling: f64) -> f64 {
        let TrapezoidConfig { p0, plateau_m: r, range_m, .. } = *self.profile;
        let s = if let Some(table) = self.table {
            table.probability(d)
        } else if d <= r {
            p0
        } else if d >= range_m {
            0.0
        } else {
            p0 * (range_m - d) / (range_m - r)
        };
        s.max(floor).min(ceiling)
    }

    /// The sectors, if they are evidence.
    fn sectors(&self) -> Option<&SectorTable> {
        let is_used = self.tolerance != SectorTolerance::Unlimited && self.log.receptions().sectors().is_some();
        self.log.sectors().filter(|_| is_used)
    }

    /// Whether the direction from the stop of a reception to the vertex is in the sector of the reception.
    fn is_in_sector(&self, vertex: Position, reception: &Reception) -> bool {
        let of_reception = |sector: &&SectorConfig| Some(sector.sector) == reception.sector;
        let sector = self.sectors().and_then(|table| table.iter().find(of_reception));
        sector.is_none_or(|sector| self.admits(vertex, reception.stop, sector))
    }

    /// Whether silence at a stop says anything about the vertex.
    fn is_covered(&self, vertex: Position, stop: u32) -> bool {
        self.silence == SilenceRule::Everywhere
            || self.sectors().is_none_or(|table| table.iter().any(|sector| self.admits(vertex, stop, sector)))
    }

    /// Whether the direction from a stop to the vertex is in a sector, by angles.
    fn admits(&self, vertex: Position, stop: u32, sector: &SectorConfig) -> bool {
        let apart = vertex - self.log.stops()[stop as usize].position;
        let across = apart.x_m.hypot(apart.y_m);
        let (azimuth, elevation) = (apart.y_m.atan2(apart.x_m), apart.z_m.atan2(across));
        let (from, width) = (sector.azimuth_from_deg.to_radians(), azimuth_width_deg(sector).to_radians());
        let [low, high] = [sector.elevation_from_deg, sector.elevation_to_deg].map(f64::to_radians);
        let turn = std::f64::consts::TAU;
        match self.tolerance {
            SectorTolerance::Angular | SectorTolerance::AngularLiteral => {
                let step_m = self.lattice.step_m();
                let margin = |d: f64| {
                    let near =
                        if self.tolerance == SectorTolerance::Angular { (0.5 * step_m / d).atan() } else { 0.0 };
                    (step_m / self.profile.range_m).atan().max(near)
                };
                let off_axis = (azimuth - from - 0.5 * width + 2.5 * turn).rem_euclid(turn) - 0.5 * turn;
                // At the stop itself, and right above it, a direction is rounding.
                apart.length_m() <= 1e-9
                    || (across <= 1e-9 || off_axis.abs() <= 0.5 * width + margin(across))
                        && (low - margin(apart.length_m())..=high + margin(apart.length_m())).contains(&elevation)
            }
            _ => {
                let h = self.lattice.half_diagonal_m();
                // Distances beyond an edge; the third line is what lies behind.
                let beyond_first = -across * (azimuth - from).sin();
                let beyond_last = -across * (from + width - azimuth).sin();
                let behind = -across * (azimuth - from - 0.5 * width).cos();
                let half_turn = std::f64::consts::PI;
                let azimuth_fits = if width > half_turn {
                    width >= turn || beyond_first <= h || beyond_last <= h
                } else {
                    beyond_first <= h && beyond_last <= h && behind <= h
                };
                let far = apart.length_m();
                azimuth_fits
                    && (sector.elevation_from_deg <= -90.0 || far * (low - elevation).sin() <= h)
                    && (sector.elevation_to_deg >= 90.0 || far * (elevation - high).sin() <= h)
                    && -far * (elevation - 0.5 * (low + high)).cos() <= h
            }
        }
    }

    fn product(&self, node: NodeId, vertex: Position, floor: f64, ceiling: f64) -> f64 {
        let mut product = 1.0;
        for (stop, place) in (0..).zip(self.log.stops()) {
            let counts = self.log.of(node).iter().find(|r| r.stop == stop);
            let (received, sent) = counts.map_or((0, 1), |r| (r.received, r.sent));
            let mut s = self.s(vertex.distance_m(place.position), floor, ceiling);
            if received == 0 && !self.is_covered(vertex, stop) {
                s = floor;
            }
            let in_sector = counts.is_none_or(|reception| self.is_in_sector(vertex, &reception));
            for packet in 0..sent {
                product *= match (packet < received, in_sector) {
                    (true, true) => s,
                    (true, false) => floor,
                    (false, _) => 1.0 - s,
                };
            }
        }
        product
    }

    /// Vertices of the search set with their likelihoods, and whether the node is infeasible.
    pub(super) fn likelihoods(&self, node: NodeId) -> (Vec<(u64, f64)>, bool) {
        let receivers: Vec<Reception> = self.log.of(node).iter().filter(|r| r.received > 0).collect();
        let range_squared = self.profile.range_m.powi(2);
        let near = |vertex: Position, reception: &Reception| {
            let apart = vertex - self.log.stops()[reception.stop as usize].position;
            apart.dot(apart) < range_squared && self.is_in_sector(vertex, reception)
        };
        let (floor, ceiling) = (self.profile.floor, self.profile.ceiling);
        let mut strict = Vec::new();
        let mut relaxed = Vec::new();
        for index in 0..self.lattice.len() {
            let vertex = self.lattice.position(self.lattice.vertex(index));
            if !receivers.is_empty() && receivers.iter().all(|reception| near(vertex, reception)) {
                let product = self.product(node, vertex, floor, ceiling);
                if product > 0.0 {
                    strict.push((index, product));
                }
            }
            if receivers.iter().any(|reception| near(vertex, reception)) {
                let (floor, ceiling) = (floor.max(LITERAL_FLOOR), ceiling.min(1.0 - LITERAL_FLOOR));
                relaxed.push((index, self.product(node, vertex, floor, ceiling)));
            }
        }
        if strict.is_empty() { (relaxed, true) } else { (strict, false) }
    }

    pub(super) fn maximisers(likelihoods: &[(u64, f64)]) -> (f64, Vec<u64>) {
        let highest = likelihoods.iter().fold(0.0, |high: f64, &(_, p)| high.max(p));
        let equal = |&&(_, p): &&(u64, f64)| p.ln() >= highest.ln() - 1e-9;
        (highest, likelihoods.iter().filter(equal).map(|&(i, _)| i).collect())
    }

    /// Mean and covariance of a node that is somewhere in the cell of a vertex.
    pub(super) fn mean_and_covariance(&self, likelihoods: &[(u64, f64)]) -> (Position, [[f64; 3]; 3]) {
        let place = |index| self.lattice.position(self.lattice.vertex(index));
        let total: f64 = likelihoods.iter().map(|&(_, p)| p).sum();
        let mean = likelihoods.iter().fold(Position::ORIGIN, |sum, &(i, p)| sum + place(i) * (p / total));
        let mut covariance = [[0.0; 3]; 3];
        for &(index, p) in likelihoods {
            let offset: [f64; 3] = (place(index) - mean).into();
            for (row, a) in covariance.iter_mut().zip(offset) {
                for (entry, b) in row.iter_mut().zip(offset) {
                    *entry += a * b * p / total;
                }
            }
        }
        for axis in (0..3).filter(|&axis| self.lattice.counts()[axis] > 1) {
            covariance[axis][axis] += self.lattice.step_m().powi(2) / 12.0;
        }
        (mean, covariance)
    }
}

/// Width of a sector (degrees).
pub(super) fn azimuth_width_deg(sector: &SectorConfig) -> f64 {
    let width_deg = sector.azimuth_to_deg - sector.azimuth_from_deg;
    if width_deg >= 360.0 { 360.0 } else { width_deg.rem_euclid(360.0) }
}
