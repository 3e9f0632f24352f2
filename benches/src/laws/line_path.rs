//! A robot that drives along one line.

use sextant_channel::Position;
use sextant_kernel::Seed;

use super::independent_shadowing::usual_dbm;
use super::survey::{Listening, SURROUNDINGS, none_lost, survey};
use super::{LawError, ReceptionLogAt, Site};

/// The name of the law.
pub(super) const NAME: &str = "line-path";

/// Length of the line (m), its stops, and how far nodes are from it (m).
const LENGTH_M: f64 = 60.0;
const STOPS: u32 = 60;
const BESIDE_M: f64 = 5.0;

/// Stops a metre apart along a slight bend, nodes on both sides. The bend tells the sides apart only just.
pub(super) fn log(seed: Seed) -> Result<ReceptionLogAt, LawError> {
    let bend = |x_m: f64| 3.0 * libm::sin(x_m / LENGTH_M * std::f64::consts::PI);
    let stops = (0..STOPS).map(|stop| {
        let x_m = (f64::from(stop) + 0.5) / f64::from(STOPS) * LENGTH_M;
        Position::new(x_m, bend(x_m), 0.0)
    });
    let nodes = (0..16).map(|node| {
        let draw = |axis| seed.uniform(SURROUNDINGS, [node, axis, 0]);
        let x_m = LENGTH_M * draw(0);
        Position::new(x_m, bend(x_m) + BESIDE_M * (2.0 * draw(1) - 1.0), 0.0)
    });
    let site = Site::of(seed, nodes.collect(), stops.collect());
    let strength = |node, stop| usual_dbm(&site, node, stop);
    let log = survey(&site, Listening::default(), &strength, &none_lost)?;
    Ok((log, site.nodes))
}
