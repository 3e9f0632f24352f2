//! Beacons of coordinators.

use super::cursor::Cursor;
use super::{ParseError, WriteError};

const BATTERY_LIFE_EXTENSION: u16 = 1 << 12;
const PAN_COORDINATOR: u16 = 1 << 14;
const ASSOCIATION_PERMIT: u16 = 1 << 15;
const GTS_PERMIT: u8 = 1 << 7;
/// Largest number of guaranteed slots, and of pending addresses of each kind.
const MAX_LISTED: usize = 7;

/// The superframe that a beacon opens (superframe specification field).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Superframe {
    /// Beacon order, 0 to 15: the beacon interval is 960 * 2^order symbols; 15: no regular beacons.
    pub beacon_order: u8,
    /// Superframe order, 0 to 15: the active part is 960 * 2^order symbols.
    pub superframe_order: u8,
    /// Last slot of the contention access period, 0 to 15.
    pub final_cap_slot: u8,
    /// Whether contention is only possible directly after the beacon, to save batteries (battery life extension).
    pub battery_life_extension: bool,
    /// Whether the sender is the coordinator of the whole PAN.
    pub pan_coordinator: bool,
    /// Whether devices may join.
    pub association_permit: bool,
}

/// A guaranteed time slot (GTS descriptor).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GuaranteedSlot {
    /// Short address of the device that owns it.
    pub device: u16,
    /// First slot of the superframe, 0 to 15.
    pub first_slot: u8,
    /// Length in slots, 0 to 15.
    pub slots: u8,
    /// Whether the device receives in the slot; otherwise it transmits.
    pub receive_only: bool,
}

/// Content of a beacon.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Beacon<'a> {
    /// The superframe that it opens.
    pub superframe: Superframe,
    /// Whether devices may request guaranteed slots.
    pub gts_permit: bool,
    /// Guaranteed slots, at most 7.
    pub guaranteed: Vec<GuaranteedSlot>,
    /// Short addresses for which frames are pending, at most 7.
    pub pending_short: Vec<u16>,
    /// Extended addresses for which frames are pending, at most 7.
    pub pending_extended: Vec<u64>,
    /// Payload.
    pub payload: &'a [u8],
}

/// `value` as the content of a field that holds at most `allowed`.
fn fit(field: &'static str, value: usize, allowed: usize) -> Result<u8, WriteError> {
    match u8::try_from(value) {
        Ok(octet) if value <= allowed => Ok(octet),
        _ => Err(WriteError::BeaconField { field, found: value, allowed }),
    }
}

fn nibble(field: &'static str, value: u8) -> Result<u8, WriteError> {
    fit(field, usize::from(value), 15)
}

impl Superframe {
    fn to_bits(self) -> Result<u16, WriteError> {
        let flag = |is_set: bool, bit: u16| if is_set { bit } else { 0 };
        Ok(u16::from(nibble("the beacon order", self.beacon_order)?)
            | u16::from(nibble("the superframe order", self.superframe_order)?) << 4
            | u16::from(nibble("the final CAP slot", self.final_cap_slot)?) << 8
            | flag(self.battery_life_extension, BATTERY_LIFE_EXTENSION)
            | flag(self.pan_coordinator, PAN_COORDINATOR)
            | flag(self.association_permit, ASSOCIATION_PERMIT))
    }

    const fn from_bits(bits: u16) -> Self {
        let [low, high] = bits.to_le_bytes();
        Self {
            beacon_order: low & 15,
            superframe_order: low >> 4,
            final_cap_slot: high & 15,
            battery_life_extension: bits & BATTERY_LIFE_EXTENSION != 0,
            pan_coordinator: bits & PAN_COORDINATOR != 0,
            association_permit: bits & ASSOCIATION_PERMIT != 0,
        }
    }
}

impl<'a> Beacon<'a> {
    pub(super) fn write(&self, mpdu: &mut Vec<u8>) -> Result<(), WriteError> {
        mpdu.extend(self.superframe.to_bits()?.to_le_bytes());
        let count = fit("the number of guaranteed slots", self.guaranteed.len(), MAX_LISTED)?;
        mpdu.push(count | if self.gts_permit { GTS_PERMIT } else { 0 });
        if count > 0 {
            let directions = self.guaranteed.iter().rev();
            mpdu.push(directions.fold(0, |mask, slot| mask << 1 | u8::from(slot.receive_only)));
        }
        for slot in &self.guaranteed {
            mpdu.extend(slot.device.to_le_bytes());
            let first = nibble("the first slot of a guaranteed slot", slot.first_slot)?;
            mpdu.push(first | nibble("the length of a guaranteed slot", slot.slots)? << 4);
        }
        let short = fit("the number of short pending addresses", self.pending_short.len(), MAX_LISTED)?;
        let extended = fit("the number of extended pending addresses", self.pending_extended.len(), MAX_LISTED)?;
        mpdu.push(short | extended << 4);
        mpdu.extend(self.pending_short.iter().flat_map(|address| address.to_le_bytes()));
        mpdu.extend(self.pending_extended.iter().flat_map(|address| address.to_le_bytes()));
        mpdu.extend(self.payload);
        Ok(())
    }

    pub(super) fn parse(cursor: &mut Cursor<'a>) -> Result<Self, ParseError> {
        let superframe = Superframe::from_bits(cursor.u16("superframe specification")?);
        let specification = cursor.u8("GTS specification")?;
        let count = specification & 7;
        let directions = if count > 0 { cursor.u8("GTS directions")? } else { 0 };
        let mut guaranteed = Vec::new();
        for index in 0..count {
            let device = cursor.u16("GTS list")?;
            let place = cursor.u8("GTS list")?;
            guaranteed.push(GuaranteedSlot {
                device,
                first_slot: place & 15,
                slots: place >> 4,
                receive_only: directions >> index & 1 == 1,
            });
        }
        let pending = cursor.u8("pending address specification")?;
        let short = (0..pending & 7).map(|_| cursor.u16("pending addresses"));
        let pending_short = short.collect::<Result<_, _>>()?;
        let extended = (0..pending >> 4 & 7).map(|_| cursor.u64("pending addresses"));
        let pending_extended = extended.collect::<Result<_, _>>()?;
        Ok(Self {
            superframe,
            gts_permit: specification & GTS_PERMIT != 0,
            guaranteed,
            pending_short,
            pending_extended,
            payload: cursor.rest(),
        })
    }
}
