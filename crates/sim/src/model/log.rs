//! What robots heard and met, as it grows.

use sextant_channel::{Contact, HeardAtStop, ReceptionLog, ReceptionLogBuilder, SectorTable, Stop, StopLog};

use crate::service::network_id::NetworkId;

/// What robots heard in each network, and what they met, as it grows.
#[derive(Default)]
pub(crate) struct Logs {
    networks: Vec<Log>,
    pub(crate) contacts: Vec<Contact>,
    /// Whether each node was heard, in any network.
    heard: Vec<bool>,
    pub(crate) nodes_heard: usize,
    /// Number of pairs of a stop and a node that was heard there, in all networks.
    pub(crate) receptions: usize,
}

/// What robots heard in one network.
#[derive(Default)]
struct Log {
    stops: Vec<Stop>,
    receptions: ReceptionLogBuilder,
    /// The sectors of the robots' antenna, if it has any.
    sectors: Option<SectorTable>,
}

impl Logs {
    /// Empty logs of as many networks as there are `sectors`: those of the robots' antenna in each.
    pub(crate) fn new(sectors: impl Iterator<Item = Option<SectorTable>>, nodes: usize) -> Self {
        let networks = sectors.map(|sectors| Log { sectors, ..Log::default() }).collect();
        Self { networks, heard: vec![false; nodes], ..Self::default() }
    }

    /// Number of stops so far, in the network with the most.
    pub(crate) fn stops(&self) -> usize {
        self.networks.iter().map(|log| log.stops.len()).max().unwrap_or(0)
    }

    /// Adds a stop with what was heard there, which is numbered now, and passes it to `tell` with its number.
    pub(crate) fn stop(
        &mut self,
        network: NetworkId,
        stop: Stop,
        heard: StopLog,
        tell: impl FnOnce(u32, &Stop, HeardAtStop<'_>),
    ) {
        let log = &mut self.networks[network.index()];
        let index = u32::try_from(log.stops.len()).expect("less than 2^32 stops");
        let heard = heard.at(index);
        for reception in &heard.receptions {
            let known = &mut self.heard[reception.node.index()];
            self.nodes_heard += usize::from(!std::mem::replace(known, true));
            self.receptions += usize::from(reception.received > 0);
        }
        for sample in &heard.ranges {
            let known = &mut self.heard[sample.node.index()];
            self.nodes_heard += usize::from(!std::mem::replace(known, true));
        }
        tell(index, &stop, heard.heard());
        log.stops.push(stop);
        log.receptions.extend(heard.receptions);
        heard.reports.into_iter().for_each(|report| log.receptions.report(report));
        heard.ranges.into_iter().for_each(|sample| log.receptions.range(index, sample));
    }

    /// The whole log of each network, of nodes and robots with these names.
    ///
    /// # Panics
    /// If a robot logged a node twice at a stop, a sector twice, or one that its antenna does not have.
    pub(crate) fn build(self, nodes: &[String], robots: &[String]) -> Vec<ReceptionLog> {
        let contacts = self.contacts;
        let build = |Log { stops, receptions, sectors }: Log| {
            let log = receptions.build(nodes.to_vec(), stops, contacts.clone());
            let log = log.expect("a robot logs each node and each of its sectors at most once a stop");
            let log = log.with_robots(robots.to_vec()).expect("each stop and contact is of a robot");
            match sectors {
                None => log,
                Some(sectors) => log.with_sectors(sectors).expect("robots log sectors of their antenna"),
            }
        };
        self.networks.into_iter().map(build).collect()
    }
}
