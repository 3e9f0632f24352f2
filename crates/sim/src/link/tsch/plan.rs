//! The plan of a network: from whom each station has its time, and the cells of each.

use std::collections::BTreeMap;

use sextant_kernel::{SettingError, StationId};
use sextant_mac::frame::{Address, Endpoint};
use sextant_mac::tsch::frame::{AdvertisedCell, AdvertisedSlotframe, EnhancedBeacon};
use sextant_mac::tsch::{
    Asn, Autonomous, Cell, CellOptions, CellPeer, Msf, MsfConfig, Orchestra, OrchestraConfig, Rule, Schedule,
    ScheduleKind, Slotframe, TschSettings, UnicastCells, UnicastConfig,
};

use super::cells::NamedCell;
use crate::link::settings::{KnownStations, KnownTree, TreeTraffic};
use crate::service::report::Destination;

/// What all stations may do in the cell of the minimal schedule (RFC 8180, 4.1).
const MINIMAL_OPTIONS: CellOptions =
    CellOptions::TRANSMIT.and(CellOptions::RECEIVE).and(CellOptions::SHARED).and(CellOptions::TIMEKEEPING);

/// Why the frames of a station never arrive by a schedule of one's own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellFault {
    /// There is no cell in which they may go.
    NoCell,
    /// There are cells, but nobody who should hear them listens there.
    Unheard,
}

/// The plan of a network.
#[derive(Clone, Debug, Default)]
pub(super) struct Plan {
    /// The station from which each has its time at the start; `None` for sinks, and if it is not known.
    pub(super) time_sources: Vec<Option<StationId>>,
    /// The stations that may send to each, where it listens in the cells of these.
    senders: Vec<Vec<StationId>>,
    /// The cells of each station, where these are listed.
    own: Vec<Vec<Cell>>,
}

impl Plan {
    /// The plan among these stations, along a tree if there is one.
    ///
    /// # Errors
    /// If a cell names a station that there is not. The key is below `schedule`.
    pub(super) fn new(
        settings: &TschSettings,
        cells: &[NamedCell],
        stations: &KnownStations<'_>,
        tree: Option<&KnownTree>,
    ) -> Result<Self, SettingError> {
        let count = stations.count();
        let parents = tree.map(|tree| &*tree.parents);
        let is_sink = |station: StationId| station.index() >= stations.first_sink();
        let time_source = |station: StationId| match parents {
            _ if is_sink(station) => None,
            Some(parents) => parents.get(station.index()).copied().flatten(),
            None => stations.nearest_sink(station),
        };
        let all = || (0..count).map(StationId::from_index);
        let time_sources: Vec<Option<StationId>> = all().map(time_source).collect();
        let mut senders = vec![Vec::new(); count];
        if settings.needs_senders() {
            for station in all() {
                match (parents, time_sources[station.index()]) {
                    (Some(_), Some(parent)) => {
                        senders[parent.index()].push(station);
                        if tree.is_some_and(|tree| tree.traffic == TreeTraffic::UpAndDown) {
                            senders[station.index()].push(parent);
                        }
                    }
                    (Some(_), None) => {}
                    // Without a tree, nodes send to sinks.
                    (None, _) if is_sink(station) => {
                        senders[station.index()] = all().filter(|&node| !is_sink(node)).collect();
                    }
                    (None, _) => {}
                }
            }
        }
        let own = match &settings.schedule {
            ScheduleKind::Own(own) => {
                own_cells(own.slotframe, cells, stations).map_err(|error| error.within("schedule.own"))?
            }
            ScheduleKind::Minimal(_) | ScheduleKind::Orchestra(_) | ScheduleKind::Msf(_) => Vec::new(),
        };
        Ok(Self { time_sources, senders, own })
    }

    /// The schedule of a station that has its time from another one.
    pub(super) fn schedule(
        &self,
        settings: &TschSettings,
        station: StationId,
        time_source: Option<StationId>,
    ) -> Schedule {
        match &settings.schedule {
            ScheduleKind::Minimal(length) => Schedule::new(vec![minimal_cell(*length)]),
            ScheduleKind::Own(_) => Schedule::new(self.own.get(station.index()).cloned().unwrap_or_default()),
            ScheduleKind::Orchestra(config) => {
                let rule = orchestra(config, settings, station);
                let senders = self.senders.get(station.index()).into_iter().flatten().copied();
                Schedule::new(rule.cells(time_source, senders)).with_rule(Rule::Orchestra(rule))
            }
            ScheduleKind::Msf(msf) => {
                let rule = autonomous(settings, msf.slotframe, station);
                Schedule::new(vec![minimal_cell(msf.slotframe), rule.receive_cell()])
                    .with_rule(Rule::Autonomous(rule))
            }
        }
    }

