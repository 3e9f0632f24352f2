//! Sector displacement: whether the sectors that a map suggests point to the neighbours (Gunathillake 2018, chapter 4).

use std::f64::consts::TAU;

use sextant_channel::{CellIndex, Position};

use super::error::MetricError;

/// How sector displacement is measured.
#[derive(Clone, Debug, PartialEq)]
pub struct SectorDisplacementRule {
    /// Sectors of equal width of a node's antenna, 2 or more.
    pub sectors: u32,
    /// Two nodes are neighbours if they are at most this far apart on the ground (m), whatever their heights are.
    pub radius_m: f64,
    /// How far apart two sectors are.
    pub distance: SectorDistance,
    /// The displacement of a node from those of its neighbours.
    pub of_node: NodeDisplacement,
}

impl SectorDisplacementRule {
    /// The rule for antennas of `sectors` sectors, with defaults for all other settings.
    #[must_use]
    pub fn new(sectors: u32) -> Self {
        Self { sectors, radius_m: 1.6, distance: SectorDistance::default(), of_node: NodeDisplacement::default() }
    }
}

/// How far apart two sectors are, given the difference D of their numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SectorDistance {
    /// `min(|D|, N − |D|)`: the fewest steps from one to the other.
    #[default]
    Circular,
    /// The formula of the thesis: |D| below N/2, otherwise `1 − |D| mod (N/2)`. Where this is negative, its magnitude
    /// counts.
    Literal,
}

/// The displacement of a node from those of its neighbours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum NodeDisplacement {
    /// The median; of two in the middle, the lower one.
    #[default]
    Median,
    /// The mean, rounded.
    RoundedMean,
}

/// How many sectors the directions of neighbours on the map are away from the true ones. Pairs are ordered: each of two
/// neighbours sees the other. Two nodes that stand on one another have no bearing, and are not compared.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SectorDisplacement {
    /// Pairs of neighbours, by displacement from 0 to half the sectors.
    pub pairs: Vec<u64>,
    /// Nodes, by displacement from 0 to half the sectors.
    pub nodes: Vec<u64>,
    /// Displacement of each node; `None` for those in neither histogram.
    pub per_node: Vec<Option<u32>>,
    /// Nodes on the map without a neighbour on the map to compare with.
    pub isolated: usize,
    /// Pairs of neighbours on the map that are not compared: one stands on the other, so that there is no true bearing.
    pub without_bearing: u64,
    /// Pairs that are compared although the map has both nodes in one place on the ground: it suggests the azimuth 0.
    pub without_bearing_on_map: u64,
    /// Nodes that are not on the map.
    pub unmapped: usize,
}

impl SectorDisplacement {
    /// Share of the nodes with each displacement, from 0 to half the sectors, over the nodes that have one. All are 0
    /// if there are no such nodes.
    #[must_use]
    pub fn shares(&self) -> Vec<f64> {
        shares(&self.nodes)
    }

    /// The same over the pairs of neighbours.
    #[must_use]
    pub fn pair_shares(&self) -> Vec<f64> {
        shares(&self.pairs)
    }

    /// Pairs of neighbours that are compared.
    #[must_use]
    pub fn compared(&self) -> u64 {
        self.pairs.iter().sum()
    }
}

fn shares(counts: &[u64]) -> Vec<f64> {
    let all: u64 = counts.iter().sum();
    #[expect(clippy::cast_precision_loss, reason = "numbers of nodes")]
    counts.iter().map(|&count| if all > 0 { count as f64 / all as f64 } else { 0.0 }).collect()
}

/// Two places that are nearer to one another on the ground have no bearing (m).
const ONE_PLACE_M: f64 = 1e-6;

