//! Memory that an algorithm may need at once.

use crate::MapError;

/// Memory that an algorithm may take for tables that grow with the product of two numbers, such as the hops between all
/// pairs of nodes (octets).
const ALLOWED_BYTES: u64 = 3_200_000_000;

/// Refuses a table of `rows` times `columns` entries of `entry_bytes` octets that does not fit the memory. `what` says what
/// it holds.
pub(crate) fn check_table(
    algorithm: &'static str,
    what: impl FnOnce() -> String,
    [rows, columns]: [usize; 2],
    entry_bytes: u64,
) -> Result<(), MapError> {
    let bytes = (rows as u64).saturating_mul(columns as u64).saturating_mul(entry_bytes);
    if bytes > ALLOWED_BYTES {
        return Err(MapError::TooMuchMemory { algorithm, what: what(), bytes, allowed_bytes: ALLOWED_BYTES });
    }
    Ok(())
}
