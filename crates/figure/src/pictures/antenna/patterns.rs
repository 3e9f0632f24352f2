//! Polar cuts of the sectors of an antenna, side by side.

use sextant_channel::{Antenna, Db, SectorConfig};

use super::towards;
use crate::paint::file::Figure;
use crate::paint::palette::{ACCENT, CURVES, GRID, THREAD};
use crate::paint::picture::{Anchor, Area, Picture, Point, Stroke};
use crate::plot::axes::{LABEL_TEXT, TICK_TEXT};
use crate::plot::sheet::{Entry, Sheet, Symbol};

/// Sectors in a row, and in a figure.
const COLUMNS: usize = 6;
const PER_FIGURE: usize = 36;
/// Side of the square of a sector, and radius of its circle (px).
const CELL: f64 = 152.0;
const RADIUS: f64 = 54.0;
/// What the circle spans (dB), and the step of its rings.
const SPAN_DB: f64 = 40.0;
const RING_DB: f64 = 10.0;
/// Step of a cut (degrees).
const STEP_DEG: i32 = 2;
const CUT: Stroke = Stroke::new(CURVES[0], 1.6);
const LISTENS: Stroke = Stroke::new(ACCENT, 1.0);
const RIM: Stroke = Stroke::new(THREAD, 0.8);
const DASHES: &[f64] = &[3.0, 3.0];

/// Which angle a cut runs through.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cut {
    /// All azimuths, at the elevation of the peak. Forward is up, and the left side left.
    Azimuth,
    /// All elevations, at the azimuth of the peak. The peak's side is right, and up is up.
    Elevation,
}

/// The greatest gain of a sector, and where it is (degrees).
struct Peak {
    gain_dbi: f64,
    azimuth_deg: f64,
    elevation_deg: f64,
}

/// The figures of the cuts of all sectors, with so many in each.
pub(super) fn figures(title: &str, antenna: &Antenna) -> Vec<Figure> {
    let numbers: Vec<u8> = (0..antenna.sector_count()).collect();
    let peaks: Vec<Peak> = numbers.iter().map(|&number| peak(antenna, number)).collect();
    let greatest = peaks.iter().map(|peak| peak.gain_dbi).fold(f64::NEG_INFINITY, f64::max);
    let top_dbi = (greatest / 5.0).ceil() * 5.0;
    let cuts = [(Cut::Azimuth, "antenna-azimuth-cuts"), (Cut::Elevation, "antenna-elevation-cuts")];
    let of_cut = |(cut, name): (Cut, &'static str)| {
        let (numbers, peaks) = (&numbers, &peaks);
        let parts = numbers.chunks(PER_FIGURE).zip(peaks.chunks(PER_FIGURE)).enumerate();
        parts.map(move |(part, (numbers, peaks))| Figure {
            name: if numbers.len() < peaks.len().max(usize::from(antenna.sector_count())) {
                format!("{name}-{}", part + 1)
            } else {
                name.to_owned()
            },
            picture: draw(title, antenna, cut, top_dbi, numbers, peaks),
        })
    };
    cuts.into_iter().flat_map(of_cut).collect()
}

/// The greatest gain of a sector, found in steps of two degrees.
fn peak(antenna: &Antenna, number: u8) -> Peak {
    let mut best = Peak { gain_dbi: f64::NEG_INFINITY, azimuth_deg: 0.0, elevation_deg: 0.0 };
    let step = STEP_DEG.unsigned_abs() as usize;
    for elevation in (-90..=90).step_by(step) {
        for azimuth in (-180..180).step_by(step) {
            let (azimuth_deg, elevation_deg) = (f64::from(azimuth), f64::from(elevation));
            let Db(gain_dbi) = antenna.gain(number, towards(azimuth_deg, elevation_deg));
            // Of equal ones the nearest to the horizontal plane, so that the cut of a planar antenna is in its plane.
            let is_nearer = gain_dbi > best.gain_dbi - 1e-9 && elevation_deg.abs() < best.elevation_deg.abs();
            if gain_dbi > best.gain_dbi + 1e-9 || is_nearer {
                best = Peak { gain_dbi, azimuth_deg, elevation_deg };
            }
        }
    }
    best
}

