//! Frames of the sector level sweep as octets (IEEE 802.11ad-2012, 8.3.1.16 to 8.3.1.18 and 8.3.4.1): writer and parser.
//!
//! ```
//! use sextant_kernel::StationId;
//! use sextant_mac::dmg::{Enclosed, MacAddress, SweepBody, SweepFrame, TxSector};
//!
//! let robot = MacAddress::of(StationId(1));
//! let body = SweepBody::Iss { cdown: 0, sector: TxSector::first_antenna(5), total_sectors: 6, rx_antennas: 1 };
//! let frame = SweepFrame { duration_us: 0, to: MacAddress::BROADCAST, from: robot, body };
//! let mut octets = Vec::new();
//! frame.write(Enclosed::Nothing, &mut octets);
//! assert_eq!(octets.len(), 26);
//! assert_eq!(SweepFrame::parse(&octets), Ok(frame));
//! ```

use std::time::Duration;

use super::address::MacAddress;
use super::sector::TxSector;
use super::snr_report::SnrReport;
use super::timing::{SSW_FEEDBACK_OCTETS, SSW_OCTETS, control_airtime};

mod beacon;
mod brp;
mod elements;
#[cfg(test)]
mod tests;

pub use beacon::{MAX_BEACON_PAYLOAD_OCTETS, beacon_octets, beacon_payload, beacon_payload_octets};
pub(crate) use brp::brp_octets;
pub use brp::{MAX_MEASUREMENTS, SectorMeasurement, brp_measurements};

/// Protocol version 0, type control, subtype control frame extension.
const FRAME_CONTROL: u8 = 0x64;
const SSW: u8 = 8;
const SSW_FEEDBACK: u8 = 9;
const SSW_ACK: u8 = 10;
/// Octets before the fields of the sweep: frame control, Duration, RA, TA.
const HEADER_OCTETS: usize = 16;
const FCS_OCTETS: usize = 4;

/// The choice of a sector that a station tells its peer: the best of the peer's transmit sectors, and how well it was
/// heard.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SectorFeedback {
    /// The best transmit sector of the receiver of this frame.
    pub select: TxSector,
    /// SNR at which it was heard.
    pub snr: SnrReport,
    /// Whether the sender asks to be polled.
    pub poll_required: bool,
}

/// Fields about the beam refinement that follows a sector level sweep, as they stand on the air.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BeamRefinement {
    /// The BRP request field (IEEE 802.11ad-2012, 8.4a.4); 0 requests nothing.
    pub request: u32,
    /// The beamformed link maintenance field.
    pub link_maintenance: u8,
}

impl BeamRefinement {
    /// BC-REQ, a bit of the BRP request field.
    const BEAM_COMBINING: u32 = 1 << 7;

    /// The request for a BRP frame with the SNRs of all sectors: BC-REQ asks for beam combining, which begins with it.
    #[must_use]
    pub const fn of_all_sectors() -> Self {
        Self { request: Self::BEAM_COMBINING, link_maintenance: 0 }
    }

    /// Whether the SNRs of all sectors are requested.
    #[must_use]
    pub const fn asks_for_all_sectors(self) -> bool {
        self.request & Self::BEAM_COMBINING != 0
    }
}

/// Content of a frame, by its type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SweepBody {
    /// SSW frame of an initiator sector sweep.
    Iss {
        /// Frames of this sweep that are still to come: 0 to 511.
        cdown: u16,
        /// The sector from which the frame is sent.
        sector: TxSector,
        /// Number of frames of the whole sweep: 0 to 511.
        total_sectors: u16,
        /// DMG antennas with which the initiator receives the answers, 0 to 3. Here 0 says that it expects none.
        rx_antennas: u8,
    },
    /// SSW frame of a responder sector sweep.
    Rss {
        /// Frames of this sweep that are still to come: 0 to 511.
        cdown: u16,
        /// The sector from which the frame is sent.
        sector: TxSector,
        /// The best sector of the initiator.
        feedback: SectorFeedback,
    },
    /// SSW-Feedback frame: the best sector of the responder.
    Feedback {
        /// The choice.
        feedback: SectorFeedback,
        /// Beam refinement.
        refinement: BeamRefinement,
    },
    /// SSW-ACK frame: again the best sector of the initiator.
    Ack {
        /// The choice.
        feedback: SectorFeedback,
        /// Beam refinement.
        refinement: BeamRefinement,
    },
    /// DMG Beacon frame, for all stations, with a payload in vendor specific elements. It belongs to a sweep as an SSW
    /// frame does; no one answers it.
    Beacon {
        /// The clock of the sender at the start of the frame (us).
        timestamp_us: u64,
        /// Frames of this sweep that are still to come: 0 to 511.
        cdown: u16,
        /// The sector from which the frame is sent.
        sector: TxSector,
        /// Number of the payload among those of the sender, modulo 256: the same in all frames that carry it.
        sequence: u8,
        /// Size of the payload (octets), at most [`MAX_BEACON_PAYLOAD_OCTETS`].
        payload_octets: u16,
    },
    /// BRP frame, an Action No Ack frame: the SNRs at which its sender heard sectors of its receiver.
    Brp {
        /// Number of sectors, at most [`MAX_MEASUREMENTS`].
        measurements: u8,
    },
}

