//! Antennas as files.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use sextant::antenna::{SourceNames, convert};
use sextant_channel::{Antenna, AntennaConfig, CodeBookConfig, Gaps, ListenerAntennaConfig, Position, SectorGains};
use sextant_kernel::Files;
use sextant_recording::antenna_text;

use crate::scratch;

/// What begins the text of an `antenna.toml`, which names the rest of the input as `book.csv`.
const SETTINGS: &str = "=== antenna.toml\n";

/// A code book is refused, or its gains are numbers. One that is converted from another form is accepted. An `antenna.toml` is
/// refused, or is written as the same antenna.
pub(crate) fn check(octets: &[u8]) {
    if let Some(settings) = octets.strip_prefix(SETTINGS.as_bytes()) {
        return listener(settings);
    }
    for (gaps, boresight_gain_dbi) in [(Gaps::default(), None), (Gaps::Hold, Some(12.0))] {
        let _ = book(octets, gaps, boresight_gain_dbi);
    }
    let source = if octets.starts_with(b"MATLAB") { "source.mat" } else { "source.csv" };
    let Ok(converted) = convert(&scratch::file(source, octets), &SourceNames::default(), None) else { return };
    let _ = book(converted.text.as_bytes(), Gaps::Hold, Some(12.0));
}

/// The antenna of a code book, whose gains are numbers.
fn book(octets: &[u8], gaps: Gaps, boresight_gain_dbi: Option<f64>) -> Option<Antenna> {
    let file = PathBuf::from("book.csv");
    let files = Files::Attached(Arc::new(BTreeMap::from([(file.clone(), octets.to_vec())])));
    let config = CodeBookConfig { file: Some(file), gaps, boresight_gain_dbi, ..CodeBookConfig::default() };
    let antenna = Antenna::read(&AntennaConfig::CodeBook(config), &files).ok()?;
    gains_are_numbers(&antenna);
    Some(antenna)
}

/// Gains are numbers, or nothing at all outside of the grid, and none is above the greatest.
fn gains_are_numbers(antenna: &Antenna) {
    let directions = [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.6, 0.0, 0.8], [-0.6, 0.8, 0.0], [0.0, 0.0, -1.0]];
    for [x_m, y_m, z_m] in directions {
        let direction = Position::new(x_m, y_m, z_m);
        for sector in 0..antenna.sector_count() {
            let gain = antenna.gain(sector, direction);
            assert!(
                gain.0 <= antenna.greatest_gain().0 + 1e-9,
                "{gain:?} of sector {sector} is above the greatest gain"
            );
        }
        assert!(antenna.best_sector(direction) < antenna.sector_count().max(1));
    }
}

fn listener(settings: &[u8]) {
    let Ok(text) = std::str::from_utf8(settings) else { return };
    let Ok(config) = toml::from_str::<ListenerAntennaConfig>(text) else { return };
    let none = Files::Attached(Arc::default());
    let Ok(gains) = SectorGains::read(&config, &none) else { return };
    gains_are_numbers(gains.antenna());
    let Some(written) = antenna_text::write(&gains) else { return };
    let config: ListenerAntennaConfig = toml::from_str(&written).expect("an antenna that was written is TOML");
    let again = SectorGains::read(&config, &none).expect("an antenna that was written is accepted");
    assert_eq!(
        antenna_text::write(&again).as_ref(),
        Some(&written),
        "an antenna that is written reads as another one"
    );
}
