//! Sectors as half-spaces and cones through a stop.
//!
//! A wedge of azimuths up to half a turn wide is the intersection of two half-spaces through the stop, those of its edges;
//! moved outwards by the tolerance they would reach far behind the stop where the wedge is narrow, which a third
//! half-space across its middle forbids. An elevation bounds a cone about the vertical through the stop:
//! `α ρ + β Δz ≥ −tolerance` with ρ the horizontal distance; it is a half-space where the edge is horizontal. A wider
//! wedge of azimuths is all but a wedge of the rest. All stops share the directions, so that of many half-spaces of one
//! direction only the tightest counts.
//!
//! A margin that grows near the stop ([`SectorTolerance::Angular`]) is not a half-space. The half-spaces then hold all
//! that it admits, and each vertex in them is looked at again.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use sextant_channel::{SectorTable, Wedge};
use wide::f32x4;

use super::conditions::{Plane, Residual, ResidualKind};
use super::coverage::SpherePart;
use super::margin::Margin;
use super::receiver::ReceivingStop;
use super::sector_conditions::SectorConditions;
use super::single::single;
use super::soft::SoftSectors;
use crate::lattice::Lattice;
use crate::log_facts::sectors::SectorSettings;
use crate::log_facts::{SectorTolerance, SilenceRule};

/// Least tolerance, so that rounding does not exclude an edge (m).
const ROUNDING_M: f64 = 1e-9;

/// The sectors of a survey.
#[derive(Clone, Debug)]
pub(crate) struct Wedges {
    /// Unit vectors into half-spaces, of all sectors.
    normals: Vec<[f64; 3]>,
    /// By the sector's identity.
    tests: Vec<SectorConditions>,
    /// How far beyond an edge of the half-spaces a vertex may lie (m).
    tolerance_m: f64,
    /// The angle at the edges, where it depends on the distance.
    margin: Option<Margin>,
    /// By the sector's identity, what it covers.
    wedges: Vec<Option<Wedge>>,
    /// The parts of the sphere that sectors cover, if they do not cover all of it and silence elsewhere says nothing.
    covered: Option<Vec<SpherePart>>,
    /// The sectors that say what is covered, if others.
    covering: Option<Box<Wedges>>,
}

/// How the edges of sectors are moved outwards.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edges {
    /// By an angle (rad).
    angle: f64,
    /// By a distance (m).
    tolerance_m: f64,
    margin: Option<Margin>,
}

impl Edges {
    /// As a tolerance has it for the vertices of `lattice`, with nodes heard within `range_m`.
    pub(crate) fn of(tolerance: SectorTolerance, lattice: &Lattice, range_m: f64) -> Self {
        let angle = libm::atan(lattice.step_m() / range_m);
        match tolerance {
            SectorTolerance::Angular => {
                let half_step_m = 0.5 * lattice.step_m();
                Self { angle, tolerance_m: half_step_m, margin: Some(Margin { angle, half_step_m }) }
            }
            SectorTolerance::AngularLiteral => Self { angle, tolerance_m: 0.0, margin: None },
            SectorTolerance::Positional | SectorTolerance::Unlimited => Self::at_distance(lattice.half_diagonal_m()),
        }
    }

    /// The same moved further, so that they hold every place within `by_m` of one that these hold.
    pub(crate) fn widened(self, by_m: f64) -> Self {
        Self { tolerance_m: self.tolerance_m + by_m, margin: None, ..self }
    }

    /// Moved by a distance (m).
    pub(crate) fn at_distance(tolerance_m: f64) -> Self {
        Self { angle: 0.0, tolerance_m, margin: None }
    }
}

