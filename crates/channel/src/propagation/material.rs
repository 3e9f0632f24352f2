//! Materials of obstacles.

use std::sync::LazyLock;

use sextant_kernel::SettingError;

use crate::propagation::complex::Complex;
use crate::propagation::path_loss::LIGHT_M_PER_S;

/// 10 log10(e): decibels of one neper of power.
pub(crate) const DB_PER_NEPER: f64 = 10.0 * std::f64::consts::LOG10_E;

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
    /// Carriers for which its model holds (GHz).
    pub range_ghz: [f64; 2],
    model: Model,
}

/// How absorption depends on the carrier.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Model {
    /// Relative permittivity `a f^b - j 17.98 c f^d / f`, f in GHz (Recommendation ITU-R P.2040-3, eq. 27 to 29), and
    /// a factor on the absorption.
    Permittivity([f64; 4], f64),
    /// Pure water at 20 °C by a single Debye relaxation.
    Water,
    /// Weissberger's modified exponential decay, up to 14 m deep.
    Foliage,
}

/// All known materials: one a line, after the names of the columns.
const TABLE: &str = include_str!("materials.csv");

static ALL: LazyLock<Vec<Material>> = LazyLock::new(|| TABLE.lines().skip(1).map(Material::parse).collect());

impl Material {
    /// All known materials.
    #[must_use]
    pub fn all() -> &'static [Self] {
        &ALL
    }

    /// The material in a line of the table.
    fn parse(line: &'static str) -> Self {
        let fields: Vec<&str> = line.splitn(8, ';').collect();
        let [name, absorption, low, high, model, parameters, factor, source] = fields[..] else {
            panic!("a line of the table of materials has eight fields, not {}: {line}", fields.len())
        };
        let number = |text: &str| -> f64 { text.parse().expect("a number in the table of materials") };
        let model = match model {
            "water" => Model::Water,
            "foliage" => Model::Foliage,
            _ => {
                let parameters: Vec<f64> = parameters.split(' ').map(number).collect();
                let factor = factor.split('/').map(number).reduce(|over, under| over / under);
                let parameters = parameters.try_into().expect("four parameters of a permittivity");
                Model::Permittivity(parameters, factor.expect("at least one number"))
            }
        };
        let range_ghz = [number(low), number(high)];
        Self { name, absorption_per_m: number(absorption), source, range_ghz, model }
    }

    /// The material called `name`.
    #[must_use]
    pub fn named(name: &str) -> Option<&'static Self> {
        Self::all().iter().find(|material| material.name == name)
    }

    /// The material that a file calls `name`, perhaps in another case, with underscores, the prefixes `mat-` and `itu-`, or a
    /// number after a dot, as tools for modelling write them.
    pub(crate) fn of_file(name: &str) -> Option<&'static Self> {
        let name = name.to_lowercase().replace(['_', ' '], "-");
        let name =
            name.rsplit_once('.').filter(|(_, end)| end.parse::<u32>().is_ok()).map_or(&*name, |(name, _)| name);
        let name = name.strip_prefix("mat-").unwrap_or(name);
        Self::named(name).or_else(|| Self::named(name.strip_prefix("itu-")?))
    }

    /// Absorption coefficient α at the carrier (1/m): the listed one without a carrier. Beyond the carriers for which
    /// the model holds, that of the nearest one for which it does.
    #[must_use]
    pub fn absorption_at_per_m(&self, carrier_ghz: Option<f64>) -> f64 {
        let Some(carrier_ghz) = carrier_ghz else { return self.absorption_per_m };
        let [low, high] = self.range_ghz;
        self.model.absorption_per_m(carrier_ghz.clamp(low, high))
    }

    /// Complex relative permittivity at the carrier, `a f^b - j 17.98 c f^d / f`, if it is known; beyond the carriers for
    /// which the model holds, that of the nearest one for which it does.
    pub(crate) fn permittivity(&self, carrier_ghz: f64) -> Option<Complex> {
        let [low, high] = self.range_ghz;
        self.model.permittivity(carrier_ghz.clamp(low, high))
    }

    /// Whether the model holds at the carrier.
    ///
    /// # Errors
    /// Otherwise, with the key `material`.
    pub(crate) fn check_carrier(&self, carrier_ghz: f64) -> Result<(), SettingError> {
        let [low, high] = self.range_ghz;
        if (low..=high).contains(&carrier_ghz) {
            return Ok(());
        }
        let found = format!("\"{}\" at {carrier_ghz} GHz", self.name);
        let allowed = format!("\"{}\" from {low} to {high} GHz; or `absorption_per_m` or `loss_db`", self.name);
        Err(SettingError::new("material", found, allowed))
    }

    /// All names, for messages.
    #[must_use]
    pub fn names() -> String {
        Self::all().iter().map(|material| format!("\"{}\"", material.name)).collect::<Vec<_>>().join(", ")
    }
}

/// Adds the names of all materials to the schema of a key that is one.
#[cfg(feature = "schema")]
pub(crate) fn listed(schema: &mut schemars::Schema) {
    let names = Material::all().iter().map(|material| material.name).collect::<Vec<_>>();
    schema.insert("enum".to_owned(), names.into());
}

