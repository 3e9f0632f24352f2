//! Anchors where they tell most about the places of all nodes.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;
use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};
use sextant_channel::{ObstacleField, Position};
use sextant_kernel::SettingError;

use crate::world::choice::{at_most, number_of};
use crate::world::layout::PlacedNode;

/// A tool for planning a deployment: it chooses the nodes that become anchors from the planned places of all nodes and
/// from the obstacles. What runs in the nodes later knows neither.
///
/// The design is D-optimal: it maximises the logarithm of the determinant of the information on each node, summed over all
/// nodes. A node has four unknowns, its place and the azimuth of its antenna, as nodes that know their places become anchors
/// themselves (and as anchors do not know their azimuth either). An anchor at the distance d in the direction u, of which
/// obstacles absorb less than 3 dB, adds `S [l lᵀ/(ρ σ_φ)² + u uᵀ/σ_r²]` on the place and `S/σ_φ²` on the azimuth, with ρ the
/// horizontal distance, l the horizontal direction across u, `σ_φ = HBW/√12` (an azimuth that is uniform in a sector,
/// `HBW = 360°/sectors`), `σ_r = range_m/√12`, and `S = 1 − d/range_m` how likely it is heard. Horizontal distances below a
/// tenth of the range count as a tenth. One ring of sectors tells nothing about the elevation, so heights become known
/// from anchors above and below. Beforehand a place has the standard deviation `range_m` along each axis, and an azimuth is
/// uniform on the circle.
///
/// The sum is submodular: an anchor adds the less, the more there are. The greedy choice is therefore within `1 − 1/e` of
/// the best one (Nemhauser, Wolsey and Fisher 1978), and the lazy evaluation of Minoux (1978) finds it. Of anchors that
/// add the same, the first node is taken.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct OptimisedAnchorsConfig {
    /// Share of the nodes, rounded up: 0 to 1. Either this or `count`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub share: Option<f64>,
    /// Number of anchors. Either this or `share`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub count: Option<usize>,
    /// Distance beyond which a node does not hear an anchor (m).
    pub range_m: f64,
    /// Number of antenna sectors of a node round the circle, 1 or more.
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 255)))]
    pub sectors: u8,
}

/// Loss in obstacles at which a link counts as blocked (dB).
const BLOCKED_DB: f64 = 3.0;
/// Distances below this share of the range count as this share.
const NEAREST: f64 = 0.1;

impl OptimisedAnchorsConfig {
    /// The indices of the anchors, in the order of the choice.
    pub(super) fn choose(&self, nodes: &[PlacedNode], obstacles: &ObstacleField) -> Result<Vec<usize>, SettingError> {
        let count = match (self.share, self.count) {
            (Some(share), None) => number_of(share, nodes.len())?,
            (None, Some(count)) => at_most(count, nodes.len())?,
            (Some(_), Some(_)) => return Err(SettingError::conflict("share", "`count`", "set one of them")),
            (None, None) => return Err(SettingError::missing("share", "`share` or `count`")),
        };
        SettingError::positive("range_m", self.range_m)?;
        if self.sectors == 0 {
            return Err(SettingError::new("sectors", 0, "1 to 255"));
        }
        Ok(self.design(nodes, obstacles).greedy(count))
    }

    fn design(&self, nodes: &[PlacedNode], obstacles: &ObstacleField) -> Design {
        let places: Vec<Position> = nodes.iter().map(|node| node.position).collect();
        let mut reached: Vec<Vec<Gift>> =
            (0..nodes.len()).map(|node| vec![self.gift(node, Position::ORIGIN)]).collect();
        let mut by_x: Vec<usize> = (0..nodes.len()).collect();
        by_x.sort_by(|&a, &b| places[a].x_m.total_cmp(&places[b].x_m));
        for (i, &a) in by_x.iter().enumerate() {
            for &b in by_x[i + 1..].iter().take_while(|&&b| places[b].x_m - places[a].x_m < self.range_m) {
                let apart = places[b] - places[a];
                if apart.length_m() < self.range_m && obstacles.loss(places[a], places[b]).0 < BLOCKED_DB {
                    reached[a].push(self.gift(b, apart));
                    reached[b].push(self.gift(a, apart));
                }
            }
        }
        let prior = 1.0 / (self.range_m * self.range_m);
        let unknown = Knowledge { place: [prior, prior, prior, 0.0, 0.0, 0.0], azimuth: 12.0 / (TAU * TAU) };
        Design { reached, known: vec![unknown; nodes.len()] }
    }

