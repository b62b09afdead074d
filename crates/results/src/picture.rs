//! A quick look at a state: shaded spheres as pixels, drawn by the CPU, without a GPU and without fonts.
//!
//! A million spheres take a second or two.

mod bar;
mod camera;
mod colour;
mod memory;
mod raster;
mod series;
mod sheet;
mod text;

pub use colour::{Colour, Shade};
pub use series::{Series, file_of};
pub(crate) use series::{Stored, keep, list};

use crate::blocks::Scene;
use crate::error::Error;
use bar::Bar;
use camera::Camera;
use raster::{Canvas, Disc};
use rayon::prelude::*;
use sheet::Sheet;
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
    /// Values at the two ends of the colours; `None` takes the smallest and the largest.
    pub range: Option<[f64; 2]>,
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
            clip: None,
            walls: true,
            bar: true,
            smooth: true,
        }
    }
}

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
    let Options { width, height, colour, .. } = *options;
    let needed = memory_for(options, state.len());
    if !(1..=LARGEST).contains(&width) || !(1..=LARGEST).contains(&height) {
        return Err(Error::PictureSize { width, height, needed });
    }
    if let Some(free) = memory::free().filter(|&free| needed > free) {
        return Err(Error::PictureMemory { width, height, needed, free });
    }
    let (columns, rows) = (width as usize, height as usize);
    let beside = if options.bar { Bar::width(columns, rows) } else { 0 };
    let values = colour.values(state, plan);
    let range = options.range.unwrap_or_else(|| colour.range_of(&values));

    let scene = draw(state, plan, options, [columns - beside, rows], &colour::shades(&values, range));
    let time = plan.heat.as_ref().map_or_else(|| plan.time(state.step), |_| plan.heat_time(state.step));
    let pixels = if beside == 0 {
        scene
    } else {
        let mut pixels = vec![255; 3 * columns * rows];
        let mut sheet = Sheet { columns, pixels: &mut pixels };
        sheet.paste(&scene, columns - beside);
        let bar = Bar { colour, range, caption: format!("t={}s", bar::number(time)) };
        bar.draw(&mut sheet, rows, columns - beside);
        pixels
    };
    let told = [
        ("step", state.step.to_string()),
        ("time", time.to_string()),
        ("field", colour.name().to_owned()),
        ("low", range[0].to_string()),
        ("high", range[1].to_string()),
    ];
    compress(&pixels, [width, height], told).map_err(|source| Error::Picture { source: source.into() })
}

/// Spheres and walls as bytes, without what stands beside them.
fn draw(state: &State, plan: &Plan, options: &Options, [columns, rows]: [usize; 2], shades: &[Shade]) -> Vec<u8> {
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
            Some(Disc { image, radius, thickness: state.radius[index], shade: shades[index] })
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
    canvas.reduced(scale)
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

fn compress(
    pixels: &[u8],
    [width, height]: [u32; 2],
    told: [(&str, String); 5],
) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    for (name, value) in told {
        encoder.add_text_chunk(name.to_owned(), value)?;
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(bytes)
}
