//! Links as they were measured: strength and share of frames received, by link and time.

use std::collections::BTreeMap;

use sextant_kernel::{SimTime, StationId};

use crate::power::Dbm;

/// What was measured on a link from some time on, until its next row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TracedLink {
    /// Strength at the receiver, if it is known.
    pub strength: Option<Dbm>,
    /// Share of the frames that arrived, if it is known.
    pub share: Option<f64>,
}

/// What links without rows are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OtherLinks {
    /// Nothing is heard over them.
    Silent,
    /// As the law of the channel says.
    Law,
}

/// What a trace says of a link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Traced {
    /// It was measured.
    Measured(TracedLink),
    /// Nothing is heard.
    Silent,
    /// Nothing: the law of the channel holds.
    Law,
}

/// The links of a network as they were measured, each direction for itself. A row holds until the next one of its link; the
/// first one holds before its time too.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkTrace {
    rows: BTreeMap<(u32, u32), Vec<(SimTime, TracedLink)>>,
    others: OtherLinks,
    /// Least strength of links whose rows have a share of frames, so that the share alone decides.
    least: Dbm,
}

impl LinkTrace {
    /// An empty trace. Links with a share of frames have at least the strength `least`.
    #[must_use]
    pub fn new(others: OtherLinks, least: Dbm) -> Self {
        Self { rows: BTreeMap::new(), others, least }
    }

    /// Adds what was measured on the link from one station to another, not before the last row of the link.
    pub fn add(&mut self, from: StationId, to: StationId, since: SimTime, link: TracedLink) {
        self.rows.entry((from.0, to.0)).or_default().push((since, link));
    }

    /// What is known of the link from one station to another at `now`.
    #[must_use]
    pub fn at(&self, from: StationId, to: StationId, now: SimTime) -> Traced {
        match (self.rows.get(&(from.0, to.0)), self.others) {
            (Some(rows), _) => {
                let next = rows.partition_point(|(since, _)| *since <= now);
                Traced::Measured(rows[next.saturating_sub(1)].1)
            }
            (None, OtherLinks::Silent) => Traced::Silent,
            (None, OtherLinks::Law) => Traced::Law,
        }
    }

    /// The strength of a measured link; `None` if no frame arrived.
    #[must_use]
    pub fn strength(&self, link: TracedLink) -> Option<Dbm> {
        match (link.share, link.strength) {
            (Some(share), _) if share <= 0.0 => None,
            (Some(_), Some(strength)) if strength > self.least => Some(strength),
            (Some(_), _) => Some(self.least),
            (None, strength) => strength,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn a_row_holds_until_the_next_one_of_its_link() {
        let at = |seconds| SimTime::ZERO + Duration::from_secs(seconds);
        let share = |share| TracedLink { strength: None, share: Some(share) };
        let mut trace = LinkTrace::new(OtherLinks::Silent, Dbm(-70.0));
        trace.add(StationId(0), StationId(1), at(10), share(0.5));
        trace.add(StationId(0), StationId(1), at(20), share(0.25));
        trace.add(StationId(1), StationId(0), at(0), TracedLink { strength: Some(Dbm(-80.0)), share: None });
        let found = |seconds| trace.at(StationId(0), StationId(1), at(seconds));
        assert_eq!([found(0), found(10), found(19)], [Traced::Measured(share(0.5)); 3]);
        assert_eq!([found(20), found(99)], [Traced::Measured(share(0.25)); 2]);
        assert_eq!(trace.at(StationId(0), StationId(2), at(0)), Traced::Silent);
        assert_eq!(trace.strength(share(0.5)), Some(Dbm(-70.0)));
        assert_eq!(trace.strength(share(0.0)), None);
        let both = |dbm| TracedLink { strength: Some(Dbm(dbm)), share: Some(0.5) };
        assert_eq!([-95.0, -60.0].map(|dbm| trace.strength(both(dbm))), [Some(Dbm(-70.0)), Some(Dbm(-60.0))]);
        assert_eq!(trace.strength(TracedLink { strength: Some(Dbm(-95.0)), share: None }), Some(Dbm(-95.0)));
        let law = LinkTrace::new(OtherLinks::Law, Dbm(-70.0));
        assert_eq!(law.at(StationId(0), StationId(2), at(0)), Traced::Law);
    }
}
