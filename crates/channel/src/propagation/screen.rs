//! What a person or a vehicle takes of a link that it stands in: a screen with four knife edges (3GPP TR 38.901,
//! 7.6.4.2, blockage model B; METIS deliverable D1.4, 2015).

use std::f64::consts::{FRAC_PI_2, PI};

use sextant_kernel::SettingError;

use crate::geometry::position::Position;
use crate::power::Db;
use crate::propagation::path_loss::LIGHT_M_PER_S;
use crate::propagation::reflection::Ray;

/// A screen as written in a scenario: what a body that moves takes of links.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ScreenConfig {
    /// Its width, seen from all sides alike (m): 0.3 for a person, 4.8 for a vehicle (TR 38.901).
    #[cfg_attr(feature = "config", serde(default = "width_of_a_person_m"))]
    pub width_m: f64,
    /// Its height above the place of the body (m): 1.7 for a person, 1.4 for a vehicle.
    #[cfg_attr(feature = "config", serde(default = "height_of_a_person_m"))]
    pub height_m: f64,
}

#[cfg(feature = "config")]
fn width_of_a_person_m() -> f64 {
    0.3
}

#[cfg(feature = "config")]
fn height_of_a_person_m() -> f64 {
    1.7
}

/// A screen that stands upright across each way of a signal, with its lower edge at the place of its body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Screen {
    half_width_m: f64,
    height_m: f64,
}

impl TryFrom<ScreenConfig> for Screen {
    type Error = SettingError;

    fn try_from(config: ScreenConfig) -> Result<Self, SettingError> {
        Ok(Self {
            half_width_m: SettingError::in_range("width_m", config.width_m, 1e-2, 100.0)? / 2.0,
            height_m: SettingError::in_range("height_m", config.height_m, 1e-2, 100.0)?,
        })
    }
}

/// Places this near are the same (m).
const SAME_PLACE_M: f64 = 1e-9;

/// A way of a signal as a screen sees it: straight, with the legs before and after it unfolded.
struct Unfolded {
    /// Horizontal lengths before and after the screen (m).
    before_m: f64,
    after_m: f64,
    /// Its height at the screen (m), ...
    height_m: f64,
    /// ... and by how much it rises on a horizontal metre.
    slope: f64,
}

impl Screen {
    /// Loss of one way of a signal between two places by a screen at `place`, at a carrier (GHz). The screen counts on each
    /// leg of the way that passes it, and once where the way turns.
    #[must_use]
    pub fn loss(&self, place: Position, ray: &Ray, [from, to]: [Position; 2], carrier_ghz: f64) -> Db {
        let level = |[a, b]: [Position; 2]| libm::hypot(b.x_m - a.x_m, b.y_m - a.y_m);
        let all_m: f64 = ray.legs(from, to).map(level).sum();
        let (mut gone_m, mut loss, mut at_turn) = (0.0, Db(0.0), Db(0.0));
        for [a, b] in ray.legs(from, to) {
            let leg_m = level([a, b]);
            if leg_m > 0.0 {
                let (x, y) = ((b.x_m - a.x_m) / leg_m, (b.y_m - a.y_m) / leg_m);
                let (to_x, to_y) = (place.x_m - a.x_m, place.y_m - a.y_m);
                let (along_m, aside_m) = (x * to_x + y * to_y, x * to_y - y * to_x);
                let slope = (b.z_m - a.z_m) / leg_m;
                let before_m = gone_m + along_m;
                let height_m = a.z_m + slope * along_m;
                let way = Unfolded { before_m, after_m: all_m - before_m, height_m, slope };
                let is_between = before_m > SAME_PLACE_M && before_m < all_m - SAME_PLACE_M;
                if is_between && along_m >= -SAME_PLACE_M && along_m <= leg_m + SAME_PLACE_M {
                    let here = self.across(aside_m, place.z_m, &way, carrier_ghz);
                    if along_m.abs() <= SAME_PLACE_M || (along_m - leg_m).abs() <= SAME_PLACE_M {
                        at_turn = Db(at_turn.0.max(here.0));
                    } else {
                        loss = loss + here;
                    }
                }
            }
            gone_m += leg_m;
        }
        loss + at_turn
    }

