//! Loss by the gases of the air.

use std::sync::LazyLock;

use sextant_kernel::SettingError;

/// Loss by the gases of the air, as written in a scenario: in proportion to the length of a link.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum GasConfig {
    /// None.
    #[default]
    None,
    /// Oxygen, and water vapour of 7.5 g/m³, at sea level and 15 °C (Recommendation ITU-R P.676); carriers up to 100 GHz.
    SeaLevel,
    /// This loss (dB/km).
    DbPerKm(f64),
}

/// Loss by the gases of the air at sea level: 1013.25 hPa, 15 °C, 7.5 g/m³ of water vapour. Worked out line by line by Recommendation
/// ITU-R P.676-13 (2022), annex 1, equations 1 to 9, with the 44 lines of oxygen of its Table 1 and the 35 lines of water vapour of its
/// Table 2. Between its rows, the logarithm of the loss is linear in that of the carrier, which is off by 1 % at most.
const TABLE: &str = include_str!("sea_level.csv");

/// A row of the table: carrier (GHz) and loss (dB/km).
type Row = [f64; 2];

static SEA_LEVEL: LazyLock<Vec<Row>> = LazyLock::new(|| {
    let number = |text: &str| -> f64 { text.parse().expect("a number in the table of gases") };
    let row = |line: &str| line.split_once(';').map(|(carrier, loss)| [number(carrier), number(loss)]);
    TABLE.lines().skip(1).map(|line| row(line).expect("two numbers in each row of the table of gases")).collect()
});

impl GasConfig {
    /// Loss (dB/km) at the carrier.
    ///
    /// # Errors
    /// If the loss is negative or the carrier is above 100 GHz; the key is below the one of the gas.
    pub fn db_per_km(self, carrier_ghz: f64) -> Result<f64, SettingError> {
        match self {
            Self::None => Ok(0.0),
            Self::DbPerKm(loss_db) => SettingError::in_range("db_per_km", loss_db, 0.0, 1e6),
            Self::SeaLevel if carrier_ghz <= 100.0 => Ok(sea_level_db_per_km(carrier_ghz)),
            Self::SeaLevel => {
                let found = format!("\"sea_level\" at {carrier_ghz} GHz");
                Err(SettingError::new("", found, "a carrier of at most 100 GHz, or `db_per_km`"))
            }
        }
    }
}

/// Below the table, the loss is as the square of the carrier.
fn sea_level_db_per_km(carrier_ghz: f64) -> f64 {
    let after = SEA_LEVEL.partition_point(|row| row[0] < carrier_ghz);
    let [high_ghz, high_db] = SEA_LEVEL[after.min(SEA_LEVEL.len() - 1)];
    if after == 0 {
        return high_db * (carrier_ghz / high_ghz) * (carrier_ghz / high_ghz);
    }
    let [low_ghz, low_db] = SEA_LEVEL[after - 1];
    let share = libm::log(carrier_ghz / low_ghz) / libm::log(high_ghz / low_ghz);
    low_db * libm::pow(high_db / low_db, share)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(carrier_ghz: f64) -> f64 {
        GasConfig::SeaLevel.db_per_km(carrier_ghz).expect("up to 100 GHz")
    }

    #[test]
    fn the_air_takes_what_the_recommendation_says() {
        // Worked out line by line, apart from the table: beside the lines of water vapour and oxygen, on them, and between the rows.
        for (ghz, db_per_km) in [
            (1.0, 0.005_36),
            (2.45, 0.007_10),
            (5.8, 0.009_139),
            (22.235, 0.193_3),
            (24.0, 0.173_3),
            (28.5, 0.097_8),
            (35.0, 0.100_3),
            (40.0, 0.129_4),
            (52.0, 0.725_0),
            (57.0, 10.117),
            (60.0, 14.656),
            (60.48, 14.996),
            (64.0, 6.944),
            (73.0, 0.388_1),
            (90.0, 0.377_3),
            (100.0, 0.454_0),
        ] {
            assert!((found(ghz) / db_per_km - 1.0).abs() < 0.012, "{ghz} GHz: {}", found(ghz));
        }
        assert!(GasConfig::SeaLevel.db_per_km(101.0).is_err());
        assert_eq!(GasConfig::DbPerKm(-1.0).db_per_km(60.0).unwrap_err().key, "db_per_km");
        assert_eq!(GasConfig::None.db_per_km(300.0), Ok(0.0));
    }

    #[test]
    fn the_table_rises_in_carrier_and_its_loss_is_continuous() {
        assert!(SEA_LEVEL.windows(2).all(|rows| rows[0][0] < rows[1][0] && rows[0][1] > 0.0));
        assert_eq!(SEA_LEVEL.last().expect("rows")[0].to_bits(), 100.0_f64.to_bits());
        for &[ghz, db_per_km] in SEA_LEVEL.iter() {
            for aside in [1.0 - 1e-9, 1.0] {
                assert!((found(ghz * aside) / db_per_km - 1.0).abs() < 1e-6, "{ghz}");
            }
        }
        assert!((found(0.05) / found(0.1) - 0.25).abs() < 1e-12);
    }
}
