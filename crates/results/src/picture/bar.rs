//! The bar of colours beside a picture: which value is which colour, and of what time the picture is.

use super::colour::Colour;
use super::palette::{Background, ColourMap, Rgb};
use super::sheet::Sheet;
use super::text::Letters;
use super::{Scale, Stamp};
use crate::axis::{Ticks, prefix, unit_of_time};

/// Letters of the longest label.
const LONGEST: &str = "\u{2212}1.234e-5";
/// Of a picture, the bar takes at most one part in so many of the width; a smaller picture has none.
const SHARE: usize = 3;
/// The size of letters is one part in so many of the height of the picture, but can be read.
const LETTERS: f32 = 34.0;
const LEAST: f32 = 11.0;
/// About so many ticks.
const TICKS: usize = 6;

/// What a bar shows.
pub(super) struct Bar {
    pub(super) colour: Colour,
    pub(super) map: ColourMap,
    pub(super) background: Background,
    pub(super) scale: Scale,
    /// Values at the two ends, SI.
    pub(super) range: [f64; 2],
    pub(super) stamp: Stamp,
}

fn letters(rows: usize) -> Letters {
    Letters::of_size((rows as f32 / LETTERS).max(LEAST))
}

impl Bar {
    /// Pixels across that a bar takes beside a picture; none where there is no room for it.
    pub(super) fn width(columns: usize, rows: usize) -> usize {
        let letters = letters(rows);
        let width = letters.width(LONGEST) + 3 * letters.line();
        if width * SHARE <= columns && 12 * letters.line() <= rows { width } else { 0 }
    }

    /// Draws the bar into the right part of a picture, from a column on.
    pub(super) fn draw(&self, sheet: &mut Sheet, left: usize) {
        let (rows, ink) = (sheet.rows, self.background.ink());
        let letters = letters(rows);
        let line = letters.line();
        let (left, room) = (left + line / 2, sheet.columns - left - line);
        let (shown, unit) = self.shown();
        let mut top = line / 2;
        for text in wrapped(&self.title(&unit), |text| letters.width(text) <= room) {
            letters.write(sheet, &text, [left, top], ink);
            top += line;
        }
        let caption = rows.saturating_sub(line + line / 2);
        letters.write(sheet, &self.caption(), [left, caption], ink);
        let (top, bottom) = (top + line, caption.saturating_sub(line));
        match self.levels() {
            Some(levels) => {
                for level in 0..levels {
                    let y = bottom.saturating_sub((level + 1) * (line + line / 2));
                    let shade = level as f32 / (levels - 1).max(1) as f32;
                    sheet.fill([left, y], [line, line], self.painted(shade));
                    letters.write(
                        sheet,
                        &(self.range[0] as usize + level).to_string(),
                        [left + line + line / 2, y],
                        ink,
                    );
                }
            }
            None => self.scale_of_values(sheet, &letters, [top, bottom], left, shown),
        }
    }

    /// The range in the unit that is shown, and that unit.
    fn shown(&self) -> ([f64; 2], String) {
        let [low, high] = self.range;
        match (self.colour.unit(), self.scale) {
            ("K", Scale::Celsius) => ([low, high].map(|value| value - super::CELSIUS), "\u{b0}C".to_owned()),
            (unit @ ("m/s" | "m" | "N" | "Pa"), _) => {
                let (prefix, size) = prefix(low.abs().max(high.abs()));
                ([low / size, high / size], format!("{prefix}{unit}"))
            }
            (unit, _) => ([low, high], unit.to_owned()),
        }
    }

    fn title(&self, unit: &str) -> String {
        let name = self.colour.title();
        if unit.is_empty() { name.to_owned() } else { format!("{name} ({unit})") }
    }

