//! Pictures before they are coloured: which value each pixel shows and how the light falls on it.
//!
//! Pictures of a series are drawn long before the largest value of the series is known. A PNG file of a series without a
//! range of its own therefore carries these numbers in a chunk that other programs skip, and is coloured anew in the end.

use super::palette::{Background, ColourMap};
use super::sheet::{Sheet, share};
use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;
use std::io::{Read, Write};

/// Name of the chunk: ancillary, private, not to be copied by who changes pixels.
pub(super) const CHUNK: [u8; 4] = *b"tdVS";

/// Shades of values between their smallest and largest; the last one is that of what is not a number.
const LEVELS: f64 = 65_534.0;
const NOT_A_NUMBER: u16 = u16::MAX;

/// How brightness between 0 and 1.14 becomes a byte.
const BRIGHT: f32 = 200.0;

/// Values and light of pixels.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Shaded {
    pub(super) columns: usize,
    pub(super) rows: usize,
    pub(super) pixels: Vec<Pixel>,
    /// Values at the two ends of the shades.
    pub(super) extent: [f64; 2],
}

/// A pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Pixel {
    /// Shade of the nearest sphere in it.
    pub(super) value: u16,
    /// Mean brightness of its spheres.
    pub(super) bright: u8,
    /// Mean highlight on its spheres.
    pub(super) gloss: u8,
    /// The part that spheres cover.
    pub(super) cover: u8,
    /// The part that lines cover.
    pub(super) line: u8,
}

/// A part of 1 as a byte.
pub(super) fn byte(share: f32) -> u8 {
    (share.clamp(0.0, 1.0) * 255.0).round() as u8
}

/// Brightness as a byte.
pub(super) fn brightness(bright: f32) -> u8 {
    (bright * BRIGHT).round().clamp(0.0, 255.0) as u8
}

/// The shade of a value between two others.
pub(super) fn shade(value: f64, [low, high]: [f64; 2]) -> u16 {
    if value.is_nan() {
        return NOT_A_NUMBER;
    }
    let span = if high > low { high - low } else { 1.0 };
    (((value - low) / span).clamp(0.0, 1.0) * LEVELS).round() as u16
}

impl Shaded {
    /// Colours the picture into the left part of a sheet, with colours that go from one value to another.
    pub(super) fn paint(&self, sheet: &mut Sheet, map: ColourMap, background: Background, range: [f64; 2]) {
        let line = share(background.line());
        let [from, to] = self.extent;
        let span = if to > from { to - from } else { 0.0 };
        for (place, pixel) in self.pixels.iter().enumerate() {
            let (column, row) = (place % self.columns, place / self.columns);
            if pixel.cover > 0 {
                let value =
                    if pixel.value == NOT_A_NUMBER { f64::NAN } else { from + f64::from(pixel.value) / LEVELS * span };
                let colour = map.colour(part(value, range));
                let (bright, gloss) = (f32::from(pixel.bright) / BRIGHT, f32::from(pixel.gloss) / 255.0);
                let lit = colour.map(|channel| (channel * bright + gloss).clamp(0.0, 1.0));
                sheet.blend(column, row, lit, f32::from(pixel.cover) / 255.0);
            }
            sheet.blend(column, row, line, f32::from(pixel.line) / 255.0);
        }
    }