impl Model {
    fn absorption_per_m(self, f_ghz: f64) -> f64 {
        let factor = if let Self::Permittivity(_, factor) = self { factor } else { 1.0 };
        match self.permittivity(f_ghz) {
            Some(Complex { re, im }) => factor * of_permittivity_per_m(f_ghz, re, -im),
            None => 0.45 * libm::pow(f_ghz, 0.284) / DB_PER_NEPER,
        }
    }

    fn permittivity(self, f_ghz: f64) -> Option<Complex> {
        match self {
            Self::Permittivity([a, b, c, d], _) => {
                let im = 17.98 * c * libm::pow(f_ghz, d) / f_ghz;
                Some(Complex { re: a * libm::pow(f_ghz, b), im: -im })
            }
            Self::Water => {
                let theta = 1.0 - 300.0 / 293.15;
                let low = 77.66 - 103.3 * theta;
                let high = 0.0671 * low;
                let ratio = f_ghz / (20.2 + 146.4 * theta + 316.0 * theta * theta);
                let strength = (low - high) / (1.0 + ratio * ratio);
                Some(Complex { re: high + strength, im: -(strength * ratio) })
            }
            Self::Foliage => None,
        }
    }
}

/// A known material, by its name in a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "config",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "String", into = "String")
)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(with = "String"))]
pub struct MaterialName(pub &'static Material);

impl TryFrom<String> for MaterialName {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        let known = Material::named(&name).map(Self);
        known.ok_or_else(|| format!("unknown material {name:?}; allowed: {}", Material::names()))
    }
}

impl From<MaterialName> for String {
    fn from(MaterialName(material): MaterialName) -> Self {
        material.name.to_owned()
    }
}

/// Absorption coefficient of power (1/m): `2 (2π f / c) |Im sqrt(re - j im)|`.
fn of_permittivity_per_m(f_ghz: f64, re: f64, im: f64) -> f64 {
    // (|ε| - re) / 2, written so that a small imaginary part is not lost.
    let root = (im * im / (2.0 * (libm::hypot(re, im) + re))).sqrt();
    2.0 * std::f64::consts::TAU * f_ghz * 1e9 / LIGHT_M_PER_S * root
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
        for (i, material) in Material::all().iter().enumerate() {
            assert_eq!(Material::all().iter().position(|other| other.name == material.name), Some(i));
            assert!(material.absorption_per_m > 0.0 && !material.source.is_empty());
        }
        let concrete = Material::named("concrete").unwrap();
        let loss_db_per_m = 10.0 * concrete.absorption_per_m * std::f64::consts::LOG10_E;
        assert!((loss_db_per_m - 19.977_546).abs() < 1e-6);
        assert_eq!(Material::named("Concrete"), None);
    }

    #[test]
    fn the_model_of_each_material_gives_its_listed_value_at_the_listed_carrier() {
        for material in Material::all() {
            let ratio = material.absorption_at_per_m(Some(F_GHZ)) / material.absorption_per_m;
            assert!((ratio - 1.0).abs() < 1e-3, "{}: {ratio}", material.name);
            assert_eq!(material.absorption_at_per_m(None).to_bits(), material.absorption_per_m.to_bits());
        }
    }

    #[test]
    fn absorption_at_millimetre_waves_is_that_of_the_formulas() {
        // Loss in dB per metre, computed with complex numbers from the same recommendations.
        for (name, f_ghz, db_per_m) in [
            ("itu-concrete", 28.0, 447.2575),
            ("itu-concrete", 60.0, 811.9897),
            ("itu-concrete", 73.0, 946.6522),
            ("glass", 28.0, 203.465),
            ("glass", 60.0, 564.6571),
            ("glass", 73.0, 734.2612),
            ("wood", 28.0, 193.87),
            ("wood", 60.0, 438.7842),
            ("wood", 73.0, 541.4182),
            ("plasterboard", 28.0, 192.647),
            ("plasterboard", 60.0, 394.2215),
            ("plasterboard", 73.0, 473.9815),
            ("metal", 28.0, 9133396.0),
            ("metal", 60.0, 1.336992e7),
            ("metal", 73.0, 1.474737e7),
            ("water", 28.0, 14558.24),
            ("water", 60.0, 26170.29),
            ("water", 73.0, 29203.37),
        ] {
            let found = DB_PER_NEPER * Material::named(name).unwrap().absorption_at_per_m(Some(f_ghz));
            assert!((found / db_per_m - 1.0).abs() < 1e-5, "{name}: {found}");
        }
        // Rounded by hand: 0.45 · 73^0.284.
        assert!(
            (DB_PER_NEPER * Material::named("foliage").unwrap().absorption_at_per_m(Some(73.0)) - 1.52).abs() < 0.005
        );
    }

    #[test]
    fn a_carrier_outside_the_range_of_a_model_is_refused() {
        let brick = Material::named("brick").unwrap();
        assert_eq!(brick.check_carrier(40.0), Ok(()));
        let error = brick.check_carrier(73.0).unwrap_err();
        assert!(error.found().contains("73") && error.allowed().contains("1 to 40 GHz"), "{error}");
    }
}
