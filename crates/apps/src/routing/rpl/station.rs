//! What a station of RPL knows.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use sextant_kernel::{EventKey, StationId};
use sextant_mac::routing::rpl::{
    Content, Datagram, Direction, Dodag, Message, Registration, RouteTable, RplOption, local_octets,
};
use sextant_mac::routing::{Data, Trickle};
use sextant_sim::{FrameId, Port, Timer};

use super::plan::RplPlan;

/// The timer of DIOs.
pub(in crate::routing) const DIO: Timer = Timer(16);

/// What a station of RPL knows.
#[derive(Clone, Debug)]
pub(in crate::routing) struct RplStation {
    pub(in crate::routing) plan: Arc<RplPlan>,
    pub(in crate::routing) dodag: Dodag,
    pub(in crate::routing) trickle: Trickle,
    pub(in crate::routing) registration: Registration,
    /// The ways down that it keeps, if stations do.
    pub(in crate::routing) table: RouteTable,
    /// The timers that are set.
    pub(in crate::routing) due: BTreeMap<Timer, EventKey>,
    /// Frames to one neighbour that are no packets of the queue, and to whom they go.
    pub(in crate::routing) under_way: Vec<(FrameId, StationId)>,
    pub(in crate::routing) minutes: u32,
}

impl RplStation {
    /// The root of a tree.
    pub(in crate::routing) fn root(own: StationId, plan: &Arc<RplPlan>) -> Self {
        Self::with(Dodag::of_root(own, plan.dodag), plan)
    }

    /// A node.
    pub(in crate::routing) fn node(own: StationId, plan: &Arc<RplPlan>) -> Self {
        Self::with(Dodag::of_node(own, plan.dodag), plan)
    }

    fn with(dodag: Dodag, plan: &Arc<RplPlan>) -> Self {
        Self {
            plan: Arc::clone(plan),
            dodag,
            trickle: plan.trickle.clone(),
            registration: Registration::default(),
            table: RouteTable::new(plan.route_table),
            due: BTreeMap::new(),
            under_way: Vec::new(),
            minutes: 0,
        }
    }

    /// Ways down that it keeps in its table.
    pub(in crate::routing) fn routes(&self) -> usize {
        self.table.len()
    }

    /// Sets a timer, in place of the time for which it was set.
    pub(in crate::routing) fn set(&mut self, timer: Timer, span: Duration, port: &mut Port<'_>) {
        self.stop(timer, port);
        self.due.insert(timer, port.after(span, timer));
    }

    pub(in crate::routing) fn stop(&mut self, timer: Timer, port: &mut Port<'_>) {
        if let Some(earlier) = self.due.remove(&timer) {
            port.cancel(earlier);
        }
    }

    pub(in crate::routing) fn is_set(&self, timer: Timer) -> bool {
        self.due.contains_key(&timer)
    }

    /// The next DIO is sent soon, if there is something to tell.
    pub(in crate::routing) fn hasten_dio(&mut self, uniform: f64, port: &mut Port<'_>) {
        if !self.dodag.may_tell() {
            return;
        }
        let now = port.now();
        let due = match self.is_set(DIO) {
            true => self.trickle.reset(now, uniform),
            false => Some(self.trickle.begin(now, uniform)),
        };
        if let Some(due) = due {
            self.set(DIO, due.saturating_since(now), port);
        }
    }
}

/// To whom a packet goes next.
pub(in crate::routing) enum Next {
    /// To this neighbour.
    Station(StationId),
    /// Nobody is known, but somebody may be soon.
    Later,
    /// Nobody is known.
    Nowhere,
}

impl RplStation {
    /// To whom a packet goes next.
    pub(in crate::routing) fn next_of(&self, datagram: &Datagram, port: &Port<'_>) -> Next {
        match datagram.option {
            Some(RplOption { direction: Direction::Up, .. }) => {
                self.dodag.parent().map_or(Next::Later, Next::Station)
            }
            Some(RplOption { direction: Direction::Down, .. }) => {
                self.table.next(datagram.destination, port.now()).map_or(Next::Nowhere, Next::Station)
            }
            None => Next::Station(datagram.destination),
        }
    }

    /// The packet as it is sent now: with the rank of this station, and the root where it goes if nothing else is said.
    pub(in crate::routing) fn ready(&self, datagram: &Datagram, data: &Data) -> Datagram {
        let mut datagram = datagram.clone();
        if let Some(option) = &mut datagram.option {
            option.sender_rank = self.dodag.rank();
        }
        let is_data = matches!(datagram.content, Content::Data(_));
        let is_to_root = is_data && data.hops == 0 && data.target.is_none();
        if let Some(root) = self.dodag.root().filter(|_| is_to_root) {
            datagram.destination = root;
        }
        datagram
    }

    /// Writes a message to a neighbour.
    pub(in crate::routing) fn write_message(&self, message: &Message, to: StationId, octets: &mut Vec<u8>) {
        local_octets(message, Some(to), &self.plan.configuration, octets);
    }

    /// Writes a packet whose payload beyond its number has so many octets.
    pub(in crate::routing) fn write(&self, datagram: &Datagram, payload_octets: usize, octets: &mut Vec<u8>) {
        datagram.write(datagram.header_octets() + payload_octets, &self.plan.configuration, octets);
    }
}
