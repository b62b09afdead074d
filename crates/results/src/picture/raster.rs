//! Spheres and lines on a grid of pixels, nearer ones before farther ones.

use super::camera::Image;
use super::shaded::{Pixel, Shaded, brightness, byte};
use rayon::prelude::*;

/// A sphere in the picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Disc {
    pub(super) image: Image,
    /// Pixels.
    pub(super) radius: f64,
    /// Radius of the sphere, m: how far it bulges towards the camera.
    pub(super) thickness: f64,
    /// Shade of its value.
    pub(super) shade: u16,
}

/// Rows that one thread draws at a time. Fixed, as is the order of spheres within: the same picture on any machine.
const BAND: usize = 32;

/// Samples and their depths.
pub(super) struct Canvas {
    columns: usize,
    rows: usize,
    samples: Vec<Sample>,
    depths: Vec<f32>,
}

/// What is to be seen at a point.
#[derive(Clone, Copy)]
enum Sample {
    Nothing,
    Line,
    Sphere { shade: u16, bright: f32, gloss: f32 },
}

impl Canvas {
    pub(super) fn new(columns: usize, rows: usize) -> Self {
        let count = columns * rows;
        Canvas { columns, rows, samples: vec![Sample::Nothing; count], depths: vec![f32::INFINITY; count] }
    }

    /// Draws spheres as shaded discs that bulge towards the camera.
    pub(super) fn draw_discs(&mut self, discs: &[Disc]) {
        let bands = self.bands(discs);
        let size = BAND * self.columns;
        let strips = self.samples.par_chunks_mut(size).zip(self.depths.par_chunks_mut(size));
        strips.zip(&bands).enumerate().for_each(|(number, ((samples, depths), members))| {
            let mut strip = Strip { top: number * BAND, columns: self.columns, samples, depths };
            strip.draw(discs, members);
        });
    }

    /// Which discs each band shows.
    fn bands(&self, discs: &[Disc]) -> Vec<Vec<u32>> {
        let mut bands = vec![Vec::new(); self.rows.div_ceil(BAND)];
        for (number, Disc { image, radius, .. }) in discs.iter().enumerate() {
            let beside = image.x + radius < 0.0 || image.x - radius >= self.columns as f64;
            let (top, bottom) = (image.y - radius, image.y + radius);
            if !beside && bottom >= 0.0 && top < self.rows as f64 {
                // Casts saturate at 0 above the picture.
                let last = (bottom as usize).min(self.rows - 1) / BAND;
                bands[top as usize / BAND..=last].iter_mut().for_each(|band| band.push(number as u32));
            }
        }
        bands
    }

    /// Draws a thin line where nothing is nearer.
    pub(super) fn draw_line(&mut self, from: Image, to: Image) {
        let (dx, dy) = (to.x - from.x, to.y - from.y);
        let span = dx.abs().max(dy.abs()).ceil().clamp(1.0, 8.0 * (self.columns + self.rows) as f64);
        for mark in 0..=span as usize {
            let share = mark as f64 / span;
            let (x, y) = (from.x + share * dx, from.y + share * dy);
            if x < 0.0 || y < 0.0 || x >= self.columns as f64 || y >= self.rows as f64 {
                continue;
            }
            // In perspective the inverse of the depth changes evenly along a line.
            let depth = 1.0 / ((1.0 - share) / from.depth + share / to.depth);
            let place = y as usize * self.columns + x as usize;
            if (depth as f32) < self.depths[place] {
                self.samples[place] = Sample::Line;
            }
        }
    }

    /// The picture with each pixel the mean of `scale * scale` samples; its value is that of the nearest of them.
    pub(super) fn reduced(&self, scale: usize, extent: [f64; 2]) -> Shaded {
        let (columns, rows) = (self.columns / scale, self.rows / scale);
        let pixels =
            (0..columns * rows).into_par_iter().map(|place| self.pixel([place % columns, place / columns], scale));
        Shaded { columns, rows, pixels: pixels.collect(), extent }
    }

