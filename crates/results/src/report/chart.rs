//! A chart: drawn once here, so that a page without scripts shows it, and once more by `charts.js`, which can zoom.

use super::html::{escape, json, number};
use crate::axis::{Ticks, extent};
use crate::curve::thinned;
use std::fmt::Write;

/// A line of a chart.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Line {
    pub(super) name: String,
    /// In the units of the axes.
    pub(super) points: Vec<(f64, f64)>,
    /// Whether it is something that was not computed.
    pub(super) dashed: bool,
}

/// Lines over one axis.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Chart {
    pub(super) title: String,
    /// Titles of the axes.
    pub(super) axes: [String; 2],
    /// Whether the vertical axis shows powers of ten.
    pub(super) logarithmic: bool,
    pub(super) lines: Vec<Line>,
    /// What there is to say.
    pub(super) notes: Vec<String>,
}

/// Points of a line in the page: more than pixels, so that there is something to zoom into.
const MOST_POINTS: usize = 2400;
/// Points of a line in the picture that needs no script.
const FEW_POINTS: usize = 420;
/// Colours of lines in the style sheet; they begin again where there are more lines.
const COLOURS: usize = 8;

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 300.0;
const LEFT: f64 = 74.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 10.0;
const BOTTOM: f64 = 42.0;

impl Chart {
    /// The chart as a `figure`; nothing if no line has two points.
    pub(super) fn html(&self) -> Option<String> {
        let lines: Vec<&Line> = self.lines.iter().filter(|line| line.points.len() > 1).collect();
        if lines.is_empty() {
            return None;
        }
        let mut text = format!("<figure class=\"chart\">\n<figcaption>{}</figcaption>\n", escape(&self.title));
        text += &self.svg(&lines);
        text += "<ul class=\"key\">";
        for (place, line) in lines.iter().enumerate() {
            let dashed = if line.dashed { " dashed" } else { "" };
            let _ = write!(text, "<li class=\"c{}{dashed}\">{}</li>", place % COLOURS, escape(&line.name));
        }
        text += "</ul>\n";
        for note in &self.notes {
            let _ = writeln!(text, "<p class=\"note\">{}</p>", escape(note));
        }
        let _ = writeln!(text, "<script type=\"application/json\">{}</script>\n</figure>", self.data(&lines));
        Some(text)
    }

    /// Where a value is on the vertical axis before it is scaled.
    fn lifted(&self, value: f64) -> f64 {
        if self.logarithmic { value.log10() } else { value }
    }

    fn svg(&self, lines: &[&Line]) -> String {
        let all = || lines.iter().flat_map(|line| &line.points);
        let shown = |value: &f64| value.is_finite();
        let x = extent(all().map(|point| point.0));
        let y = extent(all().map(|point| self.lifted(point.1)).filter(shown));
        let across = |value: f64| LEFT + (value - x.start) / (x.end - x.start) * (WIDTH - LEFT - RIGHT);
        let down = |value: f64| HEIGHT - BOTTOM - (value - y.start) / (y.end - y.start) * (HEIGHT - TOP - BOTTOM);
        let mut text = format!(
            "<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{}\">\n<g class=\"grid\">",
            escape(&self.title)
        );
        let (right, bottom) = (WIDTH - RIGHT, HEIGHT - BOTTOM);
        let ticks = Ticks::between(x.start, x.end, 6);
        for &tick in &ticks.values {
            let (at, said) = (across(tick), ticks.label(tick));
            let _ = write!(text, "<path d=\"M{at:.1} {TOP}V{bottom}\"/>");
            let _ = write!(text, "<text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{said}</text>", bottom + 16.0);
        }
        let ticks = Ticks::between(y.start, y.end, 5);
        for &tick in &ticks.values {
            let at = down(tick);
            let said = if self.logarithmic { powered(tick) } else { ticks.label(tick) };
            let _ = write!(text, "<path d=\"M{LEFT} {at:.1}H{right}\"/>");
            let _ = write!(text, "<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{said}</text>", LEFT - 6.0, at + 4.0);
        }
        let middle = 0.5 * (LEFT + right);
        let _ = write!(
            text,
            "</g><text class=\"title\" x=\"{middle}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
            HEIGHT - 6.0,
            escape(&self.axes[0])
        );
        let _ = writeln!(
            text,
            "<text class=\"title\" transform=\"translate(13 {:.1}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            0.5 * (TOP + bottom),
            escape(&self.axes[1])
        );
        for (place, line) in lines.iter().enumerate() {
            let lifted =
                line.points.iter().map(|&(x, y)| (x, self.lifted(y))).filter(|point| shown(&point.1)).collect();
            let points: Vec<String> = thinned(lifted, FEW_POINTS)
                .into_iter()
                .map(|(x, y)| format!("{:.1},{:.1}", across(x), down(y)))
                .collect();
            let dashed = if line.dashed { " dashed" } else { "" };
            let class = format!("line c{}{dashed}", place % COLOURS);
            let _ = writeln!(text, "<polyline class=\"{class}\" points=\"{}\"/>", points.join(" "));
        }
        text + "</svg>\n"
    }

