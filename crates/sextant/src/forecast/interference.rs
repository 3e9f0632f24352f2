//! Interferers that disturb nobody.

use sextant_sim::UnheardInterferer;

use super::network::Reach;
use super::warning::Warnings;

impl Warnings<'_> {
    /// Interferers in other bands than the networks, and those that are farther from all stations than the channel reaches.
    pub(super) fn unheard_interferers(&mut self, reaches: &[Reach<'_>]) {
        let in_other_bands = self.setup.unheard_interferers();
        for UnheardInterferer { number, spectrum_mhz: [from, to], channels_mhz: [lowest, highest] } in &in_other_bands
        {
            let name = self.setup.world.interferers[*number].name();
            let channels = if lowest.total_cmp(highest).is_lt() {
                format!("of the networks, which are at {lowest} to {highest} MHz")
            } else {
                format!("of the networks, which are at {lowest} MHz")
            };
            self.warn(
                format!("interferers[{number}]"),
                format!(
                    "no station can hear `{name}`: its spectrum, {from} to {to} MHz, does not reach into any radio channel \
                     {channels}; give it the `channel` or `center_mhz` of a network, or remove it"
                ),
            );
        }
        let stands = self.setup.world.motions.is_empty() && self.setup.robots.is_empty();
        for (number, interferer) in self.setup.world.interferers.iter().enumerate().filter(|_| stands) {
            let place = interferer.position();
            let nearest_m = |reach: &Reach<'_>| {
                let nodes = reach.nodes.iter().map(|(_, place)| *place);
                let sinks = self.setup.sinks.iter().filter(|sink| sink.is_in(reach.id)).map(|sink| sink.position);
                nodes.chain(sinks).map(|station| station.distance_m(place)).fold(f64::INFINITY, f64::min)
            };
            let is_far = |reach: &Reach<'_>| nearest_m(reach) > reach.law().max_range_m();
            if in_other_bands.iter().all(|unheard| unheard.number != number) && reaches.iter().all(is_far) {
                let name = interferer.name();
                let distance_m = reaches.iter().map(nearest_m).fold(f64::INFINITY, f64::min);
                self.warn(
                    format!("interferers[{number}].position_m"),
                    format!(
                        "no station can hear `{name}`: the nearest one is {distance_m:.1} m away, beyond `channel.max_range_m`"
                    ),
                );
            }
        }
    }
}
