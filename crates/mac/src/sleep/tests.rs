//! Scripts of explicit instants.

use std::time::Duration;

use sextant_kernel::SimTime;

use super::*;
use crate::{Phy, RadioState};

const AIRTIME: Duration = Duration::from_micros(1792);

/// A radio that notes what it is told.
#[derive(Default)]
struct Script {
    now_us: u64,
    due: Option<(u64, Event)>,
    sent: Vec<(u64, Sent)>,
    states: Vec<(u64, RadioState)>,
    is_busy: bool,
    followed: Option<Duration>,
}

impl Radio for Script {
    fn after(&mut self, span: Duration, event: Event) {
        self.due = Some((self.now_us + u64::try_from(span.as_micros()).unwrap(), event));
    }

    fn stop(&mut self) {
        self.due = None;
    }

    fn enter(&mut self, state: RadioState) {
        self.states.push((self.now_us, state));
    }

    fn is_busy(&mut self) -> bool {
        self.is_busy
    }

    fn followed_for(&mut self) -> Option<Duration> {
        self.followed.take()
    }

    fn begin(&mut self, sent: Sent) -> Duration {
        self.sent.push((self.now_us, sent));
        Duration::from_micros(match sent {
            Sent::Strobe | Sent::WakeUp { .. } => 576,
            Sent::Acknowledgement => 352,
            Sent::Data => 1792,
        })
    }
}

impl Script {
    /// What is due happens.
    fn step(&mut self, station: &mut Sleeper) -> Option<Ended> {
        let (at, event) = self.due.take().expect("something is due");
        self.now_us = at;
        station.handle(event, SimTime::ZERO + Duration::from_micros(at), self)
    }

    /// The same until an attempt ends, or nothing is due.
    fn run(&mut self, station: &mut Sleeper) -> Option<Ended> {
        while self.due.is_some() {
            if let Some(ended) = self.step(station) {
                return Some(ended);
            }
        }
        None
    }

    fn until(&mut self, station: &mut Sleeper, us: u64) {
        while self.due.is_some_and(|(at, _)| at <= us) {
            assert_eq!(self.step(station), None);
        }
        self.now_us = us;
    }
}

fn settings(wake_up: &str) -> SleepSettings {
    let wake_up = match wake_up {
        "x_mac" => WakeUpConfig::XMac(XMacConfig {}),
        "csl" => WakeUpConfig::Csl(CslConfig { phases: PhasesConfig::Unknown }),
        _ => WakeUpConfig::RepeatedData(RepeatedDataConfig { gap_us: None, phases: PhasesConfig::Unknown }),
    };
    SleepSettings::new(&config(wake_up), Phy::Oqpsk2450).expect("good settings")
}

fn config(wake_up: WakeUpConfig) -> SleepConfig {
    SleepConfig {
        wake_up,
        interval_s: 0.125,
        sinks: SinksConfig::Sleep,
        max_retries: 3,
        max_backoffs: 4,
        queue_frames: 16,
        allowed_ppm: 0.0,
    }
}

fn to_one(settings: &SleepSettings) -> Job {
    Job { to: Recipient::One, airtime: AIRTIME, span: settings.whole(AIRTIME) }
}

#[test]
fn spans_follow_from_the_physical_layer() {
    let us = |span: Duration| span.as_micros();
    let x_mac = settings("x_mac");
    assert_eq!((us(x_mac.period(AIRTIME)), us(x_mac.gap()), us(x_mac.check_length())), (1312, 736, 1504));
    let repeated = settings("repeated_data");
    // Two turnarounds and a symbol; two looks, a gap and two looks apart from start to start.
    assert_eq!((us(repeated.period(AIRTIME)), us(repeated.gap()), us(repeated.distance())), (2192, 400, 656));
    let spans = repeated.check_spans();
    assert_eq!(us(spans.turning + spans.receiving), 640);
    // 784 us: 19 octets take 800, 18 take 768.
    assert_eq!(repeated.least_mpdu_octets(), 19);
    assert_eq!((us(settings("csl").period(AIRTIME)), settings("csl").least_mpdu_octets()), (576, 0));
}

