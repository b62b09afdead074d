//! Spheres from the final state of another run.

use super::Context;
use super::draft::Spheres;
use crate::problem::Problem;
use crate::schema::{Particles, Run};
use crate::structure::suggestion;
use std::path::Path;
use tdem_engine::State;

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
    let state = loader.load(&directory).map_err(|why| {
        Problem::error("tdem::case::run-unreadable", format!("cannot take the state of {}: {why}", directory.display()))
            .at(context.place(group, &["run", "directory"]), "this run")
            .help("name the directory of a run that left a checkpoint; paths are relative to the folder of the case")
    })?;
    let material = if particles.material.is_some() {
        Vec::new()
    } else {
        let names = if spec.materials.is_empty() { names_in(&directory) } else { spec.materials.clone() };
        renamed(context, group, &names, &state)?
    };
    Ok(Spheres {
        position: state.position,
        radius: state.radius,
        velocity: state.velocity,
        angular_velocity: state.angular_velocity,
        id: state.id,
        material,
        // Walls may be others here, so only the histories of pairs go on.
        contacts: state.contacts,
    })
}

/// Names of the materials of a run in the order of their indices, from the case that it keeps.
fn names_in(directory: &Path) -> Vec<String> {
    crate::load(&directory.join("case.toml"), &[]).map_or(Vec::new(), |run| run.case.material.into_keys().collect())
}

/// The materials of a state as indices of this case.
fn renamed(context: &Context<'_>, group: usize, names: &[String], state: &State) -> Result<Vec<u16>, Problem> {
    let here = &context.loaded.case.material;
    let problem = |what: String, help: String| {
        Problem::error("tdem::case::run-materials", what)
            .at(context.place(group, &["run"]), "materials of this run")
            .help(help)
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
