//! A node that sends the traffic of its networks.

use super::source::Source;
use crate::application::{Application, Port};
use crate::event::Timer;
use crate::service::network_id::NetworkId;
use crate::service::report::SendReport;

/// The application of a node without another one: it sends the traffic of its networks and looks at nothing that
/// it hears.
#[derive(Clone, Debug)]
pub struct NodeTraffic(Sources);

#[derive(Clone, Debug)]
enum Sources {
    /// Traffic in one network.
    One(Source),
    /// Traffic in several networks, or in none.
    Several(Box<[Source]>),
}

impl NodeTraffic {
    pub(crate) fn new(mut sources: Vec<Source>) -> Self {
        Self(match sources.len() {
            1 => Sources::One(sources.remove(0)),
            _ => Sources::Several(sources.into()),
        })
    }
}

impl Application for NodeTraffic {
    /// Nodes sense, so that what their sensors say can be observed.
    fn senses(&self) -> bool {
        true
    }

    fn may_rest(&self) -> bool {
        match &self.0 {
            Sources::One(source) => source.may_rest(),
            Sources::Several(sources) => sources.iter().all(Source::may_rest),
        }
    }

    fn woken(&mut self, port: &mut Port<'_>) {
        match &mut self.0 {
            Sources::One(source) => source.woken(port),
            Sources::Several(sources) => sources.iter_mut().for_each(|source| source.woken(port)),
        }
    }

    fn ended(&mut self, port: &mut Port<'_>) {
        match &mut self.0 {
            Sources::One(source) => source.ended(port),
            Sources::Several(sources) => sources.iter_mut().for_each(|source| source.ended(port)),
        }
    }

    fn started(&mut self, port: &mut Port<'_>) {
        match &mut self.0 {
            Sources::One(source) => source.started(port),
            Sources::Several(sources) => sources.iter_mut().for_each(|source| source.started(port)),
        }
    }

    #[inline]
    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        match &mut self.0 {
            Sources::One(source) => source.timed(timer, port),
            Sources::Several(sources) => {
                let due = |source: &&mut Source| Timer(source.network().0.into()) == timer;
                sources.iter_mut().filter(due).for_each(|source| source.timed(timer, port));
            }
        }
    }

    #[inline]
    fn sent(&mut self, network: NetworkId, report: &SendReport, port: &mut Port<'_>) {
        match &mut self.0 {
            Sources::One(source) => source.sent(network, report, port),
            Sources::Several(sources) => {
                let of_network = |source: &&mut Source| source.network() == network;
                sources.iter_mut().filter(of_network).for_each(|source| source.sent(network, report, port));
            }
        }
    }
}
