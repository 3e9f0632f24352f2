//! The engine: the only event loop.

pub(crate) mod bands;
mod dying;
mod ended;
mod interference;
mod running;
mod sensing;
mod setting_up;
mod snapshot;

use std::time::Duration;

use sextant_kernel::{SimTime, StationId};

use crate::air::Air;
use crate::application::{Application, Port};
use crate::event::Event;
use crate::faults::{Death, Faults};
use crate::halo::Halo;
use crate::link::Links;
use crate::link::books::Books;
use crate::link::links::Cut;
use crate::model::Model;
use crate::model::log::Logs;
use crate::observer::{Observer, Progress};
use crate::service::delivery::{Delivery, DriveEnd};
use crate::service::network_id::NetworkId;
use crate::service::sensed::Sensations;
use crate::service::upcall::Upcall;

use interference::Noise;
use running::Stage;

pub(crate) use ended::Ended;
pub(crate) use setting_up::Extras;

/// The engine: it runs once, to its end. `A` is the application of each station.
pub(crate) struct Engine<A> {
    model: Model,
    applications: Vec<A>,
    logs: Logs,
    stage: Stage,
    end: Option<SimTime>,
    noises: Vec<Noise>,
    /// What happens before it is not counted.
    warm_up: Duration,
    /// Whether the end comes when all tasks are done.
    ends_with_tasks: bool,
    events: u64,
    sensed: Sensations,
    faults: Faults,
    /// Whether each station has died; empty as long as none has.
    dead: Vec<bool>,
    deaths: Vec<Death>,
}

impl<A: Application> Engine<A> {
    /// The same, with a start that is left out of the counts: packets that are offered before the end of the warm-up, and
    /// the energy that radios use until then. Sector sweeps all count.
    #[must_use]
    pub(crate) fn with_warm_up(self, warm_up: Duration) -> Self {
        Self { warm_up, ..self }
    }

    /// The same, where nodes beyond all halos of `radius_m` round the listeners rest.
    #[must_use]
    pub(crate) fn with_halo(mut self, radius_m: f64) -> Self {
        let roll = self.model.scene.roll;
        let places = self.model.world.nodes.iter().map(|node| node.position);
        let hears = |station: StationId| !roll.is_node(station) && self.applications[station.index()].hears();
        self.model.halo = Some(Halo::new(radius_m, places, roll.stations().map(hears).collect()));
        if roll.robots > 1 {
            // Robots far away may be simulated apart.
            self.model.scene.airs.iter_mut().for_each(|air| air.limit_hearing(radius_m));
        }
        self
    }

    /// How far nodes that do not rest may be from a listener (m); `None` if all are simulated.
    pub(crate) fn halo_reach_m(&self) -> Option<f64> {
        self.model.halo.as_ref().map(Halo::reach_m)
    }

    fn progress(&self) -> Progress {
        Progress {
            time: self.model.scene.now,
            stops: self.logs.stops(),
            nodes_heard: self.logs.nodes_heard,
            nodes: self.model.scene.roll.nodes,
            packets_offered: self.model.scene.offered,
        }
    }

    fn begin(&mut self, observer: &mut impl Observer) {
        if observer.wants_packets() {
            self.model.networks.iter_mut().for_each(Links::trace);
            self.model.scene.airs.iter_mut().for_each(Air::keep_history);
        }
        if !self.warm_up.is_zero() {
            let counted_from = SimTime::ZERO + self.warm_up;
            self.model.scene.counted_from = counted_from;
            self.model.networks.iter_mut().for_each(|network| network.count_from(counted_from));
            self.model.scene.at(counted_from, Event::WarmedUp);
        }
        self.model.begin_ways();
        self.model.draw_halos();
        for station in self.model.scene.roll.stations() {
            for network in &mut self.model.networks {
                network.begin(station, &mut self.model.scene);
            }
            let mut port = Port { model: &mut self.model, station };
            self.applications[station.index()].started(&mut port);
        }
        for network in &mut self.model.networks {
            network.begin_schedule(&mut self.model.scene);
        }
        for (number, noise) in (0..).zip(&mut self.noises) {
            noise.schedule(number, &mut self.model.scene);
        }
        self.model.sensing.begin(&mut self.model.scene);
        self.schedule_deaths();
        self.look_at_batteries();
        self.model.tell(&mut self.logs, observer);
        self.model.tell_packets(observer);
    }

