//! How far the times of a file are ahead of UTC.

use std::str::FromStr;

/// How far local time is ahead of UTC. Zones with a name change it twice a year, so only the offset itself is understood.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimeZone {
    /// Seconds, negative in the west.
    pub(crate) ahead_s: i64,
}

impl TimeZone {
    /// Coordinated universal time.
    pub const UTC: Self = Self { ahead_s: 0 };

    /// The offset of a time as RFC 3339 writes it, or shorter: `+02:00`, `+0200`, `-05`. On earth it is at most 14 hours.
    pub(crate) fn of_offset(text: &str) -> Option<Self> {
        const LARGEST_S: i64 = 14 * 3600;
        let (sign, digits) = match text.strip_prefix('-').or_else(|| text.strip_prefix('\u{2212}')) {
            Some(digits) => (-1, digits),
            None => (1, text.strip_prefix('+')?),
        };
        let (hours, minutes) = match digits.len() {
            2 => (digits, "00"),
            4 => digits.split_at_checked(2)?,
            _ => digits.split_once(':')?,
        };
        let number = |text: &str, most: i64| -> Option<i64> {
            let is_plain = text.len() == 2 && text.bytes().all(|octet| octet.is_ascii_digit());
            text.parse().ok().filter(|&number: &i64| is_plain && number <= most)
        };
        let ahead_s = 3600 * number(hours, 14)? + 60 * number(minutes, 59)?;
        (ahead_s <= LARGEST_S).then_some(Self { ahead_s: sign * ahead_s })
    }
}

impl FromStr for TimeZone {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        if ["utc", "z", "gmt"].contains(&text.to_lowercase().as_str()) {
            return Ok(Self::UTC);
        }
        Self::of_offset(text).ok_or_else(|| {
            "expected UTC, or the offset from it as +02:00 or -05:00. Names of zones are not known, because most have two \
             offsets a year: give the one of the day of the survey"
                .to_owned()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offsets_are_read_in_all_usual_forms_and_names_are_refused() {
        let ahead = |text: &str| text.parse().map(|zone: TimeZone| zone.ahead_s);
        for (text, expected) in [
            ("UTC", 0),
            ("z", 0),
            ("+02:00", 7200),
            ("+0200", 7200),
            ("+02", 7200),
            ("-05:30", -19_800),
            ("+14:00", 50_400),
            ("-00:00", 0),
        ] {
            assert_eq!(ahead(text), Ok(expected), "{text}");
        }
        for text in ["", "2", "+2", "02:00", "+02:60", "+15:00", "+14:30", "Europe/Berlin", "CEST", "+aa:00", "+é0"]
        {
            assert!(ahead(text).unwrap_err().contains("as +02:00"), "{text}");
        }
    }
}
