//! Walls as people have them: a line on the floor, a thickness and a height, with doors and windows.

use sextant_kernel::SettingError;

use super::obstacle::{Obstacle, ObstacleConfig};
use crate::geometry::polygon::area_m2;
use crate::geometry::shape::{LEVEL_M, PrismConfig, ShapeConfig};

/// A wall as written in a scenario. At most one of `material` and `absorption_per_m` is given, and at least one of these and
/// `loss_db`.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct WallConfig {
    /// Name in messages and pictures; `wall 0` for the first one, and so on, if absent.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub name: Option<String>,
    /// The middle of the wall on the floor, corner by corner (m). If the last corner is the first one, the wall is closed.
    pub points_m: Vec<[f64; 2]>,
    /// Thickness (m).
    #[cfg_attr(feature = "config", serde(default = "usual_thickness_m"))]
    pub thickness_m: f64,
    /// Name of the storey on whose floor it stands; heights are from zero if absent.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub storey: Option<String>,
    /// Height of its foot (m), above the floor of its storey if it has one.
    #[cfg_attr(feature = "config", serde(default))]
    pub bottom_m: f64,
    /// Height from its foot to its top (m). If absent, it reaches to the ceiling of its storey, or is 2.5 m high if it has none.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub height_m: Option<f64>,
    /// Name of a known material. `concrete` is light and dry, and absorbs 0.30 times the decibels of `itu-concrete`, which is dense, at all
    /// carriers.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    #[cfg_attr(feature = "schema", schemars(transform = crate::propagation::material::listed))]
    pub material: Option<String>,
    /// Absorption coefficient α (1/m), as that of an obstacle.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub absorption_per_m: Option<f64>,
    /// Loss of a link through the wall, however thick it is (dB), beside absorption.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub loss_db: Option<f64>,
    /// Loss of a reflection off its faces (dB); that of the channel if absent.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub reflection_loss_db: Option<f64>,
    /// Doors and windows.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Vec::is_empty"))]
    #[cfg_attr(feature = "schema", schemars(extend("default" = [])))]
    pub openings: Vec<OpeningConfig>,
}

/// A door, a window or a passage in a wall, as written in a scenario. Nothing stands in it without `material`, `absorption_per_m`
/// and `loss_db`; with one of them it is closed, for robots too.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct OpeningConfig {
    /// Where it begins, along the middle of the wall from its first corner (m).
    pub at_m: f64,
    /// Its width along the wall (m).
    pub width_m: f64,
    /// Where it begins above the foot of the wall (m).
    #[cfg_attr(feature = "config", serde(default))]
    pub bottom_m: f64,
    /// Where it ends above the foot of the wall (m); at the top of the wall if absent.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub top_m: Option<f64>,
    /// Name of the material that closes it.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    #[cfg_attr(feature = "schema", schemars(transform = crate::propagation::material::listed))]
    pub material: Option<String>,
    /// Absorption coefficient α of what closes it (1/m).
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub absorption_per_m: Option<f64>,
    /// Loss of a link through what closes it (dB).
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub loss_db: Option<f64>,
}

/// Thickness of a wall that does not say its own (m).
pub const USUAL_THICKNESS_M: f64 = 0.15;
/// Height of a wall that does not say its own (m).
pub const USUAL_HEIGHT_M: f64 = 2.5;

#[cfg(feature = "config")]
fn usual_thickness_m() -> f64 {
    USUAL_THICKNESS_M
}

/// Two places are one if they are nearer than this (m).
const SAME_M: f64 = 1e-6;

type Vector = [f64; 2];

fn plus([x, y]: Vector, [dx, dy]: Vector, times: f64) -> Vector {
    [x + dx * times, y + dy * times]
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// A straight part of a wall.
struct Segment {
    from: Vector,
    /// Direction, of length 1.
    along: Vector,
    length_m: f64,
    /// Where it begins along the wall (m).
    at_m: f64,
    /// How far from `from` its left and its right side begin (m).
    start_m: [f64; 2],
    /// How far from its end its left and its right side go on (m).
    end_m: [f64; 2],
    /// The corner beyond its end that it has, if it turns there.
    corner: Option<Vector>,
}

impl Segment {
    /// The footprint of the part between these distances from the start (m): at its ends it meets its neighbours.
    fn footprint(&self, from_m: f64, to_m: f64, thickness_m: f64) -> Vec<Vector> {
        let half_m = 0.5 * thickness_m;
        let is_last = to_m >= self.length_m;
        let start_m = if from_m <= 0.0 { self.start_m } else { [0.0; 2] };
        let end_m = if is_last { self.end_m } else { [0.0; 2] };
        let left = |along_m: f64| self.beside(along_m, half_m);
        let right = |along_m: f64| self.beside(along_m, -half_m);
        let corner = self.corner.filter(|_| is_last);
        [Some(left(from_m + start_m[0])), Some(right(from_m + start_m[1])), Some(right(to_m + end_m[1])), corner]
            .into_iter()
            .flatten()
            .chain([left(to_m + end_m[0])])
            .collect()
    }

    /// The place at a distance from the start, so far to the left of the middle.
    fn beside(&self, along_m: f64, left_m: f64) -> Vector {
        let left = [-self.along[1], self.along[0]];
        plus(plus(self.from, self.along, along_m), left, left_m)
    }

    /// The longest that its ends take of it (m).
    fn joints_m(&self) -> [f64; 2] {
        [self.start_m, self.end_m].map(|ends| ends[0].abs().max(ends[1].abs()))
    }
}

/// An opening in its straight part of a wall.
struct Placed<'a> {
    segment: usize,
    /// Where it begins and ends, from the start of the part (m).
    from_m: f64,
    to_m: f64,
    /// From where to where it is above the foot (m).
    heights_m: [f64; 2],
    opening: &'a OpeningConfig,
    /// Its place among those as written.
    number: usize,
}