impl Wedges {
    /// The sectors of `table`, as `settings` use them. `is_flat` says that no vertex is above or below a stop.
    pub(crate) fn new(
        table: &SectorTable,
        settings: &SectorSettings,
        soft: Option<&SoftSectors>,
        lattice: &Lattice,
        range_m: f64,
        is_flat: bool,
    ) -> Self {
        let edges = Edges::of(settings.tolerance, lattice, range_m);
        let hard = Self::of_table(table, edges, settings.silence, is_flat);
        match soft {
            // A sector may be named where it does not point, but it covers no more.
            Some(soft) => {
                let possible = Self::of_table(&soft.possible(table), edges, SilenceRule::Everywhere, is_flat);
                Self { covering: Some(Box::new(hard)), ..possible }
            }
            None => hard,
        }
    }

    /// The sectors of `table` with these edges. `is_flat` says that no place is above or below a stop.
    pub(crate) fn of_table(table: &SectorTable, edges: Edges, silence: SilenceRule, is_flat: bool) -> Self {
        let sectors = table.iter().filter_map(|sector| Some((usize::from(sector.sector), sector.wedge().ok()?)));
        Self::of_sectors(sectors, edges, silence, is_flat)
    }

    /// The same for sectors in the order of their identities.
    pub(crate) fn of_sectors(
        sectors: impl Iterator<Item = (usize, Wedge)>,
        edges: Edges,
        silence: SilenceRule,
        is_flat: bool,
    ) -> Self {
        let Edges { angle, tolerance_m, margin } = edges;
        let mut wedges = Self {
            normals: Vec::new(),
            tests: Vec::new(),
            tolerance_m: tolerance_m + ROUNDING_M,
            margin,
            wedges: Vec::new(),
            covered: None,
            covering: None,
        };
        let mut parts = Vec::new();
        for (id, wedge) in sectors {
            let test = wedges.test(&wedge, angle);
            wedges.tests.resize(id + 1, SectorConditions::default());
            wedges.wedges.resize(id + 1, None);
            wedges.tests[id] = test.clone();
            wedges.wedges[id] = Some(wedge);
            parts.push(SpherePart { test, wedge });
        }
        if silence == SilenceRule::Covered {
            let of_ring = |wedge: &Wedge| SpherePart { test: wedges.test(wedge, angle), wedge: *wedge };
            wedges.covered = SpherePart::outside_of_which_silence_is_certain(parts, is_flat, of_ring);
        }
        wedges
    }

    fn test(&mut self, wedge: &Wedge, angle: f64) -> SectorConditions {
        let mut test = SectorConditions::default();
        self.add_azimuths(&mut test, wedge, angle);
        self.add_elevations(&mut test, wedge, angle);
        test
    }

    fn add_azimuths(&mut self, test: &mut SectorConditions, wedge: &Wedge, angle: f64) {
        let (from, width) = (wedge.azimuth_from_rad - angle, wedge.azimuth_width_rad + 2.0 * angle);
        if width >= TAU {
            return;
        }
        let towards = |azimuth: f64| [libm::cos(azimuth), libm::sin(azimuth)];
        let edges = [from + FRAC_PI_2, from + width - FRAC_PI_2].map(towards);
        if width > PI + 1e-9 {
            test.reflex = Some(edges);
            return;
        }
        for [x, y] in edges.into_iter().chain([towards(from + 0.5 * width)]) {
            let plane = self.normal([x, y, 0.0]);
            test.planes.push(plane);
        }
    }

    fn add_elevations(&mut self, test: &mut SectorConditions, wedge: &Wedge, angle: f64) {
        let low = (wedge.elevation_rad[0] - angle).max(-FRAC_PI_2);
        let high = (wedge.elevation_rad[1] + angle).min(FRAC_PI_2);
        let middle = 0.5 * (low + high);
        let mut cones = Vec::new();
        if low > -FRAC_PI_2 {
            cones.push([-libm::sin(low), libm::cos(low)]);
        }
        if high < FRAC_PI_2 {
            cones.push([libm::sin(high), -libm::cos(high)]);
        }
        // Behind the stop, as far as the tolerance at the edges allows.
        if libm::sin(middle) > libm::cos(low) || -libm::sin(middle) > libm::cos(high) {
            cones.push([libm::cos(middle), libm::sin(middle)]);
        }
        for [alpha, beta] in cones {
            if alpha.abs() < 1e-12 {
                let plane = self.normal([0.0, 0.0, beta.signum()]);
                test.planes.push(plane);
            } else {
                test.cones.push([alpha, beta]);
            }
        }
    }

