//! Whom a robot asks.

use sextant_channel::{Dbm, Position};

use super::heard::Neighbourhood;
use super::navigation_map::MapFrame;
use super::poll::Asked;

/// Answers that a robot wants in a poll.
const WANTED: [usize; 2] = [15, 35];
/// Change of the least power after a poll with more or fewer answers (dB).
const CHANGE_DB: f64 = 2.0;

/// Numbers the polls of a robot, and chooses whom it asks.
#[derive(Clone, Debug, Default)]
pub(crate) struct Asking {
    number: u16,
    least: Option<Dbm>,
}

impl Asking {
    /// The number of the next poll.
    pub(crate) fn next_poll(&mut self) -> u16 {
        self.number = self.number.wrapping_add(1);
        self.number
    }

    /// Number of polls so far; after 65535 comes 0.
    #[must_use]
    pub(crate) fn polls(&self) -> u16 {
        self.number
    }

    /// Whom a robot asks next that is at `place` on a map in `frame`: the nodes within `radius_m` of it on the map. Where
    /// the place itself is a guess, those near it would say little about it: then the nodes that hear the robot well.
    /// `answers` are those of the last poll.
    pub(crate) fn whom(
        &mut self,
        frame: MapFrame,
        place: Option<Position>,
        radius_m: f64,
        answers: &Neighbourhood,
    ) -> Asked {
        match (frame, place) {
            (MapFrame::Robot, Some(center)) => Asked::Near { center, radius_m },
            _ => self.loud(answers),
        }
    }

    /// Whom to ask next, if these nodes have answered the last poll: so many that some twenty answer. A channel is
    /// reciprocal, so the power of answers tells that of requests.
    fn loud(&mut self, answers: &Neighbourhood) -> Asked {
        let count = answers.nodes().len();
        let [fewest, most] = WANTED;
        self.least = match self.least {
            None if count <= most => None,
            None => {
                let mut powers: Vec<f64> = answers.nodes().map(|(_, heard)| heard.rssi.0).collect();
                powers.sort_by(|a, b| b.total_cmp(a));
                Some(Dbm(powers[usize::midpoint(fewest, most)]))
            }
            Some(least) if count > most => Some(Dbm(least.0 + CHANGE_DB)),
            Some(least) if count < fewest => Some(Dbm(least.0 - CHANGE_DB)),
            Some(least) => Some(least),
        };
        self.least.map_or(Asked::All, Asked::Loud)
    }
}
