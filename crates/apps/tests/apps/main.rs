//! Controllers in a scripted world, against closed forms, with checks of what they must never do; node applications on
//! the engine.

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
