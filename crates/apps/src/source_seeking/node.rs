//! The application of a node.

use std::collections::BTreeMap;

use sextant_channel::{Dbm, Position};
use sextant_kernel::StationId;
use sextant_sim::{Application, Delivery, Destination, FieldId, NetworkId, Payload, Port, Sensed, Timer};

use super::message::SeekMessage;
use super::record::NodeSeekRecord;
use crate::navigation::{Answer, Request, WaitingAnswers};

/// Share of the window of a poll in which nodes begin to send: what waits for the channel then still comes in it.
const SENDING_SHARE: f64 = 0.9;

/// A node: it keeps its latest reading of each field, and answers robots that ask for one.
#[derive(Debug)]
pub struct SeekNode {
    network: NetworkId,
    /// Its place on the map; a node that is not on the map does not answer.
    place: Option<Position>,
    tx_power: Dbm,
    readings: BTreeMap<FieldId, f64>,
    /// Answers that wait for their instants.
    asked: WaitingAnswers<(StationId, u16, FieldId)>,
    draws: u64,
    record: NodeSeekRecord,
}

impl SeekNode {
    /// A node that sends with `tx_power` over `network`, and is at `place` on the map.
    #[must_use]
    pub fn new(network: NetworkId, place: Option<Position>, tx_power: Dbm) -> Self {
        Self {
            network,
            place,
            tx_power,
            readings: BTreeMap::new(),
            asked: WaitingAnswers::new(0, SENDING_SHARE),
            draws: 0,
            record: NodeSeekRecord::default(),
        }
    }

    /// What it leaves behind.
    #[must_use]
    pub fn into_record(self) -> NodeSeekRecord {
        self.record
    }

    fn ask(&mut self, delivery: &Delivery<'_>, request: Request, field: FieldId, port: &mut Port<'_>) {
        let &Delivery { from: robot, rssi, .. } = delivery;
        if !self.place.is_some_and(|place| request.concerns(place, rssi)) {
            return;
        }
        self.draws += 1;
        let draw = port.uniform(self.draws);
        self.asked.wait(&request, (robot, request.number, field), draw, port);
    }
}

impl Application for SeekNode {
    fn hears(&self) -> bool {
        true
    }

    fn senses(&self) -> bool {
        true
    }

    fn sensed(&mut self, sensed: &Sensed, _port: &mut Port<'_>) {
        if let Sensed::Sampled { field, value } = *sensed {
            self.readings.insert(field, value);
        }
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, port: &mut Port<'_>) {
        if let (true, Ok(SeekMessage::Request(request, field))) =
            (delivery.network == self.network, SeekMessage::read(delivery.payload))
        {
            self.ask(delivery, request, field, port);
        }
    }

    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        let Some((robot, number, field)) = self.asked.due(timer) else { return };
        let (Some(place), Some(&value)) = (self.place, self.readings.get(&field)) else { return };
        let octets = SeekMessage::Answer(Answer { number, place, tx_power: self.tx_power }, field, value).to_octets();
        match port.send(self.network, Destination::Station(robot), Payload::Octets(&octets)) {
            Ok(_) => {
                self.record.answers += 1;
                self.record.octets += octets.len() as u64;
            }
            Err(_) => self.record.refused += 1,
        }
    }
}
