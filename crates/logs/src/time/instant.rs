//! Times as decimal seconds or as date and time of day, exact to the nanosecond when read and written.

use std::time::Duration;

use sextant_kernel::SimTime;

use super::time_zone::TimeZone;

/// The allowed values of a cell with seconds.
pub(crate) const ALLOWED: &str =
    "seconds as a decimal number, at least 0 and below 18446744073, or a time as 2026-11-22T15:04:05Z";

/// The same for a cell whose time does not say its zone.
pub(crate) const ALLOWED_ZONED: &str = "a time with its zone, as 2026-11-22T15:04:05Z or 2026-11-22T15:04:05+02:00; the zone of \
     times that do not say theirs is given by `time_zone=UTC`, or by their offset from it as `time_zone=+02:00`";

/// The same for a cell that has so many digits that they are parts of a second.
pub(crate) const ALLOWED_SCALED: &str = "seconds, below 18446744073; milliseconds (13 digits since 1970), microseconds (16) and \
     nanoseconds (19) have the columns t_ms, t_us and t_ns: `path_fields=t_ns=NAME` or `packet_fields=t_ns=NAME`";

/// The columns that a file may have for times: seconds, or parts of a second.
pub(crate) const COLUMNS: [&str; 4] = ["t_s", "t_ms", "t_us", "t_ns"];

const SECOND_NS: u64 = 1_000_000_000;

/// The time `text` seconds after the start, to the nearest nanosecond. Plain decimals are not converted to floating point,
/// which has too few digits for seconds since 1970.
pub(crate) fn parse(text: &str) -> Option<SimTime> {
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

/// The time of a date and time of day as RFC 3339 writes it, in time since 1970: `2026-11-22T15:04:05.5+01:00`, and as other
/// programs do: `2026/11/22 15:04:05,5`. Without an offset it is in `zone`, and none if there is no zone.
pub(crate) fn parse_date(text: &str, zone: Option<TimeZone>) -> Option<SimTime> {
    let (date, clock) = text.split_once(['T', 't', ' '])?;
    let clock = clock.strip_suffix(" UTC").map_or_else(|| clock.to_owned(), |clock| format!("{clock}Z"));
    let (clock, zone) = match clock.strip_suffix(['Z', 'z']) {
        Some(clock) => (clock, TimeZone::UTC),
        None => match clock.find(['+', '-']) {
            Some(at) => (clock[..at].trim_end(), TimeZone::of_offset(&clock[at..])?),
            None => (clock.as_str(), zone?),
        },
    };
    let separator = if date.contains('/') { '/' } else { '-' };
    let [year, month, day] = <[&str; 3]>::try_from(date.split(separator).collect::<Vec<_>>()).ok()?;
    let (year, month) = (four_digits(year)?, two_digits(month, 12)?);
    let day = two_digits(day, days_of(year, month)?)?;
    if day == 0 {
        return None;
    }
    let [hour, minute, second] = <[&str; 3]>::try_from(clock.splitn(3, ':').collect::<Vec<_>>()).ok()?;
    let (second, fraction) =
        second.split_once(['.', ',']).map_or((second, "0"), |(second, fraction)| (second, fraction));
    // A leap second is taken as the first one of the next minute.
    let of_day_s = 3600 * two_digits(hour, 23)? + 60 * two_digits(minute, 59)? + two_digits(second, 60)?;
    let whole_s = u64::try_from(days_since_1970(year, month, day) * 86_400 + of_day_s - zone.ahead_s).ok()?;
    let fraction = parse(&format!("0.{fraction}"))?;
    whole_s.checked_mul(SECOND_NS)?.checked_add(fraction.as_nanos()).map(SimTime::from_nanos)
}

/// A number of exactly two digits, at most `max`.
pub(crate) fn two_digits(text: &str, max: i64) -> Option<i64> {
    let is_plain = text.len() == 2 && text.bytes().all(|byte| byte.is_ascii_digit());
    text.parse().ok().filter(|&number| is_plain && number <= max)
}

fn four_digits(text: &str) -> Option<i64> {
    let is_plain = text.len() == 4 && text.bytes().all(|byte| byte.is_ascii_digit());
    text.parse().ok().filter(|_| is_plain)
}

/// The number of days of a month; `None` if there is no such month.
fn days_of(year: i64, month: i64) -> Option<i64> {
    let is_leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    match month {
        1 | 3 | 5 | 7 | 8 | 10 | 12 => Some(31),
        4 | 6 | 9 | 11 => Some(30),
        2 => Some(if is_leap { 29 } else { 28 }),
        _ => None,
    }
}

/// Days from 1 January 1970 to a day of the Gregorian calendar: `days_from_civil` of H. Hinnant, "chrono-Compatible
/// Low-Level Date Algorithms" (2021). Years begin in March there, so that a leap day is the last one.
pub(crate) fn days_since_1970(year: i64, month: i64, day: i64) -> i64 {
    let year = if month <= 2 { year - 1 } else { year };
    let (era, of_era) = (year.div_euclid(400), year.rem_euclid(400));
    let of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    era * 146_097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719_468
}

/// The date and time of day, as RFC 3339 writes it in UTC, of a time after 1970, or before it (ns).
pub(crate) fn format_date(nanos: i64) -> String {
    let unsigned = |number: i64| number.unsigned_abs();
    let (second, fraction) = (nanos.div_euclid(1_000_000_000), nanos.rem_euclid(1_000_000_000));
    let (days, of_day_s) = (second.div_euclid(86_400), second.rem_euclid(86_400));
    // `civil_from_days` of H. Hinnant, as above.
    let days = days + 719_468;
    let (era, of_era) = (days.div_euclid(146_097), days.rem_euclid(146_097));
    let year_of_era = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let from_march = (5 * of_year + 2) / 153;
    let day = of_year - (153 * from_march + 2) / 5 + 1;
    let month = if from_march < 10 { from_march + 3 } else { from_march - 9 };
    let year = year_of_era + 400 * era + i64::from(month <= 2);
    let (hour, minute, second) = (of_day_s / 3600, of_day_s / 60 % 60, of_day_s % 60);
    let clock = format(SimTime::from_nanos(unsigned(fraction)));
    let fraction = clock.strip_prefix('0').unwrap_or_default();
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}{fraction}Z")
}

