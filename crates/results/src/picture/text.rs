//! Text in pictures: DejaVu Sans, of which Latin, Greek, digits and signs are part of the program.

use super::palette::Rgb;
use super::sheet::{Sheet, share};
use ab_glyph::{Font, FontRef, Glyph, PxScale, ScaleFont, point};

/// See `fonts/LICENSE-DejaVu.txt`.
static DATA: &[u8] = include_bytes!("../../fonts/DejaVuSans.ttf");

/// A size of letters.
pub(super) struct Letters {
    font: FontRef<'static>,
    scale: PxScale,
}

impl Letters {
    /// Letters of so many pixels from the lowest to the highest.
    pub(super) fn of_size(pixels: f32) -> Self {
        let font = FontRef::try_from_slice(DATA).expect("the font is part of the program");
        Letters { font, scale: PxScale::from(pixels) }
    }

    /// Pixels from one line of text to the next.
    pub(super) fn line(&self) -> usize {
        self.font.as_scaled(self.scale).height().ceil() as usize
    }

    /// Pixels that a text takes across.
    pub(super) fn width(&self, text: &str) -> usize {
        self.lay(text).1.ceil() as usize
    }

    /// Glyphs side by side from 0 on, and where they end.
    fn lay(&self, text: &str) -> (Vec<Glyph>, f32) {
        let font = self.font.as_scaled(self.scale);
        let (mut pen, mut last) = (0.0, None);
        let glyphs = text
            .chars()
            .map(|letter| {
                let id = font.glyph_id(letter);
                pen += last.map_or(0.0, |last| font.kern(last, id));
                let glyph = id.with_scale_and_position(self.scale, point(pen, 0.0));
                pen += font.h_advance(id);
                last = Some(id);
                glyph
            })
            .collect();
        (glyphs, pen)
    }

    /// Writes a text with the upper left corner of its line at a pixel.
    pub(super) fn write(&self, sheet: &mut Sheet, text: &str, [left, top]: [usize; 2], ink: Rgb) {
        let (base, ink) = (self.font.as_scaled(self.scale).ascent(), share(ink));
        for glyph in self.lay(text).0 {
            let Some(outline) = self.font.outline_glyph(glyph) else { continue };
            let bounds = outline.px_bounds();
            outline.draw(|x, y, cover| {
                let column = left as f32 + bounds.min.x + x as f32;
                let row = (top as f32 + base).round() + bounds.min.y + y as f32;
                if column >= 0.0 && row >= 0.0 {
                    sheet.blend(column as usize, row as usize, ink, cover.min(1.0));
                }
            });
        }
    }

    /// Whether every letter of a text can be drawn.
    #[cfg(test)]
    pub(super) fn have(&self, text: &str) -> bool {
        text.chars().all(|letter| self.font.glyph_id(letter).0 != 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Colour;

    #[test]
    fn what_bars_say_can_be_written() {
        let said = Colour::ALL.map(|colour| format!("{} {}", colour.title(), colour.unit())).concat();
        assert!(
            Letters::of_size(20.0).have(&(said + "\u{b0}C \u{b5}m \u{2212}0123456789.,e-+\u{3b1}\u{3c3}\u{fc}\u{e9}"))
        );
    }

    #[test]
    fn a_letter_is_where_it_is_written() {
        let mut sheet = Sheet::new([60, 40], ([255; 3], true));
        let letters = Letters::of_size(30.0);
        letters.write(&mut sheet, "I", [10, 2], [0; 3]);
        let dark: Vec<usize> = sheet
            .bytes(false)
            .chunks_exact(3)
            .enumerate()
            .filter(|(_, pixel)| pixel[0] < 128)
            .map(|(place, _)| place)
            .collect();
        let columns: Vec<usize> = dark.iter().map(|place| place % 60).collect();
        let rows: Vec<usize> = dark.iter().map(|place| place / 60).collect();
        assert!(columns.iter().all(|column| (10..22).contains(column)) && !dark.is_empty());
        let [first, last] = [rows[0], rows[rows.len() - 1]];
        assert!((14..24).contains(&(last - first)) && last < 2 + letters.line(), "{first} {last}");
        assert!(letters.width("0.50") > letters.width("0.5") && letters.width("") == 0);
    }
}
