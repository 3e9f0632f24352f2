//! Tests of the machine with a scripted radio. Instants are counted in symbols of 16 us after the start of the
//! beacon; a backoff period has 20.

use std::collections::VecDeque;

use super::*;
use crate::csma::CsmaConfig;

const PHY: Phy = Phy::Oqpsk2450;

/// A command of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    Draw { max: u32 },
    Cca,
    Transmit,
    Enter(RadioState),
}

/// A radio with given draws, channel states and acknowledgements. After the end of a list, draws are 0, the channel
/// is idle and no acknowledgement comes.
#[derive(Default)]
struct Script {
    now: SimTime,
    draws: VecDeque<u32>,
    busy: VecDeque<bool>,
    /// For each transmission, whether it is acknowledged.
    acks: VecDeque<bool>,
    timer: Option<(SimTime, Event)>,
    air: Vec<(SimTime, Event)>,
    log: Vec<(u64, Step)>,
}

fn at(symbols: u64) -> SimTime {
    SimTime::ZERO + PHY.symbols(symbols)
}

fn symbols(time: SimTime) -> u64 {
    time.as_nanos() / 16_000
}

impl Script {
    fn new(draws: &[u32], busy: &[bool], acks: &[bool]) -> Self {
        Self {
            draws: draws.iter().copied().collect(),
            busy: busy.iter().copied().collect(),
            acks: acks.iter().copied().collect(),
            ..Self::default()
        }
    }

    fn note(&mut self, step: Step) {
        self.log.push((symbols(self.now), step));
    }

    fn next(&mut self) -> Option<Event> {
        let due = |&(at, event): &(SimTime, Event)| (at, event.class());
        let next = self.timer.into_iter().chain(self.air.iter().copied()).min_by_key(due)?;
        if self.timer == Some(next) {
            self.timer = None;
        } else {
            self.air.retain(|pending| *pending != next);
        }
        self.now = next.0;
        Some(next.1)
    }

    /// Runs until a frame has ended or nothing is pending.
    fn run(&mut self, csma: &mut SlottedCsma) -> Option<Report> {
        while let Some(event) = self.next() {
            let report = csma.handle(self.now, event, self);
            if report.is_some() {
                return report;
            }
        }
        None
    }

    fn open(&mut self, csma: &mut SlottedCsma, now: u64, window: AccessWindow) {
        self.now = at(now);
        csma.open(self.now, window, self);
    }

    fn start(&mut self, csma: &mut SlottedCsma, now: u64, frame: OutgoingFrame) {
        self.now = at(now);
        csma.start(self.now, frame, self);
    }

    fn instants(&self, step: Step) -> Vec<u64> {
        self.log.iter().filter(|entry| entry.1 == step).map(|entry| entry.0).collect()
    }

    fn windows(&self) -> Vec<u32> {
        let window = |&(_, step): &(u64, Step)| if let Step::Draw { max } = step { Some(max) } else { None };
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
    }

    fn enter(&mut self, state: RadioState) {
        self.note(Step::Enter(state));
    }

    fn start_cca(&mut self) {
        self.note(Step::Cca);
        let busy = self.busy.pop_front().unwrap_or(false);
        self.air.push((self.now + PHY.cca(), Event::CcaEnded { busy }));
    }

    fn start_transmission(&mut self, frame: OutgoingFrame) {
        self.note(Step::Transmit);
        let end = self.now + PHY.airtime(frame.mpdu_octets);
        self.air.push((end, Event::TransmissionEnded));
        if self.acks.pop_front().unwrap_or(false) {
            // On the first boundary that is at least a turnaround away.
            let ack = at((symbols(end) + 12).next_multiple_of(20));
            self.air.push((ack + PHY.ack_airtime(), Event::AckReceived { sequence: frame.sequence }));
        }
    }
}

/// 44 octets: 100 symbols, five backoff periods.
const FRAME: OutgoingFrame = OutgoingFrame { mpdu_octets: 44, ack_request: false, sequence: 7 };
const UNICAST: OutgoingFrame = OutgoingFrame { ack_request: true, ..FRAME };
const LIFS: u64 = 40;

fn machine() -> SlottedCsma {
    SlottedCsma::new(CsmaSettings::default(), PHY)
}

/// Contention from boundary 0 to `end` symbols.
fn until(end: u64) -> AccessWindow {
    AccessWindow::Contention(Contention::new(PHY, at(0), at(end)))
}

/// Contention in the superframe that starts at `start`.
fn between(start: u64, end: u64) -> AccessWindow {
    AccessWindow::Contention(Contention::new(PHY, at(start), at(end)))
}

