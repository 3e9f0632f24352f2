//! The time line: what each station does, as bars, and the ways of packets from station to station.

mod plan;
mod span;
mod ways;
mod window;

use std::collections::{BTreeMap, BTreeSet};

use plotters::style::RGBColor;
use sextant_kernel::NodeId;

use super::PacketSource;
use crate::paint::palette::{ACCENT, GRID, INK, THREAD};
use crate::paint::picture::{Anchor, Area, Picture, Point, Stroke, TextStyle, shortened};
use crate::plot::axes::{Axes, Axis, FRAME, Shown, TICK_TEXT};
use crate::plot::sheet::{Entry, Sheet, Symbol};
use plan::{OnTime, PLANNED};
use span::{LOOKS, Span};
use ways::{Leg, Piece};
use window::WholeWay;

/// Width of the plot (px).
const WIDTH: f64 = 820.0;
/// Height of the row of a station (px); less if there are many.
const ROW: f64 = 24.0;
/// Height of all rows together, from which on they are lower (px).
const HIGHEST: f64 = 640.0;
/// Stations that are drawn, at most.
const MOST_ROWS: usize = 40;
/// Longest name of a station (px).
const LONGEST_NAME: f64 = 64.0;
/// A bar is at least this wide (px).
const LEAST_PX: f64 = 2.0;
/// Bars that are drawn, at most: the window ends there.
const MOST_BARS: usize = 3000;
/// Slots and checks behind them, at most; more are left out.
const MOST_PLANNED: usize = 3000;
/// The way of any packet, ...
const WAY: Stroke = Stroke::new(THREAD, 1.0);
/// ... and of the one that the picture is about.
const SHOWN_WAY: Stroke = Stroke::new(INK, 2.0);

/// What is drawn.
struct TimeLine {
    from_s: f64,
    to_s: f64,
    spans: Vec<Span>,
    planned: Vec<OnTime>,
    pieces: Vec<Piece>,
    about: Option<WholeWay>,
    /// The row of each station.
    rows: BTreeMap<u32, usize>,
    /// What was left out, in words.
    left_out: Vec<String>,
}

/// The figure; `None` if nothing was sent or assessed.
pub(super) fn draw(source: &PacketSource<'_>) -> Option<Picture> {
    let line = TimeLine::new(source)?;
    let row = ROW.min(HIGHEST / line.rows.len().max(1) as f64);
    let (mut picture, areas) = line.sheet(source).lay_out(&[(WIDTH, row * line.rows.len().max(1) as f64)]);
    let (scale, unit) = if line.to_s - line.from_s > 2.0 { (1.0, "s") } else { (1e3, "ms") };
    let axes = Axes {
        across: Axis {
            low: 0.0,
            high: scale * (line.to_s - line.from_s),
            name: format!("time after {:.4} s ({unit})", line.from_s),
            shown: Shown::All,
        },
        up: Axis { low: 0.0, high: line.rows.len().max(1) as f64, name: String::new(), shown: Shown::All },
        area: areas[0],
    };
    let canvas = Canvas { line: &line, axes: &axes, scale, row };
    canvas.draw(source, &mut picture);
    picture.frame(areas[0], FRAME);
    // Rows have names instead of numbers.
    Axes { up: Axis { low: 0.0, high: 0.0, ..axes.up.clone() }, ..axes }.draw(&mut picture);
    Some(picture)
}

impl TimeLine {
    fn new(source: &PacketSource<'_>) -> Option<Self> {
        let ((from_s, mut to_s), about) = window::window(source)?;
        let mut left_out = Vec::new();
        let mut spans = span::within(source, (from_s, to_s));
        if let Some(first_more) = spans.get(MOST_BARS) {
            to_s = first_more.from_s;
            left_out.push(format!("cut after {MOST_BARS} bars"));
            spans.truncate(MOST_BARS);
        }
        let pieces = ways::within(source, (from_s, to_s));
        let (rows, more) = rows(source, &spans, &pieces, about);
        if more > 0 {
            left_out.push(format!("{more} more stations"));
        }
        let planned = plan::within(source, (from_s, to_s), MOST_PLANNED);
        if planned.is_none() {
            left_out.push("too long for its slots and checks".to_owned());
        }
        let mut planned = planned.unwrap_or_default();
        planned.retain(|time| rows.contains_key(&time.station));
        spans.retain(|span| rows.contains_key(&span.station));
        Some(Self { from_s, to_s, spans, planned, pieces, about, rows, left_out })
    }

