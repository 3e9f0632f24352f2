//! Frames of a capture from which no node was heard.

use std::collections::BTreeMap;

/// Why a frame is skipped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Skipped {
    /// It names no sender.
    NoSource,
    /// Its check sequence is wrong.
    BadFcs,
    /// It ends before its addresses do.
    TooShort,
    /// Its header is not valid.
    Invalid,
    /// It is of another PAN than the chosen one.
    OtherPan,
    /// The capture does not tell its time.
    NoTime,
}

impl Skipped {
    /// The words after a number of frames.
    pub(super) const fn words(self) -> &'static str {
        match self {
            Self::NoSource => "without a source address (acknowledgements, for example)",
            Self::BadFcs => "with a wrong FCS",
            Self::TooShort => "that end before their source address",
            Self::Invalid => "with an invalid header",
            Self::OtherPan => "of another PAN or none",
            Self::NoTime => "without a time",
        }
    }
}

/// How many frames were used and skipped.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct FrameCount {
    used: u64,
    skipped: BTreeMap<Skipped, u64>,
}

impl FrameCount {
    /// Counts a frame.
    pub(super) fn take<T>(&mut self, frame: &Result<T, Skipped>) {
        match frame {
            Ok(_) => self.used += 1,
            Err(why) => *self.skipped.entry(*why).or_default() += 1,
        }
    }

    /// Number of used frames.
    pub(super) const fn used(&self) -> u64 {
        self.used
    }

    /// Whether most frames had a wrong check sequence.
    pub(super) fn is_mostly_wrong(&self) -> bool {
        let bad = self.skipped.get(&Skipped::BadFcs).copied().unwrap_or_default();
        bad > self.used && bad > 0
    }

    /// The skipped frames by reason; empty if there are none.
    pub(super) fn reasons(&self) -> String {
        let reason = |(why, count): (&Skipped, &u64)| format!("{count} {}", why.words());
        self.skipped.iter().map(reason).collect::<Vec<_>>().join(", ")
    }
}
