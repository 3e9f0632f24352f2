//! Which node belongs to which tile.

use sextant_kernel::NodeId;

use super::budget::Budget;
use super::census::{Census, NodeCounts};
use super::tile_count::TileCount;
use crate::mapping::TilesError;

/// The tile of each node. Tiles are rectangles with about the same number of receptions: the plane is cut across its longer
/// side so that the two parts have receptions in proportion to their tiles, and each part again.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Plan {
    /// The nodes of each tile, in ascending order.
    pub(super) tiles: Vec<Vec<NodeId>>,
    /// Receptions of the largest tile.
    pub(super) most_receptions: u64,
    /// Nodes of the largest tile.
    pub(super) most_nodes: u64,
}

/// A node that is given to a tile.
#[derive(Clone, Copy, Debug)]
struct Placed {
    node: NodeId,
    middle: [f64; 2],
    receptions: u64,
}

impl Plan {
    /// The tiles of the nodes that the log lists; there is at least one tile.
    pub(super) fn new(census: &Census, tiles: usize) -> Self {
        let placed = |(node, counts): (NodeId, &NodeCounts)| Placed {
            node,
            middle: counts.middle(),
            receptions: u64::from(counts.listed),
        };
        let mut nodes: Vec<Placed> = census.listed().map(placed).collect();
        let mut plan = Self { tiles: Vec::with_capacity(tiles), most_receptions: 0, most_nodes: 0 };
        plan.divide(&mut nodes, tiles);
        plan
    }

    fn divide(&mut self, nodes: &mut [Placed], tiles: usize) {
        if tiles <= 1 {
            let mut of_tile: Vec<NodeId> = nodes.iter().map(|placed| placed.node).collect();
            of_tile.sort_unstable();
            self.most_receptions = self.most_receptions.max(nodes.iter().map(|placed| placed.receptions).sum());
            self.most_nodes = self.most_nodes.max(of_tile.len() as u64);
            self.tiles.push(of_tile);
            return;
        }
        let [width_m, height_m] = sides_m(nodes.iter().map(|placed| placed.middle));
        let axis = usize::from(height_m > width_m);
        nodes.sort_unstable_by(|a, b| a.middle[axis].total_cmp(&b.middle[axis]).then(a.node.cmp(&b.node)));
        let first = tiles / 2;
        let all: u64 = nodes.iter().map(|placed| placed.receptions).sum();
        let wanted = u128::from(all) * first as u128 / tiles as u128;
        let mut before = 0_u128;
        let cut = nodes.iter().position(|placed| {
            before += u128::from(placed.receptions);
            before > wanted
        });
        let (low, high) = nodes.split_at_mut(cut.unwrap_or(0));
        self.divide(low, first);
        self.divide(high, tiles - first);
    }
}

/// Width and height of the rectangle that holds these places (m); 0 without any.
fn sides_m(places: impl Iterator<Item = [f64; 2]>) -> [f64; 2] {
    let corners = places.fold([[f64::INFINITY, f64::NEG_INFINITY]; 2], |corners, place| {
        [0, 1].map(|axis| [corners[axis][0].min(place[axis]), corners[axis][1].max(place[axis])])
    });
    corners.map(|[low, high]| (high - low).max(0.0))
}

