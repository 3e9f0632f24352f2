use proptest::prelude::*;

use super::*;

/// A number that binary32 holds exactly.
fn number() -> impl Strategy<Value = f64> {
    (-1e6_f32..1e6).prop_map(f64::from)
}

fn place() -> impl Strategy<Value = Position> {
    (number(), number(), number()).prop_map(|(x_m, y_m, z_m)| Position::new(x_m, y_m, z_m))
}

fn belief() -> impl Strategy<Value = Belief> {
    let covariance = prop::option::of(prop::array::uniform6(number()));
    (place(), covariance).prop_map(|(place, covariance)| {
        let symmetric = |[xx, xy, xz, yy, yz, zz]: [f64; 6]| [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
        Belief { place, covariance: covariance.map(symmetric) }
    })
}

fn directions() -> impl Strategy<Value = Directions> {
    let rings = prop::collection::vec(prop::array::uniform2(number()), 0..5);
    (number(), number(), any::<u8>(), rings).prop_map(|(azimuth_rad, azimuth_sigma_rad, sectors, rings)| Directions {
        azimuth_rad,
        azimuth_sigma_rad,
        sectors,
        rings,
    })
}

/// A bearing that the octets hold exactly.
fn bearing() -> impl Strategy<Value = Option<SectorBearing>> {
    let bearing = (any::<[u8; 2]>(), 1_u8..).prop_map(|([low, high], sigma)| bearing_of([low, high, sigma]));
    prop_oneof![Just(None), bearing]
}

fn message() -> impl Strategy<Value = Message> {
    let heard = (any::<u32>(), any::<u8>(), bearing()).prop_map(|(station, sector, bearing)| HeardSector {
        station: StationId(station),
        sector,
        bearing,
    });
    let others = prop::collection::vec((any::<u32>().prop_map(StationId), place()), 0..5);
    let earlier = prop::collection::vec(place(), 0..4);
    let beacon = (belief(), prop::option::of(directions()), earlier, others)
        .prop_map(|(belief, directions, earlier, others)| Beacon { belief, directions, earlier, others });
    prop_oneof![
        belief().prop_map(Message::Place),
        (belief(), prop::collection::vec(heard, 0..9)).prop_map(|(belief, heard)| Message::Report(belief, heard)),
        beacon.prop_map(Message::Beacon),
        (belief(), any::<bool>()).prop_map(|(belief, is_bad)| Message::Coordinates { belief, is_bad }),
    ]
}

proptest! {
    #[test]
    fn a_message_reads_as_it_was_written(message in message()) {
        let mut octets = vec![7; 3];
        message.write(&mut octets);
        prop_assert_eq!(Message::read(&octets), Ok(message));
    }

    #[test]
    fn cut_and_garbled_messages_are_errors_or_other_messages(message in message(), at in 0_usize..200, flip in 1_u8..) {
        let mut octets = Vec::new();
        message.write(&mut octets);
        let at = at % octets.len();
        if let Ok(read) = Message::read(&octets[..at]) {
            // Lists without a count can end after each entry.
            prop_assert!(matches!(read, Message::Report(..) | Message::Beacon(_)));
        }
        octets[at] ^= flip;
        let _ = Message::read(&octets);
    }
}

#[test]
fn the_octets_of_a_beacon_are_those_of_the_table() {
    let belief = Belief::exact(Position::new(1.0, -2.0, 0.5));
    let directions = Directions { azimuth_rad: 0.25, azimuth_sigma_rad: 0.125, sectors: 8, rings: vec![[-0.5, 0.5]] };
    let (earlier, others) = (vec![Position::new(0.5, 0.5, 0.5)], vec![(StationId(258), Position::ORIGIN)]);
    let mut octets = Vec::new();
    Message::Beacon(Beacon { belief, directions: Some(directions), earlier, others }).write(&mut octets);
    let expected: Vec<u8> = [
        &[0x13, 0x16][..],
        // 1, -2 and 0.5 as binary32.
        &[0, 0, 0x80, 0x3F, 0, 0, 0, 0xC0, 0, 0, 0, 0x3F],
        // 0.25 and 0.125, 8 sectors in one ring from -0.5 to 0.5.
        &[0, 0, 0x80, 0x3E, 0, 0, 0, 0x3E, 8, 1, 0, 0, 0, 0xBF, 0, 0, 0, 0x3F],
        // One earlier place, and one other anchor.
        &[1, 0, 0, 0, 0x3F, 0, 0, 0, 0x3F, 0, 0, 0, 0x3F],
        &[2, 1, 0, 0],
        &[0; 12],
    ]
    .concat();
    assert_eq!(octets, expected);
}

#[test]
fn what_is_no_message_says_why() {
    let mut octets = Vec::new();
    Message::Place(Belief::exact(Position::ORIGIN)).write(&mut octets);
    assert_eq!(Message::read(&octets[..7]), Err(MessageError::Truncated { octets: 7, part: "the place" }));
    assert_eq!(Message::read(&[]), Err(MessageError::Truncated { octets: 0, part: "the header" }));
    let with = |at: usize, octet: u8| {
        let mut octets = octets.clone();
        octets[at] = octet;
        Message::read(&octets)
    };
    assert_eq!(with(0, 0x21), Err(MessageError::Version(2)));
    assert_eq!(with(0, 0x15), Err(MessageError::Kind { found: 5, allowed: "1 to 4" }));
    // The exponent of an infinite number.
    assert!(with(5, 0x7F).is_ok());
    octets[4..6].copy_from_slice(&[0x80, 0x7F]);
    assert_eq!(Message::read(&octets), Err(MessageError::NotFinite("the place")));
    octets[4..6].copy_from_slice(&[0, 0]);
    octets.push(1);
    assert_eq!(Message::read(&octets), Err(MessageError::TooLong(1)));
}

#[test]
fn many_reports_are_split_into_messages_that_fit() {
    let heard: Vec<_> = (0..41).map(|i| HeardSector { station: StationId(i), sector: 3, bearing: None }).collect();
    let belief = Belief::exact(Position::ORIGIN);
    let messages: Vec<_> = Message::reports(belief, &heard, 114).collect();
    // 14 octets and 20 entries of 5.
    assert_eq!(messages.len(), 3);
    let mut octets = Vec::new();
    messages[0].write(&mut octets);
    assert_eq!(octets.len(), 114);
    assert_eq!(Message::reports(belief, &[], 114).count(), 0);
}

#[test]
fn other_anchors_fill_a_beacon_up_to_its_room() {
    let directions = Directions { azimuth_rad: 0.0, azimuth_sigma_rad: 0.0, sectors: 8, rings: vec![[0.0; 2]; 2] };
    for (directions, covariance, earlier) in
        [(None, None, 0), (Some(directions.clone()), Some([[0.0; 3]; 3]), 0), (Some(directions), None, 3)]
    {
        let belief = Belief { place: Position::ORIGIN, covariance };
        let earlier = vec![Position::ORIGIN; earlier];
        let mut beacon = Beacon { belief, directions, earlier, others: Vec::new() };
        let room = beacon.room_for_others(200);
        beacon.others = vec![(StationId(1), Position::ORIGIN); room];
        let mut octets = Vec::new();
        Message::Beacon(beacon).write(&mut octets);
        assert!((185..=200).contains(&octets.len()), "{} octets with {room} others", octets.len());
    }
}

#[test]
fn sectors_are_numbered_ring_by_ring() {
    let directions =
        Directions { azimuth_rad: 1.0, azimuth_sigma_rad: 0.0, sectors: 4, rings: vec![[-0.5, 0.0], [0.0, 0.5]] };
    let wedge = directions.wedge(6).unwrap();
    assert_eq!(
        wedge.elevation_rad.map(|edge_rad| edge_rad.total_cmp(&0.25)),
        [std::cmp::Ordering::Less, std::cmp::Ordering::Greater]
    );
    // Sector 2 of 4 is turned by half a turn.
    assert!((wedge.azimuth_from_rad + 0.5 * wedge.azimuth_width_rad - 1.0 - 0.5 * TAU).abs() < 1e-12);
    assert_eq!(directions.wedge(8), None);
}
