//! Enhanced beacons.

use super::{
    DESTINATION_MODE, ELEMENTS, Kind, PAN_ID_COMPRESSION, SOURCE_MODE, SlotFrameError, VERSION_2, elements, finish,
    open,
};
use crate::frame::{Address, Endpoint};
use crate::tsch::{Asn, CellOptions};

/// An enhanced beacon to all (IEEE 802.15.4-2015, 7.3.1): what a station needs to join. Template and channels are the default ones
/// of the network, which have the number 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EnhancedBeacon {
    /// Its sender.
    pub from: Endpoint,
    /// Sequence number.
    pub sequence: u8,
    /// The slot in which it is sent.
    pub asn: Asn,
    /// How far its sender is from the root of the network.
    pub join_metric: u8,
    /// The slotframes that it tells.
    pub slotframes: Vec<AdvertisedSlotframe>,
}

/// A slotframe in a beacon.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AdvertisedSlotframe {
    /// Its number.
    pub handle: u8,
    /// Its length (slots).
    pub length: u16,
    /// Its cells.
    pub cells: Vec<AdvertisedCell>,
}

/// A cell in a beacon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AdvertisedCell {
    /// The slot in which it is.
    pub timeslot: u16,
    /// What its channel has beyond the number of the slot.
    pub channel_offset: u16,
    /// What it is for.
    pub options: CellOptions,
}

impl EnhancedBeacon {
    /// Its size (octets).
    #[must_use]
    pub fn octets(&self) -> u8 {
        let mut mpdu = Vec::new();
        self.write(&mut mpdu);
        u8::try_from(mpdu.len()).expect("a beacon with few cells fits into a frame")
    }

    /// Replaces the content of `mpdu` with the MPDU.
    pub fn write(&self, mpdu: &mut Vec<u8>) {
        mpdu.clear();
        let mode = match self.from.address {
            Address::Short(_) => 2,
            Address::Extended(_) => 3,
        };
        let control = Kind::Beacon as u16
            | PAN_ID_COMPRESSION
            | ELEMENTS
            | 2 << DESTINATION_MODE
            | VERSION_2
            | mode << SOURCE_MODE;
        mpdu.extend(control.to_le_bytes());
        mpdu.push(self.sequence);
        mpdu.extend(self.from.pan.to_le_bytes());
        Address::BROADCAST.write(mpdu);
        self.from.address.write(mpdu);
        elements::write_header(elements::PAYLOAD_FOLLOWS, &[], mpdu);
        let mut group = Vec::new();
        let mut content = self.asn.octets().to_vec();
        content.push(self.join_metric);
        elements::write_short(elements::SYNCHRONISATION, &content, &mut group);
        elements::write_short(elements::TIMESLOT, &[0], &mut group);
        elements::write_long(elements::HOPPING, &[0], &mut group);
        let few = |count: usize| u8::try_from(count).expect("few slotframes and cells");
        let mut content = vec![few(self.slotframes.len())];
        for slotframe in &self.slotframes {
            content.push(slotframe.handle);
            content.extend(slotframe.length.to_le_bytes());
            content.push(few(slotframe.cells.len()));
            for cell in &slotframe.cells {
                content.extend(cell.timeslot.to_le_bytes());
                content.extend(cell.channel_offset.to_le_bytes());
                content.push(cell.options.bits());
            }
        }
        elements::write_short(elements::SLOTFRAMES, &content, &mut group);
        elements::write_payload(elements::MLME, &group, mpdu);
        finish(mpdu);
    }

    /// Reads an MPDU. Elements of others are skipped.
    ///
    /// # Errors
    /// If it is not an enhanced beacon with a source and the number of its slot.
    pub fn parse(mpdu: &[u8]) -> Result<Self, SlotFrameError> {
        let (control, header, mut rest) = open(mpdu, Kind::Beacon)?;
        let sequence = header.sequence.ok_or(SlotFrameError::Missing("sequence number"))?;
        let source = header.source.ok_or(SlotFrameError::Missing("source"))?;
        let pan = source.pan.or_else(|| header.destination.and_then(|to| to.pan));
        let from = Endpoint { pan: pan.ok_or(SlotFrameError::Missing("PAN"))?, address: source.address };
        if control & ELEMENTS == 0 {
            return Err(SlotFrameError::Missing("information elements"));
        }
        loop {
            let (id, _, others) = elements::header_element(rest)?;
            rest = others;
            if id == elements::PAYLOAD_FOLLOWS {
                break;
            }
        }
        let (mut synchronisation, mut slotframes) = (None, Vec::new());
        while !rest.is_empty() {
            let (group, mut nested, others) = elements::payload_element(rest)?;
            rest = others;
            while group == elements::MLME && !nested.is_empty() {
                let (id, content, others) = elements::nested_element(nested)?;
                nested = others;
                match id {
                    elements::SYNCHRONISATION => {
                        let &[a, b, c, d, e, join_metric] = content else {
                            return Err(SlotFrameError::TruncatedElement);
                        };
                        synchronisation = Some((Asn::of_octets([a, b, c, d, e]), join_metric));
                    }
                    elements::SLOTFRAMES => {
                        slotframes = advertised(content).ok_or(SlotFrameError::TruncatedElement)?
                    }
                    _ => {}
                }
            }
        }
        let (asn, join_metric) = synchronisation.ok_or(SlotFrameError::Missing("number of its slot"))?;
        Ok(Self { from, sequence, asn, join_metric, slotframes })
    }
}

/// The slotframes of an element; `None` if it ends too early.
fn advertised(content: &[u8]) -> Option<Vec<AdvertisedSlotframe>> {
    let (&count, mut rest) = content.split_first()?;
    let mut slotframes = Vec::new();
    for _ in 0..count {
        let &[handle, low, high, cells] = rest.first_chunk()?;
        rest = &rest[4..];
        let mut slotframe =
            AdvertisedSlotframe { handle, length: u16::from_le_bytes([low, high]), cells: Vec::new() };
        for _ in 0..cells {
            let &[slot_low, slot_high, low, high, options] = rest.first_chunk()?;
            rest = &rest[5..];
            slotframe.cells.push(AdvertisedCell {
                timeslot: u16::from_le_bytes([slot_low, slot_high]),
                channel_offset: u16::from_le_bytes([low, high]),
                options: CellOptions::of_bits(options),
            });
        }
        slotframes.push(slotframe);
    }
    Some(slotframes)
}