    fn pixel(&self, [column, row]: [usize; 2], scale: usize) -> Pixel {
        let (mut spheres, mut lines, mut nearest) = (0_u32, 0_u32, f32::INFINITY);
        let (mut value, mut light, mut shine) = (0, 0.0, 0.0);
        for k in 0..scale * scale {
            let place = (row * scale + k / scale) * self.columns + column * scale + k % scale;
            match self.samples[place] {
                Sample::Nothing => {}
                Sample::Line => lines += 1,
                Sample::Sphere { shade, bright, gloss } => {
                    spheres += 1;
                    light += bright;
                    shine += gloss;
                    if self.depths[place] < nearest {
                        (nearest, value) = (self.depths[place], shade);
                    }
                }
            }
        }
        let all = (scale * scale) as f32;
        let of_spheres = spheres.max(1) as f32;
        Pixel {
            value,
            bright: brightness(light / of_spheres),
            gloss: byte(shine / of_spheres),
            // Lines are laid over spheres, so that of what they leave spheres cover the more.
            cover: byte(spheres as f32 / (all - lines as f32).max(1.0)),
            line: byte(lines as f32 / all),
        }
    }
}

/// Some rows of a picture.
struct Strip<'a> {
    top: usize,
    columns: usize,
    samples: &'a mut [Sample],
    depths: &'a mut [f32],
}

impl Strip<'_> {
    fn draw(&mut self, discs: &[Disc], members: &[u32]) {
        const NOBODY: u32 = u32::MAX;
        let mut nearest = vec![NOBODY; self.samples.len()];
        for &member in members {
            self.cover(&discs[member as usize], member, &mut nearest);
        }
        for (place, &member) in nearest.iter().enumerate().filter(|&(_, &member)| member != NOBODY) {
            let disc = &discs[member as usize];
            let [x, y] = self.offset(place, disc);
            let [bright, gloss] = lit([x as f32, y as f32]);
            self.samples[place] = Sample::Sphere { shade: disc.shade, bright, gloss };
        }
    }

    /// Offset of the middle of a pixel from the middle of a disc, as shares of its radius, y upwards.
    fn offset(&self, place: usize, disc: &Disc) -> [f64; 2] {
        let (column, row) = (place % self.columns, self.top + place / self.columns);
        let x = column as f64 + 0.5 - disc.image.x;
        let y = row as f64 + 0.5 - disc.image.y;
        [x / disc.radius, -y / disc.radius]
    }

    fn cover(&mut self, disc: &Disc, member: u32, nearest: &mut [u32]) {
        let Disc { image, radius, thickness, .. } = *disc;
        let rows = self.samples.len() / self.columns;
        let first = (image.y - radius).max(self.top as f64) as usize - self.top;
        let last = ((image.y + radius) as usize).min(self.top + rows - 1);
        for row in first..=last.saturating_sub(self.top) {
            let down = (self.top + row) as f64 + 0.5 - image.y;
            let half = radius * radius - down * down;
            if half <= 0.0 {
                continue;
            }
            let half = half.sqrt();
            let left = (image.x - half).max(0.0) as usize;
            let right = (image.x + half + 1.0).clamp(0.0, self.columns as f64) as usize;
            for place in row * self.columns + left..row * self.columns + right {
                let [x, y] = self.offset(place, disc);
                let bulge = 1.0 - x * x - y * y;
                if bulge > 0.0 {
                    let depth = (image.depth - thickness * bulge.sqrt()) as f32;
                    if depth < self.depths[place] {
                        self.depths[place] = depth;
                        nearest[place] = member;
                    }
                }
            }
        }
    }
}

/// Brightness and highlight of a sphere: light from the upper left behind the camera, a darker rim.
fn lit([x, y]: [f32; 2]) -> [f32; 2] {
    const LIGHT: [f32; 3] = [-0.396, 0.594, 0.700];
    // Half-way between the light and the eye.
    const HALF: [f32; 3] = [-0.215, 0.322, 0.922];
    let z = (1.0 - x * x - y * y).max(0.0).sqrt();
    let along = |direction: [f32; 3]| (direction[0] * x + direction[1] * y + direction[2] * z).max(0.0);
    let brightness = (0.42 + 0.72 * along(LIGHT)) * (0.45 + 0.55 * z.sqrt());
    [brightness, 0.22 * along(HALF).powi(40)]
}
