//! What a mobile anchor does in a slot: it sends a message to all that hear it.

use sextant_kernel::SimTime;

use super::slot::Slot;
use crate::application::Port;
use crate::event::Timer;
use crate::service::network_id::NetworkId;
use crate::service::report::{Destination, Payload, SendError};
use crate::station::{Pose, RobotBody};

/// The timer of the next frame in the first network; those of the others follow.
const FIRST_FRAME: u16 = 1;

/// The timer of the end of the slot.
const SLOT_OVER: Timer = Timer(u16::MAX);

/// What a robot sends to all at each stop, instead of surveying: the robot is a mobile anchor.
pub trait Broadcast: DuplicateBroadcast + Send + Sync {
    /// The message of the stop that begins `now`, at the `pose` that the robot believes to have; `None` ends its
    /// task. In a slot on a drive, the pose is that of the mean instant of sending. It is asked once for each stop, and
    /// the message is sent as often as the body says, in equal intervals. The message must fit into a frame of each of
    /// the robot's networks.
    fn message(&mut self, pose: &Pose, now: SimTime) -> Option<Vec<u8>>;
}

/// Copies a boxed broadcast, so that a robot can start afresh. Implemented for every broadcast that is `Clone`.
pub trait DuplicateBroadcast {
    /// A broadcast in the same state.
    fn duplicate(&self) -> Box<dyn Broadcast>;
}

impl<B: Broadcast + Clone + 'static> DuplicateBroadcast for B {
    fn duplicate(&self) -> Box<dyn Broadcast> {
        Box::new(self.clone())
    }
}

impl Clone for Box<dyn Broadcast> {
    fn clone(&self) -> Self {
        self.as_ref().duplicate()
    }
}

/// What a mobile anchor does in a slot.
pub(super) struct Broadcasting {
    broadcast: Box<dyn Broadcast>,
    message: Vec<u8>,
    /// Its networks, each with the number of frames that are still to end in the slot.
    networks: Vec<(NetworkId, u32)>,
    /// Number of times that it sends the message in a slot.
    repeats: u32,
    /// Whether the time of the slot is not over.
    is_resting: bool,
}

impl Broadcasting {
    pub(super) fn new(broadcast: Box<dyn Broadcast>, body: &RobotBody) -> Self {
        let networks = body.networks.iter().map(|&network| (network, 0)).collect();
        Self { broadcast, message: Vec::new(), networks, repeats: body.sweeps_per_stop, is_resting: false }
    }

    /// The slot begins; returns whether there is a message to send.
    pub(super) fn begin(&mut self, slot: &Slot, port: &mut Port<'_>) -> bool {
        let mean = slot.due(self.repeats - 1, 2 * self.repeats);
        let Some(message) = self.broadcast.message(&port.pose_at(mean), port.now()) else { return false };
        self.message = message;
        self.is_resting = true;
        port.after(slot.span, SLOT_OVER);
        for number in 0..self.networks.len() {
            self.networks[number].1 = self.repeats;
            self.send(number, slot, port);
        }
        true
    }

    fn send(&mut self, number: usize, slot: &Slot, port: &mut Port<'_>) {
        let network = self.networks[number].0;
        match port.send(network, Destination::All, Payload::Octets(&self.message)) {
            Ok(_) => {}
            Err(error @ SendError::Oversized { .. }) => panic!("the message of a mobile anchor: {error}"),
            // The link counts what it does not take.
            Err(_) => self.sent(network, slot, port),
        }
    }

    pub(super) fn timed(&mut self, timer: Timer, slot: &Slot, port: &mut Port<'_>) {
        match timer {
            SLOT_OVER => self.is_resting = false,
            Timer(number) => self.send(usize::from(number - FIRST_FRAME), slot, port),
        }
    }

    /// The message has left the link of a network: it is sent again when it is due.
    pub(super) fn sent(&mut self, network: NetworkId, slot: &Slot, port: &mut Port<'_>) {
        let Some(number) = self.networks.iter().position(|&(of, _)| of == network) else { return };
        let left = &mut self.networks[number].1;
        *left = left.saturating_sub(1);
        if *left > 0 {
            let due = slot.due(self.repeats - *left, self.repeats);
            let number = u16::try_from(number).expect("at most 256 networks");
            port.after(due.saturating_since(port.now()), Timer(FIRST_FRAME + number));
        }
    }

    /// Whether the time of the slot is over and the message has left all links.
    pub(super) fn is_over(&self) -> bool {
        !self.is_resting && self.networks.iter().all(|&(_, left)| left == 0)
    }
}
