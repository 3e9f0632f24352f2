//! Packets from a small part of the time of the path.

use sextant_kernel::SimTime;

use super::finding::Finding;
use crate::time::instant;

/// Packets from a smaller share of the time of the path are odd.
const LEAST_SHARE: f64 = 0.1;
/// Units that times may have by mistake, and the seconds in each.
const UNITS: [(&str, f64); 2] = [("minutes", 60.0), ("hours", 3600.0)];
/// Times in another unit fill at least this share of the path.
const FILLED: f64 = 0.5;

/// What is odd of packets from a time, if robots drove from another time on until another time.
pub(crate) fn finding(packets: (SimTime, SimTime), path: (SimTime, SimTime)) -> Option<Finding> {
    let seconds = |(from, to): (SimTime, SimTime)| to.saturating_since(from).as_secs_f64();
    let (heard_s, driven_s) = (seconds(packets), seconds(path));
    if heard_s >= LEAST_SHARE * driven_s {
        return None;
    }
    let (end_s, path_end_s) = (packets.1.as_secs_f64(), path.1.as_secs_f64());
    let fits = |&&(_, unit_s): &&(&str, f64)| end_s * unit_s <= path_end_s && heard_s * unit_s >= FILLED * driven_s;
    let remedy = match UNITS.iter().find(fits) {
        Some((name, unit_s)) => {
            format!("times in {name} would fill the path: are they? then give seconds, {unit_s} times as large")
        }
        None => "compare the times of packets and path; if the receiver was off, cut the path to the time in which it was on"
            .to_owned(),
    };
    Some(Finding {
        check: "packets-in-part",
        odd: format!(
            "all packets are from {:.1} % of the time of the path: {} to {} s of {} to {} s",
            100.0 * heard_s / driven_s,
            instant::format(packets.0),
            instant::format(packets.1),
            instant::format(path.0),
            instant::format(path.1)
        ),
        cost: "all other stops count as silent, which puts each node near the few stops that heard".to_owned(),
        remedy,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packets_from_a_small_part_of_the_path_are_told_with_the_unit_that_fits() {
        let at = |tenths: u64| SimTime::from_nanos(tenths * 100_000_000);
        let found = |from, to| finding((at(from), at(to)), (at(0), at(2200)));
        assert_eq!(found(0, 2000), None);
        let minutes = found(0, 36).expect("odd");
        assert!(minutes.odd.contains("1.6 % of the time of the path: 0 to 3.6 s of 0 to 220 s"), "{minutes}");
        assert!(minutes.remedy.contains("minutes"), "{minutes}");
        assert!(!found(1000, 1036).expect("odd").remedy.contains("minutes"));
    }
}
