//! More opinions on the place of each node than that of the link model. They know no law of radio, so that a law which explains
//! a log badly does not mislead them.

mod gain;
mod heavy_tailed;
mod learnt;

use nalgebra::{Matrix2, Vector2};
use rayon::prelude::*;
use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::{Interrupted, NodeId, Watch, Work};

pub(super) use self::gain::GainOfLaw;
use self::heavy_tailed::{HeavyTailed, together};
pub use self::learnt::OpinionConstants;
use crate::comparators::strengths::{centroid, strongest_place};
use crate::comparators::{Comparator, PacketCentroid, RssiCentroid, StrongestStop};
use crate::log_facts::strengths::sound_strengths;
use crate::numerics::convex_hull::{hull, turn};
use crate::posterior::{Concern, Estimate};
use crate::topology_map::TopologyMap;

/// How much the link model and other opinions count for the places of a map.
///
/// Where a log has strengths, these are the centroid of the stops that heard a node, by the square of the received power, and its
/// strongest stop; else the centroid by the sixth power of the shares. Each is a Student distribution round its place, to a
/// power because they come from the same evidence. The posterior of the link model is a Student distribution too. It counts less
/// where its law explains strengths worse than fields without distance do, and the others count less where it explains them better.
#[derive(Clone, Debug, PartialEq)]
pub struct Opinions {
    /// Mean gain of the law over a field of strengths without distance, for each strength at stops that were left out (nats).
    /// `None` without strengths, or if no stops could be left out.
    pub gain: Option<f64>,
    /// How much of the law by which the link model places nodes is that of the log; the rest is that of usual links.
    pub own_share: f64,
    /// Power of the posterior of the link model.
    pub link_model_power: f64,
    /// Scale of its Student distribution, as a share of its covariance: from all of it to the share with which the variance of the
    /// distribution is that of the posterior.
    pub link_model_scale: f64,
    /// How far its places may be off beyond what its posterior says (m).
    pub link_model_error_m: f64,
    /// How much farther the others may be off beside stops that lie on a line (m): places amid the stops do not tell how far
    /// beside them a node is.
    pub beside_line_m: f64,
    /// The other opinions.
    pub others: Vec<Opinion>,
}

/// An opinion on places beside that of the link model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Opinion {
    /// The name of the estimator that has it.
    pub estimator: &'static str,
    /// Scale of the Student distribution round its places (m).
    pub scale_m: f64,
}

/// Power of the shares of the packet centroid, and of the received powers of the one by strengths.
const CENTROID_POWER: f64 = 6.0;
const RSSI_POWER: f64 = 2.0;

/// From what the opinions beside the link model come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OpinionSource {
    /// Strengths: their centroid, and the strongest stop.
    Strengths,
    /// Packets alone: their centroid.
    Packets,
}

impl Opinions {
    /// What counts how much in a log whose links are usually so long (m), under a law with this `gain` over fields of strengths.
    fn of(source: OpinionSource, gain: Option<f64>, usual_link_m: f64, constants: &OpinionConstants) -> Self {
        let opinion = |estimator, share: f64| Opinion { estimator, scale_m: share * usual_link_m };
        if source == OpinionSource::Packets {
            let [_, power] = constants.links_power;
            let others = vec![opinion(PacketCentroid::NAME, constants.centroid)];
            let error_m = constants.links_error * usual_link_m;
            return Self {
                gain: None,
                own_share: 1.0,
                link_model_power: power,
                link_model_scale: 1.0,
                link_model_error_m: error_m,
                beside_line_m: usual_link_m,
                others,
            };
        }
        let [low, high] = constants.gains;
        let told = gain.unwrap_or(constants.unknown_gain);
        let believed = ((told - low) / (high - low)).clamp(0.0, 1.0);
        let between = |[least, most]: [f64; 2]| least + believed * (most - least);
        let beyond = libm::exp(constants.wider_a_nat * (told - high).max(0.0));
        let wider = (between(constants.wider) * beyond).min(constants.widest);
        let others = vec![
            opinion(RssiCentroid::NAME, wider * constants.rssi_centroid),
            opinion(StrongestStop::NAME, wider * constants.strongest),
        ];
        // A law that gains much is one of these links: it errs no more than it says.
        let error_m = constants.links_error * usual_link_m / beyond;
        let own_share = constants.own_share_at(gain);
        let power = between(constants.links_power);
        Self {
            gain,
            own_share,
            link_model_power: power,
            link_model_scale: constants.links_scale_at(gain),
            link_model_error_m: error_m,
            beside_line_m: usual_link_m,
            others,
        }
    }

