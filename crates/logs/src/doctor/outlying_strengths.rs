//! Single strengths that no place of their node explains.

use sextant_channel::ReceptionLog;
use sextant_kernel::text::listed;
use sextant_mapper::{GrossStrength, gross_strengths};

use super::finding::Finding;
use super::stop_text::stop_text;

/// What is odd of single strengths of `log`.
pub(super) fn finding(log: &ReceptionLog) -> Option<Finding> {
    let told = |&GrossStrength { node, stop, rssi_dbm, above_db, others }: &GrossStrength| {
        let side = if above_db > 0.0 { "above" } else { "below" };
        let name = &log.names()[node.index()];
        format!(
            "{name} at {}: {rssi_dbm:.0} dBm is {:.0} dB {side} what its other {others} strengths say",
            stop_text(log, stop),
            above_db.abs()
        )
    };
    let gross: Vec<String> = gross_strengths(log).iter().map(told).collect();
    (!gross.is_empty()).then(|| Finding {
        check: "outlying-strengths",
        odd: format!("strengths that no place of their node explains: {}", listed(&gross)),
        cost: "the link model leaves them out; other estimators may place these nodes metres away".to_owned(),
        remedy: "correct these rows, or leave them out".to_owned(),
    })
}
