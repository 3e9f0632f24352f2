//! The messages of maps that are computed in the nodes, as octets.

use std::f64::consts::{PI, TAU};

use sextant_channel::{Position, Wedge};
use sextant_kernel::StationId;
use sextant_mapper::SectorBearing;

use super::belief::Belief;
use crate::octets::{MessageError, Reader, put, put_place};

const VERSION: u8 = 1;

const PLACE: u8 = 1;
const REPORT: u8 = 2;
const BEACON: u8 = 3;
const COORDINATES: u8 = 4;

const HAS_COVARIANCE: u8 = 1;
const HAS_DIRECTIONS: u8 = 2;
const HAS_OTHERS: u8 = 4;
const IS_BAD: u8 = 8;
const HAS_EARLIER: u8 = 16;
const HAS_BEARINGS: u8 = 32;

/// Octets before the place.
const HEADER_OCTETS: usize = 2;
/// Octets of an entry of a REPORT, without and with bearings.
const HEARD_OCTETS: [usize; 2] = [5, 8];
/// Steps of the standard deviation of a bearing (rad): a quarter of a degree.
const SIGMA_STEP_RAD: f64 = PI / 720.0;
/// Octets of an anchor that a BEACON passes on.
const OTHER_OCTETS: usize = 16;

/// A message, as octets in this layout.
///
/// All numbers are little-endian, all lengths in metres, all angles in radians; `f32` is IEEE 754 binary32. The sender
/// is the transmitter address of the frame, and the sector in which a frame was sent is named by the frame.
///
/// | octets | field |
/// | --- | --- |
/// | 1 | version (1) in the high four bits, kind in the low four: 1 PLACE, 2 REPORT, 3 BEACON, 4 COORDINATES |
/// | 1 | flags: bit 0 covariance, bit 1 directions, bit 2 other anchors, bit 3 the coordinates are bad, bit 4 earlier places, bit 5 bearings |
/// | 12 | place of the sender: x, y, z as `f32` |
/// | 24 | with bit 0: covariance of the place as six `f32`: xx, xy, xz, yy, yz, zz (m²) |
///
/// Then in a REPORT, for each station heard:
///
/// | octets | field |
/// | --- | --- |
/// | 4 | station |
/// | 1 | its sector that was heard best |
/// | 2 | with bit 5: azimuth of the sender from the middle of its sector 0, in steps of 2π/65536 |
/// | 1 | with bit 5: standard deviation of that azimuth in steps of a quarter of a degree, rounded up; 0: only the sector is known |
///
/// In a BEACON with bit 1:
///
/// | octets | field |
/// | --- | --- |
/// | 4 | azimuth of the boresight of sector 0, counterclockwise from x |
/// | 4 | standard deviation of that azimuth |
/// | 1 | sectors in a ring |
/// | 1 | rings |
/// | 8 | for each ring: lowest and highest elevation |
///
/// In a BEACON with bit 4, for a mobile anchor:
///
/// | octets | field |
/// | --- | --- |
/// | 1 | number of earlier places |
/// | 12 | each of them: where it sent the beacons before this one |
///
/// In a BEACON with bit 2, up to the end, anchors that the sender has heard:
///
/// | octets | field |
/// | --- | --- |
/// | 4 | station |
/// | 12 | its place |
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Message {
    /// An anchor that does not know the directions of its sectors asks other anchors in which of them they hear it.
    Place(Belief),
    /// The answer of an anchor to those that asked.
    Report(Belief, Vec<HeardSector>),
    /// An anchor tells its place and the directions of its sectors.
    Beacon(Beacon),
    /// A node tells where it believes to be.
    Coordinates {
        /// Where.
        belief: Belief,
        /// Whether the coordinates do not agree with those of its neighbours.
        is_bad: bool,
    },
}

/// A station, and its sector that was heard best.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HeardSector {
    /// The station that was heard.
    pub station: StationId,
    /// Its sector.
    pub sector: u8,
    /// The direction of the listener in the frame of the station's antenna, if the strengths of several sectors tell it.
    pub bearing: Option<SectorBearing>,
}

/// What an anchor tells.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Beacon {
    /// Where it believes to be.
    pub belief: Belief,
    /// The directions of its sectors, if it has sectors and knows them.
    pub directions: Option<Directions>,
    /// Where a mobile anchor sent its beacons before this one (m), at most 255 places.
    pub earlier: Vec<Position>,
    /// Other anchors with their places (m).
    pub others: Vec<(StationId, Position)>,
}