    /// What the script draws.
    fn data(&self, lines: &[&Line]) -> String {
        let list =
            |values: &mut dyn Iterator<Item = f64>| values.map(|value| number(value, 7)).collect::<Vec<_>>().join(",");
        let mut shared = String::new();
        let lines: Vec<String> = lines
            .iter()
            .map(|line| {
                let points = thinned(line.points.clone(), MOST_POINTS);
                let (x, y) = (list(&mut points.iter().map(|p| p.0)), list(&mut points.iter().map(|p| p.1)));
                // Columns of one history have the same times, which need not be repeated.
                let x = if x == shared { "null".to_owned() } else { format!("[{}]", replace(&mut shared, x)) };
                format!("{{\"name\":{},\"dashed\":{},\"x\":{x},\"y\":[{y}]}}", json(&line.name), line.dashed)
            })
            .collect();
        format!(
            "{{\"title\":{},\"x\":{},\"y\":{},\"log\":{},\"lines\":[{}]}}",
            json(&self.title),
            json(&self.axes[0]),
            json(&self.axes[1]),
            self.logarithmic,
            lines.join(",")
        )
    }
}

/// Puts a text in the place of another and returns it.
fn replace(place: &mut String, text: String) -> String {
    place.clone_from(&text);
    text
}

/// What stands at a logarithmic axis: whole powers of ten only, or the grid would lie.
fn powered(exponent: f64) -> String {
    if exponent.fract() == 0.0 { format!("1e{exponent}") } else { String::new() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(lines: Vec<Line>) -> Chart {
        let axes = ["time (s)", "a < b (J)"].map(str::to_owned);
        Chart { title: "Energy & heat".into(), axes, logarithmic: false, lines, notes: vec!["<b>".into()] }
    }

    #[test]
    fn a_chart_is_drawn_without_a_script_and_has_its_numbers_for_one() {
        let line = |name: &str, factor: f64| Line {
            name: name.into(),
            points: (0..50).map(|k| (f64::from(k), factor * f64::from(k * k))).collect(),
            dashed: factor < 0.0,
        };
        let html = chart(vec![line("</script>", 1.0), line("b", -1.0)]).html().expect("there is something to draw");
        assert_eq!(html.matches("<polyline").count(), 2);
        assert_eq!(html.matches("</script>").count(), 1, "names cannot end the element");
        assert!(html.contains("Energy &amp; heat") && html.contains("&lt;b&gt;") && html.contains("a &lt; b (J)"));
        assert!(html.contains("\"x\":[0,1,2,") && html.contains("\"x\":null"), "times stand there once");
        assert!(html.contains("c1 dashed"));
        assert_eq!(chart(Vec::new()).html(), None);
        assert_eq!(chart(vec![Line { points: vec![(0.0, 1.0)], ..line("a", 1.0) }]).html(), None);
    }

    #[test]
    fn a_logarithmic_axis_shows_what_is_above_zero() {
        let points = vec![(0.0, 0.0), (1.0, 1e-6), (2.0, 1e-2)];
        let line = Line { name: "ratio".into(), points, dashed: false };
        let html = Chart { logarithmic: true, ..chart(vec![line]) }.html().expect("two points are above zero");
        assert!(html.contains(">1e-4<") && !html.contains("NaN") && !html.contains("inf"), "{html}");
    }
}
