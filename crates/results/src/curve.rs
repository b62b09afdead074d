//! A curve of two columns of the history, as a picture in the folder of the run.

use crate::axis::{Ticks, extent, prefix};
use crate::error::{Action, Context, Error};
use crate::files::atomically;
use crate::glossary::unit_of_column;
use crate::run_directory::HISTORY;
use crate::words::{escape, plain};
use std::fmt::Write;
use std::fs;
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

/// The numbers of a column of a run's history, one for each row; NaN where a row is cut off.
///
/// # Errors
/// [`Error::NoColumn`], and whatever the file system says.
pub fn history_column(run: &Path, name: &str) -> Result<Vec<f64>, Error> {
    let path = run.join(HISTORY);
    let text = fs::read_to_string(&path).context(Action::Read, &path)?;
    column(&text, name).ok_or(Error::NoColumn { column: name.to_owned(), path })
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

/// Pixels of the picture, and of what surrounds the axes.
const SIZE: [f64; 2] = [960.0, 640.0];
const LEFT: f64 = 112.0;
const RIGHT: f64 = 36.0;
const TOP: f64 = 18.0;
const BOTTOM: f64 = 78.0;
const LINE: &str = "#1f4e8c";
const OTHERS: [&str; 3] = ["#c0501e", "#4c8a3a", "#7a4f9c"];
const MINUS: char = '\u{2212}';

/// The picture, or why there is none. Places are given to a hundredth of a pixel, so that lines have no stairs.
fn svg(points: &[(f64, f64)], against: &[(String, Vec<[f64; 2]>)], titles: [&str; 2]) -> Result<String, String> {
    if points.is_empty() {
        return Err("no row of the history has a number for both axes".to_owned());
    }
    // XML has no place for letters that a terminal would obey.
    let titles = titles.map(plain);
    let titles = [&*titles[0], &*titles[1]];
    let named = |(name, points): &(String, Vec<[f64; 2]>)| (plain(name).into_owned(), points.clone());
    let against: Vec<_> = against.iter().map(named).collect();
    let all = || points.iter().copied().chain(against.iter().flat_map(|(_, points)| points).map(|&[x, y]| (x, y)));
    let [x, y] = [extent(all().map(|point| point.0)), extent(all().map(|point| point.1))];
    let (right, bottom) = (SIZE[0] - RIGHT, SIZE[1] - BOTTOM);
    let across = |value: f64| LEFT + (value - x.start) / (x.end - x.start) * (right - LEFT);
    let down = |value: f64| bottom - (value - y.start) / (y.end - y.start) * (bottom - TOP);
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" \
         font-family=\"sans-serif\" font-size=\"17\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"#fff\"/>\n",
        SIZE[0], SIZE[1]
    );
    axes(&mut text, [Ticks::between(x.start, x.end, 9), Ticks::between(y.start, y.end, 9)], titles, (&across, &down));

    let line = |text: &mut String, points: &mut dyn Iterator<Item = (f64, f64)>, style: &str| {
        let points: Vec<String> = points.map(|(x, y)| format!("{:.2},{:.2}", across(x), down(y))).collect();
        let _ = writeln!(
            text,
            "<polyline fill=\"none\" stroke-width=\"2\" stroke-linejoin=\"round\" {style} points=\"{}\"/>",
            points.join(" ")
        );
    };
    let mut keys = vec![("computed", format!("stroke=\"{LINE}\""))];
    line(&mut text, &mut points.iter().copied(), &keys[0].1);
    for ((name, points), colour) in against.iter().zip(OTHERS.into_iter().cycle()) {
        let style = format!("stroke=\"{colour}\" stroke-dasharray=\"8 5\"");
        line(&mut text, &mut points.iter().map(|&[x, y]| (x, y)), &style);
        keys.push((name, style));
    }
    if keys.len() > 1 {
        key(&mut text, &keys);
    }
    Ok(text + "</svg>\n")
}

/// Grid, ticks with labels, and titles.
fn axes(
    text: &mut String,
    [x, y]: [Ticks; 2],
    titles: [&str; 2],
    (across, down): (&dyn Fn(f64) -> f64, &dyn Fn(f64) -> f64),
) {
    let (right, bottom) = (SIZE[0] - RIGHT, SIZE[1] - BOTTOM);
    let said = |ticks: &Ticks, value: f64| ticks.label(value).replace('-', &MINUS.to_string());
    let mut grid = String::new();
    let mut labels = String::new();
    for &value in &x.values {
        let at = across(value);
        let _ = write!(grid, "M{at:.2} {TOP}V{bottom}");
        let label = said(&x, value);
        let _ = writeln!(labels, "<text x=\"{at:.2}\" y=\"{}\" text-anchor=\"middle\">{label}</text>", bottom + 24.0);
    }
    for &value in &y.values {
        let at = down(value);
        let _ = write!(grid, "M{LEFT} {at:.2}H{right}");
        let label = said(&y, value);
        let (left, at) = (LEFT - 9.0, at + 6.0);
        let _ = writeln!(labels, "<text x=\"{left}\" y=\"{at:.2}\" text-anchor=\"end\">{label}</text>");
    }
    let _ = writeln!(text, "<path fill=\"none\" stroke=\"#ddd\" d=\"{grid}\"/>");
    let _ = writeln!(text, "<path fill=\"none\" stroke=\"#000\" d=\"M{LEFT} {TOP}V{bottom}H{right}\"/>\n{labels}");
    let [x_title, y_title] = titles.map(escape);
    let _ = writeln!(
        text,
        "<text x=\"{}\" y=\"{}\" font-size=\"19\" text-anchor=\"middle\">{x_title}</text>",
        0.5 * (LEFT + right),
        SIZE[1] - 18.0
    );
    let _ = writeln!(
        text,
        "<text transform=\"translate(26 {}) rotate(-90)\" font-size=\"19\" text-anchor=\"middle\">{y_title}</text>",
        0.5 * (TOP + bottom)
    );
}

/// What each line is.
fn key(text: &mut String, keys: &[(&str, String)]) {
    const ROW: f64 = 24.0;
    let (left, top) = (LEFT + 14.0, TOP + 14.0);
    let longest = keys.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    let (width, height) = (64.0 + 9.5 * longest as f64, 14.0 + ROW * keys.len() as f64);
    let _ = writeln!(
        text,
        "<rect x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" fill=\"#fff\" stroke=\"#ddd\"/>"
    );
    for (place, (name, style)) in keys.iter().enumerate() {
        let y = top + 20.0 + ROW * place as f64;
        let (from, to, words) = (left + 12.0, left + 40.0, left + 50.0);
        let _ = writeln!(text, "<path d=\"M{from} {y}H{to}\" stroke-width=\"2\" {style}/>");
        let _ = writeln!(text, "<text x=\"{words}\" y=\"{}\">{}</text>", y + 6.0, escape(name));
    }
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
    fn a_shallow_curve_has_no_stairs() {
        // Over a hundred points it rises by a pixel; whole pixels would leave one step.
        let points: Vec<(f64, f64)> =
            (0..=1000).map(|k| (f64::from(k), if k == 1000 { 600.0 } else { 0.01 * f64::from(k) })).collect();
        let text = svg(&points, &[], ["a", "b"]).unwrap();
        let line = text.split("points=\"").nth(1).unwrap().split('"').next().unwrap();
        let heights: Vec<f64> =
            line.split(' ').take(900).map(|point| point.split_once(',').unwrap().1.parse().unwrap()).collect();
        assert!(heights.chunks(4).all(|stretch| stretch[0] > stretch[stretch.len() - 1]), "it rises all the way");
    }
}
