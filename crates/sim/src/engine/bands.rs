//! Which networks share a band, and the air of each band.

use std::time::Duration;

use sextant_channel::{Channel, Db, Dbm};
use sextant_kernel::{Seed, SettingError};
use sextant_mac::Phy;

use super::interference::power_in_band;
use super::setup::NetworkSetup;
use crate::air::{AirSettings, ReceptionModel};
use crate::link::{Ieee802154, Technology};
use crate::purpose;
use crate::world::World;

/// Signals this far below the noise may be neglected.
const NEGLECTED_BELOW_NOISE: Db = Db(10.0);

/// Packets of one band; the packets of the next band are numbered after them, so that no two packets share a draw.
const PACKETS_OF_A_BAND: u64 = 1 << 44;

/// The networks of each band, in the order of their first networks.
///
/// # Errors
/// If networks that share a band have different channels.
pub(super) fn bands(networks: &[NetworkSetup]) -> Result<Vec<Vec<usize>>, SettingError> {
    let mut bands: Vec<Vec<usize>> = Vec::new();
    for (i, network) in networks.iter().enumerate() {
        let shares =
            |band: &&mut Vec<usize>| networks[band[0]].technology.spectrum() == network.technology.spectrum();
        match bands.iter_mut().find(shares) {
            None => bands.push(vec![i]),
            Some(band) => {
                if matches!(network.technology, Technology::Ieee80211ad(_)) {
                    let found = format!("sector sweeps on the radio channel of network {}", band[0]);
                    let allowed = "a radio channel of its own for each network with sector sweeps";
                    return Err(SettingError::new(format!("networks[{i}].radio.channel"), found, allowed));
                }
                if networks[band[0]].channel != network.channel {
                    let found =
                        format!("another channel than that of network {}, on the same radio channel", band[0]);
                    let allowed = "one channel for all networks on a radio channel";
                    return Err(SettingError::new(format!("networks[{i}].channel"), found, allowed));
                }
                band.push(i);
            }
        }
    }
    Ok(bands)
}

/// Refuses bit errors of another physical layer than that of which they are known.
pub(super) fn check_reception(networks: &[NetworkSetup]) -> Result<(), SettingError> {
    for (i, network) in networks.iter().enumerate() {
        let (reception, radio) = match &network.technology {
            Technology::Ieee802154(Ieee802154 { radio, reception, .. }) if radio.phy() != Phy::Oqpsk2450 => {
                (reception, format!("a radio with `phy = \"{}\"`", radio.phy().name()))
            }
            Technology::Ieee802154(_) => continue,
            Technology::Ieee80211ad(settings) => (&settings.reception, "sector sweeps".to_owned()),
        };
        if *reception == ReceptionModel::Ber {
            let found = format!("set for {radio}");
            let allowed = "only `phy = \"oqpsk2450\"`, whose bit error rate is known; \
                           with others `reception.sinr_threshold`, `reception.sir_threshold` or `reception.overlap`";
            let refusal = SettingError::new("reception.ber", found, allowed);
            return Err(if i == 0 { refusal } else { refusal.within(format!("networks[{i}]")) });
        }
    }
    Ok(())
}

/// Refuses settings of links that do not fit together.
pub(super) fn check_links(networks: &[NetworkSetup]) -> Result<(), SettingError> {
    for (i, network) in networks.iter().enumerate() {
        let Some(links) = network.technology.ieee802154() else { continue };
        links.check().map_err(|error| if i == 0 { error } else { error.within(format!("networks[{i}]")) })?;
    }
    Ok(())
}

/// The air of the band number `band`, which `networks` share.
pub(super) fn air(
    networks: &[&NetworkSetup],
    band: usize,
    world: &World,
    channel_seed: Seed,
    seed: Seed,
    (first_packet, message_loss): (u64, f64),
) -> AirSettings {
    let channel_seed =
        if band == 0 { channel_seed } else { Seed(channel_seed.bits(purpose::BAND, [band as u64, 0, 0])) };
    let technologies = || networks.iter().map(|network| &network.technology);
    AirSettings {
        channel: Channel::new(networks[0].channel, world.obstacles.clone(), channel_seed),
        power: Dbm(technologies().map(|technology| technology.greatest_tx_power().0).fold(f64::MIN, f64::max)),
        noise: Dbm((world.interferers.iter())
            .filter_map(|interferer| power_in_band(interferer, &networks[0].technology))
            .fold(f64::MIN, |greatest, power| greatest.max(power.0))),
        gain: Db(technologies().map(|technology| technology.greatest_gain().0).fold(0.0, f64::max)),
        floor: Dbm(technologies().map(|technology| technology.noise_floor().0).fold(f64::MAX, f64::min))
            - NEGLECTED_BELOW_NOISE,
        sensing: technologies().map(Technology::carrier_sense).max().unwrap_or(Duration::ZERO),
        first_packet: first_packet + band as u64 * PACKETS_OF_A_BAND,
        message_loss,
        seed,
    }
}
