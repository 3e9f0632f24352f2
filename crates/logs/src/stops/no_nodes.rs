//! Columns of wide tables that are no nodes, by their names.

/// What robots and scanners write beside strengths, without marks between words.
const NAMES: [&str; 38] = [
    "accuracy",
    "battery",
    "batterylevel",
    "bearing",
    "building",
    "buildingid",
    "course",
    "floor",
    "floorid",
    "floornumber",
    "hdop",
    "heading",
    "humidity",
    "movement",
    "pdop",
    "phoneid",
    "pitch",
    "pressure",
    "relativeposition",
    "roll",
    "satellites",
    "scan",
    "scanid",
    "spaceid",
    "speed",
    "stopid",
    "storey",
    "temp",
    "temperature",
    "userid",
    "vdop",
    "velocity",
    "voltage",
    "vx",
    "vy",
    "vz",
    "weather",
    "yaw",
];

/// Units that may follow such a name.
const UNITS: [&str; 25] = [
    "c", "celsius", "deg", "degc", "degpers", "f", "hpa", "k", "kmh", "kpa", "m", "mbar", "mpers", "mps", "ms", "mv",
    "pa", "pct", "percent", "rad", "radpers", "rh", "v", "volt", "volts",
];

/// Whether a column with this name is no node: `floor`, `Battery Level`, `temperature_c`, `heading_rad`.
pub(super) fn is_no_node(name: &str) -> bool {
    let name = name.to_lowercase();
    let words: Vec<&str> = name.split(|mark: char| !mark.is_alphanumeric()).filter(|word| !word.is_empty()).collect();
    let is_unit = |words: &[&str]| UNITS.contains(&words.concat().as_str());
    (1..=words.len()).any(|end| {
        let (own, unit) = words.split_at(end);
        NAMES.contains(&own.concat().as_str()) && (unit.is_empty() || is_unit(unit))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_with_their_units_are_no_nodes_and_nodes_may_begin_like_them() {
        for name in ["floor", "FLOOR", "Floor-ID", "temperature_c", "speed [m/s]", "Battery Level (%)", "vx_m_per_s"]
        {
            assert!(is_no_node(name), "{name}");
        }
        for name in ["floor_lamp", "ap-3", "AA:BB:CC:DD:EE:0F", "temperature_sensor_2", "kitchen", "#3", "c"] {
            assert!(!is_no_node(name), "{name}");
        }
    }
}
