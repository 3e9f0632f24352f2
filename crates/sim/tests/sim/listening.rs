//! When stations listen, and what a command to listen changes.

use std::time::Duration;

use sextant_channel::Position;
use sextant_sim::{Application, Delivery, Destination, NetworkId, Payload, Port, Setup, Sink, Timer};

use crate::network;
use crate::scripted::NETWORK;

/// Time from one frame to the next; a frame and what belongs to it take 1088 us.
const TICK: Duration = Duration::from_millis(2);

/// Sends a frame each tick, 20 times, with the number of the tick in it; or listens as its commands say.
#[derive(Default)]
struct Station {
    sent: u8,
    sends: bool,
    /// When it begins to listen, and for how long (ticks).
    commands: Vec<(u32, u32)>,
    heard: Vec<u8>,
    listened_at: Vec<u64>,
}

impl Application for Station {
    fn hears(&self) -> bool {
        !self.sends
    }

    fn started(&mut self, port: &mut Port<'_>) {
        if self.sends {
            port.after(Duration::ZERO, Timer(0));
        }
        for (&(at, _), number) in self.commands.iter().zip(0..) {
            port.after(TICK * at, Timer(number));
        }
    }

    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        if !self.sends {
            let (_, span) = self.commands[usize::from(timer.0)];
            port.listen(NETWORK, TICK * span);
            return;
        }
        port.send(NETWORK, Destination::All, Payload::Octets(&[self.sent])).expect("the link is idle");
        self.sent += 1;
        if self.sent < 20 {
            port.after(TICK, timer);
        }
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, _port: &mut Port<'_>) {
        self.heard.push(delivery.payload[0]);
    }

    fn listened(&mut self, _network: NetworkId, port: &mut Port<'_>) {
        self.listened_at.push(port.now().as_nanos() / 2_000_000);
    }
}

/// What a node, a robot and a sink hear of the frames of another node, and when their times to listen are over
/// (ticks), all with the same commands.
fn listen(commands: &[(u32, u32)]) -> [(Vec<u8>, Vec<u64>); 3] {
    let beside = Position::new(1.0, 0.0, 0.0);
    let setup = Setup {
        robots: network::own_robots([network::body("robot", beside)]),
        sinks: vec![Sink { name: "sink".into(), position: beside, networks: None }],
        ..network::engine(&[Position::ORIGIN, beside], network::link(2.0, network::prompt()), 1)
    };
    let sender = Station { sends: true, ..Station::default() };
    let listener = || Station { commands: commands.to_vec(), ..Station::default() };
    let ended = network::run(setup, vec![sender, listener(), listener(), listener()]);
    let [_, node, robot, sink] = &ended.applications[..] else { panic!("four stations") };
    [node, robot, sink].map(|station| (station.heard.clone(), station.listened_at.clone()))
}

#[test]
fn a_robot_hears_only_while_it_listens_and_nodes_and_sinks_always() {
    let all: Vec<u8> = (0..20).collect();
    let [node, robot, sink] = listen(&[]);
    assert_eq!(node, (all.clone(), vec![]));
    assert_eq!(robot, (vec![], vec![]));
    assert_eq!(sink, (all.clone(), vec![]));
    // A command to listen tells nodes and sinks when the time is over, and does not close their receivers.
    let [node, robot, sink] = listen(&[(2, 3), (10, 1)]);
    assert_eq!(node, (all.clone(), vec![5, 11]));
    assert_eq!(robot, (vec![2, 3, 4, 10], vec![5, 11]));
    assert_eq!(sink, (all, vec![5, 11]));
}

#[test]
fn a_new_command_to_listen_replaces_what_is_left_of_the_old_one() {
    let [_, longer, _] = listen(&[(2, 3), (4, 4)]);
    assert_eq!(longer, (vec![2, 3, 4, 5, 6, 7], vec![8]));
    let [_, shorter, _] = listen(&[(2, 10), (4, 2)]);
    assert_eq!(shorter, (vec![2, 3, 4, 5], vec![6]));
}
