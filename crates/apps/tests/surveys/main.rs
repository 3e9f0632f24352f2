//! Surveys in a scripted world: the controllers against closed forms, and checks of what they must never do.

mod areas;
mod automated;
mod curves;
mod layers;
mod planned;
mod random_walk;
mod world;
