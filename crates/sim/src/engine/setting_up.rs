//! Setting up: an engine is made of its setup, with what happens in the networks and between them.

use std::time::Duration;

use sextant_channel::SectorTable;
use sextant_kernel::{EventQueue, NodeId, Seed, SettingError, SimTime, StationId};
use sextant_mac::coordinator::Coordinator;

use super::bands::{self, Bands};
use super::running::Stage;
use super::{Engine, dying, interference};
use crate::air::{Air, Interface, ReceiverId};
use crate::application::Application;
use crate::batteries::Bank;
use crate::event::Event;
use crate::link::antennas::Antennas;
use crate::link::settings::{Berth, Placement};
use crate::model::log::Logs;
use crate::model::origins::Origins;
use crate::model::ranging::Ranging;
use crate::model::{Model, Vehicle};
use crate::network::Network;
use crate::purpose;
use crate::scene::Scene;
use crate::sensing::Sensing;
use crate::service::network_id::NetworkId;
use crate::service::sensed::Sensations;
use crate::setup::Setup;
use crate::station::Motion;
use crate::world::motion::NodeCourse;

/// The number of each of `count` networks.
///
/// # Errors
/// If there is none, or more than numbers.
fn network_ids(count: usize) -> Result<Vec<NetworkId>, SettingError> {
    match u8::try_from(count.wrapping_sub(1)) {
        Ok(last) => Ok((0..=last).map(NetworkId).collect()),
        Err(_) if count == 0 => Err(SettingError::new("networks", "empty", "at least one network")),
        Err(_) => Err(SettingError::new("networks", count, "at most 256 networks")),
    }
}

/// With so many nodes that look at what they hear, receivers are told late of signals: fewer have little of it.
const MANY_HEAR: usize = 16;

/// Tells receivers late of signals, in the bands where that can be.
fn tell_late(scene: &mut Scene, networks: &[Network], bands: &[bands::Band]) {
    let Scene { airs, motions, roll, .. } = scene;
    for (air, band) in airs.iter_mut().zip(bands) {
        if band.networks.iter().all(|&network| networks[network].technology.settings().asks_at_ends()) {
            let interface = |station: StationId| Interface { receiver: ReceiverId(station.0), station };
            let places =
                roll.stations().map(|station| (interface(station), motions[station.index()].at(SimTime::ZERO)));
            air.tell_late(places);
        }
    }
}

/// What only some runs need.
pub(crate) struct Extras {
    /// Number of the round: frames of different rounds have different draws, though each round begins at time zero. The
    /// survey is round 0.
    pub(crate) round: u64,
    /// The seed of the channel, if it is not that of the rest.
    pub(crate) channel_seed: Seed,
    /// The state machine of the station that sends beacons in the first network.
    pub(crate) coordinator: Option<(StationId, Coordinator)>,
}

