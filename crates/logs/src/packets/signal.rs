//! What was measured of the packets of a node at a stop.

use std::cmp::Ordering;

/// What was measured of some packets of one sector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Signal {
    /// The sector, if the listener has sectors.
    pub(crate) sector: Option<u8>,
    /// Packets of which the strength is known.
    measured: u32,
    /// Mean strength of the measured packets (dBm); NaN if there is none.
    rssi_dbm: f64,
    /// Highest signal-to-noise ratio (dB); NaN if none is known.
    snr_db: f64,
}

impl Signal {
    /// That of no packets.
    pub(crate) const NONE: Self = Self { sector: None, measured: 0, rssi_dbm: f64::NAN, snr_db: f64::NAN };

    /// The signal of `packets` packets whose mean strength is `rssi_dbm`.
    pub(crate) fn new(packets: u32, sector: Option<u8>, rssi_dbm: Option<f64>, snr_db: Option<f64>) -> Self {
        Self {
            sector,
            measured: if rssi_dbm.is_some() { packets } else { 0 },
            rssi_dbm: rssi_dbm.unwrap_or(f64::NAN),
            snr_db: snr_db.unwrap_or(f64::NAN),
        }
    }

    /// Mean strength (dBm), if it is known.
    pub(crate) fn rssi_dbm(&self) -> Option<f64> {
        Some(self.rssi_dbm).filter(|level| !level.is_nan())
    }

    /// Highest signal-to-noise ratio (dB), if it is known.
    pub(crate) fn snr_db(&self) -> Option<f64> {
        Some(self.snr_db).filter(|level| !level.is_nan())
    }

    /// Whether nothing is known of the packets.
    pub(crate) fn is_unknown(&self) -> bool {
        self.sector.is_none() && self.rssi_dbm.is_nan() && self.snr_db.is_nan()
    }

    /// Adds packets of the same sector, or of any: strengths are averaged over packets, in dBm.
    pub(crate) fn add(&mut self, other: &Self) {
        // `max` leaves NaN aside.
        self.snr_db = self.snr_db.max(other.snr_db);
        if other.rssi_dbm.is_nan() {
            return;
        }
        if self.rssi_dbm.is_nan() || self.measured == 0 && other.measured > 0 {
            (self.rssi_dbm, self.measured) = (other.rssi_dbm, other.measured);
        } else if other.measured > 0 {
            self.measured = self.measured.saturating_add(other.measured);
            self.rssi_dbm += (other.rssi_dbm - self.rssi_dbm) * f64::from(other.measured) / f64::from(self.measured);
        }
    }
}

/// The strength of some packets, if nothing else is measured: takes less memory than a [`Signal`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Strength {
    rssi_dbm: f64,
    measured: u32,
}

impl From<Signal> for Strength {
    fn from(Signal { rssi_dbm, measured, .. }: Signal) -> Self {
        Self { rssi_dbm, measured }
    }
}

impl From<Strength> for Signal {
    fn from(Strength { rssi_dbm, measured }: Strength) -> Self {
        Self { sector: None, measured, rssi_dbm, snr_db: f64::NAN }
    }
}

/// Packets received in one sector.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OfSector {
    pub(crate) received: u32,
    pub(crate) signal: Signal,
}

/// The signal of all packets of a node at a stop, from those of each sector. Its sector is the one with the best
/// reception: the strongest mean, or without strengths the most packets; of equal ones the first.
pub(crate) fn merged(mut sectors: impl Iterator<Item = OfSector>) -> Option<Signal> {
    let mut best = sectors.next()?;
    let mut all = best.signal;
    for other in sectors {
        all.add(&other.signal);
        let by_strength = match (other.signal.rssi_dbm(), best.signal.rssi_dbm()) {
            (Some(other), Some(best)) => other.total_cmp(&best),
            (Some(_), None) => Ordering::Greater,
            (None, Some(_)) => Ordering::Less,
            (None, None) => Ordering::Equal,
        };
        let heard = |of: &OfSector| of.received > 0 && of.signal.sector.is_some();
        let order = heard(&other).cmp(&heard(&best)).then(by_strength).then(other.received.cmp(&best.received));
        if order == Ordering::Greater {
            best = other;
        }
    }
    Some(Signal { sector: best.signal.sector, ..all })
}
