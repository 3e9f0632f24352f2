//! Figures of an antenna: the pattern of each sector with the directions where it stands in a log, and which sector is the
//! best where.

mod patterns;
mod winners;

use sextant_channel::{Antenna, Position};

use crate::paint::file::Figure;

/// The figures of an antenna with sectors: cuts in azimuth and in elevation through the peak of each sector, and the best
/// sector in each direction; none of an antenna without sectors.
#[must_use]
pub fn of_antenna(title: &str, antenna: &Antenna) -> Vec<Figure> {
    if antenna.is_omnidirectional() {
        return Vec::new();
    }
    let mut figures = patterns::figures(title, antenna);
    figures.push(Figure { name: "antenna-best-sector".to_owned(), picture: winners::draw(title, antenna) });
    figures
}

/// The unit vector of a direction (degrees); an elevation beyond the vertical comes down on the other side.
fn towards(azimuth_deg: f64, elevation_deg: f64) -> Position {
    let (sa, ca) = libm::sincos(azimuth_deg.to_radians());
    let (se, ce) = libm::sincos(elevation_deg.to_radians());
    Position::new(ca * ce, sa * ce, se)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::picture::Mark;
    use sextant_channel::{AntennaConfig, AntennaSectorsConfig, CodeBookConfig, SectorGainsConfig, Vertical};

    fn book() -> Antenna {
        let sector = |sector: u8, gains: [f64; 4]| SectorGainsConfig { sector, gain_dbi: vec![gains.into(); 2] };
        let config = CodeBookConfig {
            azimuths_deg: Some(vec![0.0, 90.0, 180.0, 270.0]),
            elevations_deg: Some(vec![-10.0, 30.0]),
            sectors: Some(vec![sector(3, [9.0, 3.0, -13.0, 3.0]), sector(61, [-13.0, 3.0, 9.0, 3.0])]),
            ..CodeBookConfig::default()
        };
        Antenna::try_from(AntennaConfig::CodeBook(config)).expect("a good code book")
    }

    fn texts(figure: &Figure) -> Vec<String> {
        let text = |mark: &Mark| if let Mark::Text { text, .. } = mark { Some(text.clone()) } else { None };
        figure.picture.marks.iter().filter_map(text).collect()
    }

    #[test]
    fn sectors_are_drawn_with_their_identities() {
        let figures = of_antenna("a", &book());
        let names: Vec<&str> = figures.iter().map(Figure::name).collect();
        assert_eq!(names, ["antenna-azimuth-cuts", "antenna-elevation-cuts", "antenna-best-sector"]);
        for figure in &figures {
            let texts = texts(figure);
            for identity in ["3", "61"] {
                assert!(
                    texts.iter().any(|text| text.split(' ').any(|word| word == identity)),
                    "{identity}: {texts:?}"
                );
            }
        }
    }

    #[test]
    fn many_sectors_have_several_figures_and_none_has_none() {
        let config = AntennaSectorsConfig {
            azimuth_sectors: 40,
            first_azimuth_deg: 0.0,
            elevations_deg: vec![0.0, 30.0],
            vertical: Vertical::Array,
            beam_width_deg: None,
            vertical_width_deg: None,
            pattern: sextant_channel::PatternConfig::default(),
            boresight_gain_dbi: None,
            quasi_omni_gain_dbi: 0.0,
            gain_ripple_db: 0.0,
        };
        let many = Antenna::try_from(AntennaConfig::Sectors(config)).expect("a good antenna");
        let names: Vec<String> = of_antenna("a", &many).iter().map(|figure| figure.name().to_owned()).collect();
        assert_eq!(names.len(), 2 * 3 + 1, "{names:?}");
        assert_eq!(names[2], "antenna-azimuth-cuts-3");
        assert!(of_antenna("a", &Antenna::default()).is_empty());
    }
}
