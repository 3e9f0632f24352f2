//! Long work beside the interpreter: it goes on without it, is seen and can be stopped.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::ThreadPoolBuilder;
use sextant::kernel::{Watch, Work};

use crate::error::failed_inside;

/// How often signals are looked at and progress is told.
const LOOK: Duration = Duration::from_millis(50);

/// Stops work because of an exception, which is raised when the work has ended.
#[derive(Debug, Default)]
pub(crate) struct Brake {
    is_stopped: AtomicBool,
    failure: Mutex<Option<PyErr>>,
}

impl Brake {
    /// Stops the work because of `error`. Of several, the first counts.
    pub(crate) fn fail(&self, error: PyErr) {
        self.failure.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
        self.is_stopped.store(true, Ordering::Relaxed);
    }

    /// Whether the work was stopped.
    pub(crate) fn is_stopped(&self) -> bool {
        self.is_stopped.load(Ordering::Relaxed)
    }
}

/// Sees long work, and stops it.
#[derive(Debug, Default)]
pub(crate) struct Supervisor {
    brake: Arc<Brake>,
    done: AtomicU64,
    work: Mutex<Option<(&'static str, u64)>>,
}

impl Supervisor {
    /// What stops the work, for programs of the user.
    pub(crate) fn brake(&self) -> Arc<Brake> {
        Arc::clone(&self.brake)
    }

    fn work(&self) -> Option<(&'static str, u64)> {
        *self.work.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Tells how far the work is.
    pub(crate) fn set(&self, name: &'static str, steps: u64, done: u64) {
        *self.work.lock().unwrap_or_else(PoisonError::into_inner) = Some((name, steps));
        self.done.store(done, Ordering::Relaxed);
    }
}

impl Watch for Supervisor {
    fn begin(&self, work: Work) {
        self.set(work.name, work.steps, 0);
    }

    fn advance(&self, steps: u64) {
        self.done.fetch_add(steps, Ordering::Relaxed);
    }

    fn is_stopped(&self) -> bool {
        self.brake.is_stopped()
    }
}

/// Does `work` in threads of its own, so that the interpreter is free, a child of a fork has its own threads, and Ctrl-C is
/// seen. `progress` is called with the name of the work, the steps that are done and all steps. An exception, of a signal,
/// of `progress` or of a program of the user, stops the work, and is raised when it has ended.
pub(crate) fn supervised<T: Send>(
    py: Python<'_>,
    threads: Option<usize>,
    progress: Option<&Py<PyAny>>,
    work: impl FnOnce(&Supervisor) -> T + Send,
) -> PyResult<T> {
    let pool = ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).thread_name(|_| "sextant".to_owned());
    let pool = pool.build().map_err(|why| PyRuntimeError::new_err(format!("threads cannot be started: {why}")))?;
    let supervisor = Supervisor::default();
    let done = py.detach(|| {
        thread::scope(|scope| {
            let (ended, wait) = channel();
            let (pool, supervisor) = (&pool, &supervisor);
            let worker = scope.spawn(move || {
                let done = catch_unwind(AssertUnwindSafe(|| pool.install(|| work(supervisor))));
                // Nobody waits any more only if the other side has failed.
                let _ = ended.send(());
                done
            });
            let mut told = None;
            while wait.recv_timeout(LOOK) == Err(RecvTimeoutError::Timeout) {
                if let Err(error) = Python::attach(|py| look(py, supervisor, progress, &mut told)) {
                    supervisor.brake.fail(error);
                }
            }
            worker.join().and_then(|done| done)
        })
    });
    if let Some(error) = supervisor.brake.failure.lock().unwrap_or_else(PoisonError::into_inner).take() {
        return Err(error);
    }
    done.map_err(|panic| failed_inside(panic.as_ref()))
}

/// Does `work` without the interpreter. That it fails inside is an exception.
pub(crate) fn guarded<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    caught(|| Ok(py.detach(work)))
}

/// Does `work` with the interpreter. That it fails inside is an exception.
pub(crate) fn caught<T>(work: impl FnOnce() -> PyResult<T>) -> PyResult<T> {
    caught_as(work, failed_inside)
}

/// The same with an exception of its own.
pub(crate) fn caught_as<T>(
    work: impl FnOnce() -> PyResult<T>,
    exception: impl FnOnce(&(dyn Any + Send)) -> PyErr,
) -> PyResult<T> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| Err(exception(panic.as_ref())))
}

/// Lets signals be handled, and tells the progress if it has changed.
fn look(
    py: Python<'_>,
    supervisor: &Supervisor,
    progress: Option<&Py<PyAny>>,
    told: &mut Option<(&'static str, u64)>,
) -> PyResult<()> {
    py.check_signals()?;
    let (Some(progress), Some((name, steps))) = (progress, supervisor.work()) else { return Ok(()) };
    let done = supervisor.done.load(Ordering::Relaxed).min(steps);
    if told.replace((name, done)) != Some((name, done)) && !supervisor.is_stopped() {
        progress.call1(py, (name, done, steps))?;
    }
    Ok(())
}
