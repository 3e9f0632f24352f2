//! Controllers in a scripted world, against closed forms, with checks of what they must never do; node applications on
//! the engine.

#![allow(clippy::disallowed_methods, reason = "oracles may be those of the C library")]

mod areas;
mod automated;
mod curves;
mod distributed;
mod layers;
mod partition;
mod planned;
mod random_walk;
mod seeking;
mod target_search;
mod world;
