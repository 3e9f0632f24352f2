//! Times as decimal seconds, exact to the nanosecond when read and written.

use std::time::Duration;

use sextant_kernel::SimTime;

/// The allowed values of a cell with seconds.
pub(super) const ALLOWED: &str = "seconds as a decimal number, at least 0 and below 18446744073";

const SECOND_NS: u64 = 1_000_000_000;

/// The time `text` seconds after the start, to the nearest nanosecond. Plain decimals are not converted to floating point,
/// which has too few digits for seconds since 1970.
pub(super) fn parse(text: &str) -> Option<SimTime> {
    let (whole, fraction) = text.split_once('.').unwrap_or((text, ""));
    let plain = |digits: &str| digits.bytes().all(|byte| byte.is_ascii_digit());
    if !plain(whole) || !plain(fraction) || whole.len() + fraction.len() == 0 {
        let span = Duration::try_from_secs_f64(text.parse().ok()?).ok()?;
        return u64::try_from(span.as_nanos()).ok().map(SimTime::from_nanos);
    }
    let seconds: u64 = if whole.is_empty() { 0 } else { whole.parse().ok()? };
    let digit = |place: usize| fraction.as_bytes().get(place).map_or(0, |byte| u64::from(byte - b'0'));
    let mut nanos = (0..9).fold(0, |sum, place| sum * 10 + digit(place));
    nanos += u64::from(digit(9) >= 5);
    seconds.checked_mul(SECOND_NS)?.checked_add(nanos).map(SimTime::from_nanos)
}

/// The shortest decimal that [`parse`] reads as `time`.
pub(super) fn format(time: SimTime) -> String {
    let (seconds, nanos) = (time.as_nanos() / SECOND_NS, time.as_nanos() % SECOND_NS);
    if nanos == 0 {
        return seconds.to_string();
    }
    format!("{seconds}.{nanos:09}").trim_end_matches('0').to_owned()
}

/// The time `by_s` seconds later, or earlier if it is negative; `None` if there is no such time.
pub(super) fn shifted(time: SimTime, by_s: f64) -> Option<SimTime> {
    let by = Duration::try_from_secs_f64(by_s.abs()).ok()?;
    let by_ns = u64::try_from(by.as_nanos()).ok()?;
    let time_ns = time.as_nanos();
    let shifted = if by_s < 0.0 { time_ns.checked_sub(by_ns) } else { time_ns.checked_add(by_ns) };
    shifted.map(SimTime::from_nanos)
}

/// A span in seconds, with at most three decimals.
pub(super) fn format_span(span: Duration) -> String {
    let text = format!("{:.3}", span.as_secs_f64());
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seconds_since_1970_keep_their_nanoseconds() {
        let time = SimTime::from_nanos(1_764_000_000_123_456_789);
        assert_eq!(parse("1764000000.123456789"), Some(time));
        assert_eq!(format(time), "1764000000.123456789");
    }

    #[test]
    fn decimals_are_rounded_to_the_nearest_nanosecond() {
        for (text, nanos) in [
            ("0", 0),
            ("1", SECOND_NS),
            (".5", SECOND_NS / 2),
            ("2.", 2 * SECOND_NS),
            ("0.0000000005", 1),
            ("0.00000000049", 0),
            ("0.9999999999", SECOND_NS),
            ("1e-3", 1_000_000),
            ("18446744073.709551615", u64::MAX),
        ] {
            assert_eq!(parse(text), Some(SimTime::from_nanos(nanos)), "{text}");
        }
    }

    #[test]
    fn a_shifted_time_is_exact_and_never_before_the_first() {
        let time = SimTime::from_nanos(1_764_000_000_123_456_789);
        assert_eq!(shifted(time, -0.5), Some(SimTime::from_nanos(1_763_999_999_623_456_789)));
        assert_eq!(shifted(time, 2.0), Some(SimTime::from_nanos(1_764_000_002_123_456_789)));
        assert_eq!(shifted(SimTime::from_nanos(5), -1.0), None);
    }

    #[test]
    fn invalid_times_are_rejected() {
        for text in ["", ".", "-1", "nan", "inf", "1,5", "12:30", "18446744073.709551616", "1e300", "1.2.3", "0x10"] {
            assert_eq!(parse(text), None, "{text}");
        }
    }
}