    /// Handles an event; returns whether the simulation goes on.
    #[inline]
    fn handle(&mut self, event: Event, observer: &mut impl Observer) -> bool {
        match event {
            Event::Link(station, network, event) => {
                self.model.networks[network.index()].handle(station, event, &mut self.model.scene, observer);
                if !self.model.scene.upcalls.is_empty() {
                    self.pass_on(network);
                }
                if self.is_dead(station) {
                    // The frame that was on air has ended.
                    self.model.networks[network.index()].die(station, &mut self.model.scene);
                }
            }
            Event::Timer(station, timer) => {
                let mut port = Port { model: &mut self.model, station };
                self.applications[station.index()].timed(timer, &mut port);
            }
            Event::ArcPartDriven(station) => self.model.pass(station),
            Event::HaloDue(station) => {
                // Nothing happens in the world.
                self.model.scene.discounted += 1;
                self.model.draw_halo(station);
            }
            Event::DriveEnded(station) => {
                let end = self.model.arrive(station).map_or(DriveEnd::Arrived, DriveEnd::Blocked);
                let mut port = Port { model: &mut self.model, station };
                self.applications[station.index()].drive_ended(end, &mut port);
            }
            Event::NodeTurned(station) => self.model.turn_node(station),
            Event::TargetTurned(target) => self.turn(target, observer),
            Event::TargetEntered(station, target) => self.enter(station, target, observer),
            Event::TargetLeft(station, target) => self.leave(station, target, observer),
            Event::TargetMissed(_, target) => self.miss(target),
            Event::FalseAlarmRaised(station) => self.raise_false_alarm(station, observer),
            Event::FalseAlarmEnded(station, target) => self.end_false_alarm(station, target, observer),
            Event::SampleDue(station) => self.sample(station, observer),
            Event::Died(station) => self.die(station),
            Event::BatteryDue(station) => self.look_at_battery(station),
            Event::NoiseStarted(number) => {
                self.noises[usize::from(number)].start(number, &mut self.model.scene);
            }
            Event::NoiseEnded(number) => self.noises[usize::from(number)].end(number, &mut self.model.scene),
            Event::WarmedUp => {
                self.catch_up(Cut::now(&self.model.scene));
                self.restart_meters();
            }
        }
        self.wake();
        let stopped = !self.model.notes.is_empty() && self.model.tell(&mut self.logs, observer);
        if !self.model.scene.traced.is_empty() {
            self.model.tell_packets(observer);
        }
        !stopped || observer.goes_on(self.progress())
    }

    /// Tells the applications what the link of a network has to say.
    fn pass_on(&mut self, network: NetworkId) {
        if let [Upcall::Sent { station, report }] = self.model.scene.upcalls[..] {
            // The most frequent case, without a frame.
            self.model.scene.upcalls.clear();
            if self.is_dead(station) {
                return;
            }
            let mut port = Port { model: &mut self.model, station };
            self.applications[station.index()].sent(network, &report, &mut port);
            return;
        }
        let mut upcalls = std::mem::take(&mut self.model.scene.upcalls);
        let (frame, payload) = self.model.networks[network.index()].take_payload();
        for upcall in upcalls.drain(..) {
            let station = upcall.station();
            if self.is_dead(station) {
                continue;
            }
            let mut port = Port { model: &mut self.model, station };
            let application = &mut self.applications[station.index()];
            match upcall {
                Upcall::Delivered { from, sequence, power, sector, snr, .. } => {
                    let payload = &frame[payload.clone()];
                    let rssi = power.to_dbm();
                    let delivery = Delivery { network, from, sequence, payload, rssi, sector, snr };
                    application.delivered(&delivery, &mut port);
                }
                Upcall::Sent { report, .. } => application.sent(network, &report, &mut port),
                Upcall::Listened { .. } => application.listened(network, &mut port),
                Upcall::Swept { .. } => {
                    let answers = port.model.networks[network.index()].take_answers(station);
                    application.swept(network, &answers, &mut port);
                }
                Upcall::Radio { news, .. } => {
                    application.radio(network, &news.event(network, &frame[payload.clone()]), &mut port);
                }
                Upcall::Announced { announcement, .. } => application.announced(&announcement, &mut port),
            }
        }
        self.model.networks[network.index()].give_back(frame);
        // No command of an application makes a link speak at once.
        debug_assert!(self.model.scene.upcalls.is_empty());
        self.model.scene.upcalls = upcalls;
    }

    /// Wakes the nodes that have come into a halo.
    #[inline]
    fn wake(&mut self) {
        let Some(halo) = self.model.halo.as_mut().filter(|halo| halo.has_reached()) else { return };
        let mut reached = halo.take_reached();
        for station in reached.drain(..) {
            if !self.is_dead(station) {
                self.applications[station.index()].woken(&mut Port { model: &mut self.model, station });
            }
        }
        if let Some(halo) = &mut self.model.halo {
            halo.give_back(reached);
        }
    }

    fn finish(mut self) -> Ended<A> {
        let interrupted = self.is_interrupted();
        let now = self.model.scene.now;
        let halo_m = self.model.halo.as_ref().map(Halo::radius_m);
        if halo_m.is_some() {
            for station in self.model.scene.roll.stations() {
                self.applications[station.index()].ended(&mut Port { model: &mut self.model, station });
            }
        }
        let end_poses = (0..self.model.vehicles.len()).map(|robot| self.pose_at(now, robot)).collect();
        let Model { scene, networks, world, vehicles, batteries, .. } = self.model;
        let events = self.events + scene.steps - scene.discounted;
        let networks: Vec<Books> = networks.into_iter().map(|network| network.finish(now)).collect();
        let batteries = batteries.map(|bank| dying::close_batteries(bank, &networks, now)).unwrap_or_default();
        // The logs are built last, because that takes as much memory again as they have.
        drop(scene);
        let names: Vec<String> = world.nodes.into_iter().map(|node| node.name).collect();
        let robots: Vec<String> = vehicles.iter().map(|vehicle| vehicle.body.name.clone()).collect();
        Ended {
            applications: self.applications,
            logs: self.logs.build(&names, &robots),
            path_lengths_m: vehicles.iter().map(|vehicle| vehicle.path_length_m).collect(),
            end_poses,
            networks,
            end: now,
            events,
            sensed: self.sensed,
            deaths: self.deaths,
            batteries,
            interrupted,
            halo_m,
        }
    }
}