    /// `L = -20 log10(1 - (F_h1 + F_h2)(F_w1 + F_w2))`, `F = atan(±π/2 sqrt(π/λ (D1 + D2 - r))) / π` for each edge, with the
    /// lengths from the ends of the way to it, seen from above for the sides and from the side for top and bottom. The sign
    /// is plus in the shadow; if the way passes, it is minus for the nearer of two edges.
    fn across(&self, aside_m: f64, floor_m: f64, way: &Unfolded, carrier_ghz: f64) -> Db {
        let wavelength_m = LIGHT_M_PER_S / (carrier_ghz * 1e9);
        let &Unfolded { before_m, after_m, height_m, slope } = way;
        let edge = |offset_m: f64, slope: f64| {
            let direct_m = libm::hypot(before_m + after_m, slope * (before_m + after_m));
            let bent_m =
                libm::hypot(before_m, offset_m + slope * before_m) + libm::hypot(after_m, offset_m - slope * after_m);
            libm::atan(FRAC_PI_2 * (PI / wavelength_m * (bent_m - direct_m).max(0.0)).sqrt()) / PI
        };
        let pair = |low_m: f64, high_m: f64, slope: f64| {
            let (low, high) = (edge(low_m, slope), edge(high_m, slope));
            if low_m <= 0.0 && high_m >= 0.0 { low + high } else { (high - low).abs() }
        };
        let sides = pair(aside_m - self.half_width_m, aside_m + self.half_width_m, 0.0);
        let heights = pair(floor_m - height_m, floor_m + self.height_m - height_m, slope);
        Db(-20.0 * libm::log10(1.0 - sides * heights))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The straight way between two places.
    fn straight(from: Position, to: Position) -> Ray {
        let (length_m, apart) = (from.distance_m(to), to - from);
        let departure = apart * (1.0 / length_m);
        let (loss, phase_rad, arrival) = (Db(0.0), 0.0, departure * -1.0);
        let turns = [from, to];
        Ray { loss, departure, arrival, length_m, phase_rad, bounces: 0, is_diffracted: false, turns }
    }

    const GHZ: f64 = 60.0;

    fn person() -> Screen {
        ScreenConfig { width_m: 0.3, height_m: 1.7 }.try_into().expect("a good screen")
    }

    fn between(from: [f64; 3], to: [f64; 3], place: [f64; 3]) -> f64 {
        let [from, to] = [from, to].map(Position::from);
        let ray = straight(from, to);
        let there = person().loss(place.into(), &ray, [from, to], GHZ).0;
        let back = person().loss(place.into(), &ray.reversed(), [to, from], GHZ).0;
        assert!((there - back).abs() < 1e-9, "{there} dB, and {back} dB back");
        there
    }

    /// The formula of the report, term by term: lengths from both ends to the four edges of the screen at (5, y).
    fn literal_db(y: f64) -> f64 {
        let wavelength = 0.299_792_458 / GHZ;
        let term = |d1: f64, d2: f64, sign: f64| {
            (sign * std::f64::consts::FRAC_PI_2 * (std::f64::consts::PI / wavelength * (d1 + d2 - 10.0)).sqrt())
                .atan()
                / std::f64::consts::PI
        };
        let to_edge = |offset: f64| (25.0 + offset * offset).sqrt();
        let (near, far) = (y.abs() - 0.15, y.abs() + 0.15);
        let near_sign = if near > 0.0 { -1.0 } else { 1.0 };
        let sides = term(to_edge(near), to_edge(near), near_sign) + term(to_edge(far), to_edge(far), 1.0);
        // The way is 1 m above the floor, 0.7 m below the top.
        let heights = term(to_edge(1.0), to_edge(1.0), 1.0) + term(to_edge(0.7), to_edge(0.7), 1.0);
        -20.0 * (1.0 - heights * sides).log10()
    }

    #[test]
    fn the_loss_is_that_of_the_literal_formula_in_the_centre_at_the_edge_and_beside() {
        for y in [0.0, 0.1, 0.15, 0.2, 0.5, 2.0, -0.12] {
            let found = between([0.0, 0.0, 1.0], [10.0, 0.0, 1.0], [5.0, y, 0.0]);
            assert!((found - literal_db(y)).abs() < 1e-9, "{y}: {found}, literal {}", literal_db(y));
        }
        // Worked out elsewhere.
        let at = |y: f64| between([0.0, 0.0, 1.0], [10.0, 0.0, 1.0], [5.0, y, 0.0]);
        assert!((at(0.15) - 4.7476).abs() < 1e-3, "{}", at(0.15));
        assert!((at(0.0) - 11.5615).abs() < 1e-3, "{}", at(0.0));
        assert!(at(3.0) < 0.005, "{}", at(3.0));
    }

    #[test]
    fn who_stands_behind_an_end_takes_nothing_and_a_way_overhead_little() {
        assert!(between([0.0, 0.0, 1.0], [10.0, 0.0, 1.0], [-1.0, 0.0, 0.0]).abs() < 1e-12);
        assert!(between([0.0, 0.0, 1.0], [10.0, 0.0, 1.0], [11.0, 0.0, 0.0]).abs() < 1e-12);
        assert!(between([0.0, 0.0, 3.0], [10.0, 0.0, 3.0], [5.0, 0.0, 0.0]) < 0.3);
        // A way that rises is shaded where it passes low.
        let rising = |x: f64| between([0.0, 0.0, 0.5], [10.0, 0.0, 4.5], [x, 0.0, 0.0]);
        assert!(rising(1.0) > 10.0 && rising(8.0) < 1.0, "{} {}", rising(1.0), rising(8.0));
    }

    #[test]
    fn a_folded_way_counts_as_long_as_it_is() {
        // A way over a mirror at y = 3: on its first leg it is shaded as on a straight way of the same length.
        let (from, to, turn) =
            (Position::new(0.0, 0.0, 1.0), Position::new(8.0, 0.0, 1.0), Position::new(4.0, 3.0, 1.0));
        let bounced = Ray { turns: [turn; 2], ..straight(from, to) };
        let found = person().loss(Position::new(2.0, 1.5, 0.0), &bounced, [from, to], GHZ).0;
        let expected = between([0.0, 0.0, 1.0], [10.0, 0.0, 1.0], [2.5, 0.0, 0.0]);
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        // At the mirror it counts once.
        let there = person().loss(Position::new(4.0, 3.0, 0.0), &bounced, [from, to], GHZ).0;
        assert!((there - between([0.0, 0.0, 1.0], [10.0, 0.0, 1.0], [5.0, 0.0, 0.0])).abs() < 1e-9, "{there}");
        // Whoever stands on the straight line does not shade it.
        assert!(person().loss(Position::new(4.0, 0.0, 0.0), &bounced, [from, to], GHZ).0 < 0.03);
    }

    #[test]
    fn a_screen_without_size_is_refused() {
        let refused = |width_m, height_m| Screen::try_from(ScreenConfig { width_m, height_m }).unwrap_err().key;
        assert_eq!(refused(0.0, 1.7), "width_m");
        assert_eq!(refused(0.3, f64::NAN), "height_m");
    }
}
