//! The plane of a survey whose places are given by latitude and longitude.

use proptest::prelude::*;
use sextant_channel::Position;
use sextant_logs::LocalPlane;

/// East and north (m) of a place (degrees, degrees, metres) from an origin, computed by PROJ 9 (`+proj=cart`, then
/// `+proj=topocentric`, on the ellipsoid WGS84).
const REFERENCE: [([f64; 3], [f64; 3], [f64; 2]); 7] = [
    ([50.6061, 3.1367, 25.0], [50.6065, 3.1379, 27.0], [84.948_084_651_161_2, 44.497_167_075_226_95]),
    ([48.52, 7.74, 150.0], [48.59, 7.8, 150.0], [4_426.332_903_383_054, 7_785.995_199_131_654]),
    // Across 180 degrees.
    ([-17.0, 179.995, 5.0], [-17.002, -179.994, 5.0], [1_171.332_624_418_254_2, -221.371_584_250_626_37]),
    ([69.65, 18.95, 0.0], [69.7, 19.1, 40.0], [5_810.267_089_742_318, 5_585.059_557_436_08]),
    ([0.0, 0.0, 0.0], [0.01, -0.01, 0.0], [-1_113.194_885_439_668, 1_105.742_752_714_878_2]),
    ([-33.9, -70.6, 570.0], [-33.1, -70.1, 3200.0], [46_696.625_494_617_176, 88_658.869_300_972_57]),
    ([89.5, 12.0, 0.0], [89.505, 14.0, 10.0], [1_929.520_044_025_853_2, 592.148_959_322_199_4]),
];

#[test]
fn places_are_those_of_an_independent_program() {
    for (origin, place, [east, north]) in REFERENCE {
        let plane = LocalPlane::new(origin[0], origin[1], origin[2]);
        let local = plane.to_local(place[0], place[1], place[2]);
        assert!((local.x_m - east).abs() < 1e-7 && (local.y_m - north).abs() < 1e-7, "{local} of {place:?}");
        assert!((local.z_m - (place[2] - origin[2])).abs() < 1e-9);
        let back = plane.to_geodetic(local);
        assert!((back.lat_deg - place[0]).abs() < 1e-11, "{back:?} of {place:?}");
        assert!((back.lon_deg - place[1]).abs() < 1e-10, "{back:?} of {place:?}");
        assert!((back.height_m - place[2]).abs() < 1e-9);
    }
}

proptest! {
    #[test]
    fn the_way_back_leads_to_the_same_place(
        lat in -89.9..89.9, lon in -180.0..180.0, height in -400.0..9000.0,
        x_m in -1e5..1e5, y_m in -1e5..1e5, z_m in -500.0..5000.0,
    ) {
        let plane = LocalPlane::new(lat, lon, height);
        let place = Position::new(x_m, y_m, z_m);
        let found = plane.to_geodetic(place);
        prop_assert!((-180.0..=180.0).contains(&found.lon_deg) && (-90.0..=90.0).contains(&found.lat_deg));
        let again = plane.to_local(found.lat_deg, found.lon_deg, found.height_m);
        prop_assert!(again.distance_m(place) < 1e-7, "{again} of {place}");
    }

    /// Beside the origin, the radii of curvature of the ellipsoid give the lengths of a degree.
    #[test]
    fn a_small_step_has_the_length_that_the_curvature_gives(lat in -89.0..89.0_f64, lon in -180.0..180.0) {
        let (a, f) = (6_378_137.0, 1.0 / 298.257_223_563);
        let e2: f64 = f * (2.0 - f);
        let w2 = 1.0 - e2 * lat.to_radians().sin().powi(2);
        let (meridian_m, prime_vertical_m) = (a * (1.0 - e2) / w2.powf(1.5), a / w2.sqrt());
        let step_deg = 1e-5_f64;
        let step = LocalPlane::new(lat, lon, 0.0).to_local(lat + step_deg, lon + step_deg, 0.0);
        let (north, east) =
            (meridian_m * step_deg.to_radians(), prime_vertical_m * lat.to_radians().cos() * step_deg.to_radians());
        prop_assert!((step.y_m - north).abs() < 1e-4 && (step.x_m - east).abs() < 1e-4, "{step}");
    }
}
