//! The container of a recording: written chunk by chunk, inspected, and recovered after a crash.

pub(crate) mod inspect;
pub(crate) mod recover;
pub(crate) mod sink;
