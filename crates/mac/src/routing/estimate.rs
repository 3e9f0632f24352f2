//! The quality of a link, from beacons that were heard over it and frames that were sent over it.

/// Beacons, heard or missed, of a sample.
const BEACONS: u32 = 3;
/// Transmissions of a sample.
const TRANSMISSIONS: u32 = 5;
/// Share of the old estimate in the new one.
const KEPT: f64 = 0.9;

/// The expected number of transmissions over a link (ETX), until the sender knows that a frame arrived: the estimator of
/// the four-bit link estimation (Fonseca, Gnawali, Jamieson, Levis, HotNets 2007), with the windows of TinyOS. Beacons tell
/// how well the neighbour is heard. Frames to the neighbour tell how well that hears, acknowledgements included; each
/// five transmissions are a sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LinkEstimate {
    etx: Option<f64>,
    /// Share of the beacons that arrive.
    quality: f64,
    /// Number of the last beacon.
    last: Option<u8>,
    heard: u32,
    missed: u32,
    transmissions: u32,
    acknowledged: u32,
}

impl LinkEstimate {
    /// Expected transmissions; `None` before the first sample.
    #[must_use]
    pub fn etx(&self) -> Option<f64> {
        self.etx
    }

    /// A beacon with this number was heard. Those between it and the one before were missed.
    pub fn heard(&mut self, number: u8) {
        let missed = self.last.map_or(0, |last| number.wrapping_sub(last).wrapping_sub(1));
        self.last = Some(number);
        self.heard += 1;
        self.missed += u32::from(missed);
        if self.heard + self.missed < BEACONS {
            return;
        }
        let share = f64::from(self.heard) / f64::from(self.heard + self.missed);
        (self.heard, self.missed) = (0, 0);
        self.quality = if self.etx.is_none() { share } else { KEPT * self.quality + (1.0 - KEPT) * share };
        self.add(1.0 / self.quality);
    }

    /// A frame was sent so many times, and at last acknowledged so many times: once or never. A window without an
    /// acknowledgement goes on, so that its sample grows.
    pub fn sent(&mut self, transmissions: u32, acknowledged: u32) {
        self.transmissions += transmissions;
        self.acknowledged += acknowledged;
        if self.transmissions < TRANSMISSIONS {
            return;
        }
        let sample = f64::from(self.transmissions) / f64::from(self.acknowledged.max(1));
        if self.acknowledged > 0 {
            (self.transmissions, self.acknowledged) = (0, 0);
        }
        self.add(sample);
    }

    fn add(&mut self, sample: f64) {
        self.etx = Some(self.etx.map_or(sample, |etx| KEPT * etx + (1.0 - KEPT) * sample));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(found: Option<f64>, expected: f64) -> bool {
        found.is_some_and(|found| (found - expected).abs() < 1e-12)
    }

    #[test]
    fn three_beacons_make_the_first_estimate() {
        let mut link = LinkEstimate::default();
        link.heard(255);
        link.heard(0);
        assert_eq!(link.etx(), None);
        link.heard(1);
        assert!(near(link.etx(), 1.0));
        // One of three is missed: the share is 2/3 with a weight of 0.1.
        link.heard(2);
        link.heard(4);
        let quality = 0.9 + 0.1 * 2.0 / 3.0;
        assert!(near(link.etx(), 0.9 + 0.1 / quality), "{:?}", link.etx());
    }

    #[test]
    fn each_five_transmissions_are_a_sample() {
        let mut link = LinkEstimate::default();
        (0..3).for_each(|number| link.heard(number));
        link.sent(2, 1);
        link.sent(2, 1);
        assert!(near(link.etx(), 1.0));
        link.sent(2, 1);
        assert!(near(link.etx(), 0.9 + 0.1 * 6.0 / 3.0));
    }

    #[test]
    fn a_neighbour_that_is_gone_costs_more_with_each_frame() {
        let mut link = LinkEstimate::default();
        (0..3).for_each(|number| link.heard(number));
        // Four transmissions each: samples of 8, 12, 16, 20.
        let mut expected = 1.0;
        link.sent(4, 0);
        for total in [8.0, 12.0, 16.0, 20.0] {
            link.sent(4, 0);
            expected = 0.9 * expected + 0.1 * total;
            assert!(near(link.etx(), expected));
        }
        assert!(expected > 5.0, "{expected}: it is not used any more after five frames");
    }

    /// The mean of many samples of a link on which a frame and its acknowledgement arrive with p together is near 1/p; the
    /// mean of quotients is a little more. The frames are those of a fixed sequence of one success in four.
    #[test]
    fn the_estimate_goes_to_the_number_of_transmissions_that_the_link_needs() {
        let mut link = LinkEstimate::default();
        (0..200).for_each(|_| link.sent(4, 1));
        assert!(near(link.etx(), 4.0));
    }
}
