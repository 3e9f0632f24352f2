//! Applications of nodes, robots and sinks.

use std::collections::BTreeSet;
use std::time::Duration;

use sextant::Programs;
use sextant::channel::{Position, Reception};
use sextant::kernel::{NodeId, SimTime};
use sextant::sim::{
    Application, Applications, Delivery, Destination, DriveEnd, NetworkId, Packets, Payload, Port, SendOutcome,
    SendReport, Simulation, Timer,
};

use super::{Counter, NETWORK, results, run, shipped, star};

/// Sends a message to all every half second, and counts what became of it.
#[derive(Debug, Default)]
struct Chatter {
    offered: u64,
    outcomes: Vec<SendOutcome>,
    heard: u64,
    program_seed: u128,
}

impl Application for Chatter {
    fn hears(&self) -> bool {
        true
    }

    fn started(&mut self, port: &mut Port<'_>) {
        self.program_seed = port.program_seed();
        port.after(Duration::from_millis(500).mul_f64(port.uniform(0)), Timer(0));
    }

    fn timed(&mut self, _: Timer, port: &mut Port<'_>) {
        self.offered += 1;
        port.send(NETWORK, Destination::All, Payload::Octets(b"good morning")).expect("a free link");
        port.after(Duration::from_millis(500), Timer(0));
    }

    fn sent(&mut self, _: NetworkId, report: &SendReport, _: &mut Port<'_>) {
        self.outcomes.push(report.outcome);
    }

    fn delivered(&mut self, _: &Delivery<'_>, _: &mut Port<'_>) {
        self.heard += 1;
    }
}

fn sum_of_fates(packets: &Packets) -> u64 {
    packets.received
        + packets.lost_collision
        + packets.lost_channel_access
        + packets.lost_queue
        + packets.lost_signal
        + packets.out_of_range
        + packets.not_listened
        + packets.pending
}

#[test]
fn a_sink_that_only_counts_changes_no_octet() {
    let scenario = star();
    let mut counter = Counter::default();
    let programs = Programs::default().with_sink("east", Box::new(&mut counter));
    let given = results(&scenario, programs);
    assert_eq!(given, results(&scenario, Programs::default()));
    let run = run(&scenario, Programs::default());
    let deliveries = &run.survey().unwrap().networks[0].deliveries;
    assert!(counter.0 > 50 && counter.0 == deliveries[31], "{} of {deliveries:?}", counter.0);
}

#[test]
fn nodes_with_programs_send_among_the_traffic_of_the_others() {
    let scenario = star();
    let usual = run(&scenario, Programs::default());
    let names: Vec<&str> = scenario.world().nodes.iter().map(|node| node.name.as_str()).collect();
    let mut chatters: Vec<Chatter> = (0..5).map(|_| Chatter::default()).collect();
    let mut programs = Programs::default();
    for (name, chatter) in names[10..15].iter().zip(&mut chatters) {
        programs = programs.with_node(name, Box::new(chatter));
    }
    let mixed = run(&scenario, programs);
    let (usual, mixed) = (&usual.survey().unwrap().networks[0], &mixed.survey().unwrap().networks[0]);
    for (node, packets) in mixed.packets[..30].iter().enumerate() {
        assert_eq!(packets.offered, sum_of_fates(packets), "{packets:?}");
        let expected = node.checked_sub(10).and_then(|i| chatters.get(i)).map(|chatter| chatter.offered);
        assert_eq!(packets.offered, expected.unwrap_or(usual.packets[node].offered), "node {node}");
        assert!(mixed.energy[node].tx_j > 0.0, "node {node}");
    }
    for (chatter, packets) in chatters.iter().zip(&mixed.packets[10..]) {
        assert!(chatter.offered >= 15, "{chatter:?}");
        assert_eq!(chatter.outcomes.len() as u64, packets.offered - packets.pending, "{packets:?}");
        assert!(chatter.outcomes.iter().filter(|&&outcome| outcome == SendOutcome::Sent).count() > 10);
    }
    let seeds: BTreeSet<u128> = chatters.iter().map(|chatter| chatter.program_seed).collect();
    assert_eq!(seeds.len(), 5);
    assert!(usual.packets[12].offered != mixed.packets[12].offered, "the program changes what its node offers");
}

