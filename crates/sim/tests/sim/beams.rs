//! The powers of links for all sectors of both ends, and bodies that hide links.

use std::f64::consts::{FRAC_PI_2, PI};
use std::time::Duration;

use sextant_channel::{Antenna, Dbm, ObstacleField, Position, ReflectionsConfig, ScreenConfig};
use sextant_kernel::{Files, NodeId, Seed};
use sextant_sim::{
    Antennas, Application, IdealReception, Port, SectorPair, SectorPowers, Setup, TargetConfig, TargetMotionConfig,
    Timer, World,
};

use crate::broadcasts::link;
use crate::network;
use crate::scripted::NETWORK;

/// A robot that looks at the links each second.
#[derive(Default)]
struct Looker {
    looks: bool,
    seen: Vec<(SectorPowers, IdealReception)>,
}

impl Application for Looker {
    fn started(&mut self, port: &mut Port<'_>) {
        if self.looks {
            port.after(Duration::from_millis(500), Timer(0));
        }
    }

    fn timed(&mut self, _timer: Timer, port: &mut Port<'_>) {
        let powers = port.sector_powers(NETWORK, NodeId(0)).expect("a link");
        assert_eq!(port.sector_powers(NETWORK, NodeId(0)).as_ref(), Some(&powers), "nothing changes at an instant");
        self.seen.push((powers, port.ideal_receptions(NETWORK)[0]));
        port.after(Duration::from_secs(1), Timer(0));
    }
}

/// Eight sectors of both ends.
const EIGHT: &str = "nodes.sectors = { azimuth_sectors = 8, boresight_gain_dbi = 25.0 }\n\
                     robots.sectors = { azimuth_sectors = 8, boresight_gain_dbi = 25.0 }\nnode_headings = 'aligned'";

const NODE: Position = Position::new(0.0, 0.0, 1.0);
const ROBOT: Position = Position::new(5.0, 2.0, 1.0);

/// A node and a robot, 5.4 m apart, among bodies, for some seconds.
fn run(targets: Vec<TargetConfig>, mirrors: bool, seconds: u64) -> Vec<(SectorPowers, IdealReception)> {
    let mut network = link(EIGHT);
    if mirrors {
        let mirrors = ReflectionsConfig { loss_db: Some(4.0), ground_z_m: Some(0.0), ..Default::default() };
        let law = "path_loss.log_distance = { exponent = 2.0 }";
        let config: sextant_channel::ChannelConfig = toml::from_str(law).expect("a channel");
        let config = sextant_channel::ChannelConfig { reflections: Some(mirrors), ..config };
        network.channel = config.try_into().expect("a good channel");
    }
    let setup = network::engine(&[NODE], network, 4);
    let target = |(i, config): (usize, TargetConfig)| {
        config.build(i as u64, &ObstacleField::default(), Seed(1)).expect("a good target")
    };
    let targets = targets.into_iter().enumerate().map(target).collect();
    let setup = Setup {
        world: World { targets, ..setup.world },
        robots: network::own_robots([network::body("r", ROBOT)]),
        duration: Some(Duration::from_secs(seconds)),
        ..setup
    };
    let ended = network::run(setup, vec![Looker::default(), Looker { looks: true, ..Looker::default() }]);
    ended.applications.into_iter().nth(1).expect("a robot").seen
}

fn person(places: &str, speed: f64) -> TargetConfig {
    let motion = format!("waypoints = {{ places_m = {places}, speed_m_per_s = {speed} }}");
    let motion: TargetMotionConfig = toml::from_str(&motion).expect("a motion");
    let screen = Some(ScreenConfig { width_m: 0.4, height_m: 1.7 });
    TargetConfig { name: "person".into(), motion, screen }
}

fn antenna() -> Antenna {
    let antennas = Antennas::read(&toml::from_str(EIGHT).expect("antennas"), &Files::default());
    antennas.expect("good antennas").nodes().clone()
}

