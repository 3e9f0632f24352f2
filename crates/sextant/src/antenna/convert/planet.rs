//! Patterns in the format of MSI and Planet (`.msi`, `.pln`): a gain, and the losses below it in a horizontal and a vertical
//! cut.

use super::book::{Owner, Rows, TableRow};
use super::gain_unit::GainUnit;
use super::names::{SourceNames, Turning};
use super::{ConvertError, Source};

/// A dipole has this gain over an isotropic antenna (dB).
const DIPOLE_DBI: f64 = 2.15;
/// Cuts whose two sides differ by less are symmetric (dB).
const SAME_DB: f64 = 0.05;

/// Whether a text is such a pattern.
pub(super) fn is_pattern(text: &str) -> bool {
    let begins = |line: &str| {
        let mut words = line.split_whitespace();
        let word = words.next().unwrap_or_default();
        let has_count = words.next().is_some_and(|count| count.parse::<usize>().is_ok());
        word.eq_ignore_ascii_case("horizontal") || word.eq_ignore_ascii_case("vertical") && has_count
    };
    text.lines().map(str::trim).filter(|line| !line.is_empty()).take(60).any(begins)
}

/// A cut: angles (degrees) and losses (dB).
type Cut = Vec<(f64, f64)>;

/// What a file says.
#[derive(Default)]
struct Pattern {
    /// The words after `GAIN` and `TILT`.
    gain: Option<String>,
    tilt: Option<String>,
    /// The half-power widths after `H_WIDTH` and `V_WIDTH` (degrees).
    widths_deg: [Option<f64>; 2],
    horizontal: Cut,
    vertical: Cut,
}

fn invalid(place: String, found: String, allowed: &str) -> ConvertError {
    ConvertError::Invalid { place, found, allowed: allowed.to_owned() }
}

impl Pattern {
    fn read(text: &str) -> Result<Self, ConvertError> {
        let mut pattern = Self::default();
        // The line of the last cut.
        let mut cut_line = None;
        let mut lines = text.lines().enumerate().map(|(i, line)| (i + 1, line.trim()));
        while let Some((number, line)) = lines.next() {
            let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
            let word = word.to_ascii_uppercase();
            if word == "GAIN" {
                pattern.gain = Some(rest.trim().to_owned());
            } else if word == "TILT" {
                pattern.tilt = Some(rest.trim().to_owned()).filter(|words| !words.is_empty());
            } else if word == "H_WIDTH" || word == "V_WIDTH" {
                let width_deg = numbers(rest).first().copied();
                if rest.trim().is_empty() || width_deg.is_some_and(|width_deg| width_deg > 0.0 && width_deg <= 360.0)
                {
                    pattern.widths_deg[usize::from(word == "V_WIDTH")] = width_deg;
                } else {
                    let allowed = "a width above 0, at most 360 degrees";
                    return Err(invalid(format!("line {number}"), format!("`{line}`"), allowed));
                }
            } else if word == "HORIZONTAL" || word == "VERTICAL" {
                let count = rest.trim().parse::<usize>().ok().filter(|count| (1..=3600).contains(count));
                let place = || format!("line {number}");
                let allowed = "the number of its angles, 1 to 3600";
                let count = count.ok_or_else(|| invalid(place(), format!("`{line}`"), allowed))?;
                let cut = lines.by_ref().take(count).map(|(number, line)| row(number, line));
                let cut = cut.collect::<Result<Cut, ConvertError>>()?;
                if cut.len() < count {
                    return Err(invalid(
                        place(),
                        format!("{} of {count} angles", cut.len()),
                        "a line for each angle",
                    ));
                }
                if word == "HORIZONTAL" {
                    pattern.horizontal = cut
                } else {
                    pattern.vertical = cut
                }
                cut_line = Some(line);
            } else if let Some(cut_line) = cut_line.filter(|_| !numbers(line).is_empty()) {
                let found = format!("`{line}`, more angles than `{cut_line}` says");
                return Err(invalid(format!("line {number}"), found, "the number of angles before them"));
            }
        }
        Ok(pattern)
    }