    /// What an anchor tells the node at `apart` from it. Itself it knows as well as one that is nearest, from all sides,
    /// but its azimuth it learns from others only.
    fn gift(&self, node: usize, apart: Position) -> Gift {
        let sigma = TAU / f64::from(self.sectors) / 12.0_f64.sqrt();
        let distance_m = apart.length_m();
        let least_m = NEAREST * self.range_m;
        let heard = 1.0 - distance_m / self.range_m;
        let along = heard * 12.0 / (self.range_m * self.range_m);
        let across = |across_m: f64| heard / (across_m.max(least_m) * sigma).powi(2);
        if distance_m <= 0.0 {
            let all = across(0.0);
            return Gift { node, told: Knowledge { place: [all, all, all, 0.0, 0.0, 0.0], azimuth: 0.0 } };
        }
        let [x, y, z] = <[f64; 3]>::from(apart).map(|component| component / distance_m);
        let level_m = libm::hypot(apart.x_m, apart.y_m);
        let [left_x, left_y] = if level_m > 0.0 { [-apart.y_m / level_m, apart.x_m / level_m] } else { [0.0, 0.0] };
        let across = across(level_m);
        let place = [
            along * x * x + across * left_x * left_x,
            along * y * y + across * left_y * left_y,
            along * z * z,
            along * x * y + across * left_x * left_y,
            along * x * z,
            along * y * z,
        ];
        Gift { node, told: Knowledge { place, azimuth: heard / (sigma * sigma) } }
    }
}

/// Information on a node.
#[derive(Clone, Copy, Debug)]
struct Knowledge {
    /// On its place (1/m²): xx, yy, zz, xy, xz, yz.
    place: [f64; 6],
    /// On the azimuth of its antenna (1/rad²).
    azimuth: f64,
}

impl Knowledge {
    fn with(mut self, more: &Self) -> Self {
        for (sum, term) in self.place.iter_mut().zip(more.place) {
            *sum += term;
        }
        self.azimuth += more.azimuth;
        self
    }

    /// Logarithm of the determinant.
    fn ln_determinant(&self) -> f64 {
        let [xx, yy, zz, xy, xz, yz] = self.place;
        let place = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
        libm::log(place * self.azimuth)
    }
}

/// What an anchor tells a node.
#[derive(Clone, Copy, Debug)]
struct Gift {
    node: usize,
    told: Knowledge,
}

/// The state of a choice.
#[derive(Clone, Debug)]
struct Design {
    /// By the node that may become an anchor, what it tells others and itself.
    reached: Vec<Vec<Gift>>,
    /// By node, what the anchors so far tell.
    known: Vec<Knowledge>,
}

impl Design {
    /// What the objective gains by an anchor.
    fn gain(&self, anchor: usize) -> f64 {
        let of = |gift: &Gift| {
            let known = &self.known[gift.node];
            known.with(&gift.told).ln_determinant() - known.ln_determinant()
        };
        self.reached[anchor].iter().map(of).sum()
    }

    fn take(&mut self, anchor: usize) {
        for gift in &self.reached[anchor] {
            self.known[gift.node] = self.known[gift.node].with(&gift.told);
        }
    }

    /// The anchors, each the one that gains most. Gains only fall, so that an old one bounds that of today.
    fn greedy(mut self, count: usize) -> Vec<usize> {
        let mut candidates: BinaryHeap<Candidate> =
            (0..self.reached.len()).map(|node| Candidate { gain: self.gain(node), node, anchors: 0 }).collect();
        let mut chosen = Vec::with_capacity(count);
        while chosen.len() < count
            && let Some(best) = candidates.pop()
        {
            if best.anchors == chosen.len() {
                self.take(best.node);
                chosen.push(best.node);
            } else {
                candidates.push(Candidate { gain: self.gain(best.node), anchors: chosen.len(), ..best });
            }
        }
        chosen
    }
}

