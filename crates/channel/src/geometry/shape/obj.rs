//! Reading Wavefront .obj files: vertices, faces and the names of their materials; everything else is skipped.

use std::collections::BTreeMap;

use super::surface::Surface;
use crate::geometry::position::Position;

/// The faces of one material, with the name that `usemtl` gives it; `None` before the first of these.
#[derive(Clone, Debug)]
pub(crate) struct MaterialFaces {
    pub(crate) material: Option<String>,
    pub(crate) surface: Surface,
}

/// The surface in `text`; faces with more than three corners are split into fans of triangles.
///
/// # Errors
/// The first flaw and its line.
pub(crate) fn parse(text: &str) -> Result<Surface, String> {
    let (vertices, parts) = read(text)?;
    let triangles = parts.into_iter().flat_map(|(_, triangles)| triangles).collect();
    Ok(Surface { vertices, triangles })
}

/// The surfaces in `text`, one for each material, in the order in which they are used first.
///
/// # Errors
/// The first flaw and its line.
pub(crate) fn parts(text: &str) -> Result<Vec<MaterialFaces>, String> {
    let (vertices, runs) = read(text)?;
    let mut parts: Vec<(Option<String>, Vec<[u32; 3]>)> = Vec::new();
    for (material, triangles) in runs {
        match parts.iter_mut().find(|(known, _)| *known == material) {
            Some((_, all)) => all.extend(triangles),
            None => parts.push((material, triangles)),
        }
    }
    let part = |(material, triangles): (Option<String>, Vec<[u32; 3]>)| {
        let mut surface = Surface::default();
        let mut own: BTreeMap<u32, u32> = BTreeMap::new();
        for corners in triangles {
            let corners = corners.map(|vertex| {
                *own.entry(vertex).or_insert_with(|| {
                    surface.vertices.push(vertices[vertex as usize]);
                    u32::try_from(surface.vertices.len() - 1).expect("no more vertices than in the file")
                })
            });
            surface.triangles.push(corners);
        }
        MaterialFaces { material, surface }
    };
    Ok(parts.into_iter().filter(|(_, triangles)| !triangles.is_empty()).map(part).collect())
}

/// Triangles of one material, one after the other in a file.
type Run = (Option<String>, Vec<[u32; 3]>);

/// All vertices, and the triangles in their order.
fn read(text: &str) -> Result<(Vec<Position>, Vec<Run>), String> {
    let mut vertices = Vec::new();
    let mut runs: Vec<Run> = vec![(None, Vec::new())];
    for (index, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        let result = match words.next() {
            Some("v") => vertex(words).map(|p| vertices.push(p)),
            Some("f") => face(words, vertices.len()).map(|triangles| {
                runs.iter_mut().last().into_iter().for_each(|(_, run)| run.extend(&triangles));
            }),
            Some("usemtl") => {
                runs.push((Some(words.collect::<Vec<_>>().join(" ")), Vec::new()));
                Ok(())
            }
            _ => Ok(()),
        };
        result.map_err(|flaw| format!("line {}: {flaw}", index + 1))?;
    }
    Ok((vertices, runs))
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
