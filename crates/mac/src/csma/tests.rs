//! Tests of the machine with a scripted radio.

use std::collections::VecDeque;
use std::time::Duration;

use sextant_kernel::SimTime;

use super::*;
use crate::Class;
use crate::{EnergyMeter, RadioStates};

/// A command of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    Draw { max: u32 },
    Cca,
    Transmit,
    Cancel,
    Enter(RadioState),
}

/// A radio with given draws, channel states and acknowledgements. After the end of a list, draws
/// are 0, the channel is idle and no acknowledgement comes.
struct Script {
    phy: Phy,
    now: SimTime,
    draws: VecDeque<u32>,
    busy: VecDeque<bool>,
    /// For each transmission, the sequence number of the acknowledgement that follows, if any.
    acks: VecDeque<Option<u8>>,
    timer: Option<(SimTime, Event)>,
    air: Vec<(SimTime, Event)>,
    /// The commands and their instants (us).
    log: Vec<(u64, Step)>,
    meter: EnergyMeter,
}

impl Script {
    fn new(draws: &[u32], busy: &[bool], acks: &[Option<u8>]) -> Self {
        Self {
            phy: Phy::Oqpsk2450,
            now: SimTime::ZERO,
            draws: draws.iter().copied().collect(),
            busy: busy.iter().copied().collect(),
            acks: acks.iter().copied().collect(),
            timer: None,
            air: Vec::new(),
            log: Vec::new(),
            meter: EnergyMeter::new(RadioState::Idle, SimTime::ZERO),
        }
    }

    fn now_us(&self) -> u64 {
        self.now.as_nanos() / 1000
    }

    fn note(&mut self, step: Step) {
        self.log.push((self.now_us(), step));
    }

    /// Advances to the next event; `None` if nothing is pending.
    fn next(&mut self) -> Option<Event> {
        let due = |&(at, event): &(SimTime, Event)| (at, event.class());
        let from_air = self.air.iter().copied().min_by_key(due);
        let next = self.timer.into_iter().chain(from_air).min_by_key(due)?;
        if self.timer == Some(next) {
            self.timer = None;
        } else {
            self.air.retain(|pending| *pending != next);
        }
        self.now = next.0;
        Some(next.1)
    }

    /// Runs until the frame under way has ended.
    fn report(&mut self, csma: &mut Csma) -> Report {
        loop {
            let event = self.next().expect("the machine waits for something");
            if let Some(report) = csma.handle(event, self) {
                self.meter.enter(self.meter.state(), self.now);
                return report;
            }
        }
    }

    /// The instants (us) of this command.
    fn instants(&self, step: Step) -> Vec<u64> {
        self.log.iter().filter(|entry| entry.1 == step).map(|entry| entry.0).collect()
    }

    fn windows(&self) -> Vec<u32> {
        let window = |&(_, step): &(u64, Step)| {
            if let Step::Draw { max } = step { Some(max) } else { None }
        };
        self.log.iter().filter_map(window).collect()
    }
}

impl Radio for Script {
    fn backoff_periods(&mut self, max_inclusive: u32) -> u32 {
        self.note(Step::Draw { max: max_inclusive });
        self.draws.pop_front().unwrap_or(0)
    }

    fn after(&mut self, span: Duration, event: Event) {
        assert_eq!(self.timer, None, "there is one timer");
        self.timer = Some((self.now + span, event));
    }

    fn cancel_timer(&mut self) {
        assert!(self.timer.take().is_some(), "a timer is pending");
        self.note(Step::Cancel);
    }

    fn enter(&mut self, state: RadioState) {
        self.meter.enter(state, self.now);
        self.note(Step::Enter(state));
    }

    fn start_cca(&mut self) {
        assert_eq!(self.meter.state(), RadioState::Receive);
        self.note(Step::Cca);
        let busy = self.busy.pop_front().unwrap_or(false);
        self.air.push((self.now + self.phy.cca(), Event::CcaEnded { busy }));
    }

    fn start_transmission(&mut self, frame: OutgoingFrame) {
        assert_eq!(self.meter.state(), RadioState::Transmit);
        self.note(Step::Transmit);
        let end = self.now + self.phy.airtime(frame.mpdu_octets);
        self.air.push((end, Event::TransmissionEnded));
        if let Some(sequence) = self.acks.pop_front().flatten() {
            let heard = end + self.phy.turnaround() + self.phy.ack_airtime();
            self.air.push((heard, Event::AckReceived { sequence }));
        }
    }
}

