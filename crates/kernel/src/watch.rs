//! The port through which long work tells how far it is, and asks whether to go on.

/// What is about to be done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Work {
    /// What is done: the name of an algorithm or of a part of it.
    pub name: &'static str,
    /// What a step is: `node`, `round`.
    pub unit: &'static str,
    /// Steps, at most.
    pub steps: u64,
    /// Elementary operations of all steps together, at most: vertices times stops, pairs of nodes. Each takes some
    /// nanoseconds.
    pub operations: f64,
}

/// Whoever watches long work. Called from many threads at once, and often: nothing here may wait.
pub trait Watch: std::fmt::Debug + Sync {
    /// `work` begins, and what was begun before is over.
    fn begin(&self, work: Work);

    /// So many more steps are done.
    fn advance(&self, steps: u64);

    /// Whether the work is to end without a result. Once it is, it stays so.
    fn is_stopped(&self) -> bool;
}

impl dyn Watch + '_ {
    /// An error once the work is to end.
    ///
    /// # Errors
    /// [`Interrupted`] if so.
    #[inline]
    pub fn check(&self) -> Result<(), Interrupted> {
        if self.is_stopped() { Err(Interrupted) } else { Ok(()) }
    }
}

/// No watch: the work goes on to its end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Unwatched;

impl Watch for Unwatched {
    fn begin(&self, _: Work) {}

    fn advance(&self, _: u64) {}

    fn is_stopped(&self) -> bool {
        false
    }
}

/// Work inside work that has its own progress: asks another [`Watch`] whether to go on, and tells it nothing.
#[derive(Clone, Copy, Debug)]
pub struct Unreported<'a>(pub &'a dyn Watch);

impl Watch for Unreported<'_> {
    fn begin(&self, _: Work) {}

    fn advance(&self, _: u64) {}

    fn is_stopped(&self) -> bool {
        self.0.is_stopped()
    }
}

/// The work was ended from outside before it had a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("interrupted")]
pub struct Interrupted;

#[cfg(test)]
mod tests {
    use super::*;

    /// Stops work at once.
    #[derive(Debug)]
    struct Stopped;

    impl Watch for Stopped {
        fn begin(&self, _: Work) {}

        fn advance(&self, _: u64) {}

        fn is_stopped(&self) -> bool {
            true
        }
    }

    #[test]
    fn work_inside_work_is_stopped_with_it() {
        let check = |watch: &dyn Watch| watch.check();
        assert_eq!([check(&Unwatched), check(&Stopped)], [Ok(()), Err(Interrupted)]);
        assert_eq!([check(&Unreported(&Unwatched)), check(&Unreported(&Stopped))], [Ok(()), Err(Interrupted)]);
    }
}