/// The directions of the sectors of an antenna: rings of equal sectors. Sector `i` of ring `j` is number
/// `j · sectors + i`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Directions {
    /// Azimuth of the boresight of sector 0, counterclockwise from x (rad).
    pub azimuth_rad: f64,
    /// Its standard deviation (rad).
    pub azimuth_sigma_rad: f64,
    /// Sectors in a ring.
    pub sectors: u8,
    /// Lowest and highest elevation of each ring (rad).
    pub rings: Vec<[f64; 2]>,
}

impl Message {
    /// Where the sender believes to be.
    #[must_use]
    pub(crate) fn belief(&self) -> &Belief {
        match self {
            Self::Place(belief) | Self::Report(belief, _) | Self::Coordinates { belief, .. } => belief,
            Self::Beacon(beacon) => &beacon.belief,
        }
    }

    /// Replaces the content of `octets` with the message.
    pub(crate) fn write(&self, octets: &mut Vec<u8>) {
        let (kind, flags) = match self {
            Self::Place(_) => (PLACE, 0),
            Self::Report(_, heard) => (REPORT, if has_bearings(heard) { HAS_BEARINGS } else { 0 }),
            Self::Beacon(beacon) => {
                let flag = |flag, is_set| if is_set { flag } else { 0 };
                let directions = flag(HAS_DIRECTIONS, beacon.directions.is_some());
                let earlier = flag(HAS_EARLIER, !beacon.earlier.is_empty());
                (BEACON, directions | earlier | flag(HAS_OTHERS, !beacon.others.is_empty()))
            }
            Self::Coordinates { is_bad, .. } => (COORDINATES, if *is_bad { IS_BAD } else { 0 }),
        };
        let belief = self.belief();
        let covariance = if belief.covariance.is_some() { HAS_COVARIANCE } else { 0 };
        octets.clear();
        octets.extend([VERSION << 4 | kind, flags | covariance]);
        put_place(octets, belief.place);
        if let Some([[xx, xy, xz], [_, yy, yz], [_, _, zz]]) = belief.covariance {
            [xx, xy, xz, yy, yz, zz].into_iter().for_each(|entry| put(octets, entry));
        }
        match self {
            Self::Place(_) | Self::Coordinates { .. } => {}
            Self::Report(_, heard) => {
                let has_bearings = has_bearings(heard);
                for HeardSector { station, sector, bearing } in heard {
                    octets.extend(station.0.to_le_bytes());
                    octets.push(*sector);
                    if has_bearings {
                        octets.extend(bearing_octets(*bearing));
                    }
                }
            }
            Self::Beacon(Beacon { directions, earlier, others, .. }) => {
                if let Some(Directions { azimuth_rad, azimuth_sigma_rad, sectors, rings }) = directions {
                    put(octets, *azimuth_rad);
                    put(octets, *azimuth_sigma_rad);
                    octets.extend([*sectors, u8::try_from(rings.len()).expect("at most 255 rings")]);
                    rings.iter().flatten().for_each(|&elevation_rad| put(octets, elevation_rad));
                }
                if !earlier.is_empty() {
                    octets.push(u8::try_from(earlier.len()).expect("at most 255 places"));
                    earlier.iter().for_each(|&place| put_place(octets, place));
                }
                for (station, place) in others {
                    octets.extend(station.0.to_le_bytes());
                    put_place(octets, *place);
                }
            }
        }
    }

