//! The unit of a key, which is the end of its name.

/// Endings of names and their units; of two that fit, the longer one stands first.
const UNITS: &[(&str, &str)] = &[
    ("m_per_sqrt_m", "m/√m"),
    ("rad_per_sqrt_m", "rad/√m"),
    ("rad_per_m", "rad/m"),
    ("m_per_s2", "m/s²"),
    ("rad_per_s", "rad/s"),
    ("bit_per_s", "bit/s"),
    ("m_per_s", "m/s"),
    ("per_s", "1/s"),
    ("per_min", "1/min"),
    ("per_h", "1/h"),
    ("per_year", "1/year"),
    ("db_per_km", "dB/km"),
    ("db_per_m", "dB/m"),
    ("per_m2", "1/m²"),
    ("per_m", "1/m"),
    ("dbm", "dBm"),
    ("dbi", "dBi"),
    ("db", "dB"),
    ("ghz", "GHz"),
    ("mhz", "MHz"),
    ("khz", "kHz"),
    ("hz", "Hz"),
    ("deg", "degrees"),
    ("rad", "rad"),
    ("ms", "ms"),
    ("us", "µs"),
    ("ns", "ns"),
    ("h", "h"),
    ("s", "s"),
    ("m", "m"),
    ("ppm", "ppm"),
    ("octets", "octets"),
    ("mah", "mAh"),
    ("ma", "mA"),
    ("mb", "MB"),
    ("mw", "mW"),
    ("w", "W"),
    ("v", "V"),
    ("j", "J"),
];

/// The unit that the key `name` ends in.
pub(crate) fn of(name: &str) -> Option<&'static str> {
    split(name).map(|(_, unit)| unit)
}

/// The name of a key without the unit that it ends in, and that unit: `speed` and `m/s` of `speed_m_per_s`. The name is empty
/// if the key is the unit alone.
#[must_use]
pub fn split(name: &str) -> Option<(&str, &'static str)> {
    UNITS.iter().find_map(|(ending, unit)| match name.strip_suffix(ending)? {
        "" if ending.len() > 1 => Some(("", *unit)),
        before => before.strip_suffix('_').map(|before| (before, *unit)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_is_the_end_of_a_name() {
        for (name, unit) in [
            ("grid_step_m", Some("m")),
            ("speed_m_per_s", Some("m/s")),
            ("acceleration_sigma_m_per_s2", Some("m/s²")),
            ("absorption_per_m", Some("1/m")),
            ("gas_db_per_km", Some("dB/km")),
            ("db_per_km", Some("dB/km")),
            ("tx_power_dbm", Some("dBm")),
            ("length_noise_m_per_sqrt_m", Some("m/√m")),
            ("false_alarms_per_h", Some("1/h")),
            ("lifetime_h", Some("h")),
            ("exponent", None),
            ("maps", None),
            ("robots", None),
            ("seed", None),
        ] {
            assert_eq!(of(name), unit, "{name}");
        }
    }
}
