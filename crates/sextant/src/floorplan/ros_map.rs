//! Maps of robots as ROS saves them: `map.yaml` beside an image.

use std::fs;
use std::path::{Path, PathBuf};

use super::FloorPlanOptions;
use super::error::FloorPlanError;
use super::image::Picture;
use super::occupancy::{Occupancy, share};

/// What `map.yaml` says.
#[derive(Debug)]
pub(super) struct RosMap {
    pub(super) image: PathBuf,
    resolution_m: f64,
    /// Where the lower left corner is, and how the map is turned (rad).
    origin: [f64; 3],
    mode: Mode,
    occupied: f64,
}

/// How a shade says whether a cell is occupied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    /// The darker, the likelier (`trinary` and `scale`, which differ in free cells alone).
    Dark,
    /// The lighter, the likelier.
    Light,
    /// The value is the occupancy in percent, and what is above 100 is unknown, whatever `negate` says (`raw`; ROS 2, package
    /// `nav2_map_server`, `map_io.cpp`).
    Percent,
}

/// The greatest turn of a map that is in radians.
const MOST_YAW_RAD: f64 = std::f64::consts::TAU;

/// Reads `map.yaml`: keys `image`, `resolution`, `origin`, `negate`, `mode`, `occupied_thresh`.
///
/// # Errors
/// If it cannot be read, or a key is missing or invalid.
pub(super) fn read(path: &Path) -> Result<RosMap, FloorPlanError> {
    let text = fs::read_to_string(path)
        .map_err(|why| FloorPlanError::Read { path: path.to_owned(), why: why.to_string() })?;
    parse(&text, path.parent().unwrap_or(Path::new("")))
        .map_err(|problem| FloorPlanError::Content { path: path.to_owned(), problem })
}

fn parse(text: &str, folder: &Path) -> Result<RosMap, String> {
    let value = |key: &str| value(text, key);
    let required = |key: &str| value(key).ok_or_else(|| format!("the key `{key}` is missing"));
    let number = |key: &str, text: &str| -> Result<f64, String> {
        let number = text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
        number.ok_or_else(|| format!("`{key}` is `{text}`; allowed: a number"))
    };
    let resolution_m = number("resolution", &required("resolution")?)?;
    if !(resolution_m > 0.0 && resolution_m <= 100.0) {
        return Err(format!("`resolution` is {resolution_m}; allowed: metres a pixel above 0, at most 100"));
    }
    let origin = value("origin").unwrap_or_else(|| "[0, 0, 0]".to_owned());
    let numbers = origin.trim_start_matches('[').trim_end_matches(']').split(',');
    let numbers: Vec<f64> = numbers.map(|text| number("origin", text)).collect::<Result<_, _>>()?;
    let origin = match *numbers.as_slice() {
        [x_m, y_m] => [x_m, y_m, 0.0],
        [x_m, y_m, yaw_rad] => [x_m, y_m, yaw_rad],
        _ => return Err(format!("`origin` is {origin}; allowed: a list of x, y, yaw")),
    };
    if origin[2].abs() > MOST_YAW_RAD {
        return Err(format!("`origin` has a yaw of {}; allowed: -6.283 to 6.283 radians", origin[2]));
    }
    let negate = match value("negate").as_deref() {
        None | Some("0" | "false") => false,
        Some("1" | "true") => true,
        Some(other) => return Err(format!("`negate` is `{other}`; allowed: 0 or 1")),
    };
    let mode = match value("mode").as_deref() {
        None | Some("trinary" | "scale") if negate => Mode::Light,
        None | Some("trinary" | "scale") => Mode::Dark,
        Some("raw") => Mode::Percent,
        Some(other) => return Err(format!("`mode` is `{other}`; allowed: trinary, scale, raw")),
    };
    let occupied = value("occupied_thresh").map(|text| number("occupied_thresh", &text)).transpose()?;
    let occupied = occupied.unwrap_or(0.65);
    if !(0.0..=1.0).contains(&occupied) {
        return Err(format!("`occupied_thresh` is {occupied}; allowed: 0 to 1"));
    }
    let image = folder.join(required("image")?);
    Ok(RosMap { image, resolution_m, origin, mode, occupied })
}

