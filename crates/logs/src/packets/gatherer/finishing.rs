//! The end of gathering: how many packets each node sent at each stop, and the log.

use std::collections::BTreeMap;
use std::time::Duration;

use sextant_channel::ReceptionLogBuilder;
use sextant_kernel::{NodeId, RobotId, SimTime};

use super::{Gatherer, MOST_SILENT_PAIRS, RobotTrack, silent};
use crate::doctor::{self, ClockDrift, ClockOffset};
use crate::error::robot_log_error::RobotLogError;
use crate::median::median_by;
use crate::packets::gathered::Gathered;
use crate::packets::heard::{HeardPackets, reception};
use crate::packets::interval::{Gaps, Intervals, intervals};
use crate::packets::sending::{self, MOST_SENT};
use crate::path::robot_path::{Path, later, span_of};
use crate::path::slot::Slot;
use crate::robot_log::RobotLog;
use crate::time::instant;

impl Gatherer {
    /// The log of all packets.
    ///
    /// # Errors
    /// If there were no packets, or none on the path.
    pub fn finish(mut self) -> Result<RobotLog, RobotLogError> {
        if self.ranges.is_empty() && self.brought > 0 && self.cover.is_empty() {
            let problem = format!("none of {} ranges is a number that was measured on the path", self.brought);
            return Err(RobotLogError::NoRanges { name: "the log".to_owned(), problem });
        }
        if self.ranges.is_empty() || !self.cover.is_empty() {
            self.cover.check(self.tracks.iter().map(|track| &track.path), self.delay_s, &mut self.notes)?;
        }
        self.strengths.finish(&mut self.notes)?;
        self.notes.extend(self.rssi.note());
        self.findings.extend(self.rssi.findings());
        let clock = self.clock();
        let all_gaps = self.tracks.iter_mut().flat_map(|track| &mut track.gaps);
        let counts =
            all_gaps.map(Gaps::repeated).fold([0; 2], |sum, counts| [sum[0] + counts[0], sum[1] + counts[1]]);
        self.findings.extend(doctor::repeated::finding(counts));
        let path = span_of(self.tracks.iter().map(|track| &track.path));
        self.findings.extend(self.cover.placed_span().and_then(|packets| doctor::part::finding(packets, path)));
        let intervals = self.intervals();
        let pairs = self.names.len().saturating_mul(self.stops.len());
        let lists_silent = pairs <= MOST_SILENT_PAIRS;
        if !lists_silent && intervals.of.iter().any(Option::is_some) {
            self.notes.push(format!(
                "{pairs} pairs of a node and a stop are too many to list (at most {MOST_SILENT_PAIRS}): at a stop without \
                 a packet, a node counts as one missed packet"
            ));
        }
        let (heard, _) = std::mem::replace(&mut self.heard, Gathered::new()).finish();
        let mut receptions = ReceptionLogBuilder::default();
        let mut sent = vec![0; self.stops.len()];
        for of_node in heard.chunk_by(|a, b| a.node == b.node) {
            let node = NodeId(of_node[0].node);
            let interval = intervals.of[node.index()];
            if let Some(interval) = interval {
                self.count_sent(of_node, interval, &mut sent)?;
            }
            let mut pairs = of_node.chunk_by(|a, b| a.stop == b.stop).peekable();
            for (stop, &sent) in (0..).zip(&sent) {
                match pairs.next_if(|pair| pair[0].stop == stop) {
                    Some(pair) => receptions.push(reception(pair, interval.map(|_| sent))),
                    // 0 of 1 means the same as an absent pair.
                    None if interval.is_some() && lists_silent && sent != 1 => {
                        receptions.push(silent(node, stop, sent))
                    }
                    None => {}
                }
            }
        }
        if self.brought > 0 {
            let (brought, placed) = (self.brought, self.ranges.len());
            self.notes.push(format!("{brought} ranges were measured, of which {placed} count"));
            self.notes.extend(self.ranges.unit_note());
        }
        let middles = self.middles();
        let ranges = self.ranges.finish(&mut self.notes);
        let log = receptions
            .build(self.names, self.stops, self.contacts)
            .and_then(|log| log.with_robots(self.robots))
            .and_then(|log| log.with_ranges(ranges))
            .map_err(RobotLogError::Invalid)?;
        let usual_stop = usual_stop(self.tracks.iter().flat_map(|track| &track.slots));
        let usual = usual_stop.zip(intervals.told.map(|told| told.median).or(self.interval));
        let of_paths = doctor::of_paths(self.tracks.iter().map(|track| &track.path), &log, self.plane.as_ref());
        self.findings.splice(0..0, of_paths);
        self.findings.extend(doctor::listening::finding(&log, usual));
        Ok(RobotLog {
            log,
            plane: self.plane,
            notes: self.notes,
            findings: self.findings,
            clock,
            middles,
            odometry: None,
        })
    }

