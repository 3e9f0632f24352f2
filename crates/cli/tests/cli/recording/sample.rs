//! A reception log with all features: unheard nodes, counts, sectors, strengths, empty stops, contacts.

use std::path::Path;
use std::time::Duration;

use sextant_channel::{Anchor, Contact, Link, NeighbourLog, Position, Reception, ReceptionLog, Stop};
use sextant_kernel::{NodeId, RobotId, SimTime};
use sextant_recording::messages::{FrameMessage, MappedNodeMessage, SensorsMessage};
use sextant_recording::{
    FileRecorder, GridPlane, Level, Origin, PlacedNode, Recorder, RecordingError, Sensation, Solid,
};

/// Pseudo-random numbers, the same on every machine (splitmix64).
pub(crate) struct Numbers(pub(crate) u64);

impl Numbers {
    pub(crate) fn below(&mut self, bound: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (bits ^ (bits >> 31)) % bound
    }

    fn small(&mut self, bound: u32) -> u32 {
        u32::try_from(self.below(u64::from(bound))).expect("below 2^32")
    }

    /// A coordinate without a short decimal form (m).
    fn coordinate(&mut self) -> f64 {
        f64::from(self.small(1 << 30)) / 3.0e7 - 10.0
    }

    fn position(&mut self) -> Position {
        Position::new(self.coordinate(), self.coordinate(), self.coordinate())
    }
}

/// Which of two robots has the stop or contact number `index`.
fn robot(index: u32) -> RobotId {
    RobotId(u32::from(index % 3 == 1))
}

/// A log with `nodes` nodes and `stops` stops of two robots.
pub(crate) fn log(seed: u64, nodes: u32, stops: u32) -> ReceptionLog {
    let mut numbers = Numbers(seed);
    let names =
        (0..nodes).map(|node| format!("node {node}, \"quoted\" and {}", if node % 2 == 0 { "é" } else { "x" }));
    let places = (0..stops).map(|stop| {
        let time = SimTime::from_nanos(u64::from(stop) * 1_200_000_001 + numbers.below(1_000_000));
        Stop { robot: robot(stop), time, position: numbers.position(), heading_rad: Some(0.25 * f64::from(stop)) }
    });
    let places: Vec<Stop> = places.collect();
    let mut receptions = Vec::new();
    for stop in 0..stops {
        for node in 0..nodes {
            // The last node is never heard; some pairs have no reception.
            if node + 1 == nodes || numbers.below(3) == 0 {
                continue;
            }
            let sent = numbers.small(7);
            let received = numbers.small(sent + 1);
            let sector = (numbers.below(2) == 0).then(|| u8::try_from(numbers.below(256)).expect("below 256"));
            let rssi_dbm = (numbers.below(2) == 0).then(|| -90.0 + numbers.coordinate());
            // 0 of 1 means the same as an absent pair, so a CSV folder does not keep it.
            let received = if sent == 1 { 1 } else { received };
            let snr_db = (numbers.below(2) == 0).then(|| numbers.coordinate());
            receptions.push(Reception { node: NodeId(node), stop, received, sent, sector, rssi_dbm, snr_db });
        }
    }
    let contacts = (0..stops / 5).map(|i| Contact {
        robot: robot(i),
        time: SimTime::from_nanos(u64::from(i) * 7),
        position: numbers.position(),
    });
    let contacts = contacts.collect();
    let log = ReceptionLog::new(names.collect(), places, receptions, contacts).expect("a sound log");
    let robots = ["surveyor", "scout"].into_iter().take(log.robot_count()).map(str::to_owned).collect();
    log.with_robots(robots).expect("a name for each")
}

/// The true positions of the nodes of the sample.
pub(crate) fn truth(log: &ReceptionLog) -> Vec<PlacedNode> {
    let mut numbers = Numbers(99);
    (0..log.node_count())
        .map(|i| PlacedNode { node: NodeId::from_index(i), position: numbers.position(), error_m: None })
        .collect()
}

/// Receptions of the first node by the last one, if there are two nodes.
pub(crate) fn links(nodes: usize) -> NeighbourLog {
    let link = Link {
        listener: NodeId::from_index(nodes - 1),
        sender: NodeId(0),
        received: 4,
        sent: 5,
        rssi_dbm: Some(-66.5),
    };
    NeighbourLog::new(nodes, if nodes > 1 { vec![link] } else { Vec::new() }).expect("two nodes")
}

