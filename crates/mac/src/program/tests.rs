use super::*;
use crate::timing::Phy;

const PHY: Phy = Phy::Oqpsk2450;
const WAKE_UP_US: f64 = 860.0;

/// A radio and its timers: nothing happens but what these bring.
struct Script {
    radio: ProgramRadio,
    timers: Pending,
    now: SimTime,
}

#[derive(Default)]
struct Pending(Vec<(SimTime, Event)>);

impl Timers for Pending {
    fn set(&mut self, event: Event, at: SimTime) {
        self.cancel(event);
        self.0.push((at, event));
    }

    fn cancel(&mut self, event: Event) {
        self.0.retain(|&(_, pending)| pending != event);
    }
}

fn at(us: u64) -> SimTime {
    SimTime::from_nanos(1000 * us)
}

fn us(us: u64) -> Duration {
    Duration::from_micros(us)
}

/// The news up to an instant (us), each with its time (us).
type Log = Vec<(u64, News)>;

impl Script {
    fn new() -> Self {
        let config = ProgramConfig { channels: Vec::new(), wake_up_us: Some(WAKE_UP_US) };
        let settings = ProgramSettings::new(config, PHY, 11).expect("good settings");
        Self { radio: ProgramRadio::new(&settings, PHY), timers: Pending::default(), now: SimTime::ZERO }
    }

    /// A radio that has rested so for long.
    fn resting(rest: Rest) -> Self {
        let mut script = Self::new();
        script.rest(rest);
        assert_eq!(script.until(10_000).len(), usize::from(rest != Rest::Off));
        script.timers.0.clear();
        script.now = SimTime::ZERO;
        script.radio.awake = SimTime::ZERO;
        script
    }

    /// Goes on to an instant (us), its events included.
    fn until(&mut self, end_us: u64) -> Log {
        let mut log = Log::new();
        while let Some(next) =
            (0..self.timers.0.len()).min_by_key(|&i| (self.timers.0[i].0, self.timers.0[i].1.class()))
            && self.timers.0[next].0 <= at(end_us)
        {
            let (time, event) = self.timers.0.remove(next);
            assert!(time >= self.now, "{event:?} is set for the past");
            self.now = time;
            if let Some(news) = self.radio.handle(event, time, &mut self.timers) {
                log.push((time.as_nanos() / 1000, news));
            }
        }
        self.now = at(end_us);
        log
    }

    fn rest(&mut self, rest: Rest) -> SimTime {
        self.radio.rest(rest, self.now, &mut self.timers)
    }

    fn open(&mut self, from: Option<u64>, until: u64) -> Result<SimTime, Refusal> {
        self.radio.open(from.map(at), at(until), self.now, &mut self.timers)
    }

    fn send(&mut self, start: Option<u64>, awaited: Option<u8>) -> Result<SimTime, Refusal> {
        let sending = Sending { at: start.map(at), airtime: us(832), awaited };
        self.radio.send(sending, self.now, &mut self.timers)
    }

    fn state(&self) -> RadioState {
        self.radio.state()
    }
}

#[test]
fn the_way_to_a_rest_takes_a_turnaround_or_the_time_to_wake_up() {
    let mut script = Script::new();
    assert_eq!(script.state(), RadioState::Sleep);
    assert_eq!(script.rest(Rest::Idle), at(860));
    assert_eq!(script.until(860), [(860, News::Ready)]);
    assert_eq!(script.rest(Rest::Receive), at(860 + 192));
    assert_eq!(script.state(), RadioState::Turnaround);
    assert_eq!(script.until(2000), [(860 + 192, News::Ready)]);
    assert_eq!((script.state(), script.rest(Rest::Idle)), (RadioState::Receive, at(2000)));
    assert_eq!((script.state(), script.rest(Rest::Off)), (RadioState::Idle, at(2000)));
    assert_eq!((script.state(), script.rest(Rest::Receive)), (RadioState::Sleep, at(2000 + 860)));
    assert_eq!(script.until(5000), [(2860, News::Ready)]);
}

