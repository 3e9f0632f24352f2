//! The application of a node.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use sextant_channel::{Dbm, Position};
use sextant_kernel::{SimTime, StationId};
use sextant_sim::{
    Application, Delivery, FrameId, NetworkId, Port, SendOutcome, SendReport, Sensed, TargetId, Timer,
};

use super::gradient_node::GradientNode;
use super::message::{Detection, FirstDetection, Message};
use super::outbox::{MessageCounts, Outbox};
use super::reports::HOLDS;
use super::route::Route;
use super::settings::{Method, TargetSearch};
use crate::navigation::{Answer, Flood, FloodKey, Request, WaitingAnswers};

/// The timer of the next round of pseudo-gradients.
const ROUND: Timer = Timer(1);
/// The timer of the next attempt to tell the sink.
const RETRY: Timer = Timer(2);
/// The first of the timers of answers.
const FIRST_ANSWER: u16 = 100;
/// The timers of messages to pass on.
const FIRST_FLOOD: u16 = 1000;
const FLOODS: u16 = 64;
/// The timers of pseudo-gradients to pass on, one for each target.
const FIRST_GRADIENT: u16 = 2000;

/// Longest time that a node waits before it passes a message on, and the copies after which it does not.
pub(super) const FLOOD_JITTER: Duration = Duration::from_millis(150);
pub(super) const ENOUGH_COPIES: u32 = 4;

/// Mean time between two attempts to tell the sink.
const RETRY_INTERVAL: Duration = Duration::from_millis(500);

/// Share of the window of a poll in which nodes begin to send: what waits for the channel then still comes in it.
const SENDING_SHARE: f64 = 0.8;

/// A node: it keeps the times at which it detected targets, answers robots, and passes messages on.
#[derive(Debug)]
pub struct SearchNode {
    settings: Arc<TargetSearch>,
    /// Its place on the map; a node that is not on the map only passes messages on.
    place: Option<Position>,
    tx_power: Dbm,
    detections: Vec<Detection>,
    /// Changes with each detection.
    version: u32,
    /// The version that each robot knows.
    told: BTreeMap<StationId, u32>,
    /// Answers under way, with the version that they tell.
    answering: Vec<(FrameId, StationId, u32)>,
    /// Answers that wait for their instants.
    asked: WaitingAnswers<(StationId, Request)>,
    /// The targets that the robots know of, and since when.
    known: BTreeMap<TargetId, SimTime>,
    route: Route,
    /// Whether an attempt to tell the sink is due later.
    retries: bool,
    flood: Flood,
    gradients: Option<GradientNode>,
    outbox: Outbox,
    draws: u64,
}

/// What a node leaves behind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NodeSearchRecord {
    /// What it sent.
    pub sent: MessageCounts,
    /// Times that no node on the way to the sink acknowledged a message; it was sent again later.
    pub failures: u64,
}

impl SearchNode {
    /// A node at `place` on the map that sends with `tx_power`.
    #[must_use]
    pub fn new(settings: Arc<TargetSearch>, network: NetworkId, place: Option<Position>, tx_power: Dbm) -> Self {
        let gradients = match &settings.method {
            Method::PseudoGradient(method) => Some(GradientNode::new(method.clone())),
            Method::Detarsk(_) => None,
        };
        Self {
            settings,
            place,
            tx_power,
            detections: Vec::new(),
            version: 0,
            told: BTreeMap::new(),
            answering: Vec::new(),
            asked: WaitingAnswers::new(FIRST_ANSWER, SENDING_SHARE),
            known: BTreeMap::new(),
            route: Route::default(),
            retries: false,
            flood: Flood::new(FLOOD_JITTER, ENOUGH_COPIES, FIRST_FLOOD, FLOODS),
            gradients,
            outbox: Outbox::new(network),
            draws: 0,
        }
    }

    /// What it leaves behind.
    #[must_use]
    pub fn into_record(self) -> NodeSearchRecord {
        NodeSearchRecord { sent: self.outbox.counts, failures: self.route.failures() }
    }

    fn draw(&mut self, port: &Port<'_>) -> f64 {
        self.draws += 1;
        port.uniform(self.draws)
    }

    /// A robot asks: the node answers later in the window if it is near, or has something new to tell.
    fn ask(&mut self, delivery: &Delivery<'_>, request: Request, port: &mut Port<'_>) {
        let &Delivery { from: robot, rssi, .. } = delivery;
        let Some(place) = self.place else { return };
        let has_news = self.settings.tells_all() && self.told.get(&robot).copied().unwrap_or(0) < self.version;
        if !request.concerns(place, rssi) && !has_news {
            return;
        }
        let draw = self.draw(port);
        self.asked.wait(&request, (robot, request), draw, port);
    }

    fn answer(&mut self, robot: StationId, request: Request, port: &mut Port<'_>) {
        let Some(place) = self.place else { return };
        let news = if self.told.get(&robot).copied().unwrap_or(0) < self.version { self.detections.len() } else { 0 };
        let first = self.detections.len() - news.min(Message::MOST_DETECTIONS);
        let detections = if news == 0 { Vec::new() } else { self.detections[first..].to_vec() };
        let answer = Answer { number: request.number, place, tx_power: self.tx_power };
        if let Some(frame) = self.outbox.unicast(&Message::Answer(answer, detections), robot, port) {
            self.answering.push((frame, robot, self.version));
        }
    }

