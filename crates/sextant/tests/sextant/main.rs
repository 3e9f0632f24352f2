//! The library as its users call it.

mod disasters;
mod examples;
mod mutants;
mod programs;
mod stepping;
mod teams;
