//! The bar of colours beside a picture: which value is which colour, and of what time the picture is.

use super::colour::{Colour, colour_of};
use super::sheet::Sheet;
use super::text;

const INK: [u8; 3] = [40, 44, 52];
/// Values that are written beside the bar.
const LABELS: usize = 5;
/// Letters of the longest label, such as -1.234e-5.
const LETTERS: &str = "-1.234e-5";
/// Of a picture, the bar takes at most one part in so many of the width; a smaller picture has none.
const SHARE: usize = 3;

/// What a bar shows.
pub(super) struct Bar {
    pub(super) colour: Colour,
    /// Values at the two ends.
    pub(super) range: [f64; 2],
    /// What stands below it.
    pub(super) caption: String,
}

impl Bar {
    /// Pixels per pixel of a letter: readable where a picture is shown at half its size.
    fn scale(rows: usize) -> usize {
        ((rows + 150) / 300).max(1)
    }

    /// Pixels across that a bar takes beside a picture; none where there is no room for it.
    pub(super) fn width(columns: usize, rows: usize) -> usize {
        let scale = Bar::scale(rows);
        let width = text::width(LETTERS, scale) + 24 * scale;
        if width * SHARE <= columns { width } else { 0 }
    }

    /// Draws the bar into the right part of a picture, from a column on.
    pub(super) fn draw(&self, sheet: &mut Sheet<'_>, rows: usize, left: usize) {
        let scale = Bar::scale(rows);
        let (line, name) = (text::HEIGHT * scale, self.colour.name().replace('-', " "));
        let mut top = 4 * scale;
        // A name of two words takes two lines, and its unit one of its own.
        for word in name.split(' ').chain([self.colour.unit()]).filter(|word| !word.is_empty()) {
            text::write(sheet, word, [left + 4 * scale, top], scale, INK);
            top += line + 3 * scale;
        }
        let bottom = rows.saturating_sub(2 * line + 6 * scale);
        text::write(sheet, &self.caption, [left + 4 * scale, rows.saturating_sub(line + 4 * scale)], scale, INK);
        let top = top + line;
        let height = bottom.saturating_sub(top);
        if height < LABELS * line {
            return;
        }
        let (bar, beside) = (left + 4 * scale, left + 18 * scale);
        match self.levels() {
            Some(levels) => {
                for level in 0..levels {
                    let value = self.range[0] + level as f64;
                    let y = bottom - (level + 1) * (2 * line);
                    let shade = level as f32 / (levels - 1).max(1) as f32;
                    sheet.fill([bar, y], [10 * scale, line + line / 2], painted(shade));
                    text::write(sheet, &number(value), [beside, y + line / 4], scale, INK);
                }
            }
            None => self.scale_of_values(sheet, [top, height], [bar, beside], scale),
        }
    }

    /// A few whole numbers get a patch each.
    fn levels(&self) -> Option<usize> {
        const MOST: f64 = 8.0;
        let [low, high] = self.range;
        let few = self.colour == Colour::Material && low.fract() == 0.0 && high.fract() == 0.0;
        (few && (0.0..MOST).contains(&(high - low))).then(|| (high - low) as usize + 1)
    }

    fn scale_of_values(
        &self,
        sheet: &mut Sheet<'_>,
        [top, height]: [usize; 2],
        [bar, beside]: [usize; 2],
        scale: usize,
    ) {
        let [low, high] = self.range;
        for row in 0..height {
            let shade = 1.0 - row as f32 / (height - 1).max(1) as f32;
            sheet.fill([bar, top + row], [10 * scale, 1], painted(shade));
        }
        // A range without extent, or of nothing, has at most one value to tell.
        let labels = if high > low { LABELS } else { usize::from(low.is_finite()) };
        for label in 0..labels {
            let share = label as f64 / (LABELS - 1) as f64;
            let y = top + ((1.0 - share) * (height - 1) as f64) as usize;
            sheet.fill([bar + 10 * scale, y], [2 * scale, scale], INK);
            let text = number(low + share * (high - low));
            let up = (text::HEIGHT * scale / 2).min(y);
            text::write(sheet, &text, [beside, y - up], scale, INK);
        }
    }
}

fn painted(shade: f32) -> [u8; 3] {
    colour_of(shade).map(|part| (part * 255.0).round() as u8)
}

/// Four digits at most.
pub(super) fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    match rounded.abs() {
        0.0 => "0".to_owned(),
        1e-3..1e5 => format!("{rounded}"),
        _ => format!("{rounded:e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_fit_beside_the_bar() {
        let values = [-1.234_56e-5, 123_456.0, 0.1 + 0.2, -0.001_234, 0.0, 293.15];
        assert_eq!(values.map(number), ["-1.235e-5", "1.235e5", "0.3", "-0.001234", "0", "293.1"]);
        assert!(values.map(number).iter().all(|text| text.len() <= LETTERS.len()));
    }

    #[test]
    fn a_bar_runs_from_dark_below_to_bright_above() {
        let (columns, rows) = (400, 300);
        let width = Bar::width(columns, rows);
        let mut pixels = vec![255; 3 * columns * rows];
        let bar = Bar { colour: Colour::Temperature, range: [20.0, 900.0], caption: "t = 1 s".into() };
        bar.draw(&mut Sheet { columns, pixels: &mut pixels }, rows, columns - width);
        let column: Vec<&[u8]> =
            (0..rows).map(|row| &pixels[3 * (row * columns + columns - width + 6)..][..3]).collect();
        let [first, last] = [painted(1.0), painted(0.0)];
        let place = |colour: [u8; 3]| column.iter().position(|pixel| *pixel == colour);
        assert!(place(first).expect("bright is there") < place(last).expect("dark is there"));
        assert_eq!(Bar::width(80, 60), 0, "too small a picture has none");
    }

    #[test]
    fn materials_have_patches() {
        let bar = |range| Bar { colour: Colour::Material, range, caption: String::new() };
        assert_eq!([[0.0, 1.0], [0.0, 0.0], [0.0, 40.0]].map(|range| bar(range).levels()), [Some(2), Some(1), None]);
    }
}
