//! What theory says of CSMA-CA: exact values of small cases.
//!
//! All stations hear each other, frames that overlap are lost, and nothing else is lost. There are no acknowledgements.

use std::collections::BTreeMap;
use std::time::Duration;

use super::CsmaSettings;
use crate::Phy;

/// Stations in [`one_shot`], at most: the time for more of them grows fast.
pub(crate) const MOST_ONE_SHOT: usize = 4;

/// Mean time between two frames of a saturated station that is alone, by unslotted access: backoff, assessment, turnaround,
/// frame, interframe spacing, and the acknowledgement with its turnaround if there is one.
#[must_use]
pub fn lone_saturated_period(settings: &CsmaSettings, phy: Phy, mpdu_octets: u8, is_acknowledged: bool) -> Duration {
    let backoffs = f64::from((1_u32 << settings.min_be()) - 1) / 2.0;
    let waking = if settings.has_idle_turnarounds() { phy.turnaround() } else { Duration::ZERO };
    let access = phy.backoff_period().mul_f64(backoffs) + waking + phy.cca() + phy.turnaround();
    let answer = if is_acknowledged { phy.turnaround() + phy.ack_airtime() } else { Duration::ZERO };
    access + phy.airtime(mpdu_octets) + answer + phy.interframe_spacing(mpdu_octets)
}

/// What becomes of the frames of stations that all get one frame at the same instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OneShot {
    /// Probability that the frame of a station is received.
    pub received: f64,
    /// Probability that a station gives its frame up because the channel was busy too often.
    pub failed: f64,
}

/// Stations before their next assessment, by its start, with their busy assessments so far; and the frames that may still
/// disturb, by their start, and whether they collided. Times are in nanoseconds from the first assessment on.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
struct State {
    contending: Vec<(i64, u8)>,
    on_air: Vec<(i64, bool)>,
}

impl State {
    /// One more station assesses the channel at `start`, after `busy` busy assessments.
    fn with_station(&self, start: i64, busy: u8) -> Self {
        let mut next = self.clone();
        next.contending.push((start, busy));
        next.contending.sort_unstable();
        next
    }
}

/// Mean numbers of frames that are received and given up.
#[derive(Clone, Copy, Default)]
struct Fates {
    received: f64,
    failed: f64,
}

/// What becomes of the frames of `stations` that all get a frame of `mpdu_octets` at the same instant, by unslotted access:
/// the exact probabilities, over all draws of all backoffs. States that differ in the names of stations or in their time
/// alone are one. `None` for more than `MOST_ONE_SHOT` stations, for none, or if radios are idle before an assessment.
#[must_use]
pub fn one_shot(stations: usize, settings: &CsmaSettings, phy: Phy, mpdu_octets: u8) -> Option<OneShot> {
    if stations == 0 || stations > MOST_ONE_SHOT || settings.has_idle_turnarounds() {
        return None;
    }
    let mut round = Round { settings, phy, airtime_ns: nanos(phy.airtime(mpdu_octets)), known: BTreeMap::new() };
    let mut states = BTreeMap::from([(State::default(), 1.0)]);
    for _ in 0..stations {
        let mut more = BTreeMap::new();
        for (state, probability) in states {
            let starts = round.backoffs(0);
            let share = probability / starts.len() as f64;
            for start in starts {
                *more.entry(state.with_station(start, 0)).or_default() += share;
            }
        }
        states = more;
    }
    let mut mean = Fates::default();
    for (state, probability) in states {
        let Fates { received, failed } = round.fates(state);
        mean.received += probability * received;
        mean.failed += probability * failed;
    }
    let count = stations as f64;
    Some(OneShot { received: mean.received / count, failed: mean.failed / count })
}

struct Round<'a> {
    settings: &'a CsmaSettings,
    phy: Phy,
    airtime_ns: i64,
    /// What becomes of the frames of each state that was met.
    known: BTreeMap<State, Fates>,
}

