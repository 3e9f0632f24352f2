//! Complete networks, against closed forms and reference values of other simulators.

mod discovery;
mod hopping;
mod network;
mod one_shot;
mod sensing;
mod superframe;
mod survey;
