//! A curve of two columns of the history, as a picture in the folder of the run.

use crate::error::{Action, Context, Error};
use crate::files::atomically;
use crate::glossary::unit_of_column;
use crate::run_directory::HISTORY;
use crate::words::plain;
use plotters::prelude::*;
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// What a curve shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Part of the name of its file.
    pub name: String,
    /// Along the horizontal axis.
    pub x: Axis,
    /// Along the vertical axis.
    pub y: Axis,
    /// Names of other curves, and their points in the units of the axes.
    pub against: Vec<(String, Vec<[f64; 2]>)>,
}

/// What an axis shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// A column of `history.csv`.
    pub column: String,
    /// Multiplies its values.
    pub factor: f64,
    /// Is added to them then.
    pub offset: f64,
    /// What stands at the axis; if `None`, the column and its unit, with a prefix such as micro if that is easier to read.
    pub title: Option<String>,
}

/// First part of the names of files with curves; the ending is `svg`.
pub(crate) const PREFIX: &str = "curve-";
pub(crate) const ENDING: &str = "svg";

const SIZE: (u32, u32) = (960, 640);
const FONT: &str = "sans-serif";
/// A curve of more points is thinned out; what is left are the extremes.
const MOST_POINTS: usize = 6000;

/// Draws a curve of the history that a run has written, and returns its file.
///
/// # Errors
/// [`Error::NoColumn`] if the history does not have it, [`Error::Drawing`] if nothing in it can be drawn, and whatever the
/// file system says.
pub fn draw(run: &Path, curve: &Curve) -> Result<PathBuf, Error> {
    let history = run.join(HISTORY);
    let text = fs::read_to_string(&history).context(Action::Read, &history)?;
    let path = run.join(format!("{PREFIX}{}.{ENDING}", curve.name));
    let Found { points, titles: [x_title, y_title] } = find(&history, &text, curve)?;
    let drawn = svg(&thinned(points, MOST_POINTS), &curve.against, [&x_title, &y_title])
        .map_err(|why| Error::Drawing { curve: curve.name.clone(), why, path: path.clone() })?;
    atomically(&path, |unfinished| fs::write(unfinished, &drawn).context(Action::Write, &path))?;
    Ok(path)
}

/// What a history has for a curve.
pub(crate) struct Found {
    /// In the units of the axes.
    pub(crate) points: Vec<(f64, f64)>,
    /// Of the horizontal and the vertical axis.
    pub(crate) titles: [String; 2],
}

/// Finds a curve in the text of a history; `path` is where that comes from.
pub(crate) fn find(path: &Path, history: &str, curve: &Curve) -> Result<Found, Error> {
    let column = |axis: &Axis| {
        let no_column = || Error::NoColumn { column: axis.column.clone(), path: path.into() };
        column(history, &axis.column).ok_or_else(no_column)
    };
    let (x, x_title) = scaled(&curve.x, column(&curve.x)?);
    let (y, y_title) = scaled(&curve.y, column(&curve.y)?);
    let points = x.into_iter().zip(y).filter(|(x, y)| x.is_finite() && y.is_finite()).collect();
    Ok(Found { points, titles: [x_title, y_title] })
}

/// The numbers of a column; rows that are cut off have none.
fn column(history: &str, name: &str) -> Option<Vec<f64>> {
    let mut lines = history.lines();
    let place = lines.next()?.split(',').position(|column| column == name)?;
    Some(lines.map(|line| line.split(',').nth(place).and_then(|cell| cell.parse().ok()).unwrap_or(f64::NAN)).collect())
}

/// Values of an axis and its title.
fn scaled(axis: &Axis, column: Vec<f64>) -> (Vec<f64>, String) {
    let values: Vec<f64> = column.into_iter().map(|value| value * axis.factor + axis.offset).collect();
    if let Some(title) = &axis.title {
        return (values, title.clone());
    }
    let name = if axis.offset != 0.0 {
        format!("{} x {} + {}", axis.factor, axis.column, axis.offset)
    } else if axis.factor == 1.0 {
        axis.column.clone()
    } else if axis.factor == -1.0 {
        format!("-{}", axis.column)
    } else {
        format!("{} x {}", axis.factor, axis.column)
    };
    match unit_of_column(&axis.column) {
        Some(unit) if unit != "1" => {
            let largest = values.iter().filter(|value| value.is_finite()).fold(0.0, |most: f64, v| most.max(v.abs()));
            let (prefix, size) = prefix(largest);
            (values.into_iter().map(|value| value / size).collect(), format!("{name} ({prefix}{unit})"))
        }
        _ => (values, name),
    }
}