/// Calls every method of the recorder.
pub(crate) fn record_all<W: std::io::Write>(
    recorder: &mut Recorder<W>,
    log: &ReceptionLog,
) -> Result<(), RecordingError> {
    let at = |nanos| SimTime::from_nanos(nanos);
    recorder.origin(Origin { scenario: "sample", seed: 42, version: "1.2.3" })?;
    recorder.scenario("name = \"sample\"\n")?;
    let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|[x, y]| Position::new(x, y, 0.0));
    let solid = Solid { name: "wall".to_owned(), vertices: corners.into(), triangles: vec![[0, 1, 2]] };
    recorder.obstacles(at(0), &[solid])?;
    recorder.world_nodes(at(0), &truth(log))?;
    recorder.world_names(at(0), [("post", corners[1])].into_iter())?;
    recorder.log(log)?;
    let anchor = Anchor { node: NodeId(0), position: Position::new(7.0, 8.0, 9.0) };
    recorder.anchors(&[anchor])?;
    let heard = links(log.node_count());
    recorder.neighbours(&heard)?;
    recorder.beacons(&heard)?;
    recorder.robot(at(5), "surveyor", Position::new(1.0, 2.0, 3.0), std::f64::consts::PI)?;
    recorder.path(at(6), "surveyor", &corners)?;
    recorder.leg(at(5), None, "surveyor", 1, [corners[0], corners[1]])?;
    recorder.way(at(6), None, "surveyor", &corners)?;
    recorder.way(at(6), Some("search"), "agent", &corners)?;
    let stop = Stop { time: at(6), ..Stop::at(corners[0]) };
    recorder.listening(None, "surveyor", &stop, at(1_000_000_008), &corners[1..])?;
    recorder.estimated_place(at(6), "search", "agent", "own_place", corners[1], None)?;
    recorder.metric(at(7), "path_length_m", 12.5)?;
    recorder.note(at(8), Level::Warning, "survey", "nobody heard")?;
    let frames = [("received", vec![[corners[0], corners[2]]])];
    recorder.on_air(at(9), &frames, Duration::from_nanos(1_000))?;
    recorder.frame(&FrameMessage {
        start_ns: 9,
        airtime_ns: 1_000,
        source: 3,
        mpdu: vec![0x41, 0x88, 0x00],
        outcome: "received".to_owned(),
        power_dbm: Some(-71.5),
        network: "inner".to_owned(),
        deafness: String::new(),
    })?;
    let placed = PlacedNode { node: NodeId(1), position: Position::new(4.0, 5.0, 6.0), error_m: Some(0.25) };
    recorder.map(at(10), "ml-tm", &[placed])?;
    let plane = GridPlane {
        first: Position::new(-1.0, -2.0, 0.0),
        step_m: 0.5,
        columns: 2,
        values: vec![-1.0, -2.0, f64::NEG_INFINITY, -4.0],
    };
    recorder.likelihood(at(11), "ml-tm", "n12", &plane)?;
    recorder.sensors(&SensorsMessage { target_radius_m: Some(2.5), ..SensorsMessage::default() })?;
    recorder.target(at(12), "intruder", Position::new(1.5, 2.5, 0.0))?;
    for (nanos, sensation) in [(13, Sensation::Entered), (14, Sensation::Sampled(-0.5)), (15, Sensation::Left)] {
        recorder.sensed(at(nanos), NodeId(1), "intruder", sensation)?;
    }
    recorder.field(at(16), "gas", &plane)?;
    recorder.mapped_node(
        at(17),
        &MappedNodeMessage {
            node: 1,
            role: "new_anchor".to_owned(),
            anchor_since: Some(2),
            category: "good".to_owned(),
            x_m: Some(1.25),
            neighbours: 40,
            scattered: 3,
            vertices: 1 << 40,
            energy_j: 0.1,
            bearings: Some(0),
            ..MappedNodeMessage::default()
        },
    )?;
    recorder.summary("{\"maps\": []}")
}

/// Records everything to the file `path`.
pub(crate) fn record_file(path: &Path, log: &ReceptionLog) {
    let mut recorder = FileRecorder::create(path).expect("a folder for it");
    record_all(&mut recorder, log).expect("room on the disk");
    recorder.finish().expect("room on the disk");
}
