//! Energy of a radio: a current for each of its states.

use std::time::Duration;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sextant_channel::Dbm;
use sextant_kernel::{SettingError, SimTime};

/// State of a radio.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RadioState {
    /// Off, except for the part that wakes it up.
    Sleep,
    /// Oscillator on, neither receiving nor transmitting.
    Idle,
    /// Receiver on: listening, sensing the channel, receiving.
    Receive,
    /// Transmitting.
    Transmit,
    /// Changing between receiving and transmitting: deaf, with the current of the receiver.
    Turnaround,
}

/// The radio whose energy is counted, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum EnergyConfig {
    /// Texas Instruments CC2420 at 3 V.
    #[default]
    Cc2420,
    /// Microchip AT86RF233 at 3 V.
    At86rf233,
    /// A 60 GHz radio with phased arrays: assumed powers, of no data sheet.
    #[serde(rename = "mmwave_60_ghz")]
    Mmwave60Ghz,
    /// Any other radio.
    Custom(CustomRadioConfig),
}

/// Currents of a radio, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CustomRadioConfig {
    /// Supply voltage (V).
    pub supply_v: f64,
    /// Current while transmitting (mA), at any power.
    pub tx_ma: f64,
    /// Current while receiving or listening (mA).
    pub rx_ma: f64,
    /// Current while idle, oscillator on (mA).
    pub idle_ma: f64,
    /// Current while asleep (mA).
    pub sleep_ma: f64,
}

/// Current at a transmit power.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TxLevel {
    power: Dbm,
    current_a: f64,
}

/// Supply voltage and current of each state of a radio.
#[derive(Clone, Debug, PartialEq)]
pub struct RadioStates {
    supply_v: f64,
    /// Never empty; in order of rising power.
    tx: Vec<TxLevel>,
    rx_a: f64,
    idle_a: f64,
    sleep_a: f64,
}

impl RadioStates {
    /// Texas Instruments CC2420 (data sheet SWRS041) at 3 V.
    #[must_use]
    pub fn cc2420() -> Self {
        let tx = [
            (-25.0, 8.5),
            (-15.0, 9.9),
            (-10.0, 11.2),
            (-7.0, 12.5),
            (-5.0, 13.9),
            (-3.0, 15.2),
            (-1.0, 16.5),
            (0.0, 17.4),
        ];
        Self::from_milliamperes(3.0, &tx, 18.8, 0.426, 0.020)
    }

    /// Microchip AT86RF233 (data sheet 8351) at 3 V; idle is its state TRX_OFF.
    #[must_use]
    pub fn at86rf233() -> Self {
        let tx = [(-17.0, 7.2), (-5.0, 9.8), (0.0, 11.8), (4.0, 13.8)];
        Self::from_milliamperes(3.0, &tx, 11.8, 0.3, 0.0002)
    }

    /// A 60 GHz radio with phased arrays that transmits with 0.6 W, receives with 0.4 W, idles with 50 mW and sleeps
    /// with 1 mW. An assumption: neither a standard nor one data sheet is behind it.
    #[must_use]
    pub fn mmwave_60_ghz() -> Self {
        // At 1 V, currents are powers.
        Self::from_milliamperes(1.0, &[(0.0, 600.0)], 400.0, 50.0, 1.0)
    }

    fn from_milliamperes(supply_v: f64, tx: &[(f64, f64)], rx: f64, idle: f64, sleep: f64) -> Self {
        let level = |&(dbm, ma): &(f64, f64)| TxLevel { power: Dbm(dbm), current_a: ma * 1e-3 };
        Self {
            supply_v,
            tx: tx.iter().map(level).collect(),
            rx_a: rx * 1e-3,
            idle_a: idle * 1e-3,
            sleep_a: sleep * 1e-3,
        }
    }

    /// Power drawn in `state` (W). Transmitting at `tx_power` uses the lowest level of the radio that
    /// reaches it, or else its highest.
    #[must_use]
    pub fn power_w(&self, state: RadioState, tx_power: Dbm) -> f64 {
        self.supply_v
            * match state {
                RadioState::Sleep => self.sleep_a,
                RadioState::Idle => self.idle_a,
                RadioState::Receive | RadioState::Turnaround => self.rx_a,
                RadioState::Transmit => self.tx_a(tx_power),
            }
    }

    fn tx_a(&self, power: Dbm) -> f64 {
        let level = self.tx.iter().find(|level| level.power >= power).or(self.tx.last());
        level.expect("a radio has a transmit level").current_a
    }
}

impl TryFrom<EnergyConfig> for RadioStates {
    type Error = SettingError;

