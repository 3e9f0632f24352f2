//! The same work on one thread and on three.

use std::sync::LazyLock;

use rayon::{ThreadPool, ThreadPoolBuilder};

/// Of so many inputs one is compared while fuzzing: half of the time would pass with the second run otherwise.
const SHARE: u32 = 4;

static ONE: LazyLock<ThreadPool> = LazyLock::new(|| pool(1));
static THREE: LazyLock<ThreadPool> = LazyLock::new(|| pool(3));

fn pool(threads: usize) -> ThreadPool {
    ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started")
}

/// What `work` gives on one thread and, of one in so many inputs while fuzzing and of all that are replayed, on three. Which
/// inputs that are, the input tells.
pub(crate) fn on_one_and_three<R: Send>(input: &[u8], work: impl Fn() -> R + Send + Sync) -> (R, Option<R>) {
    let sum = input.iter().fold(0_u32, |sum, octet| sum.wrapping_mul(31).wrapping_add(u32::from(*octet)));
    let is_compared = !cfg!(fuzzing) || sum.is_multiple_of(SHARE);
    (ONE.install(&work), is_compared.then(|| THREE.install(&work)))
}