    /// The place of a node, with its covariance, of that by the link model and of the `others`. Heights follow as the link model
    /// has them depend on the place in the plane.
    fn place(&self, estimate: &Estimate, told: &Told, constants: &OpinionConstants) -> Option<Estimate> {
        if estimate.concern == Some(Concern::TooFew) {
            return None;
        }
        let covariance = estimate.covariance?;
        let error_m = self.link_model_error_m;
        let in_plane = |place: Position| Vector2::new(place.x_m, place.y_m);
        let own = Matrix2::from_fn(|row, column| covariance[row][column]) + Matrix2::identity() * (error_m * error_m);
        let links = HeavyTailed::student(
            in_plane(estimate.position),
            own * self.link_model_scale,
            constants.links_freedom,
            self.link_model_power,
        );
        let beside = beside_line(&told.heard_at) * (self.beside_line_m * self.beside_line_m);
        let round = told.places.iter().zip(&self.others).map(|(place, opinion)| {
            let scale = Matrix2::identity() * (opinion.scale_m * opinion.scale_m) + beside;
            HeavyTailed::student(in_plane(*place), scale, constants.freedom, constants.power)
        });
        let (mean, spread) = together(&std::iter::once(links).chain(round).collect::<Vec<_>>())?;
        // The height is linear in the place in the plane, about that of the link model.
        let across = Vector2::new(covariance[2][0], covariance[2][1]);
        let slope = own.try_inverse()? * across;
        let up_m = slope.dot(&(mean - in_plane(estimate.position)));
        let along = spread * slope;
        let height = covariance[2][2] - slope.dot(&across) + slope.dot(&along);
        let position = Position::new(mean[0], mean[1], estimate.position.z_m + up_m);
        let joined = [
            [spread[(0, 0)], spread[(0, 1)], along[0]],
            [spread[(1, 0)], spread[(1, 1)], along[1]],
            [along[0], along[1], height.max(0.0)],
        ];
        // The others are places amid the stops: they do not tell that a node is no farther away.
        let told = if estimate.concern == Some(Concern::AtEdge) {
            let apart: [f64; 3] = (position - estimate.position).into();
            let around = |row: usize, column: usize| covariance[row][column] + apart[row] * apart[column];
            std::array::from_fn(|row| std::array::from_fn(|column| around(row, column)))
        } else {
            joined
        };
        Some(Estimate { position, covariance: Some(told), ..estimate.clone() })
    }
}

/// What is told of a node without a law of radio.
#[derive(Clone, Debug)]
struct Told {
    /// Where the other opinions place it.
    places: Vec<Position>,
    /// Where it was heard.
    heard_at: Vec<Position>,
}

impl OpinionSource {
    /// What is told of a node. `None` if nothing is.
    fn of_node(self, log: &ReceptionLog, node: NodeId) -> Option<Told> {
        match self {
            Self::Strengths => {
                let strengths = sound_strengths(log, node);
                let places = vec![centroid(&strengths, RSSI_POWER)?, strongest_place(&strengths)?];
                Some(Told { places, heard_at: strengths.iter().map(|strength| strength.place).collect() })
            }
            Self::Packets => {
                let centroid = PacketCentroid::with_power(CENTROID_POWER).place(log, node)?;
                let heard = log.of(node).iter().filter(|reception| reception.received > 0);
                let heard_at = heard.map(|reception| log.stops()[reception.stop as usize].position).collect();
                Some(Told { places: vec![centroid], heard_at })
            }
        }
    }
}

