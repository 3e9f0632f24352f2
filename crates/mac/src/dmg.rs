//! Sector level sweeps of IEEE 802.11ad (directional multi-gigabit, DMG; 2012, 9.35.2) as machines without i/o.
//!
//! An [`Initiator`] sends one SSW frame from each of its transmit sectors. A [`Responder`] listens in all directions,
//! keeps the sector that it heard best, and sends it back in SSW frames from each of its own sectors. Many responders
//! that heard one sweep share the channel by [`Contention`]: CSMA/CA without or with feedback, or slots (A-BFT). A sweep
//! to one named responder is the full procedure of the standard, with SSW-Feedback and SSW-ACK. A sweep can also only
//! announce a station, or carry a payload to all stations in DMG Beacon frames; no one answers it. With feedback, an
//! initiator may ask for the SNRs of all its sectors, which a responder then reports in a BRP frame.
//!
//! A link that is kept while a robot moves has its own parts: [`retraining`] says when its beam is trained, [`interval`] how much
//! of a beacon interval that takes, and [`data`] what data frames bring in the rest.
//!
//! Goes in: events with their instants, and the frames that were decoded, with their SINR. Comes out: commands to a
//! [`Radio`], and reports. A machine owns no octets: the radio gets each frame as a [`SweepFrame`], which writes itself.
//!
//! Differences from the standard, which are those of Gunathillake (2018, chapter 4): an SSW frame of an initiator may
//! go to all stations, where the standard has DMG beacons. A sweep that expects no answers says so by 0 receive
//! antennas. A beacon is sent by contention at any time, and not at the start of a beacon interval. The SNRs of all sectors
//! are asked for in the SSW-Feedback (BC-REQ), where the standard has a BRP frame with TXSS-FBCK-REQ after it.

mod address;
mod alarm;
mod backoff;
pub mod data;
mod edca;
mod frame;
mod initiator;
pub mod interval;
mod port;
mod responder;
pub mod retraining;
#[cfg(test)]
mod script;
mod sector;
mod settings;
mod snr_report;
pub mod timing;

pub use address::MacAddress;
pub use edca::AccessCategory;
pub use frame::{
    BeamRefinement, Enclosed, MAX_BEACON_PAYLOAD_OCTETS, MAX_MEASUREMENTS, SectorFeedback, SectorMeasurement,
    SweepBody, SweepFrame, SweepParseError, beacon_octets, beacon_payload, beacon_payload_octets, brp_measurements,
};
pub use initiator::{Access, Answer, Initiator, InitiatorOutcome, InitiatorReport, SweepPurpose};
pub use port::{Aim, Event, Radio};
pub use responder::{HeardSweep, Responder, ResponderOutcome, ResponderReport};
pub use sector::{SectorLayout, TxSector};
pub use settings::{
    Abft, AbftConfig, AnswerSettings, Contention, ContentionConfig, CsmaFeedbackConfig, SweepConfig, SweepSettings,
};
pub use snr_report::{MeasuredSnr, SnrReport};