impl WallConfig {
    /// The obstacles that the wall number `number` of a world consists of: one for each piece between corners and openings, what is
    /// below and above openings, and what closes them. Heights are from zero ([`Storeys::wall`](crate::Storeys::wall)). Pieces of one wall that touch are crossed in one passage.
    ///
    /// # Errors
    /// If a number is invalid, the wall has no length, a part is too short for its thickness, or an opening is not within one
    /// straight part, is higher than the wall or overlaps another one.
    pub fn obstacles(&self, number: usize) -> Result<Vec<Obstacle>, SettingError> {
        let thickness_m = SettingError::positive("thickness_m", self.thickness_m)?;
        let height_m = SettingError::positive("height_m", self.height_m.unwrap_or(USUAL_HEIGHT_M))?;
        SettingError::finite("bottom_m", self.bottom_m)?;
        let segments = self.segments()?;
        let openings = self.placed_openings(&segments, height_m)?;
        let mut made = Vec::new();
        for (number, segment) in segments.iter().enumerate() {
            let mut from_m = 0.0;
            for Placed { from_m: at_m, to_m, heights_m: [bottom_m, top_m], opening, .. } in
                openings.iter().filter(|placed| placed.segment == number)
            {
                self.add(&mut made, segment.footprint(from_m, *at_m, thickness_m), [0.0, height_m], None)?;
                let footprint = segment.footprint(*at_m, *to_m, thickness_m);
                self.add(&mut made, footprint.clone(), [0.0, *bottom_m], None)?;
                self.add(&mut made, footprint.clone(), [*bottom_m, *top_m], Some(opening))?;
                self.add(&mut made, footprint, [*top_m, height_m], None)?;
                from_m = *to_m;
            }
            self.add(&mut made, segment.footprint(from_m, segment.length_m, thickness_m), [0.0, height_m], None)?;
        }
        Ok(made.into_iter().map(|piece: Obstacle| piece.of_wall(number)).collect())
    }

    /// Adds a piece between these heights above the foot, of the wall or of what closes an opening; nothing if it has no height or
    /// no length.
    fn add(
        &self,
        made: &mut Vec<Obstacle>,
        corners_m: Vec<Vector>,
        [from_m, to_m]: [f64; 2],
        opening: Option<&OpeningConfig>,
    ) -> Result<(), SettingError> {
        if to_m - from_m <= 0.0 || area_m2(&corners_m) <= SAME_M * self.thickness_m {
            return Ok(());
        }
        let (material, absorption_per_m, loss_db) = match opening {
            None => (&self.material, self.absorption_per_m, self.loss_db),
            Some(opening) => (&opening.material, opening.absorption_per_m, opening.loss_db),
        };
        if opening.is_some() && material.is_none() && absorption_per_m.is_none() && loss_db.is_none() {
            return Ok(());
        }
        let what = if opening.is_some() { "opening" } else { "piece" };
        let number = made.len();
        made.push(Obstacle::try_from(ObstacleConfig {
            name: self.name.as_ref().map(|name| format!("{name}, {what} {number}")),
            shape: ShapeConfig::Prism(PrismConfig {
                corners_m,
                bottom_m: self.bottom_m + from_m,
                height_m: to_m - from_m,
            }),
            material: material.clone(),
            absorption_per_m,
            loss_db,
            solid: true,
            reflection_loss_db: self.reflection_loss_db,
        })?);
        Ok(())
    }