    fn caption(&self) -> String {
        let (unit, size) = unit_of_time(self.stamp.longest.unwrap_or(self.stamp.time));
        format!("t = {} {unit}", number(self.stamp.time / size))
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
        sheet: &mut Sheet,
        letters: &Letters,
        [top, bottom]: [usize; 2],
        left: usize,
        [low, high]: [f64; 2],
    ) {
        let (line, ink) = (letters.line(), self.background.ink());
        let height = bottom.saturating_sub(top);
        if height < 3 * line {
            return;
        }
        let thin = (line / 12).max(1);
        sheet.fill([left - thin, top - thin], [line + 2 * thin, height + 2 * thin], ink);
        for row in 0..height {
            let shade = 1.0 - row as f32 / (height - 1) as f32;
            sheet.fill([left, top + row], [line, 1], self.painted(shade));
        }
        let mut tick = |value: f64, share: f64, text: String| {
            debug_assert!(value.is_finite());
            let y = top + ((1.0 - share) * (height - 1) as f64).round() as usize;
            sheet.fill([left + line + thin, y - thin / 2], [line / 4, thin], ink);
            let text = text.replace('-', "\u{2212}");
            letters.write(sheet, &text, [left + line + line / 2, y.saturating_sub(line / 2)], ink);
        };
        if high > low {
            let ticks = Ticks::between(low, high, TICKS);
            for &value in &ticks.values {
                tick(value, (value - low) / (high - low), ticks.label(value));
            }
        } else if low.is_finite() {
            // A range without extent has one value to tell.
            tick(low, 0.0, number(low));
        }
    }

    fn painted(&self, shade: f32) -> Rgb {
        self.map.colour(shade).map(|part| (part * 255.0).round() as u8)
    }
}

/// A text in lines that fit.
fn wrapped(text: &str, fits: impl Fn(&str) -> bool) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if fits(&format!("{line} {word}")) => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// Four digits at most.
fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    match rounded.abs() {
        0.0 => "0".to_owned(),
        1e-3..1e5 => crate::words::parted(&format!("{rounded}")),
        _ => format!("{rounded:e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bar(colour: Colour, range: [f64; 2]) -> Bar {
        let stamp = Stamp { step: 7, time: 5400.0, longest: Some(20_280.0) };
        let (map, background) = (colour.map(), Background::White);
        Bar { colour, map, background, scale: Scale::Celsius, range, stamp }
    }

    #[test]
    fn a_bar_says_units_that_are_easy_to_read() {
        let told = |colour, range| {
            let bar = bar(colour, range);
            let (shown, unit) = bar.shown();
            (bar.title(&unit), shown)
        };
        assert_eq!(told(Colour::Temperature, [273.15, 373.15]), ("temperature (\u{b0}C)".into(), [0.0, 100.0]));
        assert_eq!(told(Colour::Stress, [-2e6, 2e6]), ("mean stress (MPa)".into(), [-2.0, 2.0]));
        assert_eq!(told(Colour::Damage, [0.0, 0.5]).0, "share of broken bonds");
        assert_eq!(bar(Colour::Damage, [0.0, 0.5]).caption(), "t = 1.5 h", "in the unit of the whole run");
        let kelvin = Bar { scale: Scale::Kelvin, ..bar(Colour::Temperature, [300.0, 400.0]) };
        assert_eq!(kelvin.shown(), ([300.0, 400.0], "K".into()));
    }

    #[test]
    fn a_bar_runs_from_dark_below_to_bright_above() {
        let (columns, rows) = (400, 300);
        let width = Bar::width(columns, rows);
        let mut sheet = Sheet::new([columns, rows], Background::White.fill());
        let bar = bar(Colour::Damage, [0.0, 0.5]);
        let left = columns - width;
        bar.draw(&mut sheet, left);
        let bytes = sheet.bytes(false);
        let column: Vec<&[u8]> =
            (0..rows).map(|row| &bytes[3 * (row * columns + left + letters(rows).line())..][..3]).collect();
        let [first, last] = [bar.painted(1.0), bar.painted(0.0)];
        let place = |colour: [u8; 3]| column.iter().position(|pixel| *pixel == colour);
        assert!(place(first).expect("bright is there") < place(last).expect("dark is there"));
        assert_eq!(Bar::width(80, 60), 0, "too small a picture has none");
    }

    #[test]
    fn names_that_are_too_long_take_lines() {
        assert_eq!(wrapped("share of broken bonds", |text| text.len() <= 10), ["share of", "broken", "bonds"]);
        assert_eq!(wrapped("height", |_| false), ["height"]);
    }

    #[test]
    fn materials_have_patches() {
        let bar = |range| bar(Colour::Material, range);
        assert_eq!([[0.0, 1.0], [0.0, 0.0], [0.0, 40.0]].map(|range| bar(range).levels()), [Some(2), Some(1), None]);
    }
}