    /// The gain (dBi), and what was taken for it.
    fn gain_dbi(&self) -> Result<(f64, &'static str), ConvertError> {
        let missing = || ConvertError::Missing {
            what: "gain",
            found: "no line `GAIN`".to_owned(),
            allowed: "a line like `GAIN 15.5 dBi`".to_owned(),
        };
        let text = self.gain.as_deref().ok_or_else(missing)?;
        let lower = text.to_ascii_lowercase();
        let (value, over, note) = if let Some(value) = lower.strip_suffix("dbi") {
            (value, 0.0, "dBi")
        } else if let Some(value) = lower.strip_suffix("dbd") {
            (value, DIPOLE_DBI, "dBd: 2.15 dB were added")
        } else {
            (lower.as_str(), DIPOLE_DBI, "dBd, as the format says of gains without a unit: 2.15 dB were added")
        };
        let value = value.trim().parse().ok().filter(|value: &f64| value.is_finite());
        let value = value.ok_or_else(|| {
            invalid("the line `GAIN`".to_owned(), format!("`{text}`"), "a number, and `dBi` or `dBd`")
        })?;
        Ok((value + over, note))
    }
}

/// The finite numbers with which a line begins.
fn numbers(line: &str) -> Vec<f64> {
    let number = |word: &str| word.parse().ok().filter(|number: &f64| number.is_finite());
    line.split_whitespace().map_while(number).collect()
}

/// An angle and a loss.
fn row(number: usize, line: &str) -> Result<(f64, f64), ConvertError> {
    match numbers(line)[..] {
        // Some programs write losses with a sign.
        [angle, loss] => Ok((angle, loss.abs())),
        _ => Err(invalid(format!("line {number}"), format!("`{line}`"), "an angle and a loss in dB")),
    }
}

/// Whether a cut is the same on both sides of its angle 0.
fn is_symmetric(cut: &Cut) -> bool {
    let at = |angle: f64| {
        let apart = |known: f64| (known - angle).rem_euclid(360.0).min((angle - known).rem_euclid(360.0));
        cut.iter().find(|(known, _)| apart(*known) < 1e-6).map(|(_, loss)| *loss)
    };
    cut.iter().all(|&(angle, loss)| at(-angle).is_none_or(|other| (other - loss).abs() < SAME_DB))
}

/// Width of the part of a cut round its least loss that is at most 3 dB below it (degrees), its ends between two angles by a straight
/// line; `None` if the cut does not have both of them.
fn half_power_deg(cut: &Cut) -> Option<f64> {
    let mut cut = cut.clone();
    cut.sort_by(|a, b| a.0.total_cmp(&b.0));
    let span_deg = cut.last()?.0 - cut.first()?.0;
    let step_deg = span_deg / (cut.len() - 1).max(1) as f64;
    if span_deg + 1.5 * step_deg >= 360.0 {
        // Once around, it begins and ends at its weakest angle: no beam is cut there.
        if span_deg >= 360.0 {
            cut.pop();
        }
        let weakest = (0..cut.len()).max_by(|&a, &b| cut[a].1.total_cmp(&cut[b].1))?;
        cut[..weakest].iter_mut().for_each(|(angle, _)| *angle += 360.0);
        cut.rotate_left(weakest);
        cut.push((cut[0].0 + 360.0, cut[0].1));
    }
    let strongest = (0..cut.len()).min_by(|&a, &b| cut[a].1.total_cmp(&cut[b].1))?;
    let half = cut[strongest].1 + 3.0;
    let is_weak = |(_, loss): &(f64, f64)| *loss > half;
    let before = cut[..strongest].iter().rposition(is_weak)?;
    let after = strongest + cut[strongest..].iter().position(is_weak)?;
    let end = |(strong, weak): ((f64, f64), (f64, f64))| {
        strong.0 + (weak.0 - strong.0) * (half - strong.1) / (weak.1 - strong.1)
    };
    Some(end((cut[after - 1], cut[after])) - end((cut[before + 1], cut[before])))
}

/// The angle of the least loss of a cut, if it is not 0 (degrees, -180 to 180).
fn tilt_deg(cut: &Cut) -> Option<f64> {
    let least = cut.iter().map(|(_, loss)| *loss).fold(f64::INFINITY, f64::min);
    let angles = cut.iter().filter(|(_, loss)| *loss <= least).map(|(angle, _)| {
        let angle = angle.rem_euclid(360.0);
        if angle > 180.0 { angle - 360.0 } else { angle }
    });
    angles.min_by(|a, b| a.abs().total_cmp(&b.abs())).filter(|angle| *angle != 0.0)
}