    /// Reads a message.
    ///
    /// # Errors
    /// If the octets are not a message.
    pub(crate) fn read(octets: &[u8]) -> Result<Self, MessageError> {
        let mut reader = Reader::new(octets);
        let [first, flags] = reader.take("the header")?;
        if first >> 4 != VERSION {
            return Err(MessageError::Version(first >> 4));
        }
        let kind = first & 0xF;
        if !(PLACE..=COORDINATES).contains(&kind) {
            return Err(MessageError::Kind { found: kind, allowed: "1 to 4" });
        }
        let place = reader.place("the place")?;
        let covariance = if flags & HAS_COVARIANCE == 0 {
            None
        } else {
            let mut entry = || reader.number("the covariance");
            let (xx, xy, xz, yy, yz, zz) = (entry()?, entry()?, entry()?, entry()?, entry()?, entry()?);
            Some([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        };
        let belief = Belief { place, covariance };
        let message = match kind {
            PLACE => Self::Place(belief),
            REPORT => {
                let has_bearings = flags & HAS_BEARINGS != 0;
                let mut heard = Vec::with_capacity(reader.left() / HEARD_OCTETS[usize::from(has_bearings)]);
                while reader.left() > 0 {
                    let station = reader.station("a report")?;
                    let [sector] = reader.take("a report")?;
                    let bearing = if has_bearings { bearing_of(reader.take("a bearing")?) } else { None };
                    heard.push(HeardSector { station, sector, bearing });
                }
                Self::Report(belief, heard)
            }
            BEACON => {
                let directions = (flags & HAS_DIRECTIONS != 0).then(|| directions(&mut reader)).transpose()?;
                let mut earlier = Vec::new();
                if flags & HAS_EARLIER != 0 {
                    let [count] = reader.take("the earlier places")?;
                    for _ in 0..count {
                        earlier.push(reader.place("the earlier places")?);
                    }
                }
                let mut others = Vec::new();
                if flags & HAS_OTHERS != 0 {
                    others.reserve(reader.left() / OTHER_OCTETS);
                    while reader.left() > 0 {
                        others.push((reader.station("another anchor")?, reader.place("another anchor")?));
                    }
                }
                Self::Beacon(Beacon { belief, directions, earlier, others })
            }
            _ => Self::Coordinates { belief, is_bad: flags & IS_BAD != 0 },
        };
        reader.end()?;
        Ok(message)
    }

    /// The reports about `heard`, in as many messages of at most `octets` as they need. Without any, none.
    pub(crate) fn reports(belief: Belief, heard: &[HeardSector], octets: usize) -> impl Iterator<Item = Self> {
        let entry = HEARD_OCTETS[usize::from(has_bearings(heard))];
        let per_message = (octets.saturating_sub(HEADER_OCTETS + belief.octets()) / entry).max(1);
        heard.chunks(per_message).map(move |part| Self::Report(belief, part.to_vec()))
    }
}

impl Beacon {
    /// Number of other anchors for which a message of at most `octets` has room beside the rest; at least one.
    #[must_use]
    pub(crate) fn room_for_others(&self, octets: usize) -> usize {
        let directions = self.directions.as_ref().map_or(0, Directions::octets);
        let earlier = if self.earlier.is_empty() { 0 } else { 1 + 12 * self.earlier.len() };
        (octets.saturating_sub(HEADER_OCTETS + self.belief.octets() + directions + earlier) / OTHER_OCTETS).max(1)
    }
}

impl Directions {
    /// Octets that they take in a message.
    pub(super) fn octets(&self) -> usize {
        10 + 8 * self.rings.len()
    }

    /// The directions of sector number `sector`; `None` if there is no such sector.
    #[must_use]
    pub(crate) fn wedge(&self, sector: u8) -> Option<Wedge> {
        if self.sectors == 0 {
            return None;
        }
        let &[low_rad, high_rad] = self.rings.get(usize::from(sector / self.sectors))?;
        let width_rad = TAU / f64::from(self.sectors);
        let middle_rad = self.azimuth_rad + f64::from(sector % self.sectors) * width_rad;
        Some(Wedge {
            azimuth_from_rad: middle_rad - 0.5 * width_rad,
            azimuth_width_rad: width_rad,
            elevation_rad: [low_rad, high_rad],
        })
    }
}

/// Whether a report tells bearings.
fn has_bearings(heard: &[HeardSector]) -> bool {
    heard.iter().any(|heard| heard.bearing.is_some())
}

/// A bearing as octets.
fn bearing_octets(bearing: Option<SectorBearing>) -> [u8; 3] {
    let Some(SectorBearing { azimuth_rad, sigma_rad }) = bearing else { return [0; 3] };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most 65536")]
    let [low, high, ..] = ((azimuth_rad.rem_euclid(TAU) / TAU * 65536.0).round() as u32).to_le_bytes();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 to 255")]
    let sigma = (sigma_rad / SIGMA_STEP_RAD - 1e-9).ceil().clamp(1.0, 255.0) as u8;
    [low, high, sigma]
}

fn bearing_of([low, high, sigma]: [u8; 3]) -> Option<SectorBearing> {
    let azimuth_rad = f64::from(i16::from_le_bytes([low, high])) / 65536.0 * TAU;
    (sigma > 0).then(|| SectorBearing { azimuth_rad, sigma_rad: f64::from(sigma) * SIGMA_STEP_RAD })
}

/// The directions that come next.
fn directions(reader: &mut Reader<'_>) -> Result<Directions, MessageError> {
    let part = "the directions";
    let (azimuth_rad, azimuth_sigma_rad) = (reader.number(part)?, reader.number(part)?);
    let [sectors, rings] = reader.take(part)?;
    let ring = |_| Ok([reader.number(part)?, reader.number(part)?]);
    let rings = (0..rings).map(ring).collect::<Result<_, MessageError>>()?;
    Ok(Directions { azimuth_rad, azimuth_sigma_rad, sectors, rings })
}

#[cfg(test)]
mod tests;
