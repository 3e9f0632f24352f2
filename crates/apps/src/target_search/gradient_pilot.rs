//! How a robot follows a pseudo-gradient.

use std::collections::BTreeMap;

use sextant_channel::Dbm;
use sextant_kernel::StationId;
use sextant_sim::TargetId;

use super::message::GradientMessage;

/// What a robot heard last of the pseudo-gradients of the nodes around it.
#[derive(Clone, Debug, Default)]
pub(super) struct GradientPilot {
    heard: BTreeMap<TargetId, BTreeMap<StationId, Heard>>,
}

#[derive(Clone, Copy, Debug)]
struct Heard {
    round: u16,
    value: f64,
    rssi: Dbm,
}

impl GradientPilot {
    /// A node sent its pseudo-gradient.
    pub(super) fn hear(&mut self, node: StationId, message: &GradientMessage, rssi: Dbm) {
        let heard = Heard { round: message.round, value: message.value, rssi };
        let of_target = self.heard.entry(message.target).or_default();
        // Only the latest round counts; the one before stays until the next one is under way.
        of_target.retain(|_, other| {
            message.round.wrapping_sub(other.round) <= 1 || other.round.wrapping_sub(message.round) <= 1
        });
        of_target.insert(node, heard);
    }

    /// The node to drive to: that with the least pseudo-gradient in the latest round, and among equal ones that with the
    /// largest power. `None` if no node was heard.
    pub(super) fn choose(&self, target: TargetId) -> Option<StationId> {
        let of_target = self.heard.get(&target)?;
        let latest = of_target
            .values()
            .map(|heard| heard.round)
            .reduce(|a, b| if b.wrapping_sub(a) <= u16::MAX / 2 { b } else { a })?;
        let in_round = of_target.iter().filter(|(_, heard)| heard.round == latest);
        let least = in_round.min_by(|(_, a), (_, b)| a.value.total_cmp(&b.value).then(b.rssi.0.total_cmp(&a.rssi.0)));
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
