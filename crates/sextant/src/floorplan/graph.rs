//! From the thinned walls to lines from corner to corner.

use super::lines::{Cell, distance, simplified};
use super::occupancy::Mask;
use super::thinning::crossings;

/// A line of a wall in cells.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct WallLine {
    pub(super) line: Vec<Cell>,
    /// Mean thickness (cells).
    pub(super) thickness: f64,
    /// Of its first and its last place, whether the wall ends there and meets no other one.
    pub(super) is_free: [bool; 2],
}

/// A line between two meeting points, or free ends.
struct Stroke {
    cells: Vec<Cell>,
    /// The meeting point at each end; `None` for a free one.
    ends: [Option<usize>; 2],
    is_closed: bool,
    thickness: f64,
    /// How deep in the wall its two ends are (cells).
    depths: [f64; 2],
}

/// The cells of a stroke in order.
struct Course {
    cells: Vec<usize>,
    ends: [Option<usize>; 2],
    is_closed: bool,
}

/// One end of a stroke.
type End = (usize, usize);

/// The lines of the walls `mask`, thinned to `thin`, whose cells are so deep in it. Lines that go straight on where walls meet are one.
pub(super) fn wall_lines(mask: &Mask, thin: &Mask, depths: &[f32]) -> Vec<WallLine> {
    let (mut meetings, node_of) = meetings(thin);
    let mut strokes = strokes(mask, thin, depths, &node_of, &mut meetings);
    drop_spurs(&mut strokes);
    let partners = partners(&strokes, &meetings);
    join(&strokes, &meetings, &partners)
}

/// Where lines meet: the middle of each meeting point, and the number of the point of its cells.
fn meetings(thin: &Mask) -> (Vec<Cell>, Vec<Option<usize>>) {
    let mut crossing = thin.empty_like();
    for cell in thin.members().filter(|&cell| crossings(thin, cell) >= 3) {
        crossing.cells[cell] = true;
        // Its neighbours too: lines that leave it touch each other at corners of cells.
        thin.neighbours(cell).for_each(|neighbour| crossing.cells[neighbour] = true);
    }
    let mut node_of = vec![None; thin.cells.len()];
    let middles = crossing.components().into_iter().enumerate().map(|(number, cells)| {
        let sum = cells.iter().fold([0.0, 0.0], |sum, &cell| {
            node_of[cell] = Some(number);
            let place = thin.place(cell);
            [sum[0] + place[0], sum[1] + place[1]]
        });
        sum.map(|sum| sum / cells.len() as f64)
    });
    (middles.collect(), node_of)
}

/// The lines between meeting points.
fn strokes(
    mask: &Mask,
    thin: &Mask,
    depths: &[f32],
    node_of: &[Option<usize>],
    meetings: &mut Vec<Cell>,
) -> Vec<Stroke> {
    let mut rest = thin.clone();
    (0..rest.cells.len()).filter(|&cell| node_of[cell].is_some()).for_each(|cell| rest.cells[cell] = false);
    let node_beside = |cell: usize, other: Option<usize>| {
        let mut nodes = thin.neighbours(cell).filter_map(|neighbour| node_of[neighbour]);
        nodes.find(|&node| Some(node) != other)
    };
    let mut courses: Vec<Course> = Vec::new();
    for component in rest.components() {
        let order = in_order(&rest, &component);
        let (first, last) = (order[0], order[order.len() - 1]);
        let at_first = node_beside(first, None);
        // The two ends of a single cell are at different points.
        let at_last = node_beside(last, at_first.filter(|_| order.len() < 3));
        let is_closed = order.len() > 3
            && at_first.is_none()
            && at_last.is_none()
            && rest.neighbours(first).any(|neighbour| neighbour == last);
        if is_closed {
            courses.push(Course { cells: order, ends: [None; 2], is_closed: true });
            continue;
        }
        // Walls of different thickness meet at each place where it changes.
        let mut from = at_first;
        let mut pieces = pieces(thin, depths, &order).into_iter().peekable();
        while let Some(piece) = pieces.next() {
            let to = if pieces.peek().is_some() {
                meetings.push(thin.place(piece[piece.len() - 1]));
                Some(meetings.len() - 1)
            } else {
                at_last
            };
            courses.push(Course { cells: piece, ends: [from, to], is_closed: false });
            from = to;
        }
    }
    let lines: Vec<&[usize]> = courses.iter().map(|course| course.cells.as_slice()).collect();
    let areas = areas(mask, &lines);
    let stroke = |(course, area): (Course, usize)| {
        let Course { cells: order, ends, is_closed } = course;
        let (first, last) = (order[0], order[order.len() - 1]);
        let mut cells: Vec<Cell> = order.iter().map(|&cell| thin.place(cell)).collect();
        if is_closed {
            cells.push(cells[0]);
        }
        let depths = [first, last].map(|cell| f64::from(depths[cell]));
        let free: f64 = (0..2).filter(|&end| ends[end].is_none() && !is_closed).map(|end| depths[end] - 1.0).sum();
        let length: f64 = simplified(&cells, 1.0).windows(2).map(|leg| distance(leg[0], leg[1])).sum();
        let covered = length + if is_closed { 0.0 } else { 1.0 } + free.max(0.0);
        Stroke { cells, ends, is_closed, thickness: (area as f64 / covered).max(1.0), depths }
    };
    courses.into_iter().zip(areas).map(stroke).collect()
}

