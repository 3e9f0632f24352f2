use super::*;

const PHY: Phy = Phy::Oqpsk2450;

fn specification(beacon_order: u8, superframe_order: u8, final_cap_slot: u8) -> Superframe {
    Superframe {
        beacon_order,
        superframe_order,
        final_cap_slot,
        battery_life_extension: false,
        pan_coordinator: true,
        association_permit: false,
    }
}

fn timing(beacon_order: u8, superframe_order: u8, final_cap_slot: u8) -> SuperframeTiming {
    SuperframeTiming::new(PHY, specification(beacon_order, superframe_order, final_cap_slot)).expect("good orders")
}

fn at(us: u64) -> SimTime {
    SimTime::ZERO + Duration::from_micros(us)
}

fn us(micros: u64) -> Duration {
    Duration::from_micros(micros)
}

#[test]
fn superframes_have_the_lengths_of_the_standard() {
    // Milliseconds of orders 0 to 14: 960 symbols of 16 us, doubled each time.
    let table = [
        15.36, 30.72, 61.44, 122.88, 245.76, 491.52, 983.04, 1966.08, 3932.16, 7864.32, 15_728.64, 31_457.28,
        62_914.56, 125_829.12, 251_658.24,
    ];
    for (order, ms) in (0..).zip(table) {
        let whole = timing(order, order, 15);
        let span_us = |span: Duration| span.as_nanos() as f64 / 1e3;
        assert!((span_us(whole.beacon_interval()) - 1e3 * ms).abs() < 1e-9, "order {order}");
        assert_eq!((whole.active(), whole.cap_end()), (whole.beacon_interval(), whole.beacon_interval()));
        assert!(!whole.has_inactive_part());
        // Sixteen slots of 60 symbols each, doubled once per order.
        assert_eq!(whole.slot_start(1) * 16, whole.active());
        assert_eq!(whole.slot_start(1), PHY.symbols(60) * (1 << order));
        let short = timing(14, order, 15);
        assert_eq!(short.active(), whole.active());
        assert_eq!(short.beacon_interval(), timing(14, 14, 15).beacon_interval());
        assert_eq!(short.has_inactive_part(), order < 14);
    }
}

#[test]
fn other_layers_count_in_their_own_symbols() {
    let timing = SuperframeTiming::new(Phy::Bpsk868, specification(3, 2, 11)).expect("good orders");
    assert_eq!(timing.beacon_interval(), Duration::from_millis(8 * 48));
    assert_eq!(timing.active(), Duration::from_millis(4 * 48));
    assert_eq!(timing.cap_end(), Duration::from_millis(3 * 48));
}

#[test]
fn a_beacon_that_opens_no_superframe_has_no_timing() {
    for (beacon_order, superframe_order) in [(15, 15), (15, 0), (6, 15), (6, 7)] {
        assert_eq!(SuperframeTiming::new(PHY, specification(beacon_order, superframe_order, 15)), None);
    }
}

#[test]
fn contention_begins_on_the_first_boundary_after_the_beacon_and_ends_with_its_last_slot() {
    // A beacon of 13 octets takes 608 us: the boundary at 320 us is too early.
    let contention = timing(0, 0, 15).contention(at(1000), 13);
    assert_eq!(contention.boundary(at(1000)), at(1000 + 640));
    assert_eq!(contention.end(), at(1000 + 15_360));
    // With seven guaranteed slots the beacon has 35 octets, 1312 us, and contention nine slots of 960 us.
    let contention = timing(0, 0, 8).contention(at(1000), 35);
    assert_eq!((contention.boundary(at(1000)), contention.end()), (at(1000 + 1600), at(1000 + 8640)));
    // 14 octets take 640 us: the boundary at that instant is good.
    assert_eq!(timing(0, 0, 15).contention(at(0), 14).boundary(at(0)), at(640));
}

#[test]
fn boundaries_are_whole_backoff_periods_after_the_start_of_the_beacon() {
    let contention = timing(6, 6, 15).contention(at(100), 13);
    for (now, boundary) in [(0, 740), (740, 740), (741, 1060), (1060, 1060), (99_999, 100_260)] {
        assert_eq!(contention.boundary(at(now)), at(boundary), "{now}");
    }
}

#[test]
fn battery_life_extension_leaves_six_backoff_periods_after_beacon_and_spacing() {
    let saving = Superframe { battery_life_extension: true, ..specification(6, 6, 15) };
    let contention = SuperframeTiming::new(PHY, saving).expect("good orders").contention(at(0), 13);
    // 608 us and a short spacing of 192 us.
    let first = 960;
    assert_eq!(contention.boundary(at(0)), at(first));
    assert!(contention.is_battery_saving());
    assert_eq!(contention.countable(at(first)), 6);
    assert_eq!(contention.countable(at(first + 6 * 320)), 0);
    assert_eq!(contention.countable(at(first + 60 * 320)), 0);
    // The first bit goes out two periods later, in one of the six.
    for periods in 0..10 {
        assert_eq!(contention.fits(at(first + periods * 320), 127, true), periods <= 3, "{periods} periods");
    }
}

#[test]
fn two_assessments_frame_acknowledgement_and_spacing_must_fit() {
    let contention = Contention::new(PHY, at(0), at(96_000));
    let fits_until = |octets, ack| (0..300).filter(|&k| contention.fits(at(320 * k), octets, ack)).max();
    // 2 * 320 + (6 + 20) * 32 + 640 = 2112 us: 6.6 periods before the end, which is at boundary 300.
    assert_eq!(fits_until(20, false), Some(293));
    // The frame ends 0.6 periods after a boundary, so its acknowledgement starts 0.4 + 1 periods later:
    // 4.6 + 1.4 + 1.1 + 2 periods.
    assert_eq!(fits_until(20, true), Some(290));
    // A short frame: 640 + 512 + 192 us = 4.2 periods; acknowledged 3.6 + 1.4 + 1.1 + 0.6 = 6.7 periods.
    assert_eq!((fits_until(10, false), fits_until(10, true)), (Some(295), Some(293)));
}

#[test]
fn an_acknowledgement_starts_on_a_boundary_in_contention_and_after_a_turnaround_elsewhere() {
    let timing = timing(0, 0, 8);
    for (frame_end, gap) in [(0, 320), (128, 192), (129, 511), (320, 320), (448, 192), (449, 511), (8639, 321)] {
        assert_eq!(timing.ack_gap(us(frame_end)), us(gap), "{frame_end}");
    }
    assert_eq!(timing.ack_gap(us(8640)), us(192));
    assert_eq!(timing.ack_gap(us(9001)), us(192));
    // For every end of a frame on whole symbols, it is 12 to 31 symbols later.
    for symbol in 0..500 {
        let gap = timing.ack_gap(PHY.symbols(symbol));
        assert!(gap >= PHY.symbols(12) && gap <= PHY.symbols(31), "{gap:?}");
    }
}

#[test]
fn the_longest_transaction_fits_in_the_shortest_contention() {
    // Beacons of every size: with zero to seven guaranteed slots, and an extended source address.
    for beacon_octets in 13..=41 {
        let start = at(777);
        let end = start + PHY.airtime(beacon_octets) + PHY.symbols(MIN_CAP_SYMBOLS);
        let first = start + periods_to(PHY.airtime(beacon_octets), PHY);
        let contention = Contention { first, ..Contention::new(PHY, start, end) };
        assert!(contention.fits(first, 127, true), "beacon of {beacon_octets} octets");
    }
}
