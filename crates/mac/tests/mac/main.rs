//! Channel access over ideal media, against enumerations, closed forms and other simulations.

mod enumeration;
mod one_shot;
mod sector_sweep;
mod slotted;
