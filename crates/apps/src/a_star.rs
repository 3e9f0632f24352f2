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
    let Reached { cost, before, goal } = reach(graph, start);
    let vertex = goal?;
    let step_back = |&vertex: &usize| Some(before[vertex]).filter(|&vertex| vertex != usize::MAX);
    let mut vertices: Vec<_> = std::iter::successors(Some(vertex), step_back).collect();
    vertices.reverse();
    Some(Path { vertices, cost: cost[vertex] })
}

/// The least cost from `start` to each vertex of a graph without goals; `None` where there is no path.
pub(crate) fn costs(graph: &impl Graph, start: usize) -> Vec<Option<u64>> {
    reach(graph, start).cost.into_iter().map(|cost| Some(cost).filter(|&cost| cost != UNKNOWN)).collect()
}

/// What a search reached.
struct Reached {
    /// The least cost of each vertex that was visited.
    cost: Vec<u64>,
    /// The vertex before each of them.
    before: Vec<usize>,
    /// The goal that was found first.
    goal: Option<usize>,
}

fn reach(graph: &impl Graph, start: usize) -> Reached {
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
            return Reached { cost, before, goal: Some(vertex) };
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
    Reached { cost, before, goal: None }
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
        self.moves(vertex).map(|(_, neighbour, step)| (neighbour, step))
    }

    /// The same, with the number of the direction of each, 0 to 7.
    pub(crate) fn moves(self, vertex: usize) -> impl Iterator<Item = (u8, usize, u64)> {
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
        (0..).zip(MOVES).filter_map(move |(direction, (east, north, step))| {
            let column = column.checked_add_signed(east).filter(|&column| column < self.columns)?;
            let row = row.checked_add_signed(north).filter(|&row| row < self.rows)?;
            Some((direction, row * self.columns + column, step))
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
