//! A calendar queue (Brown 1988, "Calendar queues: a fast O(1) priority queue implementation for the
//! simulation event set problem"): days of equal width, a year of as many days as there are about events.

use super::{Entry, Order};

/// A calendar queue. A day is about three mean gaps of the next 25 events wide; its width is a power of two.
pub struct Calendar {
    /// The days. Each is sorted; its earliest entry is the last.
    days: Vec<Vec<Entry>>,
    /// Width of a day: 2^shift ns.
    shift: u32,
    today: u64,
    len: usize,
}

impl Default for Calendar {
    fn default() -> Self {
        Self { days: vec![Vec::new(); 2], shift: 20, today: 0, len: 0 }
    }
}

impl Calendar {
    fn day_of(&self, entry: &Entry) -> u64 {
        entry.time.as_nanos() >> self.shift
    }

    #[expect(clippy::cast_possible_truncation, reason = "reduced to the length of a Vec")]
    fn place(&self, day: u64) -> usize {
        (day & (self.days.len() as u64 - 1)) as usize
    }

    fn write(&mut self, entry: Entry) {
        let place = self.place(self.day_of(&entry));
        let day = &mut self.days[place];
        let at = day.iter().rposition(|other| entry < *other).map_or(0, |before| before + 1);
        day.insert(at, entry);
        self.len += 1;
    }

    fn take(&mut self) -> Option<Entry> {
        if self.len == 0 {
            return None;
        }
        self.len -= 1;
        for _ in 0..self.days.len() {
            let place = self.place(self.today);
            if self.days[place].last().is_some_and(|entry| self.day_of(entry) <= self.today) {
                return self.days[place].pop();
            }
            self.today += 1;
        }
        // There is no event within a year: search all days.
        let next = *self.days.iter().filter_map(|day| day.last()).min()?;
        self.today = self.day_of(&next);
        let place = self.place(self.today);
        self.days[place].pop()
    }

    fn resize(&mut self, days: usize) {
        let sample: Vec<Entry> = (0..25).map_while(|_| self.take()).collect();
        let gaps = || sample.windows(2).map(|pair| (pair[1].time - pair[0].time).as_nanos());
        let count = (sample.len() as u128).saturating_sub(1).max(1);
        let mean = gaps().sum::<u128>() / count;
        let (sum, count) =
            gaps().filter(|&gap| gap <= 2 * mean).fold((0, 0), |(sum, count), gap| (sum + gap, count + 1));
        self.shift = (3 * sum / count.max(1)).max(1).ilog2();
        self.today = sample.first().map_or(0, |entry| self.day_of(entry));
        self.len = 0;
        let old = std::mem::replace(&mut self.days, vec![Vec::new(); days]);
        for entry in old.into_iter().flatten().chain(sample) {
            self.write(entry);
        }
    }
}

impl Order for Calendar {
    fn push(&mut self, entry: Entry) {
        self.today = self.today.min(self.day_of(&entry));
        self.write(entry);
        if self.len > 2 * self.days.len() {
            self.resize(2 * self.days.len());
        }
    }

    fn pop(&mut self) -> Option<Entry> {
        let entry = self.take()?;
        if 2 * self.len < self.days.len() && self.days.len() > 2 {
            self.resize(self.days.len() / 2);
        }
        Some(entry)
    }
}