const BROADCAST: OutgoingFrame = OutgoingFrame { mpdu_octets: 20, ack_request: false, sequence: 7 };
const UNICAST: OutgoingFrame = OutgoingFrame { ack_request: true, ..BROADCAST };
const BUSY: [bool; 5] = [true; 5];

fn machine() -> Csma {
    Csma::new(CsmaSettings::default(), Phy::Oqpsk2450)
}

fn machine_with(config: CsmaConfig) -> Csma {
    Csma::new(CsmaSettings::try_from(config).expect("good settings"), Phy::Oqpsk2450)
}

#[test]
fn a_frame_on_an_idle_channel_goes_out_after_backoff_cca_and_turnaround() {
    let mut radio = Script::new(&[5], &[], &[]);
    let mut csma = machine();
    csma.start(BROADCAST, &mut radio);
    let report = radio.report(&mut csma);
    let expected = [
        (0, Step::Enter(RadioState::Idle)),
        (0, Step::Draw { max: 7 }),
        (1600, Step::Enter(RadioState::Receive)),
        (1600, Step::Cca),
        (1728, Step::Enter(RadioState::Turnaround)),
        (1920, Step::Enter(RadioState::Transmit)),
        (1920, Step::Transmit),
        (2752, Step::Enter(RadioState::Idle)),
    ];
    assert_eq!(radio.log, expected);
    assert_eq!(report, Report { frame: BROADCAST, outcome: Outcome::Sent, ccas: 1, transmissions: 1 });
}

#[test]
fn a_busy_channel_is_given_up_after_five_ccas() {
    let mut radio = Script::new(&[2, 15, 0, 31, 1], &BUSY, &[]);
    let mut csma = machine();
    csma.start(BROADCAST, &mut radio);
    let report = radio.report(&mut csma);
    assert_eq!(radio.windows(), [7, 15, 31, 31, 31]);
    // Each backoff starts at the end of the CCA before it.
    assert_eq!(radio.instants(Step::Cca), [640, 5568, 5696, 15_744, 16_192]);
    assert_eq!(radio.now_us(), 16_192 + 128);
    let outcome = Outcome::ChannelAccessFailure;
    assert_eq!(report, Report { frame: BROADCAST, outcome, ccas: 5, transmissions: 0 });
    // Nothing was sent, so there is no interframe spacing.
    csma.start(BROADCAST, &mut radio);
    assert_eq!(radio.windows().len(), 6);
    assert_eq!(radio.report(&mut csma).outcome, Outcome::Sent);
}

#[test]
fn the_fifth_cca_can_still_find_the_channel_idle() {
    let mut radio = Script::new(&[], &BUSY[..4], &[]);
    let mut csma = machine();
    csma.start(BROADCAST, &mut radio);
    let report = radio.report(&mut csma);
    assert_eq!((report.outcome, report.ccas, report.transmissions), (Outcome::Sent, 5, 1));
}

#[test]
fn the_settings_bound_backoffs_and_exponents() {
    let config = CsmaConfig { min_be: 0, max_be: 3, max_backoffs: 5, ..CsmaConfig::default() };
    let mut radio = Script::new(&[], &[true; 6], &[]);
    let mut csma = machine_with(config);
    csma.start(BROADCAST, &mut radio);
    assert_eq!(radio.report(&mut csma).ccas, 6);
    assert_eq!(radio.windows(), [0, 1, 3, 7, 7, 7]);

    let config = CsmaConfig { min_be: 8, max_be: 8, max_backoffs: 0, ..config };
    let mut radio = Script::new(&[255], &BUSY, &[]);
    let mut csma = machine_with(config);
    csma.start(BROADCAST, &mut radio);
    assert_eq!(radio.report(&mut csma).ccas, 1);
    assert_eq!(radio.windows(), [255]);
    assert_eq!(radio.now_us(), 255 * 320 + 128);
}

#[test]
fn the_receiver_is_ready_when_the_acknowledgement_starts_and_the_frame_ends_with_it() {
    let mut radio = Script::new(&[0], &[], &[Some(7)]);
    let mut csma = machine();
    csma.start(UNICAST, &mut radio);
    let report = radio.report(&mut csma);
    let end = 128 + 192 + 832;
    let expected = [
        (end, Step::Enter(RadioState::Turnaround)),
        (end + 192, Step::Enter(RadioState::Receive)),
        (end + 192 + 352, Step::Cancel),
        (end + 192 + 352, Step::Enter(RadioState::Idle)),
    ];
    assert_eq!(radio.log[radio.log.len() - 4..], expected);
    assert_eq!(report, Report { frame: UNICAST, outcome: Outcome::Acknowledged, ccas: 1, transmissions: 1 });
    assert_eq!(Event::ReceiveReady.class(), Class::EndOfSignal);
    assert!(Event::ReceiveReady.class() < Class::StartOfSignal);
}

