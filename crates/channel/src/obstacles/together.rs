//! What a straight line meets of obstacles that touch or overlap, where that is not what it meets of each alone.

use crate::geometry::position::Position;
use crate::geometry::shape::{LEVEL_M, join_near};
use crate::obstacles::crossing::Crossing;
use crate::obstacles::obstacle::Obstacle;

/// Parts of a line from their beginning to their end (m), in order.
type Spans = Vec<[f64; 2]>;

/// A line between two obstacles is judged by those so far beside it (m): gaps of less than a millimetre are closed, ...
const ASIDE_M: f64 = LEVEL_M;
/// ... and by those so far above and below it (m): of bodies whose common face slopes.
const ABOVE_M: f64 = 1e-6;
/// Parts of a line shorter than this are rounding (m).
const ROUNDING_M: f64 = 1e-9;

/// An obstacle at a line.
struct Member<'a> {
    number: usize,
    obstacle: &'a Obstacle,
    spans: Spans,
}

impl Member<'_> {
    fn holds(&self, at_m: f64) -> bool {
        holds(&self.spans, at_m)
    }
}

fn holds(spans: &Spans, at_m: f64) -> bool {
    spans.iter().any(|span| span[0] < at_m && at_m < span[1])
}

/// How long two spans have in common (m); below 0, what is between them.
fn common_m(one: [f64; 2], other: [f64; 2]) -> f64 {
    one[1].min(other[1]) - one[0].max(other[0])
}

/// What the line from `from` to `to` meets of those `obstacles` with these numbers, which touch others and are near to it;
/// `None` if that is what it meets of each alone.
///
/// - A line between obstacles that touch is in the way of the weaker of those beside it.
/// - Pieces of walls count once where they overlap: the strongest absorbs.
/// - Pieces of one wall that touch on the line, and pieces of walls that overlap there, are one passage: it costs the greatest
///   of their fixed losses.
pub(super) fn met(obstacles: &[Obstacle], numbers: &[usize], from: Position, to: Position) -> Option<Vec<Crossing>> {
    let member = |&number: &usize| {
        let obstacle = &obstacles[number];
        Member { number, obstacle, spans: obstacle.shape().spans(from, to) }
    };
    let mut members: Vec<Member<'_>> = numbers.iter().map(member).collect();
    members.sort_unstable_by_key(|member| member.number);
    let is_closed = close_joints(&mut members, from, to);
    let mut passages: Vec<usize> = members.iter().map(|member| member.spans.len()).collect();
    let is_shared = share_passages(&members, &mut passages);
    let is_cut = cut_overlaps(&mut members);
    let crossing = |(member, passages): (&Member<'_>, usize)| {
        let length_m = member.spans.iter().fold(0.0, |sum, span| sum + (span[1] - span[0]));
        Crossing { obstacle: member.number, length_m, passages }
    };
    let crossings = members.iter().zip(passages).map(crossing);
    (is_closed || is_shared || is_cut)
        .then(|| crossings.filter(|crossing| crossing.length_m > 0.0 || crossing.passages > 0).collect())
}

