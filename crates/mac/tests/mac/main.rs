//! Channel access over ideal media, against enumerations, closed forms and other simulations.

#![allow(clippy::disallowed_methods, reason = "oracles may be those of the C library")]

mod enumeration;
mod one_shot;
mod sector_sweep;
mod slotted;
