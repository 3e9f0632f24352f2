//! Receptions as columns, so that values that most logs do not have take no memory.

use sextant_kernel::NodeId;

use super::Reception;

/// What was heard, without the nodes: each column has one value per reception.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct ReceptionColumns {
    pub(super) stops: Vec<u32>,
    /// Packets received and sent.
    pub(super) packets: Column<Packets>,
    pub(super) sectors: Column<Option<u8>>,
    pub(super) strengths: Column<Level>,
    /// Signal-to-noise ratios that nodes reported.
    pub(super) ratios: Column<Level>,
}

impl ReceptionColumns {
    /// Whether some reception is not one packet received of one.
    pub(super) fn has_counts(&self) -> bool {
        self.packets.0.iter().any(|&packets| packets != packets.at_least_one())
    }

    /// The same with each slot as one packet.
    pub(super) fn at_least_one(&self) -> Self {
        let mut packets = Column(self.packets.0.iter().map(|packets| packets.at_least_one()).collect());
        if packets.0.iter().all(|&slot| slot == Packets::default()) {
            packets = Column::default();
        }
        Self { packets, ..self.clone() }
    }

    pub(super) fn len(&self) -> usize {
        self.stops.len()
    }

    pub(super) fn push(&mut self, reception: &Reception) {
        let &Reception { node: _, stop, received, sent, sector, rssi_dbm, snr_db } = reception;
        let before = self.stops.len();
        self.stops.push(stop);
        self.packets.push(before, Packets { received, sent });
        self.sectors.push(before, sector);
        self.strengths.push(before, Level::new(rssi_dbm));
        self.ratios.push(before, Level::new(snr_db));
    }

    /// Makes the column of sectors, if no reception names one.
    pub(super) fn fill_sectors(&mut self) {
        let len = self.len();
        self.sectors.0.resize(len, None);
    }

    /// The reception at `at`, which belongs to `node`.
    pub(super) fn get(&self, node: NodeId, at: usize) -> Reception {
        let Packets { received, sent } = self.packets.get(at);
        Reception {
            node,
            stop: self.stops[at],
            received,
            sent,
            sector: self.sectors.get(at),
            rssi_dbm: self.strengths.get(at).value(),
            snr_db: self.ratios.get(at).value(),
        }
    }

    /// Moves each reception to the index that `destinations` gives, one column after the other, so that
    /// at most one column is in memory twice.
    pub(super) fn scatter<I: Iterator<Item = usize>>(&mut self, destinations: impl Fn() -> I) {
        scatter(&mut self.stops, destinations());
        scatter(&mut self.packets.0, destinations());
        scatter(&mut self.sectors.0, destinations());
        scatter(&mut self.strengths.0, destinations());
        scatter(&mut self.ratios.0, destinations());
    }

    /// Puts the receptions from `start` on in the order of the indices `order`.
    pub(super) fn gather(&mut self, start: usize, order: &[usize]) {
        gather(&mut self.stops, start, order);
        gather(&mut self.packets.0, start, order);
        gather(&mut self.sectors.0, start, order);
        gather(&mut self.strengths.0, start, order);
        gather(&mut self.ratios.0, start, order);
    }

    pub(super) fn shrink_to_fit(&mut self) {
        self.stops.shrink_to_fit();
        self.packets.0.shrink_to_fit();
        self.sectors.0.shrink_to_fit();
        self.strengths.0.shrink_to_fit();
        self.ratios.0.shrink_to_fit();
    }
}

/// Moves each value to the index that `destinations` gives for it.
pub(super) fn scatter<T: Copy + Default>(values: &mut Vec<T>, destinations: impl Iterator<Item = usize>) {
    let mut moved = vec![T::default(); values.len()];
    for (&value, destination) in values.iter().zip(destinations) {
        moved[destination] = value;
    }
    *values = moved;
}

fn gather<T: Copy>(values: &mut [T], start: usize, order: &[usize]) {
    if !values.is_empty() {
        let ordered: Vec<T> = order.iter().map(|&at| values[at]).collect();
        values[start..start + order.len()].copy_from_slice(&ordered);
    }
}

/// A column; while it is empty, every reception has the default value.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Column<T>(Vec<T>);

impl<T: Copy + Default + PartialEq> Column<T> {
    /// Appends `value` to a column of `before` receptions.
    fn push(&mut self, before: usize, value: T) {
        if self.0.is_empty() {
            if value == T::default() {
                return;
            }
            self.0.resize(before, T::default());
        }
        self.0.push(value);
    }

    fn get(&self, at: usize) -> T {
        self.0.get(at).copied().unwrap_or_default()
    }

    /// The values of the receptions `range`; `None` if all receptions of the log have the default value.
    pub(super) fn slice(&self, range: std::ops::Range<usize>) -> Option<&[T]> {
        self.0.get(range).filter(|_| !self.0.is_empty())
    }
}

/// Number of packets received and number of packets sent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Packets {
    pub(super) received: u32,
    pub(super) sent: u32,
}

impl Packets {
    /// One packet, received if any packet was; no packet if none was sent.
    fn at_least_one(self) -> Self {
        Self { received: self.received.min(1), sent: self.sent.min(1) }
    }
}

impl Default for Packets {
    fn default() -> Self {
        Self { received: 1, sent: 1 }
    }
}

/// The bits of a level (dB or dBm); the bits of NaN if it was not measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Level(u64);

impl Level {
    fn new(value: Option<f64>) -> Self {
        value.filter(|value| !value.is_nan()).map_or(Self::default(), |value| Self(value.to_bits()))
    }

    fn value(self) -> Option<f64> {
        Some(f64::from_bits(self.0)).filter(|value| !value.is_nan())
    }
}

impl Default for Level {
    fn default() -> Self {
        Self(f64::NAN.to_bits())
    }
}