#[test]
fn a_radio_that_wakes_up_and_then_is_wanted_on_turns_around_besides() {
    let mut script = Script::new();
    script.rest(Rest::Idle);
    script.until(100);
    assert_eq!(script.rest(Rest::Receive), at(860));
    script.rest(Rest::Idle);
    script.until(800);
    assert_eq!(script.rest(Rest::Receive), at(800 + 192));
    // Off and on again: the time counts anew.
    script.rest(Rest::Off);
    assert_eq!(script.rest(Rest::Idle), at(800 + 860));
}

#[test]
fn a_frame_goes_out_a_turnaround_after_the_command_or_when_it_should() {
    for (rest, lead, state) in [(Rest::Idle, 192, RadioState::Idle), (Rest::Off, 860, RadioState::Sleep)] {
        let mut script = Script::resting(rest);
        assert_eq!(script.send(None, None), Ok(at(lead)));
        assert_eq!(script.state(), RadioState::Turnaround);
        assert_eq!(script.until(lead), [(lead, News::FrameBegins)]);
        assert_eq!(script.until(9000), [(lead + 832, News::Sent)]);
        assert_eq!(script.state(), state);
        let mut script = Script::resting(rest);
        assert_eq!(script.send(Some(5000), None), Ok(at(5000)));
        script.until(5000 - lead - 1);
        assert_eq!(script.state(), state);
        script.until(5000 - lead);
        assert_eq!(script.state(), RadioState::Turnaround);
        assert_eq!(script.until(9000), [(5000, News::FrameBegins), (5832, News::Sent)]);
    }
}

#[test]
fn a_receiver_is_on_again_a_turnaround_after_a_frame() {
    let mut script = Script::resting(Rest::Receive);
    script.send(None, None).expect("it is free");
    assert_eq!(script.until(3000), [(192, News::FrameBegins), (1024, News::Sent), (1216, News::Ready)]);
    assert_eq!(script.state(), RadioState::Receive);
}

#[test]
fn frames_too_early_or_beside_others_are_refused_with_the_earliest_instant() {
    let mut script = Script::resting(Rest::Idle);
    script.until(1000);
    assert_eq!(script.send(Some(1191), None), Err(Refusal::TooEarly { asked: at(1191), earliest: at(1192) }));
    assert_eq!(script.send(Some(3), None), Err(Refusal::TooEarly { asked: at(3), earliest: at(1192) }));
    assert_eq!(script.send(Some(1192), None), Ok(at(1192)));
    assert_eq!(script.send(None, None), Err(Refusal::Sending { until: at(1192 + 832) }));
    assert!(!script.radio.take_back(&mut script.timers), "it turns around already");
    script.until(3000);
    assert_eq!(script.send(Some(4000), None), Ok(at(4000)));
    assert_eq!(script.send(Some(9000), None), Err(Refusal::Sending { until: at(4832) }));
    assert!(script.radio.take_back(&mut script.timers));
    assert_eq!(script.until(9000), []);
    let words = Refusal::TooEarly { asked: at(3), earliest: at(1192) }.to_string();
    assert_eq!(
        words,
        "the instant is 0.000003000 s; allowed: 0.001192000 s or later, because the radio needs that time to turn around"
    );
}

