//! The signal-to-noise ratios of all sectors: `sector_snrs.csv`, or a column of `receptions.csv`.

use std::collections::BTreeMap;
use std::path::Path;

use sextant_channel::{ReceptionLog, SectorReport};
use sextant_kernel::NodeId;

use super::stop_table::Stops;
use crate::csv::output::Output;
use crate::csv::table::{Column, Table, TableRow};
use crate::csv::table_source::TableSource;
use crate::error::robot_log_error::RobotLogError;

/// The column of `receptions.csv`.
pub(crate) const COLUMN: &str = "sector_snr_db";
const COLUMNS: [&str; 4] = ["node", "stop", "sector", "snr_db"];
/// What a cell of the column may have.
const ALLOWED: &str = "pairs of a sector (0 to 255) and its SNR in dB, with spaces between them: `0:12.5 3:9.25`";

/// What is known of the log whose ratios are read.
#[derive(Clone, Copy)]
pub(crate) struct KnownParts<'a> {
    pub(crate) stops: &'a Stops,
    /// Name of the file or table of receptions, for messages.
    pub(crate) receptions: &'a str,
}

/// The sectors and ratios of a cell of the column of `receptions.csv`.
pub(crate) fn of_cell(row: &TableRow<'_>, column: Column) -> Result<Vec<(u8, f64)>, RobotLogError> {
    if !column.exists() {
        return Ok(Vec::new());
    }
    let pair = |text: &str| {
        let (sector, snr_db) = text.split_once(':')?;
        let snr_db: f64 = row.decimal(snr_db).parse().ok()?;
        Some((sector.parse().ok()?, Some(snr_db).filter(|snr_db| snr_db.is_finite())?))
    };
    let text = row.filled(column).unwrap_or_default();
    text.split_whitespace().map(|text| pair(text).ok_or_else(|| row.wrong(column, ALLOWED))).collect()
}

/// Reads the ratios in a table, of nodes and stops of `log`. Rows of stops that were left out are skipped.
pub(crate) fn read(
    source: TableSource<'_>,
    log: &ReceptionLog,
    KnownParts { stops, receptions }: KnownParts<'_>,
    notes: &mut Vec<String>,
) -> Result<Vec<SectorReport>, RobotLogError> {
    let table = Table::open(source, &COLUMNS, &[])?;
    let [node, stop, sector, snr_db] = COLUMNS.map(|name| table.column(name));
    notes.extend(table.notes());
    let nodes: BTreeMap<&str, NodeId> = (0..).map(NodeId).zip(log.names()).map(|(id, name)| (&**name, id)).collect();
    let mut reports = Vec::new();
    table.rows(|row| {
        let name = row.node(node)?;
        let &id = nodes.get(&*name).ok_or_else(|| row.wrong(node, format!("a node of {}", receptions)))?;
        let at = row.filled(stop).unwrap_or_default();
        if stops.left_out.contains(&*at) {
            return Ok(());
        }
        let &at = stops.ids.get(&*at).ok_or_else(|| row.wrong(stop, format!("a stop of {}", stops.name)))?;
        if log.at(id, at).is_none_or(|reception| reception.received == 0) {
            return Err(row.wrong(node, format!("a node that was heard at this stop, as {receptions} has it")));
        }
        let id_of_sector = row.sector(sector)?;
        let id_of_sector = id_of_sector.ok_or_else(|| row.wrong(sector, "a whole number from 0 to 255"))?;
        if let Some(known) = log.sectors().filter(|known| !known.contains(id_of_sector)) {
            return Err(row.wrong(sector, format!("a sector of the antenna: {}", known.identities())));
        }
        let ratio = row.finite(snr_db)?.ok_or_else(|| row.wrong(snr_db, "a finite number"))?;
        reports.push(SectorReport { node: id, stop: at, sector: id_of_sector, snr_db: ratio });
        Ok(())
    })?;
    Ok(reports)
}

