use std::time::Duration;

use super::*;
use crate::routing::rpl::objective::{Mrhof, Objective, StepOfRank};

const ROOT: StationId = StationId(0);
const OWN: StationId = StationId(9);

fn at(s: u64) -> SimTime {
    SimTime::from_secs(s)
}

fn dio(rank: u16) -> Dio {
    Dio { root: ROOT, rank: Rank(rank), dtsn: 0 }
}

/// A node that has sent four frames over the link to each of these neighbours, which told these ranks, at time zero.
fn node(settings: DodagSettings, neighbours: &[(u32, u16)]) -> Dodag {
    let mut dodag = Dodag::of_node(OWN, settings);
    for &(station, rank) in neighbours {
        dodag.heard(StationId(station), &dio(rank), at(0));
        for _ in 0..4 {
            dodag.sent(StationId(station), 1, LinkOutcome::Acknowledged, at(0));
        }
    }
    dodag
}

#[test]
fn a_first_parent_needs_four_transmissions_over_its_link() {
    let mut dodag = Dodag::of_node(OWN, DodagSettings::default());
    let heard = dodag.heard(ROOT, &dio(256), at(0));
    assert_eq!(heard, [Action::LeaveLater, Action::BeginProbing, Action::ProbeSoon]);
    for s in 1..=3 {
        assert_eq!(dodag.probed(at(s), 0.5), Some(ROOT));
        assert_eq!(dodag.sent(ROOT, 1, LinkOutcome::Acknowledged, at(s)), [Action::ProbeSoon]);
    }
    let joined = dodag.sent(ROOT, 1, LinkOutcome::Acknowledged, at(4));
    assert_eq!(joined, [Action::NoteParent(None), Action::Stay, Action::Register]);
    // 176/128 of a transmission count as the least increase.
    assert_eq!((dodag.parent(), dodag.rank(), dodag.stage()), (Some(ROOT), Rank(512), Stage::Joined));
    assert!(!dodag.may_tell(), "those above know no way down yet");
    assert_eq!(dodag.registered(), [Action::HastenDio]);
    assert!(dodag.may_tell() && dodag.registered().is_empty());
}

#[test]
fn without_probing_the_first_neighbour_is_the_parent_at_once() {
    let settings = DodagSettings { probing: Probing::Off, downward: Downward::Unknown, ..DodagSettings::default() };
    let mut dodag = Dodag::of_node(OWN, settings);
    dodag.heard(ROOT, &dio(256), at(0));
    assert_eq!((dodag.parent(), dodag.stage(), dodag.may_tell()), (Some(ROOT), Stage::Reachable, true));
}

#[test]
fn a_parent_that_acknowledges_nothing_is_given_up_and_its_rank_is_taken_back() {
    let mut dodag = node(DodagSettings::default(), &[(0, 256)]);
    dodag.registered();
    dodag.tell();
    // From 176: 312 and 434 are below 512, and 544 is above.
    for _ in 0..2 {
        assert!(dodag.sent(ROOT, 4, LinkOutcome::Lost, at(1)).is_empty());
    }
    let lost = dodag.sent(ROOT, 4, LinkOutcome::Lost, at(1));
    assert_eq!(lost, [Action::NoteParent(Some(ROOT)), Action::HastenDio, Action::Solicit, Action::LeaveLater]);
    assert!(dodag.may_tell(), "the rank that was told is poisoned");
    assert_eq!(dodag.tell().map(|dio| dio.rank), Some(Rank::INFINITE));
    assert!(!dodag.may_tell());
}

#[test]
fn a_neighbour_of_infinite_rank_is_no_parent() {
    let mut dodag = node(DodagSettings::default(), &[(1, 512), (2, 700)]);
    assert_eq!(dodag.parent(), Some(StationId(1)));
    let heard = dodag.heard(StationId(1), &dio(u16::MAX), at(2));
    assert_eq!(heard, [Action::NoteParent(Some(StationId(1))), Action::Register]);
    assert_eq!((dodag.parent(), dodag.rank()), (Some(StationId(2)), Rank(956)));
}

