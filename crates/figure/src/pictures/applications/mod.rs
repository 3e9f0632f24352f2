//! Pictures of applications: who went where, targets and fields, and what came of it over time.

pub(crate) mod application;
pub(crate) mod application_curves;
pub(crate) mod field;
pub(crate) mod targets;
