//! A quick look at a state: shaded spheres as pixels, drawn by the CPU, without a GPU and without fonts.
//!
//! A million spheres take a second or two.

mod camera;
mod colour;
mod raster;

pub use colour::{Colour, Shade};

use crate::blocks::Scene;
use crate::error::Error;
use camera::Camera;
use raster::{Canvas, Disc};
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
    /// Whether the outlines of walls are drawn.
    pub walls: bool,
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
            walls: true,
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

/// Draws a state, as the bytes of a PNG file.
///
/// # Errors
/// [`Error::PictureSize`], or [`Error::Picture`] from the compressor.
pub fn render(state: &State, plan: &Plan, options: &Options) -> Result<Vec<u8>, Error> {
    let Options { width, height, .. } = *options;
    if !(1..=LARGEST).contains(&width) || !(1..=LARGEST).contains(&height) {
        return Err(Error::PictureSize { width, height });
    }
    let scale = if options.smooth { 2 } else { 1 };
    let (columns, rows) = (width as usize * scale, height as usize * scale);

    let [low, high] = subject(state, plan, options.subject);
    let camera = Camera::looking_at(low, high, options.direction, options.view_angle_deg, [columns, rows]);
    let shades = options.colour.shades(state, plan, options.range);
    let discs: Vec<Disc> = (0..state.len())
        .filter_map(|index| {
            let image = camera.project(state.position[index])?;
            let radius = camera.size_at(image.depth, state.radius[index]);
            Some(Disc { image, radius, thickness: state.radius[index], shade: shades[index] })
        })
        .collect();

    let mut canvas = Canvas::new(columns, rows);
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
    compress(&canvas.reduced(scale), width, height).map_err(|source| Error::Picture { source: source.into() })
}

/// More pixels than anybody looks at, few enough for the memory of a small computer.
const LARGEST: u32 = 16_384;

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

fn compress(pixels: &[u8], width: u32, height: u32) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(bytes)
}