/// What is told of the nodes of a log beside the link model.
#[derive(Clone, Debug)]
pub struct OtherOpinions {
    source: OpinionSource,
    told: Vec<Option<Told>>,
    /// The nodes beyond the stops, of which they tell nothing.
    beyond: Vec<bool>,
    /// `None` if no node was heard at two places.
    usual_link_m: Option<f64>,
}

impl OtherOpinions {
    /// The opinions on the nodes of `log`.
    ///
    /// # Errors
    /// If `watch` ends the work.
    pub fn of(log: &ReceptionLog, source: OpinionSource, watch: &dyn Watch) -> Result<Self, Interrupted> {
        let nodes = log.node_count();
        watch.begin(Work { name: "opinions", unit: "node", steps: nodes as u64, operations: nodes as f64 * 1e6 });
        let told: Result<Vec<Option<Told>>, Interrupted> = (0..nodes)
            .into_par_iter()
            .map(|node| {
                watch.check()?;
                watch.advance(1);
                Ok(source.of_node(log, NodeId::from_index(node)))
            })
            .collect();
        let told = told?;
        let usual_link_m = usual_link_m(told.iter().flatten());
        Ok(Self { source, beyond: vec![false; told.len()], told, usual_link_m })
    }

    /// The same without opinions on nodes that `map` places beyond the stops of `log`. A place among the stops is all that these
    /// opinions can tell: of a node outside they tell the nearest border.
    #[must_use]
    pub fn amid_stops(self, log: &ReceptionLog, map: &TopologyMap) -> Self {
        let border = hull(log.stops().iter().map(|stop| [stop.position.x_m, stop.position.y_m]).collect());
        let is_amid = |estimate: &Option<Estimate>| {
            let Some(place) = estimate.as_ref().map(|estimate| [estimate.position.x_m, estimate.position.y_m]) else {
                return false;
            };
            let sides = border.iter().zip(border.iter().cycle().skip(1));
            sides.map(|(&from, &to)| turn(from, to, place)).all(|turn| turn >= 0.0)
        };
        let beyond: Vec<bool> = map.estimates.iter().map(|estimate| !is_amid(estimate)).collect();
        let told = self.told.into_iter().zip(&beyond).map(|(told, is_beyond)| told.filter(|_| !is_beyond)).collect();
        Self { told, beyond, ..self }
    }

    /// Adds them to a `map` by the link model, whose law has this `gain`; what counted how much. `None` if no node was heard at
    /// two places: the map stays as it is. A law that explains strengths worse than fields without distance is no evidence of how far
    /// beyond the stops a node is.
    pub fn join(&self, map: &mut TopologyMap, gain: Option<f64>, constants: &OpinionConstants) -> Option<Opinions> {
        let opinions = Opinions::of(self.source, gain, self.usual_link_m?, constants);
        let explains_nothing = gain.is_some_and(|gain| gain <= constants.gains[0]);
        let join = |((estimate, told), is_beyond): ((&mut Option<Estimate>, &Option<Told>), &bool)| {
            if let (Some(own), Some(told)) = (&*estimate, told)
                && let Some(joined) = opinions.place(own, told, constants)
            {
                *estimate = Some(joined);
            } else if let Some(own) = estimate
                && explains_nothing
                && *is_beyond
            {
                own.concern = own.concern.or(Some(Concern::NoEvidence));
            }
        };
        map.estimates.par_iter_mut().zip(&self.told).zip(&self.beyond).for_each(join);
        Some(opinions)
    }
}

/// The direction beside the line near which some places lie, as a matrix that takes the part of a way along it: of places on a line
/// with the whole of its square, of places that spread alike in all directions with nothing.
fn beside_line(places: &[Position]) -> Matrix2<f64> {
    let in_plane = |place: &Position| Vector2::new(place.x_m, place.y_m);
    let middle = places.iter().map(in_plane).sum::<Vector2<f64>>() / places.len().max(1) as f64;
    let ways = places.iter().map(|place| in_plane(place) - middle);
    let spread = ways.map(|way| way * way.transpose()).sum::<Matrix2<f64>>().symmetric_eigen();
    let (across, along) = if spread.eigenvalues[0] < spread.eigenvalues[1] { (0, 1) } else { (1, 0) };
    let [least, most] = [across, along].map(|axis| spread.eigenvalues[axis].max(0.0));
    if most <= 0.0 {
        return Matrix2::zeros();
    }
    let share = 1.0 - (least / most).sqrt();
    let direction = spread.eigenvectors.column(across);
    direction * direction.transpose() * (share * share)
}

