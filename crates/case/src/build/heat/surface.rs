//! Surfaces: which particles lie at them, and what each of these exchanges.

use super::super::{Context, Draft, lattice};
use super::course;
use crate::codes;
use crate::problem::{Problem, counted};
use crate::schema::{self, Depth, Face, Heat, Surface};
use crate::walls::FACES;
use std::collections::BTreeMap;
use tdem_engine::physics::heat::surface;
use tdem_engine::{Around, Exposure, SurfacePart};

/// How far centres of a layer may lie behind the outermost, as a fraction of their radius.
const LAYER: f64 = 0.5;

/// Surfaces as gauges watch them, by name.
pub(in crate::build) type Surfaces = BTreeMap<String, tdem_engine::Surface>;

/// How large a `[[surface]]` is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceExtent {
    /// Number of particles that lie at it.
    pub particles: usize,
    /// Of all of them together, m²; 0 if they are held at a temperature without depth, which needs none.
    pub area: f64,
    /// Depth of their centres behind it, m.
    pub depth: f64,
}

/// What a plan has of exposures.
pub(super) struct Exposed {
    pub(super) exposures: Vec<Exposure>,
    /// Open sides of each of them, a bit for each; empty without.
    pub(super) sides: Vec<u8>,
    /// Of each `[[surface]]`.
    pub(super) extents: Vec<SurfaceExtent>,
}

/// A surface with its particles.
struct Skin<'c> {
    surface: &'c Surface,
    index: usize,
    /// Indices into the draft.
    members: Vec<u32>,
    /// Part of each particle, m².
    area: f64,
    /// Of their centres, m.
    depth: f64,
}

/// What particles are exposed to; the draft gets an index for each.
pub(super) fn expose(
    context: &Context<'_>,
    heat: &Heat,
    draft: &mut Draft,
    zones: &[Vec<u32>],
    problems: &mut Vec<Problem>,
) -> (Exposed, Surfaces) {
    let mut skins = Vec::new();
    for (index, surface) in context.loaded.case.surface.iter().enumerate() {
        match skin(context, draft, zones, index, surface) {
            Ok(skin) => skins.push(skin),
            Err(problem) => problems.push(problem),
        }
    }
    let mut of_particle: Vec<Vec<usize>> = vec![Vec::new(); draft.state.len()];
    for (k, skin) in skins.iter().enumerate() {
        skin.members.iter().for_each(|&member| of_particle[member as usize].push(k));
    }
    problems.extend(held_twice(context, &skins, &of_particle));
    let at_sides = at_sides(draft, heat.open_faces());
    let mut known: BTreeMap<(u16, &[usize], u8), u16> = BTreeMap::new();
    let mut exposures = vec![Exposure::default()];
    let mut sides = vec![0];
    let mut parts = vec![vec![None]; skins.len()];
    draft.state.exposure = (of_particle.iter().zip(&draft.state.material).zip(at_sides))
        .map(|((of, &material), at)| {
            if of.is_empty() && at == 0 {
                return 0;
            }
            *known.entry((material, of, at)).or_insert_with(|| {
                let conductivity = context.conductivity(usize::from(material));
                let mut exposure = Exposure::default();
                for of_skin in &mut parts {
                    of_skin.push(None);
                }
                for &k in of {
                    parts[k][exposures.len()] = Some(skins[k].add_to(&mut exposure, heat, conductivity));
                }
                exposures.push(exposure);
                sides.push(at);
                (exposures.len() - 1) as u16
            })
        })
        .collect();
    let surfaces = skins.iter().zip(parts).map(|(skin, parts)| {
        let mut ids: Vec<u32> = skin.members.iter().map(|&member| draft.state.id[member as usize]).collect();
        ids.sort_unstable();
        (skin.surface.name.clone(), tdem_engine::Surface { members: ids.into(), parts })
    });
    if heat.open_faces().is_empty() {
        sides.clear();
    }
    let extents = skins.iter().map(|skin| SurfaceExtent {
        particles: skin.members.len(),
        area: skin.area * skin.members.len() as f64,
        depth: skin.depth,
    });
    (Exposed { exposures, sides, extents: extents.collect() }, surfaces.collect())
}

/// At which of some sides of all that there is each particle lies, a bit for each.
fn at_sides(draft: &Draft, faces: &[Face]) -> Vec<u8> {
    let mut at = vec![0; draft.state.len()];
    for (bit, &(face, ..)) in FACES.iter().enumerate().filter(|(_, known)| faces.contains(&known.0)) {
        let all = (0..draft.state.len() as u32).collect();
        for k in outermost(draft, all, face) {
            at[k as usize] |= 1 << bit;
        }
    }
    at
}

