//! Who listens in which slot, and who is awake on each channel.

use std::collections::BTreeMap;

use sextant_kernel::{SimTime, StationId};
use sextant_mac::tsch::{Asn, Schedule};

/// Who listens in which slot, and who is awake on each channel.
pub(super) struct Listeners {
    /// For each slotframe its length, and the stations that listen in each of its slots.
    slotframes: Vec<(u16, BTreeMap<u16, Vec<StationId>>)>,
    /// By place of the channel in the sequence.
    awake: Vec<Awake>,
}

/// The stations that were woken for frames on a channel.
#[derive(Default)]
pub(super) struct Awake {
    /// Frames on air.
    pub(super) frames: u32,
    pub(super) stations: Vec<StationId>,
    /// When stations were last woken, and for which slot.
    pub(super) woken: Option<(SimTime, Asn)>,
}

impl Listeners {
    pub(super) fn new(channels: usize) -> Self {
        let awake = std::iter::repeat_with(Awake::default).take(channels).collect();
        Self { slotframes: Vec::new(), awake }
    }

    /// A station follows a schedule from now on.
    pub(super) fn add(&mut self, station: StationId, schedule: &Schedule) {
        for cell in schedule.listening() {
            let handle = usize::from(cell.slotframe.handle);
            while self.slotframes.len() <= handle {
                self.slotframes.push((1, BTreeMap::new()));
            }
            let (length, slots) = &mut self.slotframes[handle];
            *length = cell.slotframe.length;
            let stations = slots.entry(cell.timeslot).or_default();
            if let Err(place) = stations.binary_search(&station) {
                stations.insert(place, station);
            }
        }
    }

    /// A station follows its schedule no more.
    pub(super) fn remove(&mut self, station: StationId, schedule: &Schedule) {
        for cell in schedule.listening() {
            if let Some((_, slots)) = self.slotframes.get_mut(usize::from(cell.slotframe.handle))
                && let Some(stations) = slots.get_mut(&cell.timeslot)
                && let Ok(place) = stations.binary_search(&station)
            {
                stations.remove(place);
            }
        }
    }

    /// The stations that listen in a slot, some of them more than once: by slotframe, and then by station.
    pub(super) fn at(&self, asn: Asn) -> impl Iterator<Item = StationId> + '_ {
        self.slotframes.iter().flat_map(move |(length, slots)| {
            let timeslot = u16::try_from(asn.0 % u64::from(*length)).expect("below a length");
            slots.get(&timeslot).into_iter().flatten().copied()
        })
    }

    /// The stations that are awake on a channel.
    pub(super) fn awake(&mut self, place: usize) -> &mut Awake {
        &mut self.awake[place]
    }
}
