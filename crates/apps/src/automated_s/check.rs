//! Where to listen for missing nodes after all lanes are driven.

use sextant_channel::Position;
use sextant_sim::Situation;

use super::knowledge::Knowledge;
use super::rules::Rules;
use super::trip::{Goal, Trip};
use super::view::{Move, View};

/// How often the robot returns for one node, per packet wanted.
const RETURNS_PER_PACKET: u32 = 2;

/// How often the robot returns for one node.
fn returns(rules: &Rules) -> u32 {
    rules.settings.packets_per_node.saturating_mul(RETURNS_PER_PACKET)
}

/// Whether there are nodes for which the robot knows no place to listen.
pub(super) fn misses_nodes(knowledge: &Knowledge, rules: &Rules) -> bool {
    knowledge.misses_nodes(rules.settings.packets_per_node, returns(rules))
}

/// A trip to a place where the robot may hear missing nodes. If some nodes were never heard, these are places that it
/// passed; then places where the missing nodes were heard best. A robot with an area does not know which nodes belong
/// to its area, so it visits gaps. `None` if no such place is left.
pub(super) fn next_trip(knowledge: &mut Knowledge, rules: &Rules, situation: &Situation<'_>) -> Option<Trip> {
    let here = situation.position;
    loop {
        let goal = if rules.area.is_some() {
            knowledge.nearest_gap(here, rules.covered_m()[0])
        } else {
            place_to_check(knowledge, rules, here)
        }?;
        let view = View { situation, last_move: Move::Free, rules, knowledge };
        if let Some(trip) = Trip::plan(&view, goal, Goal::Check) {
            return Some(trip);
        }
        knowledge.give_up_opening(goal);
    }
}

/// A place that the robot passed if there are nodes never heard, otherwise the place where missing nodes were heard
/// best.
fn place_to_check(knowledge: &mut Knowledge, rules: &Rules, here: Position) -> Option<Position> {
    let radii_m = rules.covered_m().into_iter().filter(|_| misses_nodes(knowledge, rules));
    let opening = { radii_m }.find_map(|radius_m| knowledge.nearest_opening(here, radius_m));
    opening.or_else(|| knowledge.place_to_listen_again(here, rules.settings.packets_per_node, returns(rules)))
}
