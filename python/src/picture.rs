//! Pictures.

use pyo3::PyResult;
use sextant::figure::FileFormat;
use sextant::mapping::{ComputedMap, drawn, figures};

use crate::error::of_file;
use crate::map::Origin;

/// A name, and a picture as SVG.
pub(crate) type Drawn = (String, String);

/// The figures of a map.
pub(crate) fn of_map(origin: &Origin, computed: Option<&ComputedMap<'_>>) -> PyResult<Vec<Drawn>> {
    let Some(computed) = computed else { return Ok(Vec::new()) };
    let world = drawn(&origin.input).map_err(|why| of_file("the recording".as_ref(), why))?;
    let maps = [computed.clone()];
    let figures = figures(&origin.title, &origin.input, world, &maps);
    let svg = |figure: &sextant::figure::Figure| {
        let bytes = figure.encode(FileFormat::Svg).map_err(|why| of_file(figure.name().as_ref(), why))?;
        Ok((figure.name().to_owned(), String::from_utf8_lossy(&bytes).into_owned()))
    };
    figures.iter().map(svg).collect()
}
