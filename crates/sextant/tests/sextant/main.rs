//! The library as its users call it.

#![allow(clippy::disallowed_methods, reason = "oracles may be those of the C library")]

mod batteries;
mod beams;
mod counts;
mod disasters;
mod examples;
mod fading;
mod forecast;
mod idle_keys;
mod linked;
mod moving;
mod mutants;
mod own_access;
mod own_missions;
mod programs;
mod routing;
mod rpl;
mod sleeping;
mod slots;
mod star;
mod stepping;
mod teams;
