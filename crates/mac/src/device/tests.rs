//! Tests of the machine with a scripted radio. Instants are counted in symbols of 16 us.

use super::*;
use crate::csma::Outcome;
use crate::frame::Superframe;
use crate::superframe::{BeaconEnabledConfig, GtsConfig};

const PHY: Phy = Phy::Oqpsk2450;
/// Octets of a beacon without guaranteed slots, and its symbols on air.
const OCTETS: u8 = 13;
const BEACON: u64 = 38;
/// Turnaround and the longest beacon.
const WAIT: u64 = 12 + 266;

fn at(symbols: u64) -> SimTime {
    SimTime::ZERO + PHY.symbols(symbols)
}

fn symbols(time: SimTime) -> u64 {
    time.as_nanos() / 16_000
}

/// Draws are always 0, the channel is never busy, no frame is acknowledged; both timers and the state can be read.
#[derive(Default)]
struct Script {
    now: SimTime,
    timer: Option<(SimTime, csma::Event)>,
    tracking: Option<(SimTime, Event)>,
    states: Vec<(u64, RadioState)>,
    transmissions: Vec<u64>,
}

impl csma::Radio for Script {
    fn backoff_periods(&mut self, _max_inclusive: u32) -> u32 {
        0
    }

    fn after(&mut self, span: Duration, event: csma::Event) {
        assert_eq!(self.timer, None, "there is one timer for channel access");
        self.timer = Some((self.now + span, event));
    }

    fn cancel_timer(&mut self) {
        self.timer = None;
    }

    fn enter(&mut self, state: RadioState) {
        self.states.push((symbols(self.now), state));
    }

    fn start_cca(&mut self) {
        self.after(PHY.cca(), csma::Event::CcaEnded { busy: false });
    }

    fn start_transmission(&mut self, frame: OutgoingFrame) {
        self.transmissions.push(symbols(self.now));
        self.after(PHY.airtime(frame.mpdu_octets), csma::Event::TransmissionEnded);
    }
}

impl Radio for Script {
    fn track_after(&mut self, span: Duration, event: Event) {
        assert_eq!(self.tracking, None, "there is one timer for beacons");
        self.tracking = Some((self.now + span, event));
    }

    fn cancel_tracking(&mut self) {
        self.tracking = None;
    }
}

impl Script {
    /// The device receives a complete beacon that starts at `start`.
    fn hear(&mut self, device: &mut Device, start: u64, beacon: &Beacon<'_>) {
        self.run(device, start + BEACON);
        self.now = at(start + BEACON);
        device.receive_beacon(self.now, OCTETS, beacon, self);
    }

    /// Runs all events that are due before `end`.
    fn run(&mut self, device: &mut Device, end: u64) -> Option<Report> {
        let mut report = None;
        loop {
            let timer = self.timer.filter(|due| due.0 < at(end));
            let tracking = self.tracking.filter(|due| due.0 < at(end));
            match (timer, tracking) {
                (None, None) => return report,
                (Some((now, event)), other) if other.is_none_or(|other| now <= other.0) => {
                    (self.now, self.timer) = (now, None);
                    report = device.handle_csma(now, event, self).or(report);
                }
                (_, Some((now, event))) => {
                    (self.now, self.tracking) = (now, None);
                    device.handle(now, event, self);
                }
                (Some(_), None) => unreachable!("the first arm takes it"),
            }
        }
    }

    fn pending(&self) -> Option<(u64, Event)> {
        self.tracking.map(|(at, event)| (symbols(at), event))
    }

    fn state(&self) -> Option<RadioState> {
        self.states.last().map(|entry| entry.1)
    }
}

fn settings(beacon_order: u8, superframe_order: u8) -> BeaconEnabled {
    let gts = vec![GtsConfig { node: "a".to_owned(), slots: 2 }];
    let config = BeaconEnabledConfig { beacon_order, superframe_order, gts, ..BeaconEnabledConfig::default() };
    BeaconEnabled::try_from(config).expect("good settings")
}

/// A beacon that gives slots 14 and 15 to device 7.
fn beacon(settings: &BeaconEnabled) -> Beacon<'static> {
    Beacon {
        superframe: Superframe {
            beacon_order: settings.beacon_order(),
            superframe_order: settings.superframe_order(),
            final_cap_slot: 13,
            battery_life_extension: false,
            pan_coordinator: true,
            association_permit: false,
        },
        gts_permit: false,
        guaranteed: vec![GuaranteedSlot { device: 7, first_slot: 14, slots: 2, receive_only: false }],
        pending_short: Vec::new(),
        pending_extended: Vec::new(),
        payload: &[],
    }
}

const FRAME: OutgoingFrame = OutgoingFrame { mpdu_octets: 44, ack_request: false, sequence: 7 };

#[test]
fn a_device_without_coordinator_listens_and_sends_nothing() {
    let mut radio = Script::default();
    let mut device = Device::new(&settings(1, 0), PHY, 3);
    assert_eq!(Device::INITIAL_STATE, RadioState::Receive);
    device.start(at(0), FRAME, &mut radio);
    assert!(device.is_busy() && !device.is_synchronised());
    assert!(radio.timer.is_none() && radio.tracking.is_none() && radio.states.is_empty());
}

