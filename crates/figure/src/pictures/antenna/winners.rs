//! The greatest gain of any sector in each direction, and the sector that has it.

use plotters::style::RGBColor;
use sextant_channel::{Antenna, Db};

use super::towards;
use crate::paint::palette::{CURVES, INK, PAPER, Ramp};
use crate::paint::picture::{Anchor, Area, Picture, Stroke};
use crate::plot::axes::{Axes, Axis, Shown, TICK_TEXT};
use crate::plot::sheet::{ColourBar, Sheet};

/// Size of each plot (px).
const SIZE: (f64, f64) = (720.0, 300.0);
/// Step between directions (degrees).
const STEP_DEG: i32 = 2;
const COLUMNS: usize = 180;
const ROWS: usize = 90;
/// Fewest directions of a region with a number.
const FEWEST: usize = 14;
/// Lowest gain that has its own colour, below the greatest (dB).
const SPAN_DB: f64 = 30.0;
/// How much of a curve's colour the areas of a sector have: neighbours differ in colour or in share.
const SHARES: [f64; 3] = [0.75, 0.5, 0.3];
/// Gains that differ by less are equal (dB).
const EQUAL_DB: f64 = 1e-9;
const BORDER: Stroke = Stroke::new(INK, 0.7);

/// The directions of the grid, row by row from the lowest elevation: the best sector, `None` if several are equally good,
/// and its gain (dBi).
struct Winners(Vec<(Option<u8>, f64)>);

impl Winners {
    fn of(antenna: &Antenna) -> Self {
        let half = f64::from(STEP_DEG) / 2.0;
        let direction = |place: usize| {
            let (row, column) = (place / COLUMNS, place % COLUMNS);
            let step = f64::from(STEP_DEG);
            towards(-180.0 + step * column as f64 + half, -90.0 + step * row as f64 + half)
        };
        let best = |place: usize| {
            let direction = direction(place);
            let sector = antenna.best_sector(direction);
            let Db(gain) = antenna.gain(sector, direction);
            let is_equal = |other| other != sector && antenna.gain(other, direction).0 > gain - EQUAL_DB;
            ((!(0..antenna.sector_count()).any(is_equal)).then_some(sector), gain)
        };
        Self((0..COLUMNS * ROWS).map(best).collect())
    }

    fn sector(&self, column: usize, row: usize) -> Option<u8> {
        self.0[row * COLUMNS + column].0
    }

    /// Regions of neighbouring directions with one best sector: the sector, and a direction well inside.
    fn regions(&self) -> Vec<(u8, usize, usize)> {
        let mut seen = vec![false; self.0.len()];
        let mut regions = Vec::new();
        for start in 0..self.0.len() {
            if seen[start] {
                continue;
            }
            let Some(sector) = self.0[start].0 else { continue };
            let (mut next, mut members) = (vec![start], Vec::new());
            seen[start] = true;
            while let Some(place) = next.pop() {
                members.push(place);
                let (row, column) = (place / COLUMNS, place % COLUMNS);
                let beside = [
                    (column > 0).then(|| place - 1),
                    (column + 1 < COLUMNS).then_some(place + 1),
                    (row > 0).then(|| place - COLUMNS),
                    (row + 1 < ROWS).then_some(place + COLUMNS),
                ];
                for other in beside.into_iter().flatten().filter(|&other| self.0[other].0 == Some(sector)) {
                    if !std::mem::replace(&mut seen[other], true) {
                        next.push(other);
                    }
                }
            }
            if members.len() >= FEWEST {
                regions.extend(inside(&members).map(|place| (sector, place % COLUMNS, place / COLUMNS)));
            }
        }
        regions
    }
}

/// The member nearest to the middle of all.
fn inside(members: &[usize]) -> Option<usize> {
    let count = members.len() as f64;
    let column = |place: usize| (place % COLUMNS) as f64;
    let row = |place: usize| (place / COLUMNS) as f64;
    let middle = |of: &dyn Fn(usize) -> f64| members.iter().map(|&place| of(place)).sum::<f64>() / count;
    let (x, y) = (middle(&column), middle(&row));
    let away = |place: usize| libm::hypot(column(place) - x, row(place) - y);
    members.iter().copied().min_by(|&a, &b| away(a).total_cmp(&away(b)))
}