impl<A: Application> Engine<A> {
    /// An engine with an application for each station: nodes come first, then robots, then sinks. What the robots of the
    /// setup are there for is in their applications.
    ///
    /// # Errors
    /// If networks in one band have different channels, or the settings of a network do not fit together.
    ///
    /// # Panics
    /// If the number of applications is not that of the stations.
    pub(crate) fn new(setup: Setup, applications: Vec<A>, extras: Extras) -> Result<Self, SettingError> {
        let roll = setup.roll();
        assert_eq!(applications.len(), roll.len(), "one application for each station");
        let ids = network_ids(setup.networks.len())?;
        let Setup { world, robots, sinks, networks, .. } = &setup;
        let places = world.nodes.iter().map(|node| node.position);
        let motions: Vec<Motion> = (places.chain(robots.iter().map(|robot| robot.body.start)))
            .chain(sinks.iter().map(|sink| sink.position))
            .map(Motion::standing)
            .collect();
        let mut scene = Scene {
            now: SimTime::ZERO,
            event: Event::WarmedUp,
            steps: 0,
            queue: EventQueue::new(),
            airs: Vec::new(),
            motions,
            roll,
            moving: Vec::new(),
            seed: setup.seed,
            backoffs: roll.stations().map(|station| setup.seed.draws(purpose::BACKOFF, station.0.into())).collect(),
            offered: 0,
            discounted: 0,
            counted_from: SimTime::ZERO,
            upcalls: Vec::new(),
            traced: Vec::new(),
        };
        let seed = setup.seed;
        let courses: Vec<(StationId, NodeCourse)> =
            world.motions.iter().map(|motion| (StationId(motion.node.0), motion.course(seed))).collect();
        scene.moving = courses.iter().map(|(station, _)| *station).collect();
        let hears: Vec<bool> = applications.iter().map(Application::hears).collect();
        let Extras { round, channel_seed, mut coordinator } = extras;
        bands::check_links(networks)?;
        dying::check_batteries(&setup)?;
        for carrier_ghz in networks.iter().filter_map(|network| network.channel.signal_ghz()) {
            world.check_carrier(carrier_ghz).map_err(|error| error.within("world"))?;
        }
        let bands = bands::bands(networks)?;
        let noises = interference::noises(&world.interferers, networks, &bands);
        if noises.len() > usize::from(u16::MAX) {
            let found = format!("a list of {}", world.interferers.len());
            return Err(SettingError::new("interferers", found, "at most 65535, over all radio channels"));
        }
        let fixed = world.nodes.iter().map(|node| node.position).chain(sinks.iter().map(|sink| sink.position));
        let message_loss = setup.faults.message_loss();
        let all = Bands { world, channel_seed, seed: setup.seed, round, message_loss, roll };
        for (i, band) in bands.iter().enumerate() {
            let moving = courses.iter().map(|(station, _)| *station).collect();
            scene.airs.push(Air::new(all.air(i, band, networks), fixed.clone(), roll).with_moving(moving));
        }
        let mut links = Vec::with_capacity(networks.len());
        for (network, id) in networks.iter().zip(ids) {
            let settings = network.technology.settings();
            let audience = if settings.always_receives() { vec![true; roll.len()] } else { hears.clone() };
            let mut berth = |spectrum| {
                let rules = (0..roll.nodes).map(|node| settings.radio().rule_of(NodeId::from_index(node)));
                let rules = rules.chain(std::iter::repeat_n(0, roll.robots + roll.sinks));
                let air = bands::band_of(&bands, spectrum);
                let first_receiver =
                    scene.airs[air].add_receivers(settings.radio().reception_rules(), rules, &audience);
                Berth { air, first_receiver }
            };
            let Berth { air, first_receiver } = berth(settings.spectrum());
            let further = settings.further_spectra().into_iter().map(berth).collect();
            let placement = Placement {
                network: id,
                is_only: networks.len() == 1,
                radio_states: network.radio_states.clone(),
                air,
                first_receiver,
                further,
                members: setup.members(id),
                hears: hears.clone(),
                coordinator: coordinator.take_if(|_| id == NetworkId::default()),
            };
            links.push(network.technology.links(placement, &mut scene));
        }
        let hear = hears[..roll.nodes].iter().filter(|&&hears| hears).count();
        if hear >= MANY_HEAR && noises.is_empty() {
            tell_late(&mut scene, networks, &bands);
        }
        let batteries = setup.batteries.clone().map(|batteries| {
            let most_w = |station| {
                let radios = links.iter().zip(networks).filter_map(|(links, network)| {
                    Some(network.radio_states.most_w(links.transmitter(station)?.tx_power))
                });
                radios.sum()
            };
            Bank::new(batteries, most_w)
        });
        let ranging = |network: &Network| Some(Ranging::new(network.ranging?, &network.channel, world));
        let rangings = networks.iter().map(ranging).collect();
        let sectors = networks.iter().map(|network| network.technology.antennas());
        let sectors = sectors.map(|antennas| antennas.map(Antennas::robot_sectors).filter(|table| !table.is_empty()));
        let logs = Logs::new(sectors.map(Option::<&SectorTable>::cloned), roll.nodes);
        let senses: Vec<bool> = applications[..roll.nodes].iter().map(Application::senses).collect();
        let sensing = Sensing::new(world, &senses, &scene);
        let has_task: Vec<bool> = applications.iter().map(Application::has_task).collect();
        let unfinished = has_task.iter().filter(|&&has_task| has_task).count();
        Ok(Self {
            model: Model {
                scene,
                networks: links,
                rangings,
                world: setup.world,
                vehicles: setup.robots.into_iter().map(|robot| Vehicle::new(robot.body)).collect(),
                sensing,
                courses,
                halo: None,
                batteries,
                origins: Origins::default(),
                notes: Vec::new(),
                has_task,
                unfinished,
            },
            applications,
            logs,
            stage: Stage::Ready,
            end: setup.duration.map(|duration| SimTime::ZERO + duration),
            noises,
            warm_up: Duration::ZERO,
            ends_with_tasks: unfinished > 0,
            events: 0,
            sensed: Sensations::default(),
            faults: setup.faults,
            dead: Vec::new(),
            deaths: Vec::new(),
        })
    }
}