/// A surface of the case with its particles.
fn skin<'c>(
    context: &Context<'_>,
    draft: &Draft,
    zones: &[Vec<u32>],
    index: usize,
    surface: &'c Surface,
) -> Result<Skin<'c>, Problem> {
    let case = &context.loaded.case;
    let place = |key: &str| context.loaded.tree.place(&["surface", &index.to_string(), key]);
    let all = 0..draft.state.len() as u32;
    let mut members: Vec<u32> = match &surface.of {
        None => all.collect(),
        Some(name) => match case.zone.iter().position(|zone| zone.name == *name) {
            Some(zone) => zones[zone].clone(),
            None => all.filter(|&k| case.particles[usize::from(draft.group[k as usize])].name == *name).collect(),
        },
    };
    if let Some(face) = surface.face {
        members = outermost(draft, members, face);
    }
    if members.is_empty() {
        return Err(Problem::new(codes::SURFACE_EMPTY, "no particle lies at this surface")
            .at(place("of"), "has no particles")
            .help("zones act in the order of the file, and hold particles whose centres lie in them"));
    }
    let cell = lattice_of(context, draft, &members);
    let area = match (surface.area, &cell) {
        (Some(area), _) => area.get() / members.len() as f64,
        // A face of a lattice has a cell's part of each particle; of what lies elsewhere that would be wrong.
        (None, Some(cell)) if surface.face.is_some() => cell.area,
        _ if surface.needs_no_area() => 0.0,
        (None, _) => {
            return Err(Problem::new(codes::MISSING_KEY, "nothing says how large this surface is")
                .at(place(""), "`area` belongs here")
                .help("add area = ... in m²; only a `face` of particles of one lattice can do without"));
        }
    };
    let depth = match (surface.depth, &cell) {
        (Depth::Metres(depth), _) => depth.get(),
        (Depth::HalfCell, Some(cell)) => cell.depth,
        (Depth::HalfCell, None) => {
            return Err(Problem::new(codes::MISSING_KEY, "half a cell is a depth of lattices only")
                .at(place("depth"), "`depth` belongs here")
                .help("add depth = ..., how deep centres lie behind the surface, m; 0.0 for not at all"));
        }
    };
    Ok(Skin { surface, index, members, area, depth })
}

/// Those that lie outermost in a direction.
fn outermost(draft: &Draft, members: Vec<u32>, face: Face) -> Vec<u32> {
    let state = &draft.state;
    let (axis, low) = FACES.iter().find(|known| known.0 == face).map_or((0, true), |&(_, axis, low)| (axis, low));
    let height = |k: u32| if low { -state.position[k as usize][axis] } else { state.position[k as usize][axis] };
    let highest = members.iter().map(|&k| height(k)).fold(f64::NEG_INFINITY, f64::max);
    members.into_iter().filter(|&k| highest - height(k) <= LAYER * state.radius[k as usize]).collect()
}

/// The lattice that particles lie on, if it is one.
fn lattice_of(context: &Context<'_>, draft: &Draft, members: &[u32]) -> Option<lattice::Cell> {
    let mut groups: Vec<u16> = members.iter().map(|&k| draft.group[k as usize]).collect();
    groups.dedup();
    groups.sort_unstable();
    groups.dedup();
    let cell = |group: u16| context.loaded.case.particles[usize::from(group)].lattice.as_ref().map(lattice::Cell::of);
    let first = cell(*groups.first()?)?;
    groups.iter().all(|&group| cell(group) == Some(first)).then_some(first)
}

/// Particles that two surfaces hold at a temperature: one problem for each pair of surfaces.
fn held_twice(context: &Context<'_>, skins: &[Skin<'_>], of_particle: &[Vec<usize>]) -> Vec<Problem> {
    let mut pairs: BTreeMap<[usize; 2], usize> = BTreeMap::new();
    for of in of_particle {
        let held: Vec<usize> = of.iter().copied().filter(|&k| skins[k].holds()).collect();
        if let [first, second, ..] = held.as_slice() {
            *pairs.entry([*first, *second]).or_insert(0) += 1;
        }
    }
    let place = |k: usize| context.loaded.tree.place(&["surface", &skins[k].index.to_string(), "temperature"]);
    pairs
        .into_iter()
        .map(|([first, second], count)| {
            let who = counted(count, "particle");
            Problem::new(codes::TWO_TEMPERATURES, format!("{who} would be held at two temperatures"))
                .at(place(second), "some particles here")
                .at(place(first), "have this from before")
                .help("bound one of the surfaces so that it leaves these particles out, or give it a depth")
        })
        .collect()
}

impl Skin<'_> {
    /// Whether its particles themselves are held at its temperature.
    fn holds(&self) -> bool {
        self.surface.temperature.is_some() && self.depth == 0.0
    }

    /// Adds what it does to a particle to what others do. Returns which part is its own.
    fn add_to(&self, exposure: &mut Exposure, heat: &Heat, conductivity: f64) -> SurfacePart {
        let (surface, zero) = (self.surface, heat.scale.zero());
        let warm = |of: &schema::Course| course(of, zero);
        if self.holds() {
            exposure.temperature = surface.temperature.as_ref().map(warm);
            return SurfacePart::Held;
        }
        let film = surface.convection.as_ref().map_or(0.0, |convection| convection.coefficient.get());
        let cover = surface::Cover {
            area: self.area,
            depth: self.depth,
            conductivity,
            film: if surface.temperature.is_some() { f64::INFINITY } else { film },
            emissivity: surface.radiation.as_ref().map_or(0.0, |radiation| radiation.emissivity.get()),
        };
        let fluid = surface.convection.as_ref().map(|convection| &convection.temperature);
        let around = Around {
            flux: surface.flux.as_ref().map(|flux| course(flux, 0.0)),
            fluid: surface.temperature.as_ref().or(fluid).map(warm),
            surroundings: surface.radiation.as_ref().map(|radiation| warm(&radiation.temperature)),
        };
        exposure.exchanges.push((cover.exchange(), around));
        SurfacePart::Exchange(exposure.exchanges.len() - 1)
    }
}
