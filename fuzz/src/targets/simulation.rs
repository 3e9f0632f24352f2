//! A small scenario made of choices.

use arbitrary::{Result, Unstructured};
use sextant::Scenario;

use crate::budget::is_small;
use crate::properties::{errors_are_clear, runs};

/// Text that is written piece by piece.
struct Text<'a, 'b> {
    choices: &'a mut Unstructured<'b>,
    text: String,
}

/// Whether nodes send of their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Technology {
    /// They have traffic.
    Stations,
    /// They answer sector sweeps, and send nothing else.
    Sweeps,
}

/// The scenario is refused with clear errors, or it runs with all properties of a run.
pub(crate) fn check(octets: &[u8]) {
    let Ok(text) = scenario(&mut Unstructured::new(octets)) else { return };
    let _shown = Shown(&text);
    match Scenario::parse(&text).and_then(|scenario| scenario.check_grids().map(|()| scenario)) {
        Ok(scenario) if is_small(&scenario) => runs(&scenario),
        Ok(_) => {}
        Err(errors) => errors_are_clear(&errors),
    }
}

/// A scenario that is shown if a property does not hold.
struct Shown<'a>(&'a str);

impl Drop for Shown<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!("the scenario:\n{}", self.0);
        }
    }
}

/// The scenario that the octets choose.
pub(crate) fn scenario(choices: &mut Unstructured<'_>) -> Result<String> {
    let mut text = Text { choices, text: String::new() };
    let seed = text.choices.arbitrary::<u8>()?;
    let duration_s = text.of(&["0.05", "0.5", "2.0", "7.5"])?;
    text.line(&format!("name = \"chosen\"\nseed = {seed}\nduration_s = {duration_s}"));
    text.nodes()?;
    text.obstacles()?;
    text.network()?;
    if text.stations()? > 0 {
        text.maps()?;
    }
    text.recording()?;
    Ok(text.text)
}