/// The usual length of a link in the plane (m): the geometric mean over nodes of the mean distance from the last of the other
/// opinions to the stops that received the node. `None` if each node was received at one place.
fn usual_link_m<'a>(told: impl Iterator<Item = &'a Told>) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0.0);
    for Told { places, heard_at } in told {
        let Some(middle) = places.last() else { continue };
        let lengths = heard_at.iter().map(|place| libm::hypot(place.x_m - middle.x_m, place.y_m - middle.y_m));
        let lengths: Vec<f64> = lengths.filter(|&length_m| length_m > 0.0).collect();
        if !lengths.is_empty() {
            sum += libm::log(lengths.iter().sum::<f64>() / lengths.len() as f64);
            count += 1.0;
        }
    }
    (count > 0.0).then(|| libm::exp(sum / count))
}

#[cfg(test)]
mod tests {
    use sextant_channel::{Reception, Stop};
    use sextant_kernel::Unwatched;

    use super::*;

    fn estimate(position: Position, covariance: [[f64; 3]; 3]) -> Estimate {
        let map = TopologyMap::of_places("a", vec![Some(position)], crate::topology_map::CoordinateFrame::World);
        let estimate = map.estimates[0].clone().unwrap();
        Estimate { covariance: Some(covariance), ..estimate }
    }

    #[test]
    fn a_law_counts_the_more_the_more_it_gains_and_the_others_the_less() {
        let learnt = OpinionConstants::LEARNT;
        let of = |gain| Opinions::of(OpinionSource::Strengths, gain, 10.0, &learnt);
        let gains = [Some(-0.5), Some(-0.15), None, Some(-0.05), Some(0.0), Some(0.5), Some(1.0), Some(9.0)];
        let told: Vec<Opinions> = gains.map(of).to_vec();
        assert!(told.is_sorted_by(|a, b| a.link_model_power <= b.link_model_power));
        assert!(told.is_sorted_by(|a, b| a.others[0].scale_m <= b.others[0].scale_m));
        assert!(told.is_sorted_by(|a, b| a.link_model_error_m >= b.link_model_error_m));
        assert!(told.is_sorted_by(|a, b| a.own_share <= b.own_share && a.link_model_scale >= b.link_model_scale));
        assert!(
            (told[0].link_model_scale - 1.0).abs() < 1e-12 && (told[7].link_model_scale - 1.0 / 3.0).abs() < 1e-12
        );
        assert_eq!((told[2].own_share, told[5].own_share, told[6].own_share), (0.5, 0.5, 1.0));
        assert_eq!(
            (told[0].link_model_power, told[0].others[0].scale_m, told[0].link_model_error_m),
            (0.2, 3.0, 1.0)
        );
        assert_eq!((told[7].link_model_power, told[7].others[1].scale_m), (1.0, 29.0));
        let packets = Opinions::of(OpinionSource::Packets, None, 10.0, &learnt);
        assert_eq!(packets.others, [Opinion { estimator: "packet-centroid", scale_m: 6.5 }]);
    }

