use super::*;
use crate::routing::rpl::frame::RplFrame;
use crate::routing::rpl::message::{Dao, DaoAck, DaoStatus};

const CONFIGURATION: DioConfiguration = DioConfiguration {
    mode: 1,
    doublings: 8,
    interval_min: 12,
    redundancy: 0,
    max_rank_increase: 2048,
    min_hop_rank_increase: 256,
    objective: 1,
    lifetime_min: 30,
};
const UP: RplOption = RplOption { direction: Direction::Up, flags: OptionFlags::None, sender_rank: Rank(0x0300) };

fn data() -> Datagram {
    Datagram {
        source: StationId(5),
        destination: StationId(0x0109),
        hop_limit: 64,
        option: None,
        route: None,
        content: Content::Data(0x1234),
    }
}

fn written(datagram: &Datagram, size: usize) -> Vec<u8> {
    let mut octets = vec![1];
    datagram.write(size, &CONFIGURATION, &mut octets);
    assert_eq!(RplFrame::read(&octets), Some(RplFrame::Datagram(datagram.clone())), "{octets:02x?}");
    let message = match datagram.content {
        Content::Message(Message::Dao(_)) => 50,
        Content::Message(_) => 8,
        Content::Data(_) => 0,
    };
    let least = datagram.header_octets() + message;
    assert_eq!(octets.len(), if message > 0 { least } else { least.max(size) });
    octets
}

fn route(stations: u32) -> Option<SourceRoute> {
    SourceRoute::over((1..=stations).map(StationId).collect())
}

#[test]
fn packets_have_the_sizes_of_their_headers_and_are_read_back() {
    let up = Datagram { option: Some(UP), ..data() };
    let octets = written(&up, 0);
    assert_eq!(octets.len(), usize::from(LEAST_DATA_OCTETS));
    assert_eq!(octets[..7], [0x7C, 0x66, 64, 0, 5, 1, 9]);
    assert_eq!(octets[7..15], [0xE1, 6, 0x63, 4, 0, 0, 3, 0]);
    assert_eq!(octets[15..], [0xF0, 0x22, 0x3D, 0x22, 0x3D, 0, 0, 0x12, 0x34]);
    assert_eq!(written(&up, 60).len(), 60);
    assert_eq!(written(&data(), 0).len(), 16);
    for (stations, octets) in [(1, 16), (4, 16), (5, 24), (8, 24), (9, 32)] {
        assert_eq!(source_route_octets(usize::try_from(stations).expect("few")), octets);
        assert_eq!(written(&Datagram { route: route(stations), ..data() }, 0).len(), 16 + octets);
    }
    let wrong = RplOption { direction: Direction::Down, flags: OptionFlags::RankError, ..UP };
    assert_eq!(written(&Datagram { option: Some(wrong), ..data() }, 0)[11], 0xC0);
}

#[test]
fn messages_over_several_hops_are_read_back() {
    let dao = Dao { target: StationId(5), parent: Some(StationId(6)), lifetime_min: 30, number: 7, asks: true };
    let up = Datagram { option: Some(UP), content: Content::Message(Message::Dao(dao)), ..data() };
    assert_eq!(written(&up, 99).len(), 7 + 9 + 50);
    let ack = Content::Message(Message::DaoAck(DaoAck { number: 7, status: DaoStatus::Accepted }));
    assert_eq!(written(&Datagram { content: ack, ..data() }, 0).len(), 7 + 1 + 8);
    assert_eq!(written(&Datagram { content: ack, route: route(2), ..data() }, 0).len(), 7 + 17 + 8);
}

#[test]
fn a_source_route_leads_over_its_stations_and_keeps_its_size() {
    let mut packet = Datagram { destination: StationId(9), route: route(2), ..data() };
    let size = written(&packet, 0).len();
    let mut way = vec![packet.destination.0];
    while packet.target() != packet.destination {
        assert!(packet.advance());
        assert_eq!(written(&packet, 0).len(), size);
        way.push(packet.destination.0);
    }
    assert_eq!(way, [9, 1, 2]);
    assert!(!packet.advance());
}

#[test]
fn a_rank_is_wrong_if_a_packet_does_not_come_nearer() {
    let down = RplOption { direction: Direction::Down, ..UP };
    let wrong = |option: RplOption| [512, 768, 1024].map(|rank| option.is_wrong_at(Rank(rank)));
    assert_eq!((wrong(UP), wrong(down)), ([false, false, true], [true, true, false]));
}

#[test]
fn octets_that_end_early_are_no_packet() {
    for packet in [Datagram { option: Some(UP), ..data() }, Datagram { route: route(3), ..data() }] {
        let octets = written(&packet, 0);
        for end in 0..octets.len() {
            assert_eq!(RplFrame::read(&octets[..end]), None, "{end} octets");
        }
    }
}
