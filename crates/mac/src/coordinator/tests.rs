use super::*;
use crate::frame::Address;
use crate::superframe::{BeaconEnabledConfig, GtsConfig};

const PHY: Phy = Phy::Oqpsk2450;
const SOURCE: Endpoint = Endpoint { pan: 0x1234, address: Address::Short(0) };

#[derive(Debug, Default, PartialEq)]
struct Script {
    timers: Vec<(Duration, Event)>,
    states: Vec<RadioState>,
    beacons: Vec<u8>,
}

impl Radio for Script {
    fn after(&mut self, span: Duration, event: Event) {
        self.timers.push((span, event));
    }

    fn enter(&mut self, state: RadioState) {
        self.states.push(state);
    }

    fn start_beacon(&mut self, mpdu_octets: u8) {
        self.beacons.push(mpdu_octets);
    }
}

fn coordinator(beacon_order: u8, superframe_order: u8, slots: &[u8]) -> Result<Coordinator, SettingError> {
    let gts = slots.iter().enumerate().map(|(i, &slots)| GtsConfig { node: format!("n{i}"), slots }).collect();
    let config = BeaconEnabledConfig { beacon_order, superframe_order, gts, ..BeaconEnabledConfig::default() };
    let settings = BeaconEnabled::try_from(config).expect("good settings");
    let devices: Vec<u16> = (0..slots.len()).map(|i| 0x0100 + u16::try_from(i).expect("at most 7")).collect();
    Coordinator::new(&settings, PHY, SOURCE, &devices, 0xCE)
}

fn at(us: u64) -> SimTime {
    SimTime::ZERO + Duration::from_micros(us)
}

#[test]
fn a_beacon_starts_a_turnaround_later_and_the_radio_is_deaf_until_a_turnaround_after_it() {
    let mut radio = Script::default();
    let mut coordinator = coordinator(6, 4, &[]).expect("good settings");
    assert_eq!((coordinator.active_end(), coordinator.is_sending()), (None, false));
    coordinator.prepare(&mut radio);
    assert!(coordinator.is_sending());
    coordinator.handle(at(1000), Event::TransmitReady, &mut radio);
    coordinator.handle(at(1608), Event::TransmissionEnded, &mut radio);
    assert!(coordinator.is_sending());
    coordinator.handle(at(1800), Event::ReceiveReady, &mut radio);
    assert!(!coordinator.is_sending());
    let turnaround = Duration::from_micros(192);
    assert_eq!(radio.timers, [(turnaround, Event::TransmitReady), (turnaround, Event::ReceiveReady)]);
    use RadioState::{Receive, Transmit, Turnaround};
    assert_eq!(radio.states, [Turnaround, Transmit, Turnaround, Receive]);
    assert_eq!(radio.beacons, [13]);
    assert_eq!(coordinator.active_end(), Some(at(1000 + 245_760)));
}

#[test]
fn beacons_have_the_octets_of_the_standard_and_ascending_numbers() {
    let mut coordinator = coordinator(6, 4, &[]).expect("good settings");
    let mut mpdu = Vec::new();
    coordinator.prepare(&mut Script::default());
    coordinator.write_beacon(&mut mpdu);
    // Control 0x8000, number, PAN, source; orders 6 and 4, final slot 15, PAN coordinator; no slots, nothing pending.
    let head = [0x00, 0x80, 0xCF, 0x34, 0x12, 0x00, 0x00, 0x46, 0x4F, 0x00, 0x00];
    assert_eq!(mpdu[..11], head);
    assert_eq!(mpdu.len(), 13);
    assert_eq!(Frame::parse(&mpdu).expect("good octets").sequence, 0xCF);
}

#[test]
fn guaranteed_slots_are_given_from_the_end_of_the_active_part() {
    let coordinator = coordinator(6, 6, &[1, 3]).expect("good settings");
    let mut mpdu = Vec::new();
    coordinator.write_beacon(&mut mpdu);
    let FrameBody::Beacon(beacon) = Frame::parse(&mpdu).expect("good octets").body else { panic!("a beacon") };
    let slot = |device, first_slot, slots| GuaranteedSlot { device, first_slot, slots, receive_only: false };
    assert_eq!(beacon.guaranteed, [slot(0x0100, 15, 1), slot(0x0101, 12, 3)]);
    assert_eq!(beacon.superframe.final_cap_slot, 11);
    assert_eq!(coordinator.guaranteed(), beacon.guaranteed);
}

#[test]
fn contention_keeps_at_least_440_symbols_after_the_beacon() {
    // Order 0: slots of 60 symbols. Beacons of 13, 17, 20 .. 35 octets have 38, 46, 52 .. 82 symbols.
    assert!(coordinator(0, 0, &[1; 7]).is_ok(), "540 - 82 = 458 symbols");
    assert!(coordinator(0, 0, &[7]).is_ok(), "540 - 46 = 494 symbols");
    let error = coordinator(0, 0, &[8]).expect_err("480 - 46 = 434 symbols");
    assert_eq!(error.key, "gts");
    assert!(error.to_string().contains("434 symbols"), "{error}");
    assert!(coordinator(1, 1, &[8]).is_ok());
    assert!(coordinator(1, 1, &[8, 4]).is_err(), "4 * 120 - 52 = 428 symbols");
}

#[test]
fn it_knows_which_frames_its_slots_and_its_contention_can_carry() {
    let coordinator = coordinator(0, 0, &[2, 3]).expect("good settings");
    // 120 symbols: 34 octets take 80 and the long spacing 40. Acknowledged, 18 octets take 48, 34 more and the short
    // spacing 12; 19 octets take 50, 34 more and the long one.
    assert!(coordinator.slot_carries(0, 34, false) && !coordinator.slot_carries(0, 35, false));
    assert!(coordinator.slot_carries(0, 18, true) && !coordinator.slot_carries(0, 19, true));
    assert!(coordinator.slot_carries(1, 35, false));
    assert!(coordinator.contention_carries(127, true));
}

#[test]
fn acknowledgements_wait_for_a_boundary_in_contention_only() {
    let mut coordinator = coordinator(1, 0, &[4]).expect("good settings");
    let turnaround = Duration::from_micros(192);
    assert_eq!(coordinator.ack_gap(at(7)), turnaround);
    coordinator.prepare(&mut Script::default());
    coordinator.handle(at(1000), Event::TransmitReady, &mut Script::default());
    assert_eq!(coordinator.ack_gap(at(1000 + 3200)), Duration::from_micros(320));
    assert_eq!(coordinator.ack_gap(at(1000 + 3200 + 200)), Duration::from_micros(440));
    // The guaranteed slot starts after 12 * 960 us, the active part ends after 15 360 us.
    assert_eq!(coordinator.ack_gap(at(1000 + 11_600)), turnaround);
    assert_eq!(coordinator.ack_gap(at(1000 + 20_000)), turnaround);
}