/// Its own rank was 768 once, so neighbours with up to 768 + 512 can be parents.
#[test]
fn a_rank_grows_by_no_more_than_the_limit_until_the_station_begins_anew() {
    let settings = DodagSettings { max_rank_increase: 512, ..DodagSettings::default() };
    let parent_after = |rank: u16| {
        let mut dodag = node(settings, &[(1, 512), (2, rank)]);
        assert_eq!(dodag.rank(), Rank(768));
        dodag.heard(StationId(1), &dio(u16::MAX), at(2));
        dodag.parent()
    };
    assert_eq!((parent_after(1280), parent_after(1281)), (Some(StationId(2)), None));
    let mut dodag = node(settings, &[(1, 512), (2, 1281)]);
    dodag.heard(StationId(1), &dio(u16::MAX), at(2));
    dodag.heard(StationId(2), &dio(1281), at(3));
    assert_eq!(dodag.parent(), Some(StationId(2)), "without a rank there is no limit");
}

#[test]
fn hysteresis_keeps_a_parent_for_ten_minutes_and_objective_function_zero_does_not() {
    let parents = |objective| {
        let mut dodag = node(DodagSettings { objective, ..DodagSettings::default() }, &[(1, 800)]);
        dodag.heard(StationId(2), &dio(700), at(0));
        for s in [0, 500, 601] {
            for station in [1, 2] {
                dodag.sent(StationId(station), 4, LinkOutcome::Acknowledged, at(s));
            }
        }
        let before = dodag.parent();
        dodag.sent(StationId(2), 1, LinkOutcome::Acknowledged, at(602));
        (before, dodag.parent())
    };
    let mrhof = Objective::Mrhof(Mrhof { hysteresis_time: Duration::from_secs(601), ..Mrhof::default() });
    assert_eq!(parents(mrhof), (Some(StationId(1)), Some(StationId(2))));
    assert_eq!(parents(Objective::Of0(StepOfRank::Constant)), (Some(StationId(2)), Some(StationId(2))));
}

#[test]
fn a_request_of_the_parent_to_register_again_is_passed_on() {
    let mut dodag = node(DodagSettings::default(), &[(1, 512)]);
    assert_eq!(dodag.heard(StationId(1), &Dio { dtsn: 1, ..dio(512) }, at(2)), [Action::Register]);
    assert_eq!(dodag.dio().map(|dio| dio.dtsn), Some(1));
    assert!(dodag.heard(StationId(1), &Dio { dtsn: 1, ..dio(512) }, at(2)).is_empty());
}

#[test]
fn a_repair_forgets_ranks_and_another_tree_is_joined_after_leaving_only() {
    let mut dodag = node(DodagSettings::default(), &[(1, 512)]);
    let other = Dio { root: StationId(7), rank: Rank(256), dtsn: 0 };
    assert!(dodag.heard(StationId(7), &other, at(1)).is_empty());
    assert!(dodag.repair(at(2)).contains(&Action::Solicit));
    assert_eq!((dodag.parent(), dodag.stage()), (None, Stage::Searching));
    // The link is still known well.
    dodag.heard(StationId(1), &dio(512), at(3));
    assert_eq!(dodag.parent(), Some(StationId(1)));
    dodag.leave();
    assert_eq!((dodag.stage(), dodag.root()), (Stage::Detached, None));
    dodag.heard(StationId(7), &other, at(5));
    assert_eq!(dodag.root(), Some(StationId(7)));
}

#[test]
fn what_a_packet_says_of_a_rank_counts() {
    let mut dodag = node(DodagSettings::default(), &[(1, 512), (2, 700)]);
    dodag.corrected(StationId(1), Rank(1500), at(1));
    assert_eq!(dodag.parent(), Some(StationId(2)));
}