/// A line cut at those of its corners at which the wall is thicker on one side than on the other.
fn pieces(thin: &Mask, depths: &[f32], order: &[usize]) -> Vec<Vec<usize>> {
    let places: Vec<Cell> = order.iter().map(|&cell| thin.place(cell)).collect();
    let corners: Vec<usize> = simplified(&places, 2.0)
        .iter()
        .filter_map(|corner| places.iter().position(|&place| distance(place, *corner) <= 0.0))
        .collect();
    let thickness = |from: usize, to: usize| {
        let mut depths: Vec<f32> = order[from..=to].iter().map(|&cell| depths[cell]).collect();
        depths.sort_by(f32::total_cmp);
        f64::from(2.0 * depths[depths.len() / 2] - 1.0)
    };
    let mut pieces = Vec::new();
    let mut from = 0;
    for leg in corners.windows(3) {
        let (before, after) = (thickness(leg[0], leg[1]), thickness(leg[1], leg[2]));
        if !are_alike(before, after) {
            pieces.push(order[from..=leg[1]].to_vec());
            from = leg[1] + 1;
        }
    }
    pieces.push(order[from..].to_vec());
    pieces
}

/// Whether two walls are about as thick as each other (cells).
fn are_alike(one: f64, other: f64) -> bool {
    (one - other).abs() <= (0.4 * one.min(other)).max(1.5)
}

/// The cells of a line one after the other.
fn in_order(rest: &Mask, component: &[usize]) -> Vec<usize> {
    let start = component.iter().copied().find(|&cell| rest.neighbours(cell).count() <= 1);
    let mut order = vec![start.unwrap_or(component[0])];
    let mut seen: std::collections::BTreeSet<usize> = order.iter().copied().collect();
    while let Some(next) = rest.neighbours(order[order.len() - 1]).find(|cell| !seen.contains(cell)) {
        seen.insert(next);
        order.push(next);
    }
    order
}

/// The number of cells of the walls that are nearest to each line.
fn areas(mask: &Mask, lines: &[&[usize]]) -> Vec<usize> {
    let mut owner: Vec<Option<usize>> = vec![None; mask.cells.len()];
    let mut queue: Vec<usize> = Vec::new();
    for (number, line) in lines.iter().enumerate() {
        for &cell in *line {
            owner[cell] = Some(number);
            queue.push(cell);
        }
    }
    let mut areas = vec![0; lines.len()];
    let mut next = 0;
    while let Some(&cell) = queue.get(next) {
        next += 1;
        if let Some(number) = owner[cell] {
            areas[number] += 1;
        }
        for neighbour in mask.neighbours(cell) {
            if owner[neighbour].is_none() {
                owner[neighbour] = owner[cell];
                queue.push(neighbour);
            }
        }
    }
    areas
}

/// Drops lines that go from a meeting point to a free end and are not longer than the wall is thick there.
fn drop_spurs(strokes: &mut Vec<Stroke>) {
    strokes.retain(|stroke| {
        let is_spur = stroke.ends.iter().flatten().count() == 1 && {
            let inner = stroke.ends.iter().position(Option::is_some).unwrap_or(0);
            (stroke.cells.len() as f64) <= 1.5 * stroke.depths[inner]
        };
        !is_spur
    });
}

