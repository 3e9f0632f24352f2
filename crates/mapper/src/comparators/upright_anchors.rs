//! Near anchors that span space: those of a node whose tetrahedra are not nearly flat.
//!
//! In which order the anchors are listed does not matter. Of many anchors that are equally many hops away, those are
//! tried that are farthest from one another, because they make the largest tetrahedra. Anchors nearby may all lie on one
//! wall; then the nearest ones that do not are taken too. So more anchors never leave a node without a place that it has
//! with fewer.

use sextant_channel::Position;

/// Volume over mean edge of a tetrahedron, 1 if it is regular, up to which it is flat.
pub(super) const FLAT: f64 = 0.1;
/// Number of nearest anchors of which tetrahedra are made.
const NEAREST: usize = 12;

/// An anchor that a node reaches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ReachedAnchor {
    /// Its index among all anchors.
    pub(super) anchor: usize,
    pub(super) place: Position,
    /// Hops from the node.
    pub(super) hops: u32,
}

/// Sorts anchors by their hops, the nearest ones first, and equally near ones by their coordinates.
pub(super) fn sort_nearest_first(reached: &mut [ReachedAnchor]) {
    let coordinates = |of: &ReachedAnchor| <[f64; 3]>::from(of.place);
    reached.sort_by(|a, b| {
        let by_axis = |axis: usize| coordinates(a)[axis].total_cmp(&coordinates(b)[axis]);
        a.hops.cmp(&b.hops).then_with(|| by_axis(0)).then_with(|| by_axis(1)).then_with(|| by_axis(2))
    });
}

/// Those of the anchors `reached`, the nearest ones first, that form a tetrahedron (a triangle in two `dimensions`) which
/// is not nearly flat, in the same order. They are among the nearest few, if these do not all lie in a plane (on a line);
/// otherwise the nearest anchors that lift them out of it come with them. None if there are none.
pub(super) fn upright(reached: &[ReachedAnchor], dimensions: usize) -> Vec<ReachedAnchor> {
    let (tried, rest) = nearest(reached);
    let kept = in_upright_figures(&tried, dimensions);
    if !kept.is_empty() {
        return kept;
    }
    let lifted = lifted(&tried, &rest, dimensions);
    if !lifted.is_empty() {
        return lifted;
    }
    // The nearest ones may even be on one line, out of which no single anchor lifts them.
    let mut spread: Vec<ReachedAnchor> = reached.first().copied().into_iter().collect();
    spread_out(&mut spread, reached.get(1..).unwrap_or_default().to_vec());
    sort_nearest_first(&mut spread);
    in_upright_figures(&spread, dimensions)
}

/// The few nearest anchors, and the others. Of those that tie for the last places, the ones that are far from the nearer
/// anchors and from one another are chosen.
fn nearest(reached: &[ReachedAnchor]) -> (Vec<ReachedAnchor>, Vec<ReachedAnchor>) {
    let Some(last) = reached.get(NEAREST - 1).map(|last| last.hops) else { return (reached.to_vec(), Vec::new()) };
    let sure = reached.partition_point(|anchor| anchor.hops < last);
    let tied = reached.partition_point(|anchor| anchor.hops <= last);
    let mut tried = reached[..sure].to_vec();
    let mut rest = spread_out(&mut tried, reached[sure..tied].to_vec());
    rest.extend(&reached[tied..]);
    sort_nearest_first(&mut tried);
    (tried, rest)
}

/// Adds those of `others` to `chosen` that are farthest from all that are chosen, one after the other, up to the number of
/// nearest anchors; the first one is the farthest from the middle. The result is the ones left over, in their order.
fn spread_out(chosen: &mut Vec<ReachedAnchor>, mut others: Vec<ReachedAnchor>) -> Vec<ReachedAnchor> {
    #[expect(clippy::cast_precision_loss, reason = "a number of anchors")]
    let share = 1.0 / others.len().max(1) as f64;
    let middle = others.iter().fold(Position::ORIGIN, |sum, anchor| sum + anchor.place * share);
    while chosen.len() < NEAREST && !others.is_empty() {
        let apart_m = |place: Position| -> f64 {
            let nearest_m = chosen.iter().map(|other| other.place.distance_m(place)).fold(f64::INFINITY, f64::min);
            if chosen.is_empty() { middle.distance_m(place) } else { nearest_m }
        };
        let distances_m: Vec<f64> = others.iter().map(|other| apart_m(other.place)).collect();
        let farthest =
            (1..others.len()).fold(0, |best, at| if distances_m[at] > distances_m[best] { at } else { best });
        chosen.push(others.remove(farthest));
    }
    others
}