/// The prefix of a unit that leaves the fewest zeros, and its size.
pub(crate) fn prefix(largest: f64) -> (&'static str, f64) {
    let prefixes = [("G", 1e9), ("M", 1e6), ("k", 1e3), ("", 1.0), ("m", 1e-3), ("\u{b5}", 1e-6), ("n", 1e-9)];
    prefixes.into_iter().find(|(_, size)| largest >= *size).unwrap_or(("", 1.0))
}

/// The same curve with fewer points: of each stretch the first point, the lowest and the highest.
pub(crate) fn thinned(points: Vec<(f64, f64)>, most: usize) -> Vec<(f64, f64)> {
    if points.len() <= most {
        return points;
    }
    let stretch = points.len().div_ceil(most / 3);
    let of_stretch = |stretch: &[(f64, f64)]| {
        let by_height = |a: &&usize, b: &&usize| stretch[**a].1.total_cmp(&stretch[**b].1);
        let places: Vec<usize> = (0..stretch.len()).collect();
        let extremes = [places.iter().min_by(by_height), places.iter().max_by(by_height)];
        let mut kept: Vec<usize> = extremes.into_iter().flatten().copied().chain([0]).collect();
        kept.sort_unstable();
        kept.dedup();
        kept.into_iter().map(|place| stretch[place]).collect::<Vec<_>>()
    };
    let last = points.last().copied();
    points.chunks(stretch).flat_map(of_stretch).chain(last).collect()
}

/// From the lowest to the highest value and a little more.
pub(crate) fn extent(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    let width = high - low;
    let margin = if width > 0.0 { 0.04 * width } else { 0.5 * high.abs().max(1.0) };
    low - margin..high + margin
}

/// A number at a grid line: as many digits as tell it from the next. What is far less than the length of the axis is 0 that
/// was not met.
pub(crate) fn label(value: f64, length: f64) -> String {
    let value = if value.abs() < 1e-9 * length { 0.0 } else { value };
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    match rounded.abs() {
        0.0 => "0".to_owned(),
        1e-3..1e6 => format!("{rounded}"),
        _ => format!("{rounded:e}"),
    }
}

/// The picture, or why there is none.
fn svg(points: &[(f64, f64)], against: &[(String, Vec<[f64; 2]>)], titles: [&str; 2]) -> Result<String, String> {
    if points.is_empty() {
        return Err("no row of the history has a number for both axes".to_owned());
    }
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
        let others = || against.iter().flat_map(|(_, points)| points).map(|&[x, y]| (x, y));
        let all = || points.iter().copied().chain(others());
        let extents = [extent(all().map(|point| point.0)), extent(all().map(|point| point.1))];
        // XML has no place for letters that a terminal would obey.
        let titles = titles.map(plain);
        let named = |(name, points): &(String, Vec<[f64; 2]>)| (plain(name).into_owned(), points.clone());
        let against: Vec<_> = against.iter().map(named).collect();
        paint(&area, points, &against, extents, [&titles[0], &titles[1]]).map_err(|error| error.to_string())?;
    }
    Ok(text)
}

type Painted<B> = Result<(), DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>>;

