//! TSCH, settings checked.

use std::time::Duration;

use sextant_kernel::SettingError;

use super::{
    BeaconsConfig, Hopping, JoiningConfig, MsfConfig, MsfRules, OrchestraConfig, OwnScheduleConfig, ScheduleConfig,
    SynchronisationConfig, Timeslot, TschConfig, UnicastConfig,
};
use crate::Phy;
use crate::tsch::frame::EnhancedAck;

/// Most frames that wait for a neighbour.
const MOST_FRAMES: u16 = 10_000;

/// Most further transmissions of a frame.
const MOST_RETRIES: u8 = 15;

/// Largest back-off exponent.
const GREATEST_BE: u8 = 8;

/// HOUSEKEEPINGCOLLISION_PERIOD, WAIT_DURATION_MIN, WAIT_DURATION_MAX and QUARANTINE_DURATION of MSF (RFC 9033, table 2; s).
const MSF_TIMES_S: [u64; 4] = [60, 30, 60, 300];

/// Most channel offsets of MSF (NUM_CH_OFFSET).
const MOST_OFFSETS: u16 = 16;

/// The exponents of the back-off in shared cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BackoffExponents {
    /// After the first failure.
    pub least: u8,
    /// The largest one.
    pub greatest: u8,
}

/// When stations may send and listen.
#[derive(Clone, Debug, PartialEq)]
pub enum ScheduleKind {
    /// One cell, which all share, in slotframes of this length (slots).
    Minimal(u16),
    /// Cells by the numbers of the stations.
    Orchestra(OrchestraConfig),
    /// Cells that stations agree on with their parents.
    Msf(MsfConfig),
    /// The cells of each station, whose names are not known yet.
    Own(OwnScheduleConfig),
}

/// How nodes join and keep the time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Synchronisation {
    /// Whether they scan at the start, or are in the network.
    pub joining: JoiningConfig,
    /// After so long without a correction, a node asks for one.
    pub keep_alive: Duration,
    /// After so long without a correction, it has lost the network.
    pub lost_after: Duration,
}

/// TSCH, settings checked.
#[derive(Clone, Debug, PartialEq)]
pub struct TschSettings {
    /// When stations may send and listen.
    pub schedule: ScheduleKind,
    /// The channels.
    pub hopping: Hopping,
    /// What happens when within a slot.
    pub timeslot: Timeslot,
    /// Further transmissions of a frame without acknowledgement.
    pub max_retries: u8,
    /// Of the back-off in shared cells.
    pub exponents: BackoffExponents,
    /// Frames that wait for each neighbour.
    pub queue_frames: u16,
    /// Longest time between the beacons of a station; `None` if none are sent.
    pub beacon_interval: Option<Duration>,
    /// How nodes join and keep the time.
    pub synchronisation: Synchronisation,
}

