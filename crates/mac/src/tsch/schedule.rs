//! The schedule of a station: its cells, and in which slots they come.

use sextant_kernel::StationId;

use super::{Asn, Autonomous, Cell, CellOptions, CellPeer, Orchestra};

/// How the cell to any other station is found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rule {
    /// By Orchestra.
    Orchestra(Orchestra),
    /// By its address, as long as no cell to it is listed.
    Autonomous(Autonomous),
}

/// The cells of a station.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Schedule {
    /// Those that it has whatever it sends, by slotframe.
    cells: Vec<Cell>,
    /// How the cell to any other station is found, if there is a rule.
    rule: Option<Rule>,
}

/// A cell in which a station listens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Heard {
    /// What its channel has beyond the number of the slot.
    pub channel_offset: u16,
    /// Whether what is heard in it corrects the clock.
    pub is_timekeeping: bool,
}

impl Schedule {
    /// The schedule with these cells.
    #[must_use]
    pub fn new(mut cells: Vec<Cell>) -> Self {
        cells.sort_by_key(|cell| (cell.slotframe, cell.timeslot));
        Self { cells, rule: None }
    }

    /// The same, in which a rule gives the cells to other stations.
    #[must_use]
    pub fn with_rule(self, rule: Rule) -> Self {
        Self { rule: Some(rule), ..self }
    }

    /// The same with further cells.
    #[must_use]
    pub fn with_cells(self, further: impl Iterator<Item = Cell>) -> Self {
        let Self { mut cells, rule } = self;
        cells.extend(further);
        Self { rule, ..Self::new(cells) }
    }

    /// The cells that the station has whatever it sends.
    #[must_use]
    pub fn cells(&self) -> &[Cell] {
        &self.cells
    }

    /// The cells in which frames to a station may go: those to it alone, or those to all if there are none.
    pub fn cells_to(&self, peer: StationId) -> impl Iterator<Item = Cell> + '_ {
        let is_listed = self.sending().any(|cell| cell.peer == CellPeer::Station(peer));
        let by_rule = match &self.rule {
            Some(Rule::Orchestra(rule)) => rule.cell_to(peer),
            Some(Rule::Autonomous(rule)) if !is_listed => rule.cell_to(peer),
            Some(Rule::Autonomous(_)) | None => None,
        };
        let wanted = if is_listed || by_rule.is_some() { CellPeer::Station(peer) } else { CellPeer::All };
        by_rule.into_iter().chain(self.sending().filter(move |cell| cell.peer == wanted))
    }

    /// The cells in which frames to all may go.
    pub fn cells_to_all(&self) -> impl Iterator<Item = Cell> + '_ {
        self.sending().filter(|cell| cell.peer == CellPeer::All)
    }

    /// The cells in which enhanced beacons may go: their own, or those to all if there are none.
    pub fn beacon_cells(&self) -> impl Iterator<Item = Cell> + '_ {
        let has_own = self.sending().any(|cell| cell.peer == CellPeer::Beacons);
        let wanted = if has_own { CellPeer::Beacons } else { CellPeer::All };
        self.sending().filter(move |cell| cell.peer == wanted)
    }

    fn sending(&self) -> impl Iterator<Item = Cell> + '_ {
        self.cells.iter().copied().filter(Cell::sends)
    }

    /// The cells in which the station listens.
    pub fn listening(&self) -> impl Iterator<Item = &Cell> {
        self.cells.iter().filter(|cell| cell.listens())
    }

    /// The cell in which the station listens in a slot, if it sends nothing: that of the slotframe with the lowest number.
    #[must_use]
    #[inline]
    pub fn heard_at(&self, asn: Asn) -> Option<Heard> {
        let cell = self.listening().find(|cell| cell.is_at(asn))?;
        let is_timekeeping = cell.options.has(CellOptions::TIMEKEEPING);
        Some(Heard { channel_offset: cell.channel_offset, is_timekeeping })
    }

    /// The number of slots from `from` up to but not including `until` in which the station listens if it sends nothing.
    /// Slots with cells of several slotframes count once (inclusion and exclusion over the slotframes).
    #[must_use]
    pub fn listens_within(&self, from: Asn, until: Asn) -> u64 {
        if until <= from {
            return 0;
        }
        let mut slotframes: Vec<(u8, Vec<Residue>)> = Vec::new();
        for cell in self.listening() {
            let residue = Residue { at: cell.timeslot.into(), length: cell.slotframe.length.into() };
            match slotframes.last_mut() {
                Some((handle, residues)) if *handle == cell.slotframe.handle => {
                    if !residues.contains(&residue) {
                        residues.push(residue);
                    }
                }
                _ => slotframes.push((cell.slotframe.handle, vec![residue])),
            }
        }
        let whole = Residue { at: 0, length: 1 };
        let sum = union_sum(&slotframes, whole, 1, from.0, until.0);
        u64::try_from(sum).expect("a number of slots")
    }
}