/// What stands beside a frame, so that a frame is small.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Enclosed<'a> {
    /// Most frames enclose nothing.
    Nothing,
    /// The payload of a beacon.
    Payload(&'a [u8]),
    /// The measurements of a BRP frame.
    Measurements(&'a [SectorMeasurement]),
}

/// A frame of the sector level sweep. The length of a receive sector sweep (RXSS) is always 0, because receivers are
/// quasi-omnidirectional; flags of the frame control field are 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SweepFrame {
    /// For how long after its end the medium is taken (us).
    pub duration_us: u16,
    /// Receiver (RA). A beacon has no such field and is for all.
    pub to: MacAddress,
    /// Transmitter (TA); the BSSID of a beacon.
    pub from: MacAddress,
    /// Content.
    pub body: SweepBody,
}

/// Why octets are not a valid frame of the sector level sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SweepParseError {
    /// The size is not that of a frame of this type.
    #[error("the {kind} frame has {found} octets; allowed: {allowed}")]
    Size {
        /// Type of the frame.
        kind: &'static str,
        /// Its size (octets).
        found: usize,
        /// The only size (octets).
        allowed: u16,
    },
    /// The frame ends within its header.
    #[error(
        "the frame has {0} octets; allowed: 26 (SSW), 28 (SSW-Feedback, SSW-ACK), 41 to 1023 (DMG Beacon), 44 and more (BRP)"
    )]
    Truncated(usize),
    /// The frame check sequence is wrong.
    #[error("the FCS is {found:#010x}; the octets before it give {computed:#010x}")]
    BadFcs {
        /// The value received.
        found: u32,
        /// The correct value.
        computed: u32,
    },
    /// The frame is no control frame of the extension, no beacon and no action.
    #[error(
        "the frame control field starts with {0:#04x}; allowed: 0x64 (control frame extension), 0x0c (DMG Beacon), 0xe0 \
         (Action No Ack)"
    )]
    Type(u8),
    /// The extension is another one.
    #[error("control frame extension {0} is not of the sector level sweep; allowed: 8, 9, 10")]
    Extension(u8),
    /// A flag of the frame control field is set.
    #[error("the flags of the frame control field are {0:#03x}; allowed: 0")]
    Flags(u8),
    /// The frame asks for a receive sector sweep.
    #[error("the RXSS length is {0}; allowed: 0")]
    ReceiveSweep(u8),
    /// A beacon ends within its fixed fields, or is larger than any frame of the control PHY.
    #[error("the DMG Beacon frame has {0} octets; allowed: 41 to 1023")]
    BeaconSize(usize),
    /// A beacon has a field between its fixed fields and its elements.
    #[error("the DMG Beacon frame has a Clustering Control field; allowed: none")]
    Clustering,
    /// An element is longer than the rest of its frame.
    #[error("the element at octet {at} of the {kind} frame is cut: {left} octets are left of it")]
    CutElement {
        /// Type of the frame.
        kind: &'static str,
        /// Where it begins.
        at: usize,
        /// Octets from there to the FCS.
        left: usize,
    },
    /// A beacon has no element with a payload.
    #[error("the DMG Beacon frame has no element with a payload")]
    NoPayload,
    /// The action is another one.
    #[error("the Action No Ack frame has category {category} and action {action}; allowed: 20 and 1 (BRP)")]
    Action {
        /// Its category.
        category: u8,
        /// The action of that category.
        action: u8,
    },
    /// A BRP frame has not the two elements of a report.
    #[error("the BRP frame has no SNRs of sectors; allowed: elements 153 with SNRs and sector IDs present, and 154")]
    NoMeasurements,
    /// The two elements of a BRP frame do not fit together.
    #[error("the BRP frame has {found} octets of measurements; allowed: {allowed}, 2 for each that it announces")]
    Measurements {
        /// Octets of measurements.
        found: usize,
        /// Octets of those announced.
        allowed: usize,
    },
}

