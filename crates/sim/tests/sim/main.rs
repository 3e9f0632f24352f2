//! Complete networks, against closed forms and reference values of other simulators.

mod acknowledgement;
mod discovery;
mod draws;
mod driving;
mod flooding;
mod hopping;
mod listening;
mod meeting;
mod mesh;
mod mobile_anchors;
mod network;
mod networks;
mod odometry;
mod on_air;
mod one_shot;
mod phy;
mod queue;
mod scripted;
mod seeker;
mod sensing;
mod superframe;
mod survey;
mod sweeps;
mod tasks;
mod timers;
mod tree;
