//! The application of a node that takes part in a map which the nodes compute themselves.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use sextant_channel::Position;
use sextant_kernel::SettingError;
use sextant_mapper::{Bearing, Estimate, RingOrientation, UnorientedRing};
use sextant_sim::{
    Application, Applications, Delivery, Destination, LeftOut, NetworkId, Payload, Port, ReadySimulation,
    SendOutcome, SendReport, Setup, Simulation, Timer,
};

use super::belief::Belief;
use super::config::{DistributedMapping, Exchange, Recompute};
use super::filtration::{Category, Scattering};
use super::message::{Beacon, Directions, Message};
use super::neighbours::{HeardBy, Neighbours};
use super::outbox::Outbox;
use super::patterns::Patterns;
use super::record::{MappingRecord, MappingRole};
use super::schedule::{BeaconWindow, Schedule};

/// The timer of the next window; those of the messages of a window follow.
const WINDOW: Timer = Timer(0);
/// The share of a window in which messages are sent: what waits for the channel then is still sent in it.
const SENDING_SHARE: f64 = 0.75;
/// Largest payload of a message (octets), with and without sectors: it fits in a frame.
const LARGEST_OCTETS: [usize; 2] = [900, 102];

/// An anchor with fewer bearings does not doubt its place.
const LEAST_BEARINGS: usize = 4;

/// The antenna of each node: one ring of equal sectors, all raised by the same unknown angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeAntenna {
    /// Sectors in the ring.
    pub sectors: u8,
    /// Width of a sector in elevation (rad).
    pub vertical_width_rad: f64,
}

/// A node that takes part in a map which the nodes compute themselves (Gunathillake 2018, chapter 5): an anchor, which
/// knows its place but not the directions of its sectors, or a node that works out its place from what it hears.
#[derive(Debug)]
pub struct MappingNode {
    settings: Arc<DistributedMapping>,
    network: NetworkId,
    antenna: Option<NodeAntenna>,
    schedule: Schedule,
    role: MappingRole,
    /// Where it is by its own knowledge.
    belief: Option<Belief>,
    estimate: Option<Estimate>,
    /// Whether it joins the anchors in this iteration.
    joins: bool,
    directions: Option<RingOrientation>,
    scattering: Scattering,
    category: Category,
    neighbours: Neighbours,
    /// Number of anchors and stops of mobile anchors in the evidence of the last estimate.
    evidence: usize,
    window: u32,
    outbox: Outbox,
    draws: u64,
    record: MappingRecord,
}

impl MappingNode {
    /// A node; an anchor if it knows its place. `antenna` is absent without sectors. `patterns` are those of the antennas, if
    /// strengths tell directions.
    #[must_use]
    pub fn new(
        settings: Arc<DistributedMapping>,
        network: NetworkId,
        antenna: Option<NodeAntenna>,
        patterns: Patterns,
        anchor: Option<Position>,
    ) -> Self {
        let schedule = settings.schedule(antenna.is_some());
        Self {
            settings,
            network,
            antenna,
            schedule,
            role: if anchor.is_some() { MappingRole::InitialAnchor } else { MappingRole::Node },
            belief: anchor.map(Belief::exact),
            estimate: None,
            joins: anchor.is_some(),
            directions: None,
            scattering: Scattering::default(),
            category: Category::Bad,
            neighbours: Neighbours::new(patterns),
            evidence: 0,
            window: 0,
            outbox: Outbox::default(),
            draws: 0,
            record: MappingRecord::default(),
        }
    }

