//! Stops at which the receiver was dead.

use sextant_channel::ReceptionLog;
use sextant_kernel::{Interrupted, Watch};

/// Logarithm of the probability below which silence is not by chance: one in three million.
const IMPOSSIBLE: f64 = -15.0;
/// Other stops that are asked, the nearest.
const NEIGHBOURS: usize = 6;
/// Packets that the middle one of them must have heard.
const HEARD_NEARBY: u64 = 3;

/// Whether each stop heard nothing at all although, by the curve, that is all but impossible and although most of the
/// stops nearest to it did hear something. `ln_silence` has the logarithm of the probability of hearing nothing at it.
pub(super) fn find(log: &ReceptionLog, ln_silence: &[f64], watch: &dyn Watch) -> Result<Vec<bool>, Interrupted> {
    let mut heard = vec![0_u64; log.stops().len()];
    for reception in log.receptions() {
        heard[reception.stop as usize] += u64::from(reception.received);
    }
    let is_dead =
        |stop: usize| heard[stop] == 0 && ln_silence[stop] < IMPOSSIBLE && nearby(log, stop, &heard) >= HEARD_NEARBY;
    (0..heard.len()).map(|stop| watch.check().map(|()| is_dead(stop))).collect()
}

/// Packets heard at the middle one of the stops nearest to `stop`.
fn nearby(log: &ReceptionLog, stop: usize, heard: &[u64]) -> u64 {
    let place = log.stops()[stop].position;
    let mut others: Vec<(f64, u64)> = (0..heard.len())
        .filter(|&other| other != stop)
        .map(|other| (log.stops()[other].position.distance_m(place), heard[other]))
        .collect();
    others.sort_by(|a, b| a.0.total_cmp(&b.0));
    others.truncate(NEIGHBOURS);
    others.sort_by_key(|&(_, heard)| heard);
    others.get(others.len() / 2).map_or(0, |&(_, heard)| heard)
}
