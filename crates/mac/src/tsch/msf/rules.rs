//! The numbers of MSF, and what it did.

/// The numbers of MSF (RFC 9033, table 2). Times are in slots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MsfRules {
    /// Length of the slotframes (SLOTFRAME_LENGTH).
    pub length: u16,
    /// Number of channel offsets (NUM_CH_OFFSET).
    pub channels: u16,
    /// So many cells to the parent go by between two decisions (MAX_NUMCELLS).
    pub max_num_cells: u16,
    /// If more of them were used, one is added (LIM_NUMCELLSUSED_HIGH).
    pub used_high: u16,
    /// If fewer were used, one is deleted (LIM_NUMCELLSUSED_LOW).
    pub used_low: u16,
    /// Between two looks at how the cells deliver (HOUSEKEEPINGCOLLISION_PERIOD).
    pub housekeeping: u64,
    /// Least and longest wait before a neighbour is asked again (WAIT_DURATION_MIN and WAIT_DURATION_MAX).
    pub waits: [u64; 2],
    /// How long a neighbour is not asked after an error (QUARANTINE_DURATION).
    pub quarantine: u64,
    /// How long a response is waited for (section 9).
    pub timeout: u64,
}

/// How a station used MSF.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MsfUse {
    /// Mean number of negotiated cells in which it sends.
    pub mean_cells: f64,
    /// That number at the end.
    pub cells: u32,
    /// Transactions that it began.
    pub transactions: u64,
    /// Those of them that failed: no response came, or one that says no.
    pub failures: u64,
    /// Cells that it relocated.
    pub relocations: u64,
}
