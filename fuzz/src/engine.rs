//! The entry of libFuzzer.

use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use sextant_fuzz::Target;

/// The target that the environment names.
static TARGET: LazyLock<&Target> = LazyLock::new(|| {
    let name = std::env::var("SEXTANT_FUZZ_TARGET").unwrap_or_default();
    sextant_fuzz::target(&name).unwrap_or_else(|| panic!("SEXTANT_FUZZ_TARGET is `{name}`, which is not a target"))
});

fuzz_target!(|octets: &[u8]| TARGET.run(octets));
