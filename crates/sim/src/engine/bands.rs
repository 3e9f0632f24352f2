//! Which networks share a band, and the air of each band.

use std::time::Duration;

use sextant_channel::{Channel, Db, Dbm};
use sextant_kernel::{Seed, SettingError};

use crate::air::{AirSettings, Changes, ChangingLinks};
use crate::network::Network;
use crate::purpose;
use crate::station::Roll;
use crate::world::World;

/// Signals this far below the noise may be neglected.
pub(crate) const NEGLECTED_BELOW_NOISE: Db = Db(10.0);

/// A frame so far above the least power is received whatever the model of reception.
const SURELY_RECEIVED: Db = Db(10.0);

/// The networks of each band, in the order of their first networks.
///
/// # Errors
/// If networks that share a band have different channels, or one of them has sector sweeps.
pub(crate) fn bands(networks: &[Network]) -> Result<Vec<Vec<usize>>, SettingError> {
    let mut bands: Vec<Vec<usize>> = Vec::new();
    for (i, network) in networks.iter().enumerate() {
        let settings = network.technology.settings();
        let shares =
            |band: &&mut Vec<usize>| networks[band[0]].technology.settings().spectrum() == settings.spectrum();
        match bands.iter_mut().find(shares) {
            None => bands.push(vec![i]),
            Some(band) => {
                if let Some(what) = settings.unshared() {
                    let with = format!("that of network {}: it is the same radio channel", band[0]);
                    let remedy = format!("give each network with {what} its own");
                    return Err(SettingError::conflict(format!("networks[{i}].radio.channel"), with, remedy));
                }
                if networks[band[0]].channel != network.channel {
                    let with = format!("that of network {}, which is on the same radio channel", band[0]);
                    let remedy = "write the same table in both";
                    return Err(SettingError::conflict(format!("networks[{i}].channel"), with, remedy));
                }
                if networks[band[0]].link_trace != network.link_trace {
                    let with = format!("that of network {}, which is on the same radio channel", band[0]);
                    let remedy = "write the same table in both";
                    return Err(SettingError::conflict(format!("networks[{i}].link_trace"), with, remedy));
                }
                band.push(i);
            }
        }
    }
    Ok(bands)
}

/// Refuses settings of links that do not fit together.
pub(crate) fn check_links(networks: &[Network]) -> Result<(), SettingError> {
    networks.iter().enumerate().try_for_each(|(i, network)| {
        let checked = network.technology.settings().check();
        checked.map_err(|error| if i == 0 { error } else { error.within(format!("networks[{i}]")) })
    })
}

/// What all bands have in common.
pub(crate) struct Bands<'a> {
    pub(crate) world: &'a World,
    pub(crate) channel_seed: Seed,
    pub(crate) seed: Seed,
    /// Number of the round of a simulation: see [`Extras`](super::Extras).
    pub(crate) round: u64,
    /// Probability that a frame is lost, whatever its power.
    pub(crate) message_loss: f64,
    pub(crate) roll: Roll,
}

impl Bands<'_> {
    /// What changes the links of a network in time, and of those that share its band. All bands have the seed in common, so
    /// that radio channels near each other fade alike.
    fn changes(&self, network: &Network) -> Option<Changes> {
        let settings = network.technology.settings();
        let trace = network.link_trace.as_ref().map(|trace| {
            let needed = settings
                .reception_rules()
                .iter()
                .map(|rules| rules.least_power().to_dbm().0)
                .fold(f64::MIN, f64::max);
            trace.of(&self.roll, Dbm(needed) + SURELY_RECEIVED)
        });
        let links = ChangingLinks { seed: self.channel_seed, stations: self.roll.len() };
        Changes::of(&network.channel, settings.fading_band(), trace, links)
    }

    /// The air of the band number `band`, which `networks` share.
    pub(crate) fn air(&self, band: usize, networks: &[&Network]) -> AirSettings {
        let channel_seed = match band {
            0 => self.channel_seed,
            _ => Seed(self.channel_seed.bits(purpose::BAND, [band as u64, 0, 0])),
        };
        let settings = || networks.iter().map(|network| network.technology.settings());
        let first = networks[0].technology.settings();
        AirSettings {
            channel: Channel::new(networks[0].channel, self.world.obstacles.clone(), channel_seed),
            changes: self.changes(networks[0]),
            power: Dbm(settings().map(|settings| settings.greatest_tx_power().0).fold(f64::MIN, f64::max)),
            noise: Dbm((self.world.interferers.iter())
                .filter_map(|interferer| first.power_of(interferer))
                .fold(f64::MIN, |greatest, power| greatest.max(power.0))),
            gain: Db(settings().map(|settings| settings.greatest_gain().0).fold(0.0, f64::max)),
            floor: Dbm(settings().map(|settings| settings.noise_floor().0).fold(f64::MAX, f64::min))
                - NEGLECTED_BELOW_NOISE,
            sensing: settings().map(|settings| settings.carrier_sense()).max().unwrap_or(Duration::ZERO),
            salt: self.seed.bits(purpose::ROUND, [self.round, band as u64, 0]),
            message_loss: self.message_loss,
            seed: self.seed,
        }
    }
}
