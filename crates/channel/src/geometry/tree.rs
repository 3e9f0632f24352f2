//! The broad phase: the boxes that a line meets, and the nearest box.

use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhNode};

use crate::geometry::bounds::Bounds;
use crate::geometry::glam::{aabb, position};
use crate::geometry::position::Position;
use crate::geometry::span::Span;

/// A hierarchy of the boxes of numbered objects. The order of its results depends only on the tree.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tree(Bvh);

impl Tree {
    /// The tree of the objects with these `boxes`, numbered from 0.
    pub(crate) fn new(boxes: impl IntoIterator<Item = Bounds>) -> Self {
        let boxes: Vec<_> = boxes.into_iter().map(aabb).collect();
        if boxes.is_empty() { Self::default() } else { Self(Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes)) }
    }

    /// The objects whose boxes, grown by `margin_m`, meet `span`.
    #[inline]
    pub(crate) fn along(&self, span: Span, margin_m: f64) -> impl Iterator<Item = usize> + '_ {
        self.0.leaves(move |node| span.meets(bounds(node).grown(margin_m))).map(|leaf| leaf as usize)
    }

    /// Calls `act` with each object whose box, grown by `margin_m`, meets `span`. Each caller gets a loop of its own, in which
    /// nothing is moved.
    #[inline]
    pub(crate) fn each_along(&self, span: Span, margin_m: f64, mut act: impl FnMut(usize)) {
        for leaf in self.0.leaves(move |node| span.meets(bounds(node).grown(margin_m))) {
            act(leaf as usize);
        }
    }

    /// The objects whose boxes, grown by `margin_m`, contain `p`.
    pub(crate) fn holding(&self, p: Position, margin_m: f64) -> impl Iterator<Item = usize> + '_ {
        self.0.leaves(move |node| bounds(node).grown(margin_m).contains(p)).map(|leaf| leaf as usize)
    }

    /// The objects whose boxes meet a box.
    pub(crate) fn meeting(&self, other: Bounds) -> impl Iterator<Item = usize> + '_ {
        self.0.leaves(move |node| bounds(node).meets(other)).map(|leaf| leaf as usize)
    }

    /// The smallest `distance_m` of all objects, each at least as far from `p` as its box; infinite without objects.
    pub(crate) fn nearest_m(&self, p: Position, distance_m: impl Fn(usize) -> f64) -> f64 {
        let leaf = |leaf: u32, _| Some(distance_m(leaf as usize));
        self.0
            .find_best(f64::MAX, |node, _| bounds(node).distance_m(p), leaf)
            .map_or(f64::INFINITY, |(_, least)| least)
    }
}

#[inline]
fn bounds(node: &BvhNode) -> Bounds {
    Bounds { min: position(node.mins()), max: position(node.maxs()) }
}
