//! What robots and nodes do on maps, and the maps that nodes compute themselves.

pub(crate) mod applications;
pub(crate) mod distributed;
