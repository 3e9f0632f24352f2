//! What a station has heard of the others.

use std::collections::BTreeMap;

use sextant_channel::Position;
use sextant_kernel::StationId;
use sextant_mapper::{HeardAnchor, SectorBearing};
use sextant_sim::Delivery;

use super::belief::Belief;
use super::message::{Beacon, Directions, HeardSector, Message};
use super::patterns::{Patterns, heard_sector};

/// What a station has heard of the others, by station.
#[derive(Debug, Default)]
pub(super) struct Neighbours {
    by_station: BTreeMap<StationId, Neighbour>,
    /// Anchors that others have heard, with their places.
    hearsay: BTreeMap<StationId, Position>,
    /// Where mobile anchors sent beacons before those that were heard: by station, each place once.
    passed: BTreeMap<StationId, Vec<Position>>,
    /// Who has heard this station, where that is, and from which direction.
    reports: BTreeMap<StationId, HeardBy>,
    /// By which strengths tell directions.
    patterns: Patterns,
}

/// A station that has heard this one.
#[derive(Clone, Copy, Debug)]
pub(super) struct HeardBy {
    pub(super) belief: Belief,
    /// The sector of this station that it heard best.
    pub(super) sector: u8,
    /// Its direction in the frame of this station's antenna, if it can tell.
    pub(super) bearing: Option<SectorBearing>,
}

/// What a station has heard of another one.
#[derive(Debug)]
struct Neighbour {
    /// Where it last believed to be.
    belief: Belief,
    is_mobile: bool,
    /// What was heard of it, by the place that it told: one entry unless it moves.
    sightings: Vec<Sighting>,
    /// The iteration in which it last asked for reports.
    asked: Option<u32>,
}

/// What was heard of a station that believes to be at one place.
#[derive(Debug)]
struct Sighting {
    belief: Belief,
    /// The best signal-to-noise ratio (dB), and the sector from which it came.
    best: Option<(f64, u8)>,
    /// The best ratio of each sector (dB).
    strengths: Vec<(u8, f64)>,
    /// What its beacon said of the directions of its sectors; `None` if it has sent no beacon, so that it is no anchor yet.
    beacon: Option<Option<Directions>>,
}

impl Sighting {
    fn note_frame(&mut self, delivery: &Delivery<'_>) {
        let Some(sector) = delivery.sector else { return };
        let snr_db = delivery.snr.map_or(delivery.rssi.0, |snr| snr.0);
        if self.best.is_none_or(|(best_db, _)| snr_db > best_db) {
            self.best = Some((snr_db, sector));
        }
        match self.strengths.iter_mut().find(|(known, _)| *known == sector) {
            Some((_, best_db)) => *best_db = best_db.max(snr_db),
            None => self.strengths.push((sector, snr_db)),
        }
    }

    /// As evidence on the place of the listener; `None` if the sender is no anchor.
    fn evidence(&self, patterns: &Patterns, is_mobile: bool) -> Option<HeardAnchor> {
        let directions = self.beacon.as_ref()?;
        let sector = directions.as_ref().zip(self.best).and_then(|(directions, (_, sector))| {
            heard_sector(directions, sector, patterns.bearing(is_mobile, &self.strengths))
        });
        let Belief { place, covariance } = self.belief;
        Some(HeardAnchor { place, sector, covariance, packets: 1 })
    }
}

impl Neighbours {
    /// Nobody was heard yet.
    pub(super) fn new(patterns: Patterns) -> Self {
        Self { patterns, ..Self::default() }
    }

    /// Takes in a message to the station `own` in iteration `iteration`.
    pub(super) fn hear(
        &mut self,
        message: Message,
        delivery: &Delivery<'_>,
        own: StationId,
        iteration: u32,
        is_mobile: bool,
    ) {
        let belief = *message.belief();
        let neighbour = self.by_station.entry(delivery.from).or_insert_with(|| Neighbour {
            belief,
            is_mobile,
            sightings: Vec::new(),
            asked: None,
        });
        neighbour.belief = belief;
        let sighting = match &message {
            Message::Coordinates { .. } => return,
            Message::Place(_) | Message::Report(..) | Message::Beacon(_) => {
                let known = neighbour.sightings.iter().position(|sighting| sighting.belief == belief);
                let index = known.unwrap_or_else(|| {
                    neighbour.sightings.push(Sighting { belief, best: None, strengths: Vec::new(), beacon: None });
                    neighbour.sightings.len() - 1
                });
                &mut neighbour.sightings[index]
            }
        };
        sighting.note_frame(delivery);
        match message {
            Message::Place(_) => neighbour.asked = Some(iteration),
            Message::Report(_, heard) => {
                if let Some(&HeardSector { sector, bearing, .. }) = heard.iter().find(|heard| heard.station == own) {
                    self.reports.insert(delivery.from, HeardBy { belief, sector, bearing });
                }
            }
            Message::Beacon(Beacon { directions, earlier, others, .. }) => {
                sighting.beacon = Some(directions);
                if !earlier.is_empty() {
                    let passed = self.passed.entry(delivery.from).or_default();
                    let new: Vec<Position> = earlier.into_iter().filter(|place| !passed.contains(place)).collect();
                    passed.extend(new);
                }
                self.hearsay.extend(others.into_iter().filter(|(station, _)| *station != own));
            }
            Message::Coordinates { .. } => {}
        }
    }

