//! Which networks share a band, and the air of each band.

use std::time::Duration;

use sextant_channel::{Channel, Db, Dbm};
use sextant_kernel::{Seed, SettingError};

use crate::air::{AirSettings, Changes, ChangingLinks, Screens};
use crate::link::settings::Spectrum;
use crate::network::Network;
use crate::purpose;
use crate::station::Roll;
use crate::world::World;
use crate::world::target::Target;

/// Signals this far below the noise may be neglected.
pub(crate) const NEGLECTED_BELOW_NOISE: Db = Db(10.0);

/// A frame so far above the least power is received whatever the model of reception.
const SURELY_RECEIVED: Db = Db(10.0);

/// A band, and who uses it.
#[derive(Clone, Debug)]
pub(crate) struct Band {
    pub(crate) spectrum: Spectrum,
    /// The numbers of its networks.
    pub(crate) networks: Vec<usize>,
    /// The number of the band whose shadowing it has: its own, or the first one of the network that changes to it.
    shadowing: usize,
}

/// The bands in the order of their first networks, and after them those that radios may only change to.
///
/// # Errors
/// If networks that share a band have different channels, or one of them has sector sweeps.
pub(crate) fn bands(networks: &[Network]) -> Result<Vec<Band>, SettingError> {
    let mut bands: Vec<Band> = Vec::new();
    let settings = |network: usize| networks[network].technology.settings();
    let first = (0..networks.len()).map(|i| (i, settings(i).spectrum()));
    let further = (0..networks.len())
        .flat_map(|i| settings(i).further_spectra().into_iter().map(move |spectrum| (i, spectrum)));
    for (i, spectrum) in first.chain(further) {
        let (network, settings) = (&networks[i], settings(i));
        match bands.iter_mut().find(|band| band.spectrum == spectrum) {
            None => {
                let shadowing = match spectrum == settings.spectrum() {
                    true => bands.len(),
                    false => band_of(&bands, settings.spectrum()),
                };
                bands.push(Band { spectrum, networks: vec![i], shadowing });
            }
            Some(band) => {
                let band = &mut band.networks;
                if let Some(what) = settings.unshared() {
                    let with = format!("that of network {}: it is the same radio channel", band[0]);
                    let remedy = format!("give each network with {what} its own");
                    return Err(SettingError::conflict(format!("networks[{i}].radio.channel"), with, remedy));
                }
                if networks[band[0]].channel != network.channel {
                    let with = format!("that of network {}, which is on the same radio channel", band[0]);
                    let remedy =
                        "write the same table in both, with its `reference_loss_db`: the default follows the carrier";
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

/// The number of the band with this spectrum.
///
/// # Panics
/// If there is none.
pub(crate) fn band_of(bands: &[Band], spectrum: Spectrum) -> usize {
    bands.iter().position(|band| band.spectrum == spectrum).expect("each network is in its bands")
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
    /// What changes the links of a band in time. All bands have the seed in common, so that radio channels near each other
    /// fade alike.
    fn changes(&self, band: &Band, network: &Network) -> Option<Changes> {
        let settings = network.technology.settings();
        let trace = network.link_trace.as_ref().map(|trace| {
            let needed = settings
                .radio()
                .reception_rules()
                .iter()
                .map(|rules| rules.least_power().to_dbm().0)
                .fold(f64::MIN, f64::max);
            trace.of(&self.roll, band.spectrum.channel, Dbm(needed) + SURELY_RECEIVED)
        });
        let fading_band = settings.radio().fading_band(band.spectrum.channel);
        let carrier_ghz = network.channel.carrier_ghz().unwrap_or(fading_band.center_hz * 1e-9);
        let screens = Screens::new(self.world.targets.iter().map(Target::screen), carrier_ghz);
        let links = ChangingLinks { seed: self.channel_seed, stations: self.roll.len(), trace, screens };
        Changes::of(&network.channel, fading_band, links)
    }

    /// The air of the band number `number`, which some of `networks` share.
    pub(crate) fn air(&self, number: usize, band: &Band, networks: &[Network]) -> AirSettings {
        let networks: Vec<&Network> = band.networks.iter().map(|&network| &networks[network]).collect();
        let channel_seed = match band.shadowing {
            0 => self.channel_seed,
            shadowing => Seed(self.channel_seed.bits(purpose::BAND, [shadowing as u64, 0, 0])),
        };
        let settings = || networks.iter().map(|network| network.technology.settings());
        let first = networks[0].technology.settings();
        AirSettings {
            channel: Channel::new(networks[0].channel, self.world.obstacles.clone(), channel_seed),
            changes: self.changes(band, networks[0]),
            power: Dbm(settings().map(|settings| settings.radio().greatest_tx_power().0).fold(f64::MIN, f64::max)),
            noise: Dbm((self.world.interferers.iter())
                .filter_map(|interferer| first.radio().power_of(interferer, band.spectrum.channel))
                .fold(f64::MIN, |greatest, power| greatest.max(power.0))),
            gain: Db(settings().map(|settings| settings.greatest_gain().0).fold(0.0, f64::max)),
            floor: Dbm(settings().map(|settings| settings.radio().noise_floor().0).fold(f64::MAX, f64::min))
                - NEGLECTED_BELOW_NOISE,
            sensing: settings().map(|settings| settings.carrier_sense()).max().unwrap_or(Duration::ZERO),
            salt: self.seed.bits(purpose::ROUND, [self.round, number as u64, 0]),
            message_loss: self.message_loss,
            powers_vary: settings().any(|settings| settings.powers_vary()),
            seed: self.seed,
        }
    }
}