impl Round<'_> {
    /// All lengths of the backoff after `busy` busy assessments, which are drawn alike.
    fn backoffs(&self, busy: u8) -> Vec<i64> {
        let exponent = self.settings.min_be().saturating_add(busy).min(self.settings.max_be());
        (0..1_i64 << exponent).map(|draw| draw * nanos(self.phy.backoff_period())).collect()
    }

    /// What becomes of the frames that have not ended in `state`.
    fn fates(&mut self, mut state: State) -> Fates {
        let Some(&(first, _)) = state.contending.first() else {
            return Fates { received: settle(&mut state, i64::MAX, self.airtime_ns), failed: 0.0 };
        };
        state.contending.iter_mut().for_each(|(start, _)| *start -= first);
        state.on_air.iter_mut().for_each(|(begin, _)| *begin -= first);
        // Frames that ended before this assessment disturb nothing any more.
        let received = settle(&mut state, 0, self.airtime_ns);
        let later = match self.known.get(&state) {
            Some(&known) => known,
            None => {
                let found = self.assessed(state.clone());
                self.known.insert(state, found);
                found
            }
        };
        Fates { received: received + later.received, ..later }
    }

    /// The same, by the first assessment of the state, which is at zero.
    fn assessed(&mut self, mut state: State) -> Fates {
        let (start, busy) = state.contending.remove(0);
        let sensed = start + nanos(self.phy.cca());
        if state.on_air.iter().any(|&(begin, _)| begin < sensed && begin + self.airtime_ns > start) {
            if busy + 1 > self.settings.max_backoffs() {
                let later = self.fates(state);
                return Fates { failed: later.failed + 1.0, ..later };
            }
            let backoffs = self.backoffs(busy + 1);
            let share = 1.0 / backoffs.len() as f64;
            return backoffs.into_iter().fold(Fates::default(), |mean, backoff| {
                let Fates { received, failed } = self.fates(state.with_station(sensed + backoff, busy + 1));
                Fates { received: mean.received + share * received, failed: mean.failed + share * failed }
            });
        }
        let begin = sensed + nanos(self.phy.turnaround());
        let mut collides = false;
        for (other, collided) in &mut state.on_air {
            let overlaps = *other + self.airtime_ns > begin;
            *collided |= overlaps;
            collides |= overlaps;
        }
        state.on_air.push((begin, collides));
        self.fates(state)
    }
}

/// Removes the frames that have ended at `now`, and returns the number of those that were received.
fn settle(state: &mut State, now: i64, airtime_ns: i64) -> f64 {
    let mut received = 0.0;
    state.on_air.retain(|&(begin, collided)| {
        let is_over = begin.saturating_add(airtime_ns) <= now;
        received += f64::from(u8::from(is_over && !collided));
        !is_over
    });
    received
}

fn nanos(span: Duration) -> i64 {
    i64::try_from(span.as_nanos()).unwrap_or(i64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PHY: Phy = Phy::Oqpsk2450;

    #[track_caller]
    fn near(found: f64, expected: f64, tolerance: f64) {
        assert!((found - expected).abs() <= tolerance, "{found}, not {expected}");
    }

    #[test]
    fn a_lone_saturated_station_sends_a_frame_each_6_88_ms_with_acknowledgements() {
        let period = |acknowledged| lone_saturated_period(&CsmaSettings::default(), PHY, 127, acknowledged);
        assert_eq!(period(true), Duration::from_micros(1440 + 4256 + 192 + 352 + 640));
        assert_eq!(period(false), Duration::from_micros(1440 + 4256 + 640));
    }

    /// Compares probabilities with some that were enumerated draw by draw by a program that shares no code with this crate.
    #[track_caller]
    fn enumerated(cases: &[(usize, u8, f64, f64)]) {
        for &(stations, octets, received, failed) in cases {
            let found = one_shot(stations, &CsmaSettings::default(), PHY, octets).expect("few stations");
            near(found.received, received, 1e-7);
            near(found.failed, failed, 1e-6);
        }
    }

    #[test]
    fn one_shot_probabilities_are_those_of_an_enumeration_of_all_draws() {
        enumerated(&[
            (1, 20, 1.0, 0.0),
            (2, 9, 0.875, 0.0),
            (2, 20, 0.874_999_8, 2.09e-7),
            (2, 44, 7_339_941.0 / 8_388_608.0, 1.085e-5),
            (2, 127, 7_334_369.0 / 8_388_608.0, 0.875 - 7_334_369.0 / 8_388_608.0),
            (3, 20, 0.798_362_6, 1.34e-5),
            (3, 45, 0.831_196_7, 2.424e-4),
            (3, 114, 0.828_665_2, 9.616e-3),
        ]);
        assert_eq!(one_shot(MOST_ONE_SHOT + 1, &CsmaSettings::default(), PHY, 20), None);
    }

    #[test]
    fn one_shot_probabilities_of_four_stations_are_those_of_an_enumeration_of_all_draws() {
        enumerated(&[(4, 20, 0.731_216_2, 8.60e-5), (4, 44, 0.770_527_5, 1.430e-3)]);
    }
}
