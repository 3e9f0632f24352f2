//! Transmit sectors of a station, and the order in which it sweeps them.

use std::time::Duration;

use sextant_kernel::SettingError;

use super::timing::{LBIFS, SBIFS, SSW_AIRTIME};

/// Most DMG antennas of a station.
pub const MAX_ANTENNAS: usize = 4;
/// Most sectors of one DMG antenna.
pub const MAX_ANTENNA_SECTORS: u8 = 64;
/// Most sectors of a station.
pub const MAX_SECTORS: u16 = 128;

/// A transmit sector of a station.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct TxSector {
    /// DMG antenna ID: 0 to 3.
    pub antenna: u8,
    /// Sector ID of that antenna: 0 to 63.
    pub sector: u8,
}

impl TxSector {
    /// This sector of the first DMG antenna.
    #[must_use]
    pub const fn first_antenna(sector: u8) -> Self {
        Self { antenna: 0, sector }
    }
}

/// How many sectors each DMG antenna of a station has. A sweep goes through them antenna by antenna.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SectorLayout {
    sectors: [u8; MAX_ANTENNAS],
}

impl SectorLayout {
    /// One count of sectors per DMG antenna.
    ///
    /// # Errors
    /// If there are not 1 to 4 antennas, if one has not 1 to 64 sectors, or if together they have more than 128.
    pub fn new(sectors_per_antenna: &[u8]) -> Result<Self, SettingError> {
        if !(1..=MAX_ANTENNAS).contains(&sectors_per_antenna.len()) {
            return Err(SettingError::new("antennas", sectors_per_antenna.len(), "1 to 4 DMG antennas"));
        }
        for &count in sectors_per_antenna {
            if !(1..=MAX_ANTENNA_SECTORS).contains(&count) {
                return Err(SettingError::new("sectors", count, "1 to 64 sectors per DMG antenna"));
            }
        }
        let total: u16 = sectors_per_antenna.iter().copied().map(u16::from).sum();
        if total > MAX_SECTORS {
            return Err(SettingError::new("sectors", total, "at most 128 sectors of all DMG antennas"));
        }
        let mut sectors = [0; MAX_ANTENNAS];
        sectors[..sectors_per_antenna.len()].copy_from_slice(sectors_per_antenna);
        Ok(Self { sectors })
    }

    /// Number of sectors, 1 to 128: the frames of a sweep.
    #[must_use]
    pub fn total(&self) -> u16 {
        self.sectors.iter().copied().map(u16::from).sum()
    }

    /// Number of DMG antennas, 1 to 4.
    #[must_use]
    pub fn antennas(&self) -> u8 {
        self.sectors.iter().map(|&count| u8::from(count > 0)).sum()
    }

    /// The sector of the frame `index` of a sweep.
    ///
    /// # Panics
    /// If the sweep has no such frame.
    #[must_use]
    pub fn sector(&self, index: u16) -> TxSector {
        let mut left = index;
        for (antenna, &count) in (0..).zip(&self.sectors) {
            match left.checked_sub(u16::from(count)) {
                Some(rest) => left = rest,
                None => return TxSector { antenna, sector: u8::try_from(left).expect("at most 63") },
            }
        }
        panic!("a sweep of {} sectors has no frame {index}", self.total())
    }

    /// The silence between the frame `index` of a sweep and the next: LBIFS if the DMG antenna changes, else SBIFS.
    ///
    /// # Panics
    /// If one of the two is not in the sweep.
    #[must_use]
    pub fn gap_after(&self, index: u16) -> Duration {
        if self.sector(index).antenna == self.sector(index + 1).antenna { SBIFS } else { LBIFS }
    }

    /// Time from the start of the first frame of a sweep with SSW frames to the end of its last.
    #[must_use]
    pub fn sweep_duration(&self) -> Duration {
        SSW_AIRTIME + self.remaining_after(0, SSW_AIRTIME)
    }

    /// Time from the end of the frame `index` of a sweep to the end of its last, with frames of this `airtime`.
    #[must_use]
    pub fn remaining_after(&self, index: u16, airtime: Duration) -> Duration {
        let frames = u32::from(self.total() - 1 - index);
        let changes = u32::from(self.antennas() - 1 - self.sector(index).antenna);
        (airtime + SBIFS) * frames + (LBIFS - SBIFS) * changes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout(sectors: &[u8]) -> SectorLayout {
        SectorLayout::new(sectors).expect("a good layout")
    }

    #[test]
    fn sweeps_of_one_antenna_last_as_the_frames_and_the_gaps_between_them() {
        for (sectors, ns) in [(1, 14_909), (4, 62_636), (8, 126_272), (16, 253_544), (32, 508_088), (64, 1_017_176)] {
            assert_eq!(layout(&[sectors]).sweep_duration(), Duration::from_nanos(ns), "{sectors} sectors");
        }
    }

    #[test]
    fn a_change_of_the_antenna_takes_lbifs_instead_of_sbifs() {
        // 128 sectors of two antennas: 2035.352 us, and 17 us more for the one change.
        assert_eq!(layout(&[64, 64]).sweep_duration(), Duration::from_nanos(2_035_352 + 17_000));
        let sweep = layout(&[2, 1, 3]);
        let sectors: Vec<_> = (0..6).map(|i| sweep.sector(i)).map(|s| (s.antenna, s.sector)).collect();
        assert_eq!(sectors, [(0, 0), (0, 1), (1, 0), (2, 0), (2, 1), (2, 2)]);
        let gaps: Vec<_> = (0..5).map(|i| sweep.gap_after(i).as_micros()).collect();
        assert_eq!(gaps, [1, 18, 18, 1, 1]);
        // What remains is what the frames and gaps after it add up to.
        for index in 0..6 {
            for airtime in [SSW_AIRTIME, Duration::from_nanos(306_600)] {
                let rest: Duration = (index..5).map(|i| sweep.gap_after(i) + airtime).sum();
                assert_eq!(sweep.remaining_after(index, airtime), rest, "after frame {index} of {airtime:?}");
            }
        }
    }

    #[test]
    fn layouts_beyond_the_fields_of_the_frames_are_rejected() {
        let refused = |sectors: &[u8]| SectorLayout::new(sectors).err().map(|error| error.key);
        assert_eq!(refused(&[]).as_deref(), Some("antennas"));
        assert_eq!(refused(&[1; 5]).as_deref(), Some("antennas"));
        assert_eq!(refused(&[8, 0]).as_deref(), Some("sectors"));
        assert_eq!(refused(&[65]).as_deref(), Some("sectors"));
        assert_eq!(refused(&[64, 64, 1]).as_deref(), Some("sectors"));
        assert_eq!(refused(&[32; 4]), None);
    }
}
