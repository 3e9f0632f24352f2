//! What links and applications say to each other: frames to send and how they ended, deliveries, counts.

pub(crate) mod delays;
pub(crate) mod delivery;
pub(crate) mod due_frames;
pub(crate) mod estimate;
pub(crate) mod ideal;
pub(crate) mod network_id;
pub(crate) mod outcome;
pub(crate) mod packet_trace;
pub(crate) mod packets;
pub(crate) mod radio_error;
pub(crate) mod radio_event;
pub(crate) mod report;
pub(crate) mod rhythm;
pub(crate) mod sensed;
pub(crate) mod sleep;
pub(crate) mod slots;
pub(crate) mod sweep;
pub(crate) mod upcall;