impl Text<'_, '_> {
    fn of<'c>(&mut self, choices: &[&'c str]) -> Result<&'c str> {
        self.choices.choose(choices).copied()
    }

    fn line(&mut self, line: &str) {
        self.text.push_str(line);
        self.text.push('\n');
    }

    /// One of these lines; an empty one is none.
    fn line_of(&mut self, lines: &[&str]) -> Result<()> {
        let line = self.of(lines)?;
        self.line(line);
        Ok(())
    }

    /// A coordinate (m): quarters of a metre, 32 m at most.
    fn coordinate(&mut self) -> Result<f64> {
        Ok(f64::from(self.choices.arbitrary::<i8>()?) / 4.0)
    }

    fn place(&mut self) -> Result<String> {
        let (x_m, y_m) = (self.coordinate()?, self.coordinate()?);
        Ok(format!("[{x_m:?}, {y_m:?}]"))
    }

    fn nodes(&mut self) -> Result<()> {
        let count = self.choices.int_in_range(1..=8_u8)?;
        match self.choices.int_in_range(0..=2_u8)? {
            0 => {
                let places = (0..count).map(|_| self.place()).collect::<Result<Vec<_>>>()?;
                self.line(&format!("[world.nodes.explicit]\npositions_m = [{}]", places.join(", ")));
            }
            1 => self.line(&format!(
                "[world.nodes.lattice]\nspacing_m = 2.0\njitter_m = 0.4\ncount = {count}\n\
                 region.rectangle = {{ min_m = [0.0, 0.0], max_m = [12.0, 10.0] }}"
            )),
            _ => self.line(&format!(
                "[world.nodes.random]\ncount = {count}\nmin_distance_m = 0.1\nregion.disc = {{ center_m = [3.0, 3.0], radius_m = 9.0 }}"
            )),
        }
        Ok(())
    }

    fn obstacles(&mut self) -> Result<()> {
        for index in 0..self.choices.int_in_range(0..=2_u8)? {
            let material = self.of(&["concrete", "metal", "wood", "glass"])?;
            let (center, place) = (self.place()?, self.coordinate()?);
            let center = center.replace(']', ", 0.0]");
            let size = 0.5 + place.abs() / 8.0;
            self.line(&format!("[[world.obstacles]]\nname = \"o{index}\"\nmaterial = \"{material}\""));
            let shape = if self.choices.arbitrary::<bool>()? {
                format!("shape.box = {{ center_m = {center}, size_m = [{size:?}, 1.0, 2.0] }}")
            } else {
                format!("shape.cylinder = {{ base_m = {center}, radius_m = {size:?}, height_m = 2.0 }}")
            };
            self.line(&shape);
        }
        Ok(())
    }

    fn network(&mut self) -> Result<()> {
        let tx_dbm = self.of(&["-50.0", "0.0", "-20.0"])?;
        self.line(&format!("[radio]\ntx_power_dbm = {tx_dbm}\nsensitivity_dbm = -90.0"));
        self.line("[channel]");
        self.line_of(&["max_range_m = 6.0", "", "max_range_m = 40.0"])?;
        self.line_of(&["environment = \"light-tree\"", "environment = \"suburban\"", ""])?;
        self.line_of(&[
            "path_loss.log_distance = { exponent = 3.1, reference_loss_db = 0.0 }",
            "path_loss.log_distance = { exponent = 2.0, reference_loss_db = 40.05 }",
            "path_loss.close_in = { exponent = 2.1, carrier_ghz = 2.4 }",
        ])?;
        self.line_of(&[
            "shadowing.sigma_db = 0.0",
            "shadowing = { sigma_db = 3.0, correlation = \"per_link\" }",
            "shadowing = { sigma_db = 4.0, correlation.spatial = { distance_m = 3.0 } }",
        ])?;
        if self.mac()? == Technology::Stations {
            self.traffic()?;
        }
        self.line_of(&[
            "",
            "[reception.sinr_threshold]\nthreshold_db = 3.0",
            "[reception.overlap]",
            "[reception.ber]",
        ])
    }

    fn mac(&mut self) -> Result<Technology> {
        match self.choices.int_in_range(0..=5_u8)? {
            0..=2 => {
                self.line("[mac.csma_unslotted]");
                self.line_of(&["", "queue_frames = 1", "queue_frames = 10"])?;
                self.line_of(&["", "rx_on_when_idle = true"])?;
                self.line_of(&["", "max_backoffs = 0", "max_retries = 0"])?;
            }
            3 => {
                let order =
                    self.of(&["beacon_order = 4\nsuperframe_order = 2", "beacon_order = 3\nsuperframe_order = 3"])?;
                self.line(&format!("[mac.beacon_enabled]\n{order}"));
                self.line_of(&["", "gts = [{ node = \"n0\" }]"])?;
            }
            _ => {
                self.line("[mac.sector_sweep]");
                for (stations, sectors) in [("nodes", ["1", "4"]), ("robots", ["8", "3"])] {
                    let sectors = self.of(&sectors)?;
                    self.line(&format!("[antenna.{stations}.sectors]\nazimuth_sectors = {sectors}"));
                    self.line("boresight_gain_dbi = 4.1\npattern.flat_top = {}");
                }
                return Ok(Technology::Sweeps);
            }
        }
        Ok(Technology::Stations)
    }

    fn traffic(&mut self) -> Result<()> {
        let octets = self.choices.int_in_range(9..=128_u8)?;
        let acknowledged = self.of(&["", "acknowledged = true\n"])?;
        let kind = self.of(&[
            "beacon]\ninterval_s = 1.0\njitter = 0.1\n",
            "periodic]\ninterval_s = 0.02\n",
            "poisson]\nrate_per_s = 20.0\n",
            "saturated]\n",
            "once]\nat_s = 0.01\n",
            "silent]\n",
        ])?;
        if kind.starts_with("silent") {
            self.line("[traffic.silent]");
        } else {
            let own = if kind.starts_with("beacon") { "" } else { acknowledged };
            self.line(&format!("[traffic.{kind}mpdu_octets = {octets}\n{own}"));
        }
        Ok(())
    }

    /// Sinks and robots, at least one of them. Returns the number of robots.
    fn stations(&mut self) -> Result<u8> {
        let robots = self.choices.int_in_range(0..=2_u8)?;
        for index in 0..self.choices.int_in_range(u8::from(robots == 0)..=2_u8)? {
            let place = self.place()?;
            self.line(&format!("[[sinks]]\nname = \"sink{index}\"\nposition_m = {place}"));
        }
        for index in 0..robots {
            let place = self.place()?;
            self.line(&format!("[[robots]]\nname = \"robot{index}\"\nstart_m = {place}"));
            self.line_of(&["listen_s = 0.3", "listen_s = 1.2", "listen_s = 0.01"])?;
            self.line_of(&["", "speed_m_per_s = 20.0", "radius_m = 0.2"])?;
            self.line_of(&[
                "controller.s_path = { lane_spacing_m = 6.0, overshoot_m = 2.0, region.rectangle = { min_m = [0.0, 0.0], max_m = [12.0, 10.0] } }",
                "controller.waypoints = { places_m = [[0.0, 0.0], [5.0, 1.0], [5.0, 1.0], [-2.0, 8.0]] }",
                "controller.automated_s = { step_m = 2.0, lane_spacing_m = 5.0, until = \"swept\" }",
                "controller.spiral = { lane_spacing_m = 6.0, region.disc = { center_m = [3.0, 3.0], radius_m = 6.0 } }",
            ])?;
        }
        Ok(robots)
    }

    fn maps(&mut self) -> Result<()> {
        for _ in 0..self.choices.int_in_range(0..=2_u8)? {
            let algorithm = self.of(&[
                "ml_tm = { grid_step_m = 1.0, profile.trapezoid = { p0 = 0.9, plateau_m = 1.0, range_m = 6.0 } }",
                "ml_tm = { grid_step_m = 1.0, estimate = \"posterior_mean\", profile.fitted = {} }",
                "packet_centroid = {}",
                "auto = {}",
                "mmtm = { grid_step_m = 1.0, profile.fitted = {} }",
                "strongest_stop = {}",
                "tpm = {}",
            ])?;
            let number = self.text.len();
            self.line(&format!("[[maps]]\nname = \"m{number}\"\nalgorithm.{algorithm}"));
        }
        Ok(())
    }

    fn recording(&mut self) -> Result<()> {
        self.line("[recording]");
        self.line_of(&["", "frames = true"])?;
        self.line_of(&["", "packets = true"])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sextant_kernel::{Purpose, Seed};

    /// Octets at random.
    fn octets(number: u64) -> Vec<u8> {
        let word = |i: u64| Seed(number).bits(Purpose::new(1), [i, 0, 0]).to_le_bytes();
        (0..32).flat_map(word).collect()
    }

    #[test]
    fn a_third_of_all_choices_make_a_scenario_that_is_small_and_accepted() {
        let mut refusals = Vec::new();
        let mut is_run = |number| {
            let octets = octets(number);
            let text = scenario(&mut Unstructured::new(&octets)).expect("choices");
            let checked = Scenario::parse(&text).and_then(|scenario| scenario.check_grids().map(|()| scenario));
            let scenario = checked.inspect_err(|errors| refusals.push(errors.errors()[0].to_string()));
            scenario.is_ok_and(|scenario| is_small(&scenario))
        };
        let accepted = (0..90).filter(|&number| is_run(number)).count();
        assert!(accepted >= 30, "{accepted} of 90: {refusals:#?}");
    }
}
