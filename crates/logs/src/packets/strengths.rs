//! Signal strengths as receivers report them: with noise in them, or of noise alone.

use crate::error::robot_log_error::RobotLogError;
use crate::options::form_options::FormOptions;
use crate::options::noise_floor::NoiseFloor;

/// What a receiver reports of a packet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Report {
    /// It was heard, with this strength (dBm), if it is known.
    Heard(Option<f64>),
    /// Nothing but noise.
    Noise,
}

/// Corrects the strengths of a log, all in one place.
#[derive(Clone, Debug)]
pub(crate) struct Strengths {
    lora: bool,
    floor: Option<NoiseFloor>,
    /// Strengths that came.
    seen: u64,
    /// Those of noise.
    noise: u64,
    /// Those without a ratio of signal to noise, though it is needed.
    without_snr: u64,
}

impl Strengths {
    pub(crate) fn of(options: &FormOptions) -> Self {
        Self { lora: options.lora, floor: options.noise_floor, seen: 0, noise: 0, without_snr: 0 }
    }

    /// What the report of a strength (dBm) and a signal-to-noise ratio (dB) says.
    pub(crate) fn take(&mut self, rssi_dbm: Option<f64>, snr_db: Option<f64>) -> Report {
        let Some(rssi_dbm) = rssi_dbm else { return Report::Heard(None) };
        self.seen += 1;
        if self.floor.is_some_and(|floor| floor.is_noise(rssi_dbm)) {
            self.noise += 1;
            return Report::Noise;
        }
        match (self.lora, snr_db) {
            (false, _) => Report::Heard(Some(rssi_dbm)),
            (true, Some(snr_db)) => Report::Heard(Some(without_noise(rssi_dbm, snr_db))),
            (true, None) => {
                self.without_snr += 1;
                Report::Heard(None)
            }
        }
    }

    /// Adds what the user should know to `notes`.
    ///
    /// # Errors
    /// If there was nothing to correct, or all strengths are those of noise.
    pub(crate) fn finish(&self, notes: &mut Vec<String>) -> Result<(), RobotLogError> {
        let Self { lora, floor, seen, noise, without_snr } = *self;
        let refused = |problem: String| Err(RobotLogError::Form { problem });
        if let Some(floor) = floor {
            if seen == 0 {
                return refused("option `noise_floor` is for signal strengths, but the log has none".to_owned());
            }
            if noise == seen {
                return refused(format!(
                    "all {seen} signal strengths are at or below {floor}; lower option `noise_floor`"
                ));
            }
            notes.push(format!(
                "{noise} of {seen} signal strengths are at or below {floor} (option `noise_floor`) and count as not heard"
            ));
        }
        if lora {
            let heard = seen - noise;
            if heard == without_snr {
                return refused(
                    "option `lora` computes the strength of the signal from RSSI and SNR, but nothing in the log has both"
                        .to_owned(),
                );
            }
            let left_out = match without_snr {
                0 => String::new(),
                count => format!("; {count} without SNR are not used as strengths"),
            };
            notes.push(format!(
                "{} signal strengths are RSSI + SNR - 10 lg(1 + 10^(SNR / 10 dB)) (option `lora`){left_out}",
                heard - without_snr
            ));
        }
        Ok(())
    }
}

/// The strength of a signal (dBm) whose receiver reports the power of signal and noise together (dBm) and their ratio (dB),
/// as receivers of LoRa do. From P = S + N and r = S / N follows S = P r / (1 + r), in decibels the sum below. Far above the
/// noise it is the RSSI, far below it the RSSI plus the ratio.
fn without_noise(rssi_dbm: f64, snr_db: f64) -> f64 {
    rssi_dbm + snr_db - 10.0 * libm::log1p(libm::pow(10.0, snr_db / 10.0)) / std::f64::consts::LN_10
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_signal_of_lora_is_the_report_without_its_noise() {
        // Signal and noise alike: half of the power, 3.01 dB less.
        assert!((without_noise(-110.0, 0.0) + 113.0103).abs() < 1e-4);
        // Powers of 1 and 100 pW: -120 and -100 dBm in units that do not matter; their sum is 101.
        let sum_dbm = 10.0 * 101_f64.log10() - 120.0;
        assert!((without_noise(sum_dbm, -20.0) + 120.0).abs() < 1e-9);
        assert!((without_noise(-60.0, 30.0) + 60.0).abs() < 0.01);
    }

    #[test]
    fn a_power_up_to_the_threshold_is_noise() {
        let floor = Some("-100+6".parse().unwrap());
        let mut strengths = Strengths::of(&FormOptions { noise_floor: floor, lora: true, ..FormOptions::default() });
        assert_eq!(strengths.take(Some(-94.0), Some(3.0)), Report::Noise);
        assert_eq!(strengths.take(Some(-93.9), None), Report::Heard(None));
        assert_eq!(strengths.take(None, Some(1.0)), Report::Heard(None));
        let Report::Heard(Some(level)) = strengths.take(Some(-80.0), Some(0.0)) else { panic!("heard") };
        assert!((level + 83.0103).abs() < 1e-4);
        let mut notes = Vec::new();
        strengths.finish(&mut notes).unwrap();
        assert_eq!(
            notes,
            [
                "1 of 3 signal strengths are at or below -94 dBm (option `noise_floor`) and count as not heard",
                "1 signal strengths are RSSI + SNR - 10 lg(1 + 10^(SNR / 10 dB)) (option `lora`); 1 without SNR are not used as \
                 strengths"
            ]
        );
    }

    #[test]
    fn a_log_without_strengths_to_correct_is_an_error() {
        let refused = |options: FormOptions, rows: &[(Option<f64>, Option<f64>)]| {
            let mut strengths = Strengths::of(&options);
            for &(rssi_dbm, snr_db) in rows {
                strengths.take(rssi_dbm, snr_db);
            }
            strengths.finish(&mut Vec::new()).unwrap_err().to_string()
        };
        let floor = || FormOptions { noise_floor: Some("-90".parse().unwrap()), ..FormOptions::default() };
        let lora = FormOptions { lora: true, ..FormOptions::default() };
        assert!(refused(floor(), &[(None, None)]).contains("the log has none"));
        assert!(refused(floor(), &[(Some(-90.0), None)]).contains("all 1 signal strengths"));
        assert!(refused(lora, &[(Some(-90.0), None), (None, Some(2.0))]).contains("nothing in the log has both"));
    }
}
