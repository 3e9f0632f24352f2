//! The scenarios that ship with the program.

use std::path::Path;

use sextant_recording::disk;
use sextant_recording::output::{OutputError, write_file};

macro_rules! shipped {
    ($($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/", $name)))),*]
    };
}

/// The scenarios and the files that they name: path below the folder of scenarios, and text.
pub const SHIPPED: &[(&str, &str)] = shipped![
    "dmtm/anchors-hs-greenhouse.toml",
    "dmtm/anchors-hs-warehouse.toml",
    "dmtm/anchors-improved-greenhouse.toml",
    "dmtm/anchors-improved-warehouse.toml",
    "dmtm/anchors-ss-greenhouse.toml",
    "dmtm/anchors-ss-warehouse.toml",
    "dmtm/clear-racks-warehouse.toml",
    "dmtm/comparison-greenhouse.toml",
    "dmtm/comparison-warehouse.toml",
    "dmtm/faults-deaths.toml",
    "dmtm/faults-liars.toml",
    "dmtm/faults-loss.toml",
    "dmtm/heard-greenhouse.toml",
    "dmtm/heard-warehouse.toml",
    "dmtm/hs-greenhouse.toml",
    "dmtm/hs-warehouse.toml",
    "dmtm/improved-greenhouse.toml",
    "dmtm/improved-rf.toml",
    "dmtm/improved-warehouse.toml",
    "dmtm/mmtm-greenhouse.toml",
    "dmtm/mmtm-warehouse.toml",
    "dmtm/optimised-anchors.toml",
    "dmtm/rf.toml",
    "dmtm/scattering-greenhouse.toml",
    "dmtm/scattering-warehouse.toml",
    "dmtm/ss-greenhouse.toml",
    "dmtm/ss-warehouse.toml",
    "ml-tm/circular.toml",
    "ml-tm/classics.toml",
    "ml-tm/comparison-circular.toml",
    "ml-tm/comparison-concave.toml",
    "ml-tm/comparison-sparse.toml",
    "ml-tm/concave.toml",
    "ml-tm/cylinder.toml",
    "ml-tm/odometry-drift.toml",
    "ml-tm/sensitivity.toml",
    "ml-tm/sparse.toml",
    "ml-tm/sphere.toml",
    "ml-tm/trajectory-hilbert.toml",
    "ml-tm/trajectory-random.toml",
    "ml-tm/trajectory-s.toml",
    "ml-tm/trajectory-spiral.toml",
    "ml-tm/two-robots.toml",
    "mmtm/comparison-greenhouse.toml",
    "mmtm/comparison-warehouse.toml",
    "mmtm/few-anchors-greenhouse.toml",
    "mmtm/few-anchors-warehouse.toml",
    "mmtm/greenhouse-3d.toml",
    "mmtm/greenhouse-871.toml",
    "mmtm/greenhouse-nodes.csv",
    "mmtm/greenhouse-vaa.toml",
    "mmtm/greenhouse-vbs.toml",
    "mmtm/one-sweep-greenhouse-3d.toml",
    "mmtm/one-sweep-greenhouse-vaa.toml",
    "mmtm/one-sweep-greenhouse-vbs.toml",
    "mmtm/one-sweep-warehouse-3d.toml",
    "mmtm/one-sweep-warehouse-vaa.toml",
    "mmtm/one-sweep-warehouse-vbs.toml",
    "mmtm/sectors-greenhouse-3d.toml",
    "mmtm/sectors-greenhouse-vaa.toml",
    "mmtm/sectors-greenhouse-vbs.toml",
    "mmtm/sectors-warehouse-3d.toml",
    "mmtm/sectors-warehouse-vaa.toml",
    "mmtm/sectors-warehouse-vbs.toml",
    "mmtm/two-bands.toml",
    "mmtm/warehouse-3d.toml",
    "mmtm/warehouse-881-nodes.csv",
    "mmtm/warehouse-881.toml",
    "mmtm/warehouse-nodes.csv",
    "mmtm/warehouse-vaa.toml",
    "mmtm/warehouse-vbs.toml",
    "seek/maps.toml",
    "seek/obstacles.toml",
    "seek/one-source.toml",
    "seek/pioneer.toml",
    "seek/slow-robot.toml",
    "seek/space.toml",
    "seek/two-sources.toml",
    "target/case-1.toml",
    "target/case-2.toml",
    "target/case-3.toml",
    "target/elements-1.toml",
    "target/elements-2.toml",
    "target/elements-3.toml",
    "target/filters.toml",
    "target/imperfect-sensors.toml",
    "target/map-then-search.toml",
    "target/maps.toml",
    "target/several.toml",
    "target/speeds-1.toml",
    "target/speeds-2.toml",
    "target/speeds-3.toml",
    "target/thesis-1.toml",
    "target/thesis-2.toml",
    "target/thesis-3.toml",
    "target/thesis-family-1.toml",
    "target/thesis-family-2.toml",
    "target/thesis-family-3.toml",
    "target/walls.toml",
];

/// Writes the scenarios into `folder`, so that the user can read and change them.
///
/// # Errors
/// If a file cannot be written.
pub fn write_scenarios(folder: &Path) -> Result<(), OutputError> {
    for (name, text) in SHIPPED {
        let path = folder.join(name);
        if let Some(above) = path.parent() {
            disk::create_folders(above).map_err(|error| OutputError::new(above, &error))?;
        }
        write_file(&path, text.as_bytes())?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scenario_of_the_chapters_ships() {
        let scenarios = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
        let mut names = Vec::new();
        for folder in ["dmtm", "ml-tm", "mmtm", "seek", "target"] {
            let files = std::fs::read_dir(scenarios.join(folder)).unwrap();
            names.extend(files.map(|file| format!("{folder}/{}", file.unwrap().file_name().to_str().unwrap())));
        }
        names.sort();
        let mut shipped: Vec<_> = SHIPPED.iter().map(|(name, _)| (*name).to_owned()).collect();
        shipped.sort();
        assert_eq!(shipped, names);
    }
}