#[test]
fn an_acknowledgement_is_awaited_for_864_us() {
    let mut script = Script::resting(Rest::Off);
    script.send(None, Some(7)).expect("it is free");
    script.until(860 + 832 + 191);
    assert_eq!(script.state(), RadioState::Turnaround);
    script.until(860 + 832 + 192);
    assert!(script.radio.is_awaiting() && script.state() == RadioState::Receive);
    assert_eq!(script.until(9000), [(860 + 832 + 864, News::Unacknowledged)]);
    assert_eq!(script.state(), RadioState::Sleep);
    let mut script = Script::resting(Rest::Idle);
    script.send(None, Some(7)).expect("it is free");
    script.until(192 + 832 + 192 + 352);
    assert!(!script.radio.receive_acknowledgement(8, script.now, &mut script.timers));
    assert!(script.radio.receive_acknowledgement(7, script.now, &mut script.timers));
    assert_eq!((script.state(), script.until(9000)), (RadioState::Idle, vec![]));
    // The shortest wait ends with the acknowledgement.
    assert_eq!(script.radio.set_ack_wait(us(543)), Err(us(544)));
    assert_eq!(script.radio.set_ack_wait(us(544)), Ok(()));
    script.send(None, Some(7)).expect("it is free");
    assert_eq!(script.until(20_000).last(), Some(&(9000 + 192 + 832 + 544, News::Unacknowledged)));
}

#[test]
fn a_window_is_open_from_its_start_to_its_end() {
    for (rest, lead, state) in [(Rest::Idle, 192, RadioState::Idle), (Rest::Off, 860, RadioState::Sleep)] {
        let mut script = Script::resting(rest);
        assert_eq!(script.open(Some(2000), 2500), Ok(at(2000)));
        script.until(2000 - lead - 1);
        assert_eq!(script.state(), state);
        assert_eq!(script.until(1999), []);
        assert_eq!(script.state(), RadioState::Turnaround);
        assert_eq!(script.until(2499), [(2000, News::Ready)]);
        assert_eq!(script.state(), RadioState::Receive);
        assert_eq!(script.until(2500), [(2500, News::WindowOver)]);
        assert_eq!(script.state(), state);
        let early = Refusal::TooEarly { asked: at(2600), earliest: at(2500 + lead) };
        assert_eq!(script.open(Some(2600), 9000).err(), (2600 < 2500 + lead).then_some(early));
    }
    let mut script = Script::resting(Rest::Idle);
    let empty = Refusal::EmptyWindow { from: at(192), until: at(192) };
    assert_eq!(script.open(None, 192), Err(empty));
    // The receiver is on: a window begins at once, and the next one replaces it.
    let mut script = Script::resting(Rest::Receive);
    assert_eq!((script.open(None, 500), script.open(None, 700)), (Ok(at(0)), Ok(at(0))));
    assert_eq!(script.until(9000), [(700, News::WindowOver)]);
    assert_eq!(script.state(), RadioState::Receive);
}

#[test]
fn a_window_goes_on_after_a_frame_and_ends_with_a_command() {
    let mut script = Script::resting(Rest::Off);
    script.open(None, 20_000).expect("it is free");
    script.until(1000);
    assert_eq!(script.send(None, None), Ok(at(1192)));
    assert_eq!(script.until(3000), [(1192, News::FrameBegins), (2024, News::Sent), (2216, News::Ready)]);
    assert_eq!(script.state(), RadioState::Receive);
    script.rest(Rest::Off);
    assert_eq!((script.state(), script.until(30_000)), (RadioState::Sleep, vec![]));
}

#[test]
fn instants_after_the_end_of_all_simulations_are_refused() {
    let mut script = Script::resting(Rest::Idle);
    let sending = Sending { at: Some(SimTime::MAX), airtime: us(832), awaited: None };
    let sent = script.radio.send(sending, script.now, &mut script.timers);
    assert_eq!(sent, Err(Refusal::TooLate(SimTime::MAX)));
    let opened = script.radio.open(None, SimTime::MAX, script.now, &mut script.timers);
    assert_eq!(opened, Err(Refusal::TooLate(SimTime::MAX)));
}

