//! What the frame of a survey follows from, gathered log by log or part by part.

use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::NodeId;

use super::axes::SurveyAxes;
use super::frame::SurveyFrame;
use super::rectangle::{Rectangle, Weighted};

/// A stop that heard nothing is left out if it is farther from the middle of those that heard something than so many diagonals of
/// their rectangle: that nothing is heard there tells nothing.
const FAR: f64 = 2.0;
/// Decibels are told apart by so many parts.
const PARTS_OF_DB: f64 = 1e6;

/// What was heard at each stop.
#[derive(Clone, Debug)]
pub(crate) struct HeardStops {
    /// Packets of all nodes.
    packets: Vec<u64>,
    has_sectors: bool,
}

impl HeardStops {
    /// Nothing, at so many stops.
    pub(crate) fn none(stops: usize) -> Self {
        Self { packets: vec![0; stops], has_sectors: false }
    }

    /// Takes what `log` heard at these stops.
    pub(crate) fn take(&mut self, log: &ReceptionLog) {
        for reception in log.receptions().iter() {
            self.packets[reception.stop as usize] += u64::from(reception.received);
        }
        self.has_sectors |= log.sectors().is_some() || log.receptions().sectors().is_some();
    }

    /// The axes of a survey at the stops of `log`, and their order; `None` if nothing was heard.
    pub(crate) fn draft(&self, log: &ReceptionLog) -> Option<FrameDraft> {
        let stops = log.stops();
        let heard = stops.iter().zip(&self.packets).filter(|&(_, &packets)| packets > 0);
        let heard: Vec<Weighted> =
            heard.map(|(stop, &packets)| ([stop.position.x_m, stop.position.y_m], packets as f64)).collect();
        let rectangle = Rectangle::round(&heard)?;
        if self.has_sectors {
            // Directions of sectors are those of the log, and its stops are told by number.
            let axes = SurveyAxes::of_log(rectangle.diagonal_m());
            let numbers = (0_u32..).zip(stops).map(|(number, _)| number).collect();
            return Some(FrameDraft { axes, stops: numbers, keys: Vec::new() });
        }
        let axes = SurveyAxes::of(&rectangle);
        let mut path: Vec<usize> = (0..stops.len()).collect();
        path.sort_by_key(|&stop| stops[stop].time);
        let mut keys: Vec<StopKey> = Vec::with_capacity(stops.len());
        for (rank, &stop) in path.iter().enumerate() {
            let place = axes.place(stops[stop].position);
            if self.packets[stop] > 0 || !axes.is_beyond(place, FAR) {
                keys.push(StopKey { rank: axes.rank(place), packets: self.packets[stop], path: rank, stop });
            }
        }
        keys.sort_unstable();
        let numbers = keys.iter().map(|key| u32::try_from(key.stop).unwrap_or(u32::MAX)).collect();
        Some(FrameDraft { axes, stops: numbers, keys: Vec::new() })
    }
}

/// By what stops are put in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct StopKey {
    rank: [i64; 3],
    packets: u64,
    path: usize,
    stop: usize,
}

/// By what nodes are put in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct NodeKey {
    /// Of the mean of the places that heard it, by packets.
    rank: [i64; 3],
    packets: u64,
    stops: usize,
    /// Mean strength in parts of a decibel.
    strength: i64,
    /// Of the place that heard it best.
    best: [i64; 3],
    node: NodeId,
}

/// A frame whose nodes are not all known.
#[derive(Clone, Debug)]
pub(crate) struct FrameDraft {
    axes: SurveyAxes,
    stops: Vec<u32>,
    keys: Vec<NodeKey>,
}

impl FrameDraft {
    /// Takes the nodes of `log` that were heard; they are `nodes` in the whole log.
    pub(crate) fn take(&mut self, nodes: impl Iterator<Item = NodeId>, log: &ReceptionLog) {
        for (number, node) in nodes.enumerate() {
            self.keys.extend(self.key(log, NodeId::from_index(number), node));
        }
    }

    fn key(&self, log: &ReceptionLog, number: NodeId, node: NodeId) -> Option<NodeKey> {
        let (mut sum, mut packets, mut stops, mut strength) = (Position::ORIGIN, 0, 0, (0.0, 0.0));
        let mut best: Option<(u32, [i64; 3])> = None;
        for reception in log.of(number).iter().filter(|reception| reception.received > 0) {
            let place = self.axes.place(log.stops()[reception.stop as usize].position);
            sum = sum + place * f64::from(reception.received);
            packets += u64::from(reception.received);
            stops += 1;
            if let Some(rssi_dbm) = reception.rssi_dbm {
                strength = (strength.0 + rssi_dbm, strength.1 + 1.0);
            }
            best = best.max(Some((reception.received, self.axes.rank(place))));
        }
        let (_, best) = best?;
        let rank = self.axes.rank(sum * (1.0 / packets as f64));
        let mean_dbm = if strength.1 > 0.0 { strength.0 / strength.1 } else { 0.0 };
        #[expect(clippy::cast_possible_truncation, reason = "strengths are small, and a cast is bounded")]
        let strength = (mean_dbm * PARTS_OF_DB).round() as i64;
        Some(NodeKey { rank, packets, stops, strength, best, node })
    }

    /// The frame, whose log has so many stops.
    pub(crate) fn frame(mut self, log_stops: usize) -> SurveyFrame {
        self.keys.sort_unstable();
        let nodes = self.keys.iter().map(|key| key.node).collect();
        SurveyFrame { axes: self.axes, stops: self.stops, nodes, log_stops }
    }
}
