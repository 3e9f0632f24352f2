//! The methods of the chapter, and the offsets of the sensors.

use super::super::runs::Term;
use sextant::summary::{ApplicationSummary, Measure, Number};

/// A method of source seeking: an application of the scenarios.
#[derive(Debug)]
pub(super) struct Method {
    pub(super) name: &'static str,
    application: &'static str,
}

impl Method {
    /// Whether it is the method of the thesis, with its numbers or ours.
    pub(super) fn is_level_set(&self) -> bool {
        self.application != GRADIENT.application
    }
}

/// The level-set law with a rate of climb that adapts to the field.
pub(super) const LEVEL_SET: Method = Method { name: "level set, our preset", application: "level-set" };

/// The level-set law with the numbers of the thesis.
pub(super) const THESIS: Method = Method { name: "level set, thesis' numbers", application: "level-set-thesis" };

/// The gradient method.
pub(super) const GRADIENT: Method = Method { name: "gradient", application: "gradient" };

/// All of them.
pub(super) const METHODS: &[&Method] = &[&LEVEL_SET, &THESIS, &GRADIENT];

/// The setting of the offsets.
const KEY: &str = "sensors.fields.offset_snr_db";

/// The ratio of signal to offset of the sensors, with its value as in tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Snr {
    /// So large that there are practically no offsets.
    NoOffsets,
    /// 30 dB.
    Db30,
    /// 20 dB.
    Db20,
    /// 10 dB.
    Db10,
}

impl Snr {
    /// From no offsets to the largest.
    pub(super) const ALL: &'static [Self] = &[Self::NoOffsets, Self::Db30, Self::Db20, Self::Db10];

    pub(super) fn words(self) -> &'static str {
        match self {
            Self::NoOffsets => "no offsets",
            Self::Db30 => "30 dB",
            Self::Db20 => "20 dB",
            Self::Db10 => "10 dB",
        }
    }

    /// Its value in sweeps.
    fn written(self) -> &'static str {
        match self {
            Self::NoOffsets => "200.0",
            Self::Db30 => "30.0",
            Self::Db20 => "20.0",
            Self::Db10 => "10.0",
        }
    }

    /// Where it is in figures (dB).
    pub(super) fn drawn_db(self) -> f64 {
        match self {
            Self::NoOffsets => 40.0,
            Self::Db30 => 30.0,
            Self::Db20 => 20.0,
            Self::Db10 => 10.0,
        }
    }
}

/// A number of a method in a cell of a scenario.
pub(super) fn term(
    scenario: &'static str,
    method: &Method,
    snr: Snr,
    number: &'static Number<ApplicationSummary>,
) -> Term {
    Term {
        settings: vec![(KEY, snr.written().to_owned())],
        ..Term::new(scenario, Measure::OfApplication(method.application, number))
    }
}