impl TschSettings {
    /// The settings for radios of a physical layer.
    ///
    /// # Errors
    /// If a number is out of range, or settings do not fit together. The keys are those of the table.
    pub fn new(config: TschConfig, phy: Phy) -> Result<Self, SettingError> {
        let TschConfig { schedule, hopping, max_retries, min_be, max_be, queue_frames, .. } = config;
        let TschConfig { timeslot, beacons, synchronisation, .. } = config;
        let schedule = schedule_kind(schedule).map_err(|error| error.within("schedule"))?;
        let hopping = match hopping {
            Some(channels) => Hopping::new(channels, phy)?,
            None => Hopping::usual(phy),
        };
        if max_retries > MOST_RETRIES {
            return Err(SettingError::new("max_retries", max_retries, format!("0 to {MOST_RETRIES}")));
        }
        if max_be > GREATEST_BE {
            return Err(SettingError::new("max_be", max_be, format!("0 to {GREATEST_BE}")));
        }
        if min_be > max_be {
            return Err(SettingError::new("min_be", min_be, format!("0 to max_be, which is {max_be}")));
        }
        if !(1..=MOST_FRAMES).contains(&queue_frames) {
            return Err(SettingError::new("queue_frames", queue_frames, format!("1 to {MOST_FRAMES}")));
        }
        let timeslot = Timeslot::new(timeslot, phy, EnhancedAck::MOST_OCTETS);
        let timeslot = timeslot.map_err(|error| error.within("timeslot"))?;
        let beacon_interval = match beacons {
            None => None,
            Some(BeaconsConfig { interval_s }) => {
                let checked = SettingError::in_range("interval_s", interval_s, 0.01, 1e5);
                Some(Duration::from_secs_f64(checked.map_err(|error| error.within("beacons"))?))
            }
        };
        let synchronisation = synchronised(synchronisation).map_err(|error| error.within("synchronisation"))?;
        if synchronisation.joining == JoiningConfig::ByScan && beacon_interval.is_none() {
            let needed = "the table, because nodes with `joining = \"by_scan\"` wait for enhanced beacons";
            return Err(SettingError::missing("beacons", needed));
        }
        let exponents = BackoffExponents { least: min_be, greatest: max_be };
        Ok(Self {
            schedule,
            hopping,
            timeslot,
            max_retries,
            exponents,
            queue_frames,
            beacon_interval,
            synchronisation,
        })
    }

    /// The lengths of its slotframes (slots), with their keys below `schedule`.
    #[must_use]
    pub fn slotframes(&self) -> Vec<(&'static str, u16)> {
        match &self.schedule {
            ScheduleKind::Minimal(slotframe) => vec![("minimal.slotframe", *slotframe)],
            ScheduleKind::Own(own) => vec![("own.slotframe", own.slotframe)],
            ScheduleKind::Msf(msf) => vec![("msf.slotframe", msf.slotframe)],
            ScheduleKind::Orchestra(orchestra) => vec![
                ("orchestra.beacon_slotframe", orchestra.beacon_slotframe),
                ("orchestra.unicast_slotframe", orchestra.unicast_slotframe),
                ("orchestra.shared_slotframe", orchestra.shared_slotframe),
            ],
        }
    }

    /// The numbers of MSF, if that is the schedule.
    #[must_use]
    pub fn msf(&self) -> Option<MsfRules> {
        let ScheduleKind::Msf(msf) = &self.schedule else { return None };
        let slots = |seconds: u64| {
            let slots = Duration::from_secs(seconds).as_nanos().div_ceil(self.timeslot.length().as_nanos());
            u64::try_from(slots).expect("few minutes have few slots")
        };
        let [housekeeping_s, least_wait_s, longest_wait_s, quarantine_s] = MSF_TIMES_S;
        let windows = (1_u64 << self.exponents.greatest) - 1;
        Some(MsfRules {
            length: msf.slotframe,
            channels: u16::try_from(self.hopping.channels().len()).unwrap_or(u16::MAX).min(MOST_OFFSETS),
            max_num_cells: msf.max_num_cells,
            used_high: msf.lim_num_cells_used_high,
            used_low: msf.lim_num_cells_used_low,
            housekeeping: slots(housekeeping_s),
            waits: [slots(least_wait_s), slots(longest_wait_s)],
            quarantine: slots(quarantine_s),
            timeout: windows.max(1) * u64::from(self.max_retries.max(1)) * u64::from(msf.slotframe),
        })
    }

    /// Whether a station listens in the cells of those that send to it, so that it must know them.
    #[must_use]
    pub fn needs_senders(&self) -> bool {
        matches!(&self.schedule, ScheduleKind::Orchestra(rules) if rules.unicast == UnicastConfig::SenderBased)
    }
}

