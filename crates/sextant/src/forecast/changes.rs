//! What is likely a mistake in links that change in time.

use sextant_sim::RobotTask;

use super::network::Reach;
use super::warning::Warnings;

/// Share of a period of the Doppler shift within which a channel hardly changes.
const STEADY: f64 = 0.1;

/// Speed of light (m/s).
const LIGHT_M_PER_S: f64 = 299_792_458.0;

impl Warnings<'_> {
    /// Frames that last longer than their link stays as it is, measured links without robots, and those of nodes that move.
    pub(super) fn changes(&mut self, reach: &Reach<'_>) {
        let table = reach.table();
        self.fast_fading(reach, &table);
        let surveys = self
            .setup
            .robots
            .iter()
            .any(|robot| matches!(robot.task, RobotTask::Survey(_)) && robot.body.networks.contains(&reach.id));
        if surveys && reach.network.link_trace.as_ref().is_some_and(|trace| !trace.leaves_others()) {
            self.warn(
                format!("{table}link_trace.others"),
                "measured links have no rows for robots, so that they hear nothing; use `others = \"law\"`",
            );
        }
        if reach.is_measured() && !self.setup.world.motions.is_empty() {
            self.warn(
                "world.motions",
                "links with rows in `link_trace` do not depend on the places of nodes that move",
            );
        }
    }

    fn fast_fading(&mut self, reach: &Reach<'_>, table: &str) {
        let Some(fading) = reach.law().fading() else { return };
        let octets = reach.network.traffic.mpdu_octets();
        let Some(airtime) = reach.network.technology.airtime(octets.into()).filter(|_| octets > 0) else { return };
        let (airtime_ms, steady_ms) = (1e3 * airtime.as_secs_f64(), 1e3 * fading.steady_s());
        let tail = "each frame has the gain of its start";
        if airtime_ms > steady_ms {
            let key = if fading.is_in_blocks() { "block_s" } else { "doppler_hz" };
            self.warn(
                format!("{table}channel.fading.{key}"),
                format!("frames last {airtime_ms:.2} ms, and links stay as they are for {steady_ms:.2} ms: {tail}"),
            );
        }
        let wavelength_m = LIGHT_M_PER_S / reach.network.technology.reference_hz();
        let speed_m_per_s = self.setup.robots.iter().map(|robot| robot.body.speed_m_per_s).fold(0.0, f64::max);
        let moving_ms = 1e3 * STEADY * wavelength_m / speed_m_per_s;
        if airtime_ms > moving_ms && !fading.is_in_blocks() {
            self.warn(
                format!("{table}channel.fading"),
                format!(
                    "frames last {airtime_ms:.2} ms, and links stay as they are for {moving_ms:.2} ms while a robot drives at \
                     {speed_m_per_s} m/s: {tail}"
                ),
            );
        }
    }
}
