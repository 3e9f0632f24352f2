//! Antennas of nodes that are raised by angles drawn for each node.

use sextant_channel::Position;
use sextant_kernel::{Files, Seed};
use sextant_sim::{Antennas, AntennasConfig};

/// The antennas of nodes with 8 sectors, half-power width 30 degrees in elevation, and these tilts.
fn antennas(nodes: &str, tilts_deg: &str) -> Result<Antennas, String> {
    let text = format!("nodes = {nodes}\nrobots.omnidirectional = {{}}\nnode_tilts_deg = {tilts_deg}");
    let config: AntennasConfig = toml::from_str(&text).expect("antennas");
    Antennas::read(&config, &Files::default()).map_err(|error| error.key)
}

const RING: &str = "{ sectors = { azimuth_sectors = 8, vertical_width_deg = 30, pattern.elliptical = {} } }";

/// The direction of `elevation_deg` above sector 0.
fn up(elevation_deg: f64) -> Position {
    let elevation_rad = elevation_deg.to_radians();
    Position::new(elevation_rad.cos(), 0.0, elevation_rad.sin())
}

#[test]
fn without_tilts_all_antennas_of_nodes_are_the_same() {
    let found = antennas(RING, "[0.0]").expect("good antennas");
    assert!(found.node_tilts_rad(Seed(1), 50).iter().all(|&tilt_rad| tilt_rad.to_bits() == 0));
    assert!(found.node_antennas(Seed(1), 50).iter().all(|&antenna| std::ptr::eq(antenna, found.nodes())));
    let level: AntennasConfig =
        toml::from_str(&format!("nodes = {RING}\nrobots.omnidirectional = {{}}")).expect("antennas");
    assert_eq!(level.node_tilts_deg, [0.0]);
    assert!(!toml::to_string(&level).expect("a table").contains("node_tilts_deg"));
}

#[test]
fn half_of_the_nodes_have_each_of_two_tilts_and_their_gain_is_greatest_there() {
    const NODES: usize = 4000;
    let found = antennas(RING, "[-25.0, 25.0]").expect("good antennas");
    let tilts_rad = found.node_tilts_rad(Seed(7), NODES);
    let raised = tilts_rad.iter().filter(|&&tilt_rad| tilt_rad > 0.0).count();
    // Five standard errors of a binomial share of one half.
    let n = NODES as f64;
    assert!((raised as f64 - n / 2.0).abs() < 5.0 * (n / 4.0).sqrt(), "{raised} of {NODES}");
    assert_eq!(found.node_tilts_rad(Seed(7), 10), tilts_rad[..10]);
    assert_ne!(found.node_tilts_rad(Seed(8), 50), tilts_rad[..50]);
    let level = antennas(RING, "[0.0]").expect("good antennas");
    for (antenna, tilt_rad) in found.node_antennas(Seed(7), 100).into_iter().zip(tilts_rad) {
        let tilt_deg = tilt_rad.to_degrees();
        assert!((tilt_deg.abs() - 25.0).abs() < 1e-9, "{tilt_deg}");
        // What points at the tilt is what points at the horizon without it.
        assert!((antenna.gain(0, up(tilt_deg)).0 - level.nodes().gain(0, up(0.0)).0).abs() < 1e-9);
        let [above, below] = [25.0, -25.0].map(|deg| antenna.gain(0, up(deg)).0);
        assert!((above - below).signum() * tilt_deg > 0.0 && (above - below).abs() > 3.0, "{above} and {below} dBi");
    }
}

#[test]
fn tilts_that_an_antenna_cannot_have_are_rejected() {
    let key = |nodes, tilts_deg| antennas(nodes, tilts_deg).err();
    let rings = "{ sectors = { azimuth_sectors = 8, elevations_deg = [0, 70] } }";
    assert_eq!(key(rings, "[-20.0, 20.0]"), None);
    assert_eq!(key(rings, "[0.0, 20.1]").as_deref(), Some("node_tilts_deg[1]"));
    assert_eq!(key(rings, "[-90.5]").as_deref(), Some("node_tilts_deg[0]"));
    assert_eq!(key(RING, "[nan]").as_deref(), Some("node_tilts_deg[0]"));
    assert_eq!(key(RING, "[]").as_deref(), Some("node_tilts_deg"));
    assert_eq!(key("{ omnidirectional = {} }", "[5.0]").as_deref(), Some("node_tilts_deg[0]"));
    assert_eq!(key("{ omnidirectional = {} }", "[0.0, 0.0]"), None);
    let book = "{ code_book = { azimuths_deg = [0, 90], elevations_deg = [0], outside_gain_dbi = -20, sectors = [{ sector = 0, gain_dbi = [[1, 2]] }] } }";
    assert_eq!(key(book, "[5.0]").as_deref(), Some("node_tilts_deg[0]"));
}
