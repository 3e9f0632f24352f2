//! Networks from end to end, against closed forms and references of other simulators.

mod discovery;
mod network;
mod one_shot;
mod superframe;
mod survey;
