//! How a robot gets the readings of the nodes around it: over the channel, or with ideal channel access.

use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::SimTime;
use sextant_sim::{Delivery, Destination, IdealReception, Payload, Port};

use super::super::field_estimate::Readings;
use super::super::message::SeekMessage;
use super::super::poll::Access;
use super::{LEAST_NODES, POLL, SeekRobot};
use crate::navigation::{HeardNode, Neighbourhood, Request};

/// Distance from which nodes answer, as a multiple of their spacing.
const REACH_SPACINGS: f64 = 5.5;
/// Time between two fixes of the place with ideal polls: that of polls over the channel.
const FIX_INTERVAL: Duration = Duration::from_secs(1);

impl SeekRobot {
    /// How far nodes that answer may be from the robot on the map (m).
    pub(super) fn reach_m(&self) -> f64 {
        self.settings.poll.reach_m.unwrap_or(REACH_SPACINGS * self.map.spacing_m())
    }

    /// The readings heard since then count in a mean at `now`.
    pub(super) fn counting_since(&self, now: SimTime) -> SimTime {
        match self.settings.poll.access {
            Access::Ideal => now,
            Access::Frames { interval, .. } => before(now, interval),
        }
    }

    /// Whether it has heard enough to begin.
    pub(super) fn has_heard_enough(&self) -> bool {
        let has_polled = match self.settings.poll.access {
            Access::Ideal => self.has_heard_all,
            Access::Frames { .. } => self.asking.polls() >= 2,
        };
        has_polled && self.readings.len() >= LEAST_NODES
    }

    /// Uses the answers of the last poll, and begins the next one. Nothing happens with ideal polls.
    pub(super) fn ask(&mut self, port: &mut Port<'_>) {
        let Access::Frames { interval, memory } = self.settings.poll.access else { return };
        let now = port.now();
        let odometry = port.pose().position;
        if let (Some(map), Some(then)) = (self.neighbourhood.centroid(), self.polled_at) {
            // Answers came all along the way since then.
            self.place.fix((then + odometry) * 0.5, map);
            self.centroid = Some(map);
        }
        let heard = std::mem::take(&mut self.neighbourhood);
        self.readings.forget_before(before(now, memory));
        self.polled_at = Some(odometry);
        let (place, radius_m) = (self.place_on_map(odometry), self.reach_m());
        let asked = self.asking.whom(self.map.frame(), place, radius_m, &heard);
        let request = Request { number: self.asking.next_poll(), window: interval, asked };
        let octets = SeekMessage::Request(request, self.settings.goal.field).to_octets();
        match port.send(self.network, Destination::All, Payload::Octets(&octets)) {
            Ok(_) => {
                self.record.polls += 1;
                self.record.octets += octets.len() as u64;
            }
            Err(_) => self.record.refused += 1,
        }
        port.listen(self.network, interval + interval / 4);
        port.after(interval, POLL);
    }

    /// A node has answered.
    pub(super) fn hear(&mut self, delivery: &Delivery<'_>, port: &Port<'_>) {
        let Ok(SeekMessage::Answer(answer, field, value)) = SeekMessage::read(delivery.payload) else { return };
        if delivery.network != self.network || field != self.settings.goal.field {
            return;
        }
        self.record.answers += 1;
        let heard = HeardNode {
            place: answer.place,
            gain: delivery.rssi - answer.tx_power,
            rssi: delivery.rssi,
            time: port.now(),
        };
        self.neighbourhood.hear(delivery.from, heard);
        self.readings.hear(delivery.from, heard, value);
    }

    /// With ideal polls: hears all nodes in range at once. Nothing happens with polls over the channel.
    pub(super) fn hear_all(&mut self, port: &mut Port<'_>) {
        if self.settings.poll.access != Access::Ideal {
            return;
        }
        let (now, odometry) = (port.now(), port.pose().position);
        let mut around = Neighbourhood::default();
        self.readings = Readings::default();
        self.has_heard_all = true;
        let here = self.place_on_map(odometry);
        for IdealReception { node, tx_power, rssi } in port.ideal_receptions(self.network) {
            let Some(place) = self.map.place(node) else { continue };
            let limit = here.zip(self.settings.poll.reach_m);
            if limit.is_some_and(|(here, reach_m)| self.axes().of(place - here).length_m() > reach_m) {
                continue;
            }
            let Some(value) = port.latest_sample(node, self.settings.goal.field) else {
                // At the start, not all nodes have taken a sample.
                self.has_heard_all = false;
                continue;
            };
            let heard = HeardNode { place, gain: rssi - tx_power, rssi, time: now };
            around.hear(node.into(), heard);
            self.readings.hear(node.into(), heard, value);
        }
        let is_due = self.fixed.is_none_or(|fixed| now.saturating_since(fixed) >= FIX_INTERVAL);
        if let (true, Some(map)) = (is_due, around.centroid()) {
            self.place.fix(odometry, map);
            self.centroid = Some(map);
            self.fixed = Some(now);
        }
    }

    /// Where it is on the map (m).
    pub(super) fn place_on_map(&self, odometry: Position) -> Option<Position> {
        self.place.to_map(odometry).or(self.centroid)
    }
}

/// The time so long before `now`; the start if there was none.
fn before(now: SimTime, span: Duration) -> SimTime {
    SimTime::ZERO + now.saturating_since(SimTime::ZERO).saturating_sub(span)
}
