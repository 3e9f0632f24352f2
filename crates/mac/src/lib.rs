//! Protocol machines without i/o: IEEE 802.15.4 channel access with and without beacons, IEEE 802.11ad sector sweeps
//! ([`dmg`]), radios that programs command ([`program`]), slots with channel hopping ([`tsch`]), routing over several hops ([`routing`]), frames, airtimes, bit
//! errors, energy, batteries ([`battery`]).
//!
//! Goes in: frames to send, and the events of timers and radio. Comes out: commands to a radio ([`csma::Radio`],
//! [`device::Radio`], [`responder::Radio`], [`coordinator::Radio`]), the octets of frames ([`frame::Frame`]), their
//! time on the air ([`Phy`]), the energy that they cost ([`EnergyMeter`]). No machine has a clock, a channel or a
//! random generator: its caller has them.
//!
//! One frame of a station that is alone; this radio is its whole world:
//!
//! ```
//! use std::time::Duration;
//! use sextant_mac::csma::{Csma, CsmaSettings, Event, Outcome, Radio, OutgoingFrame};
//! use sextant_mac::{Phy, RadioState};
//!
//! struct Alone {
//!     now: Duration,
//!     next: Option<(Duration, Event)>,
//! }
//!
//! impl Radio for Alone {
//!     fn backoff_periods(&mut self, max_inclusive: u32) -> u32 {
//!         max_inclusive // a real radio would draw a random number
//!     }
//!     fn after(&mut self, span: Duration, event: Event) {
//!         self.next = Some((self.now + span, event));
//!     }
//!     fn cancel_timer(&mut self) {
//!         self.next = None;
//!     }
//!     fn enter(&mut self, _: RadioState) {}
//!     fn start_cca(&mut self) {
//!         self.after(Phy::Oqpsk2450.cca(), Event::CcaEnded { busy: false });
//!     }
//!     fn start_transmission(&mut self, frame: OutgoingFrame) {
//!         self.after(Phy::Oqpsk2450.airtime(frame.mpdu_octets), Event::TransmissionEnded);
//!     }
//! }
//!
//! let mut radio = Alone { now: Duration::ZERO, next: None };
//! let mut csma = Csma::new(CsmaSettings::default(), Phy::Oqpsk2450);
//! csma.start(OutgoingFrame { mpdu_octets: 20, ack_request: false, sequence: 0 }, &mut radio);
//! let report = loop {
//!     let (now, event) = radio.next.take().expect("something is pending");
//!     radio.now = now;
//!     if let Some(report) = csma.handle(event, &mut radio) {
//!         break report;
//!     }
//! };
//! assert_eq!(report.outcome, Outcome::Sent);
//! // Backoff of 7 periods, CCA, turnaround, frame.
//! assert_eq!(radio.now, Duration::from_micros(7 * 320 + 128 + 192 + 832));
//! ```

pub mod battery;
pub mod coordinator;
pub mod csma;
pub mod device;
pub mod dmg;
pub mod frame;
pub mod oqpsk;
pub mod program;
pub mod responder;
pub mod routing;
pub mod sleep;
pub mod slotted;
pub mod superframe;
pub mod tsch;

mod class;
mod energy;
mod energy_meter;
mod fcs;
mod message_energy;
mod spectrum;
mod timing;

pub use class::Class;
pub use energy::{CustomRadioConfig, EnergyConfig, EnergySpent, RadioState, RadioStates};
pub use energy_meter::{Cycles, EnergyMeter};
pub use fcs::fcs;
pub use message_energy::MessageEnergy;
pub use timing::{Band, Phy};
