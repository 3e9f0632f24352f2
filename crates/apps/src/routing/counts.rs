//! What stations did for packets over several hops.

/// What a station did for the packets of all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Beacons.
    pub beacons: u64,
    /// Frames with packets on air, retries included.
    pub transmissions: u64,
    /// Packets that it got again and dropped.
    pub duplicates: u64,
    /// How often a packet came again after more hops; it was sent on.
    pub loops: u64,
    /// Packets that found its queue full.
    pub queue_drops: u64,
    /// Packets that did not reach the next station in as many tries as allowed.
    pub given_up: u64,
    /// Packets that were dropped after too many hops.
    pub hop_limit_drops: u64,
    /// Packets that a station dropped because it knew no way down.
    pub no_route: u64,
    /// Frames with fragments that it gave to the MAC.
    pub fragments: u64,
    /// Packets that it could not put together: a fragment was lost, or there was no room.
    pub reassembly_failures: u64,
    /// What it did for a tree of RPL.
    pub rpl: RplCounts,
}

/// What a station did for a tree of RPL. Messages are counted when they are given to the MAC, on each hop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RplCounts {
    /// DIOs to all.
    pub dio: u64,
    /// DIOs to one neighbour: probes of links, and answers to packets with a wrong rank.
    pub unicast_dio: u64,
    /// DISs.
    pub dis: u64,
    /// DAOs.
    pub dao: u64,
    /// Answers to DAOs.
    pub dao_ack: u64,
    /// Frames with DAOs and their answers on air, retries included.
    pub transmissions: u64,
    /// DAOs and their answers that found a queue full, or were given up on a hop.
    pub lost: u64,
    /// DIOs that were left out because others had said the same.
    pub left_out: u64,
    /// Packets that came from a station with a rank that does not fit, each time.
    pub rank_errors: u64,
    /// Packets that were dropped for that.
    pub rank_error_drops: u64,
    /// DAOs that found a table of ways full.
    pub full_tables: u64,
    /// How often it forgot its neighbours, because no answer to its DAOs came.
    pub repairs: u64,
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        // Without `..`, so that no field is forgotten.
        let Self {
            beacons,
            transmissions,
            duplicates,
            loops,
            queue_drops,
            given_up,
            hop_limit_drops,
            no_route,
            fragments,
            reassembly_failures,
            rpl,
        } = other;
        self.beacons += beacons;
        self.transmissions += transmissions;
        self.duplicates += duplicates;
        self.loops += loops;
        self.queue_drops += queue_drops;
        self.given_up += given_up;
        self.hop_limit_drops += hop_limit_drops;
        self.no_route += no_route;
        self.fragments += fragments;
        self.reassembly_failures += reassembly_failures;
        self.rpl += rpl;
    }
}

impl std::ops::AddAssign for RplCounts {
    fn add_assign(&mut self, other: Self) {
        // Without `..`, so that no field is forgotten.
        let Self {
            dio,
            unicast_dio,
            dis,
            dao,
            dao_ack,
            transmissions,
            lost,
            left_out,
            rank_errors,
            rank_error_drops,
            full_tables,
            repairs,
        } = other;
        self.dio += dio;
        self.unicast_dio += unicast_dio;
        self.dis += dis;
        self.dao += dao;
        self.dao_ack += dao_ack;
        self.transmissions += transmissions;
        self.lost += lost;
        self.left_out += left_out;
        self.rank_errors += rank_errors;
        self.rank_error_drops += rank_error_drops;
        self.full_tables += full_tables;
        self.repairs += repairs;
    }
}

impl std::iter::Sum for Counts {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), |mut sum, one| {
            sum += one;
            sum
        })
    }
}
