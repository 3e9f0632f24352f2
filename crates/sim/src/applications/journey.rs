//! The way of a robot: it drives, stops, does for a slot what it is there for, and goes on, as its controller says. It
//! may also do that while it drives.

use std::collections::BTreeSet;
use std::time::Duration;

use sextant_channel::ReceptionLog;
use sextant_kernel::{RobotId, SimTime};

use super::broadcast::{Broadcast, Broadcasting};
use super::controller::{
    CommandOutcome, Controller, Ending, HeardNode, Identity, RobotCommand, Situation, StopsLeftOut,
};
use super::slot::Slot;
use super::survey::Survey;
use crate::application::{Application, DriveAhead, Driving, Port};
use crate::event::Timer;
use crate::service::delivery::{Delivery, DriveEnd};
use crate::service::network_id::NetworkId;
use crate::service::report::SendReport;
use crate::service::sweep::SweepAnswer;
use crate::station::{Listening, Pose, RobotBody};

/// Largest number of commands in a row that take no time; a controller that gives more is stuck.
const IDLE_COMMANDS: u32 = 1000;

/// The timer of the start.
const START: Timer = Timer(0);

/// A robot on its way.
pub(crate) struct Journey {
    controller: Box<dyn Controller>,
    body: RobotBody,
    work: Work,
    nodes: usize,
    /// The slot under way.
    slot: Option<(Slot, During)>,
    /// How a drive ended whose last slot is not over.
    drive_end: Option<DriveEnd>,
    stops: usize,
    ending: Option<(Ending, SimTime)>,
}

/// What a robot does in its slots.
enum Work {
    Survey(Survey),
    Broadcast(Broadcasting),
}

/// What a journey leaves behind.
pub(crate) struct JourneyRecord {
    pub(crate) stops: usize,
    pub(crate) ending: Option<(Ending, SimTime)>,
    /// Number of packets of each node, in all networks.
    pub(crate) packets: Vec<u32>,
    /// Stops of the planned path that were left out.
    pub(crate) left_out: StopsLeftOut,
}

impl JourneyRecord {
    /// That of a robot with an own application, among `nodes` nodes: what it wrote into the logs.
    pub(crate) fn in_logs(robot: RobotId, logs: &[ReceptionLog], nodes: usize) -> Self {
        let mut times = BTreeSet::new();
        let mut packets = vec![0_u32; nodes];
        for log in logs {
            let of_robot = |stop: u32| log.stops().get(stop as usize).is_some_and(|stop| stop.robot == robot);
            times.extend(log.stops().iter().filter(|stop| stop.robot == robot).map(|stop| stop.time));
            for reception in log.receptions().iter().filter(|reception| of_robot(reception.stop)) {
                packets[reception.node.index()] += reception.received;
            }
        }
        // Stops at the same time in several networks are one.
        Self { stops: times.len(), ending: None, packets, left_out: StopsLeftOut::default() }
    }
}

/// What a robot does during a slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum During {
    Stop,
    Drive,
}

impl Work {
    /// A slot begins; returns whether there is anything to do.
    fn begin(&mut self, slot: &Slot, port: &mut Port<'_>) -> bool {
        match self {
            Self::Survey(survey) => {
                survey.begin(slot, port);
                true
            }
            Self::Broadcast(broadcasting) => broadcasting.begin(slot, port),
        }
    }

    fn is_over(&self) -> bool {
        match self {
            Self::Survey(survey) => survey.is_over(),
            Self::Broadcast(broadcasting) => broadcasting.is_over(),
        }
    }

    /// The slot is over. Returns what was heard, by node.
    fn end(&mut self, slot: &Slot, port: &mut Port<'_>) -> Vec<HeardNode> {
        match self {
            Self::Survey(survey) => survey.end(slot, port),
            Self::Broadcast(_) => Vec::new(),
        }
    }
}

impl Journey {
    /// The way of a robot that surveys `nodes` nodes.
    pub(crate) fn of_survey(body: RobotBody, controller: Box<dyn Controller>, nodes: usize) -> Self {
        let work = Work::Survey(Survey::new(&body, nodes));
        Self::new(body, controller, work, nodes)
    }

    /// The way of a mobile anchor.
    pub(crate) fn of_mobile_anchor(
        body: RobotBody,
        controller: Box<dyn Controller>,
        broadcast: Box<dyn Broadcast>,
        nodes: usize,
    ) -> Self {
        let work = Work::Broadcast(Broadcasting::new(broadcast, &body));
        Self::new(body, controller, work, nodes)
    }

    fn new(body: RobotBody, controller: Box<dyn Controller>, work: Work, nodes: usize) -> Self {
        Self { controller, work, body, nodes, slot: None, drive_end: None, stops: 0, ending: None }
    }

