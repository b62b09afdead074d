//! Parts of space, and what is cut out of groups of particles with them.

use super::Context;
use super::draft::Spheres;
use crate::codes;
use crate::problem::{Problem, counted, number};
use crate::schema::{Axis, Particles, Revolution, RibbedBar, Shape};

/// Whether a point is in a part of space; the checks have found that it has one shape.
pub(super) fn inside<'s>(context: &Context<'_>, shape: &'s Shape) -> Box<dyn Fn([f64; 3]) -> bool + 's> {
    if let Some(block) = &shape.block {
        let region = context.region(block.min, block.max);
        return Box::new(move |p| (0..3).all(|k| region.min[k] <= p[k] && p[k] <= region.max[k]));
    }
    if let Some(ball) = &shape.ball {
        let radius = ball.radius.get();
        return Box::new(move |p| {
            let square: f64 = (0..3).map(|k| (p[k] - ball.center[k]) * (p[k] - ball.center[k])).sum();
            square < radius * radius
        });
    }
    if let Some(cylinder) = &shape.cylinder {
        let radius = cylinder.radius.get();
        return Box::new(move |p| {
            let [along, square] = along_and_across(cylinder.axis, cylinder.through, p);
            let ends = cylinder.from.is_none_or(|from| from <= along) && cylinder.to.is_none_or(|to| along <= to);
            ends && square < radius * radius
        });
    }
    if let Some(bar) = &shape.ribbed_bar {
        return Box::new(|p| {
            let [along, square] = along_and_across(bar.axis, bar.through, p);
            let radius = ribbed_radius(bar, along);
            square < radius * radius
        });
    }
    let Some(revolution) = &shape.revolution else { return Box::new(|_| false) };
    Box::new(|p| {
        let [along, square] = along_and_across(revolution.axis, revolution.through, p);
        profile_radius(revolution, along).is_some_and(|radius| square < radius * radius)
    })
}

/// Coordinate of a point along an axis, m, and the square of its distance from it, m².
fn along_and_across(axis: Axis, through: [f64; 3], point: [f64; 3]) -> [f64; 2] {
    let offset: [f64; 3] = std::array::from_fn(|k| point[k] - through[k]);
    let axis = axis as usize;
    let square = (0..3).filter(|&k| k != axis).map(|k| offset[k] * offset[k]).sum();
    [offset[axis], square]
}

/// Radius of a ribbed bar, m: ribs stand at half a spacing, one and a half, and so on.
fn ribbed_radius(bar: &RibbedBar, along: f64) -> f64 {
    let (spacing, height) = (bar.rib_spacing.get(), bar.rib_height.get());
    let from_rib = (along - (along / spacing).floor() * spacing - 0.5 * spacing).abs();
    // Run of a flank; upright ones have none.
    let run = height / libm::tan(bar.flank_angle_deg.get().to_radians());
    let beyond = from_rib - 0.5 * bar.rib_width.get();
    let part = if beyond <= 0.0 { 1.0 } else { (1.0 - beyond / run).max(0.0) };
    bar.radius.get() + height * part
}

/// Radius of a body of revolution, m; none beyond its ends.
fn profile_radius(revolution: &Revolution, along: f64) -> Option<f64> {
    let piece = revolution.profile.windows(2).find(|piece| piece[0][0] <= along && along <= piece[1][0])?;
    let [[start, first], [end, last]] = [piece[0], piece[1]];
    Some(first + (last - first) * (along - start) / (end - start))
}

