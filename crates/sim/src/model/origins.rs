//! Which packets over several hops count.

use sextant_kernel::StationId;

/// Which packets over several hops count, by the stations where they begin: those that begin after the warm-up.
#[derive(Debug, Default)]
pub(crate) struct Origins {
    stations: Vec<Origin>,
}

/// The packets that begin at a station and count.
#[derive(Clone, Copy, Debug, Default)]
struct Origin {
    /// How many there are.
    packets: u64,
    /// The number of the last one, which goes round.
    last: u16,
}

impl Origins {
    /// A packet that counts begins at a station. Its number is one more than that of the packet before.
    pub(crate) fn begin(&mut self, station: StationId, number: u16) {
        if self.stations.len() <= station.index() {
            self.stations.resize(station.index() + 1, Origin::default());
        }
        let origin = &mut self.stations[station.index()];
        origin.packets += 1;
        origin.last = number;
    }

    /// Whether the latest packet of a station with this number counts.
    pub(crate) fn counts(&self, station: StationId, number: u16) -> bool {
        let origin = self.stations.get(station.index());
        origin.is_some_and(|origin| u64::from(origin.last.wrapping_sub(number)) < origin.packets)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packets_count_from_the_first_that_begins_after_the_warm_up() {
        let mut origins = Origins::default();
        let counts = |origins: &Origins, number| origins.counts(StationId(2), number);
        assert!(!counts(&origins, 0));
        for number in [u16::MAX, 0, 1] {
            origins.begin(StationId(2), number);
        }
        assert!([u16::MAX, 0, 1].into_iter().all(|number| counts(&origins, number)));
        assert!([u16::MAX - 1, 2].into_iter().all(|number| !counts(&origins, number)));
        assert!(!origins.counts(StationId(1), 0) && !origins.counts(StationId(3), 0));
        (2..=u16::MAX).for_each(|number| origins.begin(StationId(2), number));
        assert!((0..=u16::MAX).all(|number| counts(&origins, number)), "all numbers were given again");
    }
}