/// A node that may become an anchor.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    /// What it gained when there were `anchors`.
    gain: f64,
    node: usize,
    anchors: usize,
}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        self.gain.total_cmp(&other.gain).then(Reverse(self.node).cmp(&Reverse(other.node)))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Candidate {}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use sextant_channel::{Obstacle, ObstacleConfig};
    use sextant_kernel::Seed;

    use super::*;
    use crate::purpose;

    fn nodes(places: impl IntoIterator<Item = [f64; 3]>) -> Vec<PlacedNode> {
        let node = |(i, place): (usize, [f64; 3])| PlacedNode { name: format!("n{i}"), position: place.into() };
        places.into_iter().enumerate().map(node).collect()
    }

    fn config(count: usize) -> OptimisedAnchorsConfig {
        OptimisedAnchorsConfig { share: None, count: Some(count), range_m: 7.0, sectors: 8 }
    }

    /// 881 nodes in a room of 30 m by 20 m by 3 m.
    fn warehouse() -> Vec<PlacedNode> {
        let room_m = [30.0, 20.0, 3.0];
        nodes((0..881).map(|i| {
            let draw = |axis: u64| Seed(3).uniform(purpose::ANCHORS, [i, axis, 5]);
            [draw(0) * room_m[0], draw(1) * room_m[1], draw(2) * room_m[2]]
        }))
    }

    fn wall(x_m: f64) -> ObstacleField {
        let config: ObstacleConfig = toml::from_str(&format!(
            "shape.box = {{ center_m = [{x_m}, 0.0, 0.0], size_m = [0.2, 100.0, 100.0] }}\nloss_db = 20.0\n"
        ))
        .unwrap();
        ObstacleField::new(vec![
            Obstacle::read(config, &sextant_kernel::Files::of_folder(std::path::Path::new("."))).unwrap(),
        ])
    }

    #[test]
    fn anchors_on_a_line_are_evenly_spread() {
        let line = nodes((0..61).map(|i| [f64::from(i), 0.0, 0.0]));
        let mut chosen = config(10).choose(&line, &ObstacleField::default()).unwrap();
        chosen.sort_unstable();
        let gaps: Vec<usize> = chosen.windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert!(gaps.iter().all(|gap| (3..=9).contains(gap)), "{chosen:?}");
        assert!(chosen[0] <= 6 && chosen[9] >= 54, "{chosen:?}");
        // Each hears another, from which it learns its azimuth.
        for &anchor in &chosen {
            assert!(chosen.iter().any(|&other| other != anchor && other.abs_diff(anchor) < 7), "{chosen:?}");
        }
    }

    #[test]
    fn both_rooms_have_anchors() {
        // 40 nodes to the left, 10 to the right, all within the range of each other.
        let places = (0..50).map(|i| {
            let x = if i < 40 { -2.0 } else { 2.0 };
            [x + 0.3 * f64::from(i % 5), 0.5 * f64::from(i / 5) - 2.0, 0.0]
        });
        let rooms = nodes(places);
        let right = |obstacles: &ObstacleField, count| {
            let chosen = config(count).choose(&rooms, obstacles).unwrap();
            chosen.iter().filter(|&&node| node >= 40).count()
        };
        assert!((1..4).contains(&right(&wall(0.2), 4)));
        // The wall is what makes it so: the first anchor is of the larger room and tells nothing to the other.
        assert_eq!(right(&wall(0.2), 1), 0);
        let design = |obstacles: &ObstacleField| {
            let mut design = config(1).design(&rooms, obstacles);
            let before = design.gain(45);
            design.take(20);
            before - design.gain(45)
        };
        assert!(design(&wall(0.2)).abs() < 1e-9);
        assert!(design(&ObstacleField::default()) > 1.0);
    }

    #[test]
    fn anchors_of_a_large_network_hear_each_other_and_tell_more_than_random_ones() {
        let nodes = warehouse();
        let field = ObstacleField::default();
        let share = OptimisedAnchorsConfig { share: Some(0.15), count: None, ..config(0) };
        let chosen = share.choose(&nodes, &field).unwrap();
        assert_eq!(chosen.len(), 133);
        assert_eq!(chosen, share.choose(&nodes, &field).unwrap());
        let place = |node: usize| nodes[node].position;
        let heard = |anchor: usize| {
            chosen.iter().filter(|&&other| other != anchor && place(other).distance_m(place(anchor)) < 7.0).count()
        };
        assert!(chosen.iter().all(|&anchor| heard(anchor) >= 3));
        let value = |chosen: &[usize]| {
            let mut design = share.design(&nodes, &field);
            chosen.iter().for_each(|&node| design.take(node));
            design.known.iter().map(Knowledge::ln_determinant).sum::<f64>()
        };
        // The nodes lie at random, so every sixth is a random choice.
        let random: Vec<usize> = (0..nodes.len()).step_by(6).take(133).collect();
        let (best, other) = (value(&chosen), value(&random));
        eprintln!("objective: {best:.0} chosen, {other:.0} at random");
        assert!(best > other + 400.0, "{best} {other}");
    }

    proptest! {
        #[test]
        fn lazy_is_plain_greedy_and_gains_only_fall(
            places in prop::collection::vec((0.0..20.0_f64, 0.0..20.0_f64, 0.0..3.0_f64), 2..30),
        ) {
            let nodes = nodes(places.iter().map(|&(x, y, z)| [x, y, z]));
            let field = ObstacleField::default();
            let count = nodes.len() / 2;
            let chosen = config(count).choose(&nodes, &field).unwrap();
            let mut design = config(count).design(&nodes, &field);
            let mut before = vec![f64::INFINITY; nodes.len()];
            for &node in &chosen {
                let gains: Vec<f64> = (0..nodes.len()).map(|node| design.gain(node)).collect();
                for (gain, before) in gains.iter().zip(&before) {
                    prop_assert!(*gain >= 0.0 && gain <= &(before + 1e-9));
                }
                let free = |other: &usize| *other == node || !chosen.contains(other);
                let most = (0..nodes.len()).filter(free).map(|other| gains[other]).fold(0.0, f64::max);
                prop_assert!(gains[node] >= most - 1e-9);
                design.take(node);
                before = gains;
            }
        }
    }

    #[test]
    fn a_determinant_is_that_of_its_eigenvalues() {
        // 4, 1 and 1/9 along turned axes, and an azimuth of 2: the product is 8/9.
        let (c, s) = (0.8, 0.6);
        let place = [4.0 * c * c + s * s, 4.0 * s * s + c * c, 1.0 / 9.0, 3.0 * c * s, 0.0, 0.0];
        let known = Knowledge { place, azimuth: 2.0 };
        assert!((known.ln_determinant() - (8.0_f64 / 9.0).ln()).abs() < 1e-12);
    }

    #[test]
    fn invalid_settings_name_their_keys() {
        let three = nodes([[0.0; 3], [1.0; 3], [2.0; 3]]);
        let key = |config: OptimisedAnchorsConfig| config.choose(&three, &ObstacleField::default()).unwrap_err().key;
        assert_eq!(key(config(4)), "count");
        assert_eq!(key(OptimisedAnchorsConfig { share: Some(0.5), ..config(1) }), "share");
        assert_eq!(key(OptimisedAnchorsConfig { count: None, ..config(1) }), "share");
        assert_eq!(key(OptimisedAnchorsConfig { share: Some(f64::NAN), count: None, ..config(1) }), "share");
        assert_eq!(key(OptimisedAnchorsConfig { range_m: 0.0, ..config(1) }), "range_m");
        assert_eq!(key(OptimisedAnchorsConfig { sectors: 0, ..config(1) }), "sectors");
        assert_eq!(config(0).choose(&[], &ObstacleField::default()), Ok(Vec::new()));
        // Nodes at one place are anchors like others.
        let same = nodes([[0.0; 3], [0.0; 3]]);
        assert_eq!(config(2).choose(&same, &ObstacleField::default()), Ok(vec![0, 1]));
    }
}