    fn try_from(config: EnergyConfig) -> Result<Self, SettingError> {
        Ok(match config {
            EnergyConfig::Cc2420 => Self::cc2420(),
            EnergyConfig::At86rf233 => Self::at86rf233(),
            EnergyConfig::Mmwave60Ghz => Self::mmwave_60_ghz(),
            EnergyConfig::Custom(custom) => Self::try_from(custom).map_err(|error| error.within("custom"))?,
        })
    }
}

impl TryFrom<CustomRadioConfig> for RadioStates {
    type Error = SettingError;

    fn try_from(config: CustomRadioConfig) -> Result<Self, SettingError> {
        Ok(Self::from_milliamperes(
            SettingError::positive("supply_v", config.supply_v)?,
            &[(0.0, SettingError::not_negative("tx_ma", config.tx_ma)?)],
            SettingError::not_negative("rx_ma", config.rx_ma)?,
            SettingError::not_negative("idle_ma", config.idle_ma)?,
            SettingError::not_negative("sleep_ma", config.sleep_ma)?,
        ))
    }
}

/// Energy that a radio used, by activity (J).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EnergySpent {
    /// Transmitting (J).
    pub tx_j: f64,
    /// Receiving, listening, sensing, turning around (J).
    pub rx_j: f64,
    /// Idle (J).
    pub idle_j: f64,
    /// Asleep (J).
    pub sleep_j: f64,
}

impl EnergySpent {
    /// Total energy (J).
    #[must_use]
    pub fn total_j(&self) -> f64 {
        self.tx_j + self.rx_j + self.idle_j + self.sleep_j
    }
}

impl std::ops::AddAssign for EnergySpent {
    fn add_assign(&mut self, other: Self) {
        self.tx_j += other.tx_j;
        self.rx_j += other.rx_j;
        self.idle_j += other.idle_j;
        self.sleep_j += other.sleep_j;
    }
}

/// How long one radio was in each of its states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EnergyMeter {
    state: RadioState,
    since: SimTime,
    spans: [Duration; 5],
    /// How long the radio has been idle without a break, or was before its present state.
    rested: Duration,
    /// Time that the way from receiving to idle takes.
    fall: Duration,
    /// What is left of that time.
    falling: Duration,
}

impl EnergyMeter {
    /// A meter for a radio that is in `state` at `now`.
    #[must_use]
    pub const fn new(state: RadioState, now: SimTime) -> Self {
        let none = Duration::ZERO;
        Self { state, since: now, spans: [none; 5], rested: none, fall: none, falling: none }
    }

    /// The same for a radio that takes so long from receiving to idle: that time counts as a turnaround.
    #[must_use]
    pub const fn with_fall(self, fall: Duration) -> Self {
        Self { fall, ..self }
    }

    /// The state that the radio is in.
    #[must_use]
    #[inline]
    pub const fn state(&self) -> RadioState {
        self.state
    }

    /// The radio changes to `state` at `now`, or stays in it.
    ///
    /// # Panics
    /// If `now` is before the last change.
    #[inline]
    pub fn enter(&mut self, state: RadioState, now: SimTime) {
        let span = now - self.since;
        if self.state == RadioState::Idle {
            let falling = span.min(self.falling);
            self.falling -= falling;
            self.spans[RadioState::Turnaround as usize] += falling;
            self.spans[RadioState::Idle as usize] += span - falling;
            self.rested += span - falling;
        } else {
            self.spans[self.state as usize] += span;
        }
        if state != self.state {
            if state == RadioState::Idle {
                self.rested = Duration::ZERO;
                self.falling = if self.state == RadioState::Receive { self.fall } else { Duration::ZERO };
            } else if self.state != RadioState::Idle {
                self.rested = Duration::ZERO;
            }
        }
        self.state = state;
        self.since = now;
    }

    /// The receiver has just come on after idling: the turnaround of the radio, of this length, took place in the last
    /// part of the time in which it seemed idle. Nothing changes if the radio was not idle before.
    #[inline]
    pub fn wake(&mut self, turnaround: Duration) {
        let turned = turnaround.min(std::mem::take(&mut self.rested));
        self.spans[RadioState::Idle as usize] -= turned;
        self.spans[RadioState::Turnaround as usize] += turned;
    }

    /// Forgets all time so far: the meter starts again at `now`.
    pub fn restart(&mut self, now: SimTime) {
        self.enter(self.state, now);
        self.spans = [Duration::ZERO; 5];
        // Of a turnaround that comes later only what lies after `now` counts.
        self.rested = Duration::ZERO;
    }

    /// Time in `state` until the last call of [`EnergyMeter::enter`].
    #[must_use]
    pub const fn span(&self, state: RadioState) -> Duration {
        self.spans[state as usize]
    }