impl SweepFrame {
    /// Size (octets), FCS included.
    #[must_use]
    pub const fn octets(&self) -> u16 {
        match self.body {
            SweepBody::Iss { .. } | SweepBody::Rss { .. } => SSW_OCTETS,
            SweepBody::Feedback { .. } | SweepBody::Ack { .. } => SSW_FEEDBACK_OCTETS,
            SweepBody::Beacon { payload_octets, .. } => beacon_octets(payload_octets),
            SweepBody::Brp { measurements } => brp_octets(measurements),
        }
    }

    /// Time on the air.
    #[must_use]
    pub const fn airtime(&self) -> Duration {
        control_airtime(self.octets())
    }

    /// For how long after its end the medium is taken.
    #[must_use]
    pub fn duration(&self) -> Duration {
        Duration::from_micros(u64::from(self.duration_us))
    }

    /// Replaces the content of `octets` with the frame, FCS included. A buffer that has held a frame before is not
    /// reallocated. Values beyond their fields are cut to them.
    ///
    /// # Panics
    /// If what is enclosed has not the kind and size that the frame says, or more octets or measurements than a frame
    /// carries.
    pub fn write(&self, enclosed: Enclosed<'_>, octets: &mut Vec<u8>) {
        octets.clear();
        match self.body {
            SweepBody::Beacon { timestamp_us, cdown, sector, sequence, payload_octets } => {
                let Enclosed::Payload(payload) = enclosed else { panic!("{enclosed:?} is no payload") };
                assert_eq!(payload.len(), usize::from(payload_octets), "the frame says how large its payload is");
                assert!(payload_octets <= MAX_BEACON_PAYLOAD_OCTETS, "a payload of {payload_octets} octets");
                let fixed = beacon::Fixed { timestamp_us, cdown, sector };
                beacon::write(self, &fixed, sequence, payload, octets);
            }
            SweepBody::Iss { cdown, sector, total_sectors, rx_antennas } => {
                let sweep = u32::from(total_sectors) & 0x1FF | (u32::from(rx_antennas) & 3) << 9;
                self.write_ssw(ssw_field(0, cdown, sector), sweep, octets);
            }
            SweepBody::Rss { cdown, sector, feedback } => {
                self.write_ssw(ssw_field(1, cdown, sector), feedback.to_bits(), octets);
            }
            SweepBody::Feedback { feedback, refinement } => {
                self.write_choice(SSW_FEEDBACK, feedback, refinement, octets);
            }
            SweepBody::Ack { feedback, refinement } => self.write_choice(SSW_ACK, feedback, refinement, octets),
            SweepBody::Brp { measurements } => {
                let Enclosed::Measurements(heard) = enclosed else { panic!("{enclosed:?} are no measurements") };
                assert_eq!(heard.len(), usize::from(measurements), "the frame says how many sectors it reports");
                brp::write(self, heard, octets);
            }
        }
        octets.extend(crc32fast::hash(octets).to_le_bytes());
    }

    /// Writes the header of a control frame.
    fn write_header(&self, extension: u8, octets: &mut Vec<u8>) {
        octets.extend([FRAME_CONTROL, extension]);
        octets.extend(self.duration_us.to_le_bytes());
        octets.extend(self.to.0);
        octets.extend(self.from.0);
    }

    fn write_ssw(&self, ssw: u32, feedback: u32, octets: &mut Vec<u8>) {
        self.write_header(SSW, octets);
        octets.extend(&ssw.to_le_bytes()[..3]);
        octets.extend(&feedback.to_le_bytes()[..3]);
    }

    fn write_choice(&self, extension: u8, choice: SectorFeedback, refinement: BeamRefinement, octets: &mut Vec<u8>) {
        self.write_header(extension, octets);
        octets.extend(&choice.to_bits().to_le_bytes()[..3]);
        octets.extend(refinement.request.to_le_bytes());
        octets.push(refinement.link_maintenance);
    }

