//! Packets arrive up to a distance and nowhere beyond, at stops round a hall.

use sextant_channel::Position;
use sextant_kernel::Seed;

use super::survey::{Listening, SENSITIVITY_DBM, SHADOWING, SHADOWING_DB, none_lost, survey};
use super::{LawError, ReceptionLogAt, Site};

/// The name of the law.
pub(super) const NAME: &str = "cut-off";

/// Size of the hall (m), and how far packets arrive (m): from its middle to the nearest stops.
const HALL_M: [f64; 2] = [16.0, 11.0];
const HEARD_M: f64 = 6.0;
/// Stops along the walls, and the nodes.
const STOPS: u32 = 40;
const NODES: u32 = 10;
/// Strength at the distance at which packets end (dBm), far above what a receiver needs.
const LAST_ABOVE_DB: f64 = 30.0;

/// Strengths fall with the logarithm of the distance, but a link longer than 6 m loses all packets, and a shorter one none.
pub(super) fn log(seed: Seed) -> Result<ReceptionLogAt, LawError> {
    let [width_m, depth_m] = HALL_M;
    let stops = (0..STOPS).map(|stop| {
        let along_m = 2.0 * (width_m + depth_m) * f64::from(stop) / f64::from(STOPS);
        let (x_m, y_m) = if along_m < width_m {
            (along_m, 0.0)
        } else if along_m < width_m + depth_m {
            (width_m, along_m - width_m)
        } else if along_m < 2.0 * width_m + depth_m {
            (2.0 * width_m + depth_m - along_m, depth_m)
        } else {
            (0.0, 2.0 * (width_m + depth_m) - along_m)
        };
        Position::new(x_m, y_m, 0.0)
    });
    let site = Site::of(seed, Site::within(seed, NODES, HALL_M), stops.collect());
    let strength = |node: usize, stop: usize| {
        let distance_m = site.nodes[node].distance_m(site.stops[stop]).max(0.3);
        if distance_m > HEARD_M {
            return f64::NEG_INFINITY;
        }
        let above_db = 10.0 * site.exponent * libm::log10(HEARD_M / distance_m);
        SENSITIVITY_DBM + LAST_ABOVE_DB + above_db + SHADOWING_DB * site.normal(SHADOWING, node, stop)
    };
    Ok((survey(&site, Listening::default(), &strength, &none_lost)?, site.nodes))
}
