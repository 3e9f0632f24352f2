//! The channel against closed forms, brute force and the geometry library's own casts.

mod budget;
mod clearance;
mod input;
mod lengths;
mod shadow;
mod solids;
