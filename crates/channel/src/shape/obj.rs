//! Reading Wavefront .obj files: vertices and faces; everything else is skipped.

use super::surface::Surface;
use crate::Position;

/// The surface in `text`; faces with more than three corners are split into fans of triangles.
///
/// # Errors
/// The first flaw and its line.
pub(crate) fn parse(text: &str) -> Result<Surface, String> {
    let mut surface = Surface::default();
    for (index, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        let result = match words.next() {
            Some("v") => vertex(words).map(|p| surface.vertices.push(p)),
            Some("f") => face(words, surface.vertices.len()).map(|triangles| surface.triangles.extend(triangles)),
            _ => Ok(()),
        };
        result.map_err(|flaw| format!("line {}: {flaw}", index + 1))?;
    }
    Ok(surface)
}

fn vertex<'a>(words: impl Iterator<Item = &'a str>) -> Result<Position, String> {
    let mut coordinates = [0.0; 3];
    let mut words = words;
    for coordinate in &mut coordinates {
        let word = words.next().ok_or("a vertex with fewer than three coordinates")?;
        *coordinate = word.parse().map_err(|_| format!("`{word}` is not a number"))?;
    }
    Ok(coordinates.into())
}

fn face<'a>(words: impl Iterator<Item = &'a str>, vertices: usize) -> Result<Vec<[u32; 3]>, String> {
    let corners = words.map(|word| corner(word, vertices)).collect::<Result<Vec<_>, _>>()?;
    if corners.len() < 3 {
        return Err(format!("a face with {} corners; allowed: three or more", corners.len()));
    }
    Ok(corners[1..].windows(2).map(|pair| [corners[0], pair[0], pair[1]]).collect())
}

/// One corner `vertex[/texture[/normal]]`: counted from 1, or backwards from the last vertex if negative.
fn corner(word: &str, vertices: usize) -> Result<u32, String> {
    let number = word.split('/').next().unwrap_or_default();
    let number: i64 = number.parse().map_err(|_| format!("`{word}` is not a corner of a face"))?;
    let count = i64::try_from(vertices).map_err(|_| "too many vertices".to_owned())?;
    let index = if number < 0 { count.checked_add(number) } else { number.checked_sub(1) };
    match index {
        Some(index) if (0..count).contains(&index) => {
            u32::try_from(index).map_err(|_| "too many vertices".to_owned())
        }
        _ => Err(format!("corner `{word}` refers to a missing vertex; {vertices} are defined so far")),
    }
}