fn schedule_kind(config: ScheduleConfig) -> Result<ScheduleKind, SettingError> {
    let length = |key: &str, slots: u16| {
        if slots == 0 { Err(SettingError::new(key, slots, "1 to 65535")) } else { Ok(slots) }
    };
    match config {
        ScheduleConfig::Minimal(minimal) => length("minimal.slotframe", minimal.slotframe).map(ScheduleKind::Minimal),
        ScheduleConfig::Orchestra(orchestra) => {
            length("orchestra.beacon_slotframe", orchestra.beacon_slotframe)?;
            length("orchestra.unicast_slotframe", orchestra.unicast_slotframe)?;
            length("orchestra.shared_slotframe", orchestra.shared_slotframe)?;
            Ok(ScheduleKind::Orchestra(orchestra))
        }
        ScheduleConfig::Msf(msf) => {
            let MsfConfig { slotframe, max_num_cells, lim_num_cells_used_high: high, lim_num_cells_used_low: low } =
                msf;
            let refuse =
                |key: &str, found: u16, allowed: String| SettingError::new(format!("msf.{key}"), found, allowed);
            if slotframe < 3 {
                return Err(refuse("slotframe", slotframe, "3 to 65535".to_owned()));
            }
            if !(4..=10_000).contains(&max_num_cells) {
                return Err(refuse("max_num_cells", max_num_cells, "4 to 10000".to_owned()));
            }
            if high > max_num_cells {
                let allowed = format!("0 to max_num_cells, which is {max_num_cells}");
                return Err(refuse("lim_num_cells_used_high", high, allowed));
            }
            if low > high {
                let allowed = format!("0 to lim_num_cells_used_high, which is {high}");
                return Err(refuse("lim_num_cells_used_low", low, allowed));
            }
            Ok(ScheduleKind::Msf(msf))
        }
        ScheduleConfig::Own(own) => {
            length("own.slotframe", own.slotframe)?;
            if own.cells.is_empty() && own.file.is_none() {
                return Err(SettingError::missing("own.cells", "at least one cell, or a `file` of cells"));
            }
            Ok(ScheduleKind::Own(own))
        }
    }
}

fn synchronised(config: SynchronisationConfig) -> Result<Synchronisation, SettingError> {
    let SynchronisationConfig { joining, keep_alive_s, lost_after_s } = config;
    let keep_alive_s = SettingError::in_range("keep_alive_s", keep_alive_s, 0.1, 1e5)?;
    let lost_after_s = SettingError::in_range("lost_after_s", lost_after_s, keep_alive_s, 1e6)?;
    let [keep_alive, lost_after] = [keep_alive_s, lost_after_s].map(Duration::from_secs_f64);
    Ok(Synchronisation { joining, keep_alive, lost_after })
}

#[cfg(test)]
mod tests {
    use super::super::{CellConfig, MinimalConfig, TimeslotConfig};
    use super::*;

    fn written() -> TschConfig {
        TschConfig {
            schedule: ScheduleConfig::Minimal(MinimalConfig::default()),
            hopping: None,
            max_retries: 3,
            min_be: 1,
            max_be: 7,
            queue_frames: 16,
            timeslot: TimeslotConfig::default(),
            beacons: None,
            synchronisation: SynchronisationConfig::default(),
        }
    }

    fn key(config: TschConfig) -> Option<String> {
        TschSettings::new(config, Phy::Oqpsk2450).err().map(|error| error.key)
    }

    #[test]
    fn the_defaults_are_good() {
        let settings = TschSettings::new(written(), Phy::Oqpsk2450).expect("good settings");
        assert_eq!(settings.slotframes(), [("minimal.slotframe", 101)]);
        assert_eq!(settings.hopping.channels().len(), 16);
    }

    #[test]
    fn the_numbers_of_msf_are_those_of_its_standard() {
        let written = TschConfig { schedule: ScheduleConfig::Msf(MsfConfig::default()), max_be: 5, ..written() };
        let rules = TschSettings::new(written, Phy::Oqpsk2450).expect("good settings").msf();
        let expected = MsfRules {
            length: 101,
            channels: 16,
            max_num_cells: 100,
            used_high: 75,
            used_low: 25,
            housekeeping: 6000,
            waits: [3000, 6000],
            quarantine: 30_000,
            // ((2^5) - 1) 3 101 slots (section 9).
            timeout: 9393,
        };
        assert_eq!(rules, Some(expected));
    }

