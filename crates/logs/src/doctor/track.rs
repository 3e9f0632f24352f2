//! What some packets of the nodes say of a delay: for each delay, the places of the nodes and the antenna of the robot that
//! explain them best.
//!
//! A robot whose body costs signal behind it hears a node better before it passes than after, which looks as if the packets
//! came early. So front and back are estimated with each delay, and only what they cannot explain tells the delay: they do the
//! same at all distances, a delay the more the nearer the node is. Packets alone, without strengths, do not tell both.

use nalgebra::{Matrix2, Vector2, Vector4};
use rayon::prelude::*;
use sextant_channel::Position;

use super::node_fit::{Law, NodeFit, Observation, Pattern};
use super::route::Route;
use super::samples::PacketSample;
use crate::median::median;

/// A node with fewer packets says nothing.
pub(super) const LEAST_OF_NODE: usize = 12;
/// This share of the packets of a node must be on the path at each delay.
pub(super) const COVERED: f64 = 0.7;
/// The packets of a node are judged in so many parts.
pub(super) const PARTS: usize = 3;
/// Instants at which it is known where the robot was, for packets without strengths.
const BACKGROUND: usize = 160;
/// They weigh so many times as much as the packets.
const BACKGROUND_WEIGHT: f64 = 4.0;
/// Standard deviation of the prior of each value of a pattern (dB): bodies and antennas make some decibels.
const PATTERN_DB: f64 = 4.0;
/// Steps of the search for the pattern at a delay, the longest of them, and the one after which it ends (dB).
const STEPS: u32 = 4;
const LONGEST_DB: f64 = 4.0;
const SHORTEST_DB: f64 = 0.12;

/// What was observed, and the part of the packets that each observation belongs to.
type Observed = (Vec<Observation>, Vec<usize>);

/// The packets of a node, and how what they say depends on the place.
pub(super) struct PacketTrack<'a> {
    pub(super) packets: &'a [PacketSample],
    routes: &'a [Route<'a>],
    background: &'a [(Position, [f64; 2])],
    law: Law,
}

impl<'a> PacketTrack<'a> {
    pub(super) fn of(
        packets: &'a [PacketSample],
        routes: &'a [Route<'a>],
        background: &'a [(Position, [f64; 2])],
    ) -> Option<Self> {
        if packets.len() < LEAST_OF_NODE {
            return None;
        }
        let measured = packets.iter().filter_map(|packet| packet.rssi_dbm);
        let [low, high] = measured
            .clone()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], level| [level.min(low), level.max(high)]);
        let has_strengths = 2 * measured.count() > packets.len() && high - low > 3.0;
        let mut track = Self { packets, routes, background, law: Law::Presence };
        if has_strengths {
            track.law = Law::Strengths { scale_db: 4.0 };
            let (observations, _) = track.observations(0.0)?;
            let none = Pattern::zeros();
            let fit = NodeFit::of(&observations, track.law, &none)?;
            let error = |one: &Observation| (one.value - fit.eta_of(one, &none)).abs();
            let mut errors: Vec<f64> = observations.iter().map(error).collect();
            let usual = median(&mut errors)?;
            track.law = Law::Strengths { scale_db: (1.5 * usual).clamp(1.0, 8.0) };
        }
        Some(track)
    }

    /// Whether strengths tell, not only which packets were heard.
    pub(super) fn has_strengths(&self) -> bool {
        self.law != Law::Presence
    }

    /// What was observed if the packets are late by `delay_s`, and the part of the packets that each observation belongs to.
    /// `None` if too few were heard on the path.
    pub(super) fn observations(&self, delay_s: f64) -> Option<Observed> {
        let (mut observations, mut parts) = (Vec::new(), Vec::new());
        for (number, packet) in self.packets.iter().enumerate() {
            let value = match self.law {
                Law::Strengths { .. } => packet.rssi_dbm,
                Law::Presence => Some(1.0),
            };
            let seen = self.routes.get(packet.robot.index()).and_then(|route| route.before(packet.time, delay_s));
            if let (Some((at, heading)), Some(value)) = (seen, value) {
                observations.push(Observation { at, heading, value, weight: 1.0 });
                parts.push(PARTS * number / self.packets.len());
            }
        }
        let count = observations.len();
        if (count as f64) < COVERED * self.packets.len() as f64 || count < LEAST_OF_NODE {
            return None;
        }
        if self.law == Law::Presence {
            let weight = BACKGROUND_WEIGHT * count as f64 / self.background.len().max(1) as f64;
            for (number, &(at, heading)) in self.background.iter().enumerate() {
                observations.push(Observation { at, heading, value: 0.0, weight });
                parts.push(number % PARTS);
            }
        }
        Some((observations, parts))
    }

    /// The losses of the parts, as if all packets were heard on the path.
    fn losses(&self, (observations, parts): &Observed, fit: &NodeFit, pattern: &Pattern) -> [f64; PARTS] {
        let mut losses = [0.0; PARTS];
        for (observation, &part) in observations.iter().zip(parts) {
            losses[part] += fit.loss_of(observation, self.law, pattern);
        }
        let heard = observations.iter().filter(|one| self.law != Law::Presence || one.value > 0.5).count();
        losses.map(|loss| loss * self.packets.len() as f64 / heard as f64)
    }
}

