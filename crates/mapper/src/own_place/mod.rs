//! A node's own place, from the anchors that it heard.
//!
//! The likelihood is that of [`MlTm`](crate::MlTm) and [`MmTm`](crate::MmTm), with the parts exchanged: the node listens,
//! and anchors at known places send from sectors that point in known directions (Gunathillake 2018, chapter 5, step 3).

mod arcs;
mod evidence;
mod octets;
mod orientation;
mod search_set;
mod sector_bearing;
mod soft;
mod wedged;

#[cfg(feature = "config")]
use serde::{Deserialize, Serialize};
use sextant_channel::{Position, Wedge};
use sextant_kernel::SettingError;

use crate::grid_ml::solver::ReceptionCurve;
use crate::log_facts::SectorTolerance;
use crate::log_facts::heights::check_z_range;
use crate::numerics::normal::Normal;
use crate::posterior::{Estimate, EstimateKind};
use crate::profile::{ProfileConfig, ReceptionProfile};
use evidence::AnchorEvidence;
pub use orientation::{Bearing, DirectionRule, OrientationMethod, RingOrientation, UnorientedRing};
pub use sector_bearing::{BearingTable, SectorBearing};

/// Largest number of vertices of a cube as wide as the range of the profile on both sides of an anchor.
const MOST_VERTICES: f64 = 1e9;

/// How a node computes its own place, as written in a scenario.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "config", serde(deny_unknown_fields))]
pub struct OwnPlaceConfig {
    /// Distance of neighbouring grid vertices (m).
    pub grid_step_m: f64,
    /// How likely a packet is received over a distance.
    pub profile: ProfileConfig,
    /// Lowest and highest height of a node (m). If absent, the node is in the plane of the anchors that it heard if their
    /// heights differ by at most a twentieth of the range of the profile; otherwise from one range below them to one range
    /// above them.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub z_range_m: Option<[f64; 2]>,
    /// How the place is estimated from the likelihood.
    #[cfg_attr(feature = "config", serde(default))]
    pub estimate: EstimateKind,
    /// How far outside the sector of an anchor a vertex may lie. Only for `model = "wedge"`, but `unlimited` switches off
    /// sectors for both.
    #[cfg_attr(feature = "config", serde(default))]
    pub tolerance: SectorTolerance,
    /// What a sector says about the direction.
    #[cfg_attr(feature = "config", serde(default))]
    pub model: PlaceModel,
    /// Whether known anchors that were not heard are evidence.
    #[cfg_attr(feature = "config", serde(default))]
    pub silence: AnchorSilence,
}

impl OwnPlaceConfig {
    /// The literal likelihood of the thesis on a grid of `grid_step_m`: the vertex of highest likelihood, wedges, heard
    /// anchors only.
    #[must_use]
    pub fn new(grid_step_m: f64, profile: ProfileConfig) -> Self {
        Self {
            grid_step_m,
            profile,
            z_range_m: None,
            estimate: EstimateKind::default(),
            tolerance: SectorTolerance::default(),
            model: PlaceModel::default(),
            silence: AnchorSilence::default(),
        }
    }
}

/// What the sector in which an anchor was heard says about the direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "config", serde(rename_all = "snake_case"))]
pub enum PlaceModel {
    /// All directions within the sector are alike, others are impossible (thesis, chapter 5).
    #[default]
    Wedge,
    /// How likely the direction lies in the sector, given how uncertain the anchor's orientation and place are; and how
    /// likely it is heard over the distance, given how uncertain its place is.
    Soft,
}

/// Whether known anchors that were not heard are evidence on the own place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "config", serde(rename_all = "snake_case"))]
pub enum AnchorSilence {
    /// They are not (thesis, chapter 5).
    #[default]
    Ignored,
    /// Each of their packets was missed, which has the probability `1 − S(d)`.
    Missed,
}

/// An anchor as a node knows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeardAnchor {
    /// Where it says that it is (m).
    pub place: Position,
    /// The sector of best reception; `None` if it has none or its direction is unknown, which counts as an
    /// omnidirectional anchor. For an anchor that was not heard: the directions that its sectors cover together, `None` if
    /// these are all.
    pub sector: Option<HeardSector>,
    /// Covariance of its place (m²), if it is an estimate. Only the soft model uses it.
    pub covariance: Option<[[f64; 3]; 3]>,
    /// Packets received from it; for an anchor that was not heard, the packets missed. 0 is no evidence.
    pub packets: u32,
}

/// A sector of an anchor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeardSector {
    /// Its directions as seen from the anchor.
    pub wedge: Wedge,
    /// Standard deviation of the azimuth to which the anchor believes it points (rad). Only the soft model uses it.
    pub azimuth_sigma_rad: f64,
}

