//! Stops at which the receiver did not work.

use sextant_channel::{ReceptionLog, Stop};
use sextant_kernel::{Interrupted, Watch};

/// Silence with a probability below this is not by chance (logarithm): one in three million.
const IMPOSSIBLE: f64 = -15.0;
/// Number of nearest stops that are compared.
const NEIGHBOURS: usize = 6;
/// Least number of packets that the median of them must have heard.
const HEARD_NEARBY: u64 = 3;

/// Whether each stop is dead: it heard nothing, although this is nearly impossible by the curve, and although most of
/// the nearest stops heard something. `ln_silence` holds, for each stop, the logarithm of the probability of hearing
/// nothing, and `heard` the packets that it heard of all nodes.
pub(super) fn find(
    stops: &[Stop],
    heard: &[u64],
    ln_silence: &[f64],
    watch: &dyn Watch,
) -> Result<Vec<bool>, Interrupted> {
    let is_dead =
        |stop: usize| heard[stop] == 0 && ln_silence[stop] < IMPOSSIBLE && nearby(stops, stop, heard) >= HEARD_NEARBY;
    (0..heard.len()).map(|stop| watch.check().map(|()| is_dead(stop))).collect()
}

/// Adds the packets of all nodes of `log` that each stop heard to `heard`.
pub(crate) fn add_heard(log: &ReceptionLog, heard: &mut [u64]) {
    for reception in log.receptions() {
        heard[reception.stop as usize] += u64::from(reception.received);
    }
}

/// Median number of packets heard at the stops nearest to `stop`.
fn nearby(stops: &[Stop], stop: usize, heard: &[u64]) -> u64 {
    let place = stops[stop].position;
    let mut others: Vec<(f64, u64)> = (0..heard.len())
        .filter(|&other| other != stop)
        .map(|other| (stops[other].position.distance_m(place), heard[other]))
        .collect();
    others.sort_by(|a, b| a.0.total_cmp(&b.0));
    others.truncate(NEIGHBOURS);
    others.sort_by_key(|&(_, heard)| heard);
    others.get(others.len() / 2).map_or(0, |&(_, heard)| heard)
}