/// Keeps of a group's spheres what its `within` and `without` keep. What cuts nothing off is worth a warning.
pub(super) fn cut(
    context: &Context<'_>,
    index: usize,
    group: &Particles,
    spheres: Spheres,
    warnings: &mut Vec<Problem>,
) -> Result<Spheres, Problem> {
    if group.within.is_none() && group.without.is_empty() {
        return Ok(spheres);
    }
    let count = spheres.position.len();
    let mut kept = vec![true; count];
    if let Some(shape) = &group.within {
        let inside = inside(context, shape);
        kept = spheres.position.iter().map(|&point| inside(point)).collect();
        if kept.iter().all(|kept| *kept) {
            warnings.push(idle(context, &["particles", &index.to_string(), "within"], count, "all", "lie in it"));
        } else if !kept.contains(&true) {
            return Err(nothing_left(context, index, "within", &spheres, "lies in this shape"));
        }
    }
    for (k, hole) in group.without.iter().enumerate() {
        let inside = inside(context, hole);
        let before = kept.iter().filter(|kept| **kept).count();
        kept.iter_mut().zip(&spheres.position).for_each(|(kept, &point)| *kept &= !inside(point));
        if kept.iter().filter(|kept| **kept).count() == before {
            let path = ["particles", &index.to_string(), "without", &k.to_string()];
            warnings.push(idle(context, &path, before, "none of", "lies in it"));
        }
    }
    if !kept.contains(&true) {
        return Err(nothing_left(context, index, "without", &spheres, "is left by these holes"));
    }
    Ok(spheres.kept(&kept))
}

fn idle(context: &Context<'_>, path: &[&str], count: usize, how_many: &str, what: &str) -> Problem {
    let message = format!("this cuts nothing off: {how_many} the {} {what}", counted(count, "particle"));
    Problem::new(codes::CUT_IDLE, message)
        .at(context.loaded.tree.place(path), "changes nothing")
        .help("lengths are in metres; a lattice must reach beyond the body that is cut out of it")
}

fn nothing_left(context: &Context<'_>, index: usize, key: &str, spheres: &Spheres, what: &str) -> Problem {
    let edge = |start: f64, pick: fn(f64, f64) -> f64| {
        let corner: [f64; 3] = std::array::from_fn(|k| spheres.position.iter().map(|p| p[k]).fold(start, pick));
        corner.map(number).join(", ")
    };
    let message = format!("none of the {} of this group {what}", counted(spheres.position.len(), "particle"));
    let extent = format!("[{}] to [{}] m", edge(f64::INFINITY, f64::min), edge(f64::NEG_INFINITY, f64::max));
    Problem::new(codes::GROUP_EMPTY, message)
        .at(context.place(index, &[key]), "leaves nothing")
        .help(format!("their centres lie from {extent}; move or enlarge one of the two"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::Positive;

    fn positive(value: f64) -> Positive {
        Positive::try_from(value).unwrap()
    }

    #[test]
    fn ribs_are_trapezoids() {
        let bar = RibbedBar {
            axis: Axis::Y,
            through: [0.0; 3],
            radius: positive(10.0),
            rib_height: positive(1.3),
            rib_width: positive(2.0),
            rib_spacing: positive(8.0),
            flank_angle_deg: positive(60.0),
        };
        let run = 1.3 / 3.0_f64.sqrt();
        for (along, expected) in
            [(0.0, 10.0), (4.0, 11.3), (5.0, 11.3), (-4.5, 11.3), (5.0 + 0.5 * run, 10.65), (12.0, 11.3), (7.0, 10.0)]
        {
            assert!((ribbed_radius(&bar, along) - expected).abs() < 1e-12, "{along}");
        }
        assert_eq!(ribbed_radius(&RibbedBar { flank_angle_deg: positive(90.0), ..bar }, 5.001), 10.0);
    }

    #[test]
    fn a_profile_is_straight_between_its_points_and_ends_with_them() {
        let cone = Revolution { axis: Axis::Z, through: [0.0; 3], profile: vec![[0.0, 1.0], [2.0, 3.0], [3.0, 3.0]] };
        assert_eq!([-0.1, 0.0, 1.0, 2.5].map(|z| profile_radius(&cone, z)), [None, Some(1.0), Some(2.0), Some(3.0)]);
    }
}
