//! Transmit sectors of a station, and the order in which it sweeps them.

use std::time::Duration;

use sextant_kernel::SettingError;

use super::timing::{LBIFS, SBIFS, SSW_AIRTIME};

/// Most DMG antennas of a station.
pub(crate) const MAX_ANTENNAS: usize = 4;
/// Most sectors of one DMG antenna.
pub(crate) const MAX_ANTENNA_SECTORS: u8 = 64;
/// Most sectors of a station.
pub(crate) const MAX_SECTORS: u16 = 128;

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

/// The sectors of each DMG antenna of a station, by their identities on air. A sweep goes through them antenna by
/// antenna, each in ascending order. Identities may have gaps: those of a measured code book do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SectorLayout {
    /// By DMG antenna: bit `i` is set if it has the sector with identity `i`.
    identities: [u64; MAX_ANTENNAS],
}

impl SectorLayout {
    /// One count of sectors per DMG antenna, whose identities are 0 and up.
    ///
    /// # Errors
    /// If there are not 1 to 4 antennas, if one has not 1 to 64 sectors, or if together they have more than 128.
    pub fn new(sectors_per_antenna: &[u8]) -> Result<Self, SettingError> {
        if !(1..=MAX_ANTENNAS).contains(&sectors_per_antenna.len()) {
            return Err(SettingError::new("antennas", sectors_per_antenna.len(), "1 to 4 DMG antennas"));
        }
        if let Some(bad) = sectors_per_antenna.iter().find(|&count| !(1..=MAX_ANTENNA_SECTORS).contains(count)) {
            return Err(SettingError::new("sectors", bad, "1 to 64 sectors per DMG antenna"));
        }
        Self::of(
            (0..)
                .zip(sectors_per_antenna)
                .flat_map(|(antenna, &count)| (0..count).map(move |sector| TxSector { antenna, sector })),
        )
    }

    /// These sectors, in any order.
    ///
    /// # Errors
    /// If there are none or more than 128, if one appears twice or has an identity beyond its field, or if a DMG antenna
    /// before the last one has no sector.
    pub fn of(sectors: impl IntoIterator<Item = TxSector>) -> Result<Self, SettingError> {
        let mut identities = [0_u64; MAX_ANTENNAS];
        for TxSector { antenna, sector } in sectors {
            let Some(known) = identities.get_mut(usize::from(antenna)) else {
                return Err(SettingError::new("antennas", format!("DMG antenna {antenna}"), "DMG antennas 0 to 3"));
            };
            if sector >= MAX_ANTENNA_SECTORS {
                return Err(SettingError::new("sectors", format!("sector {sector}"), "sectors 0 to 63"));
            }
            let bit = 1_u64 << sector;
            if *known & bit != 0 {
                let found = format!("sector {sector} of DMG antenna {antenna} twice");
                return Err(SettingError::new("sectors", found, "each sector once"));
            }
            *known |= bit;
        }
        let layout = Self { identities };
        let used = identities.iter().filter(|&&known| known > 0).count();
        if used == 0 || identities[..used].contains(&0) {
            let found = format!("{used} DMG antennas with sectors");
            return Err(SettingError::new("antennas", found, "1 to 4 DMG antennas from 0 on, each with sectors"));
        }
        if layout.total() > MAX_SECTORS {
            return Err(SettingError::new("sectors", layout.total(), "at most 128 sectors of all DMG antennas"));
        }
        Ok(layout)
    }

    /// Number of sectors, 1 to 128: the frames of a sweep.
    #[must_use]
    pub fn total(&self) -> u16 {
        self.identities.iter().copied().map(count).sum()
    }

    /// Number of DMG antennas, 1 to 4.
    #[must_use]
    pub fn antennas(&self) -> u8 {
        self.identities.iter().map(|&known| u8::from(known > 0)).sum()
    }

    /// The sector of the frame `index` of a sweep.
    ///
    /// # Panics
    /// If the sweep has no such frame.
    #[must_use]
    pub fn sector(&self, index: u16) -> TxSector {
        let mut left = index;
        for (antenna, &known) in (0..).zip(&self.identities) {
            match left.checked_sub(count(known)) {
                Some(rest) => left = rest,
                None => {
                    // Without gaps the identity is the place; else it is the lowest bit that is left after so many.
                    let is_dense = known & known.wrapping_add(1) == 0;
                    let nth = || (0..left).fold(known, |rest, _| rest & (rest - 1)).trailing_zeros();
                    let sector = if is_dense { u32::from(left) } else { nth() };
                    let sector = u8::try_from(sector).expect("at most 63");
                    return TxSector { antenna, sector };
                }
            }
        }
        panic!("a sweep of {} sectors has no frame {index}", self.total())
    }

