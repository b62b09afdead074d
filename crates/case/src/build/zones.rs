//! What zones make of the particles in them.

use super::Context;
use super::draft::{Draft, sphere_mass};
use crate::problem::Problem;
use crate::schema::{Axis, Revolution, RibbedBar, Zone};

/// Gives particles the materials of the zones that they lie in. Returns the particles of each zone, and zones that are
/// empty.
pub(super) fn apply(context: &Context<'_>, draft: &mut Draft) -> (Vec<Vec<u32>>, Vec<Problem>) {
    let mut problems = Vec::new();
    let mut all = Vec::new();
    for (k, zone) in context.loaded.case.zone.iter().enumerate() {
        let only = zone.only.as_deref().map(|name| context.materials.index(name));
        let inside = shape(context, zone);
        let state = &mut draft.state;
        let members: Vec<u32> = (0..state.len())
            .filter(|&i| only.is_none_or(|material| state.material[i] == material) && inside(state.position[i]))
            .map(|i| i as u32)
            .collect();
        if let Some(name) = &zone.material {
            let material = context.materials.index(name);
            let density = context.materials.density[usize::from(material)];
            for &i in &members {
                state.material[i as usize] = material;
                state.mass[i as usize] = sphere_mass(state.radius[i as usize], density);
            }
        }
        if members.is_empty() {
            let of = zone.only.as_ref().map_or(String::new(), |only| format!(" of `{only}`"));
            problems.push(
                Problem::error("tdem::case::zone-empty", format!("no centre of a particle{of} lies in this zone"))
                    .at(context.loaded.tree.place(&["zone", &k.to_string()]), "changes nothing")
                    .help(
                        "lengths are in metres; zones act in the order of the file, each on what the earlier ones left",
                    ),
            );
        }
        all.push(members);
    }
    (all, problems)
}

/// Whether a point is in a zone; the checks have found that it has one shape.
fn shape<'z>(context: &Context<'_>, zone: &'z Zone) -> Box<dyn Fn([f64; 3]) -> bool + 'z> {
    if let Some(block) = &zone.block {
        let region = context.region(block.min, block.max);
        return Box::new(move |p| (0..3).all(|k| region.min[k] <= p[k] && p[k] <= region.max[k]));
    }
    if let Some(cylinder) = &zone.cylinder {
        let radius = cylinder.radius.get();
        return Box::new(move |p| {
            let [_, square] = along_and_across(cylinder.axis, cylinder.through, p);
            square < radius * radius
        });
    }
    if let Some(bar) = &zone.ribbed_bar {
        return Box::new(|p| {
            let [along, square] = along_and_across(bar.axis, bar.through, p);
            let radius = ribbed_radius(bar, along);
            square < radius * radius
        });
    }
    let Some(revolution) = &zone.revolution else { return Box::new(|_| false) };
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
