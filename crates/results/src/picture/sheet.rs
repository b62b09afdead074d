//! A finished picture that can be drawn over.

/// Pixels as bytes, red, green and blue, row by row from the top.
pub(super) struct Sheet<'a> {
    pub(super) columns: usize,
    pub(super) pixels: &'a mut [u8],
}

impl Sheet<'_> {
    /// Fills a rectangle; what lies outside the picture is left out.
    pub(super) fn fill(&mut self, [left, top]: [usize; 2], [width, height]: [usize; 2], ink: [u8; 3]) {
        let right = (left + width).min(self.columns);
        for row in self.pixels.chunks_exact_mut(3 * self.columns).skip(top).take(height) {
            row[3 * left.min(right)..3 * right].as_chunks_mut::<3>().0.fill(ink);
        }
    }

    /// Copies a picture of the same height into the left part.
    pub(super) fn paste(&mut self, picture: &[u8], columns: usize) {
        let rows = self.pixels.chunks_exact_mut(3 * self.columns);
        rows.zip(picture.chunks_exact(3 * columns)).for_each(|(row, of_picture)| {
            row[..3 * columns].copy_from_slice(of_picture);
        });
    }
}
