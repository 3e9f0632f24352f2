//! Surveys in a scripted world: the controllers against closed forms and against what they must never do.

mod automated;
mod planned;
mod world;
