//! A corridor with rooms on both sides, of which the robot sees the corridor.

use sextant_channel::Position;
use sextant_kernel::Seed;

use super::survey::{Listening, SHADOWING, SURROUNDINGS, none_lost, survey};
use super::walls::{Wall, cross};
use super::{LawError, ReceptionLogAt, Site};

/// The name of the law.
pub(super) const NAME: &str = "rooms";

/// Length and width of the corridor, depth and width of a room, width of its door (m).
const LENGTH_M: f64 = 36.0;
const WIDTH_M: f64 = 2.4;
const DEPTH_M: f64 = 5.0;
const ROOM_M: f64 = 4.0;
const DOOR_M: f64 = 0.9;
/// What a wall takes (dB).
const LOSS_DB: f64 = 7.0;
/// Stops along the corridor, and nodes.
const STOPS: u32 = 60;
const NODES: u64 = 16;

/// Nodes are in the corridor and in the rooms; the robot weaves along the corridor. Doors are open.
pub(super) fn log(seed: Seed) -> Result<ReceptionLogAt, LawError> {
    let stops = (0..STOPS).map(|stop| {
        let side = if stop % 2 == 0 { -0.3 } else { 0.3 };
        Position::new((f64::from(stop) + 0.5) / f64::from(STOPS) * LENGTH_M, side * WIDTH_M, 0.0)
    });
    let nodes = (0..NODES).map(|node| {
        let draw = |axis| seed.uniform(SURROUNDINGS, [node, axis, 0]);
        Position::new(LENGTH_M * draw(0), (2.0 * draw(1) - 1.0) * (0.5 * WIDTH_M + DEPTH_M), 0.0)
    });
    let site = Site::of(seed, nodes.collect(), stops.collect());
    let walls = walls();
    let strength = |node: usize, stop: usize| {
        let link = [site.nodes[node], site.stops[stop]];
        let loss_db: f64 = walls.iter().map(|wall| if cross(link, *wall) { LOSS_DB } else { 0.0 }).sum();
        site.mean_dbm(node, stop) - loss_db + 3.0 * site.normal(SHADOWING, node, stop)
    };
    Ok((survey(&site, Listening::default(), &strength, &none_lost)?, site.nodes))
}

/// The walls of the rooms: between them, and along the corridor beside each door.
fn walls() -> Vec<Wall> {
    let mut walls = Vec::new();
    let mut at_m = 0.0;
    while at_m < LENGTH_M {
        for side in [-1.0, 1.0] {
            let (near_m, far_m) = (side * 0.5 * WIDTH_M, side * (0.5 * WIDTH_M + DEPTH_M));
            walls.push([Position::new(at_m, near_m, 0.0), Position::new(at_m, far_m, 0.0)]);
            let door_m = at_m + 0.5 * (ROOM_M - DOOR_M);
            walls.push([Position::new(at_m, near_m, 0.0), Position::new(door_m, near_m, 0.0)]);
            walls.push([Position::new(door_m + DOOR_M, near_m, 0.0), Position::new(at_m + ROOM_M, near_m, 0.0)]);
        }
        at_m += ROOM_M;
    }
    walls
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_link_through_a_door_meets_no_wall_and_one_beside_it_does() {
        let walls = walls();
        let met = |x_m: f64| {
            let link = [Position::new(x_m, 0.0, 0.0), Position::new(x_m, 3.0, 0.0)];
            walls.iter().filter(|wall| cross(link, **wall)).count()
        };
        assert_eq!((met(2.0), met(0.7)), (0, 1));
    }
}
