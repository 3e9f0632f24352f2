//! When radios are on by plan, as a background: the cells of slots, and checks of the channel.

use plotters::style::RGBColor;

use super::super::{PacketSource, seconds};

/// What a station does by plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Planned {
    Listens,
    ListensOrSends,
    Sends,
    Checks,
}

/// How each is drawn: its colour, and its words.
pub(super) const PLANNED: [(Planned, RGBColor, &str); 4] = [
    (Planned::Listens, RGBColor(0xd6, 0xe6, 0xf4), "slot in which it listens"),
    (Planned::ListensOrSends, RGBColor(0xf8, 0xe8, 0xc4), "slot that all share"),
    (Planned::Sends, RGBColor(0xcf, 0xea, 0xde), "slot in which it may send"),
    (Planned::Checks, RGBColor(0xa8, 0xc4, 0xdc), "check of the channel"),
];

impl Planned {
    pub(super) fn color(self) -> RGBColor {
        PLANNED.iter().find(|(planned, ..)| *planned == self).map_or(PLANNED[0].1, |(_, color, _)| *color)
    }
}

/// A time in which the radio of a station is on by plan (s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OnTime {
    pub(super) station: u32,
    pub(super) planned: Planned,
    pub(super) from_s: f64,
    pub(super) to_s: f64,
}

/// All that begin in a window (s), by station and time; those of lower slotframes cover others. `None` if there are more than
/// `most`. Nothing is on after a battery was empty.
pub(super) fn within(source: &PacketSource<'_>, (from_s, to_s): (f64, f64), most: usize) -> Option<Vec<OnTime>> {
    let activity = source.activity;
    let mut times = Vec::new();
    for cell in &activity.cells {
        let has = |word: &str| cell.options.split(' ').any(|option| option == word);
        let planned = match (has("transmit"), has("receive")) {
            (true, true) => Planned::ListensOrSends,
            (true, false) => Planned::Sends,
            (false, _) => Planned::Listens,
        };
        let step_ns = cell.slot_ns.saturating_mul(cell.slotframe.into());
        let first_ns = cell.slot_ns.saturating_mul(cell.timeslot.into());
        let (station, length_ns, since_ns, until_ns) = (cell.station, cell.slot_ns, cell.from_ns, cell.to_ns);
        let pattern = Pattern { station, planned, first_ns, step_ns, length_ns, since_ns, until_ns };
        pattern.add(source, (from_s, to_s), most, &mut times)?;
    }
    for check in &activity.checks {
        let pattern = Pattern {
            station: check.station,
            planned: Planned::Checks,
            first_ns: check.first_ns,
            step_ns: check.interval_ns,
            length_ns: check.length_ns,
            since_ns: 0,
            until_ns: None,
        };
        pattern.add(source, (from_s, to_s), most, &mut times)?;
    }
    Some(times)
}

/// Times that come again and again (ns).
struct Pattern {
    station: u32,
    planned: Planned,
    first_ns: u64,
    step_ns: u64,
    length_ns: u64,
    /// None begins earlier.
    since_ns: u64,
    /// Nor later than this, if it is known.
    until_ns: Option<u64>,
}

impl Pattern {
    /// Adds those in a window; `None` if there would be more than `most`.
    fn add(
        &self,
        source: &PacketSource<'_>,
        (from_s, to_s): (f64, f64),
        most: usize,
        times: &mut Vec<OnTime>,
    ) -> Option<()> {
        let &Self { station, planned, .. } = self;
        let death = source.drawn.deaths.get(&sextant_kernel::NodeId(station)).map(|death| death.as_nanos());
        let ends = death.into_iter().chain(self.until_ns);
        let until_s = ends.fold(to_s, |until_s, end| until_s.min(seconds(end)));
        if self.step_ns == 0 {
            return Some(());
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "nanoseconds of a simulation")]
        let from_ns = ((from_s * 1e9) as u64).max(self.since_ns);
        let passed = from_ns.saturating_sub(self.first_ns + self.length_ns).div_ceil(self.step_ns);
        let starts = (passed..).map(|number| self.first_ns.saturating_add(number.saturating_mul(self.step_ns)));
        for start in starts.skip_while(|&start| start < self.since_ns) {
            let from_s = seconds(start);
            if from_s >= until_s {
                break;
            }
            if times.len() >= most {
                return None;
            }
            times.push(OnTime { station, planned, from_s, to_s: seconds(start.saturating_add(self.length_ns)) });
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use sextant_kernel::{NodeId, SimTime};
    use sextant_recording::messages::{CellMessage, CheckMessage};
    use sextant_recording::{RecordedActivity, RecordedWorld};

    use super::super::super::TimeWindow;
    use super::*;

    #[test]
    fn cells_come_in_each_slotframe_and_checks_in_each_interval() {
        // Slot 2 of 5 slots of 10 ms: at 20, 70, 120 ms ..; checks at 7, 32, 57 ms ..
        let cell = CellMessage {
            station: 1,
            slot_ns: 10_000_000,
            slotframe: 5,
            timeslot: 2,
            options: "receive".to_owned(),
            ..CellMessage::default()
        };
        let late =
            CellMessage { station: 2, from_ns: 100_000_000, options: "transmit shared".to_owned(), ..cell.clone() };
        let early = CellMessage { station: 3, to_ns: Some(70_000_000), ..cell.clone() };
        let check = CheckMessage {
            station: 0,
            network: String::new(),
            first_ns: 7_000_000,
            interval_ns: 25_000_000,
            length_ns: 1_000_000,
        };
        let activity =
            RecordedActivity { cells: vec![cell, late, early], checks: vec![check], ..RecordedActivity::default() };
        let mut drawn = RecordedWorld::default();
        drawn.deaths.insert(NodeId(0), SimTime::from_nanos(60_000_000));
        let source = PacketSource {
            title: "t",
            names: &[],
            drawn: &drawn,
            packets: &[],
            activity: &activity,
            traffic: &[],
            window: TimeWindow::default(),
        };
        let found = within(&source, (0.025, 0.13), 100).unwrap();
        let starts = |station: u32| {
            let own = found.iter().filter(|time| time.station == station);
            own.map(|time| (time.from_s * 1e3).round()).collect::<Vec<_>>()
        };
        assert_eq!(starts(1), [20.0, 70.0, 120.0], "that which has begun before the window too");
        assert_eq!(starts(2), [120.0], "only since it is in the network");
        assert_eq!(starts(3), [20.0], "only until it gives the cell up");
        assert_eq!(starts(0), [32.0, 57.0], "only until its battery is empty");
        assert_eq!(found[3].planned, Planned::Sends);
        assert_eq!(within(&source, (0.025, 0.13), 3), None);
    }
}
