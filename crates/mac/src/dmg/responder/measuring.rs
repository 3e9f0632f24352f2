//! The SNRs of all sectors of a sweep that a responder heard, and the BRP frame in which it reports them to an initiator
//! that asks (IEEE 802.11ad-2012, 9.35.6): SIFS after the SSW-Feedback, on the sector that this one selects.

use std::cmp::Reverse;

use sextant_kernel::SimTime;

use super::{Answering, HeardSweep, Responder, State};
use crate::dmg::frame::{MAX_MEASUREMENTS, SectorFeedback, SectorMeasurement, SweepBody, SweepFrame};
use crate::dmg::port::{Event, Radio};
use crate::dmg::snr_report::MeasuredSnr;
use crate::dmg::timing::SIFS;

impl Responder {
    /// The sectors of the last sweep for all that were heard, in the order in which they were swept; those of the report
    /// under way by descending SNR. None if initiators do not ask for them.
    #[must_use]
    pub fn measurements(&self) -> &[SectorMeasurement] {
        &self.measurements
    }

    /// Keeps the SNR of a frame of a sweep, if an initiator may ask for it.
    pub(super) fn measure(&mut self, frame: HeardSweep) {
        if self.settings.reports_all_sectors() && !frame.is_unicast {
            let snr = MeasuredSnr::of(frame.snr);
            self.measurements.push(SectorMeasurement { sector: frame.sector, snr });
        }
    }

    /// The initiator asks for all sectors: of more than a frame can report, the strongest are kept.
    pub(super) fn turn_to_report(
        &mut self,
        answering: Answering,
        feedback: SectorFeedback,
        now: SimTime,
        radio: &mut impl Radio,
    ) {
        self.measurements.sort_by_key(|measurement| Reverse(measurement.snr));
        self.measurements.truncate(MAX_MEASUREMENTS.into());
        self.alarm.set(now, now + SIFS, Event::TransmitReady, radio);
        self.state = State::TurningToReport(answering, feedback);
    }

    /// Starts the report.
    pub(super) fn report(&mut self, answering: Answering, feedback: SectorFeedback, radio: &mut impl Radio) {
        let measurements = u8::try_from(self.measurements.len()).expect("at most 127");
        let body = SweepBody::Brp { measurements };
        let frame = SweepFrame { duration_us: 0, to: answering.heard.initiator, from: self.address, body };
        radio.transmit(frame, feedback.select);
        self.state = State::Reporting(answering, feedback);
    }
}
