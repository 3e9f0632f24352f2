//! Frames that were due, whether they were simulated or not.

/// A number of frames, and their octets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct DueFrames {
    pub(crate) frames: u64,
    /// Octets of their MPDUs.
    pub(crate) octets: u64,
}

impl DueFrames {
    /// So many frames of `mpdu_octets` each.
    pub(crate) fn alike(frames: u64, mpdu_octets: u8) -> Self {
        Self { frames, octets: frames * u64::from(mpdu_octets) }
    }

    /// Those that are not among `earlier` ones.
    pub(crate) fn without(self, earlier: Self) -> Self {
        Self {
            frames: self.frames.saturating_sub(earlier.frames),
            octets: self.octets.saturating_sub(earlier.octets),
        }
    }
}

crate::sum_fields!(DueFrames { frames, octets });
