//! A robot on its survey: it drives, stops, listens for a slot, and goes on, as its controller says. It may also listen
//! while it drives.

use std::time::Duration;

use sextant_channel::{Dbm, Position, Reception};
use sextant_kernel::{NodeId, SimTime};

use super::controller::{CommandOutcome, Controller, Ending, Heard, RobotCommand, Situation};
use crate::application::{Application, DriveAhead, Driving, Port};
use crate::event::Timer;
use crate::service::delivery::{Delivery, DriveEnd};
use crate::service::network_id::NetworkId;
use crate::station::{Listening, RobotBody};

/// Largest number of commands in a row that take no time; a controller that gives more is stuck.
const IDLE_COMMANDS: u32 = 1000;

/// The timer of the start.
const START: Timer = Timer(0);

/// A robot: a body and what drives it. A copy starts afresh from where this one is.
#[derive(Clone)]
pub struct Robot {
    /// The body.
    pub body: RobotBody,
    /// What drives it.
    pub controller: Box<dyn Controller>,
}

/// A robot on its survey.
pub(crate) struct Survey {
    controller: Box<dyn Controller>,
    body: RobotBody,
    /// The slot in which it listens.
    slot: Option<ListeningSlot>,
    /// How a drive ended whose last slot is not over.
    drive_end: Option<DriveEnd>,
    tally: Tally,
    stops: usize,
    ending: Option<(Ending, SimTime)>,
}

/// What a survey leaves behind.
pub(crate) struct Surveyed {
    pub(crate) name: String,
    pub(crate) stops: usize,
    pub(crate) ending: Option<(Ending, SimTime)>,
    /// Number of packets of each node.
    pub(crate) packets: Vec<u32>,
}

/// A slot in which a robot listens.
#[derive(Clone, Copy, Debug)]
struct ListeningSlot {
    since: SimTime,
    span: Duration,
    /// Where the robot believes to be in the middle of the slot (m).
    place: Position,
    during: During,
}

/// What a robot does while it listens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum During {
    Stop,
    Drive,
}

/// Packets heard in a slot, by node.
struct Tally {
    slot: Vec<Slot>,
    heard: Vec<NodeId>,
    /// Number of packets of all earlier slots.
    total: Vec<u32>,
}

/// Packets heard of one node in a slot.
#[derive(Clone, Copy, Debug, Default)]
struct Slot {
    packets: u32,
    /// Packets that the node sent from the first to the last one heard, by their sequence numbers.
    sent: u32,
    rssi_sum_dbm: f64,
    last_sequence: u8,
}

impl Survey {
    pub(crate) fn new(robot: Robot, nodes: usize) -> Self {
        Self {
            controller: robot.controller,
            body: robot.body,
            slot: None,
            drive_end: None,
            tally: Tally { slot: vec![Slot::default(); nodes], heard: Vec::new(), total: vec![0; nodes] },
            stops: 0,
            ending: None,
        }
    }

    fn decide(&mut self, outcome: CommandOutcome<'_>, port: &mut Port<'_>) {
        let mut outcome = outcome;
        for _ in 0..IDLE_COMMANDS {
            let command = {
                let (time, place, nodes) = (port.now(), port.pose().position, port.node_count());
                let sensors = port.range_sensors();
                let situation = Situation { time, position: place, outcome, node_count: nodes, sensors };
                self.controller.decide(&situation)
            };
            let driving = match command {
                RobotCommand::Drive(to) => port.drive(to),
                RobotCommand::DriveArc { length_m, turn_rad } => port.drive_arc(length_m, turn_rad),
                RobotCommand::Listen => return self.listen(self.body.listen, During::Stop, port),
                RobotCommand::Finish(ending) => return self.finish(ending, port),
            };
            match driving {
                Driving::UnderWay => return self.depart(port),
                Driving::Over(end) => outcome = outcome_of(end),
            }
        }
        self.finish(Ending::Stuck, port);
    }

    /// The robot drives now. No controller halts a drive, so what will happen on it is certain.
    fn depart(&mut self, port: &mut Port<'_>) {
        let Some(DriveAhead { end, contact }) = port.drive_ahead() else { return };
        if let Some(contact) = contact {
            port.log_contact(end, contact);
        }
        let span = end - port.now();
        if self.body.listening == Listening::AlsoWhileDriving
            && let Some(slot) = slot_span(span, self.body.listen)
        {
            self.listen(slot, During::Drive, port);
        }
    }

