//! The identity of a robot among the robots.

/// Identity of a robot among the robots of a survey. Dense: an index from zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RobotId(pub u32);

impl RobotId {
    /// The identity as an index into per-robot tables.
    #[must_use]
    pub fn index(self) -> usize {
        self.0 as usize
    }

    /// The identity of the robot at `index` of a per-robot table.
    ///
    /// # Panics
    /// If the index does not fit in 32 bits.
    #[must_use]
    pub fn from_index(index: usize) -> Self {
        Self(u32::try_from(index).expect("at most 2^32 robots"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_identity_is_an_index() {
        assert_eq!(RobotId::from_index(7), RobotId(7));
        assert_eq!(RobotId(7).index(), 7);
    }
}
