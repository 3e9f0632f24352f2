//! The channel against closed forms, brute force and the geometry library's own casts.

#![allow(clippy::disallowed_methods, reason = "oracles may be those of the C library")]

mod antenna;
mod budget;
mod clearance;
mod code_book;
mod fading;
mod floors;
mod input;
mod joints;
mod lengths;
mod rays;
mod reflections;
mod rooms;
mod sector_gains;
mod shadow;
mod sight;
mod solids;
mod volumes;
