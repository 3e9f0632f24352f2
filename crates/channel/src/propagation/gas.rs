//! Loss by the gases of the air.

use sextant_kernel::SettingError;

/// Loss by the gases of the air, as written in a scenario: in proportion to the length of a link.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum GasConfig {
    /// None.
    #[default]
    None,
    /// Oxygen, and water vapour of 7.5 g/m³, at sea level; carriers up to 100 GHz.
    SeaLevel,
    /// This loss (dB/km).
    DbPerKm(f64),
}

/// Loss by oxygen at the frequencies from 53 GHz in steps of 1 GHz (dB/km), 0 below and above: 3GPP TR 38.901 V17,
/// Table 7.6.1-1.
const OXYGEN_DB_PER_KM: [f64; 15] = [1.0, 2.2, 4.0, 6.6, 9.7, 12.6, 14.6, 15.0, 14.6, 14.3, 10.5, 6.8, 3.9, 1.9, 1.0];
const OXYGEN_FROM_GHZ: f64 = 53.0;

/// The rest of the air, mostly water vapour of 7.5 g/m³ (GHz, dB/km): rounded from Recommendation ITU-R P.676; not
/// verified against its tables.
const REST_DB_PER_KM: [[f64; 2]; 3] = [[28.0, 0.1], [70.0, 0.5], [73.0, 0.4]];

impl GasConfig {
    /// Loss (dB/km) at the carrier.
    ///
    /// # Errors
    /// If the loss is negative or the carrier is above 100 GHz; the key is below the one of the gas.
    pub fn db_per_km(self, carrier_ghz: f64) -> Result<f64, SettingError> {
        match self {
            Self::None => Ok(0.0),
            Self::DbPerKm(loss_db) => SettingError::in_range("db_per_km", loss_db, 0.0, 1e6),
            Self::SeaLevel if carrier_ghz <= 100.0 => Ok(oxygen_db_per_km(carrier_ghz) + rest_db_per_km(carrier_ghz)),
            Self::SeaLevel => {
                let found = format!("\"sea_level\" at {carrier_ghz} GHz");
                Err(SettingError::new("", found, "a carrier of at most 100 GHz, or `db_per_km`"))
            }
        }
    }
}

fn oxygen_db_per_km(carrier_ghz: f64) -> f64 {
    let at = |step: f64| {
        let inside = step >= 0.0 && step < OXYGEN_DB_PER_KM.len() as f64;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a step inside the table")]
        if inside { OXYGEN_DB_PER_KM[step as usize] } else { 0.0 }
    };
    let steps = carrier_ghz - OXYGEN_FROM_GHZ;
    let below = steps.floor();
    at(below) + (steps - below) * (at(below + 1.0) - at(below))
}

fn rest_db_per_km(carrier_ghz: f64) -> f64 {
    let [first, .., last] = REST_DB_PER_KM;
    if carrier_ghz <= first[0] {
        return first[1] * (carrier_ghz / first[0]) * (carrier_ghz / first[0]);
    }
    for pair in REST_DB_PER_KM.windows(2) {
        let ([low, a], [high, b]) = (pair[0], pair[1]);
        if carrier_ghz <= high {
            return a + (carrier_ghz - low) / (high - low) * (b - a);
        }
    }
    last[1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn oxygen_follows_its_table_and_is_linear_in_between() {
        for (ghz, db_per_km) in
            [(28.0, 0.0), (52.0, 0.0), (53.0, 1.0), (60.0, 15.0), (60.5, 14.8), (64.0, 6.8), (67.0, 1.0), (68.0, 0.0)]
        {
            assert!((oxygen_db_per_km(ghz) - db_per_km).abs() < 1e-12, "{ghz}: {}", oxygen_db_per_km(ghz));
        }
    }

    #[test]
    fn the_air_takes_what_its_figures_say() {
        for (ghz, db_per_km) in [(28.0, 0.1), (70.0, 0.5), (73.0, 0.4), (100.0, 0.4), (14.0, 0.025)] {
            assert!((GasConfig::SeaLevel.db_per_km(ghz).unwrap() - db_per_km).abs() < 1e-12);
        }
        assert!((GasConfig::SeaLevel.db_per_km(60.0).unwrap() - 15.405).abs() < 1e-3);
        assert!(GasConfig::SeaLevel.db_per_km(101.0).is_err());
        assert_eq!(GasConfig::DbPerKm(-1.0).db_per_km(60.0).unwrap_err().key, "db_per_km");
        assert_eq!(GasConfig::None.db_per_km(300.0), Ok(0.0));
    }
}