    fn sheet(&self, source: &PacketSource<'_>) -> Sheet {
        let shown: BTreeSet<_> = self.spans.iter().map(|span| span.bar).collect();
        let bars = LOOKS.iter().filter(|look| shown.contains(&look.bar)).map(|look| Entry {
            symbol: Symbol::Square { side: if look.height > 0.5 { 12.0 } else { 7.0 }, fill: look.fill },
            text: look.text.to_owned(),
        });
        let mut legend: Vec<Entry> = bars.collect();
        let line =
            |stroke, text: &str| Entry { symbol: Symbol::Line { stroke, pattern: &[] }, text: text.to_owned() };
        if let Some(way) = self.about {
            legend.push(line(
                SHOWN_WAY,
                &format!("way of packet {} of {}", way.identity.1, source.name(way.identity.0)),
            ));
        }
        if self.pieces.iter().any(|piece| matches!(piece.leg, Leg::To { .. }) && !self.is_about(piece)) {
            legend.push(line(WAY, if self.about.is_some() { "way of another packet" } else { "way of a packet" }));
        }
        if self.pieces.iter().any(|piece| matches!(piece.leg, Leg::Lost { .. })) {
            legend.push(Entry { symbol: Symbol::Cross { stroke: LOST }, text: "given up".to_owned() });
        }
        let planned: BTreeSet<_> = self.planned.iter().map(|time| time.planned).collect();
        legend.extend(
            PLANNED
                .iter()
                .filter(|(what, ..)| planned.contains(what))
                .map(|&(_, fill, text)| Entry { symbol: Symbol::Square { side: 12.0, fill }, text: text.to_owned() }),
        );
        let mut note = vec![format!("{:.4} s to {:.4} s, one row a station", self.from_s, self.to_s)];
        if let Some(way) = self.about {
            note.push(format!("the quickest packet over {} hops", way.hops));
        }
        note.extend(self.left_out.iter().cloned());
        Sheet { title: format!("{}: time line", source.title), note: note.join("; "), bar: None, legend }
    }

    /// Whether a piece belongs to the packet that the picture is about.
    fn is_about(&self, piece: &Piece) -> bool {
        self.about.is_some_and(|way| piece.identity == Some(way.identity))
    }
}

/// The mark of a packet that is given up.
const LOST: Stroke = Stroke::new(ACCENT, 1.6);

/// The row of each station that takes part, and how many more there are: those that are farthest from a sink first, where there is a tree, and sinks last.
fn rows(
    source: &PacketSource<'_>,
    spans: &[Span],
    pieces: &[Piece],
    about: Option<WholeWay>,
) -> (BTreeMap<u32, usize>, usize) {
    let ends = |piece: &Piece| match piece.leg {
        Leg::At { station, .. } | Leg::Lost { station, .. } => [station, station],
        Leg::To { from, to, .. } => [from, to],
    };
    let own = pieces.iter().filter(|piece| about.is_some_and(|way| piece.identity == Some(way.identity)));
    let on_way: BTreeSet<u32> = own.flat_map(ends).collect();
    let all: BTreeSet<u32> = spans
        .iter()
        .map(|span| span.station)
        .chain(pieces.iter().flat_map(ends))
        .chain(on_way.iter().copied())
        .collect();
    let mut chosen: Vec<u32> = all.iter().copied().collect();
    // Those on the way come first, so that they are not left out.
    chosen.sort_by_key(|station| (!on_way.contains(station), *station));
    let more = chosen.len().saturating_sub(MOST_ROWS);
    chosen.truncate(MOST_ROWS);
    let depth =
        |station: u32| source.drawn.tree.get(NodeId(station).index()).map(|edge| edge.depth.unwrap_or(u32::MAX));
    chosen.sort_by_key(|&station| (std::cmp::Reverse(depth(station)), station));
    (chosen.into_iter().enumerate().map(|(row, station)| (station, row)).collect(), more)
}