fn draw(title: &str, antenna: &Antenna, cut: Cut, top_dbi: f64, numbers: &[u8], peaks: &[Peak]) -> Picture {
    let (what, how) = match cut {
        Cut::Azimuth => ("cuts in azimuth", "at the elevation of each peak, seen from above: forward is up"),
        Cut::Elevation => ("cuts in elevation", "at the azimuth of each peak, seen from the side: the peak is right"),
    };
    let note = format!("{how}; circle {top_dbi:.0} dBi, rings {RING_DB:.0} dB");
    let line =
        |stroke, pattern, text: &str| Entry { symbol: Symbol::Line { stroke, pattern }, text: text.to_owned() };
    let mut legend = vec![
        line(CUT, &[], "gain of the sector"),
        Entry { symbol: Symbol::Body { fill: GRID, rim: RIM }, text: "its directions in a log".to_owned() },
    ];
    if antenna.has_measured_quasi_omni() {
        legend.push(line(LISTENS, DASHES, "measured gain while listening"));
    }
    let sheet = Sheet { title: format!("{title}: {what}"), note, bar: None, legend };
    let columns = numbers.len().min(COLUMNS);
    let rows = numbers.len().div_ceil(COLUMNS);
    let (mut picture, areas) = sheet.lay_out(&[(CELL * columns as f64, CELL * rows as f64)]);
    let Area { left, top, .. } = areas[0];
    for (place, (&number, peak)) in numbers.iter().zip(peaks).enumerate() {
        let (column, row) = ((place % COLUMNS) as f64, (place / COLUMNS) as f64);
        let center = Point::new(left + CELL * (column + 0.5), top + CELL * (row + 0.5));
        Dial { antenna, cut, top_dbi, number, peak, center }.draw(&mut picture);
    }
    picture
}

/// The circle of one sector.
struct Dial<'a> {
    antenna: &'a Antenna,
    cut: Cut,
    top_dbi: f64,
    number: u8,
    peak: &'a Peak,
    center: Point,
}

impl Dial<'_> {
    /// The point at an angle of the cut (degrees), at a share of the radius.
    fn at(&self, angle_deg: f64, share: f64) -> Point {
        let (sin, cos) = libm::sincos(angle_deg.to_radians());
        let radius = RADIUS * share.clamp(0.0, 1.0);
        match self.cut {
            Cut::Azimuth => Point::new(self.center.x - radius * sin, self.center.y - radius * cos),
            Cut::Elevation => Point::new(self.center.x + radius * cos, self.center.y - radius * sin),
        }
    }

    fn share(&self, gain_dbi: f64) -> f64 {
        (gain_dbi - (self.top_dbi - SPAN_DB)) / SPAN_DB
    }

    /// The cut of a gain, all around.
    fn curve(&self, gain: impl Fn(sextant_channel::Position) -> Db) -> Vec<Point> {
        let point = |angle: i32| {
            let angle_deg = f64::from(angle);
            let direction = match self.cut {
                Cut::Azimuth => towards(angle_deg, self.peak.elevation_deg),
                Cut::Elevation => towards(self.peak.azimuth_deg, angle_deg),
            };
            self.at(angle_deg, self.share(gain(direction).0))
        };
        (-180..=180).step_by(STEP_DEG.unsigned_abs() as usize).map(point).collect()
    }

    /// The sector's directions in a log, as angles of the cut (degrees).
    fn wedge(&self) -> Option<[f64; 2]> {
        let identity = self.antenna.identity(self.number);
        let wedge = self.antenna.sectors().iter().find(|wedge| wedge.sector == identity)?;
        let &SectorConfig { azimuth_from_deg, azimuth_to_deg, elevation_from_deg, elevation_to_deg, .. } = wedge;
        Some(match self.cut {
            Cut::Azimuth => [azimuth_from_deg, azimuth_to_deg],
            Cut::Elevation => [elevation_from_deg, elevation_to_deg],
        })
    }

    fn draw(&self, picture: &mut Picture) {
        if let Some([from, to]) = self.wedge() {
            let pieces = ((to - from) / 5.0).ceil().clamp(1.0, 72.0);
            let steps = std::iter::successors(Some(0.0), |&i| (i < pieces).then_some(i + 1.0));
            let arc = steps.map(|i| self.at(from + (to - from) * i / pieces, 1.0));
            picture.polygon(std::iter::once(self.center).chain(arc).collect(), GRID);
        }
        for ring in [1.0, 2.0, 3.0, 4.0] {
            picture.ring(self.center, RADIUS * ring * RING_DB / SPAN_DB, RIM);
        }
        if self.antenna.has_measured_quasi_omni() {
            let listens = |direction| self.antenna.measured_quasi_omni(direction).unwrap_or(Db(f64::NEG_INFINITY));
            picture.dashed(&self.curve(listens), DASHES, LISTENS);
        }
        picture.path(self.curve(|direction| self.antenna.gain(self.number, direction)), CUT);
        let Peak { gain_dbi, azimuth_deg, elevation_deg } = *self.peak;
        let title = Point::new(self.center.x - CELL / 2.0 + 4.0, self.center.y - CELL / 2.0 + 2.0);
        let name = format!("sector {}", self.antenna.identity(self.number));
        picture.text(title, &name, Anchor::Start, LABEL_TEXT);
        let fixed_deg = match self.cut {
            Cut::Azimuth => elevation_deg,
            Cut::Elevation => azimuth_deg,
        };
        let text = format!("{gain_dbi:.1} dBi, {fixed_deg:.0}\u{b0}");
        picture.text(Point::new(title.x, self.center.y + CELL / 2.0 - 19.0), &text, Anchor::Start, TICK_TEXT);
    }
}