    /// Reads a frame, FCS included. Reserved bits are ignored, as the standard says, and so are elements of a beacon or
    /// a BRP frame that are of other kinds. [`beacon_payload`] and [`brp_measurements`] read what is enclosed.
    ///
    /// # Errors
    /// If the octets are not a valid frame of the sector level sweep.
    pub fn parse(octets: &[u8]) -> Result<Self, SweepParseError> {
        let Some((covered, &check)) = octets.split_last_chunk::<FCS_OCTETS>() else {
            return Err(SweepParseError::Truncated(octets.len()));
        };
        let Some((&header, fields)) = covered.split_first_chunk::<HEADER_OCTETS>() else {
            return Err(SweepParseError::Truncated(octets.len()));
        };
        let (found, computed) = (u32::from_le_bytes(check), crc32fast::hash(covered));
        if found != computed {
            return Err(SweepParseError::BadFcs { found, computed });
        }
        if covered[0] == beacon::FRAME_CONTROL {
            return beacon::parse(covered);
        }
        if covered[0] == brp::FRAME_CONTROL {
            return brp::parse(covered);
        }
        let [control, extension, d0, d1, r0, r1, r2, r3, r4, r5, t0, t1, t2, t3, t4, t5] = header;
        if control != FRAME_CONTROL {
            return Err(SweepParseError::Type(control));
        }
        let (flags, extension) = (extension >> 4, extension & 0xF);
        let size = |kind, allowed| SweepParseError::Size { kind, found: octets.len(), allowed };
        let body = match (extension, fields) {
            (SSW, &[s0, s1, s2, f0, f1, f2]) => parse_ssw(bits([s0, s1, s2]), bits([f0, f1, f2]))?,
            (SSW_FEEDBACK | SSW_ACK, &[f0, f1, f2, b0, b1, b2, b3, link_maintenance]) => {
                let feedback = SectorFeedback::from_bits(bits([f0, f1, f2]));
                let request = u32::from_le_bytes([b0, b1, b2, b3]);
                let refinement = BeamRefinement { request, link_maintenance };
                if extension == SSW_FEEDBACK {
                    SweepBody::Feedback { feedback, refinement }
                } else {
                    SweepBody::Ack { feedback, refinement }
                }
            }
            (SSW, _) => return Err(size("SSW", SSW_OCTETS)),
            (SSW_FEEDBACK, _) => return Err(size("SSW-Feedback", SSW_FEEDBACK_OCTETS)),
            (SSW_ACK, _) => return Err(size("SSW-ACK", SSW_FEEDBACK_OCTETS)),
            (other, _) => return Err(SweepParseError::Extension(other)),
        };
        if flags != 0 {
            return Err(SweepParseError::Flags(flags));
        }
        Ok(Self {
            duration_us: u16::from_le_bytes([d0, d1]),
            to: MacAddress([r0, r1, r2, r3, r4, r5]),
            from: MacAddress([t0, t1, t2, t3, t4, t5]),
            body,
        })
    }
}

impl SectorFeedback {
    fn to_bits(self) -> u32 {
        u32::from(self.select.sector) & 0x3F
            | (u32::from(self.select.antenna) & 3) << 6
            | u32::from(self.snr.to_octet()) << 8
            | u32::from(self.poll_required) << 16
    }

    fn from_bits(field: u32) -> Self {
        Self {
            select: TxSector { antenna: low(field >> 6, 3), sector: low(field, 0x3F) },
            snr: SnrReport::from_octet(low(field >> 8, 0xFF)),
            poll_required: field >> 16 & 1 == 1,
        }
    }
}

fn ssw_field(direction: u32, cdown: u16, sector: TxSector) -> u32 {
    direction
        | (u32::from(cdown) & 0x1FF) << 1
        | (u32::from(sector.sector) & 0x3F) << 10
        | (u32::from(sector.antenna) & 3) << 16
}

fn parse_ssw(ssw: u32, feedback: u32) -> Result<SweepBody, SweepParseError> {
    let rxss_length = low(ssw >> 18, 0x3F);
    if rxss_length != 0 {
        return Err(SweepParseError::ReceiveSweep(rxss_length));
    }
    let cdown = nine_bits(ssw >> 1);
    let sector = tx_sector(ssw);
    Ok(if ssw & 1 == 0 {
        let (total_sectors, rx_antennas) = (nine_bits(feedback), low(feedback >> 9, 3));
        SweepBody::Iss { cdown, sector, total_sectors, rx_antennas }
    } else {
        SweepBody::Rss { cdown, sector, feedback: SectorFeedback::from_bits(feedback) }
    })
}

/// The sector in a sector sweep field.
fn tx_sector(ssw: u32) -> TxSector {
    TxSector { antenna: low(ssw >> 16, 3), sector: low(ssw >> 10, 0x3F) }
}

/// A field of 24 bits.
fn bits([a, b, c]: [u8; 3]) -> u32 {
    u32::from_le_bytes([a, b, c, 0])
}

/// The low octet of `field`, of which `mask` stays.
fn low(field: u32, mask: u8) -> u8 {
    field.to_le_bytes()[0] & mask
}

fn nine_bits(field: u32) -> u16 {
    let [a, b, ..] = field.to_le_bytes();
    u16::from_le_bytes([a, b & 1])
}
