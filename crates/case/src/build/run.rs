//! Spheres from the final state of another run.

use super::Context;
use super::draft::Spheres;
use crate::problem::Problem;
use crate::schema::{Particles, Run};
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
        let given: Vec<u16> = spec.materials.iter().map(|name| context.materials.index(name)).collect();
        let renamed: Option<Vec<u16>> = state.material.iter().map(|&m| given.get(usize::from(m)).copied()).collect();
        renamed.ok_or_else(|| {
            let highest = state.material.iter().max().map_or(0, |&m| usize::from(m) + 1);
            Problem::error(
                "tdem::case::run-materials",
                format!("that run has {highest} materials, but {} are named", given.len()),
            )
            .at(context.place(group, &["run", "materials"]), "one name for each material of that run")
        })?
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
