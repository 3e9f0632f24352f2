//! The frames that were on air.

use sextant_kernel::{SimTime, StationId};
use sextant_mac::frame::{Frame, FrameBody};
use sextant_sim::{FrameOnAir, FrameOutcome, NetworkId, Observer};

/// A frame that was on air; its span in microseconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Span {
    pub(crate) network: NetworkId,
    pub(crate) source: StationId,
    pub(crate) from_us: u64,
    pub(crate) to_us: u64,
    pub(crate) is_acknowledgement: bool,
    pub(crate) sequence: u8,
    pub(crate) outcome: FrameOutcome,
}

/// Writes down all frames, in the order of their ends.
#[derive(Default)]
pub(crate) struct OnAir(pub(crate) Vec<Span>);

impl OnAir {
    /// Sender, start and end (us), and outcome of each data frame, or of each acknowledgement.
    pub(crate) fn frames(&self, acknowledgements: bool) -> Vec<(u32, u64, u64, FrameOutcome)> {
        (self.0.iter().filter(|span| span.is_acknowledgement == acknowledgements))
            .map(|span| (span.source.0, span.from_us, span.to_us, span.outcome))
            .collect()
    }
}

impl Observer for OnAir {
    fn wants_frames(&self) -> bool {
        true
    }

    fn framed(&mut self, frame: FrameOnAir<'_>) {
        let micros = |at: SimTime| at.as_nanos() / 1000;
        let Frame { body, sequence, .. } = Frame::parse(frame.bytes).expect("a frame");
        self.0.push(Span {
            network: frame.network,
            source: frame.source,
            from_us: micros(frame.start),
            to_us: micros(frame.start + frame.airtime),
            is_acknowledgement: matches!(body, FrameBody::Acknowledgement),
            sequence,
            outcome: frame.outcome,
        });
    }
}

/// What a function keeps of each frame, in the order of their ends.
pub(crate) struct Frames<T>(pub(crate) Vec<T>, fn(&FrameOnAir<'_>) -> T);

impl<T> Frames<T> {
    pub(crate) fn kept(keep: fn(&FrameOnAir<'_>) -> T) -> Self {
        Self(Vec::new(), keep)
    }
}

impl<T> Observer for Frames<T> {
    fn wants_frames(&self) -> bool {
        true
    }

    fn framed(&mut self, frame: FrameOnAir<'_>) {
        self.0.push(self.1(&frame));
    }
}