/// The end with which each end goes on at its meeting point.
fn partners(strokes: &[Stroke], meetings: &[Cell]) -> Vec<[Option<End>; 2]> {
    /// Two lines go straight on if they turn by less (cosine of 35°).
    const STRAIGHT: f64 = 0.82;
    let mut partners = vec![[None; 2]; strokes.len()];
    for (node, &middle) in meetings.iter().enumerate() {
        let ends: Vec<End> = (0..strokes.len())
            .flat_map(|stroke| [(stroke, 0), (stroke, 1)])
            .filter(|&(stroke, end)| strokes[stroke].ends[end] == Some(node))
            .collect();
        let direction = |&(stroke, end): &End| {
            let cells = &strokes[stroke].cells;
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few cells")]
            let away = (3.0 + 2.0 * strokes[stroke].thickness) as usize;
            let away = away.min(cells.len() - 1);
            let place = if end == 0 { cells[away] } else { cells[cells.len() - 1 - away] };
            let length = distance(place, middle).max(1e-9);
            [(place[0] - middle[0]) / length, (place[1] - middle[1]) / length]
        };
        let mut pairs: Vec<(f64, End, End)> = Vec::new();
        for (at, a) in ends.iter().enumerate() {
            for b in &ends[at + 1..] {
                let (one, other) = (direction(a), direction(b));
                pairs.push((-(one[0] * other[0] + one[1] * other[1]), *a, *b));
            }
        }
        pairs.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (number, &(straight, a, b)) in pairs.iter().enumerate() {
            let is_free = partners[a.0][a.1].is_none() && partners[b.0][b.1].is_none() && a.0 != b.0;
            // A corner of two lines is one line, and so are the two straightest of several, if they are as thick as each other.
            let is_alike = are_alike(strokes[a.0].thickness, strokes[b.0].thickness);
            if is_free && is_alike && (straight > STRAIGHT || number == 0) {
                partners[a.0][a.1] = Some(b);
                partners[b.0][b.1] = Some(a);
            }
        }
    }
    partners
}

/// The strokes joined at their partners; others end at the face of the wall that they meet.
fn join(strokes: &[Stroke], meetings: &[Cell], partners: &[[Option<End>; 2]]) -> Vec<WallLine> {
    let mut is_used = vec![false; strokes.len()];
    let mut lines = Vec::new();
    let starts = (0..strokes.len()).flat_map(|stroke| [(stroke, 0), (stroke, 1)]);
    let open: Vec<End> = starts.clone().filter(|&(stroke, end)| partners[stroke][end].is_none()).collect();
    for start in open.into_iter().chain(starts) {
        if is_used[start.0] {
            continue;
        }
        let mut line: Vec<Cell> = Vec::new();
        let (mut area, mut length) = (0.0, 0.0);
        let mut at = start;
        let last = loop {
            let (stroke, end) = at;
            is_used[stroke] = true;
            let Stroke { cells, thickness, .. } = &strokes[stroke];
            if end == 0 {
                line.extend(cells)
            } else {
                line.extend(cells.iter().rev())
            }
            area += thickness * cells.len() as f64;
            length += cells.len() as f64;
            let exit = (stroke, 1 - end);
            match partners[stroke][1 - end] {
                Some(next) if !is_used[next.0] => {
                    line.extend(strokes[stroke].ends[1 - end].map(|node| meetings[node]));
                    at = next;
                }
                _ => break exit,
            }
        };
        let is_ring = partners[start.0][start.1].is_some();
        let is_open = !is_ring && !strokes[start.0].is_closed;
        let is_free = [start, last].map(|(stroke, end)| is_open && strokes[stroke].ends[end].is_none());
        if is_ring && let Some(node) = strokes[start.0].ends[start.1] {
            line.push(meetings[node]);
            line.insert(0, meetings[node]);
        } else if is_open {
            finish(&mut line, strokes, meetings, partners, last);
            line.reverse();
            finish(&mut line, strokes, meetings, partners, start);
            line.reverse();
        }
        lines.push(WallLine { line, thickness: area / length, is_free });
    }
    lines
}

/// Brings the last place of `line` to where its wall ends.
fn finish(line: &mut Vec<Cell>, strokes: &[Stroke], meetings: &[Cell], partners: &[[Option<End>; 2]], end: End) {
    let stroke = &strokes[end.0];
    let Some(&last) = line.last() else { return };
    let goal = stroke.ends[end.1].map(|node| {
        let thickest = |has_partner: bool| {
            let others = (0..strokes.len()).flat_map(|other| [(other, 0), (other, 1)]).filter(|&(other, side)| {
                (other, side) != end
                    && strokes[other].ends[side] == Some(node)
                    && partners[other][side].is_some() == has_partner
            });
            others.map(|(other, _)| strokes[other].thickness).fold(0.0, f64::max)
        };
        // Before the wall that goes through there; without any, the thickest one has the corner.
        let (through, beside) = (thickest(true), thickest(false));
        let more = if through > 0.0 {
            -through
        } else if stroke.thickness > beside {
            beside
        } else {
            -beside
        };
        (meetings[node], 0.5 * more)
    });
    let before = line[line.len().saturating_sub(4)];
    let (from, more) = match goal {
        // From the meeting point to the face of the other wall.
        Some((middle, more)) => (middle, more),
        // Thinning takes as much of a free end as it is deep.
        None => (last, stroke.depths[end.1] - 0.5),
    };
    let away = distance(from, before);
    if away <= 0.0 {
        return;
    }
    let way = [(from[0] - before[0]) / away, (from[1] - before[1]) / away];
    let place = [from[0] + more * way[0], from[1] + more * way[1]];
    // What lies beyond is no part of it.
    while line.len() > 1 && distance(line[line.len() - 1], before) > distance(place, before) {
        line.pop();
    }
    line.push(place);
}
