//! Spheres from the final state of another run.

use super::Context;
use super::draft::{Carried, Spheres, kept};
use super::histories::{Histories, loaded};
use crate::codes;
use crate::problem::Problem;
use crate::schema::{BondForm, Domain, Particles, Run, RunBonds, RunContacts};
use crate::structure::suggestion;
use crate::walls::planes;
use std::path::Path;
use tdem_engine::{Bond, State};

/// Reads the final state of a run. Whoever knows checkpoints implements it.
pub trait RunLoader {
    /// The last good state in a run's directory.
    ///
    /// # Errors
    /// Why there is none, for the user.
    fn load(&self, directory: &Path) -> Result<State, String>;
}

impl<F: Fn(&Path) -> Result<State, String>> RunLoader for F {
    fn load(&self, directory: &Path) -> Result<State, String> {
        self(directory)
    }
}

/// Knows no runs.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoRuns;

impl RunLoader for NoRuns {
    fn load(&self, _: &Path) -> Result<State, String> {
        Err("other runs cannot be read here".to_owned())
    }
}

pub(super) fn place(
    context: &Context<'_>,
    loader: &dyn RunLoader,
    group: usize,
    particles: &Particles,
    spec: &Run,
) -> Result<Spheres, Problem> {
    let directory = context.loaded.file(&spec.directory);
    let mut state = loader.load(&directory).map_err(|why| {
        Problem::new(codes::RUN_UNREADABLE, format!("cannot take the state of {}: {why}", directory.display()))
            .at(context.place(group, &["run", "directory"]), "this run")
            .help("name the directory of a run that left a checkpoint; paths are relative to the folder of the case")
    })?;
    // All that follows looks up rows of one field by those of another.
    state.look_for_flaws().map_err(|flaw| {
        Problem::new(codes::RUN_UNREADABLE, format!("cannot take the state of {}: {flaw}", directory.display()))
            .at(context.place(group, &["run", "directory"]), "this run")
            .help("the state is none that a run leaves; run that case again")
    })?;
    let material = if particles.material.is_some() {
        Vec::new()
    } else {
        let names = if spec.materials.is_empty() { names_in(&directory) } else { spec.materials.clone() };
        renamed(context, group, &names, &state)?
    };
    let carried = match spec.bonds {
        RunBonds::Anew => Carried::default(),
        RunBonds::Carry => carried(context, group, spec, &directory, &state)?,
    };
    let histories = histories(context, group, spec, &directory, &mut state)?;
    Ok(Spheres {
        position: state.position.iter().map(|&place| moved(spec, place)).collect(),
        radius: (0..state.len()).map(|k| state.bonded_radius(k)).collect(),
        temperature: state.temperature,
        velocity: state.velocity,
        angular_velocity: state.angular_velocity,
        id: state.id,
        material,
        histories,
        carried,
    })
}

/// A place of that run in this one, m.
fn moved(spec: &Run, place: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| place[k] + spec.offset[k])
}

/// The contact histories of a run, with the names of its walls if they are to be transferred.
fn histories(
    context: &Context<'_>,
    group: usize,
    spec: &Run,
    directory: &Path,
    state: &mut State,
) -> Result<Histories, Problem> {
    let (pairs, walls) = (std::mem::take(&mut state.contacts), std::mem::take(&mut state.wall_contacts));
    let needed = spec.contacts == Some(RunContacts::Carry) && walls.iter().any(|wall| loaded(wall.displacement));
    let names = match crate::load(&directory.join("case.toml"), &[]) {
        // In the order of the plan that the run followed.
        Ok(run) => planes(&run.case, &run.tree, |_| 0).into_iter().map(|plane| plane.wall.name).collect(),
        Err(_) if !needed => Vec::new(),
        Err(_) => {
            let message =
                format!("the case that {} keeps cannot be read: its walls have no names", directory.display());
            return Err(Problem::new(codes::RUN_UNREADABLE, message)
                .at(context.place(group, &["run", "contacts"]), "matches walls by name")
                .help("mend that case.toml, or write contacts = \"anew\" and let friction build up again"));
        }
    };
    Ok(Histories::new(pairs, walls, names))
}

