//! The generator of random numbers of a program.

use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use sextant::kernel::StationId;
use sextant::scenario::Scenario;
use sextant::sim::program_seed;

/// A seed that follows from that of the run and from the station, and a generator of Python with it.
pub(super) struct Seeded {
    seed: u128,
    generator: PyOnceLock<Py<PyAny>>,
}

impl Seeded {
    pub(super) fn new(scenario: &Scenario, station: StationId) -> Self {
        Self { seed: program_seed(scenario.seed(), station), generator: PyOnceLock::new() }
    }

    pub(super) fn seed(&self) -> u128 {
        self.seed
    }

    /// The generator: the same one at each call.
    pub(super) fn generator(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        let generator = self.generator.get_or_try_init(py, || {
            Ok::<_, PyErr>(py.import("random")?.call_method1("Random", (self.seed,))?.unbind())
        });
        Ok(generator?.clone_ref(py))
    }
}
