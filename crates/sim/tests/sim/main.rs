//! Complete networks, against closed forms and reference values of other simulators.

mod discovery;
mod driving;
mod network;
mod odometry;
mod one_shot;
mod superframe;
mod survey;
