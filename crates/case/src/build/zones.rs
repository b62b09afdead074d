//! What zones make of the particles in them.

use super::Context;
use super::draft::{Draft, sphere_mass};
use super::shape::inside;
use crate::codes;
use crate::problem::Problem;

/// Gives particles the materials of the zones that they lie in. Returns the particles of each zone, and zones that are
/// empty.
pub(super) fn apply(context: &Context<'_>, draft: &mut Draft) -> (Vec<Vec<u32>>, Vec<Problem>) {
    let mut problems = Vec::new();
    let mut all = Vec::new();
    for (k, zone) in context.loaded.case.zone.iter().enumerate() {
        let only = zone.only.as_deref().map(|name| context.materials.index(name));
        let inside = inside(context, &zone.shape);
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
                Problem::new(codes::ZONE_EMPTY, format!("no centre of a particle{of} lies in this zone"))
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
