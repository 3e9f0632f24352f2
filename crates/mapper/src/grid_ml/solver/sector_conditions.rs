//! The conditions of one sector.

/// The conditions for a vertex to be in one sector.
#[derive(Clone, Debug, Default)]
pub(super) struct SectorConditions {
    /// Half-spaces: indices of their normals.
    pub(super) planes: Vec<usize>,
    /// Unit vectors across both edges of a wedge wider than half a turn: one of the half-planes suffices.
    pub(super) reflex: Option<[[f64; 2]; 2]>,
    /// α and β of cones.
    pub(super) cones: Vec<[f64; 2]>,
}