#[test]
fn a_frame_goes_out_after_its_backoff_and_two_idle_ccas_all_on_boundaries() {
    let mut radio = Script::new(&[3], &[], &[]);
    let mut csma = machine();
    radio.open(&mut csma, 0, until(10_000));
    // The frame comes within a backoff period: counting starts at its end.
    radio.start(&mut csma, 7, FRAME);
    let report = radio.run(&mut csma);
    let expected = [
        (7, Step::Draw { max: 7 }),
        (80, Step::Enter(RadioState::Receive)),
        (80, Step::Cca),
        (100, Step::Enter(RadioState::Receive)),
        (100, Step::Cca),
        (108, Step::Enter(RadioState::Turnaround)),
        (120, Step::Enter(RadioState::Transmit)),
        (120, Step::Transmit),
        (220, Step::Enter(RadioState::Idle)),
    ];
    assert_eq!(radio.log, expected);
    assert_eq!(report, Some(Report { frame: FRAME, outcome: Outcome::Sent, ccas: 2, transmissions: 1 }));
}

#[test]
fn a_frame_that_comes_on_a_boundary_counts_from_this_boundary() {
    let mut radio = Script::new(&[0], &[], &[]);
    let mut csma = machine();
    radio.open(&mut csma, 0, until(10_000));
    radio.start(&mut csma, 60, FRAME);
    radio.run(&mut csma);
    assert_eq!((radio.instants(Step::Cca), radio.instants(Step::Transmit)), (vec![60, 80], vec![100]));
}

#[test]
fn a_busy_channel_in_either_cca_starts_a_longer_backoff_at_the_next_boundary() {
    // Busy first, busy second, then idle twice: the first CCA after a busy one is the first of two again.
    let mut radio = Script::new(&[0, 2, 1], &[true, false, true], &[]);
    let mut csma = machine();
    radio.open(&mut csma, 0, until(10_000));
    radio.start(&mut csma, 0, FRAME);
    let report = radio.run(&mut csma).expect("it is sent");
    assert_eq!(radio.windows(), [7, 15, 31]);
    // Busy at 0: two periods from 20. Idle at 60, busy at 80: one period from 100.
    assert_eq!(radio.instants(Step::Cca), [0, 60, 80, 120, 140]);
    assert_eq!(radio.instants(Step::Transmit), [160]);
    assert_eq!((report.outcome, report.ccas), (Outcome::Sent, 5));
}

#[test]
fn a_busy_channel_is_given_up_after_five_busy_ccas() {
    let mut radio = Script::new(&[], &[true; 5], &[]);
    let mut csma = machine();
    radio.open(&mut csma, 0, until(10_000));
    radio.start(&mut csma, 0, FRAME);
    let report = radio.run(&mut csma).expect("it is given up");
    assert_eq!(radio.windows(), [7, 15, 31, 31, 31]);
    assert_eq!(radio.instants(Step::Cca), [0, 20, 40, 60, 80]);
    assert_eq!(report, Report { frame: FRAME, outcome: Outcome::ChannelAccessFailure, ccas: 5, transmissions: 0 });
    assert!(!csma.is_busy() && !csma.is_on_air());
}

#[test]
fn outside_windows_a_frame_waits_without_touching_the_radio() {
    let mut radio = Script::new(&[1], &[], &[]);
    let mut csma = machine();
    radio.start(&mut csma, 0, FRAME);
    assert!(csma.is_busy() && !csma.is_on_air());
    assert_eq!((radio.log.len(), radio.timer), (0, None));
    radio.open(&mut csma, 1000, between(960, 2000));
    radio.run(&mut csma);
    assert_eq!(radio.instants(Step::Cca), [1020, 1040]);
    // The window is over: the next frame waits.
    radio.start(&mut csma, 2000, FRAME);
    assert_eq!(radio.windows().len(), 1);
}

#[test]
fn backoff_periods_that_remain_at_the_end_of_a_window_are_counted_in_the_next() {
    let mut radio = Script::new(&[6], &[], &[]);
    let mut csma = machine();
    radio.open(&mut csma, 0, until(1000));
    // Two periods are left from boundary 960 on.
    radio.start(&mut csma, 950, FRAME);
    assert_eq!(radio.timer, None);
    assert!(csma.is_busy());
    radio.open(&mut csma, 2000, between(2000, 3000));
    radio.run(&mut csma);
    // One draw, four periods left.
    assert_eq!(radio.windows(), [7]);
    assert_eq!(radio.instants(Step::Cca), [2080, 2100]);
}

