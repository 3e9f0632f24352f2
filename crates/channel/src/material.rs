//! Materials of obstacles.

/// A material with its absorption in the 2.4 GHz band.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Name in scenarios.
    pub name: &'static str,
    /// Absorption coefficient α of the Lambert-Bouguer law at 2.45 GHz (1/m); the loss is 4.343 α dB per metre.
    /// Absorption only: reflection at the surfaces is not included.
    pub absorption_per_m: f64,
    /// How the coefficient was obtained, and from which source.
    pub source: &'static str,
}

const P2040: &str = "computed: α = 2 (2π f / c) |Im sqrt(η)| with η = a f^b - j 17.98 c f^d / f at f = 2.45 GHz; \
                     a, b, c, d of Recommendation ITU-R P.2040-3 (2023), Table 3";

impl Material {
    /// All known materials.
    pub const ALL: &[Self] = &[
        Self {
            name: "concrete",
            absorption_per_m: 4.6,
            source: "chosen: 20 dB per metre (10 α log10(e) = 19.98 dB), because the thesis gives no coefficient for concrete; \
                     light, dry concrete; see itu-concrete for dense concrete",
        },
        Self { name: "itu-concrete", absorption_per_m: 15.297, source: P2040 },
        Self { name: "brick", absorption_per_m: 5.233, source: P2040 },
        Self { name: "plasterboard", absorption_per_m: 4.497, source: P2040 },
        Self { name: "wood", absorption_per_m: 3.280, source: P2040 },
        Self { name: "chipboard", absorption_per_m: 10.222, source: P2040 },
        Self { name: "glass", absorption_per_m: 1.793, source: P2040 },
        Self { name: "marble", absorption_per_m: 1.787, source: P2040 },
        Self { name: "metal", absorption_per_m: 622_090.0, source: P2040 },
        Self {
            name: "wet-ground",
            absorption_per_m: 39.437,
            source: "computed as for building materials, from the row for wet ground of ITU-R P.2040-3 (2023), Table 3",
        },
        Self {
            name: "water",
            absorption_per_m: 61.10,
            source: "computed: α = 2 (2π f / c) |Im sqrt(ε)| of pure water at 20 °C and 2.45 GHz, ε by the single Debye \
                     relaxation of Liebe, Hufford and Manabe (1991), Int. J. Infrared and Millimeter Waves 12, 659",
        },
        Self {
            name: "foliage",
            absorption_per_m: 0.1336,
            source: "computed: 0.45 f^0.284 dB per metre at f = 2.45 (GHz) over 4.343; modified exponential decay of \
                     Weissberger (1982), ESD-TR-81-101, dense dry trees in leaf, up to 14 m deep",
        },
    ];

    /// The material called `name`.
    #[must_use]
    pub fn named(name: &str) -> Option<&'static Self> {
        Self::ALL.iter().find(|material| material.name == name)
    }

    /// Loss of power per metre (dB).
    #[must_use]
    pub fn loss_db_per_m(&self) -> f64 {
        10.0 * self.absorption_per_m * std::f64::consts::LOG10_E
    }

    /// All names, for messages.
    pub(crate) fn names() -> String {
        Self::ALL.iter().map(|material| format!("\"{}\"", material.name)).collect::<Vec<_>>().join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const F_GHZ: f64 = 2.45;

    /// 2 (2π f / c) |Im sqrt(re - j im)|, by the closed form of the root.
    fn absorption_per_m(re: f64, im: f64) -> f64 {
        let root = ((libm::hypot(re, im) - re) / 2.0).sqrt();
        2.0 * std::f64::consts::TAU * F_GHZ * 1e9 / 299_792_458.0 * root
    }

    fn assert_listed(name: &str, expected: f64) {
        let listed = Material::named(name).unwrap().absorption_per_m;
        assert!((listed / expected - 1.0).abs() < 1e-3, "{name}: listed {listed}, computed {expected}");
    }

    #[test]
    fn building_materials_absorb_what_their_permittivity_says() {
        for (name, [a, b, c, d]) in [
            ("itu-concrete", [5.24, 0.0, 0.0462, 0.7822]),
            ("brick", [3.91, 0.0, 0.0238, 0.16]),
            ("plasterboard", [2.73, 0.0, 0.0085, 0.9395]),
            ("wood", [1.99, 0.0, 0.0047, 1.0718]),
            ("chipboard", [2.58, 0.0, 0.0217, 0.78]),
            ("glass", [6.31, 0.0, 0.0036, 1.3394]),
            ("marble", [7.074, 0.0, 0.0055, 0.9262]),
            ("metal", [1.0, 0.0, 1e7, 0.0]),
            ("wet-ground", [30.0, -0.4, 0.15, 1.3]),
        ] {
            let (re, im) = (a * F_GHZ.powf(b), 17.98 * c * F_GHZ.powf(d) / F_GHZ);
            assert_listed(name, absorption_per_m(re, im));
        }
    }

    #[test]
    fn water_and_leaves_absorb_what_their_models_say() {
        let theta = 1.0 - 300.0 / 293.15;
        let (low, high) = (77.66 - 103.3 * theta, 0.0671 * (77.66 - 103.3 * theta));
        let ratio = F_GHZ / (20.2 + 146.4 * theta + 316.0 * theta * theta);
        let strength = (low - high) / (1.0 + ratio * ratio);
        assert_listed("water", absorption_per_m(high + strength, strength * ratio));
        assert_listed("foliage", 0.45 * F_GHZ.powf(0.284) / 4.342_944_8);
    }

    #[test]
    fn names_are_unique_and_a_metre_of_concrete_takes_twenty_decibels() {
        for (i, material) in Material::ALL.iter().enumerate() {
            assert_eq!(Material::ALL.iter().position(|other| other.name == material.name), Some(i));
            assert!(material.absorption_per_m > 0.0 && !material.source.is_empty());
        }
        let concrete = Material::named("concrete").unwrap();
        assert!((concrete.loss_db_per_m() - 19.977_546).abs() < 1e-6);
        assert_eq!(Material::named("Concrete"), None);
    }
}
