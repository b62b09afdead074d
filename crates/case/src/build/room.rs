//! Room for particles: memory, ids, and space in a region.

use super::{Context, Memory};
use crate::codes;
use crate::limits::StepLimits;
use crate::problem::{Problem, number};
use crate::schema::{Radius, Random, Region, SizeDistribution};
use std::f64::consts::PI;

/// More particles than any machine holds, and fewer than there are ids: a slip in a length is found before it fills the
/// memory.
const MOST_PARTICLES: u64 = 1 << 28;

/// Volume fraction at which random sequential addition of equal spheres ends: no place is left in an infinite region.
/// Zhang & Torquato, Phys. Rev. E 88 (2013) 053312: 0.38413.
const SATURATION: f64 = 0.384_13;

impl Context<'_> {
    /// Whether so many particles can be had; `group` has the last of them.
    pub(super) fn room_for(&self, group: usize, count: f64) -> Result<(), Problem> {
        let too_many = count > MOST_PARTICLES as f64;
        let bytes = count * self.bytes_each();
        let limit = match self.memory {
            _ if too_many => format!("at most {MOST_PARTICLES} are possible"),
            Some(memory) if bytes > memory as f64 => format!("this machine has {}", gigabytes(memory as f64)),
            _ => return Ok(()),
        };
        let code = if too_many { codes::TOO_MANY_PARTICLES } else { codes::TOO_LITTLE_MEMORY };
        let message = format!(
            "these would be {} particles, which take at least {} of memory; {limit}",
            number(count),
            gigabytes(bytes)
        );
        Err(Problem::new(code, message)
            .at(self.place(group, &[]), "too many")
            .help("check the radius and the extent of the region; lengths are in metres"))
    }

    /// What a particle takes at least during a run, bytes: one copy of the state and the arrays of the CPU, without bonds.
    fn bytes_each(&self) -> f64 {
        let limits = StepLimits { step: 1.0, auto: false, safety: 1.0, limits: Vec::new() };
        let plan = self.plan(&limits, Vec::new(), Vec::new(), 1.0);
        Memory::least(&plan) as f64
    }

    /// Whether the spheres of a random group can find places at all, before any is drawn.
    pub(super) fn space_for(&self, group: usize, spec: &Random, region: &Region) -> Result<(), Problem> {
        let [smallest, largest] = spec.radius.bounds();
        let room = volume(region);
        let mean = mean_volume(spec.radius);
        let (count, wanted) = match (spec.count, spec.volume_fraction) {
            (Some(count), _) => (f64::from(count), f64::from(count) * mean / room),
            (None, Some(fraction)) => (fraction.get() * room / mean, fraction.get()),
            (None, None) => return Ok(()),
        };
        // Small spheres find places between large ones: at most as if each size saw the others as a continuum.
        let saturation = if smallest == largest { SATURATION } else { 1.0 - (1.0 - SATURATION) * (1.0 - SATURATION) };
        // The number that finds a place scatters by about a fifth of its root, and radii that are drawn scatter too.
        let scatter = 0.3 + if smallest == largest { 0.0 } else { 4.0 * sphere_volume(largest) / mean };
        if wanted <= saturation + scatter / count.max(1.0).sqrt() {
            return Ok(());
        }
        let key = if spec.count.is_some() { "count" } else { "volume_fraction" };
        let message = format!(
            "these {} spheres would fill {} of the region's volume, but random places run out at {}",
            number(count.floor()),
            number(wanted),
            number((saturation * 1e3).round() * 1e-3)
        );
        Err(Problem::new(codes::NO_ROOM, message)
            .at(self.place(group, &["random", key]), "too many")
            .help("take fewer, a larger region, or a lattice; then let them settle"))
    }
}

/// Mean volume of the spheres of a distribution, m³.
fn mean_volume(radius: Radius) -> f64 {
    let [low, high] = radius.bounds();
    if low == high {
        return sphere_volume(low);
    }
    let distribution = match radius {
        Radius::Equal(_) => SizeDistribution::Number,
        Radius::Range(range) => range.distribution,
    };
    let mean_cube = match distribution {
        SizeDistribution::Number => 0.25 * (low + high) * (low * low + high * high),
        // The density of radii falls with their cube.
        SizeDistribution::Volume => 2.0 * low * low * high * high / (low + high),
    };
    4.0 / 3.0 * PI * mean_cube
}

/// m³.
pub(super) fn volume(region: &Region) -> f64 {
    (0..3).map(|k| region.max[k] - region.min[k]).product()
}

/// m³.
pub(super) fn sphere_volume(radius: f64) -> f64 {
    4.0 / 3.0 * PI * (radius * radius * radius)
}

fn gigabytes(bytes: f64) -> String {
    format!("{} GB", number((bytes * 1e-8).round() * 0.1))
}