#[test]
fn a_part_of_a_check_takes_as_much_as_its_looks_so_far() {
    let us = |spans: CheckSpans| (spans.turning.as_micros(), spans.receiving.as_micros());
    let within = |settings: &SleepSettings, us: u64| settings.check_spans_within(Duration::from_micros(us));
    let repeated = settings("repeated_data");
    for (elapsed, expected) in
        [(0, (0, 0)), (100, (100, 0)), (250, (192, 58)), (400, (192, 128)), (700, (236, 128)), (976, (384, 256))]
    {
        assert_eq!(us(within(&repeated, elapsed)), expected, "{elapsed}");
    }
    assert_eq!(us(within(&settings("x_mac"), 1000)), (192, 808));
}

#[test]
fn a_check_of_a_silent_channel_takes_two_looks() {
    let mut station = Sleeper::new(settings("repeated_data"), Rest::Asleep);
    let mut script = Script::default();
    station.check(Duration::ZERO, &mut script);
    assert_eq!(script.run(&mut station), None);
    use RadioState::{Receive, Sleep, Turnaround};
    let expected = [(0, Turnaround), (192, Receive), (320, Sleep), (656, Turnaround), (848, Receive), (976, Sleep)];
    assert_eq!(script.states, expected);
    assert!(station.is_asleep());
}

#[test]
fn a_check_that_goes_on_ends_when_it_would_have_ended() {
    for wake_up in ["x_mac", "repeated_data", "csl"] {
        let settings = settings(wake_up);
        let end = u64::try_from(settings.check_length().as_micros()).unwrap();
        for elapsed in (0..end).step_by(7) {
            let mut station = Sleeper::new(settings, Rest::Asleep);
            let mut script = Script { now_us: elapsed, ..Script::default() };
            station.check(Duration::from_micros(elapsed), &mut script);
            assert_eq!(script.run(&mut station), None);
            assert_eq!((script.now_us, station.is_asleep()), (end, true), "{wake_up} after {elapsed} us");
        }
    }
}

#[test]
fn strobes_stop_at_an_early_acknowledgement_and_the_frame_follows() {
    let settings = settings("x_mac");
    let mut station = Sleeper::new(settings, Rest::Asleep);
    let mut script = Script::default();
    station.send(to_one(&settings), &mut script);
    // Two looks in 192 + 656 + 128 us, and a turnaround.
    // An acknowledgement ends before the wait for it, in the order of events of an instant.
    script.until(&mut station, 1168 + 1312 + 576 + 192 + 351);
    script.now_us += 1;
    assert_eq!(script.sent, [(1168, Sent::Strobe), (2480, Sent::Strobe)]);
    assert_eq!(station.hear_acknowledgement(&mut script), None);
    script.until(&mut station, 3600 + 192 + 1792 + 192 + 352);
    assert_eq!(script.sent.last(), Some(&(3792, Sent::Data)));
    assert_eq!(station.hear_acknowledgement(&mut script), Some(Ended::Acknowledged));
    assert!(station.is_asleep() && script.due.is_none());
}

#[test]
fn a_sender_that_nobody_answers_gives_up_after_an_interval_and_some_periods() {
    for (wake_up, last) in [("x_mac", Sent::Strobe), ("repeated_data", Sent::Data)] {
        let settings = settings(wake_up);
        let mut station = Sleeper::new(settings, Rest::Asleep);
        let mut script = Script::default();
        station.send(to_one(&settings), &mut script);
        assert_eq!(script.run(&mut station), Some(Ended::Unacknowledged));
        let (at, sent) = *script.sent.last().expect("it sends");
        let span = Duration::from_micros(at - 1168);
        assert!(sent == last && span >= settings.interval && span <= settings.whole(AIRTIME), "{span:?}");
        let periods = span.as_micros() / settings.period(AIRTIME).as_micros();
        assert_eq!(script.sent.len() as u128, periods + 1);
    }
}

#[test]
fn wake_up_frames_count_down_to_the_frame() {
    let settings = settings("csl");
    let mut station = Sleeper::new(settings, Rest::Asleep);
    let mut script = Script::default();
    station.send(to_one(&settings), &mut script);
    script.until(&mut station, 512 + 219 * 576);
    // ceil(125 ms / 576 us) + 1.
    assert_eq!(script.sent.len(), 220);
    for (i, &(at, sent)) in script.sent[..219].iter().enumerate() {
        let i = i as u64;
        let left = Duration::from_micros((218 - i) * 576);
        assert_eq!((at, sent), (512 + i * 576, Sent::WakeUp { rendezvous: left }));
    }
    assert_eq!(script.sent[219], (512 + 219 * 576, Sent::Data));
}

