//! Paths laid out beforehand.