#[test]
fn a_radio_whose_window_ends_shortly_before_a_frame_stays_awake_for_it() {
    let mut script = Script::resting(Rest::Off);
    script.open(None, 2000).expect("it is free");
    script.until(1500);
    script.send(Some(2500), None).expect("it is free");
    assert_eq!(script.until(2000), [(2000, News::WindowOver)]);
    assert_eq!(script.state(), RadioState::Idle);
    assert_eq!(script.until(9000), [(2500, News::FrameBegins), (3332, News::Sent)]);
    assert_eq!(script.state(), RadioState::Sleep);
    // A frame that is far away lets it sleep.
    script.open(None, 12_000).expect("it is free");
    script.send(Some(20_000), None).expect("it is free");
    script.until(12_000);
    assert_eq!(script.state(), RadioState::Sleep);
    script.until(20_000 - 860);
    assert_eq!(script.state(), RadioState::Turnaround);
    assert_eq!(script.until(30_000), [(20_000, News::FrameBegins), (20_832, News::Sent)]);
}

#[test]
fn the_channel_is_assessed_only_with_the_receiver_on() {
    let mut script = Script::resting(Rest::Idle);
    let assess = |script: &mut Script| script.radio.assess(us(128), script.now, &mut script.timers);
    assert_eq!(assess(&mut script), Err(Refusal::NotReceiving));
    script.rest(Rest::Receive);
    script.until(100);
    assert_eq!(assess(&mut script), Err(Refusal::NotReceiving));
    script.until(192);
    assert_eq!(assess(&mut script), Ok(at(320)));
    assert_eq!(assess(&mut script), Err(Refusal::Assessing { until: at(320) }));
    assert_eq!(script.send(None, None), Err(Refusal::Assessing { until: at(320) }));
    assert_eq!(script.until(1000), [(320, News::Assessed(Whole::Unbroken))]);
    assert_eq!(script.send(Some(1300), None), Ok(at(1300)));
    assert_eq!(assess(&mut script), Err(Refusal::Sending { until: at(1300 + 832) }));
    script.until(5000);
    // One that is broken off has no news; in a window it must end in time.
    assert_eq!(assess(&mut script), Ok(at(5128)));
    script.rest(Rest::Idle);
    assert_eq!(script.until(6000), []);
    script.open(None, 6300).expect("it is free");
    script.until(6200);
    assert_eq!(assess(&mut script), Err(Refusal::NotReceiving));
}

#[test]
fn a_frame_is_acknowledged_192_us_after_its_end_unless_a_frame_is_due() {
    let mut script = Script::resting(Rest::Receive);
    assert!(script.radio.assess(us(128), script.now, &mut script.timers).is_ok());
    assert!(script.radio.acknowledge(script.now, &mut script.timers));
    assert_eq!(script.rest(Rest::Receive), at(192 + 352 + 192));
    assert_eq!(
        script.until(9000),
        [
            (128, News::Assessed(Whole::Broken)),
            (192, News::AcknowledgementBegins),
            (544, News::AcknowledgementSent),
            (736, News::Ready)
        ]
    );
    let at_latest = 9000 + 192 + 352 + 192;
    script.send(Some(at_latest), None).expect("it is free");
    assert!(script.radio.acknowledge(script.now, &mut script.timers));
    script.until(at_latest + 5000);
    let next = at_latest + 5000 + 735;
    script.send(Some(next), None).expect("it is free");
    assert!(!script.radio.acknowledge(script.now, &mut script.timers));
}

#[test]
fn a_receiver_that_changes_its_channel_is_deaf_for_a_turnaround() {
    let mut script = Script::resting(Rest::Receive);
    assert_eq!(script.radio.tune(script.now, &mut script.timers), Ok(at(192)));
    assert_eq!(script.state(), RadioState::Turnaround);
    assert_eq!(script.until(500), [(192, News::Ready)]);
    script.rest(Rest::Off);
    assert_eq!(script.radio.tune(script.now, &mut script.timers), Ok(at(500)));
    script.send(None, None).expect("it is free");
    let until = at(500 + 860 + 832);
    assert_eq!(script.radio.tune(script.now, &mut script.timers), Err(Refusal::Sending { until }));
}