pub(super) fn draw(title: &str, antenna: &Antenna) -> Picture {
    let winners = Winners::of(antenna);
    let greatest = winners.0.iter().map(|&(_, gain)| gain).fold(f64::NEG_INFINITY, f64::max);
    let lowest = winners.0.iter().map(|&(_, gain)| gain).fold(f64::INFINITY, f64::min);
    let low = lowest.max(greatest - SPAN_DB);
    let name = "greatest gain (dBi)".to_owned();
    let bar = ColourBar {
        name,
        low,
        high: if greatest > low { greatest } else { low + 1.0 },
        open_end: false,
        finest: 1.0,
        ramp: Ramp::Areas,
    };
    let won: std::collections::BTreeSet<u8> = winners.0.iter().filter_map(|&(sector, _)| sector).collect();
    let Db(listens) = antenna.quasi_omni();
    let note = format!(
        "in the frame of the antenna; {} of {} sectors are the best somewhere; listens with {listens:.1} dBi at most",
        won.len(),
        antenna.sector_count()
    );
    let sheet = Sheet { title: format!("{title}: best sector"), note, bar: Some(bar.clone()), legend: Vec::new() };
    let (mut picture, areas) = sheet.lay_out(&[SIZE, SIZE]);
    let axes = |area: Area, shown: Shown| Axes {
        across: Axis { low: -180.0, high: 180.0, name: "azimuth (\u{b0})".to_owned(), shown },
        up: Axis { low: -90.0, high: 90.0, name: "elevation (\u{b0})".to_owned(), shown: Shown::All },
        area,
    };
    let gains = axes(areas[0], Shown::Ticks);
    fill(&mut picture, &gains, |place| bar.color(winners.0[place].1));
    gains.draw(&mut picture);
    let sectors = axes(areas[1], Shown::All);
    fill(&mut picture, &sectors, |place| winners.0[place].0.map_or(PAPER, color));
    draw_borders(&mut picture, &sectors, &winners);
    for (sector, column, row) in winners.regions() {
        let text = antenna.identity(sector).to_string();
        picture.text(corner(&sectors, column as f64 + 0.5, row as f64 + 0.5), &text, Anchor::Middle, TICK_TEXT);
    }
    sectors.draw(&mut picture);
    picture
}

/// The point of the picture of a corner of the grid.
fn corner(axes: &Axes, column: f64, row: f64) -> crate::paint::picture::Point {
    let step = f64::from(STEP_DEG);
    axes.at(-180.0 + step * column, -90.0 + step * row)
}

/// Fills the grid with one rectangle for each run of equal colours.
fn fill(picture: &mut Picture, axes: &Axes, color: impl Fn(usize) -> RGBColor) {
    for row in 0..ROWS {
        let mut column = 0;
        while column < COLUMNS {
            let fill = color(row * COLUMNS + column);
            let mut end = column + 1;
            while end < COLUMNS && color(row * COLUMNS + end) == fill {
                end += 1;
            }
            let (low, high) = (corner(axes, column as f64, row as f64), corner(axes, end as f64, row as f64 + 1.0));
            // The rectangle is slightly larger, so that no gap is visible to its neighbours.
            let area =
                Area { left: low.x, top: high.y - 0.4, width: high.x - low.x + 0.4, height: low.y - high.y + 0.4 };
            picture.rectangle(area, fill);
            column = end;
        }
    }
}

/// Lines between directions with different best sectors.
fn draw_borders(picture: &mut Picture, axes: &Axes, winners: &Winners) {
    for row in 0..ROWS {
        for column in 1..COLUMNS {
            if winners.sector(column - 1, row) != winners.sector(column, row) {
                let ends = [row as f64, row as f64 + 1.0].map(|y| corner(axes, column as f64, y));
                picture.line(ends[0], ends[1], BORDER);
            }
        }
    }
    for row in 1..ROWS {
        for column in 0..COLUMNS {
            if winners.sector(column, row - 1) != winners.sector(column, row) {
                let ends = [column as f64, column as f64 + 1.0].map(|x| corner(axes, x, row as f64));
                picture.line(ends[0], ends[1], BORDER);
            }
        }
    }
}

/// The colour of a sector: one of the colours of curves on paper, with one of several shares.
fn color(sector: u8) -> RGBColor {
    // Without the last one, black.
    let colors = CURVES.len() - 1;
    let own = CURVES[usize::from(sector) % colors];
    let share = SHARES[usize::from(sector) / colors % SHARES.len()];
    let mixed = |own: u8, paper: u8| {
        let mixed = f64::from(own) * share + f64::from(paper) * (1.0 - share);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a mean of octets is an octet")]
        let octet = mixed.round() as u8;
        octet
    };
    RGBColor(mixed(own.0, PAPER.0), mixed(own.1, PAPER.1), mixed(own.2, PAPER.2))
}
