//! The angles of a measurement: in degrees or radians, from the horizontal plane or from the zenith.

use super::ConvertError;
use super::book::Rows;
use super::names::{AngleUnit, ColumnName, SourceNames};

/// What angles of elevation are measured from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Origin {
    Horizon,
    Zenith,
}

/// The columns or variables of the angles.
pub(super) struct AngleNames<'a> {
    pub(super) azimuth: &'a str,
    /// `None` for a planar cut.
    pub(super) elevation: Option<&'a str>,
}

/// The least and the greatest of some angles, and how they are written.
#[derive(Clone, Copy)]
struct Span {
    least: f64,
    greatest: f64,
    /// Different angles.
    count: usize,
    /// Whether all are whole numbers.
    is_whole: bool,
}

impl Span {
    fn of(angles: impl Iterator<Item = f64>) -> Self {
        let mut angles: Vec<f64> = angles.filter(|angle| angle.is_finite()).collect();
        angles.sort_by(f64::total_cmp);
        angles.dedup();
        let is_whole = angles.iter().all(|angle| angle.fract().abs() <= 0.0);
        let (least, greatest) = (angles.first().copied().unwrap_or(0.0), angles.last().copied().unwrap_or(0.0));
        Self { least, greatest, count: angles.len(), is_whole }
    }

    /// Whether the angles would be within a few degrees, and are no whole numbers: so those in radians are.
    fn may_be_radians(self) -> bool {
        self.count > 1 && !self.is_whole && self.least >= -LARGEST_RAD && self.greatest <= LARGEST_RAD
    }

    /// Whether the angles go once around in radians, to a hundredth: of degrees that is no chance.
    fn is_turn_of_radians(self) -> bool {
        let step = (self.greatest - self.least) / (self.count.max(2) - 1) as f64;
        let around = std::f64::consts::TAU;
        let is_near = |span: f64| (span - around).abs() <= 0.01 * around;
        self.count >= 8 && (is_near(self.greatest - self.least) || is_near(self.greatest - self.least + step))
    }

    fn text(self) -> String {
        format!("{} different angles from {} to {}", self.count, self.least, self.greatest)
    }
}

/// No angle in radians is greater: once around, rounded up.
const LARGEST_RAD: f64 = 6.284;

/// Turns all angles into degrees, and those from the zenith into elevations, as their names and `names` say.
///
/// # Errors
/// If they do not say it.
pub(super) fn settle(rows: &mut Rows, of: &AngleNames<'_>, names: &SourceNames) -> Result<(), ConvertError> {
    let azimuths = Span::of(rows.0.iter().map(|row| row.azimuth_deg));
    if unit(of.azimuth, azimuths, names.angles)? == AngleUnit::Radians {
        rows.0.iter_mut().for_each(|row| row.azimuth_deg = degrees(row.azimuth_deg));
    }
    let Some(name) = of.elevation else { return Ok(()) };
    let elevations = Span::of(rows.0.iter().map(|row| row.elevation_deg));
    if unit(name, elevations, names.angles)? == AngleUnit::Radians {
        rows.0.iter_mut().for_each(|row| row.elevation_deg = degrees(row.elevation_deg));
    }
    let elevations = Span::of(rows.0.iter().map(|row| row.elevation_deg));
    if origin(name, elevations, names)? == Origin::Zenith {
        for row in &mut rows.0 {
            if !(0.0..=180.0).contains(&row.elevation_deg) {
                return Err(ConvertError::Invalid {
                    place: format!("`{name}`"),
                    found: format!("an angle of {} from the zenith", row.elevation_deg),
                    allowed: "0 to 180 degrees".to_owned(),
                });
            }
            row.elevation_deg = 90.0 - row.elevation_deg;
        }
    }
    Ok(())
}

/// An angle in degrees, to the last digit that radians of a file have.
fn degrees(rad: f64) -> f64 {
    (rad.to_degrees() * 1e3).round() / 1e3
}

/// The unit of angles: what the user says, or what their name says, or degrees if they cannot be radians.
fn unit(name: &str, span: Span, given: Option<AngleUnit>) -> Result<AngleUnit, ConvertError> {
    let named = ColumnName::of(name).angle_unit();
    match (given, named) {
        (Some(given), Some(named)) if given != named => {
            Err(ConvertError::AngleUnits { name: name.to_owned(), named: named.word(), given: given.word() })
        }
        (Some(unit), _) => Ok(unit),
        (None, Some(AngleUnit::Degrees)) if span.is_turn_of_radians() => Err(doubtful(name, span)),
        (None, Some(unit)) => Ok(unit),
        (None, None) if span.may_be_radians() => Err(doubtful(name, span)),
        (None, None) => Ok(AngleUnit::Degrees),
    }
}

fn doubtful(name: &str, span: Span) -> ConvertError {
    ConvertError::UnknownAngles { name: name.to_owned(), found: span.text() }
}

/// What angles are measured from: what the user says, or what their name says, or for `theta`, which is the angle from the zenith
/// in spherical coordinates, what only such angles can be.
fn origin(name: &str, span: Span, names: &SourceNames) -> Result<Origin, ConvertError> {
    let by_user = names.elevation.is_some();
    match ColumnName::of(name).plain.as_str() {
        _ if names.from_zenith => Ok(Origin::Zenith),
        _ if by_user => Ok(Origin::Horizon),
        "zenith" | "zenithangle" | "zenithangles" | "polar" | "polarangle" | "inclination" | "colatitude" => {
            Ok(Origin::Zenith)
        }
        "theta" | "thetas" | "thetaangle" => {
            if span.least >= 0.0 && span.greatest > 90.0 {
                Ok(Origin::Zenith)
            } else {
                Err(ConvertError::UnknownOrigin { name: name.to_owned(), found: span.text() })
            }
        }
        _ => Ok(Origin::Horizon),
    }
}
