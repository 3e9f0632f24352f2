//! How much memory tiles need, and how much there is.

use super::census::Census;

/// Octets of memory for each stop: in the log, in the index of the search, and while that is made.
const PER_STOP: u64 = 130;
/// Octets for each node: its name, its counts, its tile, its estimate with a covariance, and its row of the map.
const PER_NODE: u64 = 620;
/// Octets for each node of a tile: its name and its estimate once more.
const PER_NODE_OF_TILE: u64 = 320;
/// Octets that the program needs for anything: code, tables, a chunk of the log.
const ANYTHING: u64 = 60_000_000;

/// Memory for a log in tiles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Budget {
    /// Memory that does not depend on the tiles (octets).
    pub(super) fixed_bytes: u64,
    /// Memory for each reception of the largest tile (octets).
    per_reception: u64,
    receptions: u64,
    nodes: u64,
}

impl Budget {
    pub(super) fn of(census: &Census, stops: usize, nodes: usize) -> Self {
        let (stops, nodes) = (stops as u64, nodes as u64);
        // The log of a tile, the node of each reception, and one column twice while receptions are sorted.
        let per_reception = census.columns.bytes() + 4 + census.columns.widest();
        let fixed_bytes = ANYTHING + PER_STOP * stops + PER_NODE * nodes;
        Self { fixed_bytes, per_reception, receptions: census.receptions(), nodes }
    }

    /// Memory for the largest of so many tiles, about (octets).
    pub(super) fn tile_bytes(&self, tiles: usize) -> u64 {
        let tiles = tiles as u64;
        self.of_tile(self.receptions.div_ceil(tiles), self.nodes.div_ceil(tiles))
    }

    /// Memory for a tile of so many receptions and nodes (octets).
    pub(super) fn of_tile(&self, receptions: u64, nodes: u64) -> u64 {
        self.per_reception * receptions + PER_NODE_OF_TILE * nodes
    }

    /// The least number of tiles that fit into so much memory; `None` if no number does.
    pub(super) fn least_tiles(&self, free_bytes: u64) -> Option<usize> {
        let room = free_bytes.checked_sub(self.fixed_bytes).filter(|&room| room > 0)?;
        usize::try_from(self.of_tile(self.receptions, self.nodes).div_ceil(room).max(1)).ok()
    }
}

/// Memory that other programs leave free (octets): what the system says, and what the group of processes may still use.
/// `None` if the system does not say.
pub(super) fn free_bytes() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    let of_group = |file: &str| -> Option<u64> {
        std::fs::read_to_string(format!("/sys/fs/cgroup/{file}")).ok()?.trim().parse().ok()
    };
    let left = of_group("memory.max").map(|most| most.saturating_sub(of_group("memory.current").unwrap_or(0)));
    Some((kibibytes * 1024).min(left.unwrap_or(u64::MAX)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_tiles_need_less_memory_down_to_what_is_fixed() {
        let budget = Budget { fixed_bytes: 1000, per_reception: 10, receptions: 1_000_000, nodes: 1000 };
        for tiles in [1, 3, 64] {
            let bytes = budget.fixed_bytes + budget.tile_bytes(tiles);
            assert_eq!(budget.least_tiles(bytes + 1000), Some(tiles), "{bytes}");
        }
        assert_eq!(budget.least_tiles(1000), None);
        assert_eq!(budget.least_tiles(u64::MAX), Some(1));
    }
}
