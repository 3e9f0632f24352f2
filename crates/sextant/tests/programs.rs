//! Runs with controllers and applications of the caller's own.

use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use sextant::channel::{Position, Reception};
use sextant::kernel::{SimTime, Work};
use sextant::recording::read_run;
use sextant::run::{RunStart, SurveyEnd};
use sextant::sim::{
    Application, Controller, Delivery, Destination, DriveEnd, NetworkId, Observer, Packets, Payload, Port,
    RobotCommand, RobotTask, SendOutcome, SendReport, Simulation, Situation, Timer,
};
use sextant::{Programs, Run, RunError, RunObserver, RunRecorder, Scenario, Summary, Unwatched, Watch};

const NETWORK: NetworkId = NetworkId(0);

fn shipped(name: &str) -> Scenario {
    Scenario::load(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios").join(name)).expect("a good scenario")
}

/// Two sinks, to which 30 nodes send.
fn star() -> Scenario {
    let text = "name = \"star\"\nseed = 5\nduration_s = 8.0\n\
        world.nodes.lattice = { spacing_m = 3.0, jitter_m = 0.5, count = 30, \
          region.rectangle = { min_m = [0, 0], max_m = [18, 15] } }\n\
        radio = { tx_power_dbm = -50, sensitivity_dbm = -90 }\n\
        channel = { environment = \"light-tree\", max_range_m = 9.0, path_loss.log_distance.reference_loss_db = 0.0 }\n\
        mac.csma_unslotted = {}\n\
        traffic.poisson = { rate_per_s = 3.0, acknowledged = true }\n\
        sinks = [{ name = \"west\", position_m = [4, 7, 0] }, { name = \"east\", position_m = [13, 7, 0] }]\n";
    Scenario::parse(text).expect("a good scenario")
}

/// The summary without its timing, and the octets of the recording.
fn results(scenario: &Scenario, programs: Programs<'_>) -> (String, Vec<u8>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let run = sextant::run_with(scenario, programs, &mut RunRecorder::new(&path), &Unwatched).expect("a run");
    let summary = Summary { timing: None, ..run.summary().clone() };
    (summary.to_json(), std::fs::read(path).unwrap())
}

fn run(scenario: &Scenario, programs: Programs<'_>) -> Run {
    sextant::run_with(scenario, programs, &mut (), &Unwatched).expect("a run")
}

/// The controllers of a scenario as programs.
fn own_controllers(scenario: &Scenario) -> Programs<'static> {
    let mut programs = Programs::default();
    for robot in scenario.setup().robots {
        if let RobotTask::Survey(controller) = robot.task {
            programs = programs.with_controller(&robot.body.name, controller);
        }
    }
    programs
}

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

/// Counts what it receives.
#[derive(Debug, Default)]
struct Counter(u64);

impl Application for Counter {
    fn hears(&self) -> bool {
        true
    }

