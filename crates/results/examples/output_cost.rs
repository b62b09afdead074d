//! What one output costs, part by part, for a crystal of touching spheres:
//! `cargo run --release -p tdem-results --example output_cost -- FOLDER [CELLS] [STEPS] [cpu|opencl|cuda]`.
//! There are 2 `CELLS`³ spheres.
#![allow(clippy::print_stdout, reason = "an example talks to whoever runs it")]

#[path = "../tests/common/mod.rs"]
mod common;

use std::error::Error;
use std::path::Path;
use std::time::Instant;
use tdem_engine::gpu::Api;
use tdem_engine::{Device, Ledger, Plan, Simulation, State};
use tdem_results::{Contents, RunDirectory};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let argument = |index: usize| arguments.get(index).map(String::as_str);
    let folder = Path::new(argument(0).ok_or("usage: output_cost FOLDER [CELLS] [STEPS] [cpu|opencl|cuda]")?);
    let cells: u32 = argument(1).unwrap_or("70").parse()?;
    let steps: u64 = argument(2).unwrap_or("10").parse()?;
    let device = match argument(3).unwrap_or("cpu") {
        "cuda" => Device::Gpu { api: Api::Cuda, index: 0 },
        "opencl" => Device::Gpu { api: Api::OpenCl, index: 0 },
        _ => Device::default(),
    };
    let (state, plan) = crystal(cells);
    let mut directory = RunDirectory::create(folder, "# an example, not made from a case\n", true)?;
    directory.checkpoint(&state)?;
    let mut simulation = Simulation::new(state, plan.clone(), device)?;
    for (contacts, level) in [(false, 0), (false, 1), (false, 4), (true, 1), (false, 1)] {
        simulation.advance(steps)?;
        directory.set_contents(Contents { contacts, compression: level, ..Contents::default() });
        let mut began = Instant::now();
        let mut lap = || {
            let took = began.elapsed();
            began = Instant::now();
            1e3 * took.as_secs_f64()
        };
        let capture = simulation.capture()?;
        let captured = lap();
        let state = capture.state()?;
        let assembled = lap();
        let ledger = Ledger::of(&state, &plan);
        let drawn_up = lap();
        directory.frame(&state, &plan)?;
        let framed = lap();
        directory.checkpoint(&state)?;
        let kept = lap();
        let frame = std::fs::read_dir(folder.join("frames"))?.filter_map(|entry| entry.ok()?.path().into()).max();
        let bytes = frame.map_or(Ok(0), |path: std::path::PathBuf| path.metadata().map(|found| found.len()))?;
        println!(
            "{} spheres, {} contacts (drawn: {contacts}), level {level}: capture {captured:.0} ms, state {assembled:.0}, \
             ledger {drawn_up:.0}, frame {framed:.0} ({:.1} MB), checkpoint {kept:.0}",
            state.len(),
            ledger.contacts,
            bytes as f64 * 1e-6,
        );
    }
    Ok(())
}

/// Touching spheres in a face-centred cubic lattice on the floor, with velocities of their own.
fn crystal(cells: u32) -> (State, Plan) {
    let side = common::RADIUS * 8.0_f64.sqrt() * (1.0 - 1e-6);
    let mut state = State::default();
    for cell in 0..cells * cells * (cells / 2) {
        let (x, y, z) = (cell % cells, cell / cells % cells, cell / cells / cells);
        for corner in [[0.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.5, 0.0, 0.5], [0.0, 0.5, 0.5]] {
            let id = state.id.len() as u32;
            let place = [x, y, z];
            state.id.push(id);
            state.position.push(std::array::from_fn(|k| common::RADIUS + side * (f64::from(place[k]) + corner[k])));
            state.velocity.push(std::array::from_fn(|k| noise(3 * id + k as u32)));
        }
    }
    let count = state.id.len();
    state.material = vec![0; count];
    state.constraint = vec![0; count];
    state.radius = vec![common::RADIUS; count];
    state.mass = vec![0.48; count];
    state.image = vec![[0; 3]; count];
    state.angular_velocity = vec![[0.0; 3]; count];
    state.force = vec![[0.0; 3]; count];
    state.moment = vec![[0.0; 3]; count];
    state.accounts = vec![[0.0; 4]; count];
    let mut plan = common::plan();
    plan.domain.max = [side * f64::from(cells) + 2.0; 3];
    plan.domain.periodic = [false; 3];
    plan.walls.truncate(1);
    state.wall_position = vec![[0.0; 3]];
    (state, plan)
}

/// A number between -0.1 and 0.1 for each key.
fn noise(key: u32) -> f64 {
    let mut bits = u64::from(key).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    0.2 * ((bits >> 11) as f64 / (1_u64 << 53) as f64 - 0.5)
}
