//! The reference system that a GeoJSON file from before RFC 7946 names in its member `crs`: what its coordinates are.

use serde_json::Value;

/// What coordinates are by their reference system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Coordinates {
    /// Longitude and latitude, at most a few metres from those of WGS 84.
    Degrees,
    /// Metres on the ground.
    Metres,
    /// Metres of the Mercator projection, longer than those on the ground by one over the cosine of the latitude.
    Mercator,
    /// Not known: feet perhaps, or degrees of an old survey.
    Unknown,
}

/// Names that are no codes of EPSG.
const DEGREES: [&str; 5] = ["CRS84", "CRS84H", "CRS83", "WGS84", "WGS 84"];

/// Codes of EPSG with longitude and latitude: WGS 84, ETRS89 and the systems of countries that agree with them within a few metres.
/// Those of older surveys are off by up to hundreds of metres and are not among them.
const EPSG_DEGREES: [u32; 29] = [
    4326, 4979, 4258, 4937, // WGS 84, ETRS89
    4269, 4152, 4617, 4759, 6318, 6319, 6783, // North America
    4674, 4170, 5527, // South America
    4283, 7844, 4167, // Australia, New Zealand
    4490, 4612, 6668, 4737, 4148, // China, Japan, Korea, South Africa
    4171, 4619, 4765, 4670, 4661, 4669, 4180, // parts of Europe
];

/// Codes of EPSG of plane systems in metres that are true on the ground within a few tenths of a percent, from and to.
const EPSG_METRES: [[u32; 2]; 62] = [
    [32601, 32660], // UTM over WGS 84, north and south
    [32701, 32760],
    [25828, 25838], // UTM over ETRS89
    [26901, 26923], // UTM over NAD83, NAD27
    [26701, 26722],
    [23028, 23038], // UTM over ED50
    [31965, 31985], // UTM over SIRGAS 2000
    [2955, 2962],   // UTM over NAD83(CSRS)
    [3154, 3160],
    [6328, 6348],   // UTM over NAD83(2011)
    [28348, 28358], // Australia
    [7846, 7859],
    [2193, 2193], // New Zealand
    [2056, 2056], // Switzerland
    [21781, 21781],
    [2154, 2154], // France
    [3942, 3950],
    [27700, 27700], // United Kingdom
    [2157, 2157],   // Ireland
    [29902, 29903],
    [28991, 28992], // Netherlands
    [31370, 31370], // Belgium
    [3812, 3812],
    [2169, 2169],   // Luxembourg
    [31466, 31469], // Germany
    [4647, 4647],
    [5649, 5653],
    [31254, 31259], // Austria
    [31287, 31287],
    [3416, 3416],
    [5514, 5514],   // Czechia, Slovakia
    [2176, 2180],   // Poland
    [23700, 23700], // Hungary
    [3765, 3765],   // Croatia
    [3794, 3794],   // Slovenia
    [3844, 3844],   // Romania
    [7801, 7801],   // Bulgaria
    [2100, 2100],   // Greece
    [3003, 3004],   // Italy
    [6707, 6709],
    [3763, 3763], // Portugal
    [3006, 3018], // Sweden
    [3021, 3021],
    [3067, 3067], // Finland
    [3873, 3885],
    [5105, 5130],   // Norway
    [4093, 4096],   // Denmark
    [3057, 3057],   // Iceland
    [3059, 3059],   // Latvia
    [3301, 3301],   // Estonia
    [3346, 3346],   // Lithuania
    [28402, 28432], // Gauss-Krueger of 1942
    [5253, 5259],   // Turkey
    [2039, 2039],   // Israel
    [2443, 2461],   // Japan
    [6669, 6687],
    [4491, 4554], // China
    [2326, 2326], // Hong Kong
    [5179, 5188], // Korea
    [3414, 3414], // Singapore
    [2046, 2055], // South Africa
    [3825, 3826], // Taiwan
];

/// Codes of the Mercator projection of the whole earth, also those from before it had one of EPSG.
const MERCATOR: [u32; 6] = [3857, 3395, 3785, 900_913, 102_100, 102_113];

