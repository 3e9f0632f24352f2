//! A mission of your own: a robot asks all nodes for their batteries, and visits the three with the lowest.
//!
//! `cargo run --release -p sextant --example own_mission`

use std::io::Write;
use std::sync::Arc;
use std::time::Duration;

use sextant::apps::navigation::NavigationMap;
use sextant::apps::{Mission, MissionArrival, MissionGoal, MissionOutcome, MissionTeam};
use sextant::channel::Position;
use sextant::kernel::{SettingError, StationId};
use sextant::scenario::{MissionMap, PlannedMission};
use sextant::sim::{
    Application, Applications, Delivery, Destination, DriveEnd, Driving, NetworkId, Payload, Port, ReadySimulation,
    Setup, Simulation, Timer,
};
use sextant::{Scenario, Unwatched};

const SCENARIO: &str = "name = \"batteries\"\nseed = 1\n\
    world.nodes.lattice = { spacing_m = 4.0, jitter_m = 0.5, count = 20, \
      region.rectangle = { min_m = [0, 0], max_m = [20, 16] } }\n\
    radio = { tx_power_dbm = -40, sensitivity_dbm = -90 }\n\
    channel = { environment = \"light-tree\", max_range_m = 30.0, path_loss.log_distance.reference_loss_db = 0.0 }\n\
    mac.csma_unslotted = { rx_on_when_idle = true }\n\
    traffic.periodic.interval_s = 1.0\n\
    robots = [{ name = \"carrier\", start_m = [0, 0], controller.waypoints.places_m = [[4, 0]] }]\n";

/// The network of all messages.
const NETWORK: NetworkId = NetworkId(0);
/// How many nodes are visited.
const VISITS: usize = 3;

/// The mission. It has no settings.
#[derive(Debug)]
struct LowBatteries;

impl Mission for LowBatteries {
    fn goal(&self) -> MissionGoal {
        MissionGoal::Other
    }

    fn prepare(
        self: Arc<Self>,
        map: &Arc<NavigationMap>,
        team: MissionTeam<'_>,
        setup: Setup,
    ) -> Result<ReadySimulation<'static, MissionOutcome>, SettingError> {
        let robot = || Station::Robot { map: Arc::clone(map), heard: Vec::new(), visits: Vec::new() };
        let stations = Applications {
            nodes: (0..team.nodes).map(|_| Station::Node { asked: None }).collect(),
            robots: team.robots.iter().map(|_| robot()).collect(),
            sinks: (0..team.sinks).map(|_| Station::Sink).collect(),
        };
        Ok(Simulation::with(setup, stations)?.ready(|own| outcome(own.robots)))
    }
}

/// What runs on a station.
enum Station {
    /// A node answers who asked.
    Node { asked: Option<StationId> },
    /// A robot knows the map, the batteries that it heard of and where they are on the map, and where it has been.
    Robot { map: Arc<NavigationMap>, heard: Vec<(u8, Position)>, visits: Vec<MissionArrival> },
    /// A sink does nothing.
    Sink,
}

impl Station {
    /// Drives to the next of the nodes with the lowest batteries, as long as there is one.
    fn go_on(&mut self, port: &mut Port<'_>) {
        let Self::Robot { heard, visits, .. } = self else { return };
        while let Some(&(value, place)) = heard.get(visits.len()).filter(|_| visits.len() < VISITS) {
            match port.drive(place) {
                Driving::UnderWay => return,
                Driving::Over(_) => {
                    visits.push(MissionArrival { robot: 0, time: port.now(), value: f64::from(value) })
                }
            }
        }
        port.finish();
    }
}

impl Application for Station {
    fn hears(&self) -> bool {
        true
    }

    fn has_task(&self) -> bool {
        matches!(self, Self::Robot { .. })
    }

    fn started(&mut self, port: &mut Port<'_>) {
        if let Self::Robot { .. } = self {
            // The question reaches all nodes; who does not hear it is not visited.
            let _ = port.send(NETWORK, Destination::All, Payload::Octets(b"battery?"));
            port.listen(NETWORK, Duration::from_secs(5));
        }
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, port: &mut Port<'_>) {
        match (self, delivery.payload) {
            (Self::Node { asked }, b"battery?") => {
                *asked = Some(delivery.from);
                port.after(Duration::from_secs(4).mul_f64(port.uniform(1)), Timer(0));
            }
            (Self::Robot { map, heard, .. }, &[battery]) => {
                let place = port.node(delivery.from).and_then(|node| map.place(node));
                heard.extend(place.map(|place| (battery, place)));
            }
            _ => {}
        }
    }

    fn timed(&mut self, _timer: Timer, port: &mut Port<'_>) {
        if let Self::Node { asked: Some(robot) } = *self {
            // A battery in percent, as the node measures it.
            let battery = 20 + 5 * u8::try_from(port.choice(2, 16)).unwrap_or(0);
            let _ = port.send(NETWORK, Destination::Station(robot), Payload::Octets(&[battery]));
        }
    }

    fn listened(&mut self, _network: NetworkId, port: &mut Port<'_>) {
        if let Self::Robot { heard, .. } = self {
            heard.sort_by_key(|&(battery, _)| battery);
        }
        self.go_on(port);
    }

    fn drive_ended(&mut self, _end: DriveEnd, port: &mut Port<'_>) {
        if let Self::Robot { heard, visits, .. } = self {
            let value = heard.get(visits.len()).map_or(f64::NAN, |&(battery, _)| f64::from(battery));
            visits.push(MissionArrival { robot: 0, time: port.now(), value });
        }
        self.go_on(port);
    }
}

/// What the robots did.
fn outcome(robots: Vec<Station>) -> MissionOutcome {
    let mut outcome = MissionOutcome::default();
    for robot in robots {
        let Station::Robot { heard, visits, .. } = robot else { continue };
        *outcome.messages.entry("answers").or_default() += heard.len() as u64;
        *outcome.steps.entry("visits").or_default() += visits.len() as u64;
        outcome.arrivals.extend(visits);
    }
    outcome
}

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mission = PlannedMission {
        name: "batteries".to_owned(),
        map: MissionMap::Physical,
        robots: vec![0],
        network: NETWORK,
        duration: Duration::from_secs(200),
        algorithm: "low-batteries",
        mission: Arc::new(LowBatteries),
    };
    let scenario = Scenario::parse(SCENARIO)?.with_mission(mission)?;
    let run = sextant::run(&scenario, &mut (), &Unwatched)?;
    let summary = &run.summary().applications[0];
    let visits = summary.steps.get("visits").copied().unwrap_or(0);
    writeln!(std::io::stdout(), "{visits} nodes visited: {}", summary.outcome())?;
    assert_eq!(visits, VISITS as u64);
    Ok(())
}