    fn delivered(&mut self, _: &Delivery<'_>, _: &mut Port<'_>) {
        self.0 += 1;
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
fn controllers_of_the_scenario_given_back_change_no_octet() {
    let scenario = shipped("smoke.toml");
    assert_eq!(results(&scenario, own_controllers(&scenario)), results(&scenario, Programs::default()));
}

#[test]
fn own_controllers_of_robots_far_apart_change_no_octet() {
    // Without programs these robots are simulated in parallel.
    let second = "{ name = \"second\", start_m = [400.0, 0.0], listen_s = 1.2, \
        controller = { waypoints = { places_m = [[402.0, 1.0], [404.0, 3.0]] } } }";
    let first = "{ name = \"first\", start_m = [0.0, 0.0], listen_s = 1.2, \
        controller = { waypoints = { places_m = [[2.0, 1.0], [4.0, 3.0]] } } }";
    let text = format!(
        "name = \"apart\"\nseed = 2\nrobots = [{first}, {second}]\n\
         world.nodes.explicit = [{}]\n\
         radio = {{ tx_power_dbm = -50, sensitivity_dbm = -90 }}\n\
         channel = {{ max_range_m = 6.0, path_loss.log_distance.reference_loss_db = 0.0 }}\n\
         mac.csma_unslotted = {{}}\ntraffic.periodic = {{}}\n",
        (0..12)
            .map(|i| {
                let x = f64::from(i % 6) + if i < 6 { 0.0 } else { 400.0 };
                format!("{{ name = \"n{i}\", position_m = [{x:.1}, 2.0, 0.0] }}")
            })
            .collect::<Vec<_>>()
            .join(", ")
    );
    let scenario = Scenario::parse(&text).map_err(|errors| errors.to_string()).unwrap();
    assert_eq!(results(&scenario, own_controllers(&scenario)), results(&scenario, Programs::default()));
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
    let seeds: std::collections::BTreeSet<u128> = chatters.iter().map(|chatter| chatter.program_seed).collect();
    assert_eq!(seeds.len(), 5);
    assert!(usual.packets[12].offered != mixed.packets[12].offered, "the program changes what its node offers");
}

#[test]
fn a_run_with_programs_is_the_same_with_any_number_of_threads() {
    let with_threads = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let scenario = shipped("smoke.toml");
            let mut programs = own_controllers(&scenario);
            for node in &scenario.world().nodes[..8] {
                programs = programs.with_node(&node.name, Box::new(Chatter::default()));
            }
            results(&scenario, programs)
        })
    };
    assert_eq!(with_threads(1), with_threads(3));
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
        let heard = (0..).map(sextant::kernel::NodeId).zip(&mut self.packets);
        let receptions: Vec<Reception> = heard
            .filter(|(_, packets)| **packets > 0)
            .map(|(node, packets)| {
                let received = std::mem::take(packets);
                Reception { node, stop: 0, received, sent: 3, sector: None, rssi_dbm: None, snr_db: None }
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

/// A watch that a program stops.
#[derive(Debug, Default)]
struct Switch(AtomicBool);

impl Watch for Switch {
    fn begin(&self, _: Work) {}

    fn advance(&self, _: u64) {}

    fn is_stopped(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// What the observer was told of.
#[derive(Default)]
struct Told {
    begun: u32,
    survey_s: Option<f64>,
    is_interrupted: Option<bool>,
}

impl Observer for Told {}

impl RunObserver for Told {
    fn run_started(&mut self, _: &RunStart<'_>) -> Result<(), RunError> {
        self.begun += 1;
        Ok(())
    }

    fn survey_finished(&mut self, end: &SurveyEnd<'_>) -> Result<(), RunError> {
        self.survey_s = Some(end.simulated.survey.end.as_secs_f64());
        Ok(())
    }

    fn run_finished(&mut self, summary: &Summary) -> Result<(), RunError> {
        self.is_interrupted = Some(summary.interrupted);
        Ok(())
    }
}

/// Fails at its third stop, and says so by the switch.
#[derive(Clone)]
struct Failing {
    rest: Box<dyn Controller>,
    switch: Arc<Switch>,
    decisions: u32,
    error: Arc<Mutex<Option<String>>>,
    failed_ns: Arc<AtomicU64>,
}

impl Controller for Failing {
    fn decide(&mut self, situation: &Situation<'_>) -> RobotCommand {
        self.decisions += 1;
        if self.decisions == 9 {
            *self.error.lock().unwrap() = Some("division by zero".to_owned());
            self.failed_ns.store(situation.time.as_nanos(), Ordering::Relaxed);
            self.switch.0.store(true, Ordering::Relaxed);
        }
        self.rest.decide(situation)
    }
}

#[test]
fn a_program_that_fails_ends_the_run_and_its_recording_is_readable() {
    let scenario = shipped("smoke.toml");
    let RobotTask::Survey(rest) = scenario.setup().robots.remove(0).task else { panic!("a robot that surveys") };
    let (switch, error, failed_ns) = (Arc::default(), Arc::default(), Arc::default());
    let failing = Failing {
        rest,
        switch: Arc::clone(&switch),
        decisions: 0,
        error: Arc::clone(&error),
        failed_ns: Arc::clone(&failed_ns),
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let mut observer = (RunRecorder::new(&path), Told::default());
    let programs = Programs::default().with_controller("surveyor", Box::new(failing));
    let run = sextant::run_with(&scenario, programs, &mut observer, &*switch).expect("what was done until then");
    assert_eq!(error.lock().unwrap().as_deref(), Some("division by zero"));
    let Told { begun, survey_s, is_interrupted } = observer.1;
    assert_eq!((begun, is_interrupted), (1, Some(true)));
    let failed_s = SimTime::from_nanos(failed_ns.load(Ordering::Relaxed)).as_secs_f64();
    let ended_s = survey_s.unwrap();
    assert!(failed_s > 0.0 && ended_s >= failed_s && ended_s < failed_s + 5.0, "{failed_s} s, {ended_s} s");
    assert!(run.summary().interrupted && run.survey().unwrap().interrupted && run.maps().is_empty());
    let recorded = read_run(&path).expect("a readable recording");
    assert_eq!(recorded.log().stops(), run.survey().unwrap().log().stops());
    assert!(!recorded.log().stops().is_empty());
}

#[test]
fn programs_that_fit_no_station_are_refused_with_the_names_there_are() {
    let refused = |scenario: &Scenario, programs: Programs<'_>| {
        sextant::run_with(scenario, programs, &mut (), &Unwatched).map(drop).expect_err("refused").to_string()
    };
    let application = || Box::new(Counter::default());
    let controller = || Box::new(Idle) as Box<dyn Controller>;
    let (smoke, star) = (shipped("smoke.toml"), star());
    let node = refused(&smoke, Programs::default().with_node("nod", application()));
    assert!(node.starts_with("a program is given to the node `nod`, which is not in the scenario; its nodes: `"));
    assert!(node.ends_with(" and 20 more"), "{node}");
    for (scenario, programs, expected) in [
        (
            &smoke,
            Programs::default().with_controller("rover", controller()),
            "the robot `rover`, which is not in the scenario; its robots: `surveyor`",
        ),
        (
            &star,
            Programs::default().with_robot("rover", application()),
            "which is not in the scenario; it has no robot",
        ),
        (
            &star,
            Programs::default().with_sink("north", application()),
            "the sink `north`, which is not in the scenario; its sinks: `west`, `east`",
        ),
        (
            &smoke,
            Programs::default().with_controller("surveyor", controller()).with_robot("surveyor", application()),
            "the robot `surveyor` is given a controller and an application; give it one of them",
        ),
    ] {
        let message = refused(scenario, programs);
        assert!(message.contains(expected), "{message}");
    }
    let agents = shipped("target/case-1.toml");
    let agent = &agents.config().robots[0].name;
    let message = refused(&agents, Programs::default().with_controller(agent, controller()));
    assert!(message.contains("with the role `agent`; allowed: a robot with the role `survey`"), "{message}");
}

/// Finishes at once.
#[derive(Clone)]
struct Idle;

impl Controller for Idle {
    fn decide(&mut self, _: &Situation<'_>) -> RobotCommand {
        RobotCommand::Finish(sextant::sim::Ending::Complete)
    }
}

#[test]
fn nodes_that_compute_a_map_keep_their_application() {
    let scenario = shipped("dmtm/rf.toml");
    let name = scenario.world().nodes[0].name.clone();
    let programs = Programs::default().with_node(&name, Box::new(Counter::default()));
    let message = sextant::run_with(&scenario, programs, &mut (), &Unwatched).map(drop).expect_err("refused");
    let expected = format!(
        "an application is given to the node `{name}`, but the nodes compute a map; \
         remove the application or `[distributed_mapping]`"
    );
    assert_eq!(message.to_string(), expected);
    assert!(!message.is_system_error());
}

#[test]
fn one_simulation_of_applications_and_a_run_with_them_are_the_same() {
    let silent = star().with("traffic", "{ silent = {} }").expect("no traffic");
    let applications = || (0..30).map(|_| Chatter::default()).collect::<Vec<_>>();
    let simulation = Simulation::with(silent.setup(), sextant::sim::Applications::of_nodes(applications()));
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