    fn listen(&mut self, span: Duration, during: During, port: &mut Port<'_>) {
        let since = port.now();
        let place = port.pose_at(since + span / 2).position;
        self.slot = Some(ListeningSlot { since, span, place, during });
        port.listen(self.body.network, span);
    }

    /// A slot on a drive is over: the next one begins if it ends before the drive does.
    fn listen_on(&mut self, span: Duration, port: &mut Port<'_>) {
        if let Some(end) = self.drive_end.take() {
            self.decide(outcome_of(end), port);
        } else if port.drive_ahead().is_some_and(|drive| port.now() + span <= drive.end) {
            self.listen(span, During::Drive, port);
        }
    }

    fn finish(&mut self, ending: Ending, port: &mut Port<'_>) {
        self.ending = Some((ending, port.now()));
        port.finish();
    }

    pub(crate) fn into_record(self) -> Surveyed {
        Surveyed { name: self.body.name, stops: self.stops, ending: self.ending, packets: self.tally.total }
    }
}

/// Length of the slots on a drive of `span`: as many equal ones as fit, each at least `least` long.
fn slot_span(span: Duration, least: Duration) -> Option<Duration> {
    let slots = u32::try_from(span.as_nanos() / least.as_nanos()).unwrap_or(u32::MAX);
    span.checked_div(slots)
}

fn outcome_of(end: DriveEnd) -> CommandOutcome<'static> {
    match end {
        DriveEnd::Arrived => CommandOutcome::Arrived,
        DriveEnd::Blocked(place) => CommandOutcome::Blocked(place),
    }
}

impl Application for Survey {
    fn hears(&self) -> bool {
        true
    }

    fn has_task(&self) -> bool {
        true
    }

    fn started(&mut self, port: &mut Port<'_>) {
        port.after(Duration::ZERO, START);
    }

    fn timed(&mut self, _timer: Timer, port: &mut Port<'_>) {
        port.tell_start();
        self.decide(CommandOutcome::Started, port);
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, port: &mut Port<'_>) {
        if let Some(node) = port.node(delivery.from) {
            self.tally.note(node, delivery.sequence, delivery.rssi);
        }
    }

    fn drive_ended(&mut self, end: DriveEnd, port: &mut Port<'_>) {
        if self.slot.is_some() {
            self.drive_end = Some(end);
        } else {
            self.decide(outcome_of(end), port);
        }
    }

    fn listened(&mut self, _network: NetworkId, port: &mut Port<'_>) {
        let Some(ListeningSlot { since, span, place, during }) = self.slot.take() else { return };
        self.stops += 1;
        let heard = self.tally.take();
        let reception = |heard: &Heard| Reception {
            node: heard.node,
            stop: 0,
            received: heard.packets,
            sent: heard.sent,
            sector: None,
            rssi_dbm: Some(heard.rssi_dbm),
            snr_db: None,
        };
        port.log_stop(since, place, heard.iter().map(reception).collect());
        match during {
            During::Stop => self.decide(CommandOutcome::Listened(&heard), port),
            During::Drive => self.listen_on(span, port),
        }
    }
}

impl Tally {
    /// Counts the packet `sequence` of `node`, which was received in this slot.
    fn note(&mut self, node: NodeId, sequence: u8, rssi: Dbm) {
        let slot = &mut self.slot[node.index()];
        if slot.packets == 0 {
            self.heard.push(node);
            slot.sent = 1;
        } else {
            // Sequence numbers are modulo 256: a gap of 256 packets or more looks shorter.
            slot.sent += u32::from(sequence.wrapping_sub(slot.last_sequence)).max(1);
        }
        slot.packets += 1;
        slot.rssi_sum_dbm += rssi.0;
        slot.last_sequence = sequence;
    }

    /// Returns what was heard, by node, and empties the tally.
    fn take(&mut self) -> Vec<Heard> {
        self.heard.sort_unstable();
        let heard = self.heard.drain(..).map(|node| {
            let Slot { packets, sent, rssi_sum_dbm, .. } = std::mem::take(&mut self.slot[node.index()]);
            self.total[node.index()] += packets;
            Heard { node, packets, sent, rssi_dbm: rssi_sum_dbm / f64::from(packets) }
        });
        heard.collect()
    }
}