/// Those of a few anchors that are corners of a figure which is not nearly flat.
fn in_upright_figures(tried: &[ReachedAnchor], dimensions: usize) -> Vec<ReachedAnchor> {
    let mut is_kept = vec![false; tried.len()];
    each_subset(tried.len(), dimensions + 1, |corners| {
        if is_upright(corners.iter().map(|&at| tried[at].place)) {
            corners.iter().for_each(|&at| is_kept[at] = true);
        }
    });
    tried.iter().zip(is_kept).filter(|&(_, kept)| kept).map(|(&anchor, _)| anchor).collect()
}

/// The nearest of the `others` that form a figure which is not flat with those `tried`, all with equally many hops, and
/// the corners of these figures.
fn lifted(tried: &[ReachedAnchor], others: &[ReachedAnchor], dimensions: usize) -> Vec<ReachedAnchor> {
    let mut is_kept = vec![false; tried.len()];
    let mut lifting: Vec<ReachedAnchor> = Vec::new();
    for other in others {
        if lifting.first().is_some_and(|first| first.hops < other.hops) {
            break;
        }
        let mut lifts = false;
        each_subset(tried.len(), dimensions, |face| {
            if is_upright(face.iter().map(|&at| tried[at].place).chain([other.place])) {
                face.iter().for_each(|&at| is_kept[at] = true);
                lifts = true;
            }
        });
        lifting.extend(lifts.then_some(*other));
    }
    let corners = tried.iter().zip(is_kept).filter(|&(_, kept)| kept).map(|(&anchor, _)| anchor);
    corners.chain(lifting).collect()
}

fn is_upright(corners: impl Iterator<Item = Position>) -> bool {
    flatness(&corners.collect::<Vec<_>>()) > FLAT
}

/// Calls `take` with each subset of `size` of the numbers below `count`, in rising order.
fn each_subset(count: usize, size: usize, mut take: impl FnMut(&[usize])) {
    let mut subset: Vec<usize> = (0..size).collect();
    if size > count {
        return;
    }
    loop {
        take(&subset);
        let Some(at) = (0..size).rev().find(|&at| subset[at] < count - size + at) else { return };
        subset[at] += 1;
        for next in at + 1..size {
            subset[next] = subset[next - 1] + 1;
        }
    }
}

