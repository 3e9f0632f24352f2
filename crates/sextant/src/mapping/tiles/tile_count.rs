//! Into how many tiles a log is divided.

use std::num::NonZeroUsize;
use std::str::FromStr;

/// Into how many tiles a log is divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TileCount {
    /// As many as the memory needs: that which is free, or so many megabytes.
    Auto(Option<NonZeroUsize>),
    /// So many.
    Exactly(NonZeroUsize),
}

/// The text is no number of tiles.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{found}` is not a number of tiles; allowed: 1 or more, `auto`, or `auto:MB` with the megabytes of memory to use"
)]
pub struct UnknownTileCount {
    /// The text.
    pub found: String,
}

impl FromStr for TileCount {
    type Err = UnknownTileCount;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let number = |text: &str| text.parse().map_err(|_| UnknownTileCount { found: text.to_owned() });
        match text.split_once(':') {
            None if text == "auto" => Ok(Self::Auto(None)),
            None => number(text).map(Self::Exactly),
            Some(("auto", megabytes)) => number(megabytes).map(|megabytes| Self::Auto(Some(megabytes))),
            Some(_) => Err(UnknownTileCount { found: text.to_owned() }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_of_tiles_is_a_count_or_auto() {
        let count = |count| NonZeroUsize::new(count).expect("above zero");
        assert_eq!("4".parse(), Ok(TileCount::Exactly(count(4))));
        assert_eq!("auto".parse(), Ok(TileCount::Auto(None)));
        assert_eq!("auto:500".parse(), Ok(TileCount::Auto(Some(count(500)))));
        for wrong in ["0", "-1", "four", "auto:0", "auto:", "4:auto", ""] {
            let error = wrong.parse::<TileCount>().expect_err("it is wrong").to_string();
            assert!(error.contains("allowed: 1 or more, `auto`"), "{error}");
        }
    }
}