#[test]
fn each_pair_of_sectors_has_the_gains_of_both_antennas() {
    let (powers, ideal) = run(Vec::new(), false, 1).remove(0);
    let (antenna, apart) = (antenna(), ROBOT - NODE);
    let from_node = apart * (1.0 / apart.length_m());
    // The level without gains, from the best sector of the node at a robot that listens in all directions.
    let best_gain = (0..8).map(|sector| antenna.gain(sector, from_node).0).fold(f64::MIN, f64::max);
    let level = ideal.rssi.0 - best_gain;
    let mut greatest = f64::MIN;
    for own in 0..8 {
        let gain = antenna.gain(own, from_node * -1.0).0;
        assert!((powers.to_peer()[usize::from(own)].0 - level - gain).abs() < 1e-9);
        for peer in 0..8 {
            let expected = level + gain + antenna.gain(peer, from_node).0;
            let found = powers.pair(SectorPair { own, peer }).0;
            assert!((found - expected).abs() < 1e-9, "{own} {peer}: {found}, not {expected}");
            greatest = greatest.max(expected);
        }
    }
    let strongest =
        powers.from_peer().iter().fold(Dbm::SILENCE, |best, &power| if power > best { power } else { best });
    assert!((strongest - ideal.rssi).0.abs() < 1e-9);
    assert!((powers.best().0 - greatest).abs() < 1e-9, "the best pair is the greatest of all");
}

/// The loss of a screen 0.4 m wide and 1.7 m high in the middle of a link 1 m above the floor, `aside` from it: the formula of
/// 3GPP TR 38.901, 7.6.4.2.
fn literal_db(aside: f64) -> f64 {
    let (wavelength, length) = (0.299_792_458 / 58.32, (ROBOT - NODE).length_m());
    let term = |edge: f64| {
        let bent = 2.0 * (length * length / 4.0 + edge * edge).sqrt();
        (FRAC_PI_2 * (PI / wavelength * (bent - length)).sqrt()).atan() / PI
    };
    let (near, far) = (aside.abs() - 0.2, aside.abs() + 0.2);
    let sides = if near > 0.0 { term(far) - term(near) } else { term(far) + term(near) };
    -20.0 * (1.0 - sides * (term(1.0) + term(0.7))).log10()
}

#[test]
fn a_person_in_the_way_takes_what_the_formula_says_and_who_passes_takes_it_for_a_while() {
    let free = run(Vec::new(), false, 1).remove(0);
    let loss = |seen: &(SectorPowers, IdealReception)| {
        let by_sweep = free.1.rssi - seen.1.rssi;
        assert!((free.0.best() - seen.0.best() - by_sweep).0.abs() < 1e-9, "sweeps and data differ");
        by_sweep.0
    };
    let standing = run(vec![person("[[2.5, 1.0, 0.0]]", 1.0)], false, 1).remove(0);
    assert!((loss(&standing) - literal_db(0.0)).abs() < 1e-9, "{} {}", loss(&standing), literal_db(0.0));
    // Across the link at 1 m/s: half a second after the start it is 2 m aside, then 1 m, and so on.
    let across = Position::new(-2.0, 5.0, 0.0) * (1.0 / 29.0_f64.sqrt());
    let middle = Position::new(2.5, 1.0, 0.0);
    let [from, to] = [-2.5, 2.5].map(|m| middle + across * m);
    let places = format!("[[{}, {}, 0.0], [{}, {}, 0.0]]", from.x_m, from.y_m, to.x_m, to.y_m);
    let passing = run(vec![person(&places, 1.0)], false, 6);
    for (seen, aside) in passing.iter().zip([-2.0, -1.0, 0.0, 1.0, 2.0, 2.5]) {
        assert!((loss(seen) - literal_db(aside)).abs() < 1e-6, "{aside} m: {} {}", loss(seen), literal_db(aside));
    }
}

#[test]
fn with_reflections_only_the_ways_that_pass_a_person_are_weaker() {
    let free = run(Vec::new(), true, 1).remove(0);
    let hidden = run(vec![person("[[2.5, 1.0, 0.0]]", 1.0)], true, 1).remove(0);
    let low = run(
        vec![TargetConfig {
            screen: Some(ScreenConfig { width_m: 0.4, height_m: 0.2 }),
            ..person("[[2.5, 1.0, 0.0]]", 1.0)
        }],
        true,
        1,
    );
    for (powers, ideal) in [&free, &hidden, &low[0]] {
        let best =
            powers.from_peer().iter().fold(Dbm::SILENCE, |best, &power| if power > best { power } else { best });
        assert!((best - ideal.rssi).0.abs() < 1e-9, "sweeps and data differ");
    }
    // Both ways pass the whole person. What is 0.2 m high hides the way over the ground alone, which carries little.
    let lost = |powers: &SectorPowers| (free.0.best() - powers.best()).0;
    assert!(
        lost(&hidden.0) > 8.0 && lost(&low[0].0) >= 0.0 && lost(&low[0].0) < 3.0,
        "{} {}",
        lost(&hidden.0),
        lost(&low[0].0)
    );
}