    /// The simulation of these nodes, ready to run; it leaves a record of each behind.
    ///
    /// # Errors
    /// Those of [`Simulation::with`] and [`Simulation::with_region`].
    ///
    /// # Panics
    /// If there is not one for each node of `setup`.
    pub fn simulation(
        setup: Setup,
        nodes: Vec<Self>,
        left_out: LeftOut,
    ) -> Result<ReadySimulation<'static, Vec<MappingRecord>>, SettingError> {
        let simulation = Simulation::with(setup, Applications::of_nodes(nodes))?.without(left_out)?;
        Ok(simulation.ready(|own| own.nodes.into_iter().map(Self::into_record).collect()))
    }

    /// What the node has found, and what it took.
    #[must_use]
    pub fn into_record(self) -> MappingRecord {
        MappingRecord {
            role: self.role,
            place: self.belief.map(|belief| belief.place),
            estimate: self.estimate,
            directions: self.directions,
            scattering: self.scattering,
            category: self.category,
            anchors_heard: self.neighbours.anchors(),
            mobile_stops_heard: self.neighbours.mobile_sightings(),
            table_octets: self.neighbours.octets(),
            messages: self.outbox.sent(),
            ..self.record
        }
    }

    fn is_anchor(&self) -> bool {
        self.role != MappingRole::Node
    }

    /// A window begins: what the last one brought is used, and the messages of this one are made.
    fn begin(&mut self, port: &mut Port<'_>) {
        let (iteration, window) = self.schedule.at(self.window);
        self.outbox.begin_window();
        match window {
            BeaconWindow::Place => {
                self.filter(iteration, port);
                if let (true, Some(belief)) = (self.joins, self.belief) {
                    self.outbox.put(&Message::Place(belief));
                }
            }
            BeaconWindow::Report => {
                let heard = self.neighbours.asking(iteration);
                if let (true, Some(belief)) = (self.is_anchor(), self.belief) {
                    for report in Message::reports(belief, &heard, self.largest_octets()) {
                        self.outbox.put(&report);
                    }
                }
            }
            BeaconWindow::Beacon => {
                if !self.schedule.asks {
                    self.filter(iteration, port);
                }
                if let (true, Some(belief)) = (self.joins, self.belief) {
                    self.joins = false;
                    self.directions = self.antenna.and_then(|antenna| self.orientation(belief, antenna));
                    if self.is_doubtful() {
                        self.give_up(iteration);
                    } else {
                        self.put_beacons(belief, iteration);
                    }
                }
            }
            BeaconWindow::Coordinates => {
                if self.locate(iteration)
                    && let Some(belief) = self.belief
                {
                    self.outbox.put(&Message::Coordinates {
                        belief,
                        is_bad: iteration > 1 && self.category == Category::Bad,
                    });
                }
            }
            BeaconWindow::End => {
                self.locate(iteration);
                if !self.is_anchor() {
                    port.finish();
                }
                return;
            }
        }
        self.schedule_messages(port);
        self.window += 1;
        let next = self.schedule.start_of(self.window);
        port.after(next.saturating_since(port.now()), WINDOW);
    }

    /// Each message is sent at a random instant of each of as many parts of the window as it is sent times.
    fn schedule_messages(&mut self, port: &mut Port<'_>) {
        let span = self.settings.window.mul_f64(SENDING_SHARE);
        let repeats = self.settings.repeats;
        let part = span / repeats;
        for message in 0..self.outbox.in_window() {
            for repeat in 0..repeats {
                let at = part * repeat + part.mul_f64(port.uniform(self.draws));
                self.draws += 1;
                match timer_of(message, repeat, repeats) {
                    Some(timer) => drop(port.after(at, timer)),
                    None => self.record.unsent += 1,
                }
            }
        }
    }

    /// Sends the message that is due.
    fn send(&mut self, timer: Timer, port: &mut Port<'_>) {
        let repeats = usize::try_from(self.settings.repeats).expect("at most 100 repeats");
        let message = usize::from(timer.0 - 1) / repeats;
        let Some(octets) = self.outbox.octets(message) else { return };
        match port.send(self.network, Destination::All, Payload::Octets(octets)) {
            Ok(frame) => self.outbox.give(message, frame),
            Err(_) => self.record.unsent += 1,
        }
    }

    /// Compares the own place with those of the neighbours, and becomes an anchor if they agree.
    fn filter(&mut self, iteration: u32, port: &mut Port<'_>) {
        if iteration == 0 || self.is_anchor() {
            return;
        }
        let settings = &self.settings;
        self.scattering =
            Scattering::of(self.belief.map(|belief| belief.place), self.neighbours.places(), settings.range_m);
        let sigma_m = self.belief.as_ref().and_then(Belief::greatest_sigma_m);
        let most_m = settings.new_anchor_sigma_m.map(|most_m| most_m * f64::from(iteration).sqrt());
        let is_sure = most_m.is_none_or(|most_m| sigma_m.is_some_and(|sigma_m| sigma_m <= most_m));
        self.category = Category::of(self.scattering, settings.new_anchor_below, settings.bad_above, is_sure);
        if self.category == Category::NewAnchor {
            self.role = MappingRole::NewAnchor { iteration };
            self.joins = true;
            self.record.last_change = iteration;
        }
        let is_settled = match settings.recompute {
            Recompute::Bad => true,
            Recompute::All => self.is_anchor() || self.record.last_change < iteration,
        };
        if self.category != Category::Bad && is_settled {
            port.finish();
        }
    }

    /// Works out the own place from the anchors heard, if that is due; returns whether it has changed.
    fn locate(&mut self, iteration: u32) -> bool {
        let is_due = match self.settings.recompute {
            Recompute::Bad => self.category == Category::Bad,
            Recompute::All => true,
        };
        if self.is_anchor() || !is_due {
            return false;
        }
        let heard = self.neighbours.evidence();
        if heard.len() == self.evidence {
            return false;
        }
        self.evidence = heard.len();
        let Some(own) = self.settings.place.estimate(&heard, &self.neighbours.silent()) else { return false };
        self.record.vertices += own.vertices;
        self.record.grid_octets = self.record.grid_octets.max(own.peak_octets);
        self.record.violations = own.violations;
        let covariance = match self.settings.exchange {
            Exchange::Coordinates => None,
            Exchange::Posterior => own.estimate.covariance,
        };
        let belief = Belief { place: own.estimate.position, covariance };
        self.estimate = Some(own.estimate);
        let has_changed = self.belief != Some(belief);
        self.belief = Some(belief);
        if has_changed {
            self.record.last_change = iteration;
        }
        has_changed
    }

    /// How the antenna of this anchor is turned, by the reports of others.
    fn orientation(&self, belief: Belief, antenna: NodeAntenna) -> Option<RingOrientation> {
        let bearing = |&HeardBy { belief: Belief { place, covariance }, sector, bearing }: &HeardBy| Bearing {
            place,
            covariance,
            sector,
            of_strengths: bearing,
        };
        let bearings: Vec<Bearing> = self.neighbours.reports().map(bearing).collect();
        let Belief { place, covariance } = belief;
        let NodeAntenna { sectors, vertical_width_rad } = antenna;
        UnorientedRing { place, covariance, sectors, vertical_width_rad, bearings: &bearings }
            .orientation(self.settings.directions)
    }

    /// Whether the bearings contradict the place of this anchor.
    fn is_doubtful(&self) -> bool {
        let (Some(least), Some(found)) = (self.settings.doubt_below, self.directions) else { return false };
        found.bearings >= LEAST_BEARINGS && found.agreement() < least
    }

    /// This anchor does not trust its place: it is a node from now on that has none.
    fn give_up(&mut self, iteration: u32) {
        self.record.gave_up |= self.role == MappingRole::InitialAnchor;
        self.record.last_change = iteration;
        (self.role, self.category) = (MappingRole::Node, Category::Bad);
        (self.belief, self.estimate, self.directions) = (None, None, None);
        self.evidence = 0;
    }

    /// Adds what this anchor tells: a beacon, or as many as the places of the other anchors need.
    fn put_beacons(&mut self, belief: Belief, iteration: u32) {
        let directions =
            self.directions.as_ref().zip(self.antenna).map(|(found, antenna)| directions_of(found, antenna));
        let mut others: Vec<_> =
            if self.settings.passes_on { self.neighbours.asking_places(iteration).collect() } else { Vec::new() };
        loop {
            let mut beacon =
                Beacon { belief, directions: directions.clone(), earlier: Vec::new(), others: Vec::new() };
            let room = beacon.room_for_others(self.largest_octets());
            beacon.others = others.drain(..room.min(others.len())).collect();
            self.outbox.put(&Message::Beacon(beacon));
            if others.is_empty() {
                return;
            }
        }
    }

    fn largest_octets(&self) -> usize {
        LARGEST_OCTETS[usize::from(self.antenna.is_none())]
    }
}

