//! Interferers that disturb no network, which is known before the start.

use crate::setup::Setup;

/// An interferer whose spectrum reaches into no radio channel of any network.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnheardInterferer {
    /// Its number.
    pub number: usize,
    /// The ends of its spectrum, with its leakage (MHz).
    pub spectrum_mhz: [f64; 2],
    /// The middle of the lowest and of the highest radio channel of the networks (MHz).
    pub channels_mhz: [f64; 2],
}

impl Setup {
    /// The interferers that no station of any network can hear, wherever it is: they are in other bands.
    #[must_use]
    pub fn unheard_interferers(&self) -> Vec<UnheardInterferer> {
        let all_settings = || self.networks.iter().map(|network| network.technology.settings());
        let radios = || {
            all_settings().flat_map(|settings| {
                let spectra = std::iter::once(settings.spectrum()).chain(settings.further_spectra());
                spectra.map(|spectrum| (settings.radio(), spectrum.channel))
            })
        };
        let middle_mhz = || radios().map(|(radio, channel)| 1e-6 * radio.fading_band(channel).center_hz);
        let channels_mhz =
            [middle_mhz().fold(f64::INFINITY, f64::min), middle_mhz().fold(f64::NEG_INFINITY, f64::max)];
        let interferers = self.world.interferers.iter().enumerate();
        interferers
            .filter(|(_, interferer)| radios().all(|(radio, channel)| radio.power_of(interferer, channel).is_none()))
            .map(|(number, interferer)| UnheardInterferer {
                number,
                spectrum_mhz: interferer.spectrum_mhz(),
                channels_mhz,
            })
            .collect()
    }
}
