//! A program that owns its radio: X-MAC, whose nodes sleep and are woken by strobes, beside its closed forms.
//!
//! `cargo run --release -p sextant --example x_mac`

use std::io::Write;
use std::time::Duration;

use sextant::kernel::{SimTime, StationId};
use sextant::sim::{Application, Destination, FrameId, NetworkId, Port, RadioEvent, RadioFrame, SendOutcome, Timer};
use sextant::{Programs, Scenario, Unwatched};

const SCENARIO: &str = "name = \"x-mac\"\nseed = 1\nduration_s = 2000.0\n\
    world.nodes.explicit = { positions_m = [[0, 0]], names = [\"node\"] }\n\
    radio = { tx_power_dbm = 0, sensitivity_dbm = -90 }\n\
    channel.path_loss.log_distance.exponent = 2.0\n\
    mac.program = {}\n\
    sinks = [{ name = \"sink\", position_m = [5, 0, 0] }]\n";
const NETWORK: NetworkId = NetworkId(0);
/// A strobe of 12 octets: header, and one octet that says what it is.
const STROBE: &[u8] = b"s";
/// A packet: 50 octets with the header.
const DATA: &[u8] = &[7; 39];
/// Airtimes (s) of a strobe, of data, of an acknowledgement; the radio turns around.
const STROBE_S: f64 = 576e-6;
const DATA_S: f64 = 1792e-6;
const ACK_S: f64 = 352e-6;
const TURNAROUND_S: f64 = 192e-6;
/// The least time between two packets.
const PAUSE: Duration = Duration::from_secs(1);
/// From one strobe to the next: between them there is time for an acknowledgement.
const PERIOD: Duration = Duration::from_micros(576 + 192 + 352 + 192);

/// Timer of a new packet.
const ARRIVAL: Timer = Timer(0);
/// Timer of data that do not come.
const NO_DATA: Timer = Timer(1);

/// What a node does.
enum State {
    /// It sleeps, and wakes up for a window at each interval.
    Sampling,
    /// It has acknowledged a strobe, and waits for data.
    AwaitingData,
    /// It sends strobes, and then data.
    Strobing { packet: FrameId, since: SimTime },
    /// It sends data.
    SendingData { packet: FrameId },
}

/// Wakes up at each interval for as long as strobes repeat. Who has a packet sends strobes until the receiver acknowledges one,
/// and then the packet (Buettner, Yee, Anderson and Han, SenSys 2006).
struct XMac {
    interval: Duration,
    /// To whom it sends, if it does.
    to: Option<StationId>,
    next_window: SimTime,
    state: State,
    draws: u64,
    strobes: u64,
}

impl XMac {
    fn await_arrival(&mut self, port: &mut Port<'_>) {
        if self.to.is_some() {
            // After a pause, at any instant between two windows.
            self.draws += 1;
            port.after(PAUSE + self.interval.mul_f64(port.uniform(self.draws)), ARRIVAL);
        }
    }

    /// Turns the radio off until the next window.
    fn sleep(&mut self, port: &mut Port<'_>) {
        self.state = State::Sampling;
        let Ok(mut radio) = port.radio(NETWORK) else { return };
        radio.off();
        while self.next_window < radio.earliest() {
            self.next_window += self.interval;
        }
        let from = self.next_window;
        // The radio is off, so it can be on by then.
        let _ = radio.listen(Some(from), from + PERIOD);
    }

    fn transmit(&mut self, payload: &[u8], packet: Option<FrameId>, port: &mut Port<'_>) {
        let (Some(to), Ok(mut radio)) = (self.to, port.radio(NETWORK)) else { return };
        let frame = RadioFrame { to: Destination::Station(to), payload, acknowledged: true, packet };
        // The radio has nothing else to send: this follows the end of the last frame.
        let _ = radio.transmit(frame);
    }

    fn strobe(&mut self, port: &mut Port<'_>) {
        self.strobes += 1;
        self.transmit(STROBE, None, port);
    }

    fn done(&mut self, packet: FrameId, outcome: SendOutcome, port: &mut Port<'_>) {
        let _ = port.radio(NETWORK).and_then(|mut radio| radio.done(packet, outcome));
        self.await_arrival(port);
        self.sleep(port);
    }
}

