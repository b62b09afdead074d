//! Charts as SVG that stands inside a page: text takes the page's colour, classes give the rest, nothing is filled behind it,
//! so that a chart looks right on light and on dark. That is why they are not drawn with a library that paints colours.

use std::fmt::Write;
pub(super) use tdem_results::words::escape as escaped;

/// The drawing, in units of its view box; small, so that text can be read on a narrow screen.
const WIDTH: f64 = 460.0;
const HEIGHT: f64 = 330.0;
const LEFT: f64 = 62.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 12.0;
const BOTTOM: f64 = 46.0;

/// How values lie along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Scale {
    /// From zero on.
    Linear,
    /// By their decades.
    Log,
}

/// An axis.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    title: &'static str,
    scale: Scale,
    low: f64,
    high: f64,
    label: fn(f64) -> String,
}

impl Axis {
    /// One that has room for these values, and a little more.
    pub(super) fn of(
        title: &'static str,
        scale: Scale,
        values: impl IntoIterator<Item = f64>,
        label: fn(f64) -> String,
    ) -> Self {
        let known = values.into_iter().filter(|value| value.is_finite() && (*value > 0.0 || scale == Scale::Linear));
        let (low, high) = known.fold((f64::INFINITY, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
        let (low, high) = match scale {
            Scale::Linear => (0.0, if high > 0.0 { 1.08 * high } else { 1.0 }),
            Scale::Log if low.is_finite() => (low / 1.5, high * 1.5),
            Scale::Log => (1.0, 10.0),
        };
        Axis { title, scale, low, high, label }
    }
    /// Where a value lies, from 0 to 1.
    fn place(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear => (value - self.low) / (self.high - self.low),
            Scale::Log => libm::log(value / self.low) / libm::log(self.high / self.low),
        }
    }
    fn ticks(&self) -> Vec<f64> {
        match self.scale {
            Scale::Linear => {
                let rough = (self.high - self.low) / 5.0;
                let decade = libm::pow(10.0, libm::floor(libm::log10(rough)));
                let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * decade).find(|&step| step >= rough);
                let step = step.unwrap_or(10.0 * decade);
                (0..=10).map(|k| self.low + f64::from(k) * step).filter(|&tick| tick <= self.high).collect()
            }
            Scale::Log => {
                let decades = libm::log10(self.high / self.low);
                let within: &[f64] = if decades < 1.3 {
                    &[1.0, 2.0, 3.0, 5.0, 7.0]
                } else if decades < 3.2 {
                    &[1.0, 2.0, 5.0]
                } else {
                    &[1.0]
                };
                let first = libm::floor(libm::log10(self.low)) as i32;
                let last = libm::ceil(libm::log10(self.high)) as i32;
                let ticks = (first..=last).flat_map(|k| within.iter().map(move |m| m * libm::pow(10.0, f64::from(k))));
                ticks.filter(|tick| (self.low..=self.high).contains(tick)).collect()
            }
        }
    }
}

/// What marks a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Shape {
    /// A disc.
    Disc,
    /// A square.
    Square,
    /// A ring: published.
    Ring,
    /// A cross: published, and scaled.
    Cross,
}

/// Points and lines between two axes.
pub(super) struct Chart {
    x: Axis,
    y: Axis,
    text: String,
    /// Where texts stand beside points.
    notes: Vec<([f64; 2], String)>,
}

/// What stands at the head of a drawing.
fn head(height: f64, about: &str) -> String {
    format!("<svg viewBox=\"0 0 {WIDTH} {height}\" role=\"img\" aria-label=\"{}\">\n", escaped(about))
}