#[test]
fn a_frame_without_acknowledgement_is_sent_four_times() {
    let mut radio = Script::new(&[], &[], &[]);
    let mut csma = machine();
    csma.start(UNICAST, &mut radio);
    let report = radio.report(&mut csma);
    // Backoff 0, CCA, turnaround, frame; the wait is 864 us from the end of the frame.
    let period = 128 + 192 + 832 + 864;
    assert_eq!(radio.instants(Step::Transmit), [0, 1, 2, 3].map(|i| 320 + i * period));
    assert_eq!(radio.now_us(), 4 * period);
    assert_eq!(radio.windows(), [7; 4]);
    assert_eq!(report, Report { frame: UNICAST, outcome: Outcome::NoAck, ccas: 4, transmissions: 4 });
}

#[test]
fn a_late_acknowledgement_ends_the_retries() {
    let mut radio = Script::new(&[], &[], &[None, None, Some(7)]);
    let mut csma = machine();
    csma.start(UNICAST, &mut radio);
    let report = radio.report(&mut csma);
    assert_eq!((report.outcome, report.transmissions), (Outcome::Acknowledged, 3));
}

#[test]
fn an_acknowledgement_of_another_frame_does_not_count() {
    let config = CsmaConfig { max_retries: 0, ..CsmaConfig::default() };
    let mut radio = Script::new(&[], &[], &[Some(8)]);
    let mut csma = machine_with(config);
    csma.start(UNICAST, &mut radio);
    assert_eq!(radio.report(&mut csma).outcome, Outcome::NoAck);
}

#[test]
fn turnarounds_from_idle_and_back_take_time_if_the_scenario_says_so() {
    let config = CsmaConfig { idle_turnarounds: true, ..CsmaConfig::default() };
    // Backoffs of 2, then 0, then 1 periods; the second CCA follows the first one at once, because the radio stays on.
    let mut radio = Script::new(&[2, 0, 1], &[true, true, false], &[]);
    let mut csma = machine_with(config);
    csma.start(BROADCAST, &mut radio);
    assert_eq!(radio.report(&mut csma).outcome, Outcome::Sent);
    let instants =
        |wanted| radio.log.iter().filter(|(_, step)| *step == wanted).map(|(us, _)| *us).collect::<Vec<_>>();
    let first = 2 * 320 + 192;
    let third = first + 2 * 128 + 320 + 192;
    assert_eq!(instants(Step::Cca), [first, first + 128, third]);
    assert_eq!(instants(Step::Transmit), [third + 128 + 192]);
    assert_eq!(instants(Step::Enter(RadioState::Turnaround)), [640, third - 192, third + 128]);
    // With a receiver that is always on there is nothing to turn around.
    let mut radio = Script::new(&[2], &[], &[]);
    let mut csma = machine_with(CsmaConfig { rx_on_when_idle: true, ..config });
    csma.start(BROADCAST, &mut radio);
    radio.report(&mut csma);
    assert_eq!(radio.log.iter().find(|(_, step)| *step == Step::Cca), Some(&(640, Step::Cca)));
}

#[test]
fn an_acknowledgement_of_another_frame_ends_the_wait() {
    // Backoff 0, CCA, turnaround and frame take 1152 us; the acknowledgement ends 544 us after that, and the wait would
    // end after 864 us. The frame of 20 octets needs a silence of 640 us, so that 96 us are left of it.
    for (acks, end_us) in [([Some(8)], 1152 + 544), ([None], 1152 + 864)] {
        let config = CsmaConfig { max_retries: 0, ..CsmaConfig::default() };
        let mut radio = Script::new(&[], &[], &acks);
        let mut csma = machine_with(config);
        csma.start(UNICAST, &mut radio);
        assert_eq!(radio.report(&mut csma).outcome, Outcome::NoAck);
        assert_eq!(radio.now, SimTime::ZERO + Duration::from_micros(end_us));
        assert_eq!(radio.timer.is_some(), acks == [Some(8)]);
    }
    // The next attempt contends as after a missing acknowledgement.
    let mut radio = Script::new(&[], &[], &[Some(8), Some(7)]);
    let mut csma = machine();
    csma.start(UNICAST, &mut radio);
    let report = radio.report(&mut csma);
    assert_eq!((report.outcome, report.transmissions), (Outcome::Acknowledged, 2));
}

