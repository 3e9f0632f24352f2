//! Studies as users of the library make them.

mod campaigns;
mod examples;
mod sweeps;
#[path = "../../../sextant/tests/sextant/disasters/trial.rs"]
#[expect(dead_code, reason = "tables and plans are resumed; single files are tried in the other crate")]
mod trial;
