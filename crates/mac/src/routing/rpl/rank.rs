//! How far a station is from the root.

/// Place of a station relative to others of its tree (RFC 6550, 3.5): it grows with each hop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Rank(pub u16);

impl Rank {
    /// That of a station without a way to the root.
    pub const INFINITE: Self = Self(u16::MAX);

    /// Whether a way leads to the root.
    #[must_use]
    pub fn is_finite(self) -> bool {
        self != Self::INFINITE
    }

    /// The rank of a station that is so much farther away; infinite if that is too much.
    #[must_use]
    pub fn plus(self, increase: u32) -> Self {
        Self(u16::try_from(u32::from(self.0).saturating_add(increase)).unwrap_or(u16::MAX))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rank_grows_up_to_infinity() {
        assert_eq!(Rank(256).plus(256), Rank(512));
        assert_eq!((Rank(65_000).plus(600), Rank::INFINITE.plus(1)), (Rank::INFINITE, Rank::INFINITE));
    }
}
