//! Paint: marks of a picture in pixels, colours, names beside dots, and the files that pictures become.

mod backend;
pub(crate) mod file;
pub(crate) mod labels;
pub(crate) mod palette;
pub(crate) mod picture;
