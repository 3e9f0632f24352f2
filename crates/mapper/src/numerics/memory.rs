//! Limits of the memory that an algorithm may allocate at once.

use crate::error::MapError;

/// Maximum memory for one table whose size is the product of two numbers, such as the hops between all pairs of nodes
/// (bytes).
const ALLOWED_BYTES: u64 = 3_200_000_000;

/// Rejects a table that does not fit into the memory: `rows` times `columns` entries of `entry_bytes` bytes. `what`
/// describes its content.
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
