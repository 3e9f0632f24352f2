//! Whether each setting of a sweep has its effect, and each cell is another one.

use std::collections::BTreeMap;

use sextant_scenario::{ReplacedSetting, ScenarioError, Setting};

use super::facts::CellFacts;

/// Refuses cells with a setting that has no effect, and cells with the same settings.
pub(super) fn check_effects(
    set: &[String],
    cells: &[Vec<Setting>],
    facts: &[CellFacts],
) -> Result<(), ScenarioError> {
    let mut known: BTreeMap<[u8; 32], usize> = BTreeMap::new();
    for (number, (settings, cell)) in cells.iter().zip(facts).enumerate() {
        let own = |setting: usize| setting.checked_sub(set.len()).map(|own| settings[own].line());
        let replaced = |replaced: &ReplacedSetting| Some((own(replaced.setting)?, own(replaced.by)?));
        if let Some((setting, by)) = cell.replaced.iter().find_map(replaced) {
            let message = format!("the setting `{setting}` of cell {number} has no effect: `{by}` replaces it");
            return Err(ScenarioError::new(message).help("vary only one of them, or the later one first"));
        }
        if let Some(first) = known.insert(cell.settings, number) {
            let [one, other] = [first, number].map(|cell| line(&cells[cell]));
            let message = format!("cells {first} ({one}) and {number} ({other}) have the same settings");
            return Err(
                ScenarioError::new(message).help("remove one of the values: the runs of both would be the same")
            );
        }
    }
    Ok(())
}

/// Refuses settings of `set` that have no effect in any cell.
pub(super) fn check_set(set: &[String], facts: &[CellFacts]) -> Result<(), ScenarioError> {
    for (number, setting) in set.iter().enumerate() {
        let is_replaced = |cell: &CellFacts| cell.replaced.iter().any(|replaced| replaced.setting == number);
        if !facts.is_empty() && facts.iter().all(is_replaced) {
            let message = format!("the setting `{setting}` has no effect: a later one replaces it in each cell");
            return Err(ScenarioError::new(message).help("remove it, or what replaces it"));
        }
    }
    Ok(())
}

/// The settings of a cell in one line.
fn line(settings: &[Setting]) -> String {
    let lines: Vec<_> = settings.iter().map(|setting| format!("`{}`", setting.line())).collect();
    if lines.is_empty() { "as written".to_owned() } else { lines.join(", ") }
}

#[cfg(test)]
mod tests {
    use sextant_scenario::ScenarioErrors;

    use crate::sweep::{ColumnKind, Sweep};

    fn read(axes: &str, set: &[&str]) -> Result<Sweep, ScenarioErrors> {
        let folder = tempfile::tempdir().unwrap();
        let smoke = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/smoke.toml");
        let path = folder.path().join("s.toml");
        std::fs::write(&path, format!("extends = {smoke:?}\n[sweep]\n{axes}")).unwrap();
        let set: Vec<String> = set.iter().map(ToString::to_string).collect();
        Sweep::read(&path, &set, None, None)
    }

    fn refused(axes: &str) -> String {
        read(axes, &[]).map(|_| ()).unwrap_err().to_string()
    }

    #[test]
    fn cells_with_the_same_settings_are_refused_however_they_are_written() {
        let said = refused("product.radio.tx_power_dbm = [-50, -45, -50.0]");
        assert!(said.contains("cells 0 (`radio.tx_power_dbm=-50`) and 2 (`radio.tx_power_dbm=-50.0`)"), "{said}");
        let said = refused("list = [{}, { channel.max_range_m = 5 }, { \"robots.0.speed_m_per_s\" = 1 }, {}]");
        assert!(said.contains("(as written)") && said.contains("have the same settings"), "{said}");
    }

    #[test]
    fn keys_that_replace_each_other_are_refused() {
        let trapezoid = "{ trapezoid = { p0 = 0.8, plateau_m = 2.0, range_m = 6.0 } }";
        let said = refused(&format!(
            "product.maps.0.algorithm.ml_tm.profile.trapezoid.p0 = [0.5, 0.6]\n\
             zip.maps.0.algorithm.ml_tm.profile = [{trapezoid}]"
        ));
        assert!(said.contains("trapezoid.p0=0.5` of cell 0 has no effect"), "{said}");
        let said = refused("product.\"robots.0.speed_m_per_s\" = [1, 2]\nzip.\"robots[0].speed_m_per_s\" = [3]");
        assert!(said.contains("`robots.0.speed_m_per_s=1` of cell 0 has no effect"), "{said}");
        let said = refused(
            "product.channel.path_loss.log_distance.exponent = [2, 3]\nzip.channel.path_loss.close_in.exponent = [3]\n\
             zip.channel.path_loss.close_in.carrier_ghz = [2.4]",
        );
        assert!(
            said.contains("log_distance.exponent=2` of cell 0 has no effect: `channel.path_loss.close_in"),
            "{said}"
        );
    }

    #[test]
    fn a_cell_has_the_values_of_what_only_others_set() {
        let axes = "list = [{ channel.max_range_m = 5 }, { \"robots.0.speed_m_per_s\" = 2 }, \
                    { channel.path_loss.close_in = { carrier_ghz = 2.4, exponent = 2 } }, \
                    { channel.path_loss.log_distance.reference_loss_db = 1.5 }]";
        let sweep = read(axes, &["radio.sensitivity_dbm=-85"]).unwrap();
        let value = |cell: usize, end: &str| {
            let key = sweep.keys().iter().position(|key| key.name.ends_with(end)).unwrap();
            sweep.values(cell)[key].clone()
        };
        // From the file, a default, and nothing where another law is chosen.
        assert_eq!(
            ["max_range_m", "speed_m_per_s", "reference_loss_db"].map(|end| value(0, end)),
            ["5", "1.0", "0.0"]
        );
        assert_eq!(["max_range_m", "speed_m_per_s", "carrier_ghz"].map(|end| value(1, end)), ["6.0", "2", ""]);
        assert_eq!(["carrier_ghz", "reference_loss_db"].map(|end| value(2, end)), ["2.4", ""]);
        assert_eq!(sweep.keys()[1].kind, ColumnKind::Real);
    }

    #[test]
    fn settings_that_replace_a_whole_table_say_what_they_leave_out() {
        let set = "channel.path_loss={ log_distance = { exponent = 3 } }";
        let profile = "{ trapezoid = { p0 = 0.8, plateau_m = 2.0 , range_m = 5.0 } }";
        let axes = format!(
            "product.maps.0.algorithm = [{{ ml_tm = {{ grid_step_m = 0.5, profile = {profile} }} }}, \"weighted_centroid\"]"
        );
        let said = read(&axes, &[set, "anchors.share=0.5"]).unwrap().left_out().unwrap();
        assert_eq!(said.len(), 2, "{said:?}");
        assert!(said[0].contains("`channel.path_loss.log_distance.reference_loss_db` of the file"), "{said:?}");
        assert!(
            said[1].ends_with("`maps.0.algorithm`: `maps.0.algorithm.ml_tm.counts` of the file has no effect"),
            "{said:?}"
        );
        // What is replaced by another choice is meant to be.
        let said = read("", &["channel.path_loss={ close_in = { carrier_ghz = 2.4, exponent = 2 } }"])
            .unwrap()
            .left_out()
            .unwrap();
        assert_eq!(said, [""; 0]);
    }
}