/// Text at a place; `anchor` is start, middle or end.
fn write_text(text: &mut String, [x, y]: [f64; 2], anchor: &str, what: &str) {
    let _ = writeln!(text, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{}</text>", escaped(what));
}

impl Chart {
    /// Axes with their grid.
    pub(super) fn new(x: Axis, y: Axis, about: &str) -> Self {
        let mut chart = Chart { x, y, text: head(HEIGHT, about), notes: Vec::new() };
        let (right, bottom) = (WIDTH - RIGHT, HEIGHT - BOTTOM);
        for tick in chart.x.ticks() {
            let at = chart.across(tick);
            let _ = writeln!(chart.text, "<path class=\"grid\" d=\"M{at:.1} {TOP}V{bottom}\"/>");
            write_text(&mut chart.text, [at, bottom + 16.0], "middle", &(chart.x.label)(tick));
        }
        for tick in chart.y.ticks() {
            let at = chart.up(tick);
            let _ = writeln!(chart.text, "<path class=\"grid\" d=\"M{LEFT} {at:.1}H{right}\"/>");
            write_text(&mut chart.text, [LEFT - 6.0, at + 4.0], "end", &(chart.y.label)(tick));
        }
        let _ = writeln!(chart.text, "<path class=\"frame\" d=\"M{LEFT} {TOP}V{bottom}H{right}\"/>");
        write_text(&mut chart.text, [0.5 * (LEFT + right), HEIGHT - 8.0], "middle", chart.x.title);
        let middle = 0.5 * (TOP + bottom);
        let _ = writeln!(
            chart.text,
            "<text transform=\"translate(13 {middle:.1}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            escaped(chart.y.title)
        );
        chart
    }
    fn across(&self, value: f64) -> f64 {
        LEFT + self.x.place(value) * (WIDTH - RIGHT - LEFT)
    }
    fn up(&self, value: f64) -> f64 {
        HEIGHT - BOTTOM - self.y.place(value) * (HEIGHT - BOTTOM - TOP)
    }
    /// A line through points; `class` gives its colour and whether it is broken.
    pub(super) fn line(&mut self, points: &[[f64; 2]], class: &str) {
        if points.len() < 2 {
            return;
        }
        let mut path = String::new();
        for (k, &[x, y]) in points.iter().enumerate() {
            let _ = write!(path, "{}{:.1} {:.1}", if k == 0 { 'M' } else { 'L' }, self.across(x), self.up(y));
        }
        let _ = writeln!(self.text, "<path class=\"line {class}\" d=\"{path}\"/>");
    }
    /// A point; what it is shows up where a pointer rests.
    pub(super) fn mark(&mut self, [x, y]: [f64; 2], shape: Shape, class: &str, about: &str) {
        let (x, y, about) = (self.across(x), self.up(y), escaped(about));
        let drawn = match shape {
            Shape::Disc => format!("<circle class=\"full {class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\">"),
            Shape::Ring => format!("<circle class=\"hollow {class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"5\">"),
            Shape::Square => {
                let (x, y) = (x - 3.5, y - 3.5);
                format!("<rect class=\"full {class}\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"7\" height=\"7\">")
            }
            Shape::Cross => {
                let (x, y) = (x - 4.0, y - 4.0);
                format!("<path class=\"hollow {class}\" d=\"M{x:.1} {y:.1}l8 8m0 -8l-8 8\">")
            }
        };
        let end = drawn[1..].split(' ').next().unwrap_or_default();
        let _ = writeln!(self.text, "{drawn}<title>{about}</title></{end}>");
    }
    /// A short text beside a point, unless the same stands there already.
    pub(super) fn note(&mut self, [x, y]: [f64; 2], what: &str) {
        let at = [self.across(x) + 6.0, self.up(y) + 4.0];
        let near = |(other, text): &([f64; 2], String)| {
            text == what && (other[0] - at[0]).abs() < 12.0 && (other[1] - at[1]).abs() < 12.0
        };
        if !self.notes.iter().any(near) {
            write_text(&mut self.text, at, "start", what);
            self.notes.push((at, what.to_owned()));
        }
    }
    /// An upright line from the horizontal axis to a value.
    pub(super) fn upright(&mut self, x: f64, until: f64, class: &str) {
        let low = self.y.low;
        if until > low {
            self.line(&[[x, low], [x, until]], class);
        }
    }
    /// The drawing.
    pub(super) fn finish(self) -> String {
        self.text + "</svg>\n"
    }
}

/// A value, the class of its bar, and a text for where a pointer rests.
pub(super) type Part = (f64, String, String);

/// Bars that belong together: parts of one bar, or bars side by side.
pub(super) struct Bar {
    pub(super) label: String,
    pub(super) parts: Vec<Part>,
}

/// Bars of parts of a whole, from 0 to 1, one below the other.
pub(super) fn stacked(bars: &[Bar], about: &str) -> String {
    const ROW: f64 = 30.0;
    const LABELS: f64 = 96.0;
    let height = ROW * bars.len() as f64 + 8.0;
    let mut text = head(height, about);
    let length = WIDTH - LABELS - 4.0;
    for (k, bar) in bars.iter().enumerate() {
        let top = 4.0 + ROW * k as f64;
        write_text(&mut text, [LABELS - 6.0, top + 18.0], "end", &bar.label);
        let mut from = LABELS;
        for (part, class, about) in &bar.parts {
            let width = part * length;
            if width <= 0.0 {
                continue;
            }
            let _ = writeln!(
                text,
                "<rect class=\"bar {class}\" x=\"{from:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"24\">\
                 <title>{}</title></rect>",
                escaped(about)
            );
            if *part >= 0.075 {
                let at = [from + 0.5 * width, top + 17.0];
                let percent = format!("{:.0}", 100.0 * part);
                let _ = writeln!(
                    text,
                    "<text class=\"on\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{percent}</text>",
                    at[0], at[1]
                );
            }
            from += width;
        }
    }
    text + "</svg>\n"
}

/// Groups of bars side by side.
pub(super) fn grouped(title: &'static str, groups: &[Bar], label: fn(f64) -> String, about: &str) -> String {
    let values = groups.iter().flat_map(|group| group.parts.iter().map(|(value, _, _)| *value));
    let y = Axis::of(title, Scale::Linear, values, label);
    let x =
        Axis { title: "", scale: Scale::Linear, low: 0.0, high: groups.len().max(1) as f64, label: |_| String::new() };
    let mut chart = Chart::new(Axis { high: x.high, ..x.clone() }, y, about);
    let bottom = HEIGHT - BOTTOM;
    for (k, Bar { label: name, parts: bars }) in groups.iter().enumerate() {
        let middle = chart.across(k as f64 + 0.5);
        write_text(&mut chart.text, [middle, bottom + 18.0], "middle", name);
        let width = 0.82 * (chart.across(1.0) - chart.across(0.0)) / bars.len().max(1) as f64;
        for (b, (value, class, about)) in bars.iter().enumerate() {
            let (x, y) = (middle + width * (b as f64 - 0.5 * bars.len() as f64), chart.up(*value));
            let _ = writeln!(
                chart.text,
                "<rect class=\"bar {class}\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{:.1}\" height=\"{:.1}\">\
                 <title>{}</title></rect>",
                width - 1.0,
                bottom - y,
                escaped(about)
            );
        }
    }
    chart.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(value: f64) -> String {
        format!("{value}")
    }

    #[test]
    fn points_lie_where_they_should() {
        let x = Axis { title: "x", scale: Scale::Log, low: 1.0, high: 100.0, label: plain };
        let y = Axis { title: "y", scale: Scale::Linear, low: 0.0, high: 4.0, label: plain };
        let mut chart = Chart::new(x, y, "a < b");
        assert!((chart.across(10.0) - 0.5 * (LEFT + WIDTH - RIGHT)).abs() < 1e-9);
        assert!((chart.up(1.0) - (HEIGHT - BOTTOM - 0.25 * (HEIGHT - BOTTOM - TOP))).abs() < 1e-9);
        chart.line(&[[1.0, 0.0], [100.0, 4.0]], "c0");
        for shape in [Shape::Disc, Shape::Square, Shape::Ring, Shape::Cross] {
            chart.mark([10.0, 2.0], shape, "c1", "ten & two");
        }
        chart.note([10.0, 2.0], "p");
        chart.note([10.1, 2.0], "p");
        chart.note([10.1, 2.0], "q");
        chart.upright(100.0, 4.0, "c2");
        let text = chart.finish();
        assert_eq!((text.matches(">p</text>").count(), text.matches(">q</text>").count()), (1, 1));
        assert!(text.contains("c2\" d=\"M446.0 284.0L446.0 12.0\""), "{text}");
        assert!(text.contains("d=\"M62.0 284.0L446.0 12.0\"") && text.contains("a &lt; b"), "{text}");
        assert_eq!(text.matches("<title>ten &amp; two</title>").count(), 4);
        for element in ["circle", "rect", "path", "svg", "text"] {
            let opened = text.matches(&format!("<{element} ")).count();
            let closed = text.matches(&format!("</{element}>")).count();
            let empty = if element == "path" { text.matches("\"/>").count() } else { 0 };
            assert_eq!(opened, closed + empty, "{element}: {text}");
        }
    }

    #[test]
    fn ticks_are_round_and_few() {
        let axis = |scale, values: [f64; 2]| Axis::of("", scale, values, plain);
        assert_eq!(axis(Scale::Linear, [1.0, 2.6]).ticks(), [0.0, 1.0, 2.0]);
        assert_eq!(axis(Scale::Linear, [0.0, 1.0]).ticks().len(), 3);
        let close = |found: Vec<f64>, expected: &[f64]| {
            assert_eq!(found.len(), expected.len(), "{found:?}");
            assert!(found.iter().zip(expected).all(|(a, b)| (a / b - 1.0).abs() < 1e-12), "{found:?}");
        };
        close(axis(Scale::Log, [9e3, 4e6]).ticks(), &[1e4, 2e4, 5e4, 1e5, 2e5, 5e5, 1e6, 2e6, 5e6]);
        close(axis(Scale::Log, [2e-5, 0.8]).ticks(), &[1e-4, 1e-3, 1e-2, 1e-1, 1.0]);
        assert!(!axis(Scale::Log, [f64::NAN, 0.0]).ticks().is_empty(), "nothing to show is no reason to panic");
    }

    #[test]
    fn bars_are_as_long_as_their_parts() {
        let parts =
            vec![(0.25, "p0".into(), "a".into()), (0.05, "p1".into(), "b".into()), (0.0, "p2".into(), "c".into())];
        let text = stacked(&[Bar { label: "GN".into(), parts }], "");
        assert!(text.contains("width=\"90.0\"") && text.contains("width=\"18.0\"") && !text.contains("p2"), "{text}");
        assert_eq!(text.matches("class=\"on\"").count(), 1, "a narrow part has no number on it");
        let parts = vec![(1.0, "c0".into(), String::new()), (2.0, "c1".into(), String::new())];
        let groups = [Bar { label: "GN".into(), parts }];
        let text = grouped("time", &groups, plain, "");
        let heights: Vec<f64> = text
            .split("class=\"bar")
            .skip(1)
            .map(|bar| bar.split("height=\"").nth(1).unwrap().split('"').next().unwrap().parse().unwrap())
            .collect();
        assert!((heights[1] / heights[0] - 2.0).abs() < 2e-3, "{heights:?}");
    }
}
