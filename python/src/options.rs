//! How the log of a robot is read, as keywords of Python.

use std::fmt::Display;
use std::str::FromStr;

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyString};
use sextant::logs::{BagClock, FieldNames, ReadOptions};

use crate::entries::each_entry_of_dict;
use crate::whole::whole_u32;

/// The keywords that are known.
const KNOWN: &str = "stop_every, packet_interval, path, packets, packet_fields, path_fields, range_fields, stop_files, time_zone, missing, \
                     node_columns, reciprocal, transmitter, noise_floor, lora, packet_delay, skip_no_fix, rssi_missing, \
                     pose_topic, child_frame, fixed_frame, packet_topic, range_topic, bag_clock, pan, fcs";

/// The options of keywords, which are those of the flags of `sextant map` with `_` for `-`.
pub(crate) fn read_options(keywords: &Bound<'_, PyDict>) -> PyResult<ReadOptions> {
    let mut options = ReadOptions::default();
    each_entry_of_dict(keywords, "an option", |name, value| {
        if value.is_none() {
            return Ok(());
        }
        let given = Keyword { name: &name, value };
        // Robots of a log that Python reads have one frame.
        let ReadOptions { stop_every, packet_interval_s, form, repair, bag, sniffer, frames: _ } = &mut options;
        match name.as_str() {
            "stop_every" => *stop_every = given.parsed()?,
            "packet_interval" => {
                *packet_interval_s =
                    Some(given.number(|span_s| (1e-6..=1e6).contains(&span_s), "seconds from 1e-6 to 1e6")?);
            }
            "path" => form.path = Some(given.value.extract()?),
            "packets" => form.packets = Some(given.value.extract()?),
            "packet_fields" => form.packet_fields = Some(given.fields(FieldNames::parse_packets)?),
            "path_fields" => form.path_fields = Some(given.fields(FieldNames::parse_places)?),
            "range_fields" => form.range_fields = Some(given.fields(FieldNames::parse_ranges)?),
            "stop_files" => form.stop_files = Some(given.parsed()?),
            "time_zone" => form.time_zone = Some(given.parsed()?),
            "missing" => form.missing = given.list()?,
            "node_columns" => form.node_columns = given.list()?,
            "reciprocal" => form.reciprocal = given.flag()?,
            "transmitter" => form.transmitter = Some(given.text()?),
            "noise_floor" => form.noise_floor = Some(given.parsed()?),
            "lora" => form.lora = given.flag()?,
            "packet_delay" => repair.packet_delay = given.parsed()?,
            "skip_no_fix" => repair.skip_no_fix = given.flag()?,
            "rssi_missing" => repair.rssi_missing = given.list()?,
            "pose_topic" => bag.pose_topic = Some(given.text()?),
            "child_frame" => bag.child_frame = Some(given.text()?),
            "fixed_frame" => bag.fixed_frame = Some(given.text()?),
            "packet_topic" => bag.packet_topic = Some(given.text()?),
            "range_topic" => bag.range_topic = Some(given.text()?),
            "bag_clock" => {
                bag.bag_clock = Some(match given.text()?.as_str() {
                    "stamp" => BagClock::Stamp,
                    "log" => BagClock::Log,
                    _ => return Err(given.refused("\"stamp\" or \"log\"")),
                });
            }
            "fcs" => sniffer.fcs = Some(given.parsed()?),
            "pan" => sniffer.pan = u16::try_from(whole_u32("pan", &given.value, 0..=u32::from(u16::MAX))?).ok(),
            _ => {
                return Err(PyTypeError::new_err(format!("there is no option `{name}`; options: {KNOWN}")));
            }
        }
        Ok(())
    })?;
    Ok(options)
}

/// A keyword and its value.
struct Keyword<'a, 'py> {
    name: &'a str,
    value: Bound<'py, PyAny>,
}

impl Keyword<'_, '_> {
    fn refused(&self, allowed: impl Display) -> PyErr {
        let found = self.value.repr().map_or_else(|_| "unknown".to_owned(), |found| found.to_string());
        PyValueError::new_err(format!("`{}` is {found}; allowed: {allowed}", self.name))
    }

    fn text(&self) -> PyResult<String> {
        Ok(self.value.str()?.to_str()?.to_owned())
    }

    fn flag(&self) -> PyResult<bool> {
        if self.value.is_instance_of::<PyBool>() {
            self.value.is_truthy()
        } else {
            Err(self.refused("True or False"))
        }
    }

    fn number(&self, is_allowed: impl Fn(f64) -> bool, allowed: &str) -> PyResult<f64> {
        let number = if self.value.is_instance_of::<PyBool>() { None } else { self.value.extract().ok() };
        number.filter(|&number| is_allowed(number)).ok_or_else(|| self.refused(allowed))
    }

    fn parsed<T: FromStr<Err: Display>>(&self) -> PyResult<T> {
        self.text()?.parse().map_err(|why: T::Err| self.refused(why))
    }

    /// One value or several.
    fn list<T: FromStr<Err: Display>>(&self) -> PyResult<Vec<T>> {
        let parsed = |item: Bound<'_, PyAny>| item.str()?.to_str()?.parse().map_err(|why: T::Err| self.refused(why));
        if self.value.is_instance_of::<PyString>() || self.value.try_iter().is_err() {
            return Ok(vec![parsed(self.value.clone())?]);
        }
        self.value.try_iter()?.map(|item| parsed(item?)).collect()
    }

    /// The names of columns: `KEY=NAME,..`, or a dict.
    fn fields<E: Display>(&self, parse: impl Fn(&str) -> Result<FieldNames, E>) -> PyResult<FieldNames> {
        let text = match self.value.cast::<PyDict>() {
            Ok(names) => {
                let mut pairs = Vec::new();
                each_entry_of_dict(names, "a field", |key, name| {
                    pairs.push(format!("{key}={}", name.str()?.to_str()?));
                    Ok(())
                })?;
                pairs.join(",")
            }
            Err(_) => self.text()?,
        };
        parse(&text).map_err(|why| self.refused(why))
    }
}