/// The timer of a message and a repeat of it; `None` if there are more than timers have numbers.
fn timer_of(message: usize, repeat: u32, repeats: u32) -> Option<Timer> {
    let before = u64::try_from(message).ok()?.checked_mul(repeats.into())?;
    u16::try_from(before + u64::from(repeat) + 1).ok().map(Timer)
}

/// The directions of the sectors of an antenna whose ring is turned and raised like this. Where the elevation is known to
/// lie in an interval, they hold all elevations that the sectors may cover.
fn directions_of(found: &RingOrientation, antenna: NodeAntenna) -> Directions {
    let half_rad = 0.5 * antenna.vertical_width_rad.min(PI) + found.elevation_half_width_rad;
    let ring = [-half_rad, half_rad].map(|edge_rad| (found.elevation_rad + edge_rad).clamp(-FRAC_PI_2, FRAC_PI_2));
    Directions {
        azimuth_rad: found.azimuth_rad,
        azimuth_sigma_rad: found.azimuth_sigma_rad(),
        sectors: antenna.sectors,
        rings: vec![ring],
    }
}

impl Application for MappingNode {
    fn hears(&self) -> bool {
        true
    }

    fn has_task(&self) -> bool {
        !self.is_anchor()
    }

    fn started(&mut self, port: &mut Port<'_>) {
        let start = self.schedule.start_of(0);
        port.after(start.saturating_since(port.now()), WINDOW);
    }

    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        if timer == WINDOW {
            self.begin(port);
        } else {
            self.send(timer, port);
        }
    }

    fn sent(&mut self, network: NetworkId, report: &SendReport, _port: &mut Port<'_>) {
        if network != self.network {
            return;
        }
        let is_sent = report.outcome == SendOutcome::Sent;
        self.outbox.ended(report.frame, is_sent);
        *if is_sent { &mut self.record.sent } else { &mut self.record.unsent } += 1;
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, port: &mut Port<'_>) {
        if delivery.network != self.network {
            return;
        }
        self.record.frames_received += 1;
        let Ok(message) = Message::read(delivery.payload) else {
            self.record.frames_unread += 1;
            return;
        };
        let (iteration, _) = self.schedule.at(self.window.saturating_sub(1));
        let is_mobile = port.node(delivery.from).is_none();
        self.neighbours.hear(message, delivery, port.station(), iteration, is_mobile);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_have_timers_until_the_numbers_of_timers_end() {
        assert_eq!(timer_of(0, 0, 3), Some(Timer(1)));
        assert_eq!(timer_of(7, 2, 3), Some(Timer(24)));
        assert_eq!(timer_of(655, 34, 100), Some(Timer(u16::MAX)));
        assert_eq!(timer_of(655, 35, 100), None);
        assert_eq!(timer_of(usize::MAX, 0, 100), None);
    }
}