    #[test]
    fn settings_of_msf_out_of_range_are_rejected_with_their_keys() {
        let key = |msf| key(TschConfig { schedule: ScheduleConfig::Msf(msf), ..written() });
        let usual = MsfConfig::default();
        for (msf, expected) in [
            (MsfConfig { slotframe: 2, ..usual }, "slotframe"),
            (MsfConfig { max_num_cells: 3, ..usual }, "max_num_cells"),
            (MsfConfig { lim_num_cells_used_high: 101, ..usual }, "lim_num_cells_used_high"),
            (MsfConfig { lim_num_cells_used_low: 76, ..usual }, "lim_num_cells_used_low"),
        ] {
            assert_eq!(key(msf), Some(format!("schedule.msf.{expected}")));
        }
    }

    #[test]
    fn settings_out_of_range_are_rejected_with_their_keys() {
        let minimal = |slotframe| ScheduleConfig::Minimal(MinimalConfig { slotframe });
        assert_eq!(
            key(TschConfig { schedule: minimal(0), ..written() }).as_deref(),
            Some("schedule.minimal.slotframe")
        );
        let orchestra = OrchestraConfig { shared_slotframe: 0, ..OrchestraConfig::default() };
        let orchestra = ScheduleConfig::Orchestra(orchestra);
        assert_eq!(
            key(TschConfig { schedule: orchestra, ..written() }).as_deref(),
            Some("schedule.orchestra.shared_slotframe")
        );
        let own = |cells| ScheduleConfig::Own(OwnScheduleConfig { slotframe: 5, cells, file: None });
        assert_eq!(key(TschConfig { schedule: own(Vec::new()), ..written() }).as_deref(), Some("schedule.own.cells"));
        let cell = CellConfig {
            node: "*".to_owned(),
            peer: "*".to_owned(),
            timeslot: 0,
            channel_offset: 0,
            options: "transmit".to_owned(),
        };
        assert_eq!(key(TschConfig { schedule: own(vec![cell]), ..written() }), None);
        assert_eq!(key(TschConfig { max_retries: 16, ..written() }).as_deref(), Some("max_retries"));
        assert_eq!(key(TschConfig { max_be: 9, ..written() }).as_deref(), Some("max_be"));
        assert_eq!(key(TschConfig { min_be: 8, ..written() }).as_deref(), Some("min_be"));
        assert_eq!(key(TschConfig { queue_frames: 0, ..written() }).as_deref(), Some("queue_frames"));
        let slot = TimeslotConfig { length_us: 5000, ..TimeslotConfig::default() };
        assert_eq!(key(TschConfig { timeslot: slot, ..written() }).as_deref(), Some("timeslot.length_us"));
        let beacons = Some(BeaconsConfig { interval_s: f64::NAN });
        assert_eq!(key(TschConfig { beacons, ..written() }).as_deref(), Some("beacons.interval_s"));
        let keep = |keep_alive_s, lost_after_s| TschConfig {
            synchronisation: SynchronisationConfig { keep_alive_s, lost_after_s, ..SynchronisationConfig::default() },
            ..written()
        };
        assert_eq!(key(keep(0.0, 1.0)).as_deref(), Some("synchronisation.keep_alive_s"));
        assert_eq!(key(keep(10.0, 5.0)).as_deref(), Some("synchronisation.lost_after_s"));
        let by_scan = SynchronisationConfig { joining: JoiningConfig::ByScan, ..SynchronisationConfig::default() };
        assert_eq!(key(TschConfig { synchronisation: by_scan, ..written() }).as_deref(), Some("beacons"));
    }
}
