//! The pseudo-gradient in a node.

use std::collections::BTreeMap;
use std::time::Duration;

use sextant_channel::Dbm;
use sextant_kernel::SimTime;
use sextant_sim::{Port, TargetId};

use super::config::GradientSources;
use super::message::{Detection, GradientMessage, Message};
use super::outbox::Outbox;
use super::settings::PseudoGradient;

/// Rounds by which a message may be behind the latest one of a node.
const OLDEST: u16 = u16::MAX / 2;

/// Works out the pseudo-gradient of each target in a node, round by round. A node that detects the target, or ever did, is
/// zero hops away ([`GradientSources`]). Any other node hears those of its neighbours for a while. Its hops are one more
/// than their least, and its pseudo-gradient is that number less the mean closeness of the neighbours with the least hops;
/// closeness is received power in decibels, from 0 at the sensitivity to 1 at the reference.
#[derive(Clone, Debug)]
pub(super) struct GradientNode {
    method: PseudoGradient,
    targets: BTreeMap<TargetId, Round>,
}

#[derive(Clone, Copy, Debug)]
struct Round {
    number: u16,
    /// Least hops among the neighbours, number of neighbours with that, and the sum of their closeness.
    least: u8,
    neighbours: u32,
    closeness: f64,
    /// When the newest of the detecting nodes behind these neighbours detected the target.
    detected: SimTime,
    /// Whether this node is zero hops away itself.
    is_source: bool,
    is_told: bool,
}

impl Round {
    /// What the node tells of itself: its hops and its pseudo-gradient.
    fn own(&self) -> (u8, f64) {
        if self.is_source {
            return (0, 0.0);
        }
        let hops = self.least.saturating_add(1);
        (hops, f64::from(hops) - self.closeness / f64::from(self.neighbours))
    }
}

impl GradientNode {
    pub(super) fn new(method: PseudoGradient) -> Self {
        Self { method, targets: BTreeMap::new() }
    }

    /// Time until the next round begins.
    pub(super) fn until_next_round(&self, now: SimTime) -> Duration {
        let update = self.method.update.as_nanos();
        let left = update - u128::from(now.as_nanos()) % update;
        Duration::from_nanos(u64::try_from(left).unwrap_or(u64::MAX))
    }

    /// A round begins: a node that detects a target, or did since the last round, says so at once. Returns the targets that it
    /// detected earlier, if they count: it says so later, because many nodes have to.
    pub(super) fn begin_round(
        &mut self,
        detections: &[Detection],
        outbox: &mut Outbox,
        port: &mut Port<'_>,
    ) -> Vec<TargetId> {
        let now = port.now();
        let number = self.method.round_at(now);
        let mut later = Vec::new();
        // The newest detection of a target counts.
        for detection in detections.iter().rev() {
            let since = detection.left.map_or(Duration::ZERO, |left| now.saturating_since(left));
            let Detection { target, entered: detected, .. } = *detection;
            let is_known = self.targets.get(&target).is_some_and(|round| round.number == number && round.is_source);
            let is_recent = since < self.method.update;
            if is_known || !(is_recent || self.method.sources == GradientSources::Detected) {
                continue;
            }
            let (least, neighbours, closeness, is_source, is_told) = (0, 0, 0.0, true, false);
            self.targets.insert(target, Round { number, least, neighbours, closeness, detected, is_source, is_told });
            if is_recent {
                self.pass_on(target, outbox, port);
            } else {
                later.push(target);
            }
        }
        later
    }

    /// How long a node hears others, or lets them tell, before it tells its own.
    pub(super) fn wait(&self, draw: f64) -> Duration {
        self.method.jitter.mul_f64(0.2 + 0.8 * draw)
    }

    /// The pseudo-gradient of a neighbour. Returns how long to wait before that of this node is told, if it is the first
    /// one of its round.
    pub(super) fn hear(&mut self, message: &GradientMessage, rssi: Dbm, draw: f64) -> Option<Duration> {
        let method = &self.method;
        let closeness = ((rssi - method.weakest).0 / (method.strongest - method.weakest).0).clamp(0.0, 0.999);
        let &GradientMessage { round: number, hops: least, detected, .. } = message;
        let fresh = Round { number, least, neighbours: 1, closeness, detected, is_source: false, is_told: false };
        match self.targets.get_mut(&message.target) {
            Some(round) if round.number == message.round => {
                if round.is_told || round.is_source {
                    return None;
                }
                if message.hops < round.least {
                    *round = fresh;
                } else if message.hops == round.least {
                    round.neighbours += 1;
                    round.closeness += closeness;
                    round.detected = round.detected.max(detected);
                }
                None
            }
            Some(round) if message.round.wrapping_sub(round.number) > OLDEST => None,
            _ => {
                self.targets.insert(message.target, fresh);
                Some(self.wait(draw))
            }
        }
    }

    /// Tells the pseudo-gradient of this node.
    pub(super) fn pass_on(&mut self, target: TargetId, outbox: &mut Outbox, port: &mut Port<'_>) {
        let Some(round) = self.targets.get_mut(&target).filter(|round| !round.is_told) else { return };
        round.is_told = true;
        let (hops, value) = round.own();
        let message = GradientMessage { round: round.number, target, hops, value, detected: round.detected };
        outbox.broadcast(&Message::Gradient(message), port);
    }
}
