//! Pictures: PNG and PGM, as shades of grey.

use std::fs;
use std::io::{BufReader, Cursor};
use std::path::Path;

use super::error::FloorPlanError;

/// Largest number of pixels.
const MOST_PIXELS: usize = 100_000_000;

/// A picture in shades of grey, row by row from the top.
pub(super) struct Picture {
    pub(super) width: usize,
    pub(super) height: usize,
    /// From 0 for black to 255 for white. What is transparent is white.
    pub(super) grey: Vec<u8>,
}

/// Reads the picture `path`.
///
/// # Errors
/// If it cannot be read, or is neither PNG nor PGM.
pub(super) fn read(path: &Path) -> Result<Picture, FloorPlanError> {
    let data = fs::read(path).map_err(|why| FloorPlanError::Read { path: path.to_owned(), why: why.to_string() })?;
    let picture = if data.starts_with(b"\x89PNG") { png(&data) } else { pgm(&data) };
    picture.map_err(|problem| FloorPlanError::Content { path: path.to_owned(), problem })
}

fn check(width: usize, height: usize) -> Result<(), String> {
    match width.checked_mul(height) {
        Some(0) => Err("the image has no pixels".to_owned()),
        Some(pixels) if pixels <= MOST_PIXELS => Ok(()),
        _ => Err(format!("the image has {width} by {height} pixels; allowed: at most {MOST_PIXELS} in all")),
    }
}

fn png(data: &[u8]) -> Result<Picture, String> {
    let mut decoder = png::Decoder::new(BufReader::new(Cursor::new(data)));
    decoder.set_transformations(png::Transformations::EXPAND | png::Transformations::STRIP_16);
    let mut reader = decoder.read_info().map_err(|why| why.to_string())?;
    let (width, height) = (reader.info().width as usize, reader.info().height as usize);
    check(width, height)?;
    let size = reader.output_buffer_size().ok_or("the image is too large")?;
    let mut pixels = vec![0; size];
    let frame = reader.next_frame(&mut pixels).map_err(|why| why.to_string())?;
    let channels = frame.color_type.samples();
    let shade = |pixel: &[u8]| {
        let (colour, alpha) = match *pixel {
            [grey] => (f64::from(grey), 255),
            [grey, alpha] => (f64::from(grey), alpha),
            [red, green, blue] => (luma(red, green, blue), 255),
            [red, green, blue, alpha] => (luma(red, green, blue), alpha),
            _ => (255.0, 255),
        };
        let cover = f64::from(alpha) / 255.0;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 255")]
        let grey = (colour * cover + 255.0 * (1.0 - cover)).round() as u8;
        grey
    };
    let grey = pixels[..frame.buffer_size()].chunks_exact(channels).map(shade).collect();
    Ok(Picture { width, height, grey })
}

/// The brightness of a colour (Rec. 709).
fn luma(red: u8, green: u8, blue: u8) -> f64 {
    0.2126 * f64::from(red) + 0.7152 * f64::from(green) + 0.0722 * f64::from(blue)
}

/// A grey map of Netpbm, in text (P2) or octets (P5).
fn pgm(data: &[u8]) -> Result<Picture, String> {
    let is_text = match data.get(..2) {
        Some(b"P2") => true,
        Some(b"P5") => false,
        _ => return Err("it is neither a PNG nor a PGM (P2, P5)".to_owned()),
    };
    let mut at = 2;
    let mut number = |what: &str| -> Result<usize, String> {
        loop {
            match data.get(at) {
                Some(b'#') => at += data[at..].iter().position(|&octet| octet == b'\n').unwrap_or(data.len() - at),
                Some(octet) if octet.is_ascii_whitespace() => at += 1,
                _ => break,
            }
        }
        let digits = data[at..].iter().take_while(|octet| octet.is_ascii_digit()).count();
        let text = std::str::from_utf8(&data[at..at + digits]).unwrap_or_default();
        at += digits;
        text.parse().map_err(|_| format!("the image ends before its {what}"))
    };
    let (width, height, white) = (number("width")?, number("height")?, number("greatest value")?);
    check(width, height)?;
    if !(1..=65_535).contains(&white) {
        return Err(format!("the greatest value is {white}; allowed: 1 to 65535"));
    }
    #[expect(clippy::cast_possible_truncation, reason = "at most 255")]
    let shade = |value: usize| (value.min(white) * 255 / white) as u8;
    let count = width * height;
    let grey: Vec<u8> = if is_text {
        (0..count).map(|_| number("last pixel").map(shade)).collect::<Result<_, _>>()?
    } else {
        let octets = if white > 255 { 2 } else { 1 };
        let body = data.get(at + 1..at + 1 + count * octets).ok_or("the image ends before its last pixel")?;
        body.chunks_exact(octets)
            .map(|value| shade(value.iter().fold(0, |sum, &octet| sum * 256 + usize::from(octet))))
            .collect()
    };
    Ok(Picture { width, height, grey })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grey_maps_are_read_in_text_and_octets() {
        let text = pgm(b"P2 # two by two\n2 2\n15\n0 15\n7 99\n").unwrap();
        assert_eq!((text.width, text.height, text.grey), (2, 2, vec![0, 255, 119, 255]));
        let octets = pgm(b"P5\n2 1\n255\n\x00\xCD").unwrap();
        assert_eq!(octets.grey, [0, 205]);
        let wide = pgm(b"P5 1 1 65535\n\x80\x00").unwrap();
        assert_eq!(wide.grey, [127]);
        for (data, problem) in [
            (&b"P6 1 1 255\n"[..], "neither a PNG nor a PGM"),
            (b"P5 2 2 255\n\x00", "ends before its last pixel"),
            (b"P2 2 2 255\n0 1", "ends before its last pixel"),
            (b"P2 2", "ends before its height"),
            (b"P5 0 2 255\n", "no pixels"),
            (b"P5 99999 99999 255\n", "at most 100000000"),
        ] {
            let found = pgm(data).err().unwrap();
            assert!(found.contains(problem), "{found}");
        }
    }
}
