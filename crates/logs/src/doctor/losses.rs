//! Packets that are lost however strong the signal is.

use sextant_channel::ReceptionLog;

use super::finding::Finding;

/// Fewer pairs of a node and a stop with strengths say nothing.
const LEAST: usize = 40;
/// The strongest quarter of the links loses at least this share of its packets.
const NOTABLE: f64 = 0.08;
/// And at least this share of what the second quarter loses, so that loss there does not come from power.
const FLAT: f64 = 0.5;
/// The strengths of the strongest quarter are above those of the weakest by at least this (dB).
const SPREAD_DB: f64 = 6.0;

/// What is odd of losses that do not depend on strength.
pub(super) fn finding(log: &ReceptionLog) -> Option<Finding> {
    let mut heard: Vec<(f64, u32, u32)> = log
        .receptions()
        .iter()
        .filter(|reception| reception.received > 0 && reception.sent > 1)
        .filter_map(|reception| Some((reception.rssi_dbm?, reception.received, reception.sent)))
        .filter(|(strength_dbm, ..)| *strength_dbm < 0.0)
        .collect();
    if heard.len() < LEAST {
        return None;
    }
    heard.sort_by(|a, b| b.0.total_cmp(&a.0));
    let quarter = heard.len() / 4;
    let lost = |links: &[(f64, u32, u32)]| {
        let received: f64 = links.iter().map(|(_, received, _)| f64::from(*received)).sum();
        let sent: f64 = links.iter().map(|(.., sent)| f64::from(*sent)).sum();
        1.0 - received / sent
    };
    let [first, second] = [lost(&heard[..quarter]), lost(&heard[quarter..2 * quarter])];
    let middle_dbm = |from: usize| heard[from + quarter / 2].0;
    let spread_db = middle_dbm(0) - middle_dbm(3 * quarter);
    (first >= NOTABLE && first >= FLAT * second && spread_db >= SPREAD_DB).then(|| Finding {
        check: "flat-losses",
        odd: format!(
            "{:.0} % of the packets are lost on the strongest quarter of the links (around {:.0} dBm), {:.0} % on the next \
             (around {:.0} dBm): power is not why",
            100.0 * first,
            middle_dbm(0),
            100.0 * second,
            middle_dbm(quarter)
        ),
        cost: "estimators that take a lost packet for a weak signal place these nodes too far from their stops".to_owned(),
        remedy: "count in `sent` only what was sent while the receiver listened on that channel (phones scan in windows), or \
                 leave `sent` out and keep the strengths"
            .to_owned(),
    })
}