#[test]
fn an_unexpected_acknowledgement_changes_nothing() {
    let stray = Event::AckReceived { sequence: 7 };
    let mut radio = Script::new(&[], &[], &[]);
    let mut csma = machine();
    assert_eq!(csma.handle(stray, &mut radio), None);
    csma.start(UNICAST, &mut radio);
    let log = radio.log.clone();
    assert_eq!(csma.handle(stray, &mut radio), None);
    assert_eq!(radio.log, log);
    assert!(csma.is_busy());
}

#[test]
fn a_channel_access_failure_in_a_retry_ends_the_frame() {
    let busy = [&[false][..], &BUSY].concat();
    let mut radio = Script::new(&[], &busy, &[]);
    let mut csma = machine();
    csma.start(UNICAST, &mut radio);
    let report = radio.report(&mut csma);
    let outcome = Outcome::ChannelAccessFailure;
    assert_eq!(report, Report { frame: UNICAST, outcome, ccas: 6, transmissions: 1 });
}

#[test]
fn each_retry_starts_again_with_the_first_exponent_and_all_backoffs() {
    let busy = [&BUSY[..4], &[false], &BUSY[..4], &[false]].concat();
    let mut radio = Script::new(&[], &busy, &[None, Some(7)]);
    let mut csma = machine();
    csma.start(UNICAST, &mut radio);
    let report = radio.report(&mut csma);
    assert_eq!(radio.windows(), [7, 15, 31, 31, 31, 7, 15, 31, 31, 31]);
    assert_eq!((report.outcome, report.ccas, report.transmissions), (Outcome::Acknowledged, 10, 2));
}

#[test]
fn the_next_frame_waits_for_the_end_of_the_interframe_spacing() {
    // Until the next draw, from the end of the frame or of its acknowledgement.
    for (mpdu_octets, spacing) in [(5, 192), (18, 192), (19, 640), (127, 640)] {
        for ack_request in [false, true] {
            let frame = OutgoingFrame { mpdu_octets, ack_request, sequence: 7 };
            let mut radio = Script::new(&[], &[], &[ack_request.then_some(7)]);
            let mut csma = machine();
            csma.start(frame, &mut radio);
            radio.report(&mut csma);
            let end = radio.now_us();
            assert!(!csma.is_busy());
            csma.start(frame, &mut radio);
            assert!(csma.is_busy());
            let event = radio.next().expect("the spacing ends");
            assert_eq!((event, radio.now_us()), (Event::InterframeSpaceEnded, end + spacing));
            assert_eq!(csma.handle(event, &mut radio), None);
            assert_eq!(radio.instants(Step::Draw { max: 7 }), [0, end + spacing]);
        }
    }
}

#[test]
fn after_the_interframe_spacing_a_frame_starts_at_once() {
    let mut radio = Script::new(&[], &[], &[]);
    let mut csma = machine();
    csma.start(BROADCAST, &mut radio);
    radio.report(&mut csma);
    let event = radio.next().expect("the spacing ends");
    csma.handle(event, &mut radio);
    assert_eq!(radio.next(), None);
    csma.start(BROADCAST, &mut radio);
    assert_eq!(radio.windows().len(), 2);
}