    #[test]
    fn places_turn_with_the_opinions_and_heights_follow_places() {
        let learnt = OpinionConstants::LEARNT;
        let of_log = Opinions::of(OpinionSource::Strengths, Some(-0.2), 8.0, &learnt);
        let opinions = Opinions { link_model_error_m: 0.0, ..of_log };
        let (own, others) =
            (Position::new(1.0, 2.0, 3.0), [Position::new(6.0, 2.0, 0.0), Position::new(5.0, 4.0, 0.0)]);
        // The height grows by half a metre for each metre along x.
        let covariance = [[4.0, 0.0, 2.0], [0.0, 1.0, 0.0], [2.0, 0.0, 1.5]];
        // Stops that spread alike in all directions.
        let around = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]].map(|[x, y]| Position::new(x, y, 0.0));
        let told = |places: [Position; 2]| Told { places: places.to_vec(), heard_at: around.to_vec() };
        let joined = opinions.place(&estimate(own, covariance), &told(others), &learnt).unwrap();
        let moved = joined.position - own;
        assert!(moved.x_m > 0.5 && (moved.z_m - 0.5 * moved.x_m).abs() < 1e-12, "{moved}");
        let spread = joined.covariance.unwrap();
        assert!((spread[0][2] - 0.5 * spread[0][0]).abs() < 1e-12 && spread[2][2] > 0.5);
        let turned = |place: Position| Position::new(-place.y_m, place.x_m, place.z_m);
        let covariance = [[1.0, 0.0, 0.0], [0.0, 4.0, 2.0], [0.0, 2.0, 1.5]];
        let other = opinions.place(&estimate(turned(own), covariance), &told(others.map(turned)), &learnt).unwrap();
        assert!(other.position.distance_m(turned(joined.position)) < 1e-9, "{} {}", other.position, joined.position);
    }

    #[test]
    fn places_amid_stops_on_a_line_do_not_tell_how_far_beside_it_a_node_is() {
        let learnt = OpinionConstants::LEARNT;
        let opinions = Opinions::of(OpinionSource::Strengths, Some(-0.2), 8.0, &learnt);
        let direction = Vector2::new(0.6, 0.8);
        let on_line = |along: i32| {
            let place = direction * f64::from(along);
            Position::new(place[0], place[1], 0.0)
        };
        let line: Vec<Position> = (-5..=5).map(on_line).collect();
        let across = Vector2::new(-0.8, 0.6);
        assert!((beside_line(&line) - across * across.transpose()).norm() < 1e-9);
        assert!(beside_line(&[]).norm() < 1e-12 && beside_line(&line[..1]).norm() < 1e-12);
        let own = estimate(Position::ORIGIN, [[400.0, 0.0, 0.0], [0.0, 400.0, 0.0], [0.0; 3]]);
        let told = Told { places: vec![Position::ORIGIN; 2], heard_at: line };
        let joined = opinions.place(&own, &told, &learnt).unwrap().covariance.unwrap();
        let spread = Matrix2::from_fn(|row, column| joined[row][column]);
        let deviation_m = |of: Vector2<f64>| of.dot(&(spread * of)).sqrt();
        assert!(deviation_m(across) > 2.0 * deviation_m(direction), "{spread}");
    }

    #[test]
    fn nothing_is_told_of_a_node_beyond_all_stops() {
        let corners = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]];
        let stops = corners.map(|[x_m, y_m]| Stop::at(Position::new(x_m, y_m, 0.0)));
        let heard = |node| (0..4).map(move |stop| Reception::heard(NodeId(node), stop, 1 + stop % 2, 2));
        let names = ["inside", "outside"].map(str::to_owned).to_vec();
        let log = ReceptionLog::new(names, stops.to_vec(), heard(0).chain(heard(1)).collect(), Vec::new()).unwrap();
        let places = [[4.0, 5.0], [14.0, 5.0]].map(|[x_m, y_m]| Some(Position::new(x_m, y_m, 0.0)));
        let map = TopologyMap::of_places("a", places.to_vec(), crate::topology_map::CoordinateFrame::World);
        let all = OtherOpinions::of(&log, OpinionSource::Packets, &Unwatched).unwrap();
        assert!(all.told.iter().all(Option::is_some));
        let amid = all.clone().amid_stops(&log, &map);
        assert!(amid.told[0].is_some() && amid.told[1].is_none());
        assert_eq!(amid.usual_link_m, all.usual_link_m, "links are as long as before");
    }

    #[test]
    fn a_node_that_was_heard_at_one_place_has_no_usual_link() {
        let here = Position::new(1.0, 1.0, 0.0);
        let one = Told { places: vec![here], heard_at: vec![here] };
        let two = Told { places: vec![here], heard_at: vec![here, Position::new(4.0, 5.0, 2.0)] };
        assert_eq!(usual_link_m([one.clone()].iter()), None);
        assert!((usual_link_m([one, two].iter()).unwrap() - 5.0).abs() < 1e-12);
    }
}
