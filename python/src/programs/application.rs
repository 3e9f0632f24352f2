//! An application of a station in Python.

use std::sync::Arc;

use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use sextant::scenario::Scenario;
use sextant::sim::{self, Application, NetworkId, Timer};

use super::events::{Announcement, Delivery, DriveEnd, SendReport, Sensed, SweepAnswer};
use super::port::{Port, with_port};
use super::radio_event::RadioEvent;
use crate::names::Names;
use crate::work::Brake;

/// Tells an object of Python what happens at its station. Methods that its class does not have are not called.
pub(super) struct PyApplication {
    methods: Methods,
    has_task: bool,
    port: Py<Port>,
    names: Arc<Names>,
    brake: Arc<Brake>,
}

/// The bound methods that the class has.
struct Methods {
    started: Option<Py<PyAny>>,
    ended: Option<Py<PyAny>>,
    timer: Option<Py<PyAny>>,
    delivered: Option<Py<PyAny>>,
    sent: Option<Py<PyAny>>,
    radio: Option<Py<PyAny>>,
    sensed: Option<Py<PyAny>>,
    drive_ended: Option<Py<PyAny>>,
    swept: Option<Py<PyAny>>,
    announced: Option<Py<PyAny>>,
    listened: Option<Py<PyAny>>,
}

impl Methods {
    fn of(object: &Bound<'_, PyAny>) -> PyResult<Self> {
        let base = object.py().import("sextant")?.getattr("Application")?;
        let class = object.get_type();
        let own = |name: &str| -> PyResult<Option<Py<PyAny>>> {
            let is_own = match (class.getattr(name), base.getattr(name)) {
                (Ok(own), Ok(base)) => !own.is(&base),
                (Ok(_), Err(_)) => true,
                (Err(_), _) => false,
            };
            if is_own { Ok(Some(object.getattr(name)?.unbind())) } else { Ok(None) }
        };
        Ok(Self {
            started: own("started")?,
            ended: own("ended")?,
            timer: own("timer")?,
            delivered: own("delivered")?,
            sent: own("sent")?,
            radio: own("radio")?,
            sensed: own("sensed")?,
            drive_ended: own("drive_ended")?,
            swept: own("swept")?,
            announced: own("announced")?,
            listened: own("listened")?,
        })
    }
}

impl PyApplication {
    pub(super) fn new(
        py: Python<'_>,
        (station, object): (&str, Py<PyAny>),
        scenario: &Scenario,
        names: Arc<Names>,
        brake: Arc<Brake>,
    ) -> PyResult<Self> {
        let object = object.bind(py);
        let has_task = object.getattr("has_task").is_ok_and(|has_task| has_task.is_truthy().unwrap_or(false));
        let port = Py::new(py, Port::new(station, scenario, Arc::clone(&names)))?;
        Ok(Self { methods: Methods::of(object)?, has_task, port, names, brake })
    }

    /// Calls a method, if the class has it, with what `told` makes.
    fn call<T>(&self, method: Option<&Py<PyAny>>, port: &mut sim::Port<'_>, told: impl FnOnce(&Names) -> T)
    where
        T: for<'py> Told<'py>,
    {
        let Some(method) = method.filter(|_| !self.brake.is_stopped()) else { return };
        let called = Python::attach(|py| {
            let told = told(&self.names);
            with_port(port, || told.call(py, method.bind(py), self.port.bind(py)))
        });
        if let Err(error) = called {
            self.brake.fail(error);
        }
    }
}

/// What a method is told beside its port.
trait Told<'py> {
    fn call(self, py: Python<'py>, method: &Bound<'py, PyAny>, port: &Bound<'py, Port>) -> PyResult<()>;
}

/// Nothing.
struct Nothing;

impl<'py> Told<'py> for Nothing {
    fn call(self, _: Python<'py>, method: &Bound<'py, PyAny>, port: &Bound<'py, Port>) -> PyResult<()> {
        method.call1((port,)).map(drop)
    }
}

/// One value.
struct One<T>(T);

impl<'py, T: IntoPyObject<'py>> Told<'py> for One<T> {
    fn call(self, py: Python<'py>, method: &Bound<'py, PyAny>, port: &Bound<'py, Port>) -> PyResult<()> {
        let told = self.0.into_bound_py_any(py)?;
        method.call1((told, port)).map(drop)
    }
}

/// A network, and a value of it.
struct InNetwork<T>(NetworkId, T);

impl<'py, T: IntoPyObject<'py>> Told<'py> for InNetwork<T> {
    fn call(self, py: Python<'py>, method: &Bound<'py, PyAny>, port: &Bound<'py, Port>) -> PyResult<()> {
        let told = self.1.into_bound_py_any(py)?;
        method.call1((self.0.0, told, port)).map(drop)
    }
}

impl Application for PyApplication {
    fn hears(&self) -> bool {
        self.methods.delivered.is_some()
    }

    fn senses(&self) -> bool {
        self.methods.sensed.is_some()
    }

    fn has_task(&self) -> bool {
        self.has_task
    }

    fn started(&mut self, port: &mut sim::Port<'_>) {
        self.call(self.methods.started.as_ref(), port, |_| Nothing);
    }

    fn ended(&mut self, port: &mut sim::Port<'_>) {
        self.call(self.methods.ended.as_ref(), port, |_| Nothing);
    }

    fn timed(&mut self, timer: Timer, port: &mut sim::Port<'_>) {
        self.call(self.methods.timer.as_ref(), port, |_| One(timer.0));
    }

    fn delivered(&mut self, delivery: &sim::Delivery<'_>, port: &mut sim::Port<'_>) {
        self.call(self.methods.delivered.as_ref(), port, |names| One(Delivery::new(delivery, names)));
    }

    fn sent(&mut self, network: NetworkId, report: &sim::SendReport, port: &mut sim::Port<'_>) {
        self.call(self.methods.sent.as_ref(), port, |names| One(SendReport::new(network.0, report, names)));
    }

    fn radio(&mut self, network: NetworkId, event: &sim::RadioEvent<'_>, port: &mut sim::Port<'_>) {
        match event {
            sim::RadioEvent::Received(frame) if self.methods.radio.is_none() => {
                self.delivered(&frame.delivery, port);
            }
            event => {
                self.call(self.methods.radio.as_ref(), port, |names| One(RadioEvent::new(network, event, names)));
            }
        }
    }

    fn sensed(&mut self, sensed: &sim::Sensed, port: &mut sim::Port<'_>) {
        self.call(self.methods.sensed.as_ref(), port, |_| One(Sensed::from(sensed)));
    }

    fn drive_ended(&mut self, end: sim::DriveEnd, port: &mut sim::Port<'_>) {
        self.call(self.methods.drive_ended.as_ref(), port, |_| One(DriveEnd::from(end)));
    }

    fn swept(&mut self, network: NetworkId, answers: &[sim::SweepAnswer], port: &mut sim::Port<'_>) {
        let told = |names: &Names| {
            let answers: Vec<SweepAnswer> = answers.iter().map(|answer| SweepAnswer::new(answer, names)).collect();
            InNetwork(network, answers)
        };
        self.call(self.methods.swept.as_ref(), port, told);
    }

    fn announced(&mut self, announcement: &sim::Announcement, port: &mut sim::Port<'_>) {
        self.call(self.methods.announced.as_ref(), port, |names| One(Announcement::new(announcement, names)));
    }

    fn listened(&mut self, network: NetworkId, port: &mut sim::Port<'_>) {
        self.call(self.methods.listened.as_ref(), port, |_| One(network.0));
    }
}
