//! Tests of the machine with a scripted radio.
