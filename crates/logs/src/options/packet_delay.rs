//! How late the packets are by the clock of the path.

use std::str::FromStr;

/// How late the packets are by the clock of the path: what is taken off their times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PacketDelay {
    /// So many seconds; negative if they are early.
    Seconds(f64),
    /// As the packets tell, if they do so clearly.
    Estimated,
}

impl Default for PacketDelay {
    fn default() -> Self {
        Self::Seconds(0.0)
    }
}

/// Longest delay (s).
const LONGEST_S: f64 = 1e9;

impl FromStr for PacketDelay {
    type Err = String;

    /// Reads `1.5` or `auto`.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if text == "auto" {
            return Ok(Self::Estimated);
        }
        let delay_s = text.parse().ok().filter(|delay_s: &f64| delay_s.abs() <= LONGEST_S);
        delay_s.map(Self::Seconds).ok_or_else(|| "expected seconds from -1e9 to 1e9, or auto".to_owned())
    }
}
