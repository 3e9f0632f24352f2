//! A robot on its survey: it drives, stops, listens for a slot, and goes on, as its controller says. It may also listen
//! while it drives. In a network with sector sweeps it sweeps in the slot.

mod tally;

use std::time::Duration;

use sextant_channel::{Position, Reception};
use sextant_kernel::SimTime;

use super::controller::{CommandOutcome, Controller, Ending, Heard, RobotCommand, Situation};
use crate::application::{Application, DriveAhead, Driving, Port};
use crate::event::Timer;
use crate::service::delivery::{Delivery, DriveEnd};
use crate::service::network_id::NetworkId;
use crate::service::sweep::{SweepAnswer, SweepKind};
use crate::station::{Listening, RobotBody};
use tally::Tally;

/// Largest number of commands in a row that take no time; a controller that gives more is stuck.
const IDLE_COMMANDS: u32 = 1000;

/// The timer of the start.
const START: Timer = Timer(0);

/// The timer of the next sweep in the first network; those of the others follow.
const FIRST_SWEEP: u16 = 1;

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
    /// What it does in each of its networks.
    networks: Vec<Surveyed>,
    stops: usize,
    ending: Option<(Ending, SimTime)>,
}

/// What a robot does in one network.
struct Surveyed {
    network: NetworkId,
    tally: Tally,
    /// Sector sweeps that are still to be made in the slot, the one under way included.
    sweeps_left: u32,
    /// Whether the time to listen is not over.
    is_listening: bool,
}

/// What a survey leaves behind.
pub(crate) struct SurveyRecord {
    pub(crate) name: String,
    pub(crate) stops: usize,
    pub(crate) ending: Option<(Ending, SimTime)>,
    /// Number of packets of each node, in all networks.
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

impl Survey {
    pub(crate) fn new(robot: Robot, nodes: usize) -> Self {
        let surveyed = |&network| Surveyed { network, tally: Tally::new(nodes), sweeps_left: 0, is_listening: false };
        Self {
            controller: robot.controller,
            networks: robot.body.networks.iter().map(surveyed).collect(),
            body: robot.body,
            slot: None,
            drive_end: None,
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
        for number in 0..self.networks.len() {
            let surveyed = &mut self.networks[number];
            surveyed.is_listening = true;
            port.listen(surveyed.network, span);
            if port.has_sectors(surveyed.network) {
                surveyed.sweeps_left = self.body.sweeps_per_stop;
                self.sweep(number, port);
            }
        }
    }

    /// Begins the next sweep in a network.
    fn sweep(&mut self, number: usize, port: &mut Port<'_>) {
        let surveyed = &mut self.networks[number];
        if port.sweep(surveyed.network, SweepKind::Gather).is_err() {
            // A robot answers no sweeps, and its last one is over.
            surveyed.sweeps_left = 0;
        }
    }

    /// A sweep in a network is over: the next one begins when it is due, in equal intervals.
    fn sweep_on(&mut self, number: usize, port: &mut Port<'_>) {
        let Some(ListeningSlot { since, span, .. }) = self.slot else { return };
        let surveyed = &mut self.networks[number];
        surveyed.sweeps_left = surveyed.sweeps_left.saturating_sub(1);
        if surveyed.sweeps_left == 0 {
            self.end_slot(port);
            return;
        }
        let made = self.body.sweeps_per_stop - surveyed.sweeps_left;
        let due = since + span * made / self.body.sweeps_per_stop;
        let number = u16::try_from(number).expect("at most 256 networks");
        port.after(due.saturating_since(port.now()), Timer(FIRST_SWEEP + number));
    }

    /// Writes the stop, once nothing is under way in any network, and goes on.
    fn end_slot(&mut self, port: &mut Port<'_>) {
        if self.networks.iter().any(|surveyed| surveyed.is_listening || surveyed.sweeps_left > 0) {
            return;
        }
        let Some(ListeningSlot { since, span, place, during }) = self.slot.take() else { return };
        self.stops += 1;
        let mut heard: Vec<Heard> = Vec::new();
        for surveyed in &mut self.networks {
            let receptions = surveyed.tally.take();
            heard.extend(receptions.iter().map(heard_of));
            port.log_stop(surveyed.network, since, place, receptions);
        }
        if self.networks.len() > 1 {
            heard.sort_by_key(|heard| heard.node);
            heard.dedup_by(|later, earlier| later.node == earlier.node && earlier.add(later));
        }
        match during {
            During::Stop => self.decide(CommandOutcome::Listened(&heard), port),
            During::Drive => self.listen_on(span, port),
        }
    }

    /// The number of a network among those that the robot surveys.
    fn number(&self, network: NetworkId) -> Option<usize> {
        self.networks.iter().position(|surveyed| surveyed.network == network)
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

    pub(crate) fn into_record(self) -> SurveyRecord {
        let totals = self.networks.into_iter().map(|surveyed| surveyed.tally.total);
        let sum = |mut sum: Vec<u32>, total: Vec<u32>| {
            sum.iter_mut().zip(total).for_each(|(sum, packets)| *sum += packets);
            sum
        };
        let packets = totals.reduce(sum).unwrap_or_default();
        SurveyRecord { name: self.body.name, stops: self.stops, ending: self.ending, packets }
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

    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        if timer == START {
            port.tell_start();
            self.decide(CommandOutcome::Started, port);
        } else {
            self.sweep(usize::from(timer.0 - FIRST_SWEEP), port);
        }
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, port: &mut Port<'_>) {
        if let (Some(node), Some(number)) = (port.node(delivery.from), self.number(delivery.network)) {
            self.networks[number].tally.note(node, delivery.sequence, delivery.rssi);
        }
    }

    fn drive_ended(&mut self, end: DriveEnd, port: &mut Port<'_>) {
        if self.slot.is_some() {
            self.drive_end = Some(end);
        } else {
            self.decide(outcome_of(end), port);
        }
    }

    fn listened(&mut self, network: NetworkId, port: &mut Port<'_>) {
        if let Some(number) = self.number(network) {
            self.networks[number].is_listening = false;
            self.end_slot(port);
        }
    }

    fn swept(&mut self, network: NetworkId, answers: &[SweepAnswer], port: &mut Port<'_>) {
        if let Some(number) = self.number(network) {
            let of_nodes = answers.iter().filter_map(|&answer| Some((port.node(answer.from)?, answer)));
            self.networks[number].tally.note_sweep(of_nodes);
            self.sweep_on(number, port);
        }
    }
}

fn heard_of(reception: &Reception) -> Heard {
    let &Reception { node, received, sent, rssi_dbm, .. } = reception;
    Heard { node, packets: received, sent, rssi_dbm: rssi_dbm.unwrap_or(f64::NAN) }
}
