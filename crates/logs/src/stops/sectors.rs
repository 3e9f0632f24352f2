//! `sectors.csv`: the directions of the sectors of the robot's antenna.

use std::path::Path;

use sextant_channel::{SectorConfig, SectorTable};

use crate::csv::output::Output;
use crate::csv::table::{Table, TableRow};
use crate::csv::table_source::TableSource;
use crate::error::robot_log_error::RobotLogError;

const AZIMUTHS: [&str; 2] = ["azimuth_from_deg", "azimuth_to_deg"];
const ELEVATIONS: [&str; 2] = ["elevation_from_deg", "elevation_to_deg"];

/// Reads the sectors in a table.
pub(crate) fn read(source: TableSource<'_>, notes: &mut Vec<String>) -> Result<SectorTable, RobotLogError> {
    let table = Table::open(source, &["sector", AZIMUTHS[0], AZIMUTHS[1]], &ELEVATIONS)?;
    let sector = table.column("sector");
    let azimuths = AZIMUTHS.map(|name| table.column(name));
    let elevations = ELEVATIONS.map(|name| table.column(name));
    notes.extend(table.notes());
    let mut sectors: Vec<SectorConfig> = Vec::new();
    let head = table.rows(|row: &TableRow<'_>| {
        let angle = |column| row.finite(column)?.ok_or_else(|| row.wrong(column, "a finite number"));
        let id = row.sector(sector)?;
        let config = SectorConfig {
            sector: id.ok_or_else(|| row.wrong(sector, "a whole number from 0 to 255"))?,
            azimuth_from_deg: angle(azimuths[0])?,
            azimuth_to_deg: angle(azimuths[1])?,
            elevation_from_deg: row.finite(elevations[0])?.unwrap_or(-90.0),
            elevation_to_deg: row.finite(elevations[1])?.unwrap_or(90.0),
        };
        if let Err(wrong) = config.wedge() {
            let columns = [azimuths, elevations].concat();
            let name = AZIMUTHS.iter().chain(&ELEVATIONS).position(|name| *name == wrong.key).unwrap_or(0);
            return Err(row.wrong(columns[name], wrong.allowed()));
        }
        if sectors.iter().any(|other| other.sector == config.sector) {
            return Err(row.wrong(sector, "each sector once; this sector is already given above"));
        }
        sectors.push(config);
        Ok(())
    })?;
    SectorTable::new(sectors).map_err(|wrong| head.wrong_header(wrong.to_string()))
}

/// Writes `sectors` to the file `path`.
pub(crate) fn write(path: &Path, sectors: &SectorTable) -> Result<(), RobotLogError> {
    let mut output = Output::new(&["sector", AZIMUTHS[0], AZIMUTHS[1], ELEVATIONS[0], ELEVATIONS[1]]);
    for sector in sectors.iter() {
        output.text(&sector.sector.to_string());
        let azimuths = [sector.azimuth_from_deg, sector.azimuth_to_deg];
        for angle in azimuths.into_iter().chain([sector.elevation_from_deg, sector.elevation_to_deg]) {
            output.number(angle);
        }
        output.end();
    }
    output.save(path)
}