/// The sector displacement of a map. A node at `truth[i]` is at `map[i]` on the map; the middle of its sector 0 points to the
/// azimuth `orientations_rad[i]` (counterclockwise from x), and the others follow counterclockwise. Only azimuths count.
/// Neighbours are those within the radius on the ground; those that stand on one another are not compared.
///
/// # Errors
/// [`MetricError::Length`], [`MetricError::Radius`], [`MetricError::Sectors`].
pub fn sector_displacement(
    truth: &[Position],
    map: &[Option<Position>],
    orientations_rad: &[f64],
    rule: &SectorDisplacementRule,
) -> Result<SectorDisplacement, MetricError> {
    for entries in [map.len(), orientations_rad.len()] {
        if entries != truth.len() {
            return Err(MetricError::Length { truth: truth.len(), map: entries });
        }
    }
    if !(rule.radius_m > 0.0 && rule.radius_m.is_finite()) {
        return Err(MetricError::Radius(rule.radius_m));
    }
    if rule.sectors < 2 {
        return Err(MetricError::Sectors(rule.sectors));
    }
    let classes = rule.sectors as usize / 2 + 1;
    let mut found = SectorDisplacement {
        pairs: vec![0; classes],
        nodes: vec![0; classes],
        per_node: vec![None; truth.len()],
        isolated: 0,
        without_bearing: 0,
        without_bearing_on_map: 0,
        unmapped: 0,
    };
    let ground: Vec<Position> = truth.iter().map(|place| Position { z_m: 0.0, ..*place }).collect();
    let index = CellIndex::new(&ground, rule.radius_m);
    let mut displacements: Vec<u32> = Vec::new();
    for (node, (&place, &orientation_rad)) in ground.iter().zip(orientations_rad).enumerate() {
        let Some(image) = map[node] else {
            found.unmapped += 1;
            continue;
        };
        displacements.clear();
        index.within(place, rule.radius_m, |other| {
            let other = other as usize;
            let Some(other_image) = map[other].filter(|_| other != node) else { return };
            if !has_bearing(ground[other] - place) {
                found.without_bearing += 1;
                return;
            }
            found.without_bearing_on_map += u64::from(!has_bearing(other_image - image));
            let actual = sector_of(ground[other] - place, orientation_rad, rule.sectors);
            let suggested = sector_of(other_image - image, orientation_rad, rule.sectors);
            displacements.push(rule.distance.of(actual.abs_diff(suggested), rule.sectors));
        });
        for &displacement in &displacements {
            found.pairs[displacement as usize] += 1;
        }
        found.per_node[node] = rule.of_node.of(&mut displacements);
        match found.per_node[node] {
            Some(displacement) => found.nodes[displacement as usize] += 1,
            None => found.isolated += 1,
        }
    }
    Ok(found)
}

/// Whether there is a direction on the ground along `apart`.
fn has_bearing(apart: Position) -> bool {
    libm::hypot(apart.x_m, apart.y_m) > ONE_PLACE_M
}

/// The sector, of `sectors` of equal width, that points along `apart`, if the middle of sector 0 points to the azimuth
/// `orientation_rad`.
#[must_use]
pub fn sector_of(apart: Position, orientation_rad: f64, sectors: u32) -> u32 {
    let width = TAU / f64::from(sectors);
    let from_first = libm::atan2(apart.y_m, apart.x_m) - orientation_rad + 0.5 * width;
    let index = crate::numerics::whole(from_first.rem_euclid(TAU) / width);
    u32::try_from(index).unwrap_or(0) % sectors
}

impl SectorDistance {
    /// The distance of two of `sectors` sectors whose numbers differ by `difference`.
    #[must_use]
    pub fn of(self, difference: u32, sectors: u32) -> u32 {
        let half = sectors / 2;
        match self {
            Self::Circular => difference.min(sectors - difference),
            Self::Literal if difference < half => difference,
            Self::Literal => (difference % half).abs_diff(1),
        }
    }
}

