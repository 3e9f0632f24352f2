//! Radiation patterns: how the gain of one beam falls from its boresight.

use std::f64::consts::PI;

use sextant_kernel::SettingError;

use crate::geometry::position::Position;
use crate::power::Db;

/// The radiation pattern of a beam, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum PatternConfig {
    /// The reference antenna of IEEE 802.15.3c: a round beam with a Gaussian main lobe and constant side lobes.
    Ieee802153c(Ieee802153cConfig),
    /// A beam with different widths in azimuth and elevation, and side lobes 30 dB below the peak.
    Elliptical(EllipticalConfig),
    /// The antenna element of 3GPP TR 38.901.
    Tr38901(Tr38901Config),
    /// A constant gain inside the beam and another outside, which together radiate all power.
    FlatTop(FlatTopConfig),
}

impl Default for PatternConfig {
    fn default() -> Self {
        Self::Ieee802153c(Ieee802153cConfig::default())
    }
}

/// The reference antenna of IEEE 802.15.3c, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Ieee802153cConfig {
    /// What the edge of a sector is.
    #[cfg_attr(feature = "config", serde(default))]
    pub sector_edge: SectorEdge,
    /// How the main lobe meets the side lobes.
    #[cfg_attr(feature = "config", serde(default))]
    pub lobe_edge: LobeEdge,
}

/// What the edge of a sector is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum SectorEdge {
    /// The half-power width is the width of the sector: neighbours cross 3 dB below the peak.
    #[default]
    HalfPower,
    /// The main lobe ends at the edge of the sector: its half-power width is that of the sector over 2.6.
    MainLobe,
}

/// How the main lobe meets the side lobes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum LobeEdge {
    /// The gain jumps at 1.3 half-power widths from the boresight, as the reference says.
    #[default]
    Jump,
    /// The main lobe goes on until it is as low as the side lobes.
    Continuous,
}

/// A beam of two widths, as written in a scenario. Its widths are those of the sectors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EllipticalConfig {}

/// The antenna element of 3GPP TR 38.901, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Tr38901Config {
    /// Half-power width in azimuth (degrees), 65 if absent.
    #[cfg_attr(feature = "config", serde(default = "element_width_deg"))]
    pub azimuth_width_deg: f64,
    /// Half-power width in elevation (degrees), 65 if absent.
    #[cfg_attr(feature = "config", serde(default = "element_width_deg"))]
    pub elevation_width_deg: f64,
}

fn element_width_deg() -> f64 {
    65.0
}

impl Default for Tr38901Config {
    fn default() -> Self {
        Self { azimuth_width_deg: element_width_deg(), elevation_width_deg: element_width_deg() }
    }
}

/// A pattern of two gains, as written in a scenario. The gain inside follows from the gain outside, because an antenna
/// without losses radiates all its power.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FlatTopConfig {
    /// Which directions are inside.
    #[cfg_attr(feature = "config", serde(default))]
    pub beam: FlatBeam,
    /// Gain outside the beam (dBi), at most 0; −10 if absent. `-inf`: nothing is radiated outside.
    #[cfg_attr(feature = "config", serde(default = "outside_gain_dbi"))]
    pub outside_gain_dbi: f64,
}

fn outside_gain_dbi() -> f64 {
    -10.0
}

impl Default for FlatTopConfig {
    fn default() -> Self {
        Self { beam: FlatBeam::default(), outside_gain_dbi: outside_gain_dbi() }
    }
}

/// Which directions are inside a flat beam.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum FlatBeam {
    /// An interval of azimuth, and of elevation if the sectors have a vertical width. The beams of a ring do not
    /// overlap.
    #[default]
    Wedge,
    /// A cone about the boresight.
    Cone,
}

/// A pattern that does not depend on the boresight, ready for use.
#[derive(Clone, Copy, Debug)]
pub(super) enum Pattern {
    /// Gaussian main lobe about the boresight, floor from the angle with this cosine on; dB per rad².
    Pencil { cos_edge: f64, db_per_rad2: f64 },
    /// Gaussian in azimuth and elevation of the beam, down to the floor. Beyond the sine of the elevation, and beyond
    /// the tangent of the azimuth, there is only the floor.
    Fan { azimuth_db_per_rad2: f64, elevation_db_per_rad2: f64, sin_elevation: f64, tan_azimuth: f64 },
    /// Constant within the angle with this cosine.
    FlatCone { cos_half: f64 },
    /// Constant within half an azimuth with this cosine, and within the elevations of the beam.
    FlatWedge { cos_half: f64 },
}

/// One beam: its axes in the frame of the antenna, its gain at the boresight and the lowest one (dBi).
#[derive(Clone, Copy, Debug)]
pub(super) struct Beam {
    pub(super) forward: Position,
    pub(super) left: Position,
    pub(super) up: Position,
    pub(super) peak_dbi: f64,
    pub(super) floor_dbi: f64,
    /// Sines of the lowest and highest elevation of a flat wedge.
    pub(super) sin_elevation: [f64; 2],
}

