//! A quick look at a state: shaded spheres as pixels, drawn by the CPU, without a GPU and without fonts of the system.
//!
//! A million spheres take a second or two.

mod bar;
mod camera;
mod colour;
mod memory;
mod palette;
mod raster;
mod series;
mod shaded;
mod sheet;
mod text;

pub use colour::Colour;
pub use palette::{Background, ColourMap};
pub use series::{Series, file_of};
pub(crate) use series::{Stored, keep, list, unify};
pub(crate) use shaded::without_values;

use crate::blocks::Scene;
use crate::error::Error;
use bar::Bar;
use camera::Camera;
use raster::{Canvas, Disc};
use rayon::prelude::*;
use shaded::Shaded;
use sheet::Sheet;
use std::io::Cursor;
use tdem_engine::{Plan, State};

/// What a picture looks like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Where the camera stands, seen from what it looks at; its length does not matter.
    pub direction: [f64; 3],
    /// Angle of view from top to bottom, degrees.
    pub view_angle_deg: f64,
    /// What fills the picture.
    pub subject: Subject,
    /// What colours mean.
    pub colour: Colour,
    /// Values at the two ends of the colours, SI; `None` takes the smallest and the largest: of all pictures, in a series.
    pub range: Option<[f64; 2]>,
    /// Which colours; `None` takes those of what they mean.
    pub map: Option<ColourMap>,
    /// What lies behind.
    pub background: Background,
    /// Scale of temperatures beside the bar.
    pub scale: Scale,
    /// What is cut away.
    pub clip: Option<Clip>,
    /// Whether the outlines of walls are drawn.
    pub walls: bool,
    /// Whether a bar beside the picture tells values and time; a picture that is too small for it has none.
    pub bar: bool,
    /// Smooth edges, at four times the work.
    pub smooth: bool,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            width: 1200,
            height: 900,
            direction: [1.0, -1.7, 0.9],
            view_angle_deg: 25.0,
            subject: Subject::Domain,
            colour: Colour::Speed,
            range: None,
            map: None,
            background: Background::White,
            scale: Scale::Kelvin,
            clip: None,
            walls: true,
            bar: true,
            smooth: true,
        }
    }
}

/// Scale of temperatures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// K.
    #[default]
    Kelvin,
    /// °C.
    Celsius,
}

/// Zero of the scale of Celsius, K.
const CELSIUS: f64 = 273.15;

/// What fills a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// The domain: all pictures of a run show it from the same place.
    Domain,
    /// The particles, wherever they are.
    Particles,
}

/// A plane that cuts particles away to show what lies behind them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clip {
    /// A point of the plane, m.
    pub point: [f64; 3],
    /// Towards what is left out; its length does not matter.
    pub normal: [f64; 3],
}

impl Clip {
    /// Whether a particle stays: its centre lies in the plane or behind it.
    #[must_use]
    pub fn keeps(&self, centre: [f64; 3]) -> bool {
        (0..3).map(|k| (centre[k] - self.point[k]) * self.normal[k]).sum::<f64>() <= 0.0
    }
}

/// Draws a state, as the bytes of a PNG file. Its text chunks tell `step`, `time` (s), `field`, `low` and `high`.
///
/// # Errors
/// [`Error::PictureSize`] and [`Error::PictureMemory`] before anything is drawn, or [`Error::Picture`] from the compressor.
pub fn render(state: &State, plan: &Plan, options: &Options) -> Result<Vec<u8>, Error> {
    let drawing = Drawing::of(state, plan, options)?;
    drawing.png(options, drawing.shaded.extent, false)
}

/// When a picture is of.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Stamp {
    step: u64,
    /// Of the heat, if there is some, s.
    time: f64,
    /// The longest time of a series, s.
    longest: Option<f64>,
}

/// A picture that can be coloured in any range.
struct Drawing {
    shaded: Shaded,
    stamp: Stamp,
}

impl Drawing {
    fn of(state: &State, plan: &Plan, options: &Options) -> Result<Self, Error> {
        let Options { width, height, colour, .. } = *options;
        let needed = memory_for(options, state.len());
        if !(1..=LARGEST).contains(&width) || !(1..=LARGEST).contains(&height) {
            return Err(Error::PictureSize { width, height, needed });
        }
        if let Some(free) = memory::free().filter(|&free| needed > free) {
            return Err(Error::PictureMemory { width, height, needed, free });
        }
        let values = colour.values(state, plan);
        let extent = options.range.unwrap_or_else(|| colour.extent(&values));
        let size = [width as usize - beside(options), height as usize];
        let time = plan.heat.as_ref().map_or_else(|| plan.time(state.step), |_| plan.heat_time(state.step));
        let stamp = Stamp { step: state.step, time, longest: None };
        Ok(Drawing { shaded: draw(state, plan, options, size, (&values, extent)), stamp })
    }