    /// Energy until the last call of [`EnergyMeter::enter`], with a radio that transmits at `tx_power`.
    #[must_use]
    pub fn spent(&self, radio: &RadioStates, tx_power: Dbm) -> EnergySpent {
        let joules = |state| radio.power_w(state, tx_power) * self.span(state).as_secs_f64();
        EnergySpent {
            tx_j: joules(RadioState::Transmit),
            rx_j: joules(RadioState::Receive) + joules(RadioState::Turnaround),
            idle_j: joules(RadioState::Idle),
            sleep_j: joules(RadioState::Sleep),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Phy;

    const PHY: Phy = Phy::Oqpsk2450;

    /// Energy of `span` in `state` (uJ).
    fn microjoules(radio: &RadioStates, state: RadioState, tx_dbm: f64, span: Duration) -> f64 {
        1e6 * radio.power_w(state, Dbm(tx_dbm)) * span.as_secs_f64()
    }

    fn assert_close(found: f64, expected: f64, tolerance: f64) {
        assert!((found - expected).abs() < tolerance, "{found}, not {expected}");
    }

    #[test]
    fn frames_use_the_energy_of_the_data_sheets() {
        use RadioState::{Receive, Transmit, Turnaround};
        let (short, long) = (PHY.airtime(20), PHY.airtime(127));
        let ti = RadioStates::cc2420();
        assert_close(microjoules(&ti, Transmit, 0.0, short), 43.4, 0.05);
        assert_close(microjoules(&ti, Receive, 0.0, short), 46.9, 0.05);
        assert_close(microjoules(&ti, Transmit, 0.0, long), 222.2, 0.05);
        assert_close(microjoules(&ti, Receive, 0.0, long), 240.0, 0.05);
        assert_close(microjoules(&ti, Receive, 0.0, PHY.cca()), 7.22, 0.005);
        assert_close(microjoules(&ti, Turnaround, 0.0, PHY.turnaround()), 10.83, 0.005);
        assert_close(1e-3 * microjoules(&ti, Receive, 0.0, Duration::from_secs(1)), 56.4, 0.05);
        let microchip = RadioStates::at86rf233();
        assert_close(microjoules(&microchip, Transmit, 4.0, short), 34.4, 0.05);
        assert_close(microjoules(&microchip, Receive, 4.0, short), 29.5, 0.05);
        assert_close(microjoules(&microchip, Transmit, 4.0, long), 176.2, 0.05);
        assert_close(microjoules(&microchip, Receive, 4.0, long), 150.7, 0.05);
        assert_close(microjoules(&microchip, Receive, 4.0, PHY.cca()), 4.53, 0.005);
        assert_close(microjoules(&microchip, Turnaround, 4.0, PHY.turnaround()), 6.80, 0.005);
    }

    #[test]
    fn sector_sweeps_use_the_assumed_energy_of_a_60_ghz_radio() {
        use crate::dmg::SectorLayout;
        use crate::dmg::timing::{SBIFS, SSW_AIRTIME};
        let radio = RadioStates::try_from(EnergyConfig::Mmwave60Ghz).expect("a known radio");
        assert_close(microjoules(&radio, RadioState::Transmit, 20.0, SSW_AIRTIME), 8.9, 0.05);
        assert_close(microjoules(&radio, RadioState::Receive, 20.0, SSW_AIRTIME), 6.0, 0.05);
        // Eight frames with gaps; one sweep of 64 sectors heard to its end.
        let sweep = microjoules(&radio, RadioState::Transmit, 20.0, SSW_AIRTIME * 8)
            + microjoules(&radio, RadioState::Idle, 20.0, SBIFS * 7);
        assert_close(sweep, 71.9, 0.05);
        let heard = SectorLayout::new(&[64]).expect("a good layout").sweep_duration();
        assert_close(microjoules(&radio, RadioState::Receive, 20.0, heard), 407.0, 0.5);
    }

    #[test]
    fn a_power_uses_the_lowest_level_that_reaches_it() {
        let radio = RadioStates::cc2420();
        let current_ma = |dbm| 1e3 * radio.power_w(RadioState::Transmit, Dbm(dbm)) / 3.0;
        assert_close(current_ma(-50.0), 8.5, 1e-9);
        assert_close(current_ma(-10.0), 11.2, 1e-9);
        assert_close(current_ma(-9.0), 12.5, 1e-9);
        assert_close(current_ma(20.0), 17.4, 1e-9);
    }

    #[test]
    fn a_meter_counts_each_state_once() {
        let at = |us| SimTime::ZERO + Duration::from_micros(us);
        let mut meter = EnergyMeter::new(RadioState::Sleep, at(0));
        for (us, state) in [
            (100, RadioState::Idle),
            (130, RadioState::Receive),
            (130, RadioState::Turnaround),
            (150, RadioState::Transmit),
            (190, RadioState::Sleep),
            (200, RadioState::Sleep),
        ] {
            meter.enter(state, at(us));
        }
        let spans = [
            (RadioState::Sleep, 110),
            (RadioState::Idle, 30),
            (RadioState::Receive, 0),
            (RadioState::Turnaround, 20),
            (RadioState::Transmit, 40),
        ];
        for (state, us) in spans {
            assert_eq!(meter.span(state), Duration::from_micros(us), "{state:?}");
        }
        let config = CustomRadioConfig { supply_v: 2.0, tx_ma: 4.0, rx_ma: 3.0, idle_ma: 2.0, sleep_ma: 1.0 };
        let radio = RadioStates::try_from(EnergyConfig::Custom(config)).expect("good currents");
        let spent = meter.spent(&radio, Dbm(0.0));
        assert_close(spent.tx_j, 320e-9, 1e-15);
        assert_close(spent.rx_j, 120e-9, 1e-15);
        assert_close(spent.idle_j, 120e-9, 1e-15);
        assert_close(spent.total_j(), 780e-9, 1e-15);
    }

    #[test]
    fn a_receiver_that_comes_on_has_turned_around_in_the_last_part_of_its_idle_time() {
        let at = |us| SimTime::ZERO + Duration::from_micros(us);
        let turnaround = PHY.turnaround();
        let mut meter = EnergyMeter::new(RadioState::Idle, at(0));
        // Idle for 500 us, CCA, busy, idle for 100 us, CCA, busy, CCA at once.
        meter.enter(RadioState::Receive, at(500));
        meter.wake(turnaround);
        meter.enter(RadioState::Idle, at(628));
        meter.enter(RadioState::Receive, at(728));
        meter.wake(turnaround);
        meter.enter(RadioState::Idle, at(856));
        meter.enter(RadioState::Receive, at(856));
        meter.wake(turnaround);
        meter.enter(RadioState::Turnaround, at(984));
        meter.enter(RadioState::Receive, at(1176));
        meter.wake(turnaround);
        meter.enter(RadioState::Sleep, at(1200));
        let span = |state| meter.span(state);
        assert_eq!(span(RadioState::Idle), Duration::from_micros(500 - 192));
        assert_eq!(span(RadioState::Turnaround), Duration::from_micros(192 + 100 + 192));
        assert_eq!(span(RadioState::Receive), Duration::from_micros(128 + 128 + 128 + 24));
    }

    #[test]
    fn the_way_back_to_idle_counts_as_a_turnaround_if_it_takes_time() {
        let at = |us| SimTime::ZERO + Duration::from_micros(us);
        let mut meter = EnergyMeter::new(RadioState::Receive, at(0)).with_fall(PHY.turnaround());
        meter.enter(RadioState::Idle, at(100));
        meter.enter(RadioState::Idle, at(200));
        meter.enter(RadioState::Receive, at(500));
        meter.wake(PHY.turnaround());
        meter.enter(RadioState::Idle, at(600));
        meter.enter(RadioState::Turnaround, at(650));
        meter.enter(RadioState::Transmit, at(660));
        meter.enter(RadioState::Idle, at(700));
        meter.enter(RadioState::Idle, at(750));
        let span = |state| meter.span(state);
        // 400 us idle after receiving: the way back, what is left, and the way to receiving, which takes 192 us of it.
        assert_eq!(span(RadioState::Idle), Duration::from_micros(400 - 192 - 192 + 50));
        assert_eq!(span(RadioState::Turnaround), Duration::from_micros(192 + 192 + 50 + 10));
        meter.restart(at(800));
        meter.enter(RadioState::Receive, at(830));
        assert_eq!(meter.span(RadioState::Idle), Duration::from_micros(30));
        assert_eq!(meter.span(RadioState::Transmit), Duration::ZERO);
    }

    #[test]
    fn a_custom_radio_needs_a_voltage_and_no_negative_current() {
        let good = CustomRadioConfig { supply_v: 3.0, tx_ma: 1.0, rx_ma: 1.0, idle_ma: 0.0, sleep_ma: 0.0 };
        let key = |custom| RadioStates::try_from(EnergyConfig::Custom(custom)).err().map(|error| error.key);
        assert_eq!(key(good), None);
        assert_eq!(key(CustomRadioConfig { supply_v: 0.0, ..good }).as_deref(), Some("custom.supply_v"));
        assert_eq!(key(CustomRadioConfig { rx_ma: f64::NAN, ..good }).as_deref(), Some("custom.rx_ma"));
    }
}