/// The time `text` in a unit of which `10^places` are a second: milliseconds have three places.
pub(crate) fn parse_scaled(text: &str, places: usize) -> Option<SimTime> {
    let (whole, fraction) = text.split_once('.').unwrap_or((text, ""));
    if places == 0 || !whole.bytes().chain(fraction.bytes()).all(|byte| byte.is_ascii_digit()) || whole.is_empty() {
        let exponent = i32::try_from(places).ok()?;
        return if places == 0 {
            parse(text)
        } else {
            parse(&(text.parse::<f64>().ok()? / 10_f64.powi(exponent)).to_string())
        };
    }
    let padded = format!("{whole:0>width$}", width = places + 1);
    let (seconds, rest) = padded.split_at(padded.len() - places);
    parse(&format!("{seconds}.{rest}{fraction}"))
}

/// The shortest decimal that [`parse`] reads as `time`.
pub(crate) fn format(time: SimTime) -> String {
    let (seconds, nanos) = (time.as_nanos() / SECOND_NS, time.as_nanos() % SECOND_NS);
    if nanos == 0 {
        return seconds.to_string();
    }
    format!("{seconds}.{nanos:09}").trim_end_matches('0').to_owned()
}

/// The time `by_s` seconds later, or earlier if it is negative; `None` if there is no such time.
pub(crate) fn shifted(time: SimTime, by_s: f64) -> Option<SimTime> {
    let by = Duration::try_from_secs_f64(by_s.abs()).ok()?;
    let by_ns = u64::try_from(by.as_nanos()).ok()?;
    let time_ns = time.as_nanos();
    let shifted = if by_s < 0.0 { time_ns.checked_sub(by_ns) } else { time_ns.checked_add(by_ns) };
    shifted.map(SimTime::from_nanos)
}

/// A span in seconds, with at most three decimals.
pub(crate) fn format_span(span: Duration) -> String {
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
    fn dates_are_times_since_1970() {
        let at = |text| parse_date(text, None).map(format);
        for (text, expected) in [
            ("1970-01-01T00:00:00Z", "0"),
            ("2023-11-14T22:13:20Z", "1700000000"),
            ("2024-02-29 23:59:59.25z", "1709251199.25"),
            ("2024-03-01T00:30:00+01:00", "1709249400"),
            ("2000-12-31T23:00:00-02:30", "978312600"),
        ] {
            assert_eq!(at(text).as_deref(), Some(expected), "{text}");
        }
        for text in [
            "2023-11-14T22:13:20",
            "2023-02-29T00:00:00Z",
            "2023-13-01T00:00:00Z",
            "2023-04-31T00:00:00Z",
            "2023-04-00T00:00:00Z",
            "2023-04-01T24:00:00Z",
            "2023-04-01",
            "12:30",
            "1969-12-31T23:59:59Z",
        ] {
            assert_eq!(at(text), None, "{text}");
        }
        assert_eq!(parse_date("2023-11-14T22:13:20", Some(TimeZone::UTC)), parse("1700000000"));
        let summer = "+02:00".parse().ok();
        for text in
            ["2023-11-15 00:13:20", "2023/11/15 00:13:20,0", "2023-11-14T22:13:20Z", "2023-11-14 22:13:20 UTC"]
        {
            assert_eq!(parse_date(text, summer), parse("1700000000"), "{text}");
        }
        for text in ["2023-11-14 22:13:20+00", "2023-11-14 17:43:20 -0430", "2023-11-14T23:13:20.0+01:00"] {
            assert_eq!(parse_date(text, None), parse("1700000000"), "{text}");
        }
        for text in ["1970-01-01T00:00:00Z", "2024-02-29T23:59:59.25Z", "2100-03-01T00:00:00.000000001Z"] {
            let nanos = parse_date(text, None).unwrap().as_nanos();
            assert_eq!(format_date(nanos.try_into().unwrap()), text);
        }
        assert_eq!(format_date(-1), "1969-12-31T23:59:59.999999999Z");
    }

    #[test]
    fn times_in_other_units_are_exact() {
        for (text, places, expected) in [
            ("1700000000123", 3, "1700000000.123"),
            ("1700000000123.5", 3, "1700000000.1235"),
            ("1700000000123456789", 9, "1700000000.123456789"),
            ("7", 6, "0.000007"),
            ("1.5", 0, "1.5"),
            ("2e3", 3, "2"),
        ] {
            assert_eq!(parse_scaled(text, places).map(format).as_deref(), Some(expected), "{text}");
        }
        for text in ["", ".5x", "-1", "nan"] {
            assert_eq!(parse_scaled(text, 3), None, "{text}");
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
