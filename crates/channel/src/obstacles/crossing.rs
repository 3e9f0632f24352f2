//! What a straight line meets of an obstacle.

/// The part of a straight line inside an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Index of the obstacle in its field.
    pub obstacle: usize,
    /// Length of the line inside it (m), above 0; 0 for a piece of a wall that is inside stronger ones.
    pub length_m: f64,
    /// How often the line pays its fixed loss: once a passage; never if another piece of a wall pays for the passage.
    pub passages: usize,
}