/// The bonds of a run that hold, with all that they refer to. Where one broke, particles touch from then on.
fn carried(
    context: &Context<'_>,
    group: usize,
    spec: &Run,
    directory: &Path,
    state: &State,
) -> Result<Carried, Problem> {
    let problem = |what: &str, help: &str| {
        Problem::new(codes::RUN_BONDS, what).at(context.place(group, &["run", "bonds"]), "cannot go on").help(help)
    };
    if state.bonds.is_empty() {
        let what = format!("the run {} has no bonds", directory.display());
        return Err(problem(&what, "leave `bonds` out to bond its particles as they lie"));
    }
    if context.loaded.case.bond.is_empty() {
        return Err(problem(
            "the bonds of that run go on, but nothing here says what bonds are made of",
            "write model = \"BPM\" and repeat the [[bond]] tables of that run's case",
        ));
    }
    let form = context.loaded.case.bonds.form;
    if form != BondForm::Total && state.bond_histories.is_empty() {
        return Err(problem(
            "bonds store forces here, but in that run they did not: there is nothing to go on from",
            "write bonds.form = \"total\"",
        ));
    }
    let before = crate::load(&directory.join("case.toml"), &[]).ok().map(|run| run.case.domain);
    if before.is_some_and(|before| !goes_on(context, &before, state)) {
        return Err(problem(
            "bonds of that run go through faces of its domain that repeat, but not, or not so soon, here",
            "give the domain the same length, and let it repeat, in the same directions",
        ));
    }
    let whole: Vec<bool> = state.bonds.iter().map(Bond::holds).collect();
    Ok(Carried {
        bonded_position: state.bonded_position.iter().map(|&place| moved(spec, place)).collect(),
        orientation: state.orientation.clone(),
        bonds: kept(&state.bonds, &whole),
        histories: kept(&state.bond_histories, &whole),
    })
}

/// Whether directions in which the bonds of a run go through faces that repeat repeat here too, after the same length.
fn goes_on(context: &Context<'_>, before: &Domain, state: &State) -> bool {
    let here = &context.domain;
    let length = |k: usize| before.max[k] - before.min[k];
    let same = |k: usize| {
        let change = here.max[k] - here.min[k] - length(k);
        here.periodic[k] && change.abs() <= 1e-12 * length(k)
    };
    let across = |bond: &Bond, k: usize| {
        let [first, second] = [bond.first, bond.second].map(|id| state.index_of(id).unwrap_or(0));
        (state.bonded_position[second][k] - state.bonded_position[first][k]).abs() > 0.5 * length(k)
    };
    (0..3).all(|k| !before.periodic[k] || same(k) || !state.bonds.iter().any(|bond| across(bond, k)))
}

/// Names of the materials of a run in the order of their indices, from the case that it keeps.
fn names_in(directory: &Path) -> Vec<String> {
    crate::load(&directory.join("case.toml"), &[]).map_or(Vec::new(), |run| run.case.material.into_keys().collect())
}

/// The materials of a state as indices of this case.
fn renamed(context: &Context<'_>, group: usize, names: &[String], state: &State) -> Result<Vec<u16>, Problem> {
    let here = &context.loaded.case.material;
    let problem = |what: String, help: String| {
        Problem::new(codes::RUN_MATERIALS, what).at(context.place(group, &["run"]), "materials of this run").help(help)
    };
    let used: std::collections::BTreeSet<u16> = state.material.iter().copied().collect();
    for material in &used {
        match names.get(usize::from(*material)) {
            None => {
                return Err(problem(
                    format!(
                        "particles of that run have material {material}, counted from 0, for which there is no name"
                    ),
                    "name all of them, materials = [...], or give the group one `material`".to_owned(),
                ));
            }
            Some(name) if !here.contains_key(name) => {
                let known: Vec<&str> = here.keys().map(String::as_str).collect();
                return Err(problem(
                    format!("particles of that run are made of `{name}`, which this case does not define"),
                    suggestion(name, &known),
                ));
            }
            Some(_) => {}
        }
    }
    Ok(state.material.iter().map(|&material| context.materials.index(&names[usize::from(material)])).collect())
}
