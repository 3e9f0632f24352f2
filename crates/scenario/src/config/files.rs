//! The files that the settings of a scenario name.

use std::path::PathBuf;

use sextant_apps::MapSourceConfig;
use sextant_apps::routing::TreeConfig;
use sextant_sim::MacConfig;

use super::ScenarioConfig;

impl ScenarioConfig {
    /// The files that its settings name, each with its key.
    pub(crate) fn files_mut(&mut self) -> Vec<(String, &mut PathBuf)> {
        let Self { world, applications, traffic, routing, antenna, link_trace, mac, networks, .. } = self;
        let mut files: Vec<(String, &mut PathBuf)> = Vec::new();
        files.extend(world.files_mut().map(|(key, file)| (format!("world.{key}"), file)));
        for (i, application) in applications.iter_mut().enumerate() {
            if let MapSourceConfig::File(file) = &mut application.map {
                files.push((format!("applications[{i}].map.file"), file));
            }
        }
        let mut of_traffic: Vec<_> = traffic.iter_mut().map(|traffic| ("traffic".to_owned(), traffic)).collect();
        let mut of_antennas: Vec<_> = antenna.iter_mut().map(|antenna| ("antenna".to_owned(), antenna)).collect();
        files.extend(link_trace.iter_mut().map(|trace| ("link_trace.file".to_owned(), &mut trace.file)));
        if let Some(TreeConfig::Given(given)) = routing.as_mut().map(|routing| &mut routing.tree) {
            files.push(("routing.tree.given.file".to_owned(), &mut given.file));
        }
        files.extend(mac.files_mut().map(|(key, file)| (format!("mac.{key}"), file)));
        for (name, network) in networks {
            let key = |table: &str| format!("networks.{name}.{table}");
            files.extend(network.link_trace.iter_mut().map(|trace| (key("link_trace.file"), &mut trace.file)));
            let of_mac = network.mac.iter_mut().flat_map(MacConfig::files_mut);
            files.extend(of_mac.map(|(file_key, file)| (key(&format!("mac.{file_key}")), file)));
            of_traffic.extend(network.traffic.iter_mut().map(|traffic| (key("traffic"), traffic)));
            of_antennas.extend(network.antenna.iter_mut().map(|antenna| (key("antenna"), antenna)));
        }
        for (table, traffic) in of_traffic {
            files.extend(traffic.files_mut().into_iter().map(|(key, file)| (format!("{table}.{key}"), file)));
        }
        for (table, antenna) in of_antennas {
            files.extend(antenna.files_mut().map(|(key, file)| (format!("{table}.{key}"), file)));
        }
        files
    }
}
