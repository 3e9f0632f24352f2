//! Batteries: how much is left of a capacity, and how long it lasts.

mod cell;
mod charge;
mod discharge;

use std::time::Duration;

use sextant_kernel::SettingError;

pub use cell::Cell;
pub use charge::Charge;
pub use discharge::{DischargeConfig, KibamConfig, PeukertConfig};

use discharge::Discharge;

/// Hours of a year of 365 days.
const HOURS_OF_A_YEAR: f64 = 8760.0;

/// Seconds of an hour.
const SECONDS_OF_AN_HOUR: f64 = 3600.0;

/// Voltage of a battery that is given by its capacity alone (V): that of the chips.
const USUAL_V: f64 = 3.0;

/// A capacity, as written in a scenario: by one of its keys.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Capacity {
    /// Charge (mAh).
    pub capacity_mah: Option<f64>,
    /// Energy (J).
    pub capacity_j: Option<f64>,
}

impl Capacity {
    /// The charge (C) at a voltage; `None` if no capacity is written.
    ///
    /// # Errors
    /// If there are two, or one is not positive.
    pub fn coulombs(self, voltage_v: f64) -> Result<Option<f64>, SettingError> {
        match (self.capacity_mah, self.capacity_j) {
            (Some(_), Some(_)) => Err(SettingError::conflict("capacity_j", "`capacity_mah`", "set one of them")),
            (Some(mah), None) => Ok(Some(SettingError::positive("capacity_mah", mah)? * 1e-3 * SECONDS_OF_AN_HOUR)),
            (None, Some(joules)) => Ok(Some(SettingError::positive("capacity_j", joules)? / voltage_v)),
            (None, None) => Ok(None),
        }
    }
}

/// A battery, full: its capacity, its voltage, and how it is discharged.
#[derive(Clone, Debug, PartialEq)]
pub struct Battery {
    capacity_c: f64,
    voltage_v: f64,
    discharge: Discharge,
    /// Rate at which it loses what is left (1/s).
    leak_per_s: f64,
}

/// What a battery is made of, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BatterySettings {
    /// The cell whose numbers are taken where none are given.
    pub cell: Option<Cell>,
    /// The capacity; that of the cell if absent.
    pub capacity: Capacity,
    /// The voltage (V).
    pub voltage_v: Option<f64>,
    /// Share of what is left that is lost in a year without load.
    pub self_discharge_per_year: Option<f64>,
    /// How it is discharged.
    pub model: DischargeConfig,
}

impl TryFrom<BatterySettings> for Battery {
    type Error = SettingError;

    fn try_from(settings: BatterySettings) -> Result<Self, SettingError> {
        let BatterySettings { cell, capacity, voltage_v, self_discharge_per_year, model } = settings;
        let usual_v = cell.map_or(USUAL_V, Cell::voltage_v);
        let voltage_v = SettingError::positive("voltage_v", voltage_v.unwrap_or(usual_v))?;
        let of_cell = || cell.map(|cell| cell.capacity_mah() * 1e-3 * SECONDS_OF_AN_HOUR);
        let capacity_c = capacity.coulombs(voltage_v)?.or_else(of_cell);
        let capacity_c = capacity_c
            .ok_or_else(|| SettingError::missing("capacity_mah", "`capacity_mah`, `capacity_j` or `cell`"))?;
        let is_kibam = matches!(model, DischargeConfig::Kibam(_));
        let leak = match self_discharge_per_year {
            Some(_) if is_kibam => {
                let remedy = "remove one of the two: the kinetic model has no self-discharge";
                return Err(SettingError::conflict("self_discharge_per_year", "`model.kibam`", remedy));
            }
            Some(share) if !(0.0..1.0).contains(&share) => {
                return Err(SettingError::new("self_discharge_per_year", share, "0 to less than 1"));
            }
            Some(share) => share,
            None if is_kibam => 0.0,
            None => cell.map_or(0.0, Cell::self_discharge_per_year),
        };
        let discharge = Discharge::try_from(model).map_err(|error| error.within("model"))?;
        let leak_per_s = -libm::log1p(-leak) / (HOURS_OF_A_YEAR * SECONDS_OF_AN_HOUR);
        Ok(Self { capacity_c, voltage_v, discharge, leak_per_s })
    }
}

impl Battery {
    /// The same of another capacity (C).
    #[must_use]
    pub fn with_capacity(&self, capacity_c: f64) -> Self {
        Self { capacity_c, ..self.clone() }
    }

    /// Its capacity (C).
    #[must_use]
    pub const fn capacity_c(&self) -> f64 {
        self.capacity_c
    }

    /// Its capacity (J).
    #[must_use]
    pub fn capacity_j(&self) -> f64 {
        self.capacity_c * self.voltage_v
    }

    /// Its voltage (V), which is taken as constant.
    #[must_use]
    pub const fn voltage_v(&self) -> f64 {
        self.voltage_v
    }

    /// What is in it when it is full.
    #[must_use]
    pub fn full(&self) -> Charge {
        self.discharge.full(self.capacity_c)
    }

    /// What is left (J).
    #[must_use]
    pub fn left_j(&self, charge: &Charge) -> f64 {
        charge.left_c().max(0.0) * self.voltage_v
    }

    /// Draws `energy_j` evenly over `span`: exact for a constant current.
    pub fn draw(&self, charge: &mut Charge, energy_j: f64, span: Duration) {
        let span_s = span.as_secs_f64();
        if span_s > 0.0 {
            let current_a = energy_j / (self.voltage_v * span_s);
            *charge = self.discharge.after(self.capacity_c, self.leak_per_s, charge, current_a, span_s);
        }
    }

    /// Time in which it cannot run empty with at most this power (s); infinite without a load.
    #[must_use]
    pub fn lasts_at_least_s(&self, charge: &Charge, most_w: f64) -> f64 {
        let drain_a = self.discharge.drain_a(self.capacity_c, most_w / self.voltage_v);
        charge.available_c().max(0.0) / (drain_a + self.leak_per_s * charge.left_c())
    }

    /// The longest time over which a changing current may be averaged (s).
    #[must_use]
    pub fn averaged_s(&self) -> f64 {
        self.discharge.averaged_s()
    }

    /// How long it lasts from full with a constant load (s); infinite without one.
    #[must_use]
    pub fn lifetime_s(&self, power_w: f64) -> f64 {
        let current_a = power_w / self.voltage_v;
        if current_a > 0.0 {
            self.discharge.lifetime_s(self.capacity_c, self.leak_per_s, current_a)
        } else {
            f64::INFINITY
        }
    }
}

#[cfg(test)]
mod tests;