    /// The straight parts of the wall.
    fn segments(&self) -> Result<Vec<Segment>, SettingError> {
        /// Of two parts that turn back by more, the ends are square: a joint would be a spike.
        const SHARPEST: f64 = 0.3;
        let refused = |found: String, allowed: &str| SettingError::new("points_m", found, allowed);
        let points = &self.points_m;
        if let Some(bad) = points.iter().flatten().find(|number| !(-1e9..=1e9).contains(*number)) {
            return Err(refused(format!("a list with {bad}"), "numbers of metres"));
        }
        if points.len() < 2 {
            return Err(refused(format!("a list of {}", points.len()), "two corners or more"));
        }
        let mut segments: Vec<Segment> = Vec::new();
        let mut at_m = 0.0;
        for (number, pair) in points.windows(2).enumerate() {
            let way = plus(pair[1], pair[0], -1.0);
            let length_m = dot(way, way).sqrt();
            if length_m <= SAME_M {
                let found = format!("corners {number} and {} at one place", number + 1);
                return Err(refused(found, "each corner apart from the one before"));
            }
            let along = [way[0] / length_m, way[1] / length_m];
            segments.push(Segment {
                from: pair[0],
                along,
                length_m,
                at_m,
                start_m: [0.0; 2],
                end_m: [0.0; 2],
                corner: None,
            });
            at_m += length_m;
        }
        let is_closed = segments.len() > 2 && {
            let apart = plus(points[0], points[points.len() - 1], -1.0);
            dot(apart, apart).sqrt() <= SAME_M
        };
        let count = segments.len();
        let half_m = 0.5 * self.thickness_m;
        for before in (0..count).filter(|before| is_closed || before + 1 < count) {
            let after = (before + 1) % count;
            let (a, b) = (segments[before].along, segments[after].along);
            let cosine = dot(a, b);
            let sine = a[0] * b[1] - a[1] * b[0];
            if 1.0 + cosine <= SHARPEST || sine.abs() <= f64::EPSILON {
                continue;
            }
            // By the tangent of half the turn: to the left, the left sides are shorter.
            let joint_m = half_m * sine / (1.0 + cosine);
            segments[before].end_m = [-joint_m, joint_m];
            segments[after].start_m = if cosine >= -1e-9 {
                // The part before has the whole corner, and the part after begins with a square end: no link runs along the joint.
                segments[before].corner = Some(segments[after].beside(joint_m.abs(), -half_m * joint_m.signum()));
                [joint_m.abs(); 2]
            } else {
                [joint_m, -joint_m]
            };
        }
        for (number, segment) in segments.iter().enumerate() {
            let [first_m, last_m] = segment.joints_m();
            if first_m + last_m >= segment.length_m {
                let found = format!("a part {number} of {} m", segment.length_m);
                let allowed = format!(
                    "parts longer than the joints with their neighbours at thickness_m = {}",
                    self.thickness_m
                );
                return Err(SettingError::new("points_m", found, allowed));
            }
        }
        Ok(segments)
    }

    /// The openings in the order of the wall. What would leave less than a millimetre of wall goes to the end of its part, to the
    /// next opening, to the foot or to the top.
    fn placed_openings(&self, segments: &[Segment], height_m: f64) -> Result<Vec<Placed<'_>>, SettingError> {
        let snapped = |value_m: f64, to_m: f64| if (value_m - to_m).abs() <= LEVEL_M { to_m } else { value_m };
        let mut placed: Vec<Placed<'_>> = Vec::new();
        for (number, opening) in self.openings.iter().enumerate() {
            let within = |error: SettingError| error.within(format!("openings[{number}]"));
            SettingError::not_negative("at_m", opening.at_m).map_err(within)?;
            SettingError::positive("width_m", opening.width_m).map_err(within)?;
            let top_m = snapped(opening.top_m.unwrap_or(height_m), height_m);
            if !(0.0..height_m).contains(&opening.bottom_m) {
                let allowed = format!("a number from 0 to less than {height_m}, the height of the wall");
                return Err(within(SettingError::new("bottom_m", opening.bottom_m, allowed)));
            }
            if !(top_m > opening.bottom_m && top_m <= height_m) {
                let allowed = format!("a number above bottom_m, at most {height_m}, the height of the wall");
                return Err(within(SettingError::new("top_m", top_m, allowed)));
            }
            let begins = |segment: &Segment| segment.at_m <= opening.at_m + LEVEL_M;
            let segment = segments.iter().rposition(begins).unwrap_or(0);
            let part = &segments[segment];
            let [first_m, last_m] = part.joints_m();
            let (least_m, most_m) = (first_m, part.length_m - last_m);
            let from_m = snapped(opening.at_m - part.at_m, least_m);
            let to_m = snapped(opening.at_m - part.at_m + opening.width_m, most_m);
            if from_m < least_m || to_m > most_m {
                let found = format!("{} with width_m = {}", opening.at_m, opening.width_m);
                let (from, to) = (part.at_m + least_m, part.at_m + most_m);
                let allowed =
                    format!("an opening within a straight part of the wall: this one is from {from:.3} to {to:.3} m");
                return Err(within(SettingError::new("at_m", found, allowed)));
            }
            let heights_m = [snapped(opening.bottom_m, 0.0), top_m];
            placed.push(Placed { segment, from_m, to_m, heights_m, opening, number });
        }
        placed.sort_by(|a, b| a.segment.cmp(&b.segment).then(a.from_m.total_cmp(&b.from_m)));
        for i in 1..placed.len() {
            let [before, after] = &mut placed[i - 1..=i] else { continue };
            if before.segment == after.segment {
                before.to_m = snapped(before.to_m, after.from_m);
                if before.to_m > after.from_m {
                    let (later, other) = (before.number.max(after.number), before.number.min(after.number));
                    let found = self.openings[later].at_m;
                    let allowed = format!("a place beside openings[{other}]");
                    return Err(SettingError::new(format!("openings[{later}].at_m"), found, allowed));
                }
            }
        }
        Ok(placed)
    }
}

#[cfg(test)]
mod tests;
