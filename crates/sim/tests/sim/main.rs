//! Complete networks, against closed forms and reference values of other simulators.

#![allow(clippy::disallowed_methods, reason = "oracles may be those of the C library")]

mod acknowledgement;
mod beams;
mod broadcasts;
mod code_books;
mod discovery;
mod draws;
mod driving;
mod faults;
mod flooding;
mod halo;
mod hopping;
mod ideal;
mod interference;
mod listening;
mod meeting;
mod mesh;
mod mobile_anchors;
mod network;
mod networks;
mod odometry;
mod on_air;
mod one_shot;
mod own;
mod phy;
mod programs;
mod queue;
mod quiet;
mod ranging;
mod saturated;
mod scripted;
mod sector_reports;
mod seeker;
mod sensing;
mod superframe;
mod survey;
mod sweeps;
mod tasks;
mod tilts;
mod timers;
mod tree;