/// The value of a key of `text`: on its line, or a list that goes on in the next ones. It is as on one line then, `[1,2]`.
fn value(text: &str, key: &str) -> Option<String> {
    let mut lines = text.lines().map(|line| line.split(" #").next().unwrap_or_default().trim());
    let first =
        lines.by_ref().find_map(|line| line.split_once(':').filter(|(found, _)| found.trim() == key))?.1.trim();
    if first.is_empty() {
        let is_left_out = |line: &&str| line.is_empty() || line.starts_with('#');
        let items: Vec<&str> = lines.skip_while(is_left_out).map_while(|line| line.strip_prefix('-')).collect();
        let items: Vec<&str> = items.into_iter().map(str::trim).collect();
        return Some(if items.is_empty() { String::new() } else { format!("[{}]", items.join(",")) });
    }
    let mut value = first.to_owned();
    while value.starts_with('[') && !value.ends_with(']') {
        let Some(next) = lines.next() else { break };
        value += next;
    }
    Some(value.trim_matches(['"', '\'']).to_owned())
}

impl RosMap {
    /// What options replace of what the map says, for the user.
    pub(super) fn replaced(&self, options: &FloorPlanOptions) -> Vec<String> {
        let scale = options.metres_per_pixel.filter(|scale_m| scale_m.to_bits() != self.resolution_m.to_bits());
        let scale = scale.map(|scale_m| {
            format!(
                "`resolution` of the map is {}; option `scale` replaces it by {scale_m} m a pixel",
                self.resolution_m
            )
        });
        let [x_m, y_m, _] = self.origin;
        let is_other = |place: &[f64; 2]| place.map(f64::to_bits) != [x_m, y_m].map(f64::to_bits);
        let origin = options.origin_m.filter(is_other).map(|[x, y]| {
            format!("`origin` of the map is at ({x_m}, {y_m}) m; option `origin` replaces it by ({x}, {y}) m")
        });
        scale.into_iter().chain(origin).collect()
    }