    /// The numbers as bytes.
    pub(super) fn pack(&self) -> std::io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        for size in [self.columns, self.rows] {
            bytes.extend((size as u32).to_le_bytes());
        }
        for value in self.extent {
            bytes.extend(value.to_le_bytes());
        }
        // Plane by plane they are smaller.
        let planes: [fn(&Pixel) -> u8; 6] = [
            |pixel| pixel.value.to_le_bytes()[0],
            |pixel| pixel.value.to_le_bytes()[1],
            |pixel| pixel.bright,
            |pixel| pixel.gloss,
            |pixel| pixel.cover,
            |pixel| pixel.line,
        ];
        let mut encoder = ZlibEncoder::new(bytes, Compression::fast());
        for plane in planes {
            encoder.write_all(&self.pixels.iter().map(plane).collect::<Vec<u8>>())?;
        }
        encoder.finish()
    }

    /// The numbers from bytes; none from bytes that are not whole.
    pub(super) fn unpack(bytes: &[u8]) -> Option<Self> {
        let (sizes, rest) = bytes.split_first_chunk::<8>()?;
        let (extent, rest) = rest.split_first_chunk::<16>()?;
        let size = |k: usize| Some(u32::from_le_bytes(sizes[4 * k..][..4].try_into().ok()?) as usize);
        let end = |k: usize| Some(f64::from_le_bytes(extent[8 * k..][..8].try_into().ok()?));
        let (columns, rows) = (size(0)?, size(1)?);
        let largest = super::LARGEST as usize;
        if !(1..=largest).contains(&columns) || !(1..=largest).contains(&rows) {
            return None;
        }
        let count = columns * rows;
        let mut planes = Vec::new();
        ZlibDecoder::new(rest).take(6 * count as u64 + 1).read_to_end(&mut planes).ok()?;
        let whole = planes.len() == 6 * count;
        whole.then(|| {
            let pixel = |place: usize| {
                let of = |plane: usize| planes[plane * count + place];
                Pixel {
                    value: u16::from_le_bytes([of(0), of(1)]),
                    bright: of(2),
                    gloss: of(3),
                    cover: of(4),
                    line: of(5),
                }
            };
            Some(Shaded { columns, rows, pixels: (0..count).map(pixel).collect(), extent: [end(0)?, end(1)?] })
        })?
    }
}

/// A value as a part of a range.
fn part(value: f64, [low, high]: [f64; 2]) -> f32 {
    let span = if high > low { high - low } else { 1.0 };
    ((value - low) / span) as f32
}

/// The data of the first chunk of a kind in a PNG file.
pub(super) fn chunk(png: &[u8], kind: [u8; 4]) -> Option<&[u8]> {
    let mut rest = png.get(8..)?;
    loop {
        let (length, behind) = rest.split_first_chunk::<4>()?;
        let (name, behind) = behind.split_first_chunk::<4>()?;
        let length = u32::from_be_bytes(*length) as usize;
        let data = behind.get(..length)?;
        if *name == kind {
            return Some(data);
        }
        rest = behind.get(length.checked_add(4)?..)?;
    }
}

/// A PNG file without the chunks of a kind.
pub(crate) fn without_values(png: &[u8]) -> Vec<u8> {
    match chunk(png, CHUNK) {
        None => png.to_vec(),
        Some(data) => {
            let start = data.as_ptr().addr() - png.as_ptr().addr() - 8;
            [&png[..start], &png[start + 12 + data.len()..]].concat()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two() -> Shaded {
        let pixel = |value| Pixel { value: shade(value, [10.0, 20.0]), bright: 100, gloss: 3, cover: 255, line: 0 };
        Shaded { columns: 2, rows: 1, pixels: vec![pixel(10.0), pixel(f64::NAN)], extent: [10.0, 20.0] }
    }

    #[test]
    fn numbers_come_back_and_what_is_not_whole_does_not() {
        let bytes = two().pack().unwrap();
        assert_eq!(Shaded::unpack(&bytes), Some(two()));
        for length in [0, 7, 20, bytes.len() - 3] {
            assert_eq!(Shaded::unpack(&bytes[..length]), None, "{length}");
        }
        let mut huge = bytes.clone();
        huge[..4].copy_from_slice(&u32::MAX.to_le_bytes());
        assert_eq!(Shaded::unpack(&huge), None);
    }

    #[test]
    fn a_value_has_the_colour_of_the_range_it_is_shown_in() {
        let painted = |range| {
            let mut sheet = Sheet::new([2, 1], Background::White.fill());
            two().paint(&mut sheet, ColourMap::Grey, Background::White, range);
            sheet.bytes(false)
        };
        let [own, wide] = [painted([10.0, 20.0]), painted([0.0, 20.0])];
        assert!(wide[0] > own[0] + 30, "10 is the darkest of 10 to 20, and half-way between 0 and 20");
        assert_eq!(own[3], wide[3], "what is not a number is grey in any range");
    }
}
