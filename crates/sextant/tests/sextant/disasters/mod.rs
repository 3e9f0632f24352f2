//! Disks that fail, are full, tear a write, are interrupted or lose their power, at each change that a small piece of work makes
//! of them. Nothing that was reported as written is lost, and what is left is whole, or can be gone on with.

mod exports;
mod files;
mod maps;
mod recordings;
mod trial;