    /// What is amiss for the frames of a station, if cells are listed: those to another one or to all, or any if that is not known.
    /// One of the `listeners` should hear them.
    pub(super) fn fault(
        &self,
        from: StationId,
        to: Option<Destination>,
        listeners: &[StationId],
    ) -> Option<CellFault> {
        let schedule = |station: StationId| Some(Schedule::new(self.own.get(station.index())?.clone()));
        let own = schedule(from)?;
        let cells: Vec<Cell> = match to {
            Some(Destination::Station(to)) => own.cells_to(to).collect(),
            Some(Destination::All) => own.cells_to_all().collect(),
            None => own.cells().iter().copied().filter(Cell::sends).collect(),
        };
        let hears = |cell: &Cell, station: StationId| {
            let heard = schedule(station).and_then(|schedule| schedule.heard_at(Asn(cell.timeslot.into())));
            station != from && heard.is_some_and(|heard| heard.channel_offset == cell.channel_offset)
        };
        match cells.iter().any(|cell| listeners.iter().any(|&station| hears(cell, station))) {
            _ if cells.is_empty() => Some(CellFault::NoCell),
            true => None,
            false => Some(CellFault::Unheard),
        }
    }

    /// How a station agrees on cells, if it does.
    pub(super) fn msf(&self, settings: &TschSettings, station: StationId) -> Option<Box<Msf>> {
        let rules = settings.msf()?;
        let own_slot = autonomous(settings, rules.length, station).receive_cell().timeslot;
        Some(Box::new(Msf::new(rules, own_slot)))
    }

    /// The beacon of a station in a slot.
    pub(super) fn beacon(
        &self,
        settings: &TschSettings,
        from: Endpoint,
        asn: Asn,
        join_metric: u8,
    ) -> EnhancedBeacon {
        // Stations know the cells of other schedules by themselves.
        let slotframes = match settings.schedule {
            ScheduleKind::Minimal(length) | ScheduleKind::Msf(MsfConfig { slotframe: length, .. }) => {
                vec![AdvertisedSlotframe {
                    handle: 0,
                    length,
                    cells: vec![AdvertisedCell { timeslot: 0, channel_offset: 0, options: MINIMAL_OPTIONS }],
                }]
            }
            ScheduleKind::Orchestra(_) | ScheduleKind::Own(_) => Vec::new(),
        };
        EnhancedBeacon { from, sequence: 0, asn, join_metric, slotframes }
    }

    /// Size of a beacon (octets).
    pub(super) fn beacon_octets(&self, settings: &TschSettings, station: StationId) -> u8 {
        let from = Endpoint { pan: 0, address: Address::of(station) };
        self.beacon(settings, from, Asn(0), 0).octets()
    }
}

fn autonomous(settings: &TschSettings, length: u16, station: StationId) -> Autonomous {
    Autonomous { length, channels: settings.msf().map_or(1, |rules| rules.channels), station }
}

fn minimal_cell(length: u16) -> Cell {
    Cell {
        slotframe: Slotframe { handle: 0, length },
        timeslot: 0,
        channel_offset: 0,
        options: MINIMAL_OPTIONS,
        peer: CellPeer::All,
    }
}

fn orchestra(config: &OrchestraConfig, settings: &TschSettings, station: StationId) -> Orchestra {
    let &OrchestraConfig { beacon_slotframe, unicast_slotframe, shared_slotframe, unicast } = config;
    Orchestra {
        beacon_length: beacon_slotframe,
        unicast_length: unicast_slotframe,
        shared_length: shared_slotframe,
        unicast: match unicast {
            UnicastConfig::ReceiverBased => UnicastCells::ReceiverBased,
            UnicastConfig::SenderBased => UnicastCells::SenderBased,
        },
        channels: u16::try_from(settings.hopping.channels().len()).expect("at most 256 channels"),
        station,
    }
}

/// The cells of each station of a schedule that lists them.
fn own_cells(length: u16, cells: &[NamedCell], stations: &KnownStations<'_>) -> Result<Vec<Vec<Cell>>, SettingError> {
    let by_name: BTreeMap<&str, StationId> = stations.names().collect();
    let find =
        |cell: &NamedCell, column: &str, name: &str| match name {
            "*" => Ok(None),
            name => by_name.get(name).copied().map(Some).ok_or_else(|| {
                cell.refuse(column, &format!("`{name}`"), "the name of a node or a sink, or `*` for all")
            }),
        };
    let mut own = vec![Vec::new(); stations.count()];
    for named in cells {
        let peer = find(named, "peer", &named.peer)?;
        let cell = Cell {
            slotframe: Slotframe { handle: 0, length },
            timeslot: named.timeslot,
            channel_offset: named.channel_offset,
            options: named.options,
            peer: peer.map_or(CellPeer::All, CellPeer::Station),
        };
        match find(named, "node", &named.node)? {
            Some(station) if Some(station) == peer => {
                return Err(named.refuse("peer", &format!("`{}`", named.peer), "another station than `node`"));
            }
            Some(station) => own[station.index()].push(cell),
            None => {
                let others = own.iter_mut().enumerate().filter(|(i, _)| Some(StationId::from_index(*i)) != peer);
                others.for_each(|(_, cells)| cells.push(cell));
            }
        }
    }
    Ok(own)
}
