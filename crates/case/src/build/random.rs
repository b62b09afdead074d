//! Spheres at random places, without overlap, one after the other.

use super::Context;
use super::draft::{Draft, Spheres};
use super::room::{sphere_volume, volume};
use crate::codes;
use crate::grid::Grid;
use crate::problem::{Problem, number};
use crate::rng::{Stream, uniform4};
use crate::schema::{Radius, Random, Region, SizeDistribution};
use tdem_engine::physics::Vec3;

pub(super) fn place(context: &Context<'_>, draft: &Draft, group: usize, spec: &Random) -> Result<Spheres, Problem> {
    let region = context.region(spec.min, spec.max);
    context.space_for(group, spec, &region)?;
    if let Some(count) = spec.count {
        context.room_for(group, f64::from(count))?;
    }
    let radius = radii(context, group, spec, &region)?;
    // The largest first, while there is room; the order among equals is that of the index.
    let mut order: Vec<usize> = (0..radius.len()).collect();
    order.sort_by(|&a, &b| radius[b].total_cmp(&radius[a]));

    let mut insertion = Insertion::new(context, draft, &radius, region);
    let mut position = vec![[0.0; 3]; radius.len()];
    for (placed, &k) in order.iter().enumerate() {
        let free = (0..spec.attempts).find_map(|attempt| {
            let draw = uniform4(context.loaded.case.seed, Stream::Position, group as u32, k as u32, attempt);
            let centre = insertion.candidate(radius[k], draw);
            insertion.is_free(centre, radius[k]).then_some(centre)
        });
        match free {
            Some(centre) => {
                position[k] = centre;
                insertion.put(centre, radius[k]);
            }
            None => return Err(full(context, group, spec, &region, &radius, &order[..placed])),
        }
    }
    Ok(Spheres { position, radius, ..Spheres::default() })
}

/// How large each sphere is.
fn radii(context: &Context<'_>, group: usize, spec: &Random, region: &Region) -> Result<Vec<f64>, Problem> {
    let seed = context.loaded.case.seed;
    let of = |k: u32| match spec.radius {
        Radius::Equal(radius) => radius.get(),
        Radius::Range(range) => {
            let [u, ..] = uniform4(seed, Stream::Radius, group as u32, k, 0);
            let (low, high) = (range.min.get(), range.max.get());
            match range.distribution {
                SizeDistribution::Number => low + u * (high - low),
                // The density falls with the cube of the radius, so that its product with the volume is constant.
                SizeDistribution::Volume => {
                    let (a, b) = (1.0 / (low * low), 1.0 / (high * high));
                    1.0 / (a + u * (b - a)).sqrt()
                }
            }
        }
    };
    let Some(fraction) = spec.volume_fraction else {
        return Ok((0..spec.count.unwrap_or(0)).map(of).collect());
    };
    let target = fraction.get() * volume(region);
    let [smallest, _] = spec.radius.bounds();
    context.room_for(group, target / sphere_volume(smallest))?;
    let mut radii = Vec::new();
    let mut filled = 0.0;
    for k in 0.. {
        let radius = of(k);
        filled += sphere_volume(radius);
        if filled > target * (1.0 + 1e-12) {
            break;
        }
        radii.push(radius);
    }
    if radii.is_empty() {
        return Err(Problem::new(
            codes::REGION_TOO_SMALL,
            format!("not one sphere: {} of the region is less than the volume of a sphere", fraction.get()),
        )
        .at(context.place(group, &["random", "volume_fraction"]), "too small")
        .at(context.place(group, &["random", "radius"]), "for spheres of this size"));
    }
    Ok(radii)
}

/// Spheres placed so far, and where the next may go.
struct Insertion<'c> {
    context: &'c Context<'c>,
    region: Region,
    /// Directions in which a sphere may stick out of the region, because it comes back on the other side.
    wraps: [bool; 3],
    grid: Grid,
    position: Vec<[f64; 3]>,
    radius: Vec<f64>,
}

impl<'c> Insertion<'c> {
    fn new(context: &'c Context<'c>, draft: &Draft, radius: &[f64], region: Region) -> Self {
        let domain = &context.domain;
        let largest = radius.iter().chain(&draft.state.radius).copied().fold(0.0, f64::max);
        let count = radius.len() + draft.state.len();
        let mut insertion = Insertion {
            context,
            region,
            wraps: std::array::from_fn(|k| {
                domain.periodic[k] && region.min[k] <= domain.min[k] && region.max[k] >= domain.max[k]
            }),
            grid: Grid::new(domain, region.min, region.max, 2.0 * largest, count),
            position: Vec::with_capacity(count),
            radius: Vec::with_capacity(count),
        };
        for (&centre, &radius) in draft.state.position.iter().zip(&draft.state.radius) {
            insertion.put(super::placement::wrapped(domain, centre), radius);
        }
        insertion
    }

    fn candidate(&self, radius: f64, draw: [f64; 4]) -> [f64; 3] {
        std::array::from_fn(|k| {
            let keep = if self.wraps[k] { 0.0 } else { radius };
            let (low, high) = (self.region.min[k] + keep, self.region.max[k] - keep);
            low + draw[k] * (high - low)
        })
    }

    fn is_free(&self, centre: [f64; 3], radius: f64) -> bool {
        let clear_of_walls = self.context.planes.iter().all(|plane| plane.distance(centre) >= radius);
        let period = self.context.domain.period();
        let here: Vec3<f64> = centre.into();
        clear_of_walls
            && !self.grid.any_near(centre, |k| {
                let offset = period.nearest(Vec3::from(self.position[k]) - here);
                let reach = radius + self.radius[k];
                offset.dot(offset) < reach * reach
            })
    }

    fn put(&mut self, centre: [f64; 3], radius: f64) {
        self.grid.push(centre);
        self.position.push(centre);
        self.radius.push(radius);
    }
}

fn full(
    context: &Context<'_>,
    group: usize,
    spec: &Random,
    region: &Region,
    radius: &[f64],
    placed: &[usize],
) -> Problem {
    let reached: f64 = placed.iter().map(|&k| sphere_volume(radius[k])).sum::<f64>() / volume(region);
    let wanted: f64 = radius.iter().map(|&r| sphere_volume(r)).sum::<f64>() / volume(region);
    let key = if spec.count.is_some() { "count" } else { "volume_fraction" };
    Problem::new(
        codes::NO_ROOM,
        format!(
            "only {} of {} spheres found a place, {} of the region's volume instead of {}",
            placed.len(),
            radius.len(),
            number(reached),
            number(wanted)
        ),
    )
    .at(context.place(group, &["random", key]), "too many")
    .help("random places run out at about 0.38: take fewer, a larger region, or a lattice; then let them settle")
}
