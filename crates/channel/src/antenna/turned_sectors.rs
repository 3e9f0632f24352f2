//! The directions of the sectors of an antenna that is turned.

use crate::antenna::sector::{SectorConfig, SectorDirections};
use crate::antenna::{Antenna, Orientation};
use crate::geometry::position::Position;

/// Directions are sampled at so many degrees of azimuth and elevation.
const STEP_DEG: f64 = 2.0;
const COLUMNS: usize = 180;
const ROWS: usize = 91;

/// The directions of the sectors of `antenna`, turned by `orientation`, in the frame outside. A turn about the vertical moves
/// the azimuths. After any other turn, each wedge is the smallest interval of azimuth and of elevation that has all
/// directions where the sector is the best, or that of its own greatest gain if there are none.
pub(crate) fn turned(antenna: &Antenna, orientation: Orientation) -> SectorDirections {
    let [yaw_rad, pitch_rad, roll_rad] = orientation.angles_rad();
    let is_level = [pitch_rad, roll_rad].map(f64::to_bits) == [0; 2];
    if is_level && yaw_rad.to_bits() == 0 {
        return antenna.sectors().clone();
    }
    let sectors: Vec<SectorConfig> = if is_level {
        let yaw_deg = orientation.config().yaw_deg;
        let moved = |sector: &SectorConfig| SectorConfig {
            azimuth_from_deg: sector.azimuth_from_deg + yaw_deg,
            azimuth_to_deg: sector.azimuth_to_deg + yaw_deg,
            ..sector.clone()
        };
        antenna.sectors().iter().map(moved).collect()
    } else {
        let mut cells = best_cells(antenna, orientation);
        (antenna.sectors().iter().zip(&mut cells)).map(|(sector, cells)| wedge(sector.sector, cells)).collect()
    };
    SectorDirections::new(sectors).expect("a turned sector has an interval of azimuth and one of elevation")
}

/// The unit vector of a cell of the samples.
fn direction(cell: usize) -> Position {
    let (sin_azimuth, cos_azimuth) = libm::sincos(((cell % COLUMNS) as f64 * STEP_DEG).to_radians());
    let (sin, cos) = libm::sincos(((cell / COLUMNS) as f64 * STEP_DEG - 90.0).to_radians());
    Position::new(cos * cos_azimuth, cos * sin_azimuth, sin)
}

/// The cells where each sector is the best, in their order; at least that of its own greatest gain.
fn best_cells(antenna: &Antenna, orientation: Orientation) -> Vec<Vec<usize>> {
    let count = antenna.sector_count();
    let mut cells = vec![Vec::new(); usize::from(count)];
    let mut peaks = vec![(f64::NEG_INFINITY, 0); usize::from(count)];
    for cell in 0..COLUMNS * ROWS {
        let direction = orientation.to_antenna_frame(direction(cell));
        let mut best = (f64::NEG_INFINITY, None);
        for (index, sector) in (0..count).enumerate() {
            let gain = antenna.gain(sector, direction).0;
            if gain > best.0 {
                best = (gain, Some(index));
            }
            if gain > peaks[index].0 {
                peaks[index] = (gain, cell);
            }
        }
        if let (_, Some(index)) = best {
            cells[index].push(cell);
        }
    }
    for (cells, (_, peak)) in cells.iter_mut().zip(peaks) {
        if cells.is_empty() {
            cells.push(peak);
        }
    }
    cells
}

/// The smallest wedge around these cells, and a step more on each side.
fn wedge(sector: u8, cells: &[usize]) -> SectorConfig {
    let mut is_marked = [false; COLUMNS];
    cells.iter().for_each(|cell| is_marked[cell % COLUMNS] = true);
    let columns: Vec<usize> = (0..COLUMNS).filter(|&column| is_marked[column]).collect();
    // The widest gap between neighbouring columns, around the circle.
    let gap = |i: usize| columns.get(i + 1).copied().unwrap_or(columns[0] + COLUMNS) - columns[i];
    let widest = (0..columns.len()).fold(columns.len() - 1, |best, i| if gap(i) > gap(best) { i } else { best });
    let from = columns[(widest + 1) % columns.len()] as f64 * STEP_DEG - STEP_DEG;
    let width = (360.0 - gap(widest) as f64 * STEP_DEG + 2.0 * STEP_DEG).min(360.0);
    let elevation = |cell: Option<&usize>| cell.map_or(0.0, |cell| (cell / COLUMNS) as f64 * STEP_DEG - 90.0);
    SectorConfig {
        sector,
        azimuth_from_deg: from,
        azimuth_to_deg: from + width,
        elevation_from_deg: (elevation(cells.first()) - STEP_DEG).max(-90.0),
        elevation_to_deg: (elevation(cells.last()) + STEP_DEG).min(90.0),
    }
}