/// Where the robots were at instants spread evenly over the times of their paths, and in which direction they drove.
pub(super) fn background(routes: &[Route<'_>]) -> Vec<(Position, [f64; 2])> {
    let each = BACKGROUND / routes.len().max(1);
    let of_route = |route: &Route<'_>| {
        let (start, end) = route.path.span();
        let span_s = end.as_secs_f64() - start.as_secs_f64();
        let at = |i: usize| route.before(start, -span_s * (i as f64 + 0.5) / each as f64);
        (0..each).filter_map(at).collect::<Vec<_>>()
    };
    routes.iter().flat_map(of_route).collect()
}

/// What explains all tracks at a delay. They are of one kind of law, and share the pattern.
#[derive(Clone, Debug)]
struct Explained {
    fits: Vec<Option<NodeFit>>,
    pattern: Pattern,
    loss: f64,
}

impl Explained {
    /// The places and the pattern that explain what was `observed` best, searched for from those of a neighbouring delay.
    fn of(tracks: &[PacketTrack<'_>], observed: &[Option<Observed>], start: Option<&Self>) -> Self {
        let seen = || tracks.par_iter().zip(observed).enumerate();
        let mut pattern = start.map_or_else(Pattern::zeros, |start| start.pattern);
        let mut starts: Vec<Option<Vector4<f64>>> = match start {
            Some(start) => start.fits.iter().map(|fit| fit.map(|fit| fit.parameters)).collect(),
            None => vec![None; tracks.len()],
        };
        let mut step = 0;
        loop {
            let fit = |(at, (track, observed)): (usize, (&PacketTrack<'_>, &Option<Observed>))| {
                let (observations, _) = observed.as_ref()?;
                match starts[at] {
                    Some(start) => NodeFit::from(start, observations, track.law, &pattern),
                    None => NodeFit::of(observations, track.law, &pattern),
                }
            };
            let fits: Vec<Option<NodeFit>> = seen().map(fit).collect();
            let precision = PATTERN_DB.powi(-2);
            let slopes = |(at, (track, observed)): (usize, (&PacketTrack<'_>, &Option<Observed>))| {
                let ((observations, _), fit) = (observed.as_ref()?, fits[at].filter(|_| track.has_strengths())?);
                Some(fit.pattern_slopes(observations, track.law, &pattern))
            };
            let all: Vec<(Vector2<f64>, Matrix2<f64>)> = seen().filter_map(slopes).collect();
            let (mut slope, mut curvature) = (pattern * precision, Matrix2::identity() * precision);
            for (of_node, bend) in all {
                slope += of_node;
                curvature += bend;
            }
            let way = curvature.cholesky().map_or_else(Vector2::zeros, |curvature| curvature.solve(&slope));
            let way = way.cap_magnitude(LONGEST_DB);
            if step == STEPS || way.norm() < SHORTEST_DB {
                let loss = fits.iter().flatten().map(|fit| fit.loss).sum::<f64>();
                let loss = loss + 0.5 * precision * pattern.norm_squared();
                return Self { fits, pattern, loss };
            }
            starts = fits.iter().zip(&starts).map(|(fit, &start)| fit.map(|fit| fit.parameters).or(start)).collect();
            pattern -= way;
            step += 1;
        }
    }
}

/// What explains all tracks best at a delay.
#[derive(Clone, Debug)]
pub(super) struct AtDelay {
    /// The losses of all parts of all tracks; infinite where the delay drives a track off the path.
    pub(super) losses: Vec<f64>,
    /// The front and back of the robot (dB); none without strengths.
    pub(super) pattern: Pattern,
}

/// What explains all tracks best at each of `delays_s`. The places and the pattern are searched for from those of neighbours.
pub(super) fn profile(tracks: &[PacketTrack<'_>], delays_s: &[f64]) -> Vec<AtDelay> {
    let observed: Vec<Vec<Option<Observed>>> = delays_s
        .iter()
        .map(|&delay_s| tracks.par_iter().map(|track| track.observations(delay_s)).collect())
        .collect();
    let mut best: Vec<Option<Explained>> = vec![None; delays_s.len()];
    // From the middle, which no mirror image spoils, to both ends; and from there, so that what is better spreads.
    let (middle, end) = (delays_s.len() / 2, delays_s.len());
    let ways: [Vec<usize>; 4] =
        [(middle..end).collect(), (0..=middle).rev().collect(), (0..end).collect(), (0..end).rev().collect()];
    for way in ways {
        let mut last: Option<Explained> = None;
        for at in way {
            let explained = Explained::of(tracks, &observed[at], last.as_ref());
            let best = &mut best[at];
            if best.as_ref().is_none_or(|best| explained.loss < best.loss) {
                *best = Some(explained);
            }
            last.clone_from(best);
        }
    }
    let of_delay = |(observed, explained): (&Vec<Option<Observed>>, &Option<Explained>)| {
        let explained = explained.as_ref().expect("each delay was tried");
        let of_track = |(at, track): (usize, &PacketTrack<'_>)| match (&observed[at], &explained.fits[at]) {
            (Some(observed), Some(fit)) => track.losses(observed, fit, &explained.pattern),
            _ => [f64::INFINITY; PARTS],
        };
        let losses = tracks.iter().enumerate().flat_map(of_track).collect();
        AtDelay { losses, pattern: explained.pattern }
    };
    observed.iter().zip(&best).map(of_delay).collect()
}
