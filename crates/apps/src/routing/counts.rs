//! What stations did for packets over several hops.

use sextant_sim::sum_fields;

/// What a station did for the packets of all. Of transmissions, copies and losses, those of packets that count, which were offered
/// after the warm-up; of all else, what happened after the warm-up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Beacons that the MAC took.
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

sum_fields!(Counts {
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
});

sum_fields!(RplCounts {
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
});
