//! Captures: what is written decodes, by a parser of our own and by tshark, and a disk that fails is reported.

#![expect(clippy::unwrap_used, reason = "a test ends at the first surprise")]

mod capture;
mod failure;
mod packet;
mod run;
mod tshark;
