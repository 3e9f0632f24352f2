//! Converts a picture to SVG or PNG, with the backends of plotters.

use std::fmt::Display;
use std::io;

use plotters::backend::{BitMapBackend, DrawingBackend, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontTransform, ShapeStyle, TextStyle as PlottersText};
use sextant_kernel::text::printable;
use sextant_recording::admission::PICTURE_SOFTWARE;

use super::palette::PAPER;
use super::picture::{Anchor, Mark, Picture, Point, Run, Stroke, font};

/// Units per pixel in an SVG. Coordinates of the backend are integers, so positions are exact to a tenth of a pixel.
const SVG_UNITS: f64 = 10.0;
/// Pixels of a PNG per pixel of the picture: 192 dots per inch.
const PNG_SCALE: u32 = 2;
/// Samples along each side of a PNG pixel, for smooth edges.
const SAMPLES: u32 = 3;

/// The properties of a backend.
#[derive(Clone, Copy)]
struct Manner {
    /// Units of the backend per pixel of the picture.
    units: f64,
    /// Distance from the middle of capital letters down to the middle of a text in the backend (em).
    text_drop_em: f64,
    joints: Joints,
}

/// How the pieces of a path are joined.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Joints {
    /// The backend joins them.
    Backend,
    /// Each piece is drawn by itself, with a disc at each joint. The backend leaves holes where a wide path crosses
    /// itself.
    Discs,
}

/// `picture` as an SVG document.
pub(crate) fn svg(picture: &Picture) -> io::Result<String> {
    let (width, height) = (whole(picture.width), whole(picture.height));
    let (wide, high) = (whole(picture.width * SVG_UNITS), whole(picture.height * SVG_UNITS));
    let mut document = String::new();
    {
        let mut backend = SVGBackend::with_string(&mut document, (wide, high));
        paint(picture, &mut backend, Manner { units: SVG_UNITS, text_drop_em: 0.09, joints: Joints::Backend })?;
    }
    // The backend writes the size in its units, which are tenths of a pixel.
    let size = format!("width=\"{wide}\" height=\"{high}\"");
    let document = document.replacen(&size, &format!("width=\"{width}\" height=\"{height}\""), 1);
    // It also writes what is the default of SVG, in each mark.
    Ok(document.replace(" opacity=\"1\"", "").replace(" stroke=\"none\"", ""))
}

/// `picture` as a PNG file.
pub(crate) fn png(picture: &Picture) -> io::Result<Vec<u8>> {
    let (width, height) = (whole(picture.width) * PNG_SCALE, whole(picture.height) * PNG_SCALE);
    let fine = (width * SAMPLES, height * SAMPLES);
    let mut samples = vec![0; fine.0 as usize * fine.1 as usize * 3];
    {
        let mut backend = BitMapBackend::with_buffer(&mut samples, fine);
        let units = f64::from(PNG_SCALE * SAMPLES);
        paint(picture, &mut backend, Manner { units, text_drop_em: 0.24, joints: Joints::Discs })?;
    }
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.add_text_chunk("Software".to_owned(), PICTURE_SOFTWARE.to_owned())?;
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&averaged(&samples, width, height))?;
    writer.finish()?;
    Ok(file)
}

/// The mean of each block of samples.
fn averaged(samples: &[u8], width: u32, height: u32) -> Vec<u8> {
    let (width, height, side) = (width as usize, height as usize, SAMPLES as usize);
    let mut pixels = Vec::with_capacity(width * height * 3);
    for y in 0..height {
        for x in 0..width {
            for channel in 0..3 {
                let at = |i: usize| ((y * side + i / side) * width * side + x * side + i % side) * 3 + channel;
                let sum: u32 = (0..side * side).map(|i| u32::from(samples[at(i)])).sum();
                let mean = (sum + SAMPLES * SAMPLES / 2) / (SAMPLES * SAMPLES);
                pixels.push(u8::try_from(mean).expect("a mean of octets"));
            }
        }
    }
    pixels
}

fn paint<B: DrawingBackend>(picture: &Picture, backend: &mut B, manner: Manner) -> io::Result<()> {
    let unit = |px: f64| units(px * manner.units);
    let at = |point: Point| (unit(point.x), unit(point.y));
    let (width, height) = backend.get_size();
    let far = (width.cast_signed(), height.cast_signed());
    backend.ensure_prepared().map_err(refused)?;
    backend.draw_rect((0, 0), far, &ShapeStyle::from(PAPER).filled(), true).map_err(refused)?;
    for mark in &picture.marks {
        let drawn = match mark {
            Mark::Path { points, stroke } => {
                let style = ShapeStyle::from(stroke.color).stroke_width(whole(stroke.width * manner.units).max(1));
                let points: Vec<_> = points.iter().copied().map(at).collect();
                if manner.joints == Joints::Discs {
                    draw_jointed(backend, &points, *stroke, style)?;
                    continue;
                }
                backend.draw_path(points, &style)
            }
            Mark::Polygon { points, fill } => {
                backend.fill_polygon(points.iter().copied().map(at).collect::<Vec<_>>(), fill)
            }
            Mark::Rectangle { area, fill } => {
                let corner = at(Point::new(area.right(), area.bottom()));
                backend.draw_rect(at(Point::new(area.left, area.top)), corner, fill, true)
            }
            Mark::Disc { center, radius, fill } => {
                backend.draw_circle(at(*center), whole(radius * manner.units), fill, true)
            }
            Mark::Text { at: place, text, style, anchor, run } => {
                let drop = manner.text_drop_em * style.em;
                let (place, turn) = match run {
                    Run::Across => (Point::new(place.x, place.y + drop), FontTransform::None),
                    Run::Upwards => (Point::new(place.x + drop, place.y), FontTransform::Rotate270),
                };
                let side = match anchor {
                    Anchor::Start => HPos::Left,
                    Anchor::Middle => HPos::Center,
                    Anchor::End => HPos::Right,
                };
                let text_style = PlottersText::from(font(*style, manner.units).transform(turn))
                    .color(&style.color)
                    .pos(Pos::new(side, VPos::Center));
                backend.draw_text(&printable(text), &text_style, at(place))
            }
        };
        drawn.map_err(refused)?;
    }
    backend.present().map_err(refused)
}

fn draw_jointed<B: DrawingBackend>(
    backend: &mut B,
    points: &[(i32, i32)],
    stroke: Stroke,
    style: ShapeStyle,
) -> io::Result<()> {
    for pair in points.windows(2) {
        backend.draw_line(pair[0], pair[1], &style).map_err(refused)?;
    }
    let joints = points.get(1..points.len() - 1).unwrap_or_default();
    joints.iter().try_for_each(|&joint| {
        backend.draw_circle(joint, style.stroke_width / 2, &stroke.color, true).map_err(refused)
    })
}

/// An error of a backend.
fn refused(why: impl Display) -> io::Error {
    io::Error::other(why.to_string())
}

#[expect(clippy::cast_possible_truncation, reason = "pictures are a few thousand units wide")]
fn units(px: f64) -> i32 {
    px.round() as i32
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "sizes are a few thousand units")]
fn whole(px: f64) -> u32 {
    px.round() as u32
}