    /// The index of a normal, which is added if it is new.
    fn normal(&mut self, normal: [f64; 3]) -> usize {
        // The cosine of a right angle is not quite zero.
        let normal = normal.map(|component| if component.abs() < 1e-12 { 0.0 } else { component });
        let same = |other: &[f64; 3]| other.iter().zip(&normal).all(|(a, b)| (a - b).abs() < 1e-12);
        self.normals.iter().position(same).unwrap_or_else(|| {
            self.normals.push(normal);
            self.normals.len() - 1
        })
    }

    /// Whether a vertex at `apart` from the stop is in the sector (m).
    pub(crate) fn admits(&self, sector: impl Into<usize>, apart: [f64; 3]) -> bool {
        let sector = sector.into();
        match (self.tests.get(sector), self.wedges.get(sector)) {
            (Some(test), Some(Some(wedge))) => self.holds(test, wedge, apart),
            _ => true,
        }
    }

    /// Whether a vertex at `apart` from the stop is in the wedge with this test (m).
    pub(super) fn holds(&self, test: &SectorConditions, wedge: &Wedge, apart: [f64; 3]) -> bool {
        match &self.margin {
            None => self.is_within(test, apart, self.tolerance_m),
            Some(margin) => self.is_within(test, apart, ROUNDING_M) || margin.admits(wedge, apart),
        }
    }

    fn is_within(&self, test: &SectorConditions, [dx, dy, dz]: [f64; 3], tolerance_m: f64) -> bool {
        let inside = |[x, y, z]: [f64; 3]| x * dx + y * dy + z * dz >= -tolerance_m;
        test.planes.iter().all(|&plane| inside(self.normals[plane]))
            && test.reflex.is_none_or(|edges| edges.iter().any(|&[x, y]| inside([x, y, 0.0])))
            && test.cones.iter().all(|&[alpha, beta]| alpha * (dx * dx + dy * dy).sqrt() + beta * dz >= -tolerance_m)
    }

    /// The same for a few vertices, with distances that are off by up to `apart_m`: all bits of a lane are set only if
    /// the vertex is certainly in the wedge.
    #[inline(always)]
    pub(super) fn is_certainly_within(
        &self,
        test: &SectorConditions,
        [dx, dy, dz]: &[f32x4; 3],
        apart_m: f32,
    ) -> f32x4 {
        let tolerance_m = if self.margin.is_some() { ROUNDING_M } else { self.tolerance_m };
        let least = f32x4::splat(4.0 * apart_m - single(tolerance_m));
        let inside = |[x, y, z]: [f64; 3]| (*dx * single(x) + *dy * single(y) + *dz * single(z)).simd_ge(least);
        let mut within = f32x4::ZERO.simd_eq(f32x4::ZERO);
        for &plane in &test.planes {
            within &= inside(self.normals[plane]);
        }
        if let Some([[x0, y0], [x1, y1]]) = test.reflex {
            within &= inside([x0, y0, 0.0]) | inside([x1, y1, 0.0]);
        }
        if !test.cones.is_empty() {
            let across = (*dx * *dx + *dy * *dy).sqrt();
            for &[alpha, beta] in &test.cones {
                within &= (across * single(alpha) + *dz * single(beta)).simd_ge(least);
            }
        }
        within
    }