/// How far a triangle or a tetrahedron is from being flat: its area over the squared mean edge, its volume over the cubed
/// mean edge, each 1 for the regular one and 0 for a flat one.
fn flatness(corners: &[Position]) -> f64 {
    let pairs = corners.iter().enumerate().flat_map(|(i, a)| corners[i + 1..].iter().map(|b| a.distance_m(*b)));
    let (sum_m, count) = pairs.fold((0.0, 0.0), |(sum, count), edge_m| (sum + edge_m, count + 1.0));
    let mean_m: f64 = sum_m / count;
    let edge = |i: usize| nalgebra::Vector3::from(<[f64; 3]>::from(corners[i] - corners[0]));
    let across = edge(1).cross(&edge(2));
    let measure = match corners.len() {
        3 => across.norm() * 2.0 / (3.0_f64.sqrt() * mean_m.powi(2)),
        _ => across.dot(&edge(3)).abs() * std::f64::consts::SQRT_2 / mean_m.powi(3),
    };
    if measure.is_finite() { measure } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sextant_kernel::{Purpose, Seed};

    fn reached(places: impl IntoIterator<Item = (Position, u32)>) -> Vec<ReachedAnchor> {
        let anchors = places.into_iter().enumerate();
        let mut reached: Vec<ReachedAnchor> =
            anchors.map(|(anchor, (place, hops))| ReachedAnchor { anchor, place, hops }).collect();
        sort_nearest_first(&mut reached);
        reached
    }

    /// Anchors on a wall, all one hop away.
    fn wall() -> impl Iterator<Item = (Position, u32)> {
        (0..5).flat_map(|x| (0..4).map(move |z| (Position::new(f64::from(x), 0.0, f64::from(z)), 1)))
    }

    #[test]
    fn flatness_is_one_for_regular_and_zero_for_flat_figures() {
        let triangle = [(0.0, 0.0), (1.0, 0.0), (0.5, 0.75_f64.sqrt())].map(|(x, y)| Position::new(x, y, 0.0));
        let top = |z: f64| Position::new(0.5, 0.75_f64.sqrt() / 3.0, z);
        let tetrahedron = |z: f64| [triangle[0], triangle[1], triangle[2], top(z)];
        assert!((flatness(&triangle) - 1.0).abs() < 1e-12);
        assert!((flatness(&tetrahedron((2.0_f64 / 3.0).sqrt())) - 1.0).abs() < 1e-12);
        assert!(flatness(&tetrahedron(0.0)) < 1e-12 && flatness(&tetrahedron(0.03)) < FLAT);
        assert!(flatness(&[Position::ORIGIN; 4]) < 1e-12, "all in one point");
        let line = [0.0, 1.0, 5.0].map(|x| Position::new(x, 0.0, 0.0));
        assert!(flatness(&line) < 1e-12);
    }

    #[test]
    fn subsets_are_all_and_each_once() {
        let mut found = Vec::new();
        each_subset(5, 3, |subset| found.push(subset.to_vec()));
        let by_hand = (0..5).flat_map(|a| (a + 1..5).flat_map(move |b| (b + 1..5).map(move |c| vec![a, b, c])));
        assert_eq!(found, by_hand.collect::<Vec<_>>());
        each_subset(2, 3, |_| panic!("there is none"));
    }

    #[test]
    fn of_equally_near_anchors_those_far_from_one_another_are_tried() {
        let reached = reached(wall());
        let (tried, rest) = nearest(&reached);
        assert_eq!((tried.len(), rest.len()), (NEAREST, 8));
        // The first twelve in the order of coordinates leave out two of five columns.
        for (axis, end) in [(0, 0.0), (0, 4.0), (2, 0.0), (2, 3.0)] {
            let apart_m = |anchor: &ReachedAnchor| (<[f64; 3]>::from(anchor.place)[axis] - end).abs();
            let at_end = tried.iter().filter(|anchor| apart_m(anchor) < 1e-9).count();
            assert!(at_end >= 2, "axis {axis}, {end}: {tried:?}");
        }
        let far = reached.iter().map(|&near| ReachedAnchor { hops: 2, ..near });
        let near = [ReachedAnchor { anchor: 99, place: Position::new(2.0, 1.0, 1.0), hops: 1 }];
        let all: Vec<ReachedAnchor> = near.into_iter().chain(far).collect();
        assert_eq!(nearest(&all).0[0].anchor, 99, "nearer ones come first");
    }

    #[test]
    fn anchors_on_a_wall_are_lifted_by_the_nearest_that_are_not_on_it() {
        let beside = [(Position::new(2.0, 3.0, 1.0), 3), (Position::new(1.0, 3.0, 1.0), 3)];
        let farther = [(Position::new(2.0, 6.0, 1.0), 4), (Position::new(9.0, 0.0, 1.0), 2)];
        assert!(upright(&reached(wall()), 3).is_empty());
        let found = upright(&reached(wall().chain(beside).chain(farther)), 3);
        let off_wall: Vec<u32> = found.iter().filter(|a| a.place.y_m > 0.0).map(|a| a.hops).collect();
        assert_eq!(off_wall, [3, 3], "the nearest, and all of them");
        assert!(found.len() > 4 && found.is_sorted_by_key(|anchor| anchor.hops));
        // On one line: no single anchor makes a tetrahedron with them.
        let line = (0..20).map(|x| (Position::new(f64::from(x), 0.0, 0.0), 1));
        let corners = [(Position::new(0.0, 15.0, 0.0), 5), (Position::new(9.0, 0.0, 15.0), 5)];
        let found = upright(&reached(line.chain(corners)), 3);
        assert!(found.iter().any(|a| a.place.y_m > 1.0) && found.iter().any(|a| a.place.z_m > 1.0));
    }

    #[test]
    fn the_order_in_which_anchors_are_listed_does_not_matter() {
        let draw = |i: u64, axis| (10.0 * Seed(4).uniform(Purpose::new(8), [i, axis, 0])).floor();
        let places: Vec<(Position, u32)> =
            (0..60).map(|i| (Position::new(draw(i, 0), draw(i, 1), draw(i, 2)), 1 + (i % 3) as u32)).collect();
        let of = |places: Vec<(Position, u32)>| -> Vec<(Position, u32)> {
            upright(&reached(places), 3).into_iter().map(|anchor| (anchor.place, anchor.hops)).collect()
        };
        let reversed: Vec<(Position, u32)> = places.iter().rev().copied().collect();
        assert_eq!(of(places), of(reversed));
    }
}
