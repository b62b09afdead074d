//! Two small runs with everything in them, for readers in other languages to be tested on:
//! `cargo run -p tdem-results --example sample_run -- FOLDER [STEPS]`.

#[path = "../tests/common/mod.rs"]
mod common;

use std::error::Error;
use std::path::Path;
use tdem_engine::{Plan, Schedule, Simulation, cpu};
use tdem_results::picture::{self, Colour, Options, Subject};
use tdem_results::{RunDirectory, load_final_state, pack, session};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args_os().skip(1);
    let folder = arguments.next().ok_or("usage: sample_run FOLDER [STEPS]")?;
    let folder = Path::new(&folder);
    let steps = arguments.next().and_then(|steps| steps.to_str()?.parse().ok()).unwrap_or(4000);
    // Walls that stand still are stored in another way than walls of which one moves.
    let moving = common::plan();
    let mut still = common::plan();
    still.walls.pop();
    sample(&folder.join("moving"), &moving, steps)?;
    sample(&folder.join("still"), &still, steps)
}

fn sample(folder: &Path, plan: &Plan, steps: u64) -> Result<(), Box<dyn Error>> {
    let mut state = common::state();
    state.wall_position.truncate(plan.walls.len());
    let simulation = Simulation::new(state, plan.clone(), cpu::Options::default())?;
    let mut directory = RunDirectory::create(folder, "# a sample, not made from a case\n", true)?;
    directory.set_contents(common::contents());
    let schedule = Schedule { steps, frame_every: 100, history_every: 20, ..Schedule::default() };
    session::run(simulation, &mut directory, &schedule, &mut common::Watcher::default())?;
    drop(directory);

    pack(folder, &folder.join("packed"), 4)?;
    let state = load_final_state(folder)?.state;
    std::fs::create_dir_all(folder.join("pictures"))?;
    for (name, options) in [
        ("speed", Options::default()),
        ("height", Options { colour: Colour::Height, subject: Subject::Particles, ..Options::default() }),
    ] {
        let png = picture::render(&state, plan, &options)?;
        std::fs::write(folder.join(format!("pictures/{name}.png")), png)?;
    }
    Ok(())
}
