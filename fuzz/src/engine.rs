//! The entry of libFuzzer.

use std::sync::LazyLock;

use libfuzzer_sys::{fuzz_mutator, fuzz_target, fuzzer_mutate};
use sextant_fuzz::Target;

/// The target that the environment names.
static TARGET: LazyLock<&Target> = LazyLock::new(|| {
    let name = std::env::var("SEXTANT_FUZZ_TARGET").unwrap_or_default();
    sextant_fuzz::target(&name).unwrap_or_else(|| panic!("SEXTANT_FUZZ_TARGET is `{name}`, which is not a target"))
});

fuzz_target!(|octets: &[u8]| TARGET.run(octets));

// Inputs that a target would ignore because they are too long are not made.
fuzz_mutator!(|octets: &mut [u8], size: usize, room: usize, _seed: u32| {
    let most = room.min(TARGET.longest);
    fuzzer_mutate(octets, size.min(most), most)
});
