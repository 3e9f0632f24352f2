//! Stops at which the receiver did not work.

use sextant_channel::ReceptionLog;
use sextant_kernel::{Interrupted, Watch};

/// Silence with a probability below this is not by chance (logarithm): one in three million.
const IMPOSSIBLE: f64 = -15.0;
/// Number of nearest stops that are compared.
const NEIGHBOURS: usize = 6;
/// Least number of packets that the median of them must have heard.
const HEARD_NEARBY: u64 = 3;

/// Whether each stop is dead: it heard nothing, although this is nearly impossible by the curve, and although most of
/// the nearest stops heard something. `ln_silence` holds, for each stop, the logarithm of the probability of hearing
/// nothing.
pub(super) fn find(log: &ReceptionLog, ln_silence: &[f64], watch: &dyn Watch) -> Result<Vec<bool>, Interrupted> {
    let mut heard = vec![0_u64; log.stops().len()];
    for reception in log.receptions() {
        heard[reception.stop as usize] += u64::from(reception.received);
    }
    let is_dead =
        |stop: usize| heard[stop] == 0 && ln_silence[stop] < IMPOSSIBLE && nearby(log, stop, &heard) >= HEARD_NEARBY;
    (0..heard.len()).map(|stop| watch.check().map(|()| is_dead(stop))).collect()
}

/// Median number of packets heard at the stops nearest to `stop`.
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