/// Writes the ratios of `log` to the file `path`.
pub(crate) fn write(path: &Path, log: &ReceptionLog) -> Result<(), RobotLogError> {
    let mut output = Output::new(&COLUMNS);
    for (node, name) in (0..).map(NodeId).zip(log.names()) {
        for reception in log.of(node) {
            for snr in log.sector_snrs(node, reception.stop) {
                output.text(name).text(&reception.stop.to_string()).text(&snr.sector.to_string());
                // In single precision, as it is kept.
                output.text(&snr.snr_db.to_string()).end();
            }
        }
    }
    output.save(path)
}

#[cfg(test)]
mod tests {
    use sextant_channel::{EvenSectorsConfig, Reception, SectorGains, SectorTable};

    use super::*;
    use crate::ReadOptions;
    use crate::RobotLogError;
    use crate::test_kit::folder_of;

    const STOPS: &str = "stop,t_s,x_m,y_m\nA,0,0,0\nB,1,1,0\nC,2,2,0\n";
    const RECEPTIONS: &str = "node,stop,received,sector\nlamp,A,1,3\ndoor,B,1,0\nlamp,C,1,1\ndoor,C,0,\n";

    fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
        folder_of([("stops.csv", STOPS), ("receptions.csv", RECEPTIONS)].iter().chain(files).copied())
    }

    fn read(files: &[(&str, &str)]) -> ReceptionLog {
        crate::read(folder(files).path(), &ReadOptions::default()).unwrap().log
    }

    fn refusal(files: &[(&str, &str)]) -> String {
        let folder = folder(files);
        let why = crate::read(folder.path(), &ReadOptions::default()).unwrap_err();
        why.to_string().replace(&format!("{}/", folder.path().display()), "")
    }

    /// All reports: node, stop, sector, ratio (dB).
    fn reports(log: &ReceptionLog) -> Vec<(u32, u32, u8, f64)> {
        log.sector_reports().map(|report| (report.node.0, report.stop, report.sector, report.snr_db)).collect()
    }

    #[test]
    fn ratios_of_all_sectors_are_read_from_a_file_or_a_column() {
        let file = "stop,sector,node,snr_db\nA,3,lamp,12.5\nA,0,lamp,-3\nC,1,lamp,7.25\nB,0,door,1\nC,1,lamp,8.25\n";
        let column = "node,stop,received,sector_snr_db\nlamp,A,1,3:12.5 0:-3\ndoor,B,1, 0:1 \nlamp,C,1,1:7.25\n\
                      door,A,0,\nlamp,C,1,1:8.25\n";
        let expected = [(0, 0, 0, -3.0), (0, 0, 3, 12.5), (0, 2, 1, 7.75), (1, 1, 0, 1.0)];
        assert_eq!(reports(&read(&[("sector_snrs.csv", file)])), expected);
        assert_eq!(reports(&read(&[("receptions.csv", column)])), expected);
        assert!(!read(&[]).has_sector_snrs());
        let both = refusal(&[("receptions.csv", column), ("sector_snrs.csv", file)]);
        assert!(
            both.starts_with("sector_snrs.csv, line 1: receptions.csv has the column `sector_snr_db` too"),
            "{both}"
        );
    }

    #[test]
    fn a_decimal_comma_and_left_out_stops_are_read() {
        let column = "node;stop;received;sector_snr_db\nlamp;A;1;3:12,5 0:-3\n";
        assert_eq!(reports(&read(&[("receptions.csv", column)])), [(0, 0, 0, -3.0), (0, 0, 3, 12.5)]);
        let stops = "stop,t_s,lat,lon\nA,0,10,10\nB,1,,\nC,2,10,10\n";
        let file = "node,stop,sector,snr_db\nlamp,A,3,1\ndoor,B,0,1\n";
        let folder = folder(&[("stops.csv", stops), ("sector_snrs.csv", file)]);
        let mut options = ReadOptions::default();
        options.repair.skip_no_fix = true;
        let log = crate::read(folder.path(), &options).unwrap().log;
        assert_eq!(reports(&log), [(0, 0, 3, 1.0)]);
    }

    #[test]
    fn wrong_ratios_are_refused_with_file_line_and_column() {
        let file =
            |row: &str| refusal(&[("sector_snrs.csv", &format!("node,stop,sector,snr_db\nlamp,A,3,1\n{row}\n"))]);
        let at = |column: &str| format!("sector_snrs.csv, line 3, column `{column}`: found ");
        for (row, column, allowed) in [
            ("lamb,A,3,1", "node", "a node of receptions.csv"),
            ("door,C,3,1", "node", "a node that was heard at this stop"),
            ("door,A,3,1", "node", "a node that was heard at this stop"),
            ("lamp,Z,3,1", "stop", "a stop of stops.csv"),
            ("lamp,A,256,1", "sector", "a whole number from 0 to 255"),
            ("lamp,A,2,nan", "snr_db", "a finite number"),
            ("lamp,A,2,", "snr_db", "a finite number"),
        ] {
            let found = file(row);
            assert!(found.starts_with(&at(column)) && found.contains(allowed), "{row}: {found}");
        }
        let sectors = "sector,azimuth_from_deg,azimuth_to_deg\n0,0,90\n1,90,180\n3,180,360\n";
        let found =
            refusal(&[("sectors.csv", sectors), ("sector_snrs.csv", "node,stop,sector,snr_db\nlamp,A,2,1\n")]);
        assert!(found.contains("column `sector`: found `2`; allowed: a sector of the antenna: 0 to 1, 3"), "{found}");
        for cell in ["3", "3:", "3:x", ":4", "3:1,4:2", "300:1", "3:inf"] {
            let text = format!("node,stop,received,sector_snr_db\nlamp,A,1,\"{cell}\"\n");
            let found = refusal(&[("receptions.csv", &text)]);
            let start = format!("receptions.csv, line 2, column `sector_snr_db`: found `{cell}`; allowed: pairs");
            assert!(found.starts_with(&start), "{found}");
        }
        let silent = refusal(&[("receptions.csv", "node,stop,received,sector_snr_db\nlamp,A,0,3:1\n")]);
        assert!(silent.contains("an empty cell"), "{silent}");
    }

    #[test]
    fn an_antenna_gives_gains_and_without_sectors_csv_the_directions_too() {
        let antenna = "sectors.azimuth_sectors = 4\norientation.yaw_deg = 30\n";
        let table = read(&[("antenna.toml", antenna)]).sectors().unwrap().clone();
        let azimuths: Vec<f64> = table.iter().map(|sector| sector.azimuth_from_deg).collect();
        assert!(azimuths.iter().zip([-15.0, 75.0, 165.0, 255.0]).all(|(found, of)| (found - of).abs() < 1e-9));
        assert_eq!(table.gains().unwrap().identities(), [0, 1, 2, 3]);
        let sectors = "sector,azimuth_from_deg,azimuth_to_deg\n0,0,90\n1,90,180\n2,180,270\n3,270,360\n";
        let both = read(&[("antenna.toml", antenna), ("sectors.csv", sectors)]).sectors().unwrap().clone();
        assert!(both.iter().next().unwrap().azimuth_from_deg.abs() < 1e-12 && both.gains() == table.gains());
        let book = "sector,azimuth_deg,elevation_deg,gain_dbi\n0,0,0,1\n0,120,0,2\n0,240,0,-3\n3,0,0,1\n3,120,0,0\n\
                    3,240,0,5\n1,0,0,-1\n1,120,0,0\n1,240,0,-5\n";
        let log = read(&[("antenna.toml", "code_book.file = 'book.csv'"), ("book.csv", book)]);
        assert_eq!(log.sectors().unwrap().identities(), "0 to 1, 3");
        assert!(
            crate::read(
                folder(&[("antenna.toml", "code_book.file = 'book.csv'"), ("book.csv", book)]).path(),
                &ReadOptions::default()
            )
            .unwrap()
            .notes
            .iter()
            .any(|note| note.contains("all elevations"))
        );
    }

    #[test]
    fn a_wrong_antenna_is_refused_with_file_and_line() {
        for (antenna, problem) in [
            (
                "sectors.azimuth_sectors = 4\n\nsectors.gain_ripple = 2",
                "line 3: column 9: unknown field `gain_ripple`",
            ),
            ("# an antenna\n[sectors]\nazimuth_sectors = 400", "line 3: column 19: "),
            ("[sectors]\nazimuth_sectors = 65", "line 2: `sectors.azimuth_sectors` is 65; allowed: 1 to 64"),
            ("\ncode_book.file = 'none.csv'", "line 2: `code_book.file` is "),
            ("", "line 1: `sectors` is missing; needed: `sectors` or `code_book`"),
        ] {
            let found = refusal(&[("antenna.toml", antenna)]);
            assert!(found.starts_with(&format!("antenna.toml, {problem}")), "{found}");
        }
        let sectors = "sector,azimuth_from_deg,azimuth_to_deg\n0,0,90\n1,90,180\n3,180,360\n";
        let found = refusal(&[("antenna.toml", "sectors.azimuth_sectors = 4"), ("sectors.csv", sectors)]);
        let problem = "the antenna has sectors 0 to 3; allowed: the sectors of sectors.csv, 0 to 1, 3";
        assert_eq!(found, format!("antenna.toml, line 1: {problem}"));
    }

    #[test]
    fn gains_and_ratios_are_read_back_equal_from_a_folder() {
        let config: sextant_channel::ListenerAntennaConfig = toml::from_str(
            "orientation = { yaw_deg = 20.1, pitch_deg = -3 }\n\
             code_book = { azimuths_deg = [-120, 0, 120], elevations_deg = [-5, 5], outside_gain_dbi = -inf, sectors = [\n\
             { sector = 3, gain_dbi = [[1.1, 2.2, 3.3], [-1.1, 0.1, 9.9]] },\n\
             { sector = 61, gain_dbi = [[4, 0.1, -7e-3], [4, 5, 6]] }] }",
        )
        .unwrap();
        let gains = SectorGains::read(&config, &sextant_kernel::Files::default()).unwrap();
        let report = |node, stop, sector, snr_db| SectorReport { node: NodeId(node), stop, sector, snr_db };
        let log = read(&[]);
        let receptions: Vec<Reception> =
            log.receptions().iter().map(|one| Reception { sector: None, ..one }).collect();
        let log = ReceptionLog::new(log.names().to_vec(), log.stops().to_vec(), receptions, Vec::new()).unwrap();
        let reports = vec![report(0, 0, 3, 12.1), report(0, 0, 61, -0.25), report(1, 1, 3, 1e-3)];
        let log = log.with_sectors(SectorTable::from(gains)).and_then(|log| log.with_sector_snrs(reports)).unwrap();
        let parent = tempfile::tempdir().unwrap();
        crate::write(&parent.path().join("log"), &log).unwrap();
        assert_eq!(crate::read(&parent.path().join("log"), &ReadOptions::default()).unwrap().log, log);
    }

    #[test]
    fn ratios_beside_a_log_whose_stops_have_no_names_are_refused() {
        let folder = folder_of([
            ("path.csv", "t_s,x_m,y_m\n0,0,0\n9,9,0\n"),
            ("packets.csv", "t_s,node\n1,lamp\n2,lamp\n"),
            ("sector_snrs.csv", "node,stop,sector,snr_db\n"),
        ]);
        let why = crate::read(folder.path(), &ReadOptions::default()).unwrap_err();
        assert!(matches!(&why, RobotLogError::Row { problem, .. } if problem.contains("no names")), "{why}");
        std::fs::remove_file(folder.path().join("sector_snrs.csv")).unwrap();
        std::fs::write(folder.path().join("antenna.toml"), "sectors.azimuth_sectors = 6").unwrap();
        let log = crate::read(folder.path(), &ReadOptions::default()).unwrap().log;
        let even =
            EvenSectorsConfig { azimuth_sectors: 6, first_azimuth_deg: 0.0, elevations_deg: vec![[-90.0, 90.0]] };
        let even = SectorTable::try_from(even).unwrap();
        assert!(log.sectors().unwrap().iter().eq(even.iter()) && log.sectors().unwrap().gains().is_some());
    }
}
