//! The environments of chapters 4 and 5.

/// An environment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Environment {
    Warehouse,
    Greenhouse,
}

impl Environment {
    /// In the order of the thesis.
    pub(super) const ALL: [Self; 2] = [Self::Warehouse, Self::Greenhouse];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Warehouse => "warehouse",
            Self::Greenhouse => "greenhouse",
        }
    }
}