#[test]
fn a_beacon_opens_contention_and_the_device_sleeps_when_the_active_part_is_over() {
    let mut radio = Script::default();
    let settings = settings(1, 0);
    let mut device = Device::new(&settings, PHY, 3);
    device.start(at(0), FRAME, &mut radio);
    radio.hear(&mut device, 1000, &beacon(&settings));
    assert!(device.is_synchronised());
    let report = radio.run(&mut device, 2900).expect("it is sent");
    // Boundaries 1040, 1060 and 1080 after a beacon that ends at 1038.
    assert_eq!((radio.transmissions.as_slice(), report.outcome), (&[1080][..], Outcome::Sent));
    // Active for 960 symbols of an interval of 1920; awake again 12 symbols before the next beacon.
    assert_eq!(radio.states[radio.states.len() - 2..], [(1180, RadioState::Idle), (1960, RadioState::Sleep)]);
    assert_eq!(radio.pending(), Some((2908, Event::BeaconNear)));
    radio.run(&mut device, 2909);
    assert_eq!(radio.states.last(), Some(&(2908, RadioState::Receive)));
    assert_eq!(radio.pending(), Some((2908 + WAIT, Event::BeaconMissed)));
}

#[test]
fn the_owner_of_a_guaranteed_slot_sends_at_its_start_and_never_contends() {
    let mut radio = Script::default();
    let settings = settings(1, 0);
    let mut device = Device::new(&settings, PHY, 7);
    device.start(at(0), FRAME, &mut radio);
    radio.hear(&mut device, 1000, &beacon(&settings));
    assert_eq!(radio.pending(), Some((1000 + 14 * 60 - 12, Event::GuaranteedSlotNear)));
    // 120 symbols: frame and spacing take 140, so the frame is not sent.
    assert_eq!(radio.run(&mut device, 2900), None);
    assert!(radio.transmissions.is_empty() && device.is_busy());

    let mut radio = Script::default();
    let mut device = Device::new(&settings, PHY, 7);
    device.start(at(0), OutgoingFrame { mpdu_octets: 20, ..FRAME }, &mut radio);
    radio.hear(&mut device, 1000, &beacon(&settings));
    radio.run(&mut device, 2900);
    assert_eq!(radio.transmissions, [1840]);
    assert_eq!(radio.pending(), Some((2908, Event::BeaconNear)));
}

#[test]
fn a_device_that_missed_the_beacon_sends_nothing_in_that_superframe() {
    let mut radio = Script::default();
    let settings = settings(1, 0);
    let mut device = Device::new(&settings, PHY, 3);
    radio.hear(&mut device, 1000, &beacon(&settings));
    radio.run(&mut device, 2920 + 300);
    assert_eq!(radio.state(), Some(RadioState::Sleep));
    radio.now = at(2920 + 300);
    device.start(radio.now, FRAME, &mut radio);
    radio.run(&mut device, 2920 + 1900);
    assert!(radio.transmissions.is_empty() && device.is_synchronised());
    // The next beacon is heard, and the frame goes out.
    radio.hear(&mut device, 1000 + 2 * 1920, &beacon(&settings));
    radio.run(&mut device, 6000);
    assert_eq!(radio.transmissions, [1000 + 2 * 1920 + 80]);
}

#[test]
fn the_coordinator_is_lost_after_four_beacons_in_a_row_and_found_again() {
    let mut radio = Script::default();
    let settings = settings(1, 1);
    let mut device = Device::new(&settings, PHY, 3);
    let beacon = beacon(&settings);
    radio.hear(&mut device, 1000, &beacon);
    // Three missed, one heard, four missed.
    radio.run(&mut device, 1000 + 3 * 1920 + 500);
    assert!(device.is_synchronised());
    let heard = 1000 + 4 * 1920;
    radio.hear(&mut device, heard, &beacon);
    for (missed, synchronised) in [(1, true), (2, true), (3, true), (4, false)] {
        radio.run(&mut device, heard + missed * 1920 + 500);
        assert_eq!(device.is_synchronised(), synchronised, "{missed} missed");
    }
    assert_eq!(radio.states.last(), Some(&(heard + 4 * 1920 - 12, RadioState::Receive)));
    assert_eq!(radio.pending(), None);
    radio.hear(&mut device, 100_000, &beacon);
    assert!(device.is_synchronised());
}

#[test]
fn a_beacon_that_opens_no_superframe_is_not_followed() {
    let mut radio = Script::default();
    let settings = settings(1, 0);
    let mut device = Device::new(&settings, PHY, 3);
    let mut beacon = beacon(&settings);
    beacon.superframe.beacon_order = 15;
    radio.hear(&mut device, 1000, &beacon);
    assert!(!device.is_synchronised() && radio.pending().is_none());
}

#[test]
fn a_wait_for_an_acknowledgement_beyond_the_active_part_ends_in_sleep() {
    let mut radio = Script::default();
    let settings = settings(1, 0);
    let mut device = Device::new(&settings, PHY, 3);
    let mut beacon = beacon(&settings);
    (beacon.superframe.final_cap_slot, beacon.guaranteed) = (15, Vec::new());
    radio.hear(&mut device, 1000, &beacon);
    // 8 octets have 28 symbols: CCAs on 1840 and 1860, frame from 1880 to 1908, acknowledgement due on 1920, end of
    // the spacing 1954, in time; but the wait lasts until 1962.
    radio.now = at(1840);
    device.start(radio.now, OutgoingFrame { mpdu_octets: 8, ack_request: true, sequence: 1 }, &mut radio);
    assert_eq!(radio.run(&mut device, 2900), None);
    assert_eq!(radio.transmissions, [1880]);
    assert_eq!(radio.states[radio.states.len() - 2..], [(1920, RadioState::Receive), (1962, RadioState::Sleep)]);
    assert!(device.is_busy());
}
