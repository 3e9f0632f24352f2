//! How the log of a robot is read.

use std::str::FromStr;
use std::time::Duration;

use super::bag_options::BagOptions;
use super::form_options::FormOptions;
use super::repair_options::RepairOptions;
use super::robot_frames::RobotFrames;
use super::sniffer_options::SnifferOptions;

/// How the log of a robot is read; the default asks for nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// How a path is cut into stops.
    pub stop_every: StopRule,
    /// Time between two packets of a node (s); `None` if it is to be estimated.
    pub packet_interval_s: Option<f64>,
    /// Where the parts of the log are, and how they are written.
    pub form: FormOptions,
    /// What is wrong in it, and corrected.
    pub repair: RepairOptions,
    /// What is read from a ROS bag.
    pub bag: BagOptions,
    /// What belongs to the capture of a sniffer.
    pub sniffer: SnifferOptions,
    /// The frames of its robots.
    pub frames: RobotFrames,
}

/// How a path is cut into stops.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum StopRule {
    /// By distance: the shortest of 0.5, 1, 2, 5, 10, .. m that gives at most [`StopRule::USUAL`] stops.
    #[default]
    Automatic,
    /// A stop ends where the robot is this far from where the stop began (m).
    Distance(f64),
    /// A stop ends after this time.
    Time(Duration),
}

impl StopRule {
    /// The largest number of stops of the automatic rule.
    pub const USUAL: usize = 400;
}

impl FromStr for StopRule {
    type Err = String;

    /// Reads `1.5m`, `2s` or `auto`.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let refused = || "expected a distance or a time above 0, for example 1m or 2s, or auto".to_owned();
        let text = text.trim();
        if text == "auto" {
            return Ok(Self::Automatic);
        }
        let (number, is_distance) = match (text.strip_suffix('m'), text.strip_suffix('s')) {
            (Some(number), _) => (number, true),
            (_, Some(number)) => (number, false),
            _ => return Err(refused()),
        };
        let number: f64 = number.trim().parse().map_err(|_| refused())?;
        let allowed = if is_distance { 1e-3..=1e9 } else { 1e-6..=1e9 };
        match number {
            number if !allowed.contains(&number) => Err(refused()),
            number if is_distance => Ok(Self::Distance(number)),
            number => Ok(Self::Time(Duration::from_secs_f64(number))),
        }
    }
}