#[test]
fn a_frame_that_does_not_fit_after_its_backoff_draws_again_with_the_same_exponent_in_the_next_window() {
    // Busy once, so that the exponent has grown. CCAs, frame and spacing take 40 + 100 + 40 symbols.
    let mut radio = Script::new(&[0, 2, 9], &[true], &[]);
    let mut csma = machine();
    radio.open(&mut csma, 0, until(239));
    radio.start(&mut csma, 0, FRAME);
    assert_eq!(radio.run(&mut csma), None);
    assert_eq!(radio.windows(), [7, 15]);
    radio.open(&mut csma, 1000, between(1000, 3000));
    radio.run(&mut csma);
    assert_eq!(radio.windows(), [7, 15, 15]);
    assert_eq!(radio.instants(Step::Cca), [0, 1180, 1200]);

    // One symbol more and it fits: 60 + 180.
    let mut radio = Script::new(&[0, 2], &[true], &[]);
    let mut csma = machine();
    radio.open(&mut csma, 0, until(240));
    radio.start(&mut csma, 0, FRAME);
    assert_eq!(radio.run(&mut csma).map(|report| report.outcome), Some(Outcome::Sent));
    assert_eq!(radio.instants(Step::Transmit), [100]);
}

#[test]
fn a_window_that_is_over_counts_nothing_even_if_zero_is_drawn() {
    let mut radio = Script::new(&[], &[], &[]);
    let mut csma = machine();
    radio.open(&mut csma, 0, until(100));
    radio.start(&mut csma, 100, FRAME);
    assert!(radio.log.is_empty());
}

#[test]
fn an_acknowledged_frame_ends_with_its_acknowledgement() {
    let mut radio = Script::new(&[0], &[], &[true]);
    let mut csma = machine();
    radio.open(&mut csma, 0, until(10_000));
    radio.start(&mut csma, 0, UNICAST);
    let report = radio.run(&mut csma).expect("it is acknowledged");
    // The frame ends on boundary 140, the acknowledgement starts on 160 and has 22 symbols.
    let last = [
        (140, Step::Enter(RadioState::Turnaround)),
        (152, Step::Enter(RadioState::Receive)),
        (182, Step::Enter(RadioState::Idle)),
    ];
    assert_eq!(radio.log[radio.log.len() - 3..], last);
    assert_eq!(report, Report { frame: UNICAST, outcome: Outcome::Acknowledged, ccas: 2, transmissions: 1 });
    // The spacing counts from the end of the acknowledgement.
    radio.start(&mut csma, 190, UNICAST);
    let event = radio.next().expect("the spacing ends");
    assert_eq!((event, symbols(radio.now)), (Event::InterframeSpaceEnded, 182 + LIFS));
}

#[test]
fn a_frame_without_acknowledgement_is_sent_four_times() {
    let mut radio = Script::new(&[], &[], &[]);
    let mut csma = machine();
    radio.open(&mut csma, 0, until(10_000));
    radio.start(&mut csma, 0, UNICAST);
    let report = radio.run(&mut csma).expect("it is given up");
    // 54 symbols after the end of the frame the wait is over; the next backoff starts at the next boundary.
    assert_eq!(radio.instants(Step::Transmit), [40, 240, 440, 640]);
    assert_eq!(radio.windows(), [7; 4]);
    assert_eq!(report, Report { frame: UNICAST, outcome: Outcome::NoAck, ccas: 8, transmissions: 4 });
    assert_eq!(symbols(radio.now), 740 + 54);
}

#[test]
fn a_retry_that_does_not_fit_continues_in_the_next_window() {
    let mut radio = Script::new(&[0, 3], &[], &[false, true]);
    let mut csma = machine();
    // The frame ends at 140, its acknowledgement would at 182, the spacing does at 222. The wait ends at 194; of
    // three periods one is left from 200 on.
    radio.open(&mut csma, 0, until(222));
    radio.start(&mut csma, 0, UNICAST);
    assert_eq!(radio.run(&mut csma), None);
    assert!(csma.is_busy());
    radio.open(&mut csma, 1000, between(1000, 2000));
    let report = radio.run(&mut csma).expect("it is acknowledged");
    assert_eq!(radio.instants(Step::Transmit), [40, 1080]);
    assert_eq!((report.outcome, report.transmissions), (Outcome::Acknowledged, 2));
}

