//! Pixels with an alpha channel that can be drawn over.

use super::palette::Rgb;

/// A picture, row by row from the top.
pub(super) struct Sheet {
    pub(super) columns: usize,
    pub(super) rows: usize,
    /// Red, green, blue, alpha; not multiplied by alpha.
    pixels: Vec<[u8; 4]>,
}

impl Sheet {
    /// A sheet of one colour; without it, one that can be seen through.
    pub(super) fn new([columns, rows]: [usize; 2], (fill, covers): (Rgb, bool)) -> Self {
        let [red, green, blue] = fill;
        let alpha = if covers { 255 } else { 0 };
        Sheet { columns, rows, pixels: vec![[red, green, blue, alpha]; columns * rows] }
    }

    /// Lays a colour over a pixel, `cover` of it between 0 and 1. What lies outside the picture is left out.
    pub(super) fn blend(&mut self, column: usize, row: usize, ink: [f32; 3], cover: f32) {
        if column >= self.columns || row >= self.rows || cover <= 0.0 {
            return;
        }
        let pixel = &mut self.pixels[row * self.columns + column];
        let below = f32::from(pixel[3]) / 255.0 * (1.0 - cover);
        let alpha = cover + below;
        for (channel, ink) in pixel.iter_mut().zip(ink) {
            *channel = ((ink * 255.0 * cover + f32::from(*channel) * below) / alpha).round() as u8;
        }
        pixel[3] = (alpha * 255.0).round() as u8;
    }

    /// Fills a rectangle; what lies outside the picture is left out.
    pub(super) fn fill(&mut self, [left, top]: [usize; 2], [width, height]: [usize; 2], ink: Rgb) {
        let ink = share(ink);
        for row in top..(top + height).min(self.rows) {
            for column in left..(left + width).min(self.columns) {
                self.blend(column, row, ink, 1.0);
            }
        }
    }

    /// The bytes of a picture: with alpha if asked for.
    pub(super) fn bytes(&self, alpha: bool) -> Vec<u8> {
        if alpha {
            self.pixels.as_flattened().to_vec()
        } else {
            self.pixels.iter().flat_map(|[red, green, blue, _]| [*red, *green, *blue]).collect()
        }
    }
}

/// A colour as parts of 1.
pub(super) fn share(colour: Rgb) -> [f32; 3] {
    colour.map(|channel| f32::from(channel) / 255.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_drawn_covers_what_lies_below_and_keeps_its_colour_over_nothing() {
        let mut sheet = Sheet::new([2, 1], ([100; 3], true));
        sheet.blend(0, 0, [1.0, 0.0, 0.0], 0.5);
        sheet.blend(7, 0, [1.0; 3], 1.0);
        assert_eq!(sheet.bytes(false), [178, 50, 50, 100, 100, 100]);
        let mut clear = Sheet::new([1, 1], ([0; 3], false));
        clear.blend(0, 0, [1.0, 0.0, 0.0], 0.5);
        assert_eq!(clear.bytes(true), [255, 0, 0, 128]);
    }
}