    /// The middle of the time of each stop, by its robot and its start.
    fn middles(&self) -> BTreeMap<(RobotId, SimTime), SimTime> {
        let of_robot = |(robot, track): (usize, &RobotTrack)| {
            let middle = |slot: &Slot| later(slot.start, slot.end.saturating_since(slot.start) / 2);
            track
                .slots
                .iter()
                .map(|slot| ((RobotId::from_index(robot), slot.start), middle(slot)))
                .collect::<Vec<_>>()
        };
        self.tracks.iter().enumerate().flat_map(of_robot).collect()
    }

    /// How late the packets are; a finding if they clearly are, or not always as much.
    fn clock(&mut self) -> Option<ClockOffset> {
        let paths: Vec<&Path> = self.tracks.iter().map(|track| &track.path).collect();
        let clock = doctor::offset(&self.samples, &paths)?;
        let drift = ClockDrift::of(&self.samples, &paths);
        self.findings.extend(drift.map(|drift| drift.finding()).or_else(|| clock.finding()));
        Some(clock)
    }

    /// How many packets the node of the rows `heard` sent at each stop.
    fn count_sent(&self, heard: &[HeardPackets], interval: Duration, sent: &mut [u32]) -> Result<(), RobotLogError> {
        let mut times: Vec<SimTime> = heard.iter().flat_map(|row| [row.first, row.last]).collect();
        times.sort_unstable();
        times.dedup();
        let (from, to) = span_of(self.tracks.iter().map(|track| &track.path));
        for track in &self.tracks {
            let mut counts = vec![0; track.slots.len()];
            sending::count(&track.slots, &mut counts, &times, interval, from, to);
            for ((&stop, slot), count) in track.stops.iter().zip(&track.slots).zip(counts) {
                let fits = u32::try_from(count).ok().filter(|&count| count <= MOST_SENT);
                sent[stop as usize] = fits.ok_or_else(|| RobotLogError::TooManySent {
                    node: self.names[heard[0].node as usize].clone(),
                    stop,
                    span: slot.end.saturating_since(slot.start),
                    interval,
                    sent: count,
                    most: MOST_SENT,
                })?;
            }
        }
        Ok(())
    }

    /// The sending interval of each node.
    fn intervals(&mut self) -> Intervals {
        if let Some(interval) = self.interval {
            return Intervals { of: vec![Some(interval); self.names.len()], told: None };
        }
        let mut gaps = vec![Gaps::default(); self.names.len()];
        for track in &mut self.tracks {
            for (all, own) in gaps.iter_mut().zip(std::mem::take(&mut track.gaps)) {
                all.add(own);
            }
        }
        let found = intervals(&gaps);
        let nodes = self.names.len();
        let unknown = found.of.iter().filter(|interval| interval.is_none()).count();
        if let Some(told) = found.told {
            let span = |span: Duration| format!("{} s", instant::format_span(span));
            self.notes.push(format!(
                "the nodes send every {} (median; {} to {}), as the gaps between the packets of {} of {nodes} nodes tell \
                 (option `packet_interval` sets it)",
                span(told.median),
                span(told.shortest),
                span(told.longest),
                told.nodes
            ));
        }
        if unknown > 0 && !self.cover.is_empty() {
            self.notes.push(format!(
                "how often {unknown} of {nodes} nodes send cannot be told from the gaps between their packets: each stop counts \
                 as one packet of theirs, received if any was (option `packet_interval` sets the interval)"
            ));
        }
        found
    }
}

/// The median length of `slots`.
fn usual_stop<'a>(slots: impl Iterator<Item = &'a Slot>) -> Option<Duration> {
    let mut spans: Vec<Duration> = slots.map(|slot| slot.end.saturating_since(slot.start)).collect();
    median_by(&mut spans, Ord::cmp)
}