/// The most tiles that are at least as wide as the reach, how wide so many `tiles` are (m), and the reach (m).
fn most_tiles(census: &Census, tiles: usize) -> (usize, f64, f64) {
    let [width_m, height_m] = sides_m(census.listed().flat_map(|(_, counts)| counts.corners()));
    let reach_m = census.reach_m();
    #[expect(clippy::cast_precision_loss, reason = "numbers for people")]
    let side_m = if width_m.min(height_m) > reach_m {
        (width_m * height_m / tiles as f64).sqrt()
    } else {
        width_m.max(height_m) / tiles as f64
    };
    if reach_m <= 0.0 {
        return (usize::MAX, side_m, reach_m);
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small number, not negative")]
    let along = |side_m: f64| ((side_m / reach_m) as usize).max(1);
    (along(width_m).saturating_mul(along(height_m)), side_m, reach_m)
}

/// The number of tiles for a log of so many stops and nodes.
///
/// # Errors
/// If the tiles are smaller than the reach, or the memory is too small for them.
pub(super) fn tiles(
    count: TileCount,
    census: &Census,
    [stops, nodes]: [usize; 2],
    free_bytes: Option<u64>,
) -> Result<usize, TilesError> {
    let budget = Budget::of(census, stops, nodes);
    let free_bytes = match count {
        TileCount::Auto(Some(megabytes)) => Some(megabytes.get() as u64 * 1_000_000),
        // Half of what is free is left to the cache of files and to other programs.
        TileCount::Auto(None) => free_bytes.map(|free| free / 2),
        TileCount::Exactly(_) => free_bytes,
    };
    let tiles = match (count, free_bytes) {
        (TileCount::Exactly(tiles), _) => tiles.get(),
        (TileCount::Auto(_), Some(free)) => budget.least_tiles(free).unwrap_or(usize::MAX),
        (TileCount::Auto(_), None) => 1,
    };
    let (most, side_m, reach_m) = most_tiles(census, tiles);
    if let TileCount::Exactly(_) = count
        && tiles > most
    {
        return Err(TilesError::Small { tiles, side_m, reach_m, most });
    }
    let tiles = tiles.min(most.max(1));
    let tile_bytes = budget.tile_bytes(tiles);
    match free_bytes {
        Some(free_bytes) if budget.fixed_bytes.saturating_add(tile_bytes) > free_bytes => {
            let remedy = match budget.least_tiles(free_bytes).filter(|&tiles| tiles <= most) {
                Some(tiles) => format!("{tiles} tiles fit"),
                None => "no number of tiles fits".to_owned(),
            };
            let fixed_bytes = budget.fixed_bytes;
            Err(TilesError::Memory { tiles, fixed_bytes, stops, nodes, tile_bytes, free_bytes, remedy })
        }
        _ => Ok(tiles),
    }
}

#[cfg(test)]
mod tests {
    use std::num::NonZeroUsize;

    use sextant_channel::{Position, Reception};

    use super::*;

    /// Nodes 10 m apart in `columns` columns and `rows` rows, each heard at four places up to 8 m away.
    fn census(columns: u32, rows: u32) -> Census {
        let mut census = Census::default();
        for node in 0..columns * rows {
            for (dx, dy) in [(-8.0, 0.0), (8.0, 0.0), (0.0, -8.0), (0.0, 8.0)] {
                let (x_m, y_m) = (f64::from(node % columns) * 10.0 + dx, f64::from(node / columns) * 10.0 + dy);
                let node = NodeId(node);
                let reception = Reception::heard(node, 0, 1, 1);
                census.count(&reception, Position::new(x_m, y_m, 0.0));
            }
        }
        census
    }

    fn exactly(tiles: usize) -> TileCount {
        TileCount::Exactly(NonZeroUsize::new(tiles).expect("above zero"))
    }

    #[test]
    fn each_node_is_in_one_tile_and_tiles_have_about_as_many_receptions() {
        let census = census(30, 20);
        for tiles in [1, 2, 5, 9, 16] {
            let plan = Plan::new(&census, tiles);
            assert_eq!(plan.tiles.len(), tiles);
            let mut all: Vec<NodeId> = plan.tiles.concat();
            assert!(plan.tiles.iter().all(|of_tile| of_tile.is_sorted()));
            all.sort_unstable();
            assert_eq!(all, (0..600).map(NodeId).collect::<Vec<_>>());
            let fair = 2400 / tiles as u64;
            assert!(plan.most_receptions >= fair && plan.most_receptions <= fair + 40, "{}", plan.most_receptions);
            assert_eq!(plan.most_nodes * 4, plan.most_receptions);
        }
        // Tiles are rectangles: the first quarter is the lower left.
        let corner = &Plan::new(&census, 4).tiles[0];
        assert!(corner.iter().all(|node| node.0 % 30 < 15 && node.0 / 30 < 10), "{corner:?}");
    }

    #[test]
    fn a_log_of_which_nothing_is_listed_has_empty_tiles() {
        let plan = Plan::new(&Census::default(), 3);
        assert_eq!((plan.tiles.len(), plan.most_nodes), (3, 0));
    }

    #[test]
    fn tiles_smaller_than_the_reach_are_refused_with_the_least_size() {
        let census = census(30, 20);
        // The stops span 306 m by 206 m, and the reach is 8 m.
        let refused = tiles(exactly(1000), &census, [1, 600], None).expect_err("they are too small").to_string();
        assert!(refused.contains("1000 tiles are about 7.9 m wide, less than the reach of 8.0 m"), "{refused}");
        assert!(refused.contains("allowed: 1 to 950 tiles, at least 8.0 m wide"), "{refused}");
        assert_eq!(tiles(exactly(950), &census, [1, 600], None), Ok(950));
    }

    #[test]
    fn memory_that_is_too_small_is_refused_with_the_estimate() {
        let census = census(30, 20);
        let stops = 1_000_000;
        let refused = tiles(exactly(2), &census, [stops, 600], Some(100_000_000)).expect_err("it is too small");
        let text = refused.to_string();
        assert!(
            text.contains("2 tiles need about 191 MB of memory: 191 MB for 1000000 stops and 600 nodes"),
            "{text}"
        );
        assert!(text.contains("free: 100 MB; no number of tiles fits"), "{text}");
        assert_eq!(tiles(exactly(2), &census, [stops, 600], Some(300_000_000)), Ok(2));
        let megabytes = |count| TileCount::Auto(NonZeroUsize::new(count));
        assert_eq!(tiles(megabytes(191), &census, [stops, 600], None), Ok(1));
        assert!(tiles(megabytes(190), &census, [stops, 600], None).is_err());
        assert_eq!(tiles(TileCount::Auto(None), &census, [1000, 600], Some(200_000_000)), Ok(1));
        assert_eq!(tiles(TileCount::Auto(None), &census, [1000, 600], None), Ok(1));
    }
}