/// A reference system by name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ReferenceSystem {
    /// As the file writes it.
    pub(super) name: String,
    /// What coordinates it has.
    pub(super) coordinates: Coordinates,
}

impl ReferenceSystem {
    /// That of the file, if it names one.
    pub(super) fn of(root: &Value) -> Option<Self> {
        let system = root.get("crs").filter(|system| !system.is_null())?;
        let properties = &system["properties"];
        let code = properties["code"].as_u64().map(|code| format!("EPSG:{code}"));
        let name = properties["name"].as_str().map(str::to_owned).or(code);
        let name = name.unwrap_or_else(|| system.to_string());
        let coordinates = coordinates(&name);
        Some(Self { name, coordinates })
    }

    /// Why its coordinates are not taken, and what to do.
    pub(super) fn refusal(&self) -> String {
        let why = if self.coordinates == Coordinates::Mercator {
            "whose metres are stretched by one over the cosine of the latitude"
        } else {
            "which is not known to be in metres or in degrees of WGS 84"
        };
        format!(
            "its reference system is {}, {why}; reproject it to EPSG:4326 or to a projected system in metres, such as that of a UTM zone",
            self.name
        )
    }
}

/// What a system of this name has: `EPSG:25832`, `urn:ogc:def:crs:OGC:1.3:CRS84`, `http://www.opengis.net/def/crs/EPSG/0/4326`.
fn coordinates(name: &str) -> Coordinates {
    let upper = name.trim().to_uppercase();
    let last = upper.rsplit([':', '/', '#']).next().unwrap_or_default();
    if DEGREES.contains(&last) {
        return Coordinates::Degrees;
    }
    let Ok(code) = last.parse::<u32>() else { return Coordinates::Unknown };
    if MERCATOR.contains(&code) {
        return Coordinates::Mercator;
    }
    if !upper.contains("EPSG") {
        return Coordinates::Unknown;
    }
    if EPSG_DEGREES.contains(&code) {
        Coordinates::Degrees
    } else if EPSG_METRES.iter().any(|[from, to]| (from..=to).contains(&&code)) {
        Coordinates::Metres
    } else {
        Coordinates::Unknown
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_say_degrees_metres_or_neither() {
        for (name, expected) in [
            ("urn:ogc:def:crs:OGC:1.3:CRS84", Coordinates::Degrees),
            ("urn:ogc:def:crs:OGC::CRS83", Coordinates::Degrees),
            ("urn:ogc:def:crs:EPSG::4258", Coordinates::Degrees),
            ("EPSG:4269", Coordinates::Degrees),
            ("http://www.opengis.net/def/crs/EPSG/0/4326", Coordinates::Degrees),
            ("http://www.opengis.net/gml/srs/epsg.xml#4326", Coordinates::Degrees),
            ("urn:ogc:def:crs:EPSG::32633", Coordinates::Metres),
            ("epsg:25832", Coordinates::Metres),
            ("EPSG:2056", Coordinates::Metres),
            ("EPSG:3857", Coordinates::Mercator),
            ("EPSG:900913", Coordinates::Mercator),
            // Feet, degrees of an old survey, another authority with a number that EPSG has too, and words.
            ("urn:ogc:def:crs:EPSG::2263", Coordinates::Unknown),
            ("EPSG:4267", Coordinates::Unknown),
            ("ESRI:4326", Coordinates::Unknown),
            ("EPSG:14326", Coordinates::Unknown),
            ("floor", Coordinates::Unknown),
        ] {
            assert_eq!(coordinates(name), expected, "{name}");
        }
        let old = serde_json::json!({"crs": {"type": "EPSG", "properties": {"code": 2263}}});
        assert_eq!(ReferenceSystem::of(&old).unwrap().name, "EPSG:2263");
        assert_eq!(ReferenceSystem::of(&serde_json::json!({"crs": null})), None);
        let linked = serde_json::json!({"crs": {"type": "link", "properties": {"href": "a.prj"}}});
        let linked = ReferenceSystem::of(&linked).unwrap();
        assert!(linked.coordinates == Coordinates::Unknown && linked.refusal().contains("a.prj"), "{linked:?}");
    }
}