    /// The picture in colours for values of an extent.
    fn png(&self, options: &Options, extent: [f64; 2], with_values: bool) -> Result<Vec<u8>, Error> {
        let Options { width, height, colour, background, scale, .. } = *options;
        let map = options.map.unwrap_or(colour.map());
        let range = options.range.unwrap_or_else(|| colour.range(extent, map));
        let mut sheet = Sheet::new([width as usize, height as usize], background.fill());
        self.shaded.paint(&mut sheet, map, background, range);
        if beside(options) > 0 {
            let bar = Bar { colour, map, background, scale, range, stamp: self.stamp };
            bar.draw(&mut sheet, self.shaded.columns);
        }
        let told = [
            ("step", self.stamp.step.to_string()),
            ("time", self.stamp.time.to_string()),
            ("field", colour.name().to_owned()),
            ("low", range[0].to_string()),
            ("high", range[1].to_string()),
        ];
        let values = if with_values { Some(&self.shaded) } else { None };
        let alpha = background == Background::Transparent;
        compress(&sheet, alpha, told, values).map_err(|source| Error::Picture { source: source.into() })
    }
}

/// Pixels across that the bar takes.
fn beside(options: &Options) -> usize {
    if options.bar { Bar::width(options.width as usize, options.height as usize) } else { 0 }
}

/// Spheres and walls, without what stands beside them.
fn draw(
    state: &State,
    plan: &Plan,
    options: &Options,
    [columns, rows]: [usize; 2],
    (values, extent): (&[f64], [f64; 2]),
) -> Shaded {
    let scale = if options.smooth { 2 } else { 1 };
    let size = [columns * scale, rows * scale];
    let [low, high] = subject(state, plan, options.subject);
    let camera = Camera::looking_at(low, high, options.direction, options.view_angle_deg, size);
    let discs: Vec<Disc> = (0..state.len())
        .into_par_iter()
        .filter(|&index| options.clip.is_none_or(|clip| clip.keeps(state.position[index])))
        .filter_map(|index| {
            let image = camera.project(state.position[index])?;
            let radius = camera.size_at(image.depth, state.radius[index]);
            Some(Disc { image, radius, thickness: state.radius[index], shade: shaded::shade(values[index], extent) })
        })
        .collect();

    let mut canvas = Canvas::new(size[0], size[1]);
    canvas.draw_discs(&discs);
    if options.walls {
        for corners in (Scene { state, plan, start: None }).wall_polygons() {
            let ends = corners.iter().zip(corners.iter().cycle().skip(1));
            for (&from, &to) in ends {
                if let (Some(from), Some(to)) = (camera.project(from), camera.project(to)) {
                    canvas.draw_line(from, to);
                }
            }
        }
    }
    canvas.reduced(scale, extent)
}

/// More pixels than anybody looks at.
const LARGEST: u32 = 16_384;

/// Bytes that a picture takes while it is drawn, about: pixels, depths and who is nearest, at four times the number for smooth
/// edges; the picture without and with its bar, and compressed; what is drawn of each particle.
fn memory_for(options: &Options, particles: usize) -> u64 {
    const PER_PIXEL: u64 = 3 + 4 + 2;
    const FINISHED: u64 = 3 * 3;
    let pixels = u64::from(options.width) * u64::from(options.height);
    let drawn = if options.smooth { 4 } else { 1 };
    pixels.saturating_mul(drawn * PER_PIXEL + FINISHED).saturating_add(particles as u64 * size_of::<Disc>() as u64)
}

/// The box that fills the picture.
fn subject(state: &State, plan: &Plan, subject: Subject) -> [[f64; 3]; 2] {
    let domain = [plan.domain.min, plan.domain.max];
    if subject == Subject::Domain || state.is_empty() {
        return domain;
    }
    let edge = |towards: f64, pick: fn(f64, f64) -> f64| {
        let corner = |index: usize, k: usize| state.position[index][k] + towards * state.radius[index];
        std::array::from_fn(|k| (1..state.len()).fold(corner(0, k), |edge, index| pick(edge, corner(index, k))))
    };
    [edge(-1.0, f64::min), edge(1.0, f64::max)]
}

/// What a text chunk of a PNG file tells.
pub(crate) fn told(picture: &[u8], key: &str) -> Option<String> {
    let reader = png::Decoder::new(Cursor::new(picture)).read_info().ok()?;
    let chunks = reader.info().uncompressed_latin1_text.iter();
    chunks.filter(|chunk| chunk.keyword == key).map(|chunk| chunk.text.clone()).next()
}

fn compress(
    sheet: &Sheet,
    alpha: bool,
    told: [(&str, String); 5],
    values: Option<&Shaded>,
) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, sheet.columns as u32, sheet.rows as u32);
    encoder.set_color(if alpha { png::ColorType::Rgba } else { png::ColorType::Rgb });
    for (name, value) in told {
        encoder.add_text_chunk(name.to_owned(), value)?;
    }
    let mut writer = encoder.write_header()?;
    if let Some(values) = values {
        writer.write_chunk(png::chunk::ChunkType(shaded::CHUNK), &values.pack()?)?;
    }
    writer.write_image_data(&sheet.bytes(alpha))?;
    writer.finish()?;
    Ok(bytes)
}
