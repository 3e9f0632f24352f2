//! Sleeping MACs, settings checked, with the spans that follow from them.

use std::time::Duration;

use sextant_kernel::SettingError;

use super::config::{PhasesConfig, SinksConfig, SleepConfig, WakeUpConfig};
use crate::Phy;

/// Longest interval (s): about that of CSL (65535 units of 160 us).
const LONGEST_INTERVAL_S: f64 = 10.0;

/// Least interval, in frames of the longest kind.
const LEAST_FRAMES_AN_INTERVAL: u32 = 3;

const MOST_RETRIES: u8 = 15;
const MOST_BACKOFFS: u8 = 15;
const MOST_FRAMES: u16 = 10_000;
const WORST_PPM: f64 = 1000.0;

/// Largest frame of the physical layer (octets).
const LARGEST_MPDU: u8 = 127;

/// Octets of a strobe: the header of a frame to one station, one octet that says what it is, and the check sequence.
pub const STROBE_OCTETS: u8 = 12;

/// Octets of a wake-up frame of CSL: see [`WakeUpFrame`](super::frame::WakeUpFrame).
pub const WAKE_UP_OCTETS: u8 = 12;

/// How a sender wakes its receiver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Short frames with an address, each acknowledged early by the receiver; then the frame.
    XMac,
    /// The frame itself.
    RepeatedData,
    /// Wake-up frames back to back.
    Csl,
}

/// What a station does when it wakes up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Check {
    /// The receiver is on for this long; a frame that begins in this time is received.
    Window(Duration),
    /// The station looks at the channel twice, this long from the start of one look to that of the next, and sleeps between.
    Looks(Duration),
}

/// A sleeping MAC, settings checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SleepSettings {
    /// How a sender wakes its receiver.
    pub form: Form,
    /// From one wake-up to the next.
    pub interval: Duration,
    /// Whether senders remember when a receiver wakes up.
    pub phases: PhasesConfig,
    /// Whether sinks sleep.
    pub sinks: SinksConfig,
    /// Further attempts without acknowledgement.
    pub max_retries: u8,
    /// How often in succession a sender may find the channel busy and wait.
    pub max_backoffs: u8,
    /// Frames that a station holds.
    pub queue_frames: u16,
    /// Largest deviation of a clock that senders allow for, as a factor.
    pub allowed_drift: f64,
    phy: Phy,
    gap: Duration,
}

impl SleepSettings {
    /// The settings with this physical layer.
    ///
    /// # Errors
    /// If a number is out of its range.
    pub fn new(config: &SleepConfig, phy: Phy) -> Result<Self, SettingError> {
        let &SleepConfig { wake_up, interval_s, sinks, max_retries, max_backoffs, queue_frames, allowed_ppm } =
            config;
        let least_gap = phy.turnaround() * 2 + phy.symbol();
        let (form, phases, gap) = match wake_up {
            // Time for an acknowledgement, and to turn around before and after it.
            WakeUpConfig::XMac(_) => (Form::XMac, PhasesConfig::Unknown, phy.turnaround() * 2 + phy.ack_airtime()),
            WakeUpConfig::Csl(csl) => (Form::Csl, csl.phases, Duration::ZERO),
            WakeUpConfig::RepeatedData(repeated) => {
                let gap = match repeated.gap_us {
                    None => least_gap,
                    Some(us) => {
                        let (least, most) =
                            (1e6 * least_gap.as_secs_f64(), 1e6 * phy.airtime(LARGEST_MPDU).as_secs_f64());
                        let us = SettingError::in_range("gap_us", us, least, most);
                        Duration::from_secs_f64(1e-6 * us.map_err(|error| error.within("wake_up.repeated_data"))?)
                    }
                };
                (Form::RepeatedData, repeated.phases, gap)
            }
        };
        let least_s = (phy.airtime(LARGEST_MPDU) * LEAST_FRAMES_AN_INTERVAL).as_secs_f64();
        let interval_s = SettingError::in_range("interval_s", interval_s, least_s, LONGEST_INTERVAL_S)?;
        for (key, found, most) in
            [("max_retries", max_retries, MOST_RETRIES), ("max_backoffs", max_backoffs, MOST_BACKOFFS)]
        {
            if found > most {
                return Err(SettingError::new(key, found, format!("0 to {most}")));
            }
        }
        if !(1..=MOST_FRAMES).contains(&queue_frames) {
            return Err(SettingError::new("queue_frames", queue_frames, format!("1 to {MOST_FRAMES}")));
        }
        let allowed_ppm = SettingError::in_range("allowed_ppm", allowed_ppm, 0.0, WORST_PPM)?;
        let interval = Duration::from_secs_f64(interval_s);
        let allowed_drift = 1e-6 * allowed_ppm;
        Ok(Self { form, interval, phases, sinks, max_retries, max_backoffs, queue_frames, allowed_drift, phy, gap })
    }

    /// The physical layer.
    #[must_use]
    pub fn phy(&self) -> Phy {
        self.phy
    }

    /// From the end of a frame that wakes a receiver to the start of the next one.
    #[must_use]
    pub fn gap(&self) -> Duration {
        self.gap
    }

    /// Time on air of what wakes the receiver of a frame with this time on air.
    #[must_use]
    pub fn strobe_airtime(&self, airtime: Duration) -> Duration {
        match self.form {
            Form::XMac => self.phy.airtime(STROBE_OCTETS),
            Form::RepeatedData => airtime,
            Form::Csl => self.phy.airtime(WAKE_UP_OCTETS),
        }
    }