/// Grid, axes with titles, and the lines; a key if there are several.
fn paint<B: DrawingBackend>(
    area: &DrawingArea<B, plotters::coord::Shift>,
    points: &[(f64, f64)],
    against: &[(String, Vec<[f64; 2]>)],
    [x, y]: [Range<f64>; 2],
    [x_title, y_title]: [&str; 2],
) -> Painted<B> {
    const GRID: RGBColor = RGBColor(0xdd, 0xdd, 0xdd);
    const LINE: RGBColor = RGBColor(0x1f, 0x4e, 0x8c);
    const OTHERS: [RGBColor; 3] = [RGBColor(0xc0, 0x50, 0x1e), RGBColor(0x4c, 0x8a, 0x3a), RGBColor(0x7a, 0x4f, 0x9c)];
    area.fill(&WHITE)?;
    let [length, height] = [&x, &y].map(|axis| axis.end - axis.start);
    let mut chart = ChartBuilder::on(area)
        .margin(18)
        .margin_right(36)
        .x_label_area_size(60)
        .y_label_area_size(96)
        .build_cartesian_2d(x, y)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(GRID)
        .axis_style(BLACK)
        .x_labels(9)
        .y_labels(9)
        .x_label_formatter(&|value| label(*value, length))
        .y_label_formatter(&|value| label(*value, height))
        .label_style((FONT, 17))
        .axis_desc_style((FONT, 19))
        .x_desc(x_title)
        .y_desc(y_title)
        .draw()?;
    let shown =
        |colour: RGBColor| move |(x, y): (i32, i32)| PathElement::new([(x, y), (x + 24, y)], colour.stroke_width(2));
    let line = chart.draw_series(LineSeries::new(points.iter().copied(), LINE.stroke_width(2)))?;
    if against.is_empty() {
        return area.present();
    }
    line.label("computed").legend(shown(LINE));
    for ((name, points), colour) in against.iter().zip(OTHERS.into_iter().cycle()) {
        let points = points.iter().map(|&[x, y]| (x, y));
        let dashes = DashedLineSeries::new(points, 8, 5, colour.stroke_width(2));
        chart.draw_series(dashes)?.label(name).legend(shown(colour));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .margin(14)
        .legend_area_size(32)
        .background_style(WHITE)
        .border_style(GRID)
        .label_font((FONT, 17))
        .draw()?;
    area.present()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(column: &str, factor: f64, title: Option<&str>) -> Axis {
        Axis { column: column.into(), factor, offset: 0.0, title: title.map(Into::into) }
    }

    #[test]
    fn a_curve_has_its_axes_titles_and_points() {
        let folder = tempfile::tempdir().unwrap();
        let rows: Vec<String> = (0..50).map(|k| format!("{k},{k}e-6,{}\n", -3 * k * (60 - k))).collect();
        let rows = rows.concat();
        fs::write(folder.path().join(HISTORY), format!("step,grip_displacement_y,grip_force_y\n{rows}")).unwrap();
        let curve = Curve {
            name: "pull".into(),
            x: axis("grip_displacement_y", 1.0, None),
            y: axis("grip_force_y", -1.0, None),
            against: Vec::new(),
        };
        let path = draw(folder.path(), &curve).unwrap();
        assert_eq!(path.file_name().unwrap(), "curve-pull.svg");
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.starts_with("<svg") && text.trim_end().ends_with("</svg>"));
        assert!(text.contains("grip_displacement_y (\u{b5}m)") && text.contains("-grip_force_y (kN)"), "{text}");
        let line = text.split("<polyline").last().unwrap().split("points=\"").nth(1).unwrap();
        assert_eq!(line.split('"').next().unwrap().split_whitespace().count(), 50);
        let titled = Curve { y: axis("grip_force_y", -1e-3, Some("Force, kN")), ..curve.clone() };
        assert!(fs::read_to_string(draw(folder.path(), &titled).unwrap()).unwrap().contains("Force, kN"));
        let measured = Curve { against: vec![("measured".into(), vec![[0.0, 0.0], [5e-5, 3e3]])], ..curve.clone() };
        let text = fs::read_to_string(draw(folder.path(), &measured).unwrap()).unwrap();
        assert!(text.contains("measured") && text.contains("computed"), "a key tells them apart");
        let missing = Curve { x: axis("time", 1.0, None), ..curve };
        assert!(matches!(draw(folder.path(), &missing), Err(Error::NoColumn { .. })));
    }

    #[test]
    fn what_does_not_change_and_what_is_not_there() {
        let level = svg(&[(0.0, 2.0), (1.0, 2.0)], &[], ["a", "b"]).unwrap();
        assert!(level.contains("polyline"));
        assert!(svg(&[], &[], ["a", "b"]).is_err());
    }

    #[test]
    fn a_long_curve_keeps_its_extremes() {
        let points: Vec<(f64, f64)> =
            (0..100_000).map(|k| (f64::from(k), if k == 77_777 { 9.0 } else { f64::from(k % 7) })).collect();
        let kept = thinned(points.clone(), MOST_POINTS);
        assert!(kept.len() <= MOST_POINTS + 1 && kept.contains(&(77_777.0, 9.0)));
        assert_eq!((kept[0], kept.last()), (points[0], points.last()));
        assert!(kept.is_sorted_by(|a, b| a.0 <= b.0));
    }

    #[test]
    fn labels_are_short() {
        let shown = [0.0, 0.300_000_000_000_000_04, -1250.0, 2.5e-7, 3e9].map(|value| label(value, 1.0));
        assert_eq!(shown, ["0", "0.3", "-1250", "2.5e-7", "3e9"]);
        assert_eq!([6.8e-21, -5e-5].map(|value| label(value, 2e-4)), ["0", "-5e-5"]);
        assert_eq!([3e4, 0.5, 2e-5, 0.0].map(|largest| prefix(largest).0), ["k", "m", "\u{b5}", ""]);
    }
}