impl Application for XMac {
    fn started(&mut self, port: &mut Port<'_>) {
        if let Ok(mut radio) = port.radio(NETWORK) {
            // No longer than an acknowledgement takes.
            let _ = radio.set_ack_wait(Duration::from_micros(192 + 352));
        }
        self.await_arrival(port);
        self.sleep(port);
    }

    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        match (timer, &self.state, self.to) {
            (ARRIVAL, State::Sampling, Some(to)) => {
                let since = port.now();
                let Ok(mut radio) = port.radio(NETWORK) else { return };
                radio.off();
                let Ok(packet) = radio.offer(Destination::Station(to), DATA.len()) else { return };
                self.state = State::Strobing { packet, since };
                self.strobe(port);
            }
            // It is about to receive.
            (ARRIVAL, ..) => self.await_arrival(port),
            (NO_DATA, State::AwaitingData, _) => self.sleep(port),
            _ => {}
        }
    }

    fn radio(&mut self, _network: NetworkId, event: &RadioEvent<'_>, port: &mut Port<'_>) {
        match (event, &self.state) {
            (RadioEvent::WindowOver | RadioEvent::Ignored { .. } | RadioEvent::Garbled { .. }, State::Sampling) => {
                self.sleep(port);
            }
            (RadioEvent::Received(frame), State::Sampling) if frame.delivery.payload == STROBE => {
                self.state = State::AwaitingData;
                let _ = port.radio(NETWORK).map(|mut radio| radio.receive());
                port.after(Duration::from_millis(10), NO_DATA);
            }
            (RadioEvent::Received(frame), State::AwaitingData) if frame.delivery.payload != STROBE => {
                self.sleep(port);
            }
            (RadioEvent::Acknowledged { .. }, &State::Strobing { packet, .. }) => {
                self.state = State::SendingData { packet };
                self.transmit(DATA, Some(packet), port);
            }
            (RadioEvent::Unacknowledged, &State::Strobing { packet, since }) => {
                match port.now() - since < self.interval + 2 * PERIOD {
                    true => self.strobe(port),
                    false => self.done(packet, SendOutcome::NoAcknowledgement, port),
                }
            }
            (RadioEvent::Acknowledged { .. }, &State::SendingData { packet }) => {
                self.done(packet, SendOutcome::Acknowledged, port);
            }
            (RadioEvent::Unacknowledged, &State::SendingData { packet }) => {
                self.done(packet, SendOutcome::NoAcknowledgement, port);
            }
            _ => {}
        }
    }
}

/// What a simulation brings, or the closed forms say.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measured {
    /// Share of the packets that were delivered.
    pub(crate) delivery: f64,
    /// Strobes a packet.
    pub(crate) strobes: f64,
    /// Mean time from arrival to reception (s).
    pub(crate) delay_s: f64,
    /// Share of the time in which the radio of a node that hears nothing is on.
    pub(crate) idle_duty: f64,
}

/// The closed forms of a receiver that wakes up at each interval T (s): strobes T/(2P) + 3/2, with strobes at each P; the delay
/// is T/2 + P/2 and what follows the strobe that is heard.
pub(crate) fn closed_form(interval_s: f64) -> Measured {
    let period_s = PERIOD.as_secs_f64();
    let after_s = STROBE_S + TURNAROUND_S + ACK_S + TURNAROUND_S + DATA_S;
    Measured {
        delivery: 1.0,
        strobes: interval_s / (2.0 * period_s) + 1.5,
        delay_s: TURNAROUND_S + interval_s / 2.0 + period_s / 2.0 + after_s,
        idle_duty: (TURNAROUND_S + period_s) / interval_s,
    }
}

/// The same in a simulation: of a node that sends to the sink, and of a sink to which nobody sends.
pub(crate) fn simulated(interval_s: f64, seed: u64) -> Result<Measured, Box<dyn std::error::Error>> {
    let interval = Duration::from_secs_f64(interval_s);
    let mac = |to| XMac { interval, to, next_window: SimTime::ZERO, state: State::Sampling, draws: 0, strobes: 0 };
    let simulate = |node: &mut XMac| {
        let scenario = Scenario::parse(SCENARIO)?.with("seed", seed)?;
        let programs = Programs::default().with_node("node", Box::new(node)).with_sink("sink", Box::new(mac(None)));
        sextant::run_with(&scenario, programs, &mut (), &Unwatched).map_err(Box::<dyn std::error::Error>::from)
    };
    let mut node = mac(Some(StationId(1)));
    let (run, idle) = (simulate(&mut node)?, simulate(&mut mac(None))?);
    let (survey, idle) = run.survey().zip(idle.survey()).ok_or("the nodes are simulated")?;
    let sent = survey.packets.sent as f64;
    // Off, a CC2420 draws 20 uA at 3 V.
    let asleep_s = idle.networks[0].energy[1].sleep_j / 60e-6;
    Ok(Measured {
        delivery: survey.packets.received as f64 / sent,
        strobes: node.strobes as f64 / sent,
        delay_s: survey.networks[0].delays[0].mean_s().ok_or("packets are received")?,
        idle_duty: 1.0 - asleep_s / idle.end.as_secs_f64(),
    })
}

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut out = std::io::stdout();
    writeln!(
        out,
        "interval (s)  delivery  strobes  closed form  delay (ms)  closed form  idle duty (%)  closed form"
    )?;
    for interval_s in [0.125, 0.5, 1.0] {
        let (found, closed) = (simulated(interval_s, 1)?, closed_form(interval_s));
        let [delay, closed_delay] = [found, closed].map(|measured| 1e3 * measured.delay_s);
        let [duty, closed_duty] = [found, closed].map(|measured| 1e2 * measured.idle_duty);
        let Measured { delivery, strobes, .. } = found;
        write!(out, "{interval_s:12.3} {delivery:9.4} {strobes:8.1} {:12.1}", closed.strobes)?;
        writeln!(out, " {delay:11.1} {closed_delay:12.1} {duty:14.3} {closed_duty:12.3}")?;
    }
    Ok(())
}
