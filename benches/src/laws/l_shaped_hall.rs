//! A hall with two arms, whose inner corner is in the way of many links.

use sextant_channel::Position;
use sextant_kernel::Seed;

use super::site::HALL_M;
use super::survey::{Listening, SHADOWING, none_lost, survey};
use super::walls::{Wall, cross};
use super::{LawError, ReceptionLogAt, Site};

/// The name of the law.
pub(super) const NAME: &str = "l-shaped-hall";

/// The inner corner (m), and what each of its two walls takes (dB).
const CORNER_M: [f64; 2] = [9.0, 8.0];
const LOSS_DB: f64 = 18.0;

/// Nodes and stops are in the two arms, west and south of the corner.
pub(super) fn log(seed: Seed) -> Result<ReceptionLogAt, LawError> {
    let mut site = Site::hall(seed, 40);
    let is_inside = |place: &Position| place.x_m < CORNER_M[0] || place.y_m < CORNER_M[1];
    site.nodes.retain(is_inside);
    site.nodes.truncate(20);
    site.stops.retain(is_inside);
    let corner = Position::new(CORNER_M[0], CORNER_M[1], 0.0);
    let walls: [Wall; 2] = [
        [corner, Position::new(CORNER_M[0], HALL_M[1] + 1.0, 0.0)],
        [corner, Position::new(HALL_M[0] + 1.0, CORNER_M[1], 0.0)],
    ];
    let strength = |node: usize, stop: usize| {
        let link = [site.nodes[node], site.stops[stop]];
        let loss_db: f64 = walls.iter().map(|wall| if cross(link, *wall) { LOSS_DB } else { 0.0 }).sum();
        site.mean_dbm(node, stop) - loss_db + 4.0 * site.normal(SHADOWING, node, stop)
    };
    let log = survey(&site, Listening::default(), &strength, &none_lost)?;
    Ok((log, site.nodes))
}
