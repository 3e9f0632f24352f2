//! The example of the guide runs.

#[path = "../../../../examples/sweep.rs"]
mod sweep;

#[test]
fn a_setting_is_studied() {
    sweep::main().unwrap();
}