#[test]
fn a_run_with_programs_is_the_same_with_any_number_of_threads() {
    let with_threads = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let scenario = shipped("smoke.toml");
            let mut programs = super::controllers::own_controllers(&scenario);
            for node in &scenario.world().nodes[..8] {
                programs = programs.with_node(&node.name, Box::new(Chatter::default()));
            }
            results(&scenario, programs)
        })
    };
    assert_eq!(with_threads(1), with_threads(3));
}

#[test]
fn one_simulation_of_applications_and_a_run_with_them_are_the_same() {
    let listening = star().with("mac.csma_unslotted.rx_on_when_idle", true).expect("nodes that listen");
    let silent = listening.with("traffic", "{ silent = {} }").expect("no traffic");
    let applications = || (0..30).map(|_| Chatter::default()).collect::<Vec<_>>();
    let simulation = Simulation::with(silent.setup(), Applications::of_nodes(applications()));
    let (survey, ended) = simulation.unwrap().run_own(&mut ());
    let mut chatters = applications();
    let mut programs = Programs::default();
    for (node, chatter) in silent.world().nodes.iter().zip(&mut chatters) {
        programs = programs.with_node(&node.name, Box::new(chatter));
    }
    let run = run(&silent, programs);
    let with_programs = run.survey().unwrap();
    assert_eq!(with_programs.packets, survey.packets);
    assert_eq!((with_programs.events, with_programs.end), (survey.events, survey.end));
    let heard = |chatters: &[Chatter]| chatters.iter().map(|chatter| chatter.heard).collect::<Vec<_>>();
    assert_eq!(heard(&chatters), heard(&ended.nodes));
    assert!(heard(&chatters).iter().sum::<u64>() > 1000);
}

/// Drives along the x axis, and writes a stop into the log every two metres.
#[derive(Default)]
struct Walker {
    since: SimTime,
    stops: u32,
    packets: Vec<u32>,
}

impl Walker {
    fn walk(&mut self, port: &mut Port<'_>) {
        if self.stops == 6 {
            return port.finish();
        }
        port.drive(Position::new(2.0 * f64::from(self.stops), -1.0, 0.0));
    }
}

impl Application for Walker {
    fn hears(&self) -> bool {
        true
    }

    fn has_task(&self) -> bool {
        true
    }

    fn started(&mut self, port: &mut Port<'_>) {
        self.packets = vec![0; port.node_count()];
        self.walk(port);
    }

    fn drive_ended(&mut self, _: DriveEnd, port: &mut Port<'_>) {
        self.since = port.now();
        port.listen(NETWORK, Duration::from_secs(3));
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, port: &mut Port<'_>) {
        if let Some(node) = port.node(delivery.from) {
            self.packets[node.index()] += 1;
        }
    }

    fn listened(&mut self, _: NetworkId, port: &mut Port<'_>) {
        let heard = (0..).map(NodeId).zip(&mut self.packets);
        let receptions: Vec<Reception> = heard
            .filter(|(_, packets)| **packets > 0)
            .map(|(node, packets)| {
                let received = std::mem::take(packets);
                Reception::heard(node, 0, received, 4)
            })
            .collect();
        port.log_stop(NETWORK, self.since, port.pose().position, receptions);
        self.stops += 1;
        self.walk(port);
    }
}

#[test]
fn the_stops_of_a_robot_with_an_own_application_are_mapped() {
    let scenario = shipped("smoke.toml");
    let mut walker = Walker::default();
    let run = run(&scenario, Programs::default().with_robot("surveyor", Box::new(&mut walker)));
    let (survey, summary) = (run.survey().unwrap(), run.summary());
    assert_eq!((walker.stops, survey.log().stops().len()), (6, 6));
    let robot = &summary.gathering.as_ref().unwrap().robots[0];
    assert_eq!((robot.stops, robot.ended), (6, None));
    let heard: Vec<&String> = (survey.log().names().iter().zip(&survey.robots[0].packets))
        .filter(|(_, n)| **n > 0)
        .map(|(n, _)| n)
        .collect();
    assert!(heard.len() > 5 && robot.unreached.len() == 30 - heard.len(), "{heard:?}, {:?}", robot.unreached);
    assert!(summary.maps[0].mapped > 5 && summary.maps[0].position_error_m.is_some());
}