#[test]
fn an_unanswered_frame_is_followed_by_the_wait_for_its_acknowledgement_or_the_spacing_if_that_is_longer() {
    // Length of a symbol (us), airtime of 18 and 50 octets (us), and macAckWaitDuration (symbols): one backoff period (20), one
    // turnaround (12), preamble and delimiter, and six octets in whole symbols. The spacing after 18 octets has 12 symbols,
    // and after 50 octets 40: with ASK at 868 MHz that is longer than the wait.
    for (phy, symbol_us, airtimes_us, wait, silences) in [
        (Phy::Oqpsk2450, 16, [768, 1792], 20 + 12 + 10 + 12, [54, 54]),
        (Phy::Bpsk868, 50, [9600, 22_400], 20 + 12 + 40 + 48, [120, 120]),
        (Phy::Bpsk915, 25, [4800, 11_200], 20 + 12 + 40 + 48, [120, 120]),
        (Phy::Ask868, 80, [848, 1872], 20 + 12 + 3 + 3, [38, 40]),
        (Phy::Ask915, 20, [748, 1772], 20 + 12 + 7 + 10, [49, 49]),
        (Phy::Oqpsk868, 40, [1920, 4480], 20 + 12 + 10 + 12, [54, 54]),
        (Phy::Oqpsk915, 16, [768, 1792], 20 + 12 + 10 + 12, [54, 54]),
    ] {
        assert_eq!(phy.ack_wait(), Duration::from_micros(wait * symbol_us), "{phy:?}");
        for ((mpdu_octets, airtime_us), silence) in [18, 50].into_iter().zip(airtimes_us).zip(silences) {
            let mut radio = Script::new(&[], &[], &[]);
            radio.phy = phy;
            let mut csma = Csma::new(CsmaSettings::default(), phy);
            csma.start(OutgoingFrame { mpdu_octets, ..UNICAST }, &mut radio);
            radio.report(&mut csma);
            // Assessment, turnaround, frame, silence.
            let period = (8 + 12 + silence) * symbol_us + airtime_us;
            let expected = [0, 1, 2, 3].map(|i| 20 * symbol_us + i * period);
            assert_eq!(radio.instants(Step::Transmit), expected, "{phy:?}, {mpdu_octets} octets");
            // The receiver is on until the wait is over, and rests for what is left of the spacing.
            let on_us = 4 * (8 + wait - 12) * symbol_us;
            assert_eq!(radio.meter.span(RadioState::Receive), Duration::from_micros(on_us), "{phy:?}");
        }
    }
}

#[test]
fn a_receiver_that_stays_on_rests_in_receive() {
    let config = CsmaConfig { rx_on_when_idle: true, ..CsmaConfig::default() };
    let mut radio = Script::new(&[3], &[true], &[]);
    let mut csma = machine_with(config);
    assert_eq!(csma.resting_state(), RadioState::Receive);
    csma.start(BROADCAST, &mut radio);
    radio.report(&mut csma);
    assert!(radio.instants(Step::Enter(RadioState::Idle)).is_empty());
    assert_eq!(radio.meter.span(RadioState::Receive), Duration::from_micros(3 * 320 + 2 * 128));
}

#[test]
fn a_radio_that_sleeps_between_frames_idles_for_a_frame_alone() {
    let config = CsmaConfig { sleep_between_frames: true, ..CsmaConfig::default() };
    let mut radio = Script::new(&[3], &[], &[]);
    let mut csma = machine_with(config);
    csma.start(BROADCAST, &mut radio);
    radio.report(&mut csma);
    while let Some(event) = radio.next() {
        csma.handle(event, &mut radio);
    }
    let states: Vec<_> =
        radio.log.iter().filter(|(_, step)| matches!(step, Step::Enter(_))).map(|&(_, step)| step).collect();
    use RadioState::{Idle, Receive, Sleep, Transmit, Turnaround};
    let expected = [Idle, Receive, Turnaround, Transmit, Idle, Sleep];
    assert_eq!(states, expected.map(Step::Enter));
    // A channel that is never free ends the frame, and the radio sleeps at once.
    let mut radio = Script::new(&[0; 9], &[true; 9], &[]);
    let mut csma = machine_with(config);
    csma.start(BROADCAST, &mut radio);
    radio.report(&mut csma);
    assert_eq!(radio.log.last().map(|&(_, step)| step), Some(Step::Enter(Sleep)));
}

#[test]
fn a_broadcast_of_a_lone_node_costs_63_microjoules_and_an_acknowledged_frame_94() {
    // The mean backoff is 3.5 periods: the mean of one of 3 and one of 4.
    let microjoules = |frame| {
        let one = |draw| {
            let mut radio = Script::new(&[draw], &[], &[Some(7)]);
            let mut csma = machine();
            csma.start(frame, &mut radio);
            radio.report(&mut csma);
            1e6 * radio.meter.spent(&RadioStates::cc2420(), sextant_channel::Dbm(0.0)).total_j()
        };
        (one(3) + one(4)) / 2.0
    };
    assert!((microjoules(BROADCAST) - 62.9).abs() < 0.05);
    assert!((microjoules(UNICAST) - 93.6).abs() < 0.05);
}

#[test]
fn an_event_fits_in_eight_octets() {
    assert!(size_of::<Event>() <= 8);
}