/// The slots whose number has the remainder `at` when divided by `length`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Residue {
    at: u64,
    length: u64,
}

impl Residue {
    /// The slots that both have (Chinese remainders); `None` if there are none.
    fn and(self, other: Self) -> Option<Self> {
        let mut gcd = self.length;
        let mut rest = other.length;
        while rest > 0 {
            (gcd, rest) = (rest, gcd % rest);
        }
        let length = self.length / gcd * other.length;
        // Lengths of slotframes are small: at most so many steps as the shorter one has slots.
        let (long, short) = if self.length > other.length { (self, other) } else { (other, self) };
        let steps = (0..short.length / gcd).map(|step| long.at + step * long.length);
        steps.into_iter().find(|at| at % short.length == short.at % short.length).map(|at| Self { at, length })
    }

    /// How many of them are from `from` up to but not including `until`.
    fn count(self, from: u64, until: u64) -> i128 {
        let below = |end: u64| if end > self.at { (end - self.at).div_ceil(self.length) } else { 0 };
        i128::from(below(until)) - i128::from(below(from))
    }
}

/// The number of slots in any of the slotframes, among the slots `common`: inclusion and exclusion.
fn union_sum(slotframes: &[(u8, Vec<Residue>)], common: Residue, sign: i128, from: u64, until: u64) -> i128 {
    let mut sum = 0;
    for (i, (_, residues)) in slotframes.iter().enumerate() {
        for residue in residues.iter().filter_map(|residue| residue.and(common)) {
            sum += sign * residue.count(from, until);
            sum += union_sum(&slotframes[i + 1..], residue, -sign, from, until);
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::super::Slotframe;
    use super::*;

    fn cell(handle: u8, length: u16, timeslot: u16, options: CellOptions, peer: CellPeer) -> Cell {
        Cell { slotframe: Slotframe { handle, length }, timeslot, channel_offset: handle.into(), options, peer }
    }

    const BOTH: CellOptions = CellOptions::TRANSMIT.and(CellOptions::RECEIVE);

    #[test]
    fn slots_with_cells_are_counted_as_one_would_count_them_one_by_one() {
        let listens = |handle, length, timeslot| cell(handle, length, timeslot, CellOptions::RECEIVE, CellPeer::All);
        for cells in [
            vec![listens(0, 101, 0)],
            vec![listens(0, 397, 5), listens(0, 397, 77), listens(1, 17, 3), listens(2, 31, 0)],
            // Lengths with a common factor: some of the cells never meet.
            vec![listens(0, 12, 3), listens(1, 18, 4), listens(1, 18, 9), listens(2, 10, 9)],
            vec![cell(0, 7, 1, CellOptions::TRANSMIT, CellPeer::All)],
        ] {
            let schedule = Schedule::new(cells);
            for (from, until) in [(0, 20_000), (13, 14), (5, 5), (1234, 9876), (9, 3)] {
                let counted = (from..until).filter(|&asn| schedule.heard_at(Asn(asn)).is_some()).count() as u64;
                assert_eq!(schedule.listens_within(Asn(from), Asn(until)), counted, "{schedule:?}: {from}..{until}");
            }
        }
    }

    #[test]
    fn the_slotframe_with_the_lowest_number_counts() {
        let schedule = Schedule::new(vec![
            cell(2, 5, 0, CellOptions::RECEIVE, CellPeer::All),
            cell(1, 3, 0, CellOptions::RECEIVE, CellPeer::All),
        ]);
        let offset = |asn| schedule.heard_at(Asn(asn)).map(|heard| heard.channel_offset);
        assert_eq!([0, 1, 3, 5, 15].map(offset), [Some(1), None, Some(1), Some(2), Some(1)]);
    }

    #[test]
    fn a_station_with_cells_of_its_own_gets_no_frames_in_those_to_all() {
        let own = cell(0, 10, 4, CellOptions::TRANSMIT, CellPeer::Station(StationId(3)));
        let all = cell(0, 10, 0, BOTH.and(CellOptions::SHARED), CellPeer::All);
        let schedule = Schedule::new(vec![own, all]);
        let to = |station| schedule.cells_to(StationId(station)).collect::<Vec<_>>();
        assert_eq!((to(3), to(4)), (vec![own], vec![all]));
        assert_eq!(schedule.cells_to_all().collect::<Vec<_>>(), [all]);
        assert_eq!(schedule.beacon_cells().collect::<Vec<_>>(), [all]);
    }
}