/// A boresight and the widths of the beam about it (rad).
#[derive(Clone, Copy, Debug)]
pub(super) struct Aim {
    pub(super) azimuth_rad: f64,
    pub(super) elevation_rad: f64,
    /// Half-power width in azimuth.
    pub(super) width_rad: f64,
    /// Half-power width in elevation, if it is set.
    pub(super) vertical_width_rad: Option<f64>,
}

/// Drop at the edge of the half-power width (dB), as the reference antenna rounds it.
const HALF_POWER_DB: f64 = 3.01;
/// Width of the main lobe of the reference antenna in half-power widths.
const LOBE_WIDTHS: f64 = 2.6;
/// Depth of the side lobes below the peak (dB), of elliptical beams and of the element of TR 38.901.
const SIDE_LOBE_DEPTH_DB: f64 = 30.0;

impl PatternConfig {
    /// The pattern for beams `width_rad` wide in azimuth, and the beam with this `aim`; keys are below the pattern.
    pub(super) fn build(&self, aim: Aim) -> Result<(Pattern, Beam), SettingError> {
        match *self {
            Self::Ieee802153c(config) => Ok(pencil(config, aim)),
            Self::Elliptical(EllipticalConfig {}) => {
                let (h, v) = (aim.width_rad, aim.vertical_width_rad.unwrap_or(aim.width_rad));
                // Kraus (1988), Antennas, 2nd ed., eq. 2-8-9: 41253 square degrees over the two widths.
                let peak_dbi = 10.0 * libm::log10(41_253.0 / (h.to_degrees() * v.to_degrees()));
                Ok(fan(aim, [h, v], peak_dbi))
            }
            Self::Tr38901(Tr38901Config { azimuth_width_deg, elevation_width_deg }) => {
                let width = |key, deg| {
                    let deg = SettingError::positive(key, deg).map_err(|error| error.within("tr38901"))?;
                    SettingError::in_range(key, deg, 0.0, 360.0).map_err(|error| error.within("tr38901"))
                };
                let h = width("azimuth_width_deg", azimuth_width_deg)?.to_radians();
                let v = width("elevation_width_deg", elevation_width_deg)?.to_radians();
                // 3GPP TR 38.901 V17, Table 7.3-1: maximum directional gain 8 dBi.
                Ok(fan(aim, [h, v], 8.0))
            }
            Self::FlatTop(config) => flat(config, aim).map_err(|error| error.within("flat_top")),
        }
    }
}

/// IEEE 802.15-06-0474-00-003c, Toyoda (2006), "Reference antenna model with side lobe level for TG3c evaluation":
/// `G0 = 20 log10(1.6162 / sin(h/2))`, main lobe `G0 - 3.01 (2θ/h)²` up to `θ = 1.3 h`, side lobes
/// `-0.4111 ln(h in degrees) - 10.579`.
fn pencil(config: Ieee802153cConfig, aim: Aim) -> (Pattern, Beam) {
    let h = match config.sector_edge {
        SectorEdge::HalfPower => aim.width_rad,
        SectorEdge::MainLobe => aim.width_rad / LOBE_WIDTHS,
    };
    let peak_dbi = 20.0 * libm::log10(1.6162 / libm::sin(h / 2.0));
    let floor_dbi = -0.4111 * libm::log(h.to_degrees()) - 10.579;
    let db_per_rad2 = HALF_POWER_DB * (2.0 / h) * (2.0 / h);
    let edge_rad = match config.lobe_edge {
        LobeEdge::Jump => h * LOBE_WIDTHS / 2.0,
        LobeEdge::Continuous => ((peak_dbi - floor_dbi) / db_per_rad2).sqrt(),
    };
    // A lobe of half a turn or more has no edge.
    let cos_edge = if edge_rad >= PI { f64::NEG_INFINITY } else { libm::cos(edge_rad) };
    (Pattern::Pencil { cos_edge, db_per_rad2 }, beam(aim, peak_dbi, floor_dbi))
}

/// `max(G0 - 12 ((φ/h)² + (θ/v)²), G0 - 30)`, with azimuth φ and elevation θ in the frame of the beam. The minima of
/// TR 38.901 V17, Table 7.3-1, over azimuth, elevation and both come to the same.
fn fan(aim: Aim, [h, v]: [f64; 2], peak_dbi: f64) -> (Pattern, Beam) {
    let end_rad = |width_rad: f64| width_rad * (SIDE_LOBE_DEPTH_DB / 12.0).sqrt();
    let (azimuth, elevation) = (end_rad(h), end_rad(v));
    let pattern = Pattern::Fan {
        azimuth_db_per_rad2: 12.0 / (h * h),
        elevation_db_per_rad2: 12.0 / (v * v),
        sin_elevation: if elevation < PI / 2.0 { libm::sin(elevation) } else { f64::INFINITY },
        tan_azimuth: if azimuth < PI / 2.0 { libm::tan(azimuth) } else { f64::INFINITY },
    };
    (pattern, beam(aim, peak_dbi, peak_dbi - SIDE_LOBE_DEPTH_DB))
}

