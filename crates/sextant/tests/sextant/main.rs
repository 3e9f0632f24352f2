//! The library as its users call it.

mod disasters;
mod examples;
mod mutants;
mod own_access;
mod own_missions;
mod programs;
mod stepping;
mod teams;
