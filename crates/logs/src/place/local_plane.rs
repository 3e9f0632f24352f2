//! A plane of east and north around a place on the earth (WGS 84).

use sextant_channel::Position;

/// Semi-major axis of the ellipsoid of WGS 84 (m); NIMA TR8350.2 (2000), table 3.1.
const A_M: f64 = 6_378_137.0;
/// Flattening of the ellipsoid, from the same table.
const F: f64 = 1.0 / 298.257_223_563;
/// First eccentricity, squared.
const E2: f64 = F * (2.0 - F);
/// Semi-minor axis (m).
const B_M: f64 = A_M * (1.0 - F);
/// Second eccentricity, squared.
const EP2: f64 = E2 / (1.0 - E2);

/// A place on the earth, WGS 84.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geodetic {
    /// Latitude (degrees north).
    pub lat_deg: f64,
    /// Longitude (degrees east), from −180 to 180.
    pub lon_deg: f64,
    /// Height above the ellipsoid, or above any other level that the log uses (m).
    pub height_m: f64,
}

impl Geodetic {
    /// The same with degrees to nine decimals (0.1 mm on the ground) and the height to a tenth of a millimetre.
    #[must_use]
    pub fn rounded(self) -> Self {
        let round = |value: f64, decimals: i32| (value * 10_f64.powi(decimals)).round() / 10_f64.powi(decimals);
        Self { lat_deg: round(self.lat_deg, 9), lon_deg: round(self.lon_deg, 9), height_m: round(self.height_m, 4) }
    }
}

/// A local plane: x and y are east and north in the plane that touches the ellipsoid at the origin, z is the height
/// above that of the origin. So level ground stays level, and distances are true to first order.
///
/// Between places at most `d` from the origin, distances along the ground are short by at most about the share d² / (2 R²),
/// where R = 6371 km: 1.2·10⁻⁸ at 1 km, 1.2·10⁻⁶ at 10 km, 1.2·10⁻⁴ at 100 km. There is no error of projection in the
/// way back: [`to_geodetic`](Self::to_geodetic) inverts [`to_local`](Self::to_local) to less than 0.1 µm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalPlane {
    origin: Geodetic,
    /// The origin in the frame of the earth (m).
    center: [f64; 3],
    sin_lat: f64,
    cos_lat: f64,
    sin_lon: f64,
    cos_lon: f64,
}

impl LocalPlane {
    /// Largest absolute latitude (degrees): at a pole east and north have no meaning.
    pub const LARGEST_LAT_DEG: f64 = 89.9;
    /// Largest distance from the origin at which the plane is still used (m).
    pub const RADIUS_M: f64 = 100e3;

    /// The plane around a place (degrees north and east, metres). The latitude is at most
    /// [`LARGEST_LAT_DEG`](Self::LARGEST_LAT_DEG) from the equator.
    #[must_use]
    pub fn new(lat_deg: f64, lon_deg: f64, height_m: f64) -> Self {
        let (sin_lat, cos_lat) = libm::sincos(lat_deg.to_radians());
        let (sin_lon, cos_lon) = libm::sincos(lon_deg.to_radians());
        let origin = Geodetic { lat_deg, lon_deg, height_m };
        Self { origin, center: to_earth(origin), sin_lat, cos_lat, sin_lon, cos_lon }
    }

    /// The place at x = y = z = 0.
    #[must_use]
    pub fn origin(&self) -> Geodetic {
        self.origin
    }

    /// Whether the log has heights above the sea or the ellipsoid: the origin is not at height 0.
    #[must_use]
    pub fn has_altitude(&self) -> bool {
        self.origin.height_m.abs() > 0.0
    }

    /// The place in the plane (m) of a place on the earth (degrees north and east, metres).
    #[must_use]
    pub fn to_local(&self, lat_deg: f64, lon_deg: f64, height_m: f64) -> Position {
        let place = to_earth(Geodetic { lat_deg, lon_deg, height_m });
        let [dx, dy, dz] = std::array::from_fn(|axis| place[axis] - self.center[axis]);
        let outward = self.cos_lon * dx + self.sin_lon * dy;
        let east = self.cos_lon * dy - self.sin_lon * dx;
        let north = self.cos_lat * dz - self.sin_lat * outward;
        Position::new(east, north, height_m - self.origin.height_m)
    }

    /// Straight distance from the origin to a place on the earth (m).
    #[must_use]
    pub fn distance_m(&self, lat_deg: f64, lon_deg: f64, height_m: f64) -> f64 {
        let place = to_earth(Geodetic { lat_deg, lon_deg, height_m });
        Position::from(place).distance_m(Position::from(self.center))
    }

    /// The place on the earth of a place in the plane. It inverts [`to_local`](Self::to_local).
    #[must_use]
    pub fn to_geodetic(&self, place: Position) -> Geodetic {
        let height_m = self.origin.height_m + place.z_m;
        // The ground falls away from the plane, so the way up to the height is not known before the place is. Each round
        // makes the error smaller by the square of the angle to the origin: 2·10⁻⁴ at 100 km.
        let mut up = place.z_m;
        let mut found = self.origin;
        for _ in 0..4 {
            let outward = self.cos_lat * up - self.sin_lat * place.y_m;
            let [x, y, z] = self.center;
            found = to_geodetic([
                x + self.cos_lon * outward - self.sin_lon * place.x_m,
                y + self.sin_lon * outward + self.cos_lon * place.x_m,
                z + self.sin_lat * up + self.cos_lat * place.y_m,
            ]);
            up += height_m - found.height_m;
        }
        Geodetic { height_m, ..found }
    }
}

/// From latitude, longitude and height to the frame of the earth (m): NIMA TR8350.2 (2000), equation 4-14.
fn to_earth(Geodetic { lat_deg, lon_deg, height_m: h }: Geodetic) -> [f64; 3] {
    let (sin_lat, cos_lat) = libm::sincos(lat_deg.to_radians());
    let (sin_lon, cos_lon) = libm::sincos(lon_deg.to_radians());
    let n = A_M / (1.0 - E2 * sin_lat * sin_lat).sqrt();
    [(n + h) * cos_lat * cos_lon, (n + h) * cos_lat * sin_lon, (n * (1.0 - E2) + h) * sin_lat]
}

/// The inverse of [`to_earth`]: B. R. Bowring, "The accuracy of geodetic latitude and height equations", Survey Review
/// 28 (1985), with a second round from the latitude of the first, which leaves rounding alone.
fn to_geodetic([x, y, z]: [f64; 3]) -> Geodetic {
    let p = libm::hypot(x, y);
    let latitude = |beta: f64| {
        let (sin_beta, cos_beta) = libm::sincos(beta);
        libm::atan2(z + EP2 * B_M * sin_beta.powi(3), p - E2 * A_M * cos_beta.powi(3))
    };
    let first = latitude(libm::atan2(B_M * z * (1.0 + EP2 * B_M / libm::hypot(p, z)), A_M * p));
    let lat = latitude(libm::atan2((1.0 - F) * libm::sin(first), libm::cos(first)));
    let (sin_lat, cos_lat) = libm::sincos(lat);
    let height_m = p * cos_lat + z * sin_lat - A_M * (1.0 - E2 * sin_lat * sin_lat).sqrt();
    Geodetic { lat_deg: lat.to_degrees(), lon_deg: libm::atan2(y, x).to_degrees(), height_m }
}