    /// What sectors cover, if this is not every direction and silence elsewhere says nothing.
    pub(crate) fn coverage(&self) -> Option<Coverage<'_>> {
        let wedges = self.covering.as_deref().unwrap_or(self);
        wedges.covered.as_deref().map(|parts| Coverage { wedges, parts })
    }

    /// Collects the conditions of all receptions: the tightest half-space of each direction, as a normal and the
    /// least value of its product with a place; and the conditions that are not half-spaces.
    pub(crate) fn demand(&self, receivers: &[ReceivingStop], planes: &mut Vec<Plane>, residuals: &mut Vec<Residual>) {
        planes.clear();
        planes.extend(self.normals.iter().map(|&normal| Plane { normal, least: f64::NEG_INFINITY }));
        residuals.clear();
        for receiver in receivers {
            let Some(test) = receiver.sector.and_then(|sector| self.tests.get(usize::from(sector))) else {
                continue;
            };
            let place: [f64; 3] = receiver.place.into();
            for &plane in &test.planes {
                let least = planes[plane].along(place) - self.tolerance_m;
                planes[plane].least = if least > planes[plane].least { least } else { planes[plane].least };
            }
            residuals.extend(test.reflex.map(|edges| Residual { place, kind: ResidualKind::Reflex(edges) }));
            residuals.extend(test.cones.iter().map(|&cone| Residual { place, kind: ResidualKind::Cone(cone) }));
            let is_limited = !test.planes.is_empty() || test.reflex.is_some() || !test.cones.is_empty();
            let sector = receiver.sector.filter(|_| self.margin.is_some() && is_limited);
            residuals.extend(sector.map(|sector| Residual { place, kind: ResidualKind::Margin(sector) }));
        }
        planes.retain(|plane| plane.least > f64::NEG_INFINITY);
    }

    /// Leaves out conditions that the whole box from `low` to `high` satisfies. Returns whether a place of the box may
    /// satisfy each of the others.
    pub(crate) fn cut_residuals(&self, residuals: &mut Vec<Residual>, low: [f64; 3], high: [f64; 3]) -> bool {
        let mut possible = true;
        residuals.retain(|residual| {
            let (least, most) = residual.range(low, high);
            possible &= most >= -self.tolerance_m;
            least < -self.tolerance_m
        });
        possible
    }

    /// Whether `place` satisfies all of `residuals`.
    pub(crate) fn satisfies(&self, residuals: &[Residual], place: [f64; 3]) -> bool {
        residuals.iter().all(|residual| match residual.kind {
            ResidualKind::Margin(sector) => {
                self.admits(sector, [0, 1, 2].map(|axis| place[axis] - residual.place[axis]))
            }
            ResidualKind::Reflex(_) | ResidualKind::Cone(_) => residual.range(place, place).0 >= -self.tolerance_m,
        })
    }

    /// The interval of x in which the row through y and z is in the half-spaces of a sector as seen from `place`.
    pub(crate) fn interval(&self, sector: impl Into<usize>, place: [f64; 3], y: f64, z: f64) -> (f64, f64) {
        let planes = self.tests.get(sector.into()).map_or(&[][..], |test| &test.planes);
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        for &plane in planes {
            let plane = Plane { normal: self.normals[plane], least: 0.0 };
            let plane = Plane { least: plane.along(place) - self.tolerance_m, ..plane };
            plane.cut(y, z, &mut low, &mut high);
        }
        (low, high)
    }
}

/// What sectors cover.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Coverage<'w> {
    wedges: &'w Wedges,
    parts: &'w [SpherePart],
}

impl Coverage<'_> {
    /// Whether a vertex at `apart` from a stop (m) is in any sector.
    pub(crate) fn covers(&self, apart: [f64; 3]) -> bool {
        self.parts.iter().any(|part| self.wedges.holds(&part.test, &part.wedge, apart))
    }

    /// The same for a few vertices, with distances that are off by up to `apart_m`: all bits of a lane are set only if
    /// a sector certainly covers the vertex.
    #[inline(always)]
    pub(crate) fn certainly_covers(&self, apart: &[f32x4; 3], apart_m: f32) -> f32x4 {
        let certain = |part: &SpherePart| self.wedges.is_certainly_within(&part.test, apart, apart_m);
        self.parts.iter().fold(f32x4::ZERO, |covered, part| covered | certain(part))
    }
}