    /// The places of the neighbours that stand still (m).
    pub(super) fn places(&self) -> impl Iterator<Item = Position> {
        self.by_station.values().filter(|neighbour| !neighbour.is_mobile).map(|neighbour| neighbour.belief.place)
    }

    /// The stations that asked for reports in `iteration`, with their best sectors.
    pub(super) fn asking(&self, iteration: u32) -> Vec<HeardSector> {
        let best = |(&station, neighbour): (&StationId, &Neighbour)| {
            let sighting = neighbour.sightings.last().filter(|_| neighbour.asked == Some(iteration))?;
            let (_, sector) = sighting.best?;
            let bearing = self.patterns.bearing(neighbour.is_mobile, &sighting.strengths);
            Some(HeardSector { station, sector, bearing })
        };
        self.by_station.iter().filter_map(best).collect()
    }

    /// The stations that asked in `iteration`, with their places.
    pub(super) fn asking_places(&self, iteration: u32) -> impl Iterator<Item = (StationId, Position)> {
        let asked = move |neighbour: &Neighbour| neighbour.asked == Some(iteration);
        self.by_station
            .iter()
            .filter(move |(_, neighbour)| asked(neighbour))
            .map(|(&station, neighbour)| (station, neighbour.belief.place))
    }

    /// Who has heard this station.
    pub(super) fn reports(&self) -> impl Iterator<Item = &HeardBy> {
        self.reports.values()
    }

    /// The anchors heard, as evidence on the place of this station.
    pub(super) fn evidence(&self) -> Vec<HeardAnchor> {
        let of_neighbour = |neighbour: &Neighbour| {
            let evidence = |sighting: &Sighting| sighting.evidence(&self.patterns, neighbour.is_mobile);
            neighbour.sightings.iter().filter_map(evidence).collect::<Vec<_>>()
        };
        self.by_station.values().flat_map(of_neighbour).collect()
    }

    /// The anchors of which others have told, and the earlier places of mobile anchors, that this station has not heard.
    pub(super) fn silent(&self) -> Vec<HeardAnchor> {
        let is_silent = |station: &StationId| !self.by_station.contains_key(station);
        let silent = self.hearsay.iter().filter(|(station, _)| is_silent(station)).map(|(_, &place)| place);
        let missed = self.passed.iter().flat_map(|(station, passed)| {
            let heard = self.by_station.get(station).map_or(&[][..], |neighbour| &neighbour.sightings);
            let was_heard = move |place: &Position| heard.iter().any(|sighting| sighting.belief.place == *place);
            passed.iter().copied().filter(move |place| !was_heard(place))
        });
        let evidence = |place| HeardAnchor { place, sector: None, covariance: None, packets: 1 };
        silent.chain(missed).map(evidence).collect()
    }

    /// Number of places from which mobile anchors were heard.
    pub(super) fn mobile_sightings(&self) -> usize {
        self.by_station
            .values()
            .filter(|neighbour| neighbour.is_mobile)
            .map(|neighbour| neighbour.sightings.len())
            .sum()
    }

    /// Number of anchors heard that stand still.
    pub(super) fn anchors(&self) -> usize {
        let is_anchor = |neighbour: &&Neighbour| {
            !neighbour.is_mobile && neighbour.sightings.iter().any(|sighting| sighting.beacon.is_some())
        };
        self.by_station.values().filter(is_anchor).count()
    }

    /// Memory of the tables (octets), each entry packed as in the messages.
    pub(super) fn octets(&self) -> usize {
        let keeps_all = self.patterns.nodes.is_some() || self.patterns.robots.is_some();
        let sighting = |sighting: &Sighting| {
            let directions = sighting.beacon.as_ref().and_then(Option::as_ref);
            // Best sector with its ratio, or all of them, and the directions.
            let ratios = if keeps_all { sighting.strengths.len() } else { 1 };
            sighting.belief.octets() + 2 * ratios + directions.map_or(0, Directions::octets)
        };
        let neighbour = |neighbour: &Neighbour| {
            4 + neighbour.belief.octets() + neighbour.sightings.iter().map(sighting).sum::<usize>()
        };
        let reports =
            self.reports.values().map(|by| 5 + 3 * usize::from(keeps_all) + by.belief.octets()).sum::<usize>();
        let passed = self.passed.values().map(|places| 4 + 12 * places.len()).sum::<usize>();
        self.by_station.values().map(neighbour).sum::<usize>() + 16 * self.hearsay.len() + passed + reports
    }
}
