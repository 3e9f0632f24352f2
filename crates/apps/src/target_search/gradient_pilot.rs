//! How a robot follows a pseudo-gradient.

use std::collections::BTreeMap;

use sextant_channel::Dbm;
use sextant_kernel::{SimTime, StationId};
use sextant_sim::TargetId;

use super::message::GradientMessage;
use super::settings::PseudoGradient;

/// What a robot heard last of the pseudo-gradients of the nodes around it.
#[derive(Clone, Debug)]
pub(super) struct GradientPilot {
    method: PseudoGradient,
    heard: BTreeMap<TargetId, BTreeMap<StationId, HeardHops>>,
    /// The latest round that it heard of, and when it heard the first node of it.
    latest: Option<(u16, SimTime)>,
}

#[derive(Clone, Copy, Debug)]
struct HeardHops {
    round: u16,
    value: f64,
    detected: SimTime,
    rssi: Dbm,
}

impl GradientPilot {
    pub(super) fn new(method: PseudoGradient) -> Self {
        Self { method, heard: BTreeMap::new(), latest: None }
    }

    /// Whether the robot, which ended its step at `stepped`, still waits for a round that began since then: until the nodes
    /// have told it that are first to hear of it.
    pub(super) fn waits(&self, stepped: SimTime, now: SimTime) -> bool {
        let has_heard = |(round, heard): (u16, SimTime)| {
            self.method.began(round, now) >= stepped && now.saturating_since(heard) >= self.method.jitter
        };
        self.method.waits && !self.latest.is_some_and(has_heard)
    }

    /// A node sent its pseudo-gradient.
    pub(super) fn hear(&mut self, node: StationId, message: &GradientMessage, rssi: Dbm, now: SimTime) {
        let &GradientMessage { round, value, detected, .. } = message;
        if self.latest.is_none_or(|(latest, _)| is_later(round, latest)) {
            self.latest = Some((round, now));
        }
        let heard = HeardHops { round, value, detected, rssi };
        let of_target = self.heard.entry(message.target).or_default();
        // Only the latest round counts; the one before stays until the next one is under way.
        of_target.retain(|_, other| {
            message.round.wrapping_sub(other.round) <= 1 || other.round.wrapping_sub(message.round) <= 1
        });
        of_target.insert(node, heard);
    }

    /// The node to drive to: that with the least pseudo-gradient in the latest round. Among equal ones it is that with the
    /// newest detection, and then that with the largest power. `None` if no node was heard.
    pub(super) fn choose(&self, target: TargetId) -> Option<StationId> {
        let of_target = self.heard.get(&target)?;
        let latest = of_target.values().map(|heard| heard.round).reduce(|a, b| if is_later(b, a) { b } else { a })?;
        let in_round = of_target.iter().filter(|(_, heard)| heard.round == latest);
        let least = in_round.min_by(|(_, a), (_, b)| {
            let by_value = a.value.total_cmp(&b.value);
            by_value.then(b.detected.cmp(&a.detected)).then(b.rssi.0.total_cmp(&a.rssi.0))
        });
        least.map(|(&node, _)| node)
    }

    /// The targets of which it heard a pseudo-gradient.
    pub(super) fn targets(&self) -> impl Iterator<Item = TargetId> {
        self.heard.keys().copied()
    }

    /// The pseudo-gradient of a node as heard last.
    pub(super) fn value(&self, target: TargetId, node: StationId) -> Option<f64> {
        self.heard.get(&target)?.get(&node).map(|heard| heard.value)
    }
}

/// Whether round `a` began after round `b`. Their numbers begin again after 65535.
fn is_later(a: u16, b: u16) -> bool {
    a != b && a.wrapping_sub(b) <= u16::MAX / 2
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::super::config::GradientSources;
    use super::*;

    fn at(millis: u64) -> SimTime {
        SimTime::ZERO + Duration::from_millis(millis)
    }

    fn pilot() -> GradientPilot {
        GradientPilot::new(PseudoGradient {
            update: Duration::from_secs(2),
            jitter: Duration::from_millis(250),
            weakest: Dbm(-90.0),
            strongest: Dbm(-50.0),
            waits: true,
            sources: GradientSources::Detecting,
        })
    }

    fn message(round: u16, value: f64, detected: u64) -> GradientMessage {
        GradientMessage { round, target: TargetId(0), hops: 0, value, detected: at(detected) }
    }

    #[test]
    fn among_equal_nodes_it_drives_to_that_with_the_newest_detection_and_then_to_the_strongest() {
        let mut pilot = pilot();
        pilot.hear(StationId(1), &message(3, 0.0, 5000), Dbm(-60.0), at(6010));
        pilot.hear(StationId(2), &message(3, 0.0, 5500), Dbm(-80.0), at(6020));
        pilot.hear(StationId(3), &message(3, 0.4, 5900), Dbm(-55.0), at(6030));
        assert_eq!(pilot.choose(TargetId(0)), Some(StationId(2)));
        pilot.hear(StationId(4), &message(3, 0.0, 5500), Dbm(-70.0), at(6040));
        assert_eq!(pilot.choose(TargetId(0)), Some(StationId(4)));
    }

    #[test]
    fn it_waits_for_a_round_that_began_since_its_step_and_until_that_was_told() {
        let mut pilot = pilot();
        assert!(pilot.waits(at(5900), at(6000)), "nothing was heard");
        pilot.hear(StationId(1), &message(3, 1.0, 5000), Dbm(-60.0), at(6100));
        assert!(pilot.waits(at(5900), at(6200)), "other nodes have not told it yet");
        assert!(!pilot.waits(at(5900), at(6350)));
        assert!(pilot.waits(at(6001), at(6400)), "round 3 began at 6 s, before the step ended");
        pilot.hear(StationId(2), &message(4, 1.0, 7000), Dbm(-60.0), at(8100));
        // A late message of the round before does not count again.
        pilot.hear(StationId(1), &message(3, 1.0, 5000), Dbm(-60.0), at(8200));
        assert!(!pilot.waits(at(6001), at(8350)));
    }

    #[test]
    fn the_number_of_a_round_begins_again() {
        let method = pilot().method;
        let rounds = 3 * (1 << 16) + 5;
        let now = at(2000 * rounds + 300);
        assert_eq!(method.round_at(now), 5);
        assert_eq!(method.began(5, now), at(2000 * rounds));
        assert_eq!(method.began(4, now), at(2000 * (rounds - 1)));
        assert_eq!(method.began(u16::MAX, now), at(2000 * (rounds - 6)));
        assert!(is_later(2, u16::MAX) && !is_later(u16::MAX, 2) && !is_later(7, 7));
    }
}