/// The shape of a bar.
#[derive(Clone, Copy)]
struct Shape {
    /// Its height as a share of the row.
    height: f64,
    fill: RGBColor,
    /// It is at least this wide (px).
    least_px: f64,
}

/// Where a time line is drawn.
struct Canvas<'a> {
    line: &'a TimeLine,
    axes: &'a Axes,
    /// From seconds to the unit of the axis.
    scale: f64,
    /// Height of a row (px).
    row: f64,
}

impl Canvas<'_> {
    /// The middle of the row of a station (px); `None` if it has none.
    fn middle(&self, station: u32) -> Option<f64> {
        let row = *self.line.rows.get(&station)?;
        Some(self.axes.area.top + self.row * (row as f64 + 0.5))
    }

    fn x(&self, s: f64) -> f64 {
        let TimeLine { from_s, to_s, .. } = *self.line;
        self.axes.at(self.scale * (s.clamp(from_s, to_s) - from_s), 0.0).x
    }

    fn draw(&self, source: &PacketSource<'_>, picture: &mut Picture) {
        let area = self.axes.area;
        for time in &self.line.planned {
            let height = if time.planned == plan::Planned::Checks { 0.5 } else { 1.0 };
            let shape = Shape { height, fill: time.planned.color(), least_px: 0.6 };
            self.rectangle(picture, time.station, (time.from_s, time.to_s), shape);
        }
        for &station in self.line.rows.keys() {
            let Some(middle) = self.middle(station) else { continue };
            picture.line(Point::new(area.left, middle), Point::new(area.right(), middle), Stroke::new(GRID, 1.0));
            let style = TextStyle { em: TICK_TEXT.em.min(0.85 * self.row), ..TICK_TEXT };
            let name = shortened(&source.name(station), LONGEST_NAME, style);
            picture.text(Point::new(area.left - 8.0, middle), &name, Anchor::End, style);
        }
        let (own, others): (Vec<&Piece>, Vec<&Piece>) =
            self.line.pieces.iter().partition(|piece| self.line.is_about(piece));
        others.iter().for_each(|piece| self.piece(picture, piece, WAY));
        own.iter().for_each(|piece| self.piece(picture, piece, SHOWN_WAY));
        for span in &self.line.spans {
            let look = span.bar.look();
            let shape = Shape { height: look.height, fill: look.fill, least_px: LEAST_PX };
            self.rectangle(picture, span.station, (span.from_s, span.to_s), shape);
        }
        for piece in &self.line.pieces {
            if let Leg::Lost { station, at_s } = piece.leg
                && let Some(y) = self.middle(station)
            {
                picture.cross(Point::new(self.x(at_s) + 4.0, y), 3.0, LOST);
            }
        }
    }

    /// A bar in the row of a station.
    fn rectangle(&self, picture: &mut Picture, station: u32, (from_s, to_s): (f64, f64), shape: Shape) {
        let Shape { height, fill, least_px } = shape;
        let Some(middle) = self.middle(station) else { return };
        let (left, right) = (self.x(from_s), self.x(to_s));
        let half = 0.5 * height * self.row;
        let width = (right - left).max(least_px).min((self.axes.area.right() - left).max(0.0));
        picture.rectangle(Area { left, top: middle - half, width, height: 2.0 * half }, fill);
    }

    fn piece(&self, picture: &mut Picture, piece: &Piece, stroke: Stroke) {
        match piece.leg {
            Leg::At { station, from_s, to_s } if piece.identity.is_some() => {
                if let Some(y) = self.middle(station) {
                    picture.line(Point::new(self.x(from_s), y), Point::new(self.x(to_s), y), stroke);
                }
            }
            Leg::To { from, to, at_s } => {
                if let (Some(start), Some(end)) = (self.middle(from), self.middle(to)) {
                    let x = self.x(at_s);
                    picture.line(Point::new(x, start), Point::new(x, end), stroke);
                    picture.disc(Point::new(x, end), 1.0 + stroke.width, stroke.color);
                }
            }
            Leg::At { .. } | Leg::Lost { .. } => {}
        }
    }
}