    /// A target is here that nobody knows, as far as this node was told.
    fn report(&mut self, target: TargetId, port: &mut Port<'_>) {
        if self.is_known(target, port.now()) {
            return;
        }
        let (Some(place), Some(node)) = (self.place, port.node(port.station())) else { return };
        let detection = FirstDetection { node: StationId(node.0), target, time: port.now(), place };
        self.forward(detection, port);
    }

    /// Whether the robots know of a target. Where detections are doubted, the target may be elsewhere after a while.
    fn is_known(&self, target: TargetId, now: SimTime) -> bool {
        let holds = |told: &SimTime| self.settings.doubt().is_none() || now.saturating_since(*told) < HOLDS;
        self.known.get(&target).is_some_and(holds)
    }

    /// Sends a message to the sink, or lets it wait for a better moment.
    fn forward(&mut self, detection: FirstDetection, port: &mut Port<'_>) {
        self.route.forward(detection, &mut self.outbox, port);
        self.retry_later(port);
    }

    fn retry_later(&mut self, port: &mut Port<'_>) {
        if self.route.is_waiting() && !self.retries {
            self.retries = true;
            let wait = RETRY_INTERVAL.mul_f64(0.5 + self.draw(port));
            port.after(wait, RETRY);
        }
    }

    fn entered(&mut self, target: TargetId, port: &mut Port<'_>) {
        self.detections.push(Detection { target, entered: port.now(), left: None });
        self.version += 1;
        self.report(target, port);
    }

    fn left(&mut self, target: TargetId, now: SimTime) {
        if let Some(open) = self.detections.iter_mut().rev().find(|detection| detection.target == target) {
            open.left = Some(now);
            self.version += 1;
        }
    }
}

impl Application for SearchNode {
    fn hears(&self) -> bool {
        true
    }

    fn senses(&self) -> bool {
        true
    }

    fn started(&mut self, port: &mut Port<'_>) {
        if let Some(gradients) = &self.gradients {
            port.after(gradients.until_next_round(port.now()), ROUND);
        }
    }

    fn sensed(&mut self, sensed: &Sensed, port: &mut Port<'_>) {
        match *sensed {
            Sensed::Entered(target) => self.entered(target, port),
            Sensed::Left(target) => self.left(target, port.now()),
            Sensed::Sampled { .. } => {}
        }
    }

    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        if timer == ROUND {
            let Some(gradients) = &mut self.gradients else { return };
            let later = gradients.begin_round(&self.detections, &mut self.outbox, port);
            port.after(gradients.until_next_round(port.now()), ROUND);
            for target in later {
                let draw = self.draw(port);
                let Some(gradients) = &self.gradients else { return };
                port.after(gradients.wait(draw), Timer(FIRST_GRADIENT + target.0));
            }
        } else if timer == RETRY {
            self.retries = false;
            self.route.forward_waiting(&mut self.outbox, port);
            self.retry_later(port);
        } else if let Some((robot, request)) = self.asked.due(timer) {
            self.answer(robot, request, port);
        } else if let Some((_, octets)) = self.flood.due(timer) {
            let Ok(message) = Message::read(&octets) else { return };
            let message = match message {
                Message::Tree { key, .. } => Message::Tree { key, hops: self.route.hops() },
                other => other,
            };
            self.outbox.broadcast(&message, port);
        } else if let (Some(target), Some(gradients)) = (timer.0.checked_sub(FIRST_GRADIENT), &mut self.gradients) {
            gradients.pass_on(TargetId(target), &mut self.outbox, port);
        }
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, port: &mut Port<'_>) {
        let Ok(message) = Message::read(delivery.payload) else { return };
        let flooded: Option<FloodKey> = match &message {
            Message::Request(request) => {
                self.ask(delivery, *request, port);
                None
            }
            Message::Detection(detection) => {
                self.forward(*detection, port);
                None
            }
            Message::Tree { key, hops } => {
                self.route.learn(delivery.from, *hops, delivery.rssi);
                Some(*key)
            }
            Message::Alarm { key, target, nodes, .. } => {
                let doubt = self.settings.doubt();
                if doubt.is_none_or(|doubt| nodes.is_none_or(|nodes| nodes >= doubt.confirming())) {
                    self.known.insert(*target, port.now());
                    self.route.forget(*target);
                }
                Some(*key)
            }
            Message::Claim { key, .. } => Some(*key),
            Message::Gradient(gradient) => {
                let draw = self.draw(port);
                if let Some(gradients) = &mut self.gradients
                    && let Some(wait) = gradients.hear(gradient, delivery.rssi, draw)
                {
                    port.after(wait, Timer(FIRST_GRADIENT + gradient.target.0));
                }
                None
            }
            Message::Answer(..) => None,
        };
        if let Some(key) = flooded {
            let draw = self.draw(port);
            self.flood.hear(key, delivery.payload, draw, port);
        }
    }

    fn sent(&mut self, _network: NetworkId, report: &SendReport, port: &mut Port<'_>) {
        if let Some(at) = self.answering.iter().position(|(frame, ..)| *frame == report.frame) {
            let (_, robot, version) = self.answering.swap_remove(at);
            if report.outcome == SendOutcome::Acknowledged {
                let told = self.told.entry(robot).or_default();
                *told = version.max(*told);
            }
        } else {
            self.route.ended(report, &mut self.outbox, port);
            self.retry_later(port);
        }
    }
}
