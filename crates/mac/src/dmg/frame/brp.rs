//! BRP frames (IEEE 802.11ad-2012, 8.5.22.3) that tell at which SNR the sectors of a sweep were heard: a DMG Beam
//! Refinement element (8.4.2.132) that says how many, and a Channel Measurement Feedback element (8.4.2.138) with the
//! SNRs and then the sectors.
//!
//! The count has seven bits and an element at most 255 octets: 127 sectors fit.

use super::super::address::MacAddress;
use super::super::sector::TxSector;
use super::super::snr_report::MeasuredSnr;
use super::elements::Elements;
use super::{SweepBody, SweepFrame, SweepParseError};

/// Frame control of an Action No Ack frame: protocol version 0, type management, subtype 14; no flags.
pub(super) const FRAME_CONTROL: u8 = 0xE0;

/// Most sectors that a BRP frame reports.
pub const MAX_MEASUREMENTS: u8 = 127;

/// Frame control, Duration, receiver, transmitter, BSSID, sequence control.
const HEADER_OCTETS: usize = 24;
/// Category, action, dialog token, BRP request.
const FIXED_OCTETS: usize = 7;
/// Header, fixed fields, both elements without measurements, FCS.
const OCTETS_WITHOUT_MEASUREMENTS: u16 = 24 + 7 + 7 + 2 + 4;
/// Category Unprotected DMG and its action BRP.
const ACTION: [u8; 2] = [20, 1];

const REFINEMENT: u8 = 153;
const MEASUREMENTS: u8 = 154;
/// The FBCK-TYPE field of a DMG Beam Refinement element begins at this bit.
const FEEDBACK_TYPE: u32 = 18;
/// SNRs are present.
const HAS_SNRS: u64 = 1 << FEEDBACK_TYPE;
/// The first bit of the number of measurements.
const COUNT: u32 = FEEDBACK_TYPE + 5;
/// Sector IDs are present.
const HAS_SECTORS: u64 = 1 << (FEEDBACK_TYPE + 12);
/// What a Channel Measurement Feedback element would have beside SNRs and sectors: channel measurements, tap delays.
const HAS_TAPS: u64 = 3 << (FEEDBACK_TYPE + 1);

/// The SNR at which a sector was heard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SectorMeasurement {
    /// The sector of the receiver of the report.
    pub sector: TxSector,
    /// The SNR at its sender.
    pub snr: MeasuredSnr,
}

/// Size of a BRP frame that reports so many sectors, FCS included (octets).
#[must_use]
pub(crate) const fn brp_octets(measurements: u8) -> u16 {
    OCTETS_WITHOUT_MEASUREMENTS + 2 * measurements as u16
}

/// The measurements of a frame of a sector level sweep, FCS included: those of a BRP frame, and none of other frames.
///
/// # Errors
/// If the octets are not a valid frame of the sector level sweep.
pub fn brp_measurements(octets: &[u8]) -> Result<Vec<SectorMeasurement>, SweepParseError> {
    let SweepBody::Brp { .. } = SweepFrame::parse(octets)?.body else { return Ok(Vec::new()) };
    let (snrs, sectors) = report(&octets[..octets.len() - super::FCS_OCTETS])?;
    let measurement = |(&snr, &order): (&u8, &u8)| SectorMeasurement {
        sector: TxSector { antenna: order >> 6, sector: order & 0x3F },
        snr: MeasuredSnr(snr),
    };
    Ok(snrs.iter().zip(sectors).map(measurement).collect())
}

/// Writes everything but the FCS. The sequence number is 0: the frame is never repeated.
pub(super) fn write(frame: &SweepFrame, measurements: &[SectorMeasurement], octets: &mut Vec<u8>) {
    assert!(measurements.len() <= MAX_MEASUREMENTS.into(), "{} measurements", measurements.len());
    octets.extend([FRAME_CONTROL, 0]);
    octets.extend(frame.duration_us.to_le_bytes());
    octets.extend(frame.to.0);
    octets.extend(frame.from.0);
    // The station that sweeps is that of the BSS.
    octets.extend(frame.to.0);
    octets.extend([0, 0]);
    octets.extend(ACTION);
    octets.extend([0; FIXED_OCTETS - ACTION.len()]);
    let refinement = HAS_SNRS | HAS_SECTORS | (measurements.len() as u64) << COUNT;
    octets.extend([REFINEMENT, 5]);
    octets.extend(&refinement.to_le_bytes()[..5]);
    octets.extend([MEASUREMENTS, u8::try_from(2 * measurements.len()).expect("at most 254 octets")]);
    octets.extend(measurements.iter().map(|measurement| measurement.snr.0));
    let order = |TxSector { antenna, sector }: TxSector| sector & 0x3F | antenna << 6;
    octets.extend(measurements.iter().map(|measurement| order(measurement.sector)));
}

/// Reads everything but the FCS, which is good.
pub(super) fn parse(covered: &[u8]) -> Result<SweepFrame, SweepParseError> {
    let truncated = || SweepParseError::Truncated(covered.len() + super::FCS_OCTETS);
    let Some((&[_, flags, d0, d1, ref addresses @ ..], body)) = covered.split_first_chunk::<HEADER_OCTETS>() else {
        return Err(truncated());
    };
    if flags != 0 {
        return Err(SweepParseError::Flags(flags));
    }
    let &[category, action, ..] = body else { return Err(truncated()) };
    if [category, action] != ACTION {
        return Err(SweepParseError::Action { category, action });
    }
    let (snrs, _) = report(covered)?;
    let &[r0, r1, r2, r3, r4, r5, t0, t1, t2, t3, t4, t5, ..] = addresses;
    Ok(SweepFrame {
        duration_us: u16::from_le_bytes([d0, d1]),
        to: MacAddress([r0, r1, r2, r3, r4, r5]),
        from: MacAddress([t0, t1, t2, t3, t4, t5]),
        body: SweepBody::Brp { measurements: u8::try_from(snrs.len()).expect("a count of seven bits") },
    })
}

/// The SNRs and the sectors in the elements of a frame without its FCS; as many of the ones as of the others.
fn report(covered: &[u8]) -> Result<(&[u8], &[u8]), SweepParseError> {
    let (mut count, mut measurements) = (None, None);
    for element in Elements::new("BRP", covered, HEADER_OCTETS + FIXED_OCTETS) {
        match element? {
            (REFINEMENT, &[a, b, c, d, e]) => count = count.or(announced([a, b, c, d, e])),
            (MEASUREMENTS, content) => measurements = measurements.or(Some(content)),
            _ => {}
        }
    }
    let (Some(count), Some(content)) = (count, measurements) else { return Err(SweepParseError::NoMeasurements) };
    if content.len() != 2 * count {
        return Err(SweepParseError::Measurements { found: content.len(), allowed: 2 * count });
    }
    Ok(content.split_at(count))
}

/// The number of measurements that a DMG Beam Refinement element announces, if they are SNRs and sectors alone.
fn announced([a, b, c, d, e]: [u8; 5]) -> Option<usize> {
    let field = u64::from_le_bytes([a, b, c, d, e, 0, 0, 0]);
    let has_report = field & (HAS_SNRS | HAS_SECTORS | HAS_TAPS) == HAS_SNRS | HAS_SECTORS;
    has_report.then_some((field >> COUNT & 0x7F) as usize)
}