#[test]
fn battery_life_extension_starts_with_an_exponent_of_two_at_most() {
    let window = |saving: bool| {
        let contention = Contention::new(PHY, at(0), at(10_000));
        AccessWindow::Contention(if saving { contention.with_battery_life_extension() } else { contention })
    };
    for (min_be, saving, max) in [(3, true, 3), (1, true, 1), (3, false, 7), (5, true, 3)] {
        let config = CsmaConfig { min_be, ..CsmaConfig::default() };
        let mut csma = SlottedCsma::new(CsmaSettings::try_from(config).expect("good settings"), PHY);
        let mut radio = Script::new(&[], &[], &[]);
        radio.open(&mut csma, 0, window(saving));
        radio.start(&mut csma, 0, FRAME);
        assert_eq!(radio.windows(), [max]);
    }
    // Counting stops after six periods: of five drawn at boundary 40, four are counted, so one is left.
    let mut radio = Script::new(&[5], &[], &[]);
    let mut csma = SlottedCsma::new(CsmaSettings::default(), PHY);
    radio.open(&mut csma, 0, window(true));
    radio.start(&mut csma, 40, FRAME);
    assert_eq!(radio.timer, None);
    let next = Contention::new(PHY, at(5000), at(9000)).with_battery_life_extension();
    radio.open(&mut csma, 5000, AccessWindow::Contention(next));
    radio.run(&mut csma);
    assert_eq!(radio.instants(Step::Cca), [5020, 5040]);
}

#[test]
fn in_a_guaranteed_slot_a_frame_goes_out_at_its_start_without_carrier_sense() {
    let mut radio = Script::new(&[], &[], &[]);
    let mut csma = machine();
    radio.start(&mut csma, 0, FRAME);
    // The slot starts at 900; its window opens a turnaround before. 100 + 40 symbols are just enough.
    radio.open(&mut csma, 888, AccessWindow::Guaranteed { end: at(900 + 140) });
    let report = radio.run(&mut csma).expect("it is sent");
    let expected = [
        (888, Step::Enter(RadioState::Turnaround)),
        (900, Step::Enter(RadioState::Transmit)),
        (900, Step::Transmit),
        (1000, Step::Enter(RadioState::Idle)),
    ];
    assert_eq!(radio.log, expected);
    assert_eq!(report, Report { frame: FRAME, outcome: Outcome::Sent, ccas: 0, transmissions: 1 });
}

#[test]
fn a_guaranteed_slot_that_is_a_symbol_too_short_is_left_unused() {
    for (frame, span) in [(FRAME, 140), (UNICAST, 100 + 12 + 22 + 40)] {
        for (length, sent) in [(span, 1), (span - 1, 0)] {
            let mut radio = Script::new(&[], &[], &[]);
            let mut csma = machine();
            radio.start(&mut csma, 0, frame);
            radio.open(&mut csma, 888, AccessWindow::Guaranteed { end: at(900 + length) });
            assert_eq!(radio.timer.iter().count(), sent, "{length} symbols for {frame:?}");
        }
    }
    assert_eq!(guaranteed_span(PHY, 44, true), PHY.symbols(174));
}

#[test]
fn a_second_copy_goes_out_in_the_same_guaranteed_slot_if_it_fits() {
    let mut radio = Script::new(&[], &[], &[]);
    let mut csma = machine();
    radio.start(&mut csma, 0, UNICAST);
    // Frame and wait take 154 symbols, the turnaround 12, the second copy with acknowledgement and spacing 174.
    radio.open(&mut csma, 888, AccessWindow::Guaranteed { end: at(900 + 154 + 12 + 174) });
    assert_eq!(radio.run(&mut csma), None);
    assert_eq!(radio.instants(Step::Transmit), [900, 1066]);
    // The third waits for the slot of the next superframe.
    radio.open(&mut csma, 2888, AccessWindow::Guaranteed { end: at(3200) });
    radio.run(&mut csma);
    assert_eq!(radio.instants(Step::Transmit), [900, 1066, 2900]);
}

#[test]
fn a_frame_that_comes_within_a_guaranteed_slot_still_uses_it() {
    let mut radio = Script::new(&[], &[], &[]);
    let mut csma = machine();
    radio.open(&mut csma, 888, AccessWindow::Guaranteed { end: at(1300) });
    radio.start(&mut csma, 950, FRAME);
    radio.run(&mut csma);
    assert_eq!(radio.instants(Step::Transmit), [962]);
    // The spacing after it must pass, and then the rest of the slot is too short.
    radio.start(&mut csma, 1070, FRAME);
    assert_eq!(radio.run(&mut csma).map(|report| report.outcome), Some(Outcome::Sent));
    assert_eq!(radio.instants(Step::Transmit), [962, 962 + 100 + LIFS + 12]);
    radio.start(&mut csma, 1215, FRAME);
    assert_eq!(radio.run(&mut csma), None);
}

#[test]
fn an_unexpected_acknowledgement_changes_nothing() {
    let stray = Event::AckReceived { sequence: 7 };
    let mut radio = Script::new(&[2], &[], &[]);
    let mut csma = machine();
    assert_eq!(csma.handle(at(0), stray, &mut radio), None);
    radio.open(&mut csma, 0, until(10_000));
    radio.start(&mut csma, 0, UNICAST);
    let log = radio.log.clone();
    assert_eq!(csma.handle(at(1), stray, &mut radio), None);
    assert_eq!(radio.log, log);
}