    /// Which cells of its image are occupied. Cells that are unknown are free.
    pub(super) fn occupancy(&self, picture: &Picture) -> Occupancy {
        let occupancy = |&grey: &u8| {
            let grey = f64::from(grey);
            match self.mode {
                Mode::Dark => (255.0 - grey) / 255.0,
                Mode::Light => grey / 255.0,
                Mode::Percent => (grey / 100.0).min(1.0) * f64::from(u8::from(grey <= 100.0)),
            }
        };
        let cells = picture.grey.iter().map(|grey| occupancy(grey) > self.occupied).collect();
        let near = 0.75 * self.occupied;
        let nearly =
            picture.grey.iter().map(occupancy).filter(|share| *share > near && *share <= self.occupied).count();
        Occupancy {
            width: picture.width,
            height: picture.height,
            cells,
            rule: format!(
                "what is occupied by more than `occupied_thresh`, {:.0} %, is a wall; {:.1} % of the pixels are at {:.0} % to \
                 that",
                100.0 * self.occupied,
                share(nearly, picture.grey.len()),
                100.0 * near
            ),
            pixel_m: self.resolution_m,
            origin_m: [self.origin[0], self.origin[1]],
            turn_rad: self.origin[2],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_says_where_its_image_lies() {
        let text = "image: floor.pgm\nmode: trinary\nresolution: 0.05 # m\norigin: [-3.5, 2, 0.1]\nnegate: 0\noccupied_thresh: 0.7\n";
        let map = parse(text, Path::new("/maps")).unwrap();
        assert_eq!(map.image, Path::new("/maps/floor.pgm"));
        assert_eq!((map.resolution_m, map.origin, map.mode, map.occupied), (0.05, [-3.5, 2.0, 0.1], Mode::Dark, 0.7));
        let given = |scale_m, origin_m| {
            map.replaced(&FloorPlanOptions { metres_per_pixel: scale_m, origin_m, ..FloorPlanOptions::default() })
        };
        assert_eq!(given(Some(0.05), Some([-3.5, 2.0])), [""; 0]);
        let replaced = given(Some(0.02), Some([0.0, 2.0]));
        assert!(replaced[0].contains("is 0.05; option `scale` replaces it by 0.02 m"), "{replaced:?}");
        assert!(replaced[1].contains("at (-3.5, 2) m; option `origin` replaces it by (0, 2) m"), "{replaced:?}");
        let nearly = map.occupancy(&Picture { width: 4, height: 1, grey: vec![90, 150, 205, 254] });
        assert!(
            nearly.rule.contains("`occupied_thresh`, 70 %, is a wall; 25.0 % of the pixels are at 52 %"),
            "{}",
            nearly.rule
        );
        let picture = Picture { width: 3, height: 1, grey: vec![0, 205, 254] };
        assert_eq!(map.occupancy(&picture).cells, [true, false, false]);
        let of_mode = |line: &str, grey: Vec<u8>| {
            let map = parse(&format!("image: a.pgm\nresolution: 1\n{line}"), Path::new("")).unwrap();
            map.occupancy(&Picture { width: grey.len(), height: 1, grey }).cells
        };
        let shades = || vec![0, 64, 66, 100, 101, 205, 255];
        let is = |walls: [u8; 7]| walls.map(|wall| wall == 1).to_vec();
        assert_eq!(of_mode("", shades()), is([1, 1, 1, 0, 0, 0, 0]));
        assert_eq!(of_mode("mode: scale\nnegate: 1\n", shades()), is([0, 0, 0, 0, 0, 1, 1]));
        // Percent: 65 and less is below the threshold, above 100 is unknown. It is never negated.
        assert_eq!(of_mode("mode: raw\n", shades()), is([0, 0, 1, 1, 0, 0, 0]));
        assert_eq!(of_mode("mode: raw\nnegate: 1\n", shades()), is([0, 0, 1, 1, 0, 0, 0]));
        for origin in
            ["\n- -2.0\n- 1 # m\n- 0.5", "  # corner\n  - -2.0\n\t- 1.0\n  - 0.5", " [-2.0,\n  1.0, # m\n  0.5]"]
        {
            let text = format!("image: a.pgm\norigin:{origin}\nresolution: 1\n");
            let found = parse(&text, Path::new("")).unwrap().origin;
            assert_eq!(format!("{found:?}"), "[-2.0, 1.0, 0.5]", "{origin}");
        }
        for (text, problem) in [
            ("image: a.pgm\nresolution: 1\noccupied_thresh: 1.65\n", "`occupied_thresh` is 1.65; allowed: 0 to 1"),
            ("image: a.pgm\nresolution: 1\nmode: cooked\n", "`mode` is `cooked`; allowed: trinary, scale, raw"),
            ("image: a.pgm\nresolution: 1\norigin: [0, 0, 90]\n", "a yaw of 90; allowed: -6.283 to 6.283 radians"),
            ("resolution: 0.05\n", "`image` is missing"),
            ("image: a.pgm\n", "`resolution` is missing"),
            ("image: a.pgm\nresolution: fine\n", "`resolution` is `fine`"),
            ("image: a.pgm\nresolution: 0\n", "`resolution` is 0"),
            ("image: a.pgm\nresolution: 1\norigin: [1]\n", "`origin` is [1]"),
            ("image: a.pgm\nresolution: 1\nnegate: maybe\n", "`negate` is `maybe`"),
        ] {
            let found = parse(text, Path::new("")).unwrap_err();
            assert!(found.contains(problem), "{found}");
        }
    }
}