/// Where a node believes to be.
#[derive(Clone, Debug, PartialEq)]
pub struct OwnEstimate {
    /// The place, as on a topology map. With conditions broken, it is infeasible, and its log-likelihood leaves out the
    /// factors of these.
    pub estimate: Estimate,
    /// Number of conditions that the place breaks: one for each anchor beyond the range, one for each sector that points
    /// elsewhere (with the tolerance of the settings).
    pub violations: usize,
    /// Number of places at which the likelihood was computed.
    pub vertices: u64,
    /// Memory of a node that computes this in place, in octets. Numbers are in single precision. The node stores the
    /// evidence (for each anchor its place and packets, 14; its sector, 20; the covariance, 24) and the result, but no
    /// grid: vertices come one after the other. The soft mean is taken over a small grid whose weights it stores.
    pub peak_octets: usize,
}

/// Computes a node's own place from the anchors that it heard.
///
/// The likelihood of a vertex g is `Π Z(g)` over the heard anchors, with `Z = S(d)` where g is nearer than the range and
/// in the sector, else 0; each of several packets counts. With [`AnchorSilence::Missed`] it is multiplied by `1 − S(d)`
/// for each known anchor that was not heard. If it is 0 everywhere, the vertices that break the fewest conditions are the
/// search set, and their likelihood is that of the conditions that hold: the limit of a small factor for each broken
/// condition, as this factor goes to 0.
///
/// [`PlaceModel::Soft`] replaces the condition on the direction by its probability: azimuth and elevation to g have
/// normal errors, from the uncertainty of the orientation and that of the places across the line of sight, over the
/// distance (`Φ((b − φ)/σ) − Φ((a − φ)/σ)` for a sector from a to b). One time in fifty a sector is any. `S(d)` is averaged
/// over the uncertainty of the anchor's place along the line by Gauss–Hermite quadrature with three points. With no
/// uncertainty and a fine grid it is the same likelihood inside the sectors.
///
/// The result is the same in every run. Memory is allocated once a call, not per vertex.
#[derive(Clone, Debug)]
pub struct OwnPlace {
    grid_step_m: f64,
    curve: ReceptionCurve,
    /// The curve with a floor and a ceiling, where conditions are broken.
    clamped: ReceptionCurve,
    z_range_m: Option<[f64; 2]>,
    estimate: EstimateKind,
    tolerance: SectorTolerance,
    model: PlaceModel,
    silence: AnchorSilence,
    normal: Normal,
}

impl OwnPlace {
    /// The place of a node that heard the anchors `heard`. `silent` are anchors of which it knows otherwise and that it
    /// did not hear; they count only if the settings say so. Anchors whose place is no number are left out. `None` if none
    /// is left, or no vertex is within the range of one.
    #[must_use]
    pub fn estimate(&self, heard: &[HeardAnchor], silent: &[HeardAnchor]) -> Option<OwnEstimate> {
        let silent = match self.silence {
            AnchorSilence::Ignored => &[],
            AnchorSilence::Missed => silent,
        };
        let evidence = AnchorEvidence::new(self, heard, silent)?;
        match self.model {
            PlaceModel::Wedge => wedged::estimate(&evidence, self.estimate),
            PlaceModel::Soft => soft::estimate(&evidence, self.estimate),
        }
    }

    /// Distance beyond which nothing is heard (m).
    #[must_use]
    pub fn range_m(&self) -> f64 {
        self.curve.range_m
    }
}

impl TryFrom<OwnPlaceConfig> for OwnPlace {
    type Error = SettingError;

    fn try_from(config: OwnPlaceConfig) -> Result<Self, SettingError> {
        let OwnPlaceConfig { grid_step_m, profile, z_range_m, estimate, tolerance, model, silence } = config;
        SettingError::positive("grid_step_m", grid_step_m)?;
        let profile = ReceptionProfile::for_grid(profile, grid_step_m).map_err(|error| error.within("profile"))?;
        let range_m = profile.range_m();
        let finest_m = 2.0 * range_m / libm::cbrt(MOST_VERTICES);
        if grid_step_m > range_m || grid_step_m < finest_m {
            let allowed = format!("{finest_m} to the range of the profile ({range_m} m)");
            return Err(SettingError::new("grid_step_m", grid_step_m, allowed));
        }
        check_z_range(z_range_m)?;
        let curve = ReceptionCurve::new(&profile);
        let clamped = curve.clamped();
        let normal = Normal::new();
        Ok(Self { grid_step_m, curve, clamped, z_range_m, estimate, tolerance, model, silence, normal })
    }
}