    /// From the start of what wakes a receiver to the start of the next one.
    #[must_use]
    pub fn period(&self, airtime: Duration) -> Duration {
        self.strobe_airtime(airtime) + self.gap
    }

    /// What a station does when it wakes up.
    #[must_use]
    pub fn check(&self) -> Check {
        match self.form {
            Form::XMac | Form::Csl => Check::Window(self.period(Duration::ZERO)),
            Form::RepeatedData => Check::Looks(self.distance()),
        }
    }

    /// From the start of one look at the channel to that of the next: two looks cannot both lie in a gap.
    #[must_use]
    pub fn distance(&self) -> Duration {
        match self.form {
            Form::XMac => self.period(Duration::ZERO) / 2,
            Form::RepeatedData => self.gap + self.phy.cca() * 2,
            Form::Csl => Duration::ZERO,
        }
    }

    /// Number of looks of a sender before it sends.
    #[must_use]
    pub fn looks(&self) -> u8 {
        if self.form == Form::Csl { 1 } else { 2 }
    }

    /// Time from waking up to sleeping again if nobody sends.
    #[must_use]
    pub fn check_length(&self) -> Duration {
        self.phy.turnaround()
            + match self.check() {
                Check::Window(window) => window,
                Check::Looks(distance) => distance + self.phy.cca(),
            }
    }

    /// How long the radio is on in a check in which nobody sends: it turns its receiver on, and receives.
    #[must_use]
    pub fn check_spans(&self) -> CheckSpans {
        let turnaround = self.phy.turnaround();
        match self.check() {
            Check::Window(window) => CheckSpans { turning: turnaround, receiving: window },
            Check::Looks(_) => CheckSpans { turning: turnaround * 2, receiving: self.phy.cca() * 2 },
        }
    }

    /// The same of the first part of a check, of this length.
    #[must_use]
    pub fn check_spans_within(&self, elapsed: Duration) -> CheckSpans {
        let turnaround = self.phy.turnaround();
        let look = |elapsed: Duration, most: Duration| CheckSpans {
            turning: elapsed.min(turnaround),
            receiving: elapsed.saturating_sub(turnaround).min(most),
        };
        match self.check() {
            Check::Window(window) => look(elapsed, window),
            Check::Looks(distance) => {
                let (first, second) =
                    (look(elapsed, self.phy.cca()), look(elapsed.saturating_sub(distance), self.phy.cca()));
                CheckSpans { turning: first.turning + second.turning, receiving: first.receiving + second.receiving }
            }
        }
    }

    /// How long a station that found the channel busy stays on: a frame begins by then, however long the one under way is.
    #[must_use]
    pub fn patience(&self) -> Duration {
        self.phy.airtime(LARGEST_MPDU) + self.gap + self.phy.symbol()
    }

    /// The shortest frame that no two looks miss (octets); zero if frames may have any length.
    #[must_use]
    pub fn least_mpdu_octets(&self) -> u8 {
        match self.form {
            Form::XMac | Form::Csl => 0,
            Form::RepeatedData => {
                let least = self.distance() + self.phy.cca();
                (0..=LARGEST_MPDU).find(|&octets| self.phy.airtime(octets) >= least).unwrap_or(LARGEST_MPDU)
            }
        }
    }

    /// How long a sender that does not know the phase wakes its receiver at most, counted from the start of its first frame to
    /// the start of the last one.
    #[must_use]
    pub fn whole(&self, airtime: Duration) -> Duration {
        match self.form {
            // The receiver's window is one period long.
            Form::XMac => self.interval + self.period(airtime) * 2,
            Form::RepeatedData => self.interval + self.period(airtime) + self.check_length(),
            // One more than the least.
            Form::Csl => self.interval,
        }
    }

    /// From the start of a sender's first look at the channel, with its radio asleep, to its first frame.
    #[must_use]
    pub fn access(&self) -> Duration {
        self.phy.turnaround() * 2 + self.distance() + self.phy.cca()
    }

    /// How a sender wakes a receiver of which it knows the phase, and has known it for so long; `None` if that is too long ago.
    #[must_use]
    pub fn aimed(&self, airtime: Duration, known_for: Duration) -> Option<Aimed> {
        let drift = known_for.mul_f64(2.0 * self.allowed_drift) + self.phy.symbols(GUARD_SYMBOLS);
        let aimed = match self.form {
            Form::XMac => return None,
            // The receiver wakes up between the copy before the one that it acknowledged and the end of its check before.
            Form::RepeatedData => {
                let period = self.period(airtime);
                Aimed { lead: period * 2 + drift, span: period * 3 + self.check_length() + drift * 2 }
            }
            Form::Csl => Aimed { lead: drift, span: drift * 2 },
        };
        (aimed.span < self.interval).then_some(aimed)
    }
}

/// How a sender wakes a receiver of which it knows the phase.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Aimed {
    /// How long before the instant that it knows its first frame begins.
    pub lead: Duration,
    /// From there to the start of its last frame.
    pub span: Duration,
}

/// What is added to what clocks may have drifted (symbols): the unit of phases and of times to the rendezvous.
pub(super) const GUARD_SYMBOLS: u64 = 10;

/// How long the radio is on in a check.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CheckSpans {
    /// Turning the receiver on.
    pub turning: Duration,
    /// Receiving.
    pub receiving: Duration,
}