    fn decide(&mut self, outcome: CommandOutcome<'_>, port: &mut Port<'_>) {
        let mut outcome = outcome;
        for _ in 0..IDLE_COMMANDS {
            let command = {
                let Pose { position, heading_rad } = port.pose();
                self.controller.decide(&Situation {
                    time: port.now(),
                    position,
                    heading_rad,
                    outcome,
                    node_count: port.node_count(),
                    sensors: port.range_sensors(),
                    identity: self.identity(port),
                })
            };
            let driving = match command {
                RobotCommand::Drive(to) => port.drive(to),
                RobotCommand::DriveArc { length_m, turn_rad } => port.drive_arc(length_m, turn_rad),
                RobotCommand::Listen => return self.begin_slot(self.body.listen, During::Stop, port),
                RobotCommand::Finish(ending) => return self.finish(ending, port),
            };
            match driving {
                Driving::UnderWay => return self.depart(port),
                Driving::Over(end) => outcome = outcome_of(end),
            }
        }
        self.finish(Ending::Stuck, port);
    }

    fn identity(&self, port: &Port<'_>) -> Identity {
        let sweeps_sectors = self.body.networks.iter().any(|&network| port.has_sectors(network));
        Identity { station: port.station(), seed: port.seed(), sweeps_sectors }
    }

    /// The robot drives now. No controller halts a drive, so what will happen on it is certain.
    fn depart(&mut self, port: &mut Port<'_>) {
        let Some(DriveAhead { end, contact }) = port.drive_ahead() else { return };
        if let Some(contact) = contact {
            port.log_contact(end, self.body.frame.of_world(contact));
        }
        let span = end - port.now();
        if self.body.listening == Listening::AlsoWhileDriving
            && let Some(slot) = slot_span(span, self.body.listen)
        {
            self.begin_slot(slot, During::Drive, port);
        }
    }

    fn begin_slot(&mut self, span: Duration, during: During, port: &mut Port<'_>) {
        let since = port.now();
        let slot = Slot { since, span, place: port.pose_at(since + span / 2).position };
        if self.work.begin(&slot, port) {
            self.slot = Some((slot, during));
        } else {
            port.halt();
            self.finish(Ending::Complete, port);
        }
    }

    /// Ends the slot, once its work is over, and goes on.
    fn end_slot(&mut self, port: &mut Port<'_>) {
        if !self.work.is_over() {
            return;
        }
        let Some((slot, during)) = self.slot.take() else { return };
        self.stops += 1;
        let heard = self.work.end(&slot, port);
        match during {
            During::Stop => self.decide(CommandOutcome::Listened(&heard), port),
            During::Drive => self.drive_on(slot.span, port),
        }
    }

    /// A slot on a drive is over: the next one begins if it ends before the drive does.
    fn drive_on(&mut self, span: Duration, port: &mut Port<'_>) {
        if let Some(end) = self.drive_end.take() {
            self.decide(outcome_of(end), port);
        } else if port.drive_ahead().is_some_and(|drive| port.now() + span <= drive.end) {
            self.begin_slot(span, During::Drive, port);
        }
    }

    fn finish(&mut self, ending: Ending, port: &mut Port<'_>) {
        self.ending = Some((ending, port.now()));
        port.finish();
    }

    pub(crate) fn into_record(self) -> JourneyRecord {
        let left_out = self.controller.left_out();
        let packets = match self.work {
            Work::Survey(survey) => survey.into_packets(),
            Work::Broadcast(_) => vec![0; self.nodes],
        };
        JourneyRecord { stops: self.stops, ending: self.ending, packets, left_out }
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

impl Application for Journey {
    fn hears(&self) -> bool {
        matches!(self.work, Work::Survey(_))
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
            return self.decide(CommandOutcome::Started, port);
        }
        let Some((slot, _)) = &self.slot else { return };
        match &mut self.work {
            Work::Survey(survey) => survey.timed(timer, slot, port),
            Work::Broadcast(broadcasting) => broadcasting.timed(timer, slot, port),
        }
        self.end_slot(port);
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, port: &mut Port<'_>) {
        if let Work::Survey(survey) = &mut self.work {
            survey.delivered(delivery, port);
        }
    }

    fn sent(&mut self, network: NetworkId, _report: &SendReport, port: &mut Port<'_>) {
        if let (Work::Broadcast(broadcasting), Some((slot, _))) = (&mut self.work, &self.slot) {
            broadcasting.sent(network, slot, port);
            self.end_slot(port);
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
        if let Work::Survey(survey) = &mut self.work {
            survey.listened(network);
            self.end_slot(port);
        }
    }

    fn swept(&mut self, network: NetworkId, answers: &[SweepAnswer], port: &mut Port<'_>) {
        if let (Work::Survey(survey), Some((slot, _))) = (&mut self.work, &self.slot) {
            survey.swept(network, answers, slot, port);
            self.end_slot(port);
        }
    }
}