/// Adds to the members the parts of the line that are in none of them, while the lines beside it are in some on all sides.
fn close_joints(members: &mut [Member<'_>], from: Position, to: Position) -> bool {
    if members.iter().all(|member| !member.spans.is_empty()) {
        return false;
    }
    let length_m = from.distance_m(to);
    let beside = asides(from, to).map(|aside| {
        let of = |member: &Member<'_>| member.obstacle.shape().spans(from + aside, to + aside);
        members.iter().map(of).collect::<Vec<Spans>>()
    });
    let all = members.iter().map(|member| &member.spans).chain(beside.iter().flatten());
    let mut cuts: Vec<f64> = all.flatten().flatten().copied().collect();
    cuts.sort_unstable_by(f64::total_cmp);
    let mut closed: Vec<(usize, [f64; 2])> = Vec::new();
    for pair in cuts.windows(2).filter(|pair| pair[1] - pair[0] > ROUNDING_M) {
        let at_m = f64::midpoint(pair[0], pair[1]);
        if members.iter().any(|member| member.holds(at_m)) {
            continue;
        }
        let of = |&member: &usize| members[member].obstacle;
        let by = |one: &usize, other: &usize| {
            let absorption = of(one).absorption_per_m().total_cmp(&of(other).absorption_per_m());
            absorption.then(of(one).loss().0.total_cmp(&of(other).loss().0))
        };
        let strongest = |spans: &Vec<Spans>| (0..spans.len()).filter(|&i| holds(&spans[i], at_m)).max_by(by);
        let sides: Option<Vec<usize>> = beside.iter().map(strongest).collect();
        if let Some(weakest) = sides.and_then(|sides| sides.into_iter().min_by(by)) {
            closed.push((weakest, [pair[0], pair[1]]));
        }
    }
    // A short part at an end of the line, or of what it is in, is a place in a corner.
    let is_corner = |run: [f64; 2]| {
        let is_at_end = run[0] <= ASIDE_M || run[1] >= length_m - ASIDE_M;
        let is_beside = |member: &Member<'_>| member.spans.iter().any(|&span| common_m(span, run) >= -ASIDE_M);
        run[1] - run[0] < 4.0 * ASIDE_M && (is_at_end || members.iter().any(is_beside))
    };
    let runs = closed.chunk_by(|one, other| other.1[0] - one.1[1] <= ROUNDING_M);
    let joints: Vec<_> = runs.filter(|run| !is_corner([run[0].1[0], run[run.len() - 1].1[1]])).flatten().collect();
    for &&(member, span) in &joints {
        let spans = &mut members[member].spans;
        spans.push(span);
        join_near(spans);
    }
    !joints.is_empty()
}

/// The ways from a line to the four lines beside it.
fn asides(from: Position, to: Position) -> [Position; 4] {
    let way = to - from;
    let level_m = libm::hypot(way.x_m, way.y_m);
    let left = if level_m > 0.0 {
        Position::new(-way.y_m / level_m, way.x_m / level_m, 0.0)
    } else {
        Position::new(1.0, 0.0, 0.0)
    };
    let above = way.cross(left) * (ABOVE_M / way.length_m());
    let left = left * ASIDE_M;
    [left + above, left - above, above - left, (left + above) * -1.0]
}

/// Takes from each piece of a wall what of the line is in a stronger one.
fn cut_overlaps(members: &mut [Member<'_>]) -> bool {
    let mut pieces: Vec<usize> = (0..members.len()).filter(|&i| members[i].obstacle.wall().is_some()).collect();
    let absorbs = |i: &usize| members[*i].obstacle.absorption_per_m();
    pieces.sort_by(|one, other| absorbs(other).total_cmp(&absorbs(one)));
    let mut taken: Spans = Vec::new();
    let mut is_cut = false;
    for piece in pieces {
        let spans = &mut members[piece].spans;
        let whole = spans.clone();
        for &by in &taken {
            if spans.iter().any(|&span| common_m(span, by) > ROUNDING_M) {
                is_cut = true;
                let rest = |span: [f64; 2]| [[span[0], span[1].min(by[0])], [span[0].max(by[1]), span[1]]];
                *spans = spans.iter().flat_map(|&span| rest(span)).filter(|[a, b]| b - a > ROUNDING_M).collect();
            }
        }
        taken.extend(whole);
    }
    is_cut
}

/// Counts each passage through pieces of walls at the piece with the greatest fixed loss.
fn share_passages(members: &[Member<'_>], passages: &mut [usize]) -> bool {
    let loss = |member: usize| members[member].obstacle.loss().0;
    let parts: Vec<(usize, usize, [f64; 2])> = (0..members.len())
        .filter(|&i| loss(i) > 0.0)
        .filter_map(|i| Some((i, members[i].obstacle.wall()?)))
        .flat_map(|(i, wall)| members[i].spans.iter().map(move |&span| (i, wall, span)))
        .collect();
    let is_one = |&(_, wall, span): &(usize, usize, [f64; 2]), &(_, other, beside): &(usize, usize, [f64; 2])| {
        common_m(span, beside) >= if wall == other { -LEVEL_M } else { LEVEL_M }
    };
    let mut group: Vec<usize> = (0..parts.len()).collect();
    for later in 0..parts.len() {
        for earlier in 0..later {
            if is_one(&parts[later], &parts[earlier]) {
                let (old, new) = (group[later], group[earlier]);
                group[..=later].iter_mut().filter(|group| **group == old).for_each(|group| *group = new);
            }
        }
    }
    let mut is_shared = false;
    for first in 0..parts.len() {
        let of = |&part: &usize| group[part] == group[first];
        if (0..first).any(|part| of(&part)) {
            continue;
        }
        let by = |one: &usize, other: &usize| loss(parts[*one].0).total_cmp(&loss(parts[*other].0));
        let dearest = (0..parts.len()).filter(of).max_by(by);
        for part in (0..parts.len()).filter(of).filter(|part| Some(*part) != dearest) {
            passages[parts[part].0] -= 1;
            is_shared = true;
        }
    }
    is_shared
}
