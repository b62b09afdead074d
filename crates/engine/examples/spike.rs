//! temporary
#![allow(missing_docs, clippy::all, clippy::pedantic, clippy::print_stdout, reason = "temporary")]
#[path = "../tests/common/mod.rs"]
mod common;
use tdem_engine::cpu::{List, Options};
use tdem_engine::physics::contact::Law;
use tdem_engine::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let cells: [usize; 3] = [20, 20, 40];
    let r = 0.01f64;
    let lat = 2.0 * 2f64.sqrt() * r * 0.999;
    let mut p = vec![];
    for z in 0..cells[2] {
        for y in 0..cells[1] {
            for x in 0..cells[0] {
                for b in [[0.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.5, 0.0, 0.5], [0.0, 0.5, 0.5]] {
                    p.push(([(x as f64 + b[0]) * lat, (y as f64 + b[1]) * lat, (z as f64 + b[2]) * lat], r));
                }
            }
        }
    }
    let mut s = common::spheres(&p, 920.0);
    for k in 0..s.len() {
        s.velocity[k] = std::array::from_fn(|d| 0.1 * (common::random(3, (3 * k + d) as u64) - 0.5));
    }
    let law = match a[1].as_str() {
        "GN" => Law::GN,
        "GNT" => Law::GNT,
        _ => Law::GNTM,
    };
    let mut plan = common::plan(law, [-1.0; 3], [2.0; 3], [false; 3]);
    plan.dt = 1e-6;
    plan.gravity = [0.0, 0.0, -9.81];
    plan.ledger = a.get(4).is_some_and(|s| s == "ledger");
    plan.interactions[0].static_friction = 1.0;
    plan.interactions[0].dynamic_friction = 1.0;
    plan.search.skin = 0.1 * r;
    let steps = 100;
    let o = Options {
        threads: Some(a[2].parse().unwrap()),
        lanes: a[3] != "scalar",
        list: if a[3] == "full" { List::Full } else { List::Half },
        cell_factor: 1.0,
    };
    let mut sim = Simulation::new(s, plan, &o).unwrap();
    sim.advance(5).unwrap();
    let mut best = f64::MAX;
    for _ in 0..5 {
        let cpu = || {
            let s = std::fs::read_to_string("/proc/self/stat").unwrap();
            let f: Vec<&str> = s.rsplit(')').next().unwrap().split_whitespace().collect();
            (f[11].parse::<f64>().unwrap() + f[12].parse::<f64>().unwrap()) / 100.0
        };
        let t = cpu();
        let w = std::time::Instant::now();
        sim.advance(steps).unwrap();
        print!("{:.2e}/{:.2e} ", 6.4e4 * steps as f64 / w.elapsed().as_secs_f64(), 6.4e4 * steps as f64 / (cpu() - t));
        best = best.min(cpu() - t);
    }
    let n = sim.state().len();
    println!(
        "{a:?} N {n} contacts/N {:.2} {:.3e} particle-steps/s  {:.1} B/particle searches {} hash {:x}",
        2.0 * sim.state().contacts.len() as f64 / n as f64,
        n as f64 * steps as f64 / best,
        sim.bytes() as f64 / n as f64,
        sim.searches(),
        sim.state().hash()
    );
}
