//! Receivers whose strengths are coarse and have a ceiling.

use sextant_channel::{Reception, ReceptionLog};
use sextant_kernel::Seed;

use super::independent_shadowing::usual_dbm;
use super::survey::{Listening, SENSITIVITY_DBM, none_lost, survey};
use super::{LawError, ReceptionLogAt, Site};

/// The name of the law.
pub(super) const NAME: &str = "rounded-strengths";

/// Steps of the strengths (dB), and how far the greatest is above the sensitivity (dB).
const STEP_DB: f64 = 5.0;
const CEILING_DB: f64 = 20.0;

/// Strengths in steps of 5 dB that end 20 dB above the sensitivity.
pub(super) fn log(seed: Seed) -> Result<ReceptionLogAt, LawError> {
    let site = Site::hall(seed, 16);
    let strength = |node, stop| usual_dbm(&site, node, stop);
    let fine = survey(&site, Listening::default(), &strength, &none_lost)?;
    let coarse = |rssi_dbm: f64| (rssi_dbm / STEP_DB).round() * STEP_DB;
    let receptions = fine.receptions().iter().map(|reception| Reception {
        rssi_dbm: reception.rssi_dbm.map(|rssi_dbm| coarse(rssi_dbm).min(SENSITIVITY_DBM + CEILING_DB)),
        ..reception
    });
    let log = ReceptionLog::new(fine.names().to_vec(), fine.stops().to_vec(), receptions.collect(), Vec::new())?;
    Ok((log, site.nodes))
}