/// With the share q of the sphere inside the beam, and the gain g outside: `q G + (1 - q) g = 1`.
fn flat(config: FlatTopConfig, aim: Aim) -> Result<(Pattern, Beam), SettingError> {
    let floor_dbi = config.outside_gain_dbi;
    if floor_dbi.is_nan() || floor_dbi > 0.0 {
        return Err(SettingError::new("outside_gain_dbi", floor_dbi, "at most 0; -inf for none"));
    }
    let (sin, cos_half) = ([-1.0, 1.0], libm::cos((aim.width_rad / 2.0).min(PI)));
    let (pattern, share, sin_elevation) = match config.beam {
        FlatBeam::Cone => (Pattern::FlatCone { cos_half }, (1.0 - cos_half) / 2.0, sin),
        FlatBeam::Wedge => {
            let sin = aim.vertical_width_rad.map_or(sin, |v| {
                let end = |side: f64| libm::sin((aim.elevation_rad + side * v / 2.0).clamp(-PI / 2.0, PI / 2.0));
                [end(-1.0), end(1.0)]
            });
            let share = aim.width_rad / (2.0 * PI) * (sin[1] - sin[0]) / 2.0;
            (Pattern::FlatWedge { cos_half }, share, sin)
        }
    };
    let outside = Db(floor_dbi).to_factor();
    let peak_dbi = Db::from_factor((1.0 - (1.0 - share) * outside) / share).0;
    Ok((pattern, Beam { sin_elevation, ..beam(aim, peak_dbi, floor_dbi) }))
}

fn beam(aim: Aim, peak_dbi: f64, floor_dbi: f64) -> Beam {
    let (sa, ca) = libm::sincos(aim.azimuth_rad);
    let (se, ce) = libm::sincos(aim.elevation_rad);
    Beam {
        forward: Position::new(ca * ce, sa * ce, se),
        left: Position::new(-sa, ca, 0.0),
        up: Position::new(-ca * se, -sa * se, ce),
        peak_dbi,
        floor_dbi,
        sin_elevation: [-1.0, 1.0],
    }
}

impl Beam {
    /// The same shape with the gain `peak_dbi` at the boresight: all gains change by the same decibels.
    pub(super) fn with_peak(self, peak_dbi: f64) -> Self {
        Self { peak_dbi, floor_dbi: self.floor_dbi + (peak_dbi - self.peak_dbi), ..self }
    }

    /// Gain in the unit direction `d` of the frame of the antenna (dBi).
    #[inline]
    pub(super) fn gain_dbi(&self, pattern: &Pattern, d: Position) -> f64 {
        match *pattern {
            Pattern::Pencil { cos_edge, db_per_rad2 } => {
                let cos = self.forward.dot(d);
                if cos < cos_edge {
                    return self.floor_dbi;
                }
                let angle_rad = libm::acos(cos.clamp(-1.0, 1.0));
                self.peak_dbi - db_per_rad2 * angle_rad * angle_rad
            }
            Pattern::Fan { azimuth_db_per_rad2, elevation_db_per_rad2, sin_elevation, tan_azimuth } => {
                let (x, y, z) = (self.forward.dot(d), self.left.dot(d), self.up.dot(d));
                if z.abs() > sin_elevation || (tan_azimuth < f64::INFINITY && y.abs() > x * tan_azimuth) {
                    return self.floor_dbi;
                }
                let (azimuth, elevation) = (libm::atan2(y, x), libm::asin(z.clamp(-1.0, 1.0)));
                let drop_db = azimuth_db_per_rad2 * azimuth * azimuth + elevation_db_per_rad2 * elevation * elevation;
                (self.peak_dbi - drop_db).max(self.floor_dbi)
            }
            Pattern::FlatCone { cos_half } => {
                if self.forward.dot(d) >= cos_half {
                    self.peak_dbi
                } else {
                    self.floor_dbi
                }
            }
            Pattern::FlatWedge { cos_half } => {
                // The left axis is horizontal, so turning it back gives the boresight on the horizontal plane.
                let along = self.left.y_m * d.x_m - self.left.x_m * d.y_m;
                let across = (d.x_m * d.x_m + d.y_m * d.y_m).sqrt();
                let [low, high] = self.sin_elevation;
                if along >= cos_half * across && d.z_m >= low && d.z_m <= high {
                    self.peak_dbi
                } else {
                    self.floor_dbi
                }
            }
        }
    }
}