    /// The frame of a sweep that is sent from a sector; `None` if the station has no such sector.
    #[must_use]
    pub fn index(&self, TxSector { antenna, sector }: TxSector) -> Option<u16> {
        let known = *self.identities.get(usize::from(antenna))?;
        let bit = 1_u64.checked_shl(sector.into())?;
        let before = self.identities[..usize::from(antenna)].iter().copied().map(count).sum::<u16>();
        (known & bit != 0).then(|| before + count(known & (bit - 1)))
    }

    /// The silence between the frame `index` of a sweep and the next: LBIFS if the DMG antenna changes, else SBIFS.
    ///
    /// # Panics
    /// If one of the two is not in the sweep.
    #[must_use]
    pub(crate) fn gap_after(&self, index: u16) -> Duration {
        if self.sector(index).antenna == self.sector(index + 1).antenna { SBIFS } else { LBIFS }
    }

    /// Time from the start of the first frame of a sweep with SSW frames to the end of its last.
    #[must_use]
    pub(crate) fn sweep_duration(&self) -> Duration {
        SSW_AIRTIME + self.remaining_after(0, SSW_AIRTIME)
    }

    /// Time from the end of the frame `index` of a sweep to the end of its last, with frames of this `airtime`.
    #[must_use]
    pub(crate) fn remaining_after(&self, index: u16, airtime: Duration) -> Duration {
        let frames = u32::from(self.total() - 1 - index);
        let changes = u32::from(self.antennas() - 1 - self.sector(index).antenna);
        (airtime + SBIFS) * frames + (LBIFS - SBIFS) * changes
    }
}

/// Number of sectors of a DMG antenna.
fn count(identities: u64) -> u16 {
    u16::try_from(identities.count_ones()).expect("at most 64")
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
    fn identities_with_gaps_are_swept_in_ascending_order() {
        // The sectors of a router: 0 to 30 and 59 to 63.
        let router = (0..=30).chain(59..=63).map(TxSector::first_antenna);
        let sweep = SectorLayout::of(router.clone().rev()).expect("a good layout");
        assert_eq!((sweep.total(), sweep.antennas()), (36, 1));
        assert_eq!((0..36).map(|i| sweep.sector(i)).collect::<Vec<_>>(), router.collect::<Vec<_>>());
        assert_eq!(sweep.sweep_duration(), layout(&[36]).sweep_duration());
        let two = SectorLayout::of([(1, 63), (0, 5), (1, 0)].map(|(antenna, sector)| TxSector { antenna, sector }));
        let two = two.expect("a good layout");
        for sweep in [sweep, two, layout(&[64, 64]), layout(&[1])] {
            (0..sweep.total()).for_each(|i| assert_eq!(sweep.index(sweep.sector(i)), Some(i)));
        }
        for absent in [(0, 31), (0, 58), (0, 64), (0, 255), (1, 0), (4, 0)] {
            let (antenna, sector) = absent;
            assert_eq!(sweep.index(TxSector { antenna, sector }), None, "{absent:?}");
        }
    }

    #[test]
    fn sectors_that_frames_cannot_name_are_rejected() {
        let refused = |sectors: &[(u8, u8)]| {
            let sectors = sectors.iter().map(|&(antenna, sector)| TxSector { antenna, sector });
            SectorLayout::of(sectors).err().map(|error| error.key)
        };
        assert_eq!(refused(&[]).as_deref(), Some("antennas"));
        assert_eq!(refused(&[(4, 0)]).as_deref(), Some("antennas"));
        assert_eq!(refused(&[(0, 1), (2, 1)]).as_deref(), Some("antennas"));
        assert_eq!(refused(&[(0, 64)]).as_deref(), Some("sectors"));
        assert_eq!(refused(&[(0, 7), (0, 7)]).as_deref(), Some("sectors"));
        assert_eq!(refused(&[(0, 7), (1, 7)]), None);
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
