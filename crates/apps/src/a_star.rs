//! Shortest paths by A* (Hart, Nilsson and Raphael 1968), and lattices on which each vertex has eight neighbours.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Cost of a step of a lattice.
pub(crate) const STEP: u64 = 1_000_000;
/// Cost of a diagonal step, √2 steps.
pub(crate) const DIAGONAL: u64 = 1_414_214;
/// The cost of a vertex to which no way is known.
const UNKNOWN: u64 = u64::MAX;

/// Where a path is searched.
pub(crate) trait Graph {
    /// Number of vertices.
    fn vertices(&self) -> usize;
    /// The neighbours of a vertex, and the cost of going there.
    fn neighbours(&self, vertex: usize) -> impl Iterator<Item = (usize, u64)>;
    /// Whether one can go to a neighbour.
    fn is_passable(&self, from: usize, to: usize) -> bool;
    /// A lower bound of the cost from a vertex to the nearest goal.
    fn least_cost(&self, vertex: usize) -> u64;
    /// Whether the path may end here.
    fn is_goal(&self, vertex: usize) -> bool;
}

/// A path from vertex to vertex.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Path {
    /// The vertices, from the start to the goal.
    pub(crate) vertices: Vec<usize>,
    /// What it costs.
    pub(crate) cost: u64,
}

/// A path of least cost from `start` to a goal; `None` if there is no path. Among vertices of equal cost, the one with
/// the lower number is visited first.
pub(crate) fn shortest(graph: &impl Graph, start: usize) -> Option<Path> {
    let mut cost = vec![UNKNOWN; graph.vertices()];
    let mut before = vec![usize::MAX; cost.len()];
    let mut open = BinaryHeap::new();
    cost[start] = 0;
    open.push(Reverse((graph.least_cost(start), 0, start)));
    while let Some(Reverse((_, spent, vertex))) = open.pop() {
        if spent > cost[vertex] {
            continue;
        }
        if graph.is_goal(vertex) {
            let step_back = |&vertex: &usize| Some(before[vertex]).filter(|&vertex| vertex != usize::MAX);
            let mut vertices: Vec<_> = std::iter::successors(Some(vertex), step_back).collect();
            vertices.reverse();
            return Some(Path { vertices, cost: spent });
        }
        for (neighbour, step) in graph.neighbours(vertex) {
            let total = spent + step;
            if total < cost[neighbour] && graph.is_passable(vertex, neighbour) {
                cost[neighbour] = total;
                before[neighbour] = vertex;
                open.push(Reverse((total + graph.least_cost(neighbour), total, neighbour)));
            }
        }
    }
    None
}

/// The vertices of a square lattice, numbered row by row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SquareLattice {
    pub(crate) columns: usize,
    pub(crate) rows: usize,
}

impl SquareLattice {
    /// The up to eight neighbours of a vertex, and the costs of the steps.
    pub(crate) fn neighbours(self, vertex: usize) -> impl Iterator<Item = (usize, u64)> {
        const MOVES: [(isize, isize, u64); 8] = [
            (1, 0, STEP),
            (0, 1, STEP),
            (-1, 0, STEP),
            (0, -1, STEP),
            (1, 1, DIAGONAL),
            (-1, 1, DIAGONAL),
            (-1, -1, DIAGONAL),
            (1, -1, DIAGONAL),
        ];
        let (column, row) = self.column_and_row(vertex);
        MOVES.into_iter().filter_map(move |(east, north, step)| {
            let column = column.checked_add_signed(east).filter(|&column| column < self.columns)?;
            let row = row.checked_add_signed(north).filter(|&row| row < self.rows)?;
            Some((row * self.columns + column, step))
        })
    }

    /// Column and row of a vertex.
    pub(crate) fn column_and_row(self, vertex: usize) -> (usize, usize) {
        (vertex % self.columns, vertex / self.columns)
    }

    /// Number of vertices.
    pub(crate) fn vertices(self) -> usize {
        self.columns * self.rows
    }
}