impl NodeDisplacement {
    /// The displacement of a node; `None` without neighbours.
    fn of(self, displacements: &mut [u32]) -> Option<u32> {
        let count = u32::try_from(displacements.len()).ok().filter(|&count| count > 0)?;
        match self {
            Self::Median => {
                displacements.sort_unstable();
                Some(displacements[(displacements.len() - 1) / 2])
            }
            Self::RoundedMean => {
                let sum: u32 = displacements.iter().sum();
                Some((2 * sum + count) / (2 * count))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sextant_kernel::{Purpose, Seed};

    /// A node in the middle of a ring of eight neighbours one metre away, at the middles of the sectors.
    fn ring(turned_by_deg: f64) -> Vec<Position> {
        let at = |i: u32| f64::from(45 * i) + turned_by_deg;
        let on_circle = |deg: f64| Position::new(deg.to_radians().cos(), deg.to_radians().sin(), 0.3);
        std::iter::once(Position::ORIGIN).chain((0..8).map(|i| on_circle(at(i)))).collect()
    }

    fn rule() -> SectorDisplacementRule {
        SectorDisplacementRule { radius_m: 1.05, ..SectorDisplacementRule::new(8) }
    }

    fn of(map: &[Position], rule: &SectorDisplacementRule) -> SectorDisplacement {
        let truth = ring(0.0);
        let map: Vec<Option<Position>> = map.iter().copied().map(Some).collect();
        // The orientation keeps directions off the edges of sectors.
        sector_displacement(&truth, &map, &[0.2; 9], rule).unwrap()
    }

    #[test]
    fn the_distance_of_sectors_goes_round_the_circle() {
        let distances = |distance: SectorDistance| (0..8).map(|d| distance.of(d, 8)).collect::<Vec<u32>>();
        assert_eq!(distances(SectorDistance::Circular), [0, 1, 2, 3, 4, 3, 2, 1]);
        // 1 − 0, 1 − 1, 1 − 2 and 1 − 3 from four sectors on.
        assert_eq!(distances(SectorDistance::Literal), [0, 1, 2, 3, 1, 0, 1, 2]);
        assert_eq!((0..5).map(|d| SectorDistance::Circular.of(d, 5)).collect::<Vec<u32>>(), [0, 1, 2, 2, 1]);
    }

    #[test]
    fn sectors_are_numbered_from_the_orientation_counterclockwise() {
        let towards = |deg: f64| Position::new(deg.to_radians().cos(), deg.to_radians().sin(), -2.0);
        for (azimuth_deg, orientation_deg, sector) in [
            (0.0, 0.0, 0),
            (22.0, 0.0, 0),
            (23.0, 0.0, 1),
            (-22.0, 0.0, 0),
            (-23.0, 0.0, 7),
            (10.0, 100.0, 6),
            (180.0, -180.0, 0),
        ] {
            let found = sector_of(towards(azimuth_deg), f64::to_radians(orientation_deg), 8);
            assert_eq!(found, sector, "{azimuth_deg} from {orientation_deg}");
        }
        // Just below the full circle, rounding must not give a ninth sector.
        assert_eq!(sector_of(Position::new(1.0, -1e-17, 0.0), std::f64::consts::PI / 8.0, 8), 0);
    }

    #[test]
    fn a_true_map_has_no_displacement_and_a_turned_one_that_of_its_angle() {
        let found = of(&ring(0.0), &rule());
        assert_eq!((found.nodes.as_slice(), found.isolated, found.unmapped), ([9, 0, 0, 0, 0].as_slice(), 0, 0));
        // The node in the middle sees its neighbours two sectors off; all pairs are turned by 90 degrees.
        let turned = of(&ring(90.0), &rule());
        assert_eq!(turned.per_node, vec![Some(2); 9]);
        assert_eq!(turned.shares(), [0.0, 0.0, 1.0, 0.0, 0.0]);
        // A mirror image across x: azimuth a becomes −a, a displacement of 0, 2, 4, 2, 0, 2, 4, 2 for the middle.
        let mirrored: Vec<Position> = ring(0.0).iter().map(|p| Position::new(p.x_m, -p.y_m, p.z_m)).collect();
        let found = of(&mirrored, &rule());
        assert_eq!(found.per_node[0], Some(2));
        assert_eq!(found.pairs.iter().sum::<u64>(), 8 + 8 + 2 * 8, "to and from the middle, and along the ring");
    }

    #[test]
    fn the_mean_rounds_where_the_median_takes_the_lower_middle() {
        let of = |rule: NodeDisplacement, values: &[u32]| rule.of(&mut values.to_vec());
        assert_eq!(of(NodeDisplacement::Median, &[3, 0, 0, 1]), Some(0));
        assert_eq!(of(NodeDisplacement::RoundedMean, &[3, 0, 0, 1]), Some(1));
        assert_eq!(of(NodeDisplacement::RoundedMean, &[0, 1]), Some(1), "a half rounds up");
        assert_eq!(of(NodeDisplacement::RoundedMean, &[0, 0, 1]), Some(0));
        assert_eq!(of(NodeDisplacement::Median, &[]), None);
    }

    /// A full scan over all pairs, with the difference of azimuths instead of sectors.
    fn shares_by_hand(truth: &[Position], map: &[Position], radius_m: f64, sectors: u32) -> (Vec<u64>, u64) {
        let (mut pairs, mut upright) = (vec![0; sectors as usize / 2 + 1], 0);
        for (i, j) in (0..truth.len()).flat_map(|i| (0..truth.len()).map(move |j| (i, j))).filter(|(i, j)| i != j) {
            let [dx, dy] = [truth[j].x_m - truth[i].x_m, truth[j].y_m - truth[i].y_m];
            if dx * dx + dy * dy > radius_m * radius_m {
                continue;
            } else if dx == 0.0 && dy == 0.0 {
                upright += 1;
                continue;
            }
            let [ex, ey] = [map[j].x_m - map[i].x_m, map[j].y_m - map[i].y_m];
            let index = |y: f64, x: f64| (y.atan2(x).to_degrees() / (360.0 / f64::from(sectors))).round();
            let apart = (index(dy, dx) - index(ey, ex)).rem_euclid(f64::from(sectors));
            let steps = apart.min(f64::from(sectors) - apart);
            let class = (0..pairs.len()).find(|&k| (steps - k as f64).abs() < 0.5).unwrap();
            pairs[class] += 1;
        }
        (pairs, upright)
    }

    #[test]
    fn neighbours_are_those_on_the_ground_and_nodes_that_stand_on_one_another_are_not_compared() {
        // Columns of three nodes at heights of 0, 1.5 and 3 m; those of neighbours are 1.5 m apart on the ground.
        let columns = (0..4).flat_map(|i| (0..3).map(move |j| (f64::from(i) * 1.5, f64::from(j) * 1.5)));
        let truth: Vec<Position> =
            columns.flat_map(|(x, y)| [0.0, 1.5, 3.0].map(|z| Position::new(x, y, z))).collect();
        let draw = |i: usize, axis| Seed(5).normal(Purpose::new(8), [i as u64, axis, 0]);
        let map: Vec<Position> = truth
            .iter()
            .enumerate()
            .map(|(i, &place)| place + Position::new(0.4 * draw(i, 0), 0.4 * draw(i, 1), 0.4 * draw(i, 2)))
            .collect();
        let images: Vec<Option<Position>> = map.iter().copied().map(Some).collect();
        let rule = SectorDisplacementRule::new(8);
        let found = sector_displacement(&truth, &images, &vec![0.0; truth.len()], &rule).unwrap();
        assert_eq!((found.pairs.clone(), found.without_bearing), shares_by_hand(&truth, &map, 1.6, 8));
        // 17 pairs of adjacent columns with nine pairs of nodes each, and three pairs in each of 12 columns, both ways.
        assert_eq!((found.compared(), found.without_bearing), (2 * 17 * 9, 2 * 3 * 12));
        assert_eq!((found.isolated, found.without_bearing_on_map), (0, 0));
    }

    #[test]
    fn a_map_that_stacks_two_nodes_is_compared_and_counted() {
        let truth = [0.0, 1.0].map(|x| Position::new(x, 0.0, 0.0));
        let map = [0.0, 2.0].map(|z| Some(Position::new(5.0, 5.0, z)));
        let found = sector_displacement(&truth, &map, &[0.0; 2], &SectorDisplacementRule::new(8)).unwrap();
        assert_eq!((found.without_bearing_on_map, found.without_bearing), (2, 0));
        assert_eq!(found.pairs, [1, 0, 0, 0, 1], "the azimuth 0 is right for one of the two");
        // Only the true bearing decides whether a pair is compared.
        let upright = [0.0, 1.0].map(|z| Position::new(0.0, 0.0, z));
        let found = sector_displacement(&upright, &map, &[0.0; 2], &SectorDisplacementRule::new(8)).unwrap();
        assert_eq!((found.without_bearing, found.compared(), found.isolated), (2, 0, 2));
    }

    #[test]
    fn nodes_without_a_place_or_without_neighbours_are_counted_apart() {
        let mut truth = ring(0.0);
        truth.push(Position::new(50.0, 0.0, 0.0));
        let mut map: Vec<Option<Position>> = truth.iter().copied().map(Some).collect();
        map[0] = None;
        let found = sector_displacement(&truth, &map, &[1.0; 10], &rule()).unwrap();
        assert_eq!((found.unmapped, found.isolated, found.nodes[0]), (1, 1, 8));
        assert_eq!((found.per_node[0], found.per_node[9]), (None, None));
        let error = |rule: &SectorDisplacementRule, orientations: &[f64]| {
            sector_displacement(&truth, &map, orientations, rule).unwrap_err()
        };
        assert_eq!(error(&rule(), &[0.0; 3]), MetricError::Length { truth: 10, map: 3 });
        assert_eq!(error(&SectorDisplacementRule { sectors: 1, ..rule() }, &[0.0; 10]), MetricError::Sectors(1));
        let flat = SectorDisplacementRule { radius_m: 0.0, ..rule() };
        assert_eq!(error(&flat, &[0.0; 10]), MetricError::Radius(0.0));
    }
}
