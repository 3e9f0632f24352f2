//! What the engine asks of the links of a network while it runs.

use std::ops::Range;
use std::time::Duration;

use sextant_kernel::{Rank, SimTime, StationId};

use super::books::Books;
use super::frame_buffer::FrameBuffer;
use super::ledger::Ledger;
use super::transmitter::Transmitter;
use crate::observer::Observer;
use crate::scene::Scene;
use crate::service::due_frames::DueFrames;
use crate::service::packet_trace::PacketEnd;
use crate::service::packets::Packets;
use crate::service::report::{Destination, FrameId, Payload, SendError};
use crate::service::sweep::{SweepAnswer, SweepError, SweepKind};

/// A place in the order of events.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cut {
    pub(crate) at: SimTime,
    pub(crate) rank: Rank,
}

impl Cut {
    /// Before the event under way.
    pub(crate) fn now(scene: &Scene) -> Self {
        Self { at: scene.now, rank: scene.event.rank() }
    }

    /// Before all events of an instant.
    pub(crate) fn before(at: SimTime) -> Self {
        Self { at, rank: Rank::new(0, StationId(0)) }
    }
}

/// How the links of a station end.
pub(crate) trait EndingLinks {
    /// The station is dead: its radio is off from now on, or from the end of the frame on air, and its packets end with it.
    fn turn_off(&mut self, station: StationId, scene: &mut Scene);

    /// The packets that the station still has when it dies, or at the end, are counted and traced.
    fn leave(&mut self, station: StationId, end: PacketEnd, scene: &mut Scene);
}

/// What the engine asks of the links of a network, that is of the protocol stacks of all its stations.
pub(crate) trait NetworkLinks: EndingLinks {
    /// An event of a station's link.
    type Event;

    /// Packets are traced from now on: called before the start.
    fn trace(&mut self);

    /// What became of the packets of its stations.
    fn ledger(&self) -> &Ledger;

    /// The same, to change it.
    fn ledger_mut(&mut self) -> &mut Ledger;

    /// The frame that was received last.
    fn frame(&mut self) -> &mut FrameBuffer;

    /// Counts and traces the packets that have not ended at the end of the simulation.
    fn leave_pending(&mut self, scene: &mut Scene) {
        let roll = scene.roll;
        roll.stations().for_each(|station| self.leave(station, PacketEnd::Pending, scene));
    }

    /// The network starts to work at a station.
    fn begin(&mut self, station: StationId, scene: &mut Scene);

    /// Starts what the network does by itself, after all stations.
    fn begin_schedule(&mut self, _scene: &mut Scene) {}

    /// Brings all stations to their states before `cut`. Returns when the last one changed; the start if none did.
    fn catch_up(&mut self, _cut: Cut, _scene: &mut Scene) -> SimTime {
        SimTime::ZERO
    }

    /// Packets count that are offered from this instant on.
    fn count_from(&mut self, instant: SimTime) {
        self.ledger_mut().counted_from = instant;
    }

    /// Energy counts from now on; without a definition, from the start.
    fn restart_meters(&mut self, _now: SimTime) {}

    /// Handles an event of a station's link.
    fn handle(&mut self, station: StationId, event: Self::Event, scene: &mut Scene, observer: &mut impl Observer);

    /// Takes a frame to send.
    ///
    /// # Errors
    /// If the station cannot send it.
    fn offer(
        &mut self,
        station: StationId,
        to: Destination,
        payload: Payload<'_>,
        scene: &mut Scene,
    ) -> Result<FrameId, SendError>;

    /// Leaves out frames that were due while a station rested.
    fn skip(&mut self, _station: StationId, _frames: u64) {}

    /// A station has chosen another one as its parent in a tree: its time comes from there, if its technology keeps a common time.
    fn take_time_from(&mut self, _station: StationId, _parent: StationId) {}

    /// The packets of a station go to this one from now on: links that agree on cells with it do so. Without a definition, they
    /// need not know.
    fn follow(&mut self, _station: StationId, _parent: Option<StationId>, _scene: &mut Scene) {}

    /// Notes which frames of a station were due, since packets are counted.
    fn note_due(&mut self, station: StationId, due: DueFrames) {
        self.ledger_mut().note_due(station, due);
    }

    /// Whether stations sweep sectors.
    fn sweeps_sectors(&self) -> bool {
        false
    }

    /// Whether antennas with sectors turn with the robots.
    fn turns_antennas(&self) -> bool {
        false
    }

    /// Number of sectors of the antenna of a station; `None` if it has none.
    fn sectors(&self, _station: StationId) -> Option<u8> {
        None
    }

    /// The radio of a station; `None` if the station is not in the network, or dead.
    fn transmitter(&self, station: StationId) -> Option<Transmitter>;

    /// Begins a sector sweep of a station.
    ///
    /// # Errors
    /// If it has no sectors, or is busy.
    fn sweep(&mut self, _station: StationId, _kind: SweepKind, _scene: &mut Scene) -> Result<(), SweepError> {
        Err(SweepError::NoSectors)
    }

    /// The answers to the sweep of a station that has just ended.
    fn take_answers(&mut self, _station: StationId) -> Vec<SweepAnswer> {
        Vec::new()
    }

    /// A station listens for `span` from now, instead of what is left of an earlier time to listen.
    fn listen(&mut self, station: StationId, span: Duration, scene: &mut Scene);

    /// Energy that the radio of a station has used since the start, or since its meter began anew (J).
    fn metered_j(&mut self, station: StationId, scene: &mut Scene) -> f64;

    /// A station dies. It may be told again, when the frame that was on air has ended.
    fn die(&mut self, station: StationId, scene: &mut Scene) {
        self.ledger_mut().die(station, scene.now);
        self.turn_off(station, scene);
    }

    /// Whether an event is the end of the frame that a station has on air.
    fn ends_frame(&self, station: StationId, event: Self::Event) -> bool;

    /// A station moves differently from now on.
    fn moves(&self, station: StationId, scene: &mut Scene);

    /// The frame that was received last, and where its payload is.
    fn take_payload(&mut self) -> (Vec<u8>, Range<usize>) {
        let frame = self.frame();
        (std::mem::take(&mut frame.octets), frame.payload.clone())
    }

    /// Gives the buffer of [`take_payload`](Self::take_payload) back.
    fn give_back(&mut self, frame: Vec<u8>) {
        self.frame().octets = frame;
    }

    /// What became of the packets of each station so far, but for those that are pending.
    fn packets(&self) -> &[Packets] {
        &self.ledger().packets
    }

    /// What the network leaves behind, by station.
    fn finish(self, now: SimTime) -> Books;
}