#[test]
fn a_busy_channel_is_left_alone() {
    for wake_up in ["x_mac", "repeated_data", "csl"] {
        let settings = settings(wake_up);
        let mut station = Sleeper::new(settings, Rest::Asleep);
        let mut script = Script { is_busy: true, ..Script::default() };
        station.send(to_one(&settings), &mut script);
        assert_eq!(script.run(&mut station), Some(Ended::Busy));
        assert!(script.sent.is_empty() && station.is_asleep());
    }
}

#[test]
fn who_overhears_a_strobe_for_another_sleeps_and_who_is_meant_answers() {
    let settings = settings("x_mac");
    for (meant_for, is_answered) in [(MeantFor::Another, false), (MeantFor::This, true)] {
        let mut station = Sleeper::new(settings, Rest::Asleep);
        let mut script = Script::default();
        station.check(Duration::ZERO, &mut script);
        script.until(&mut station, 1000);
        station.hear_strobe(meant_for, &mut script);
        assert_eq!(station.is_asleep(), !is_answered);
        if is_answered {
            script.until(&mut station, 1000 + 192 + 352 + 192);
            assert_eq!(script.sent, [(1192, Sent::Acknowledgement)]);
            assert!(station.hear_data(MeantFor::This, &mut script));
            assert_eq!(script.run(&mut station), None);
            assert!(station.is_asleep());
        }
    }
}

#[test]
fn a_frame_that_was_announced_and_does_not_come_is_not_waited_for_long() {
    let mut station = Sleeper::new(settings("csl"), Rest::Asleep);
    let mut script = Script::default();
    station.check(Duration::ZERO, &mut script);
    script.until(&mut station, 700);
    station.hear_wake_up(MeantFor::This, Duration::from_micros(50_000), &mut script);
    assert_eq!(script.states.last(), Some(&(700, RadioState::Sleep)));
    assert_eq!(script.run(&mut station), None);
    let on = script.states.iter().find(|(at, state)| *at > 700 && *state == RadioState::Receive);
    assert_eq!(on.map(|(at, _)| *at), Some(50_700));
    assert_eq!((script.now_us, station.is_asleep()), (51_020, true));
}

#[test]
fn a_station_that_follows_a_frame_stays_on_until_its_end() {
    let mut station = Sleeper::new(settings("repeated_data"), Rest::Asleep);
    let mut script = Script { is_busy: true, ..Script::default() };
    station.check(Duration::ZERO, &mut script);
    script.until(&mut station, 320);
    // Longest frame, gap and a symbol.
    assert_eq!(script.due, Some((320 + 4256 + 400 + 16, Event::WaitOver)));
    script.followed = Some(Duration::from_micros(900));
    script.until(&mut station, 4992);
    assert_eq!(script.due, Some((5892, Event::WaitOver)));
    assert_eq!(script.run(&mut station), None);
    assert_eq!((script.now_us, station.is_asleep()), (5892, true));
}

#[test]
fn invalid_settings_are_rejected_with_their_keys() {
    let x_mac = WakeUpConfig::XMac(XMacConfig {});
    let good = config(x_mac);
    let key = |config: SleepConfig| SleepSettings::new(&config, Phy::Oqpsk2450).err().map(|error| error.key);
    assert_eq!(key(good.clone()), None);
    for bad in [0.0, 0.012, 10.1, f64::NAN] {
        assert_eq!(key(SleepConfig { interval_s: bad, ..good.clone() }).as_deref(), Some("interval_s"));
    }
    assert_eq!(key(SleepConfig { max_retries: 16, ..good.clone() }).as_deref(), Some("max_retries"));
    assert_eq!(key(SleepConfig { max_backoffs: 16, ..good.clone() }).as_deref(), Some("max_backoffs"));
    assert_eq!(key(SleepConfig { queue_frames: 0, ..good.clone() }).as_deref(), Some("queue_frames"));
    assert_eq!(key(SleepConfig { allowed_ppm: -1.0, ..good }).as_deref(), Some("allowed_ppm"));
    let short = RepeatedDataConfig { gap_us: Some(399.0), phases: PhasesConfig::Unknown };
    let key = key(config(WakeUpConfig::RepeatedData(short)));
    assert_eq!(key.as_deref(), Some("wake_up.repeated_data.gap_us"));
}
