//! All walls are on one side of the hall.

use sextant_channel::Position;
use sextant_kernel::Seed;

use super::site::HALL_M;
use super::survey::{Listening, SHADOWING, none_lost, survey};
use super::walls::{Wall, cross};
use super::{LawError, ReceptionLogAt, Site};

/// The name of the law.
pub(super) const NAME: &str = "walled-side";

/// Where the walled side begins, and the distance of its walls (m); what each takes (dB).
const FROM_M: f64 = 12.0;
const APART_M: f64 = 4.0;
const LOSS_DB: f64 = 9.0;

/// The west is open. The east is cut into cells of 4 m by walls without doors.
pub(super) fn log(seed: Seed) -> Result<ReceptionLogAt, LawError> {
    let site = Site::hall(seed, 16);
    let along = |count: u32| (0..count).map(|number| APART_M * f64::from(number));
    let across = along(4).map(|off_m| {
        let x_m = FROM_M + off_m;
        [Position::new(x_m, -1.0, 0.0), Position::new(x_m, HALL_M[1] + 1.0, 0.0)]
    });
    let lengthwise = along(5).map(|y_m| [Position::new(FROM_M, y_m, 0.0), Position::new(HALL_M[0] + 1.0, y_m, 0.0)]);
    let walls: Vec<Wall> = across.chain(lengthwise).collect();
    let strength = |node: usize, stop: usize| {
        let link = [site.nodes[node], site.stops[stop]];
        let loss_db: f64 = walls.iter().map(|wall| if cross(link, *wall) { LOSS_DB } else { 0.0 }).sum();
        site.mean_dbm(node, stop) - loss_db + 2.0 * site.normal(SHADOWING, node, stop)
    };
    Ok((survey(&site, Listening::default(), &strength, &none_lost)?, site.nodes))
}