/// What the two cuts say of widths and of the tilt.
fn notes_of_cuts(pattern: &Pattern) -> Vec<String> {
    let mut notes = Vec::new();
    let cuts = [("horizontal", "H_WIDTH", &pattern.horizontal), ("vertical", "V_WIDTH", &pattern.vertical)];
    for ((name, key, cut), stated) in cuts.into_iter().zip(pattern.widths_deg) {
        match (half_power_deg(cut), stated) {
            (Some(found), Some(stated)) if (found - stated).abs() > (0.1 * stated).max(1.0) => notes.push(format!(
                "the half-power width of the {name} cut is {found:.1} degrees, and `{key}` says {stated}: the cut counts"
            )),
            (Some(_), _) | (None, None) => {}
            (None, Some(stated)) => notes.push(format!("`{key}` says {stated} degrees, and the {name} cut does not show it")),
        }
    }
    if let Some(width_deg) = half_power_deg(&pattern.vertical).or(pattern.widths_deg[1]) {
        notes.push(format!(
            "the vertical cut is not in the code book: its half-power width is {width_deg:.1} degrees, `vertical_width_deg` in a \
             scenario"
        ));
    }
    let says = pattern.tilt.as_ref().map(|words| format!(" (`TILT {words}`)")).unwrap_or_default();
    if let Some(tilt_deg) = tilt_deg(&pattern.vertical) {
        notes.push(format!(
            "the vertical cut is strongest at {tilt_deg} degrees{says}: the sector has that gain at elevation 0; tilt the antenna of \
             the scenario"
        ));
    }
    notes
}

/// The horizontal cut of a pattern, as sector 0.
///
/// # Errors
/// If something is missing or no number, or nothing says which way azimuths turn and that matters.
pub(super) fn rows(text: &str, names: &SourceNames) -> Result<Source, ConvertError> {
    let pattern = Pattern::read(text)?;
    let (gain_dbi, unit) = pattern.gain_dbi()?;
    let turning = match names.turning {
        Some(turning) => turning,
        None if is_symmetric(&pattern.horizontal) => Turning::Counterclockwise,
        None => return Err(ConvertError::UnknownTurning),
    };
    let row = |&(angle, loss): &(f64, f64)| {
        let azimuth_deg = if turning == Turning::Clockwise { -angle } else { angle };
        TableRow { owner: Owner::Sector(0), azimuth_deg, elevation_deg: 0.0, gain: gain_dbi - loss }
    };
    let rows = pattern.horizontal.iter().map(row).collect();
    let mut notes = vec![
        format!("a pattern of MSI and Planet: the gain is in {unit}; losses of the horizontal cut are below it"),
        "the horizontal cut is sector 0, a planar cut at elevation 0".to_owned(),
    ];
    notes.extend(notes_of_cuts(&pattern));
    Ok(Source { rows: Rows(rows), named_unit: Some(GainUnit::Dbi), gains: "gain".to_owned(), notes })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cut with a beam of 11 degrees at each of these angles, the first of which is the strongest.
    fn cut(angles: impl Iterator<Item = i32>, beams: &[i32]) -> Cut {
        let loss = |angle: i32| {
            let apart = |beam: i32| (angle - beam).rem_euclid(360).min((beam - angle).rem_euclid(360));
            let at = beams.iter().position(|&beam| apart(beam) <= 5);
            at.map_or(20.0, |at| if at == 0 { 0.0 } else { 1.0 })
        };
        angles.map(|angle| (f64::from(angle), loss(angle))).collect()
    }

    #[test]
    fn a_half_power_width_is_that_of_the_strongest_beam_alone() {
        let width = |cut: &Cut| half_power_deg(cut).map(|width_deg| (width_deg * 10.0).round() / 10.0);
        // Once around, with the end of the beam beyond the last angle, and a second beam behind.
        assert_eq!(width(&cut(0..360, &[0, 180])), Some(10.3));
        assert_eq!(width(&cut(-180..=180, &[180, 0])), Some(10.3));
        // Half around.
        assert_eq!(width(&cut(-90..=90, &[0])), Some(10.3));
        assert_eq!(width(&cut((-90..=90).rev(), &[30, -30])), Some(10.3));
        // A parabola with a width of 6.5 degrees, in steps of one and of two.
        for step in [1, 2] {
            let parabola =
                (-90..=90).step_by(step).map(|angle| (f64::from(angle), 3.0 * (f64::from(angle) / 3.25).powi(2)));
            assert!((half_power_deg(&parabola.collect()).unwrap() - 6.5).abs() < 0.35, "{step}");
        }
        // One end is not there, or there is none.
        assert_eq!(width(&cut(0..=90, &[0])), None);
        assert_eq!(width(&vec![(0.0, 1.0), (90.0, 1.0), (180.0, 1.5), (270.0, 1.0)]), None);
        assert_eq!((width(&vec![(0.0, 1.0)]), width(&Vec::new())), (None, None));
    }
}
